//! Lengths of functions, which are meant to be read at a glance: those of the packages, of their examples and of the shaders.

use std::path::Path;

use anyhow::{Result, ensure};

use super::architecture::workspace;
use super::imports::PACKAGES;
use super::pictures::files;

/// Maximum number of lines of a function, from its name to its closing brace.
const LIMIT: usize = 60;

/// Folders of functions beside the packages' sources, each with a number that it exceeds, so that no folder is read in vain.
const FOLDERS: [(&str, usize); 5] = [
    ("client-wasm/shaders", 200),
    ("client-wasm/examples", 0),
    ("server/examples", 2),
    ("server/wind/examples", 1),
    ("shared/examples", 1),
];

/// Functions of a file of Rust formatted by rustfmt, or of WGSL, with their first line and their number of lines. Those in the module `tests` at its end are left out.
fn functions(text: &str) -> Vec<(&str, usize, usize)> {
    let product = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
    let lines: Vec<_> = product.lines().collect();
    let is_function = |line: &str| {
        let before = line.split("fn ").next().unwrap_or_default();
        line.contains("fn ")
            && before.split_whitespace().all(|word| ["const", "async", "unsafe"].contains(&word) || word.starts_with("pub"))
    };
    let starts = (0..lines.len()).filter(|&at| is_function(lines[at]));
    starts
        .filter_map(|at| {
            let indent = &lines[at][..lines[at].len() - lines[at].trim_start().len()];
            let end = format!("{indent}}}");
            let opens = lines[at..].iter().position(|line| line.ends_with(['{', ';', '}']))?;
            let count = if lines[at + opens].ends_with('{') { 1 + lines[at..].iter().position(|line| *line == end)? } else { 1 + opens };
            Some((lines[at].trim(), at + 1, count))
        })
        .collect()
}

/// Functions below a folder that are too long, and the number of all.
fn too_long(dir: &Path) -> Result<(Vec<String>, usize)> {
    let (mut sources, mut found, mut count) = (Vec::new(), Vec::new(), 0);
    files(dir, &["rs", "wgsl"], &mut sources)?;
    let is_test = |path: &Path| path.components().any(|part| part.as_os_str().to_string_lossy().starts_with("tests"));
    for (path, _) in sources.into_iter().filter(|(path, _)| !path.strip_prefix(dir).is_ok_and(is_test)) {
        let text = std::fs::read_to_string(&path)?;
        let all = functions(&text);
        count += all.len();
        let long = all.into_iter().filter(|(.., lines)| *lines > LIMIT);
        found.extend(long.map(|(name, line, lines)| format!("{}:{line}: {lines} lines: {name}", path.display())));
    }
    Ok((found, count))
}

#[test]
fn functions_are_short() -> Result<()> {
    let mut found = Vec::new();
    for (folder, exceeded) in PACKAGES.map(|package| (package, 50)).into_iter().chain(FOLDERS) {
        let (long, count) = too_long(&workspace().join(folder))?;
        ensure!(count > exceeded, "{folder}: only {count} functions were found");
        found.extend(long);
    }
    ensure!(found.is_empty(), "functions of more than {LIMIT} lines:\n{}", found.join("\n"));
    Ok(())
}

#[test]
fn a_long_function_is_found() -> Result<()> {
    let dir = tempfile::tempdir()?;
    let source = |lines: usize| {
        format!(
            "trait Draw {{\n    fn draw(&self);\n}}\nimpl Draw for () {{\n    fn draw(\n        &self,\n    ) {{\n{}    }}\n}}\nfn short() {{}}\n",
            "        next();\n".repeat(lines)
        )
    };
    for (body, expected) in [(LIMIT - 4, 0), (LIMIT - 3, 1)] {
        std::fs::write(dir.path().join("draw.rs"), source(body))?;
        let (found, count) = too_long(dir.path())?;
        assert_eq!((found.len(), count), (expected, 3), "{found:?}");
    }
    let shader = |lines: usize| format!("@vertex\nfn vs() -> Corner {{\n{}}}\n", "    next();\n".repeat(lines));
    std::fs::remove_file(dir.path().join("draw.rs"))?;
    for (body, expected) in [(LIMIT - 2, 0), (LIMIT - 1, 1)] {
        std::fs::write(dir.path().join("draw.wgsl"), shader(body))?;
        let (found, count) = too_long(dir.path())?;
        assert_eq!((found.len(), count), (expected, 1), "{found:?}");
    }
    Ok(())
}
