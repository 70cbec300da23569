//! `prairie new` and `prairie schema`.

use crate::program::{prairie, text};

#[test]
fn a_new_scene_is_valid_and_leads_editors_to_its_schema() {
    let folder = tempfile::tempdir().unwrap();
    let hill = folder.path().join("hill");
    let new = prairie(&["new", hill.to_str().unwrap()]);
    let scene = hill.join("scene.toml").display().to_string();
    assert!(new.status.success() && text(&new.stdout).starts_with(&format!("{scene}\n")), "{new:?}");
    assert!(text(&new.stdout).ends_with(&format!("\nRun it with: prairie {scene}\n")), "{new:?}");
    let spaced = prairie(&["new", folder.path().join("my hill").to_str().unwrap()]);
    let command = text(&spaced.stdout).lines().last().unwrap_or_default().to_owned();
    let quote = if cfg!(windows) { '"' } else { '\'' };
    assert!(command.starts_with(&format!("Run it with: prairie {quote}")) && command.ends_with(&format!("scene.toml{quote}")), "{command}");
    assert!(prairie(&["check", &scene]).status.success());
    let schema = prairie(&["schema"]);
    assert!(schema.status.success() && schema.stdout == std::fs::read(hill.join("scene.schema.json")).unwrap());
    let again = prairie(&["new", hill.to_str().unwrap()]);
    assert_eq!((again.status.code(), text(&again.stdout)), (Some(1), String::new()));
    assert!(text(&again.stderr).contains("hill` is not empty, it contains `"), "{again:?}");
    let unknown = prairie(&["new", folder.path().join("other").to_str().unwrap(), "--from", "medow"]);
    assert!(
        text(&unknown.stderr).starts_with("error: --from: there is no built-in scene `medow` (did you mean `meadow`?); "),
        "{unknown:?}"
    );
}
