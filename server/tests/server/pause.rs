//! A world pauses while nobody is there and only the wind moves.

use crate::test_client::PlainClient;
use crate::test_server::{Server, within};
use prairie::net::bind;
use prairie::world::World;
use prairie::{Config, scenes};
use serde_json::Value;
use std::time::Duration;

const AFTER: Duration = Duration::from_millis(200);

/// Serves the scene `meadow`, in which nothing drives by itself.
async fn meadow(pause_after: Option<Duration>) -> Server {
    let config = Config { pause_after, ..Config::new(scenes::load("meadow").unwrap()) };
    let world = World::new(&config.scene.scene, config.scene.maps()).unwrap();
    Server::start_config(world, config, bind("127.0.0.1:0").await.unwrap())
}

async fn health(server: &Server) -> Value {
    let response = String::from_utf8(server.http("GET /healthz HTTP/1.1").await).unwrap();
    serde_json::from_str(response.split_once("\r\n\r\n").expect("a body").1).unwrap()
}

async fn tick(server: &Server) -> u64 {
    health(server).await["tick"].as_u64().expect("a number of steps")
}

/// Waits until the world is paused, or runs; returns its tick.
async fn until(server: &Server, is_paused: bool) -> u64 {
    within(async {
        loop {
            let health = health(server).await;
            if health["paused"] == is_paused {
                return health["tick"].as_u64().unwrap();
            }
            tokio::time::sleep(Duration::from_millis(10)).await;
        }
    })
    .await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn an_empty_world_stands_still_until_somebody_comes() {
    let server = meadow(Some(AFTER)).await;
    let paused_at = until(&server, true).await;
    tokio::time::sleep(5 * AFTER).await;
    let waiting = health(&server).await;
    assert_eq!((&waiting["tick"], &waiting["status"]), (&paused_at.into(), &"ok".into()), "no step, and nothing is wrong");

    let mut client = PlainClient::join(&server, "client").await;
    let first = client.frame().await;
    until(&server, false).await;
    tokio::time::sleep(5 * AFTER).await;
    let watched = health(&server).await;
    assert!(watched["paused"] == false && watched["tick"].as_u64() > Some(paused_at + 10), "it runs while a client is there: {watched}");
    assert_eq!(watched["dropped_secs"], 0.0, "the time that stood still is not dropped");
    drop((client, first));

    let again = until(&server, true).await;
    server.http("GET /api/wind?x=1&z=1 HTTP/1.1").await;
    assert!(until(&server, false).await >= again, "a request for the fields wakes it");
    within(async { while tick(&server).await <= again {} }).await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_world_runs_on_where_pauses_are_off() {
    let server = meadow(None).await;
    until(&server, false).await;
    tokio::time::sleep(5 * AFTER).await;
    let first = tick(&server).await;
    tokio::time::sleep(AFTER).await;
    let health = health(&server).await;
    assert!(health["paused"] == false && health["tick"].as_u64() > Some(first), "{health}");
    server.stop().await;
}
