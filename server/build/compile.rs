//! Compiles the client for the browser with a nested cargo.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

use wasm_bindgen_cli_support::Bindgen;

use crate::{Result, variable};

const TARGET: &str = "wasm32-unknown-unknown";

/// Cargo profiles of the client, defined in the workspace's Cargo.toml: quick to build, and for distributed binaries.
const PROFILE: &str = "wasm";
const DIST_PROFILE: &str = "wasm-dist";

/// Prefixes of environment variables that describe the server's build and must not reach the client's.
const SERVER_BUILD_PREFIXES: [&str; 8] = [
    "CARGO_BUILD_",
    "CARGO_CFG_",
    "CARGO_ENCODED_RUSTFLAGS",
    "CARGO_FEATURE_",
    "CARGO_PROFILE_",
    "CARGO_TARGET_",
    "RUSTC_WORKSPACE_WRAPPER",
    "RUSTFLAGS",
];

/// Compiles the package `prairie-client` and writes `prairie_client.js` and `prairie_client_bg.wasm` to `out`.
///
/// # Errors
/// Installation instructions when the wasm target is missing; otherwise the message of cargo or wasm-bindgen.
pub(crate) fn client(workspace: &Path, target_dir: &Path, out: &Path) -> Result<()> {
    ensure_target()?;
    let profile = if is_dist(target_dir) { DIST_PROFILE } else { PROFILE };
    let mut cargo = Command::new(variable("CARGO")?);
    for (name, _) in env::vars_os() {
        if name.to_str().is_some_and(|name| SERVER_BUILD_PREFIXES.iter().any(|prefix| name.starts_with(prefix))) {
            cargo.env_remove(name);
        }
    }
    cargo
        .current_dir(workspace)
        .env("CARGO_ENCODED_RUSTFLAGS", "-Ctarget-feature=+simd128")
        .args(["build", "--package", "prairie-client", "--lib", "--profile", profile, "--target", TARGET])
        .arg("--target-dir")
        .arg(target_dir);
    let status = cargo.status().map_err(|e| format!("cargo did not start: {e}"))?;
    if !status.success() {
        return Err(
            "the browser client did not compile (see cargo's messages above); PRAIRIE_CLIENT=skip builds the server without it".into()
        );
    }
    bind(&target_dir.join(TARGET).join(profile).join("prairie_client.wasm"), out)
}

/// Target directory of the client, beside the server's artifacts. All variants of the server (with and without rerun, check, test, clippy)
/// share it, and the nested cargo does not wait for the lock of the outer one.
pub(crate) fn target_dir(out: &Path) -> PathBuf {
    let profile_dir = out.ancestors().find(|dir| dir.ends_with("build")).and_then(Path::parent);
    profile_dir.unwrap_or(out).join("client")
}

/// Whether a target directory belongs to a distributed binary, for which a slow build is worth a small client.
pub(crate) fn is_dist(target_dir: &Path) -> bool {
    target_dir.parent().is_some_and(|dir| dir.ends_with("dist"))
}

fn bind(wasm: &Path, out: &Path) -> Result<()> {
    let bound = Bindgen::new().input_path(wasm).web(true).and_then(|bindgen| bindgen.typescript(false).generate(out));
    bound.map_err(|e| format!("wasm-bindgen on {}: {e:#}", wasm.display()))
}

fn ensure_target() -> Result<()> {
    if target_installed()? || (rustup_adds_target() && target_installed()?) {
        return Ok(());
    }
    Err(format!(
        "The browser client needs the Rust target {TARGET}, which this toolchain lacks. Install it with\n    rustup target add {TARGET}\n\
         or, without rustup, from the distributor of your Rust. PRAIRIE_CLIENT=skip builds the server without the page."
    ))
}

fn target_installed() -> Result<bool> {
    let rustc = variable("RUSTC")?;
    let printed = Command::new(&rustc).args(["--print", "target-libdir", "--target", TARGET]).output();
    let printed = printed.map_err(|e| format!("{rustc} did not start: {e}"))?;
    Ok(printed.status.success() && Path::new(String::from_utf8_lossy(&printed.stdout).trim()).is_dir())
}

fn rustup_adds_target() -> bool {
    Command::new("rustup").args(["target", "add", TARGET]).status().is_ok_and(|status| status.success())
}
