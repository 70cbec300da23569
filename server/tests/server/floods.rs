//! Clients that send too much: their cost is bounded, for each kind of message by itself.

use crate::stand_in::StandInWorld;
use crate::test_client::PlainClient;
use crate::test_server::{Server, within};
use prairie::Limits;
use prairie_core::scene::VehicleKind;
use prairie_core::wire::{ClientMessage, Close, Refusal, ServerMessage};
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

/// A first fragment without data, and then such fragments without end: no message is ever complete.
async fn send_empty_fragments(client: &mut PlainClient) {
    let stream = client.socket.get_mut();
    stream.write_all(&[0x02, 0x80, 0, 0, 0, 0]).await.unwrap();
    within(stream.write_all(&[0x00, 0x80, 0, 0, 0, 0].repeat(10_000))).await.unwrap();
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn empty_fragments_count() {
    let server = Server::start(Limits { bytes_per_s: 1000.0, ..Limits::default() }).await;
    let mut witness = PlainClient::join(&server, "witness").await;
    let mut client = PlainClient::join(&server, "client").await;
    send_empty_fragments(&mut client).await;
    assert_eq!(client.closed().await.0, Close::RateLimit.code());
    assert_eq!(client.refusals, [Refusal::RateLimit]);
    let mut silent = PlainClient::connect(&server).await;
    send_empty_fragments(&mut silent).await;
    assert_eq!(silent.closed().await.0, Close::RateLimit.code(), "before the hello");
    witness.frames_until(|witness| witness.peers.len() == 1).await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn requests_that_are_too_long_or_too_many_end_the_connection() {
    let server = Server::start(Limits { bytes_per_s: 1000.0, ..Limits::default() }).await;
    for request in ["GET /healthz HTTP/1.1\r\nhost: prairie\r\n\r\n".repeat(1000), format!("GET / HTTP/1.1\r\na: {}", "a".repeat(20_000))] {
        let mut stream = TcpStream::connect(server.address).await.unwrap();
        // The server may close before it has all.
        let _ = stream.write_all(request.as_bytes()).await;
        let mut response = Vec::new();
        let _ = within(stream.read_to_end(&mut response)).await;
        assert!(response.len() < 500_000, "{} bytes", response.len());
    }
    let health = String::from_utf8(server.http("GET /healthz HTTP/1.1").await).unwrap();
    assert!(health.contains("\"rate_limited_connections\":2"), "{health}");
    server.stop().await;
}

/// Sends a ping and waits for the answer, and so until the server has taken in everything before it.
async fn settle(client: &mut PlainClient) {
    client.send_message(&ClientMessage::Ping { nonce: 7 }).await;
    while client.receive().await != Ok(ServerMessage::Pong { nonce: 7 }) {}
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn of_many_choices_only_few_reach_the_world() {
    let world = StandInWorld::default();
    let requests = Arc::clone(&world.requests);
    let (server, _) = Server::start_with(world, Limits { choices_per_s: 1e-3, ..Limits::default() }, None).await;
    let mut client = PlainClient::join(&server, "client").await;
    for _ in 0..50 {
        for vehicle in [None, Some(VehicleKind::Car)] {
            client.send_message(&ClientMessage::Choose { vehicle }).await;
        }
    }
    client.send_message(&ClientMessage::View { eye_m: [1.0; 3], radius_m: 10.0 }).await;
    settle(&mut client).await;
    let frame = client.replica.frame;
    client.frames_until(|client| client.replica.frame > frame + 5).await;
    assert!(requests.load(Relaxed) <= 1, "{} requests", requests.load(Relaxed));
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn of_many_choices_the_newest_is_carried_out() {
    let world = StandInWorld::default();
    let requests = Arc::clone(&world.requests);
    let (server, _) = Server::start_with(world, Limits { choices_per_s: 4.0, ..Limits::default() }, None).await;
    let mut client = PlainClient::join(&server, "client").await;
    for vehicle in [VehicleKind::Car, VehicleKind::Monster].repeat(50) {
        client.send_message(&ClientMessage::Choose { vehicle: Some(vehicle) }).await;
    }
    client.send_message(&ClientMessage::Choose { vehicle: Some(VehicleKind::Helicopter) }).await;
    client.frames_until(|client| client.objects.iter().any(|object| object.kind == VehicleKind::Helicopter)).await;
    assert!(requests.load(Relaxed) < 100, "{} requests", requests.load(Relaxed));
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn of_many_names_only_few_are_shown() {
    let server = Server::start(Limits { renames_per_s: 1e-3, ..Limits::default() }).await;
    let mut witness = PlainClient::join(&server, "witness").await;
    let mut client = PlainClient::join(&server, "client").await;
    for number in 0..50 {
        client.send_message(&ClientMessage::Rename { name: format!("name {number}") }).await;
    }
    settle(&mut client).await;
    let frame = witness.replica.frame;
    witness.frames_until(|witness| witness.replica.frame > frame + 5 && witness.peers.iter().any(|peer| peer.1 == "name 0")).await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn of_many_pings_only_few_are_answered() {
    let server = Server::start(Limits { pings_per_s: 1e-3, ..Limits::default() }).await;
    let mut client = PlainClient::join(&server, "client").await;
    for nonce in 0..50 {
        client.send_message(&ClientMessage::Ping { nonce }).await;
    }
    client.send_message(&ClientMessage::Choose { vehicle: Some(VehicleKind::Car) }).await;
    let mut pongs = 0;
    while client.objects.is_empty() {
        match client.receive().await.unwrap() {
            ServerMessage::Pong { .. } => pongs += 1,
            ServerMessage::FrameEnd { frame, .. } => client.send_message(&ClientMessage::Ack { frame }).await,
            _ => {}
        }
    }
    assert_eq!(pongs, 1);
    server.stop().await;
}
