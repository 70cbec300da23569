//! Clients that violate the protocol are closed with a reason; the others notice nothing.

use crate::test_client::PlainClient;
use crate::test_server::{Server, within};
use futures_util::SinkExt;
use prairie::Limits;
use prairie_core::wire::{ClientMessage, Close, Drive, PROTOCOL, Refusal, ServerMessage, encode};
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio_tungstenite::tungstenite::Message;

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn bad_messages_close_only_their_sender() {
    let server = Server::start(Limits::default()).await;
    let mut witness = PlainClient::join(&server, "witness").await;
    let drive = |drive: Drive| encode(&ClientMessage::Drive { number: 1, drive });
    let view = |eye_m, radius_m| encode(&ClientMessage::View { eye_m, radius_m });
    let hello = encode(&ClientMessage::Hello { name: "again".to_owned() });
    let huge_name = encode(&ClientMessage::Hello { name: "x".repeat(5000) });
    let mut other_version = hello.clone();
    other_version[0] = PROTOCOL + 1;
    let bad = Close::BadMessage;
    let cases: [(&str, Vec<u8>, Close); 13] = [
        ("nothing", vec![], bad),
        ("garbage", vec![PROTOCOL, 0xff, 0xff, 0xff, 0xff, 0xff], bad),
        ("an oversized message", huge_name, bad),
        ("a hugely oversized message", vec![PROTOCOL; 1 << 20], bad),
        ("a truncated message", view([1.0; 3], 9.0)[..9].to_vec(), bad),
        ("a message with trailing bytes", [view([1.0; 3], 9.0), vec![0]].concat(), bad),
        ("another version", other_version, Close::Version),
        ("a second hello", hello, bad),
        ("a throttle of NaN", drive(Drive { throttle: f32::NAN, ..Drive::default() }), bad),
        ("a steer of 2", drive(Drive { steer: 2.0, ..Drive::default() }), bad),
        ("an eye at infinity", view([0.0, f32::INFINITY, 0.0], 9.0), bad),
        ("a radius of 513 m", view([0.0; 3], 513.0), bad),
        ("an acknowledgement of a frame never sent", encode(&ClientMessage::Ack { frame: 1_000_000 }), bad),
    ];
    for (what, bytes, close) in cases {
        let mut client = PlainClient::join(&server, "vandal").await;
        client.send(Message::Binary(bytes.into())).await;
        let (code, reason) = client.closed().await;
        assert_eq!(Close::from_code(code), Some(close), "{what}: {code} {reason}");
        assert!(!reason.is_empty(), "{what}");
        assert_eq!(client.refusals.contains(&Refusal::BadMessage), close == bad, "{what}");
        witness.frames_until(|witness| witness.peers.len() == 1).await;
    }
    let mut client = PlainClient::join(&server, "vandal").await;
    client.send(Message::Text("hello".into())).await;
    assert_eq!(client.closed().await.0, Close::BadMessage.code());
    for (bytes, close) in [(vec![0; 3], Close::Version), (view([0.0; 3], 1.0), bad), (vec![PROTOCOL, 99], bad)] {
        let mut client = PlainClient::connect(&server).await;
        client.send(Message::Binary(bytes.into())).await;
        assert_eq!(client.closed().await.0, close.code(), "instead of the hello");
    }
    witness.frame().await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_connection_without_a_hello_is_closed() {
    let limits = Limits { handshake_timeout: Duration::from_millis(200), ..Limits::default() };
    let server = Server::start(limits).await;
    let mut witness = PlainClient::join(&server, "witness").await;
    assert_eq!(PlainClient::connect(&server).await.closed().await.0, Close::NoHello.code());
    let mut mute = TcpStream::connect(server.address).await.unwrap();
    mute.write_all(b"GET / HTTP/1.1\r\nhost:").await.unwrap();
    let mut response = Vec::new();
    within(mute.read_to_end(&mut response)).await.unwrap();
    assert!(!String::from_utf8_lossy(&response).contains("200 OK"), "half a request gets no page");
    witness.frame().await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn pings_before_the_hello_are_answered_but_rate_limited() {
    let limits = Limits { messages_per_s: 50.0, ..Limits::default() };
    let server = Server::start(limits).await;
    let mut polite = PlainClient::connect(&server).await;
    for _ in 0..10 {
        polite.send(Message::Ping(Vec::new().into())).await;
    }
    polite.say_hello("polite").await;
    let mut client = PlainClient::connect(&server).await;
    for _ in 0..1000 {
        if client.socket.feed(Message::Ping(Vec::new().into())).await.is_err() {
            break;
        }
    }
    let _ = client.socket.flush().await;
    assert_eq!(client.closed().await.0, Close::RateLimit.code());
    polite.frame().await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn requests_that_are_never_read_do_not_block_others() {
    let limits = Limits { pending: 2, http_timeout: Duration::from_secs(2), ..Limits::default() };
    let server = Server::start(limits).await;
    let mut deaf = Vec::new();
    for _ in 0..limits.pending {
        let mut stream = TcpStream::connect(server.address).await.unwrap();
        let request = async move { while stream.write_all(b"GET / HTTP/1.1\r\nhost: prairie\r\n\r\n").await.is_ok() {} };
        deaf.push(tokio::spawn(request));
    }
    assert!(server.http("GET / HTTP/1.1").await.starts_with(b"HTTP/1.1 200"));
    for request in deaf {
        within(request).await.unwrap();
    }
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_message_flood_is_closed() {
    let limits = Limits { messages_per_s: 50.0, ..Limits::default() };
    let server = Server::start(limits).await;
    let mut witness = PlainClient::join(&server, "witness").await;
    let mut client = PlainClient::join(&server, "flood").await;
    for nonce in 0..500 {
        let ping = encode(&ClientMessage::Ping { nonce });
        if client.socket.feed(Message::Binary(ping.into())).await.is_err() {
            break;
        }
    }
    let _ = client.socket.flush().await;
    assert_eq!(client.closed().await.0, Close::RateLimit.code());
    assert!(client.refusals.contains(&Refusal::RateLimit));
    witness.frames_until(|witness| witness.peers.len() == 1).await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_client_that_never_reads_or_acknowledges_is_closed() {
    let timeout = Duration::from_millis(400);
    let limits = Limits { stall_timeout: timeout, load_timeout: timeout, ..Limits::default() };
    let server = Server::start(limits).await;
    let mut witness = PlainClient::join(&server, "witness").await;
    let mut deaf = PlainClient::join(&server, "deaf").await;
    let lazy = PlainClient::join(&server, "lazy").await;
    witness.frames_until(|witness| witness.peers.len() == 3).await;
    witness.frames_until(|witness| witness.peers.len() == 1).await;
    assert_eq!(deaf.closed().await.0, Close::Stalled.code());
    assert!(deaf.replica.frame <= limits.send.in_flight, "{} frames without an acknowledgement", deaf.replica.frame);
    drop(lazy);
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_full_server_rejects_clients_until_one_leaves() {
    let server = Server::start(Limits { clients: 1, ..Limits::default() }).await;
    let mut first = PlainClient::join(&server, "first").await;
    let mut second = PlainClient::connect(&server).await;
    second.send_message(&ClientMessage::Hello { name: "second".to_owned() }).await;
    assert_eq!(second.closed().await.0, Close::ServerFull.code());
    assert_eq!(second.refusals, [Refusal::ServerFull]);
    first.frame().await;
    first.socket.close(None).await.unwrap();
    within(async {
        loop {
            let mut third = PlainClient::connect(&server).await;
            third.send_message(&ClientMessage::Hello { name: "third".to_owned() }).await;
            if third.receive().await.is_ok_and(|message| matches!(message, ServerMessage::Welcome { .. })) {
                break;
            }
        }
    })
    .await;
    server.stop().await;
}
