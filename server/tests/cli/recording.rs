//! Recordings that cannot start, or cannot be completed.

use crate::program::{Server, prairie, text};
use std::fs::File;
use std::io::Read as _;
use std::process::Command;

#[test]
fn a_run_that_cannot_start_prints_no_address() {
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let taken = taken.local_addr().unwrap();
    let failed = prairie(&["serve", "--addr", "127.0.0.1:0", "--rerun", &format!("serve={taken}")]);
    assert_eq!((failed.status.code(), text(&failed.stdout)), (Some(1), String::new()));
    assert!(text(&failed.stderr).contains(&format!("error: cannot serve the recording at {taken}")), "{failed:?}");
}

#[test]
fn an_incomplete_recording_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("run.rrd");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    // Also open for writing, so that the program may open and close it as it likes.
    let mut reader = File::options().read(true).write(true).open(&pipe).unwrap();
    let mut server = Server::start(&["--rerun", &format!("save={}", pipe.display())], &[]);
    reader.read_exact(&mut [0; 64]).unwrap();
    // From here on it takes no more, like a disk that is full.
    drop(reader);
    let mut stderr = server.stderr();
    let status = server.stop();
    let mut log = String::new();
    stderr.read_to_string(&mut log).unwrap();
    assert_eq!(status.code(), Some(1), "{log}");
    assert!(log.contains("error: the recording is incomplete: "), "{log}");
}
