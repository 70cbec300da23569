//! Writes the table of embedded files: content type, bytes, compressed copies, hash.

use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::Path;

use brotli::enc::BrotliEncoderParams;
use flate2::{Compression, write::GzEncoder};

use crate::Result;
use crate::fingerprint::{Files, fingerprinted, hash};

/// Quality of the brotli encoder, 0 to 11. The highest makes the client 10 % smaller and takes ten times as long; it is used for distributed binaries
/// only.
const BROTLI_QUALITY: i32 = 9;
const DIST_BROTLI_QUALITY: i32 = 11;

/// Reads the files of a folder.
///
/// # Errors
/// When one cannot be read, or its name is not UTF-8.
pub(crate) fn read(dir: &Path) -> Result<Files> {
    let mut files = Files::new();
    for entry in fs::read_dir(dir).map_err(|e| format!("{}: {e}", dir.display()))? {
        let path = entry.map_err(|e| format!("{}: {e}", dir.display()))?.path();
        let name = path.file_name().and_then(|name| name.to_str()).ok_or_else(|| format!("{}: not a UTF-8 file name", path.display()))?;
        files.insert(name.to_owned(), fs::read(&path).map_err(|e| format!("{}: {e}", path.display()))?);
    }
    Ok(files)
}

/// Writes files named after their contents to `dir`, with compressed copies beside them, and to `table` a Rust slice of `(path, Asset)`, sorted by path.
///
/// # Errors
/// When a file cannot be written, its extension has no content type here, or it refers to a file that does not exist.
pub(crate) fn write_table(files: &Files, dir: &Path, table: &Path, is_dist: bool) -> Result<()> {
    let quality = if is_dist { DIST_BROTLI_QUALITY } else { BROTLI_QUALITY };
    let mut rust = String::from("&[\n");
    for (name, bytes) in fingerprinted(files)? {
        write(&dir.join(&name), &bytes)?;
        let [brotli, gzip] = [("br", brotli(&bytes, quality)), ("gz", gzip(&bytes))].map(|(ending, packed)| {
            let packed = packed.map_err(|e| format!("compressing {name}: {e}"))?;
            // Pictures are compressed already.
            if packed.len() >= bytes.len() {
                return Ok("None".to_owned());
            }
            write(&dir.join(format!("{name}.{ending}")), &packed)?;
            Ok::<_, String>(format!("Some({})", included(&format!("{name}.{ending}"))))
        });
        let row = format!(
            "    ({name:?}, Asset {{ content_type: {:?}, is_immutable: {}, bytes: {}, brotli: {}, gzip: {}, hash: {:?} }}),",
            content_type(&name)?,
            !files.contains_key(&name),
            included(&name),
            brotli?,
            gzip?,
            hash(&bytes),
        );
        writeln!(rust, "{row}").map_err(|e| e.to_string())?;
    }
    rust.push_str("]\n");
    write(table, rust.as_bytes())
}

fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    fs::write(path, bytes).map_err(|e| format!("{}: {e}", path.display()))
}

fn included(name: &str) -> String {
    format!("include_bytes!(concat!(env!(\"OUT_DIR\"), \"/client/{name}\"))")
}

fn gzip(bytes: &[u8]) -> std::io::Result<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(bytes)?;
    encoder.finish()
}

fn brotli(bytes: &[u8], quality: i32) -> std::io::Result<Vec<u8>> {
    let mut packed = Vec::new();
    let options = BrotliEncoderParams { quality, size_hint: bytes.len(), ..BrotliEncoderParams::default() };
    brotli::BrotliCompress(&mut &*bytes, &mut packed, &options)?;
    Ok(packed)
}

fn content_type(name: &str) -> Result<&'static str> {
    match name.rsplit_once('.').map(|(_, extension)| extension) {
        Some("css") => Ok("text/css; charset=utf-8"),
        Some("html") => Ok("text/html; charset=utf-8"),
        Some("js") => Ok("text/javascript; charset=utf-8"),
        Some("png") => Ok("image/png"),
        Some("svg") => Ok("image/svg+xml"),
        Some("wasm") => Ok("application/wasm"),
        Some("webmanifest") => Ok("application/manifest+json"),
        _ => Err(format!("client-wasm/web/{name}: this file has no known content type; add one in server/build/embed.rs")),
    }
}
