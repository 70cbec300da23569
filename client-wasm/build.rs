//! Links the WGSL files of each pass into `$OUT_DIR/shaders.rs`.

#[path = "build/link.rs"]
#[expect(dead_code, reason = "tests use the rest")]
mod link;

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use link::{Library, Piece};

fn main() -> ExitCode {
    println!("cargo::rerun-if-changed=shaders");
    println!("cargo::rerun-if-changed=build");
    match linked().and_then(|rust| write(&rust)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            println!("cargo::error={message}");
            ExitCode::FAILURE
        }
    }
}

fn write(rust: &str) -> Result<(), String> {
    let out = PathBuf::from(std::env::var_os("OUT_DIR").ok_or("cargo sets OUT_DIR")?).join("shaders.rs");
    std::fs::write(&out, rust).map_err(|error| format!("{}: {error}", out.display()))
}

/// Rust source of all passes: a static for each declaration that any of them needs, and a constant for each pass that lists its own.
fn linked() -> Result<String, String> {
    let library = Library::new(link::files(Path::new("shaders")).map_err(|error| format!("client-wasm/shaders: {error}"))?);
    let library = library.map_err(|error| format!("client-wasm/shaders/{error}"))?;
    let (mut declared, mut rust, mut list) = (BTreeMap::new(), String::new(), String::new());
    for pass in library.passes() {
        let mut pieces = String::new();
        for piece in library.link(pass).map_err(|error| format!("client-wasm/shaders/{error}"))? {
            match piece {
                Piece::Rust(module, name) => _ = write!(pieces, "{},", from_rust(module, name)),
                Piece::Wgsl(file, one) => {
                    let next = declared.len();
                    let number = *declared.entry((file, &one.name)).or_insert_with(|| {
                        _ = writeln!(
                            rust,
                            "static TEXT_{next}: Text = Text {{ file: {file:?}, line: {}, text: {:?} }};",
                            one.line, one.text
                        );
                        next
                    });
                    _ = write!(pieces, "Piece::Wgsl(&TEXT_{number}),");
                }
            }
        }
        let name = pass.rsplit('/').next().unwrap_or(pass).to_uppercase();
        _ = writeln!(
            rust,
            "#[doc = \"`{pass}.wgsl`.\"]\npub(crate) const {name}: Shader = Shader {{ file: {pass:?}, pieces: &[{pieces}] }};"
        );
        _ = write!(list, "{name},");
    }
    let overrides = library.0.values().flat_map(|file| &file.declarations).filter(|one| one.text.starts_with("override "));
    let overrides: Vec<_> = overrides.map(|one| one.name.as_str()).collect();
    _ = writeln!(rust, "/// Names of the overrides of all files.\nconst OVERRIDES: &[&str] = &{overrides:?};");
    _ = writeln!(rust, "/// All passes.\n#[cfg(test)]\npub(crate) const ALL: &[Shader] = &[{list}];");
    let imported: BTreeSet<_> = library.imports_from_rust().collect();
    let imported: String = imported.into_iter().map(|(module, name)| format!("({name:?}, {}),", from_rust(module, name))).collect();
    _ = writeln!(rust, "/// All that is imported from Rust, by name.\n#[cfg(test)]\nconst FROM_RUST: &[(&str, Piece)] = &[{imported}];");
    Ok(rust)
}

/// Rust source of a constant or a uniform block; the compiler reports names that do not exist.
fn from_rust(module: &str, name: &str) -> String {
    match module {
        "constants" => format!("Piece::Constant({name:?}, &constants::{name})"),
        _ => format!("Piece::Block(&{module}::{name}::BLOCK)"),
    }
}
