//! The command line.

use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Command, Output, Stdio};

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

#[test]
fn a_new_scene_is_valid_and_leads_editors_to_its_schema() {
    let folder = tempfile::tempdir().unwrap();
    let hill = folder.path().join("hill");
    let new = prairie(&["new", hill.to_str().unwrap()]);
    let scene = hill.join("scene.toml").display().to_string();
    assert!(new.status.success() && text(&new.stdout).starts_with(&format!("{scene}\n")), "{new:?}");
    assert!(text(&new.stdout).ends_with(&format!("\nRun it with: prairie {scene}\n")), "{new:?}");
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

#[test]
fn wrong_arguments_of_tls_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("missing.pem").display().to_string();
    let file = folder.path().join("file").display().to_string();
    std::fs::write(&file, "text").unwrap();
    for (arguments, expected) in [
        (&["--tls", "on"][..], "'on' for '--tls <self|CERT,KEY|acme:DOMAIN[,DOMAIN]>': expected `self`, two PEM files"),
        (&["--tls", "acme:192.168.1.5"], "`192.168.1.5`: expected a name"),
        (&["--tls", &format!("{missing},{file}")], &format!("error: --tls: {missing} cannot be read: ")),
        (&["--tls", "self", "--tls-dir", &file], &format!("error: --tls: {file} cannot be created: ")),
        (&["--tls", "self", "--acme-email", "me@play.example"], "error: --acme-email needs --tls acme:DOMAIN"),
        (&["--acme-root", &file], "error: --acme-root needs --tls acme:DOMAIN"),
        (&["--acme-email", "me"], "'me' for '--acme-email <ADDRESS>': expected an e-mail address"),
        (&["--acme-directory", "acme.example"], "'acme.example' for '--acme-directory <URL>': expected the URL"),
        (&["--allow-origin", "play.example"], "'play.example' for '--allow-origin <ORIGIN>': expected scheme, host and port"),
        (&["--allow-host", "play.example:8443"], "'play.example:8443' for '--allow-host <NAME>': expected a name without a port"),
    ] {
        let failed = prairie(&[&["serve", "--addr", "127.0.0.1:0"], arguments].concat());
        assert!(!failed.status.success() && failed.stdout.is_empty(), "{arguments:?}: {failed:?}");
        assert!(text(&failed.stderr).contains(expected), "{arguments:?}: {}", text(&failed.stderr));
    }
}

const SCENE: &str = "summary = 'a test'\npatches = { count = [1, 1], cells = 8, cell_m = 1.0 }\n[terrain]\nheight_map = 'land.png'\n\
    covering_map = 'land.png'\npixel_m = [8, 8]\nlevel_m = 0.1\n[wind]\ncells = [8, 4, 8]\n";

#[test]
fn a_certificate_is_kept_in_the_folder_that_the_start_names() {
    let folder = tempfile::tempdir().unwrap();
    let (scene, kept) = (folder.path().join("scene.toml"), folder.path().join("kept"));
    std::fs::write(&scene, SCENE).unwrap();
    std::fs::write(folder.path().join("land.png"), prairie_core::terrain::grey_png([2; 2], &[255; 4])).unwrap();
    let fingerprint = || {
        let mut server = Command::new(env!("CARGO_BIN_EXE_prairie"))
            .args(["serve", "--addr", "127.0.0.1:0", "--tls", "self", "--tls-dir"])
            .args([&kept, Path::new("--scene"), &scene])
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut output = BufReader::new(server.stdout.take().unwrap());
        let kept_in = format!("  certificate kept in: {}\n", kept.display());
        let mut text = String::new();
        while !text.ends_with(&kept_in) && output.read_line(&mut text).unwrap() > 0 {}
        server.kill().unwrap();
        server.wait().unwrap();
        assert!(text.ends_with(&kept_in), "{text}");
        text.lines().find(|line| line.starts_with("  certificate SHA-256: ")).expect("a fingerprint").to_owned()
    };
    assert_eq!(fingerprint(), fingerprint());
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
