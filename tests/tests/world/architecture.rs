//! Dependencies between the packages, and the only folders that use certain libraries.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, Result, ensure};

const BROWSER: &[&str] = &["--target", "wasm32-unknown-unknown"];

/// Root folder of the workspace.
pub(super) fn workspace() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("tests is a folder of the workspace")
}

/// Names of all packages in the dependency tree of a package, itself included.
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
fn what_server_and_client_share_is_pure() -> Result<()> {
    for options in [&[], BROWSER] {
        let forbidden = ["prairie", "prairie-client", "tests", "tokio", "axum", "wgpu", "rerun", "wasm-bindgen"];
        for package in ["prairie-core", "prairie-vehicles"] {
            assert_free_of(package, &dependencies(package, options)?, &forbidden);
        }
        assert_free_of("prairie-core", &dependencies("prairie-core", options)?, &["prairie-vehicles", "rapier3d"]);
    }
    Ok(())
}

#[test]
fn prairie_wind_depends_on_neither_server_nor_client() -> Result<()> {
    let forbidden = ["prairie", "prairie-client", "tests", "tokio", "axum", "wgpu", "rerun"];
    assert_free_of("prairie-wind", &dependencies("prairie-wind", &[])?, &forbidden);
    Ok(())
}

/// The build script of the server and the package of charts put the page together alike; a published package holds no files of another.
#[test]
fn both_copies_of_inline_rs_are_equal() -> Result<()> {
    let [of_build, of_charts] =
        ["server/build/inline.rs", "server/charts/src/inline.rs"].map(|file| fs::read_to_string(workspace().join(file)));
    assert_eq!(of_build?, of_charts?);
    Ok(())
}

#[test]
fn prairie_charts_knows_no_server() -> Result<()> {
    assert_free_of("prairie-charts", &dependencies("prairie-charts", &[])?, &["prairie", "tests", "tokio", "axum", "rerun"]);
    Ok(())
}

#[test]
#[should_panic(expected = "tests depends on prairie-client")]
fn a_forbidden_dependency_is_found() {
    assert_free_of("tests", &dependencies("tests", &[]).expect("cargo tree"), &["prairie-client"]);
}

#[test]
fn server_and_client_never_depend_on_each_other() -> Result<()> {
    // But for the features `picture`, which draws without a browser, and `charts`, which times the renderer.
    assert_free_of("prairie", &dependencies("prairie", &[])?, &["prairie-client", "wgpu-core"]);
    for options in [&[], BROWSER] {
        assert_free_of("prairie-client", &dependencies("prairie-client", options)?, &["prairie", "tests", "tokio", "axum", "rerun"]);
    }
    Ok(())
}

#[test]
fn the_library_does_without_what_only_the_program_uses() -> Result<()> {
    assert_free_of("prairie", &dependencies("prairie", &["--no-default-features"])?, &["clap", "open", "anstream", "tracing-subscriber"]);
    Ok(())
}

#[test]
fn tests_depend_on_every_package() -> Result<()> {
    let all = dependencies("tests", &[])?;
    for name in ["prairie-core", "prairie-vehicles", "prairie", "prairie-charts", "prairie-wind", "prairie-client"] {
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

/// Whether Rust source uses a library by its name, outside of comments.
fn uses(source: &str, library: &str) -> bool {
    let path = format!("{library}::");
    source.lines().map(|line| line.split("//").next().unwrap_or(line)).any(|line| {
        let reached =
            line.match_indices(&path).any(|(start, _)| !line[..start].ends_with(|c: char| c.is_alphanumeric() || "_:".contains(c)));
        reached || line.trim_start().starts_with(&format!("use {library};")) || line.contains(&format!("use {library} as "))
    })
}

/// Source files of the product that use a library, as paths below the workspace.
fn files_using(library: &str) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for package in ["shared/src", "shared/vehicles/src", "server/src", "server/charts/src", "server/wind/src", "client-wasm/src"] {
        rust_files(&workspace().join(package), &mut files)?;
    }
    let mut found = Vec::new();
    for file in files {
        if uses(&fs::read_to_string(&file)?, library) {
            found.push(file.strip_prefix(workspace())?.to_path_buf());
        }
    }
    Ok(found)
}

#[test]
fn only_net_uses_axum() -> Result<()> {
    for file in files_using("axum")? {
        assert!(file.starts_with("server/src/net"), "{} uses axum", file.display());
    }
    Ok(())
}

#[test]
fn only_inspect_uses_rerun() -> Result<()> {
    for file in files_using("rerun")? {
        assert!(file.starts_with("server/src/inspect"), "{} uses rerun", file.display());
    }
    Ok(())
}

#[test]
fn only_output_uses_zarrs() -> Result<()> {
    let files = files_using("zarrs")?;
    ensure!(!files.is_empty(), "no file uses zarrs");
    for file in files {
        assert!(file.starts_with("server/src/output"), "{} uses zarrs", file.display());
    }
    Ok(())
}

#[test]
fn only_the_studio_the_charts_and_their_commands_use_the_renderer() -> Result<()> {
    let allowed = [
        "server/src/studio",
        "server/src/charts",
        "server/charts/src",
        "server/src/cli/shot.rs",
        "server/src/cli/picture.rs",
        "client-wasm/src",
    ];
    for file in files_using("prairie_client")? {
        assert!(allowed.iter().any(|place| file.starts_with(place)), "{} uses prairie_client", file.display());
    }
    Ok(())
}

#[test]
fn uses_of_a_library_are_found() {
    for source in ["use rerun::Vec3D;", "let x = rerun::init();", "use rerun;", "pub use rerun as viewer;", "Vec<rerun::Color>"] {
        assert!(uses(source, "rerun"), "{source}");
    }
    for source in ["/// `rerun::Vec3D`", "crate::rerun::start()", "my_rerun::x", "#[cfg(feature = \"rerun\")]", "rerun: Option<Rerun>"] {
        assert!(!uses(source, "rerun"), "{source}");
    }
}
