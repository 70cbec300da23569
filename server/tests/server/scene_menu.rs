//! The menu of scenes: the list, and a change while the server runs.

use crate::test_client::PlainClient;
use crate::test_server::{Server, within};
use prairie::net::bind;
use prairie::{Config, journal, run_and_reload, scenes};
use prairie_core::wire::{ClientMessage, Close, ServerMessage};
use serde_json::{Value, json};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::sync::oneshot;

/// Serves a built-in scene like the program, with worlds that are kept in a folder.
async fn start(scene: &str, folder: &std::path::Path, pages_change_scene: bool) -> Server {
    let listener = bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let (stop, stopped) = oneshot::channel();
    let world = Some(journal::WorldFolder::new(folder.to_owned()));
    let config = Config { world, pages_change_scene, threads: Some(1), ..Config::new(scenes::load(scene).unwrap()) };
    let world = journal::open(config.world.as_ref(), &config.scene).unwrap();
    Server { address, stop, outcome: tokio::spawn(run_and_reload(world, config, listener, async { drop(stopped.await) })) }
}

/// Status and JSON body of a request.
pub(crate) async fn ask(server: &Server, request: &str, body: &str) -> (u16, Value) {
    let head = if body.is_empty() { request.to_owned() } else { format!("{request}\r\ncontent-length: {}", body.len()) };
    let response = server.http_with_body(&head, body).await;
    let text = String::from_utf8(response).unwrap();
    let (head, body) = text.split_once("\r\n\r\n").unwrap();
    (head[9..12].parse().unwrap(), serde_json::from_str(body).unwrap_or(Value::Null))
}

async fn change(server: &Server, scene: &str) -> (u16, Value) {
    ask(server, "POST /api/scene HTTP/1.1", &json!({ "name": scene }).to_string()).await
}

/// Joins as a new client; returns the name of the scene and the step of the first frame.
async fn join(server: &Server) -> (PlainClient, String, u64) {
    let mut client = PlainClient::connect(server).await;
    client.send_message(&ClientMessage::Hello { name: "Ada".to_owned() }).await;
    let mut name = String::new();
    loop {
        match within(client.receive()).await.unwrap() {
            ServerMessage::Welcome { scene_name, .. } => name = scene_name,
            ServerMessage::FrameEnd { tick, .. } => return (client, name, tick),
            _ => {}
        }
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_page_changes_the_scene_for_everyone_and_returns_to_a_world_that_went_on() {
    let folder = tempfile::tempdir().unwrap();
    let server = start("shells", folder.path(), true).await;
    let (status, list) = ask(&server, "GET /api/scenes HTTP/1.1", "").await;
    assert_eq!((status, &list["running"], &list["pages_may_change"]), (200, &json!("shells"), &json!(true)));
    assert_eq!(list["scenes"].as_array().unwrap().len(), scenes::list().count());
    let (mut client, name, first_tick) = join(&server).await;
    assert_eq!(name, "shells");

    assert_eq!(change(&server, "shells").await, (200, json!({ "running": "shells" })), "the running scene goes on");
    client.frame().await;
    let mut kept_open = TcpStream::connect(server.address).await.unwrap();
    let request = format!("GET /api/scenes HTTP/1.1\r\nhost: {}\r\n\r\n", server.address);
    kept_open.write_all(request.as_bytes()).await.unwrap();
    kept_open.readable().await.unwrap();
    assert_eq!(change(&server, "blades").await, (200, json!({ "running": "blades" })));
    assert_eq!(client.closed().await.0, Close::Stopping.code());
    // The world before does not answer any more.
    kept_open.write_all(request.as_bytes()).await.unwrap();
    let mut answers = String::new();
    within(kept_open.read_to_string(&mut answers)).await.unwrap();
    let statuses: Vec<_> = answers.split("HTTP/1.1 ").skip(1).map(|answer| &answer[..3]).collect();
    assert_eq!(statuses, ["200", "503"], "{answers}");
    let (mut client, name, _) = join(&server).await;
    assert_eq!(name, "blades");
    assert_eq!(ask(&server, "GET /api/scenes HTTP/1.1", "").await.1["running"], json!("blades"));

    assert_eq!(change(&server, "shells").await.0, 200);
    assert_eq!(client.closed().await.0, Close::Stopping.code());
    let (_, name, tick) = join(&server).await;
    assert!(name == "shells" && tick > first_tick, "{name} starts again at step {tick}");
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn requests_that_are_wrong_or_not_allowed_leave_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let server = start("shells", folder.path(), true).await;
    let (status, said) = change(&server, "strom").await;
    assert!(status == 400 && said["error"].as_str().unwrap().starts_with("`name` is \"strom\"; allowed: meadow, "), "{said}");
    for body in ["{}", "[", "{\"name\": \"storm\", \"at\": 1}"] {
        let (status, said) = ask(&server, "POST /api/scene HTTP/1.1", body).await;
        assert!(status == 400 && said["error"].as_str().unwrap().contains("JSON object with `name`"), "{said}");
    }
    assert_eq!(change(&server, &"x".repeat(5000)).await.0, 413);
    let from_elsewhere = "POST /api/scene HTTP/1.1\r\norigin: http://elsewhere.example";
    assert_eq!(ask(&server, from_elsewhere, "{\"name\": \"storm\"}").await.0, 403);
    let (_, picture) =
        (ask(&server, "GET /api/scenes/moon/picture HTTP/1.1", "").await, server.http("GET /api/scenes/storm/picture HTTP/1.1").await);
    assert!(picture.windows(3).any(|bytes| bytes == [0xff, 0xd8, 0xff]));
    assert_eq!(join(&server).await.1, "shells");
    server.stop().await;

    let server = start("shells", folder.path(), false).await;
    let (status, said) = change(&server, "storm").await;
    assert!(status == 403 && said["error"].as_str().unwrap().contains("--change-scene everyone"), "{said}");
    assert_eq!(ask(&server, "GET /api/scenes HTTP/1.1", "").await.1["pages_may_change"], json!(false));
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_world_that_is_in_use_elsewhere_leaves_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let server = start("shells", folder.path(), true).await;
    let other = start("blades", folder.path(), true).await;
    let (status, said) = change(&server, "blades").await;
    assert!(status == 503 && said["error"].as_str().unwrap().starts_with("the scene cannot be started: "), "{said}");
    assert_eq!(join(&server).await.1, "shells");
    other.stop().await;
    assert_eq!(change(&server, "blades").await.0, 200);
    server.stop().await;
}
