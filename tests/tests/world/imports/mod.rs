//! Imports between the files of each package run one way: no circle between files of different folders, and none of more than two files within a folder.

mod circles;
mod modules;
mod parse;

use std::path::Path;

use anyhow::{Result, ensure};

use circles::{Graph, circles};
use modules::Modules;

/// Source folders of the product's packages.
pub(super) const PACKAGES: [&str; 4] = ["shared/src", "server/src", "server/wind/src", "client-wasm/src"];

/// Roots of the crates of a package: its library, and its binary if it has one.
const ROOTS: [&str; 2] = ["lib.rs", "main.rs"];

/// The import graphs of a package's files, one for each crate.
fn imports(package: &str) -> Result<Vec<Graph>> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(package);
    let src = src.canonicalize()?;
    let graph = |root: &&str| Ok(Modules::of_crate(root, &mut |path| std::fs::read_to_string(src.join(path)).ok())?.graph());
    let graphs = ROOTS.iter().filter(|root| src.join(root).exists()).map(graph).collect::<Result<Vec<_>>>()?;
    let read: usize = graphs.iter().map(|graph| graph.files.len()).sum();
    ensure!(read > 5, "{package}: only {read} files were read");
    Ok(graphs)
}

/// The graph of sources given as text, by path below `src`.
fn graph_of(sources: &[(&str, &str)]) -> Graph {
    let read = &mut |path: &str| sources.iter().find(|(name, _)| *name == path).map(|(_, text)| (*text).to_owned());
    Modules::of_crate("lib.rs", read).expect("the sources parse").graph()
}

#[test]
fn imports_make_no_circles() -> Result<()> {
    let mut found = Vec::new();
    for package in PACKAGES {
        for graph in imports(package)? {
            println!("{package}/{}: {}", graph.files[0], graph.figures());
            found.extend(circles(&graph).iter().map(|circle| format!("{package}: {}", circle.join(" -> "))));
        }
    }
    ensure!(found.is_empty(), "circles of imports:\n{}", found.join("\n"));
    Ok(())
}

#[test]
fn the_command_line_is_read() -> Result<()> {
    let files: Vec<_> = imports("server/src")?.into_iter().flat_map(|graph| graph.files).collect();
    ensure!(files.iter().filter(|file| file.starts_with("cli/")).count() > 2, "{files:?}");
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
