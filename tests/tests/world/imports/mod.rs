//! Imports between the files of each package run one way: no circle between files of different folders, and none of more than two files within a folder.

mod circles;
mod modules;
mod parse;

use std::path::Path;

use anyhow::{Result, ensure};

use circles::{Graph, circles};
use modules::Modules;

/// Source folders of the product's packages.
const PACKAGES: [&str; 4] = ["shared/src", "server/src", "server/wind/src", "client-wasm/src"];

/// The files of a package and what each imports.
fn imports(package: &str) -> Result<Graph> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(package);
    let root = root.canonicalize()?;
    let graph = Modules::of_crate(&mut |path| std::fs::read_to_string(root.join(path)).ok())?.graph();
    ensure!(graph.files.len() > 5, "{package}: only {} files were read", graph.files.len());
    Ok(graph)
}

/// The graph of sources given as text, by path below `src`.
fn graph_of(sources: &[(&str, &str)]) -> Graph {
    let read = &mut |path: &str| sources.iter().find(|(name, _)| *name == path).map(|(_, text)| (*text).to_owned());
    Modules::of_crate(read).expect("the sources parse").graph()
}

#[test]
fn imports_make_no_circles() -> Result<()> {
    let mut found = Vec::new();
    for package in PACKAGES {
        let graph = imports(package)?;
        println!("{package}: {}", graph.figures());
        found.extend(circles(&graph).iter().map(|circle| format!("{package}: {}", circle.join(" -> "))));
    }
    ensure!(found.is_empty(), "circles of imports:\n{}", found.join("\n"));
    Ok(())
}

#[test]
fn a_circle_between_folders_is_found() {
    let between = [
        ("lib.rs", "pub mod wind;\npub mod grass;"),
        ("wind/mod.rs", "mod step;\npub use step::Step;"),
        ("wind/step.rs", "use crate::grass::Blade;\npub struct Step(Blade);"),
        ("grass/mod.rs", "mod blade;\npub use blade::Blade;"),
        ("grass/blade.rs", "pub struct Blade;\nimpl Blade { fn step(&self, _: &crate::wind::Step) {} }"),
    ];
    assert_eq!(
        circles(&graph_of(&between)),
        [["grass/blade.rs", "wind/step.rs", "grass/blade.rs"]],
        "through re-exports and an inline path"
    );
}

#[test]
fn a_circle_of_three_files_in_one_folder_is_found() {
    let three = [
        ("lib.rs", "mod a;\nmod b;\nmod c;"),
        ("a.rs", "use super::b::{self, B};\npub struct A(B);"),
        ("b.rs", "use crate::{c::C};\npub struct B(C);"),
        ("c.rs", "pub struct C;\nfn f() { println!(\"{}\", crate::a::X) }"),
    ];
    assert!(circles(&graph_of(&three)).is_empty(), "X is not declared");
    let three =
        three.map(|(name, text)| (name, if name == "a.rs" { "use super::b::B;\npub const X: u8 = 0;\npub struct A(B);" } else { text }));
    assert_eq!(circles(&graph_of(&three)), [["a.rs", "b.rs", "c.rs", "a.rs"]]);
}

#[test]
fn two_files_of_one_folder_tests_and_re_exports_may_meet() {
    let allowed = [
        ("lib.rs", "pub mod wind;\npub mod grass;\npub use grass::Blade;"),
        ("wind.rs", "use crate::Blade;\nmod step;\npub use step::Step;\npub struct Wind(Step, Blade);"),
        ("wind/step.rs", "use super::Wind;\npub struct Step;\nimpl Step { fn of(_: &Wind) {} }"),
        ("grass.rs", "pub struct Blade;\n#[cfg(test)]\nmod tests { use crate::wind::Wind; }\n// crate::wind::Step"),
    ];
    assert_eq!(circles(&graph_of(&allowed)), Vec::<Vec<String>>::new());
}
