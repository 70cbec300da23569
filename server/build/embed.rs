//! Writes the table of embedded files: content type, bytes, gzip, entity tag.

use std::fmt::Write as _;
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Write as _;
use std::path::Path;

use flate2::{Compression, write::GzEncoder};

use crate::Result;

/// Writes to `table` a Rust slice of `(path, Asset)` for every file in `dir`, sorted by path, and a gzip-compressed copy beside each file.
///
/// # Errors
/// When a file cannot be read, or its extension has no content type here.
pub(crate) fn write_table(dir: &Path, table: &Path) -> Result<()> {
    let mut names = Vec::new();
    for entry in fs::read_dir(dir).map_err(|e| format!("{}: {e}", dir.display()))? {
        let name = entry.map_err(|e| format!("{}: {e}", dir.display()))?.file_name();
        names.push(name.into_string().map_err(|name| format!("{}: not a UTF-8 file name", name.display()))?);
    }
    names.sort();

    let mut rust = String::from("&[\n");
    for name in &names {
        let path = dir.join(name);
        let bytes = fs::read(&path).map_err(|e| format!("{}: {e}", path.display()))?;
        let zipped = dir.join(format!("{name}.gz"));
        gzip(&bytes).and_then(|gzip| fs::write(&zipped, gzip)).map_err(|e| format!("{}: {e}", zipped.display()))?;
        let row = format!(
            "    ({name:?}, Asset {{ content_type: {:?}, bytes: {}, gzip: {}, etag: {:?} }}),",
            content_type(name)?,
            included(name),
            included(&format!("{name}.gz")),
            etag(&bytes),
        );
        writeln!(rust, "{row}").map_err(|e| e.to_string())?;
    }
    rust.push_str("]\n");
    fs::write(table, rust).map_err(|e| format!("{}: {e}", table.display()))
}

fn included(name: &str) -> String {
    format!("include_bytes!(concat!(env!(\"OUT_DIR\"), \"/client/{name}\"))")
}

fn gzip(bytes: &[u8]) -> std::io::Result<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes)?;
    encoder.finish()
}

fn etag(bytes: &[u8]) -> String {
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    format!("\"{:016x}\"", hasher.finish())
}

fn content_type(name: &str) -> Result<&'static str> {
    match name.rsplit_once('.').map(|(_, extension)| extension) {
        Some("css") => Ok("text/css; charset=utf-8"),
        Some("html") => Ok("text/html; charset=utf-8"),
        Some("js") => Ok("text/javascript; charset=utf-8"),
        Some("png") => Ok("image/png"),
        Some("svg") => Ok("image/svg+xml"),
        Some("wasm") => Ok("application/wasm"),
        _ => Err(format!("client-wasm/web/{name}: this file has no known content type; add one in server/build/embed.rs")),
    }
}
