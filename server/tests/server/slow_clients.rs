//! Clients on slow lines, and clients that need long to build the scene.

use crate::test_client::PlainClient;
use crate::test_server::{Server, within};
use prairie::Limits;
use prairie_core::wire::{ClientMessage, Close, ServerMessage};
use std::time::Duration;
use tokio::io::AsyncReadExt;
use tokio::time::sleep;

/// Joins without reading more than the welcome, once the scene has begun to arrive.
async fn join_without_reading(server: &Server) -> PlainClient {
    let mut client = PlainClient::connect_from(server, [127, 0, 0, 1]).await;
    client.ask_to_join("deaf").await;
    assert!(matches!(client.receive().await, Ok(ServerMessage::Welcome { .. })));
    within(client.socket.get_ref().readable()).await.unwrap();
    client
}

/// Resident memory of this process (bytes).
#[cfg(target_os = "linux")]
fn resident_bytes() -> usize {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    line.trim().trim_end_matches(" kB").parse::<usize>().unwrap() << 10
}

#[cfg(target_os = "linux")]
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn all_clients_share_one_scene_in_memory() {
    const MAP_BYTES: usize = 16 << 20;
    const CLIENTS: usize = 24;
    let server = Server::start_large(MAP_BYTES, Limits::default()).await;
    let mut clients = vec![join_without_reading(&server).await];
    let before = resident_bytes();
    for _ in 1..CLIENTS {
        clients.push(join_without_reading(&server).await);
    }
    let grown = resident_bytes().saturating_sub(before);
    println!("{CLIENTS} clients that do not read a scene of {} MiB: {:.1} MiB more", MAP_BYTES >> 20, grown as f64 / 1048576.0);
    assert!(grown < MAP_BYTES, "{grown} bytes more");
    drop(clients);
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_scene_may_take_longer_than_the_stall_timeout() {
    const MAP_BYTES: usize = 8 << 20;
    let limits = Limits { stall_timeout: Duration::from_millis(500), load_timeout: Duration::from_secs(60), ..Limits::default() };
    let server = Server::start_large(MAP_BYTES, limits).await;
    let mut witness = PlainClient::join(&server, "witness").await;
    let mut slow = PlainClient::connect_from(&server, [127, 0, 0, 1]).await;
    slow.ask_to_join("slow").await;
    let (mut received, mut buffer) = (0, vec![0; 256 << 10]);
    // Two seconds in all. The witness reads and acknowledges meanwhile.
    while received < MAP_BYTES {
        let read = within(slow.socket.get_mut().read(&mut buffer)).await.unwrap();
        assert!(read > 0, "closed after {received} bytes");
        received += read;
        if received / buffer.len() != (received - read) / buffer.len() {
            sleep(Duration::from_millis(60)).await;
            witness.frame().await;
        }
    }
    witness.frames_until(|witness| witness.peers.len() == 2).await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_stopping_server_says_so_while_a_scene_travels() {
    let server = Server::start_large(8 << 20, Limits::default()).await;
    let mut client = join_without_reading(&server).await;
    let ((), (code, _)) = tokio::join!(server.stop(), client.closed());
    assert_eq!(code, Close::Stopping.code());
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_client_may_pause_while_it_starts_and_not_later() {
    let limits = Limits { stall_timeout: Duration::from_millis(200), load_timeout: Duration::from_secs(3), ..Limits::default() };
    let server = Server::start(limits).await;
    let mut client = PlainClient::join(&server, "client").await;
    // The client builds the scene; then, after some frames, it compiles its shaders.
    for pause_secs in [0.7, 0.7, 0.0] {
        sleep(Duration::from_secs_f32(pause_secs)).await;
        for _ in 0..10 {
            client.frame().await;
        }
    }
    assert_eq!(client.closed().await.0, Close::Stalled.code());
    let mut silent = PlainClient::join(&server, "silent").await;
    silent.send_message(&ClientMessage::Ack { frame: 0 }).await;
    assert!(matches!(silent.receive().await, Ok(ServerMessage::Poses { .. })));
    server.stop().await;
}
