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

#[cfg(feature = "rerun")]
#[test]
fn a_run_that_cannot_start_prints_no_address() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let taken = taken.local_addr().unwrap();
    let failed = prairie(&["serve", "--addr", "127.0.0.1:0", "--rerun", &format!("serve={taken}")]);
    assert_eq!((failed.status.code(), text(&failed.stdout)), (Some(1), String::new()));
    assert!(text(&failed.stderr).contains(&format!("error: cannot serve the recording at {taken}")), "{failed:?}");
}
