//! Licences of the crates in the released binary and its page: those that `about.toml` accepts, and no others.

use std::fs;
use std::process::Command;

use anyhow::{Context as _, Result, ensure};
use spdx::{Expression, LicenseReq, ParseMode};

use super::architecture::workspace;

/// Value of `about.toml`, which also tells `.ci/notices` what to collect.
fn about(key: &str) -> Result<Vec<String>> {
    let table: toml::Table = fs::read_to_string(workspace().join("about.toml"))?.parse()?;
    let values = table.get(key).and_then(toml::Value::as_array).with_context(|| format!("about.toml has no list `{key}`"))?;
    values.iter().map(|value| value.as_str().map(String::from).with_context(|| format!("about.toml: {key} lists {value}"))).collect()
}

/// Name and licence expression of every crate that is linked into a package.
fn linked(package: &str, options: &[&str]) -> Result<Vec<(String, String)>> {
    let mut tree = Command::new(env!("CARGO"));
    tree.current_dir(workspace()).args(["tree", "--locked", "--package", package, "--edges", "normal,no-proc-macro"]);
    let output = tree.args(["--prefix", "none", "--format", "{p}\t{l}"]).args(options).output()?;
    ensure!(output.status.success(), "cargo tree of {package}: {}", String::from_utf8_lossy(&output.stderr));
    let printed = String::from_utf8(output.stdout)?;
    // A star marks a crate that was printed before.
    let lines = printed.lines().map(|line| line.trim_end_matches(" (*)")).filter_map(|line| line.split_once('\t'));
    let mut crates: Vec<_> = lines.map(|(name, licence)| (name.to_owned(), licence.to_owned())).collect();
    crates.sort();
    crates.dedup();
    Ok(crates)
}

fn is_accepted(expression: &str, accepted: &[String]) -> Result<bool> {
    let expression = Expression::parse_mode(expression, ParseMode::LAX).with_context(|| format!("licence `{expression}`"))?;
    Ok(expression.evaluate(|required: &LicenseReq| accepted.iter().any(|name| *name == required.to_string())))
}

fn refused(crates: &[(String, String)], accepted: &[String]) -> Result<Vec<String>> {
    let mut refused = Vec::new();
    for (name, licence) in crates {
        if licence.is_empty() || !is_accepted(licence, accepted)? {
            refused.push(format!("{name}: `{licence}`"));
        }
    }
    Ok(refused)
}

#[test]
fn every_linked_crate_has_an_accepted_licence() -> Result<()> {
    let accepted = about("accepted")?;
    let targets = about("targets")?;
    let mut server = vec!["--features", "rerun"];
    server.extend(targets.iter().flat_map(|target| ["--target", target]));
    for (package, options) in [("prairie", &server[..]), ("prairie-client", &["--target", "wasm32-unknown-unknown"])] {
        let crates = linked(package, options)?;
        ensure!(crates.len() > 50, "{package} has only {} crates", crates.len());
        let refused = refused(&crates, &accepted)?;
        ensure!(refused.is_empty(), "{package}: about.toml does not accept the licence of\n{}", refused.join("\n"));
    }
    Ok(())
}

#[test]
fn other_licences_are_found() -> Result<()> {
    let accepted = ["MIT".to_owned(), "ISC".to_owned()];
    for sound in ["MIT", "MIT/Apache-2.0", "GPL-3.0-only OR MIT", "ISC AND MIT"] {
        ensure!(is_accepted(sound, &accepted)?, "{sound}");
    }
    let crates = ["GPL-3.0-only", "MIT AND GPL-2.0-only", "Apache-2.0", ""].map(|licence| ("some v1.0.0".to_owned(), licence.to_owned()));
    ensure!(refused(&crates, &accepted)?.len() == crates.len());
    Ok(())
}
