//! Signals that stop the program, from its first moments on.

use std::io::{BufRead as _, BufReader, Read as _};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

/// Starts a program with its output in pipes.
fn start(program: &str, arguments: &[&str]) -> Child {
    Command::new(program)
        .args(arguments)
        .env_remove("RUST_LOG")
        .env("PRAIRIE_WORLD", "none")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

fn send(child: &Child, signal: &str) {
    let sent = Command::new("sh").arg("-c").arg(format!("kill -{signal} {}", child.id())).status().unwrap();
    assert!(sent.success());
}

/// Waits for the line with the address of the page.
fn wait_for_address(child: &mut Child) -> String {
    let mut line = String::new();
    BufReader::new(child.stdout.as_mut().unwrap()).read_line(&mut line).unwrap();
    assert!(line.starts_with("Prairie is at http://"), "{line}");
    line
}

/// Waits for the end; returns the exit code and the log.
fn end(mut child: Child) -> (Option<i32>, String) {
    let mut log = String::new();
    child.stderr.take().unwrap().read_to_string(&mut log).unwrap();
    (child.wait().unwrap().code(), log)
}

#[test]
fn every_stop_signal_ends_the_run_in_order() {
    for signal in ["INT", "TERM", "HUP"] {
        let mut child = start(env!("CARGO_BIN_EXE_prairie"), &["serve", "--addr", "127.0.0.1:0", "--scene", "shells"]);
        wait_for_address(&mut child);
        send(&child, signal);
        let (code, log) = end(child);
        assert_eq!(code, Some(0), "SIG{signal}: {log}");
        assert!(log.contains("stopping") && log.contains(&format!("SIG{signal}")), "{log}");
    }
}

#[test]
fn a_hangup_that_nohup_ignores_stays_ignored() {
    let program = env!("CARGO_BIN_EXE_prairie");
    let script = format!("trap '' HUP; exec {program} serve --addr 127.0.0.1:0 --scene shells");
    let mut child = start("sh", &["-c", &script]);
    wait_for_address(&mut child);
    send(&child, "HUP");
    send(&child, "TERM");
    let (code, log) = end(child);
    assert_eq!(code, Some(0), "{log}");
    assert!(log.contains("SIGTERM") && !log.contains("SIGHUP"), "{log}");
}

/// The socket listens before the world is built, which takes seconds where so much underbrush grows.
#[test]
fn a_signal_while_the_world_is_built_announces_no_page() {
    let folder = tempfile::tempdir().unwrap();
    let scene_dir = folder.path().join("dense");
    let program = env!("CARGO_BIN_EXE_prairie");
    assert!(Command::new(program).args(["new", "--from", "underbrush"]).arg(&scene_dir).output().unwrap().status.success());
    let file = scene_dir.join("scene.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let dense = text.replace("spacing_m = 0.4", "spacing_m = 0.125");
    assert_ne!(dense, text);
    std::fs::write(&file, dense).unwrap();
    let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let address = format!("127.0.0.1:{port}");
    let mut child = start(program, &["serve", file.to_str().unwrap(), "--addr", &address]);
    while std::net::TcpStream::connect(&address).is_err() {
        sleep(Duration::from_millis(1));
    }
    send(&child, "INT");
    let mut printed = String::new();
    child.stdout.take().unwrap().read_to_string(&mut printed).unwrap();
    let (code, log) = end(child);
    assert_eq!((code, printed.as_str()), (Some(0), ""), "{log}");
}

/// The handlers are there before the scene is loaded, which takes long for this one.
#[cfg(target_os = "linux")]
#[test]
fn a_signal_during_the_start_ends_the_program_in_order() {
    const SIGTERM: u64 = 15;
    let mut child = start(env!("CARGO_BIN_EXE_prairie"), &["serve", "--addr", "127.0.0.1:0", "--scene", "continuum"]);
    let catches_terminate = || {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).expect("the program runs");
        u64::from_str_radix(caught.trim(), 16).unwrap() >> (SIGTERM - 1) & 1 == 1
    };
    while !catches_terminate() {
        sleep(Duration::from_millis(1));
    }
    send(&child, "TERM");
    let mut printed = String::new();
    child.stdout.take().unwrap().read_to_string(&mut printed).unwrap();
    let (code, log) = end(child);
    assert_eq!((code, printed.as_str()), (Some(0), ""), "{log}");
    assert!(log.contains("SIGTERM"), "{log}");
}
