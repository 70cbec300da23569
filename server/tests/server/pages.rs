//! Pages, the health report, whose pages may open the socket, and how a run ends.

use crate::running::{Server, within};
use crate::small_world::Meadow;
use crate::visitor::Plain;
use server::{Limits, RunError};
use shared::wire::{ClientMessage, Close, Refusal, ServerMessage};
use std::io::Read as _;
use std::time::Duration;
use tokio::net::TcpStream;
use tokio_tungstenite::tungstenite;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn everybody_is_told_when_the_server_stops() {
    let server = Server::start(Limits::default()).await;
    let mut visitor = Plain::join(&server, "visitor").await;
    visitor.frame().await;
    server.stop().await;
    assert_eq!(visitor.closed().await.0, Close::Stopping.code());
    assert_eq!(visitor.refusals, [Refusal::Stopping]);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_run_is_over_when_all_goodbyes_are_said() {
    let server = Server::start(Limits::default()).await;
    let silent = Plain::connect(&server).await;
    let mut visitor = Plain::join(&server, "visitor").await;
    visitor.frame().await;
    server.stop().await;
    for visitor in [silent, visitor] {
        // Neither hangs up: the server has, after its last words.
        let mut stream = visitor.socket.into_inner().into_std().unwrap();
        let mut last_words = Vec::new();
        stream.read_to_end(&mut last_words).expect("nothing is left open");
        let code = Close::Stopping.code().to_be_bytes();
        assert!(last_words.windows(2).any(|pair| pair == code), "{last_words:?}");
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_fault_in_the_stream_ends_the_run_with_an_error() {
    let (server, _) = Server::start_with(Meadow::misshapen_at(40), Limits::default(), None).await;
    let mut visitor = Plain::join(&server, "visitor").await;
    while let Ok(message) = visitor.hear().await {
        if let ServerMessage::FrameEnd { frame, .. } = message {
            visitor.say(&ClientMessage::Ack { frame }).await;
        }
    }
    assert!(matches!(within(server.outcome).await.unwrap(), Err(RunError::StreamStopped)));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_fault_in_the_world_ends_the_run_with_an_error() {
    let world = Meadow::failing_at(20);
    let (server, _) = Server::start_with(world, Limits::default(), None).await;
    assert!(matches!(within(server.outcome).await.unwrap(), Err(RunError::WorldStopped)));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn pages_health_and_origins() {
    let server = Server::start(Limits::default()).await;
    let text = |answer: Vec<u8>| String::from_utf8_lossy(&answer).into_owned();
    let page = text(server.http("GET / HTTP/1.1").await);
    assert!(page.starts_with("HTTP/1.1 200") && page.contains("text/html"), "{page}");
    let etag = page.lines().find_map(|line| line.strip_prefix("etag: ")).expect("a tag").trim().to_owned();
    assert!(text(server.http(&format!("GET / HTTP/1.1\r\nif-none-match: {etag}")).await).starts_with("HTTP/1.1 304"));
    let packed = server.http("GET / HTTP/1.1\r\naccept-encoding: gzip").await;
    assert!(text(packed.clone()).contains("content-encoding: gzip") && packed.windows(2).any(|pair| pair == [0x1f, 0x8b]));
    assert!(text(server.http("GET /../Cargo.toml HTTP/1.1").await).starts_with("HTTP/1.1 404"));
    assert!(text(server.http("POST / HTTP/1.1").await).starts_with("HTTP/1.1 405"));
    assert!(text(server.http("nonsense").await).starts_with("HTTP/1.1 400"));

    let mut visitor = Plain::join(&server, "visitor").await;
    visitor.frame().await;
    // The first frame may show the world before its first step, and be counted after it has arrived.
    within(async {
        loop {
            let health = text(server.http("GET /healthz HTTP/1.1").await);
            let report: serde_json::Value = serde_json::from_str(health.split("\r\n\r\n").nth(1).unwrap()).unwrap();
            assert_eq!((&report["status"], &report["scene"]), (&"ok".into(), &"small".into()));
            if report["tick"].as_u64().unwrap() > 0 && report["clients"][0]["sent_bytes"].as_u64().unwrap() > 0 {
                break;
            }
            tokio::time::sleep(Duration::from_millis(10)).await;
        }
    })
    .await;

    for (origin, allowed) in [(format!("http://{}", server.address), true), ("http://elsewhere.example".to_owned(), false)] {
        let mut request = format!("ws://{}/ws", server.address).into_client_request().unwrap();
        request.headers_mut().insert("origin", origin.parse().unwrap());
        let stream = TcpStream::connect(server.address).await.unwrap();
        match within(tokio_tungstenite::client_async(request, stream)).await {
            Ok(_) => assert!(allowed, "{origin}"),
            Err(tungstenite::Error::Http(answer)) => assert!(!allowed && answer.status() == 403, "{origin}: {}", answer.status()),
            Err(other) => panic!("{origin}: {other}"),
        }
    }
    server.stop().await;
}
