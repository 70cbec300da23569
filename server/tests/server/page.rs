//! The files of the page over HTTP, their headers, and the errors that pages report.

use crate::test_server::{Server, within};
use prairie::Limits;
use std::process::Stdio;
use tokio::io::{AsyncBufReadExt as _, AsyncReadExt as _, AsyncWriteExt as _, BufReader};
use tokio::net::TcpStream;
use tokio::process::Command;

fn text(response: &[u8]) -> String {
    String::from_utf8_lossy(response).into_owned()
}

fn header<'a>(response: &'a str, name: &str) -> Option<&'a str> {
    let head = response.split("\r\n\r\n").next()?;
    head.lines().filter_map(|line| line.split_once(": ")).find(|(found, _)| *found == name).map(|(_, value)| value)
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn files_named_after_their_contents_are_kept_forever_and_the_page_is_not() {
    let server = Server::start(Limits::default()).await;
    let page = text(&server.http("GET / HTTP/1.1").await);
    assert_eq!((header(&page, "cache-control"), header(&page, "content-encoding")), (Some("no-cache"), None));
    let mut linked = page.split("href=\"").filter_map(|rest| rest.split_once('"')).map(|(name, _)| name);
    let style = linked.find(|name| name.ends_with(".css")).expect("the page links its style").to_owned();

    let mut tags = Vec::new();
    for (accepted, encoding) in [("gzip;q=0", None), ("gzip", Some("gzip")), ("gzip, deflate, br", Some("br"))] {
        let response = text(&server.http(&format!("GET /{style} HTTP/1.1\r\naccept-encoding: {accepted}")).await);
        assert!(response.starts_with("HTTP/1.1 200"), "{response}");
        assert_eq!(header(&response, "content-encoding"), encoding, "{accepted}");
        assert_eq!(header(&response, "cache-control"), Some("public, max-age=31536000, immutable"));
        assert_eq!(header(&response, "vary"), Some("accept-encoding"));
        let tag = header(&response, "etag").expect("a tag").to_owned();
        let again = format!("GET /{style} HTTP/1.1\r\naccept-encoding: {accepted}\r\nif-none-match: {tag}");
        assert!(text(&server.http(&again).await).starts_with("HTTP/1.1 304"), "{accepted}");
        assert!(!tags.contains(&tag), "{accepted}: the tag {tag} is that of another encoding");
        tags.push(tag);
    }
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn every_response_restricts_the_page() {
    let server = Server::start(Limits::default()).await;
    for request in ["GET / HTTP/1.1", "GET /healthz HTTP/1.1", "GET /nothing HTTP/1.1", "POST / HTTP/1.1"] {
        let response = text(&server.http(request).await);
        let policy = header(&response, "content-security-policy").unwrap_or_else(|| panic!("{request}: {response}"));
        assert!(policy.starts_with("default-src 'none'; script-src 'self' 'wasm-unsafe-eval';"), "{policy}");
        assert!(!policy.contains("unsafe-inline") && !policy.contains("'unsafe-eval'"), "{policy}");
        assert_eq!(header(&response, "x-content-type-options"), Some("nosniff"), "{request}");
    }
    server.stop().await;
}

/// Posts a report; returns the status.
async fn post(address: &str, headers: &str, body: &str) -> String {
    let mut stream = TcpStream::connect(address).await.unwrap();
    let head = format!("POST /report HTTP/1.1\r\nhost: {address}\r\nconnection: close\r\ncontent-length: {}\r\n{headers}\r\n", body.len());
    stream.write_all((head + body).as_bytes()).await.unwrap();
    let mut response = Vec::new();
    within(stream.read_to_end(&mut response)).await.unwrap();
    text(&response).split(' ').nth(1).unwrap_or_default().to_owned()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn reports_are_discarded_unless_the_operator_wants_them() {
    let server = Server::start(Limits::default()).await;
    let address = server.address.to_string();
    for _ in 0..30 {
        assert_eq!(post(&address, "", "panicked\nno grass left").await, "204");
    }
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_log_gets_the_errors_of_pages_bounded_and_escaped() {
    let mut program = Command::new(env!("CARGO_BIN_EXE_prairie"))
        .args(["serve", "--scene", "shells", "--addr", "127.0.0.1:0", "--report"])
        .env("PRAIRIE_WORLD", "none")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .kill_on_drop(true)
        .spawn()
        .unwrap();
    let mut printed = BufReader::new(program.stdout.take().unwrap()).lines();
    let mut log = BufReader::new(program.stderr.take().unwrap()).lines();
    let first = within(printed.next_line()).await.unwrap().expect("the address");
    let address = first.split("http://").nth(1).expect("an address").to_owned();

    assert_eq!(post(&address, "origin: http://elsewhere.example\r\n", "forged").await, "403");
    assert_eq!(post(&address, "user-agent: Browser/1\r\n", "panicked\nno grass left \u{1b}[31m\u{202e}").await, "204");
    let line = within(async {
        loop {
            let line = log.next_line().await.unwrap().expect("the server logs the report before it ends");
            if line.contains("a page reports an error") {
                return line;
            }
        }
    })
    .await;
    assert!(!line.contains("forged") && line.contains(r"panicked\nno grass left \u{1b}[31m\u{202e}"), "{line}");
    assert!(line.contains("Browser/1"), "{line}");

    assert_eq!(post(&address, "", &"x".repeat(5000)).await, "413");
    let mut statuses = Vec::new();
    for _ in 0..30 {
        statuses.push(post(&address, "", "again").await);
    }
    assert!(statuses.contains(&"204".to_owned()) && statuses.contains(&"429".to_owned()), "{statuses:?}");
}
