//! Output that is closed or full.

use crate::program::{command, text};
use std::fs::File;
use std::process::{Output, Stdio};

/// Output of the program with `stdout` as its stdout.
fn prairie(arguments: &[&str], stdout: impl Into<Stdio>) -> Output {
    command().args(arguments).stdout(stdout).output().unwrap()
}

#[test]
fn a_reader_who_has_left_is_no_error() {
    let closed = || {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        writer
    };
    for arguments in
        [["scenes"].as_slice(), &["scenes", "--format=json"], &["check", "blades"], &["--help"], &["man"], &["completions", "bash"]]
    {
        let quiet = prairie(arguments, closed());
        assert_eq!((quiet.status.code(), text(&quiet.stderr)), (Some(0), String::new()), "{arguments:?}");
    }
    // The result of a check is that of the scenes.
    let invalid = prairie(&["check", "--format=json", "xyzzy"], closed());
    assert_eq!((invalid.status.code(), text(&invalid.stderr)), (Some(1), String::new()));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_an_error() {
    for arguments in [["scenes"].as_slice(), &["check", "blades"], &["--version"], &["--help"], &["man"], &["completions", "bash"]] {
        let full = prairie(arguments, File::options().write(true).open("/dev/full").unwrap());
        assert_eq!(full.status.code(), Some(1), "{arguments:?}");
        assert_eq!(text(&full.stderr), "error: cannot write to stdout: No space left on device (os error 28)\n", "{arguments:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_server_whose_address_cannot_be_printed_goes_on() {
    use std::io::{BufRead as _, BufReader, Read as _, Write as _};
    let full = File::options().write(true).open("/dev/full").unwrap();
    let mut child = command().args(["blades", "--addr", "127.0.0.1:0"]).stdout(full).stderr(Stdio::piped()).spawn().unwrap();
    let lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let warning = lines.map(Result::unwrap).find(|line| line.contains("cannot write the address to stdout")).unwrap();
    let (_, page) = warning.split_once("page=\"http://").unwrap_or_else(|| panic!("{warning}"));
    let mut stream = std::net::TcpStream::connect(page.split('"').next().unwrap()).unwrap();
    stream.write_all(b"GET /healthz HTTP/1.0\r\n\r\n").unwrap();
    let mut response = String::new();
    stream.read_to_string(&mut response).unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(response.contains(" 200 OK"), "{response}");
}
