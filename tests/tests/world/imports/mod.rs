//! Imports between the files of each package run one way: no circle between files of different folders, and none of more than two files within a folder.
//! The folders of the renderer import only from those before them.

mod circles;
mod modules;
mod parse;

use std::path::Path;

use anyhow::{Result, ensure};

use circles::{Graph, circles};
use modules::Modules;

/// Source folders of the packages.
pub(super) const PACKAGES: [&str; 7] =
    ["shared/src", "shared/vehicles/src", "server/src", "server/charts/src", "server/wind/src", "client-wasm/src", "tests/src"];

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

/// Folders of the renderer, each importing only from itself and those before it. Files beside them import from all.
const RENDER_FOLDERS: [&str; 6] = ["gpu", "options", "inputs", "land_and_sky", "solids", "plants"];

/// Imports of the renderer against the order of its folders.
fn backward_imports(graph: &Graph) -> Vec<String> {
    let rank = |file: usize| {
        let path = graph.files[file].strip_prefix("render/")?;
        let folder = path.split_once('/').map(|(folder, _)| folder);
        Some(RENDER_FOLDERS.iter().position(|other| folder == Some(*other)).unwrap_or(RENDER_FOLDERS.len()))
    };
    let arrows = graph.arrows.iter().enumerate().flat_map(|(from, to)| to.iter().map(move |to| (from, *to)));
    let backward = arrows.filter(|(from, to)| rank(*from).zip(rank(*to)).is_some_and(|(from, to)| from < to));
    backward.map(|(from, to)| format!("{} imports {}", graph.files[from], graph.files[to])).collect()
}

#[test]
fn imports_of_the_renderer_run_one_way() -> Result<()> {
    let graphs = imports("client-wasm/src")?;
    let files: Vec<_> = graphs.iter().flat_map(|graph| &graph.files).collect();
    for folder in RENDER_FOLDERS {
        ensure!(files.iter().any(|file| file.starts_with(&format!("render/{folder}/"))), "no file in render/{folder}");
    }
    assert_eq!(graphs.iter().flat_map(backward_imports).collect::<Vec<_>>(), Vec::<String>::new());
    Ok(())
}

#[test]
fn backward_imports_of_the_renderer_are_found() {
    let sources = [
        ("lib.rs", "mod render;\npub struct Camera;"),
        ("render/mod.rs", "mod frame;\nmod gpu;\nmod plants;\npub use gpu::Gpu;"),
        ("render/frame.rs", "use super::plants::Blades;\npub struct Frame(Blades);"),
        ("render/gpu/mod.rs", "use crate::Camera;\npub struct Gpu;\nimpl Gpu { fn draw(&self, _: &super::plants::Blades) {} }"),
        ("render/plants/mod.rs", "use crate::render::Gpu;\npub struct Blades(Gpu);\nfn plan() -> crate::render::frame::Frame {}"),
    ];
    let expected = ["render/gpu/mod.rs imports render/plants/mod.rs", "render/plants/mod.rs imports render/frame.rs"];
    assert_eq!(backward_imports(&graph_of(&sources)), expected);
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
