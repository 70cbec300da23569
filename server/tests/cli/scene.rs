//! The scene on the command line, and what is said about unknown words.

use crate::program::{command, prairie, text};

/// An address of no machine (RFC 5737).
const ELSEWHERE: &str = "192.0.2.1:0";

#[test]
fn an_error_is_printed_once() {
    let refused = prairie(&["serve", "--addr", ELSEWHERE]);
    assert_eq!((refused.status.code(), text(&refused.stdout)), (Some(1), String::new()));
    assert_eq!(text(&refused.stderr).matches("cannot listen on").count(), 1, "{refused:?}");
}

#[test]
fn a_scene_is_a_word_or_an_option() {
    let is_loaded = |arguments: &[&str]| {
        let failed = prairie(&[arguments, &["--addr", ELSEWHERE]].concat());
        assert!(text(&failed.stderr).starts_with("error: --addr: cannot listen on 192.0.2.1:0"), "{arguments:?}: {failed:?}");
    };
    is_loaded(&["shells"]);
    is_loaded(&["serve", "shells"]);
    is_loaded(&["--scene", "shells"]);
    is_loaded(&["scenes/shells.toml"]);
    for twice in [["shells", "--scene", "shells"].as_slice(), &["serve", "--scene=shells", "shells"]] {
        let refused = prairie(twice);
        assert_eq!(refused.status.code(), Some(2));
        assert!(text(&refused.stderr).starts_with("error: the scene is given twice"), "{refused:?}");
    }
}

#[test]
fn the_scene_of_the_environment_yields_to_the_command_line() {
    let mut prairie = command();
    prairie.env("PRAIRIE_SCENE", "no-scene");
    let told = |arguments: &[&str], prairie: &mut std::process::Command| text(&prairie.args(arguments).output().unwrap().stderr);
    let of_variable = "error: PRAIRIE_SCENE: there is no built-in scene and no file called `no-scene`";
    assert!(told(&[], &mut prairie).starts_with(of_variable), "{}", told(&[], &mut prairie));
    assert!(
        told(&["other-scene"], &mut prairie).starts_with("error: there is no command, no built-in scene and no file called `other-scene`")
    );
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
