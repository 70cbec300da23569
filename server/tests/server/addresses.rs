//! Limits per remote address. Linux lets every address of 127.0.0.0/8 connect.
#![cfg(target_os = "linux")]

use crate::test_client::PlainClient;
use crate::test_server::{Server, within};
use prairie::Limits;
use prairie_core::wire::{Close, ServerMessage};
use std::time::Duration;
use tokio::io::AsyncReadExt;
use tokio::net::TcpStream;

const OTHER: [u8; 4] = [127, 0, 0, 2];

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn silent_connections_of_one_address_do_not_shut_out_others() {
    let long = Duration::from_secs(60);
    let limits = Limits { pending: 10, clients_per_address: 1, handshake_timeout: long, http_timeout: long, ..Limits::default() };
    let server = Server::start(limits).await;
    // WebSockets without a hello, and connections without a request.
    let _silent = [PlainClient::connect(&server).await, PlainClient::connect(&server).await];
    let mut mute = Vec::new();
    for _ in 0..20 {
        mute.push(TcpStream::connect(server.address).await.unwrap());
    }
    let mut other = PlainClient::connect_from(&server, OTHER).await;
    other.say_hello("other").await;
    other.frame().await;
    let mut last = mute.pop().unwrap();
    assert!(matches!(within(last.read(&mut [0; 1])).await, Ok(0) | Err(_)), "closed at once");
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn clients_of_one_address_are_limited() {
    let server = Server::start(Limits { clients_per_address: 2, ..Limits::default() }).await;
    let mut first = PlainClient::join(&server, "first").await;
    let mut second = PlainClient::join(&server, "second").await;
    let mut third = PlainClient::connect(&server).await;
    third.ask_to_join("third").await;
    let (code, reason) = third.closed().await;
    assert_eq!(code, Close::ServerFull.code());
    assert!(reason.contains("your address has 2 clients"), "{reason}");
    let mut other = PlainClient::connect_from(&server, OTHER).await;
    other.say_hello("other").await;
    for client in [&mut first, &mut second, &mut other] {
        client.frame().await;
    }
    second.socket.close(None).await.unwrap();
    first.frames_until(|first| first.peers.len() == 2).await;
    within(async {
        loop {
            let mut again = PlainClient::connect(&server).await;
            again.ask_to_join("again").await;
            if again.receive().await.is_ok_and(|message| matches!(message, ServerMessage::Welcome { .. })) {
                break;
            }
        }
    })
    .await;
    server.stop().await;
}
