//! `prairie check`: its reports, in text and in JSON, and its exit status.

use crate::program::{command, prairie, text};
use serde_json::{Value, json};
use std::fs;
use std::path::Path;

/// Writes a scene file; returns its path.
fn scene(folder: &Path, name: &str, contents: &str) -> String {
    let path = folder.join(name);
    fs::write(&path, contents).unwrap();
    path.to_str().unwrap().to_owned()
}

#[test]
fn the_exit_status_says_whether_all_scenes_are_valid() {
    let folder = tempfile::tempdir().unwrap();
    let broken = scene(folder.path(), "broken.toml", "sumary = 1\n");
    let valid = prairie(&["check", "meadow", "scenes/shells.toml"]);
    let told = text(&valid.stdout);
    assert!(valid.status.success() && told.starts_with("meadow: valid\n") && told.contains("\n\nscenes/shells.toml: valid\n"), "{valid:?}");
    let missing = prairie(&["check", "no/such/scene.toml"]);
    assert_eq!((missing.status.code(), text(&missing.stdout)), (Some(1), String::new()));
    assert!(text(&missing.stderr).starts_with("error: scene file `no/such/scene.toml` cannot be read"), "{missing:?}");
    let mixed = prairie(&["check", &broken, "blades", "xyzzy"]);
    let told = text(&mixed.stdout);
    assert_eq!(mixed.status.code(), Some(1));
    assert!(told.starts_with(&format!("{broken} has 3 faults\n\nerror: ")) && told.contains("\nblades: valid\n"), "{told}");
    assert!(text(&mixed.stderr).contains("called `xyzzy`"), "{mixed:?}");
    assert_eq!(prairie(&["check"]).status.code(), Some(2));
}

#[test]
fn json_lists_every_scene_and_its_faults() {
    let folder = tempfile::tempdir().unwrap();
    let broken = scene(folder.path(), "broken.toml", "summary = \"é\"\nterrain = 3\ntick = 2\n");
    let checked = prairie(&["check", "--format", "json", "shells", &broken, "xyzzy"]);
    assert_eq!((checked.status.code(), text(&checked.stderr)), (Some(1), String::new()));
    let list: Value = serde_json::from_slice(&checked.stdout).unwrap();
    assert_eq!(list[0], json!({ "file": "shells", "valid": true, "faults": [], "more_faults": 0, "error": null }));
    assert_eq!((&list[1]["file"], &list[1]["valid"], &list[1]["error"]), (&json!(broken), &json!(false), &Value::Null));
    let tick = json!({
        "file": broken, "line": 3, "column": 1, "length": 4, "path": "tick",
        "message": "is not a field of a scene; did you mean `tick_hz`?",
    });
    assert_eq!(list[1]["faults"][1], tick);
    let unknown = list[2]["error"].as_str().unwrap();
    assert!(list[2]["valid"] == json!(false) && unknown.starts_with("there is no built-in scene and no file called `xyzzy`"), "{unknown}");
}

#[test]
fn a_file_of_nothing_but_faults_has_a_short_report() {
    let folder = tempfile::tempdir().unwrap();
    let keys = |separator: &str| (0..70_000).map(|i| format!("k{i} = 1{separator}")).collect::<String>();
    let lines = scene(folder.path(), "lines.toml", &keys("\n"));
    let line = scene(folder.path(), "line.toml", &format!("wind = {{ {}x = 1 }}\n", keys(", ")));
    let syntax = scene(folder.path(), "syntax.toml", &"? ?\n".repeat(200_000));
    for (file, count) in [(lines, 70_002), (line, 70_003), (syntax, 200_000)] {
        let drawn = prairie(&["check", &file]);
        let told = text(&drawn.stdout);
        assert!(told.starts_with(&format!("{file} has {count} faults\n")), "{}", told.lines().next().unwrap_or_default());
        assert!(told.ends_with(&format!("\nand {} more faults\n", count - 20)) && told.len() < 20_000, "{}", told.len());
        let listed: Value = serde_json::from_slice(&prairie(&["check", "--format", "json", &file]).stdout).unwrap();
        assert_eq!((listed[0]["faults"].as_array().unwrap().len(), &listed[0]["more_faults"]), (1000, &json!(count - 1000)));
    }
}

#[cfg(unix)]
#[test]
fn file_names_are_escaped() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt as _;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(OsStr::from_bytes(b"a\x1b[31m\xff.toml"));
    fs::write(&path, "tick = 1\n").unwrap();
    let drawn = command().arg("check").arg(&path).output().unwrap();
    let told = text(&drawn.stdout);
    assert!(told.contains("a\\u{1b}[31m\\xff.toml has 3 faults\n") && !told.contains('\u{1b}'), "{told}");
    let missing = command().arg("check").arg(OsStr::from_bytes(b"no\x1b[31m\xff.toml")).output().unwrap();
    let told = text(&missing.stderr);
    assert!(told.starts_with("error: scene file `no\\u{1b}[31m\\xff.toml` cannot be read: "), "{told}");
}
