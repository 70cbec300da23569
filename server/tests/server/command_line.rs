//! The command line.

use std::process::{Command, Output};

fn prairie(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_prairie")).args(arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn check_reports_by_its_exit_status() {
    let valid = prairie(&["check", "meadow"]);
    assert!(valid.status.success() && text(&valid.stdout).starts_with("meadow: valid\n"), "{valid:?}");
    let missing = prairie(&["check", "no/such/scene.toml"]);
    assert_eq!((missing.status.code(), text(&missing.stdout)), (Some(1), String::new()));
    assert!(text(&missing.stderr).starts_with("error: scene file `no/such/scene.toml` cannot be read"), "{missing:?}");
}

#[test]
fn an_error_is_printed_once() {
    let nowhere = prairie(&["serve", "--addr", "nowhere"]);
    assert_eq!((nowhere.status.code(), text(&nowhere.stdout)), (Some(1), String::new()));
    assert_eq!(text(&nowhere.stderr).matches("invalid socket address").count(), 1, "{nowhere:?}");
}

#[test]
fn a_scene_is_a_word_or_an_option() {
    let nowhere = |arguments: &[&str]| {
        let failed = prairie(&[arguments, &["--addr", "nowhere"]].concat());
        assert!(text(&failed.stderr).starts_with("error: --addr: cannot listen on `nowhere`"), "{arguments:?}: {failed:?}");
    };
    nowhere(&["shells"]);
    nowhere(&["serve", "shells"]);
    nowhere(&["--scene", "shells"]);
    nowhere(&["scenes/shells.toml"]);
    for twice in [["shells", "--scene", "shells"].as_slice(), &["serve", "--scene=shells", "shells"]] {
        let refused = prairie(twice);
        assert_eq!(refused.status.code(), Some(2));
        assert!(text(&refused.stderr).starts_with("error: the scene is given twice"), "{refused:?}");
    }
}

#[test]
fn the_scene_of_the_environment_yields_to_the_command_line() {
    let mut prairie = Command::new(env!("CARGO_BIN_EXE_prairie"));
    prairie.env("PRAIRIE_SCENE", "no-scene");
    let told = |arguments: &[&str], prairie: &mut Command| text(&prairie.args(arguments).output().unwrap().stderr);
    assert!(told(&[], &mut prairie).contains("called `no-scene`"));
    assert!(told(&["other-scene"], &mut prairie).contains("called `other-scene`"));
}

#[test]
fn an_unknown_word_gets_a_suggestion() {
    let told = |arguments: &[&str]| text(&prairie(arguments).stderr);
    assert!(told(&["serv"]).starts_with("error: there is no command, no built-in scene and no file called `serv`; did you mean `serve`?"));
    assert!(
        told(&["medow"]).starts_with("error: there is no command, no built-in scene and no file called `medow`; did you mean `meadow`?")
    );
    assert!(told(&["serve", "serv"]).starts_with("error: there is no built-in scene and no file called `serv`. Built-in scenes: meadow"));
}

#[cfg(feature = "rerun")]
#[test]
fn a_run_that_cannot_start_prints_no_address() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let taken = taken.local_addr().unwrap();
    let failed = prairie(&["serve", "--addr", "127.0.0.1:0", "--rerun", &format!("serve={taken}")]);
    assert_eq!((failed.status.code(), text(&failed.stdout)), (Some(1), String::new()));
    assert!(text(&failed.stderr).contains(&format!("error: cannot serve the recording at {taken}")), "{failed:?}");
}
