//! A client built before, from the folder that `PRAIRIE_CLIENT` names.

use std::fs;
use std::path::Path;

/// Files without which there is no page; those that `index.html` names are looked for, too.
const REQUIRED: [&str; 3] = ["index.html", "prairie_client.js", "prairie_client_bg.wasm"];

/// Copies the files of a client built before from `folder` to `out`.
///
/// # Errors
/// When the folder cannot be read, lacks a file of the page, or holds a folder; the message names both.
pub(crate) fn copy(folder: &Path, out: &Path) -> Result<(), String> {
    let names = file_names(folder)?;
    let lacks = |name: &str| !names.iter().any(|present| present == name);
    if let Some(missing) = REQUIRED.into_iter().find(|name| lacks(name)) {
        return Err(format!(
            "PRAIRIE_CLIENT: the folder {} has no {missing}; allowed: `skip`, or a folder with a client built before",
            folder.display()
        ));
    }
    let index = folder.join("index.html");
    let page = fs::read_to_string(&index).map_err(|e| format!("PRAIRIE_CLIENT: {}: {e}", index.display()))?;
    if let Some(missing) = references(&page).find(|name| lacks(name)) {
        return Err(format!("PRAIRIE_CLIENT: the folder {} has no {missing}, which its index.html names", folder.display()));
    }
    for name in &names {
        fs::copy(folder.join(name), out.join(name)).map_err(|e| format!("PRAIRIE_CLIENT: {}: {e}", folder.join(name).display()))?;
    }
    Ok(())
}

fn file_names(folder: &Path) -> Result<Vec<String>, String> {
    let failed = |e: std::io::Error| {
        format!("PRAIRIE_CLIENT: the folder {}: {e}; allowed: `skip`, or a folder with a client built before", folder.display())
    };
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let name = entry.file_name().into_string().map_err(|name| format!("PRAIRIE_CLIENT: {}: not a UTF-8 file name", name.display()))?;
        if !fs::metadata(entry.path()).map_err(failed)?.is_file() {
            return Err(format!("PRAIRIE_CLIENT: the folder {} holds {name}, which is not a file of a client", folder.display()));
        }
        names.push(name);
    }
    Ok(names)
}

/// Files beside a page that its `href` and `src` attributes name.
fn references(page: &str) -> impl Iterator<Item = &str> {
    let values = page.split([' ', '\n']).filter_map(|word| word.strip_prefix("href=\"").or_else(|| word.strip_prefix("src=\"")));
    values.filter_map(|rest| rest.split('"').next()).filter(|name| !name.is_empty() && !name.contains([':', '#', '?', '/']))
}
