//! Builds the browser client and embeds it, so that `cargo run` is the only command needed.
//!
//! The files of `client-wasm/web`, the compiled client and its JavaScript bindings go to `OUT_DIR/client`. `OUT_DIR/client.rs` is the
//! table of these files that `src/net/assets.rs` includes. `PRAIRIE_CLIENT=skip` builds no client and embeds a placeholder page.

#[path = "build/commit.rs"]
mod commit;
#[path = "build/compile.rs"]
mod compile;
#[path = "build/embed.rs"]
mod embed;

use std::path::{Path, PathBuf};
use std::{env, fs, process};

type Result<T> = std::result::Result<T, String>;

fn main() {
    println!("cargo::rerun-if-env-changed=PRAIRIE_CLIENT");
    if let Err(error) = build() {
        for line in error.lines() {
            println!("cargo::error={line}");
        }
        process::exit(1);
    }
}

fn build() -> Result<()> {
    let server = PathBuf::from(variable("CARGO_MANIFEST_DIR")?);
    let out = PathBuf::from(variable("OUT_DIR")?);
    let client = out.join("client");
    let workspace = server.parent().ok_or("the server package is outside its workspace")?;
    commit::locate(workspace, &out)?;
    clear(&client)?;

    match env::var("PRAIRIE_CLIENT").unwrap_or_default().as_str() {
        "skip" => copy(&server.join("build/without_client.html"), &client.join("index.html"))?,
        "" => {
            watch(workspace);
            compile::client(workspace, &compile::target_dir(&out), &client)?;
            copy_pages(&workspace.join("client-wasm/web"), &client)?;
        }
        other => return Err(format!("PRAIRIE_CLIENT is `{other}`; allowed: `skip`, or unset to build the client")),
    }
    embed::write_table(&client, &out.join("client.rs"))
}

/// Reruns the build when a source of the client changes.
fn watch(workspace: &Path) {
    for source in ["client-wasm", "shared/src", "shared/Cargo.toml", "Cargo.toml", "Cargo.lock", "server/build"] {
        println!("cargo::rerun-if-changed={}", workspace.join(source).display());
    }
}

fn copy_pages(web: &Path, client: &Path) -> Result<()> {
    for entry in fs::read_dir(web).map_err(|e| format!("{}: {e}", web.display()))? {
        let page = entry.map_err(|e| format!("{}: {e}", web.display()))?;
        copy(&page.path(), &client.join(page.file_name()))?;
    }
    Ok(())
}

fn clear(dir: &Path) -> Result<()> {
    if dir.exists() {
        fs::remove_dir_all(dir).map_err(|e| format!("{}: {e}", dir.display()))?;
    }
    fs::create_dir_all(dir).map_err(|e| format!("{}: {e}", dir.display()))
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    fs::copy(from, to).map(drop).map_err(|e| format!("copying {} to {}: {e}", from.display(), to.display()))
}

fn variable(name: &str) -> Result<String> {
    env::var(name).map_err(|e| format!("{name}: {e}"))
}
