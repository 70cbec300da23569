//! Which crate may depend on which, and which file may name which library.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, ensure};

const BROWSER: &[&str] = &["--target", "wasm32-unknown-unknown"];

fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("tests lies in the workspace")
}

/// Names of all packages that a package is built from, itself included.
fn dependencies(package: &str, options: &[&str]) -> Result<Vec<String>> {
    let mut tree = Command::new(env!("CARGO"));
    tree.current_dir(workspace()).args(["tree", "--locked", "--package", package, "--edges", "normal,build"]);
    let output = tree.args(["--prefix", "none", "--format", "{p}"]).args(options).output().context("cargo did not start")?;
    ensure!(output.status.success(), "cargo tree of {package}: {}", String::from_utf8_lossy(&output.stderr));
    let printed = String::from_utf8(output.stdout)?;
    Ok(printed.lines().filter_map(|line| line.split(' ').next()).map(String::from).collect())
}

#[track_caller]
fn assert_free_of(package: &str, dependencies: &[String], forbidden: &[&str]) {
    assert!(dependencies.iter().any(|name| name == package), "{package} is not in its own tree: {dependencies:?}");
    for name in forbidden {
        assert!(!dependencies.iter().any(|dependency| dependency == name), "{package} depends on {name}");
    }
}

#[test]
fn shared_is_pure() -> Result<()> {
    for options in [&[], BROWSER] {
        let forbidden = ["server", "client-wasm", "tests", "tokio", "axum", "wgpu", "rerun", "wasm-bindgen"];
        assert_free_of("shared", &dependencies("shared", options)?, &forbidden);
    }
    Ok(())
}

#[test]
fn server_and_client_never_see_each_other() -> Result<()> {
    assert_free_of("server", &dependencies("server", &[])?, &["client-wasm", "wgpu-core"]);
    for options in [&[], BROWSER] {
        assert_free_of("client-wasm", &dependencies("client-wasm", options)?, &["server", "tests", "tokio", "axum", "rerun"]);
    }
    Ok(())
}

#[test]
fn tests_see_all() -> Result<()> {
    let all = dependencies("tests", &[])?;
    for name in ["shared", "server", "client-wasm"] {
        assert!(all.iter().any(|dependency| dependency == name), "tests does not depend on {name}");
    }
    Ok(())
}

fn rust_files(dir: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    for entry in fs::read_dir(dir).with_context(|| dir.display().to_string())? {
        let path = entry?.path();
        if path.is_dir() {
            rust_files(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    Ok(())
}

/// Whether Rust source reaches into a crate by its name, outside of comments.
fn names(source: &str, library: &str) -> bool {
    let path = format!("{library}::");
    source.lines().map(|line| line.split("//").next().unwrap_or(line)).any(|line| {
        let reached =
            line.match_indices(&path).any(|(start, _)| !line[..start].ends_with(|c: char| c.is_alphanumeric() || "_:".contains(c)));
        reached || line.trim_start().starts_with(&format!("use {library};")) || line.contains(&format!("use {library} as "))
    })
}

/// Files of the product that name a library, as paths below the workspace.
fn files_naming(library: &str) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for package in ["shared/src", "server/src", "client-wasm/src"] {
        rust_files(&workspace().join(package), &mut files)?;
    }
    let mut found = Vec::new();
    for file in files {
        if names(&fs::read_to_string(&file)?, library) {
            found.push(file.strip_prefix(workspace())?.to_path_buf());
        }
    }
    Ok(found)
}

#[test]
fn only_net_names_axum() -> Result<()> {
    for file in files_naming("axum")? {
        assert!(file.starts_with("server/src/net"), "{} names axum", file.display());
    }
    Ok(())
}

#[test]
fn only_inspect_names_rerun() -> Result<()> {
    for file in files_naming("rerun")? {
        let inspect = file == Path::new("server/src/inspect.rs") || file.starts_with("server/src/inspect");
        assert!(inspect, "{} names rerun", file.display());
    }
    Ok(())
}

#[test]
fn naming_a_library_is_seen() {
    for source in ["use rerun::Vec3D;", "let x = rerun::init();", "use rerun;", "pub use rerun as viewer;", "Vec<rerun::Color>"] {
        assert!(names(source, "rerun"), "{source}");
    }
    for source in ["/// `rerun::Vec3D`", "crate::rerun::start()", "my_rerun::x", "#[cfg(feature = \"rerun\")]", "rerun: Option<Rerun>"] {
        assert!(!names(source, "rerun"), "{source}");
    }
}
