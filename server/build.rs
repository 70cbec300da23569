//! Builds the browser client and embeds it, so that `cargo run` is the only command needed.
//!
//! The files of `client-wasm/web`, the compiled client and its JavaScript bindings go to `OUT_DIR/page`, and from there, named after their
//! contents and compressed, to `OUT_DIR/client`. `OUT_DIR/client.rs` is the table of these files that `src/net/assets.rs` includes. A copy of
//! the files before that stays in `target/PROFILE/client/page`.
//!
//! The page of charts is put together from `charts/page` and the measured data in `charts/results`.
//!
//! `PRAIRIE_CLIENT=skip` builds no client and embeds a placeholder page; `PRAIRIE_CLIENT=FOLDER` embeds a client built before, such as that
//! copy. A relative folder starts at the workspace. The server of docs.rs, which has no wasm target, gets the placeholder.

#[path = "build/charts.rs"]
mod charts;
#[path = "build/commit.rs"]
mod commit;
#[path = "build/compile.rs"]
mod compile;
#[path = "build/embed.rs"]
mod embed;
#[path = "build/fingerprint.rs"]
mod fingerprint;
#[path = "build/inline.rs"]
mod inline;
#[path = "build/prebuilt.rs"]
mod prebuilt;

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
    let (page, client, target_dir) = (out.join("page"), out.join("client"), compile::target_dir(&out));
    let workspace = server.parent().ok_or("the server package is outside its workspace")?;
    commit::locate(workspace, &out)?;
    clear(&page)?;
    clear(&client)?;

    let choice = env::var("PRAIRIE_CLIENT").unwrap_or_default();
    match choice.as_str() {
        "" if env::var_os("DOCS_RS").is_none() => build_client(workspace, &target_dir, &page)?,
        "" | "skip" => {
            println!("cargo::rerun-if-changed=build");
            copy(&server.join("build/without_client.html"), &page.join("index.html"))?;
            copy(&server.join("build/without_client.css"), &page.join("without_client.css"))?;
        }
        folder => {
            let folder = workspace.join(folder);
            println!("cargo::rerun-if-changed={}", folder.display());
            prebuilt::copy(&folder, &page)?;
        }
    }
    charts::write(&server.join("charts"), &page)?;
    embed::write_table(&embed::read(&page)?, &client, &out.join("client.rs"), compile::is_dist(&target_dir))
}

fn build_client(workspace: &Path, target_dir: &Path, page: &Path) -> Result<()> {
    let web = workspace.join("client-wasm/web");
    if !web.is_dir() {
        return Err(format!(
            "{}: the sources of the browser client are missing, since this package lies outside its workspace. PRAIRIE_CLIENT=FOLDER embeds a \
             client built before, PRAIRIE_CLIENT=skip builds the server without the page.",
            web.display()
        ));
    }
    watch(workspace);
    compile::client(workspace, target_dir, page)?;
    copy_files(&web, page)?;
    let kept = target_dir.join("page");
    clear(&kept)?;
    copy_files(page, &kept)
}

/// Reruns the build when a source of the client changes.
fn watch(workspace: &Path) {
    for source in ["client-wasm", "shared/src", "shared/Cargo.toml", "shared/vehicles", "Cargo.toml", "Cargo.lock", "server/build"] {
        println!("cargo::rerun-if-changed={}", workspace.join(source).display());
    }
}

fn copy_files(from: &Path, to: &Path) -> Result<()> {
    for entry in fs::read_dir(from).map_err(|e| format!("{}: {e}", from.display()))? {
        let file = entry.map_err(|e| format!("{}: {e}", from.display()))?;
        copy(&file.path(), &to.join(file.file_name()))?;
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
