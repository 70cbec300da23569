//! The log on stderr.

use crate::program::Server;
use serde_json::Value;
use std::io::Read as _;

const DETAILED: (&str, &str) = ("RUST_LOG", "prairie=debug");

/// The whole log of a server that got a nonsensical request.
fn log_of(arguments: &[&str]) -> String {
    let mut server = Server::start(arguments, &[DETAILED]);
    server.ask("NONSENSE");
    let mut stderr = server.stderr();
    assert!(server.stop().success());
    let mut log = String::new();
    stderr.read_to_string(&mut log).unwrap();
    log
}

#[test]
fn a_redirected_log_has_short_targets_and_no_colours() {
    let log = log_of(&[]);
    assert!(log.contains(" DEBUG net::serve: a connection failed error="), "{log}");
    assert!(!log.contains('\u{1b}'), "{log}");
}

#[test]
fn every_line_of_a_json_log_is_an_object() {
    let log = log_of(&["--log-format", "json"]);
    let events: Vec<Value> = log.lines().map(|line| serde_json::from_str(line).unwrap_or_else(|error| panic!("{line}: {error}"))).collect();
    let failed = events.iter().find(|event| event["message"] == "a connection failed").unwrap_or_else(|| panic!("{log}"));
    assert_eq!((&failed["level"], &failed["target"]), (&"DEBUG".into(), &"prairie::net::serve".into()));
    assert!(failed["timestamp"].is_string() && failed["error"].is_string(), "{failed}");
}

#[test]
fn a_stderr_that_nobody_reads_stops_neither_requests_nor_the_end() {
    let server = Server::start(&[], &[DETAILED]);
    // More lines than the pipe holds.
    for _ in 0..1500 {
        server.ask("NONSENSE");
    }
    assert!(server.ask("GET /healthz HTTP/1.1").contains(" 200 OK"));
    assert!(server.stop().success());
}
