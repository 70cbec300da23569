//! Names the files of the page after their contents, so that browsers may keep them forever.
//!
//! `panel.js` becomes `panel.0123456789abcdef.js`, and every reference to it in another file is rewritten before that file is named itself.

use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};

/// The file that keeps its name: browsers ask for it first, and it names all others.
const ROOT: &str = "index.html";

/// The page of charts, which people open by its name. Everything that it needs is in it.
const CHARTS: &str = "charts.html";

/// Extensions of the files that refer to others.
const TEXTS: [&str; 5] = ["css", "html", "js", "svg", "webmanifest"];

/// Extensions that make a quoted word a reference.
const EXTENSIONS: [&str; 9] = ["css", "html", "js", "mp3", "ogg", "png", "svg", "wasm", "webmanifest"];

/// Text before and after a reference.
const QUOTES: [(&str, &str); 3] = [("\"", "\""), ("'", "'"), ("url(", ")")];

/// Text before the quotes of a file that is loaded.
const LOADS: [&str; 7] = ["from ", "import ", "import(", "fetch(", "src=", "href=", "\"src\": "];

/// Files by name.
pub(crate) type Files = BTreeMap<String, Vec<u8>>;

/// The same files with a hash of their contents in their names and in the references to them. `index.html` and `charts.html` keep their names.
///
/// # Errors
/// When a file refers to one that does not exist, is not UTF-8 although its extension says that it is text, or refers to itself through others.
pub(crate) fn fingerprinted(files: &Files) -> Result<Files, String> {
    let mut names = BTreeMap::new();
    let mut done = Files::new();
    for name in files.keys() {
        finish(name, files, &mut Vec::new(), &mut names, &mut done)?;
    }
    Ok(done)
}

/// Hash of a file's contents, 16 hexadecimal digits.
pub(crate) fn hash(bytes: &[u8]) -> String {
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    format!("{:016x}", hasher.finish())
}

/// Renames a file after its contents, once the files to which it refers have been renamed and its references updated. `open` are the files being finished.
fn finish<'a>(
    name: &'a str,
    files: &'a Files,
    open: &mut Vec<&'a str>,
    names: &mut BTreeMap<&'a str, String>,
    done: &mut Files,
) -> Result<(), String> {
    if names.contains_key(name) {
        return Ok(());
    }
    if open.contains(&name) {
        return Err(format!(
            "client-wasm/web: {} and {name} refer to each other, so neither can be named after its contents",
            open.join(", ")
        ));
    }
    open.push(name);
    let mut bytes = files[name].clone();
    if TEXTS.contains(&extension(name)) && name != CHARTS {
        let mut text = String::from_utf8(bytes).map_err(|_| format!("client-wasm/web/{name}: not UTF-8"))?;
        for (reference, is_loaded) in references(&text) {
            let target = match files.get_key_value(reference.trim_start_matches("./")) {
                Some((target, _)) => target,
                None if is_loaded => return Err(format!("client-wasm/web/{name} refers to `{reference}`, which does not exist")),
                None => continue,
            };
            finish(target, files, open, names, done)?;
            let new = reference.replace(target.as_str(), &names[target.as_str()]);
            for (before, after) in QUOTES {
                text = text.replace(&format!("{before}{reference}{after}"), &format!("{before}{new}{after}"));
            }
        }
        bytes = text.into_bytes();
    }
    open.pop();
    let new = match name.rsplit_once('.') {
        Some((stem, extension)) if name != ROOT && name != CHARTS => format!("{stem}.{}.{extension}", hash(&bytes)),
        _ => name.to_owned(),
    };
    done.insert(new.clone(), bytes);
    names.insert(name, new);
    Ok(())
}

fn extension(name: &str) -> &str {
    name.rsplit_once('.').map_or("", |(_, extension)| extension)
}

/// Quoted words that look like the name of a file in the same folder, and whether the file must exist. WebAssembly bindings name their imports after a
/// file that does not exist.
fn references(text: &str) -> BTreeMap<String, bool> {
    let mut found = BTreeMap::new();
    for (before, after) in QUOTES {
        for (at, _) in text.match_indices(before) {
            let word = text[at + before.len()..].split_once(after).map(|(word, _)| word);
            if let Some(word) = word.filter(|word| is_file_name(word)) {
                *found.entry(word.to_owned()).or_insert(false) |= LOADS.iter().any(|load| text[..at].ends_with(load)) || before == "url(";
            }
        }
    }
    found
}

fn is_file_name(word: &str) -> bool {
    let name = word.strip_prefix("./").unwrap_or(word);
    let is_plain = name.chars().all(|char| char.is_ascii_alphanumeric() || "._-".contains(char));
    is_plain && name.rsplit_once('.').is_some_and(|(stem, extension)| !stem.is_empty() && EXTENSIONS.contains(&extension))
}
