//! HTTP: pages, `/healthz`, the checks of host and origin, and how a run ends.

use crate::stand_in::{StandInWorld, scene};
use crate::test_client::PlainClient;
use crate::test_server::{Server, within};
use prairie::net::bind;
use prairie::{Config, Limits, RunError};
use prairie_core::wire::{ClientMessage, Close, Refusal, ServerMessage};
use std::io::Read as _;
use std::time::Duration;
use tokio::net::TcpStream;
use tokio_tungstenite::tungstenite;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn clients_are_notified_when_the_server_stops() {
    let server = Server::start(Limits::default()).await;
    let mut client = PlainClient::join(&server, "client").await;
    client.frame().await;
    server.stop().await;
    assert_eq!(client.closed().await.0, Close::Stopping.code());
    assert_eq!(client.refusals, [Refusal::Stopping]);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_run_ends_after_all_shutdown_notices() {
    let server = Server::start(Limits::default()).await;
    let silent = PlainClient::connect(&server).await;
    let mut client = PlainClient::join(&server, "client").await;
    client.frame().await;
    server.stop().await;
    for client in [silent, client] {
        // Neither client closes; the server has closed after its last message.
        let mut stream = client.socket.into_inner().into_std().unwrap();
        let mut rest = Vec::new();
        stream.read_to_end(&mut rest).expect("nothing is left open");
        let code = Close::Stopping.code().to_be_bytes();
        assert!(rest.windows(2).any(|pair| pair == code), "{rest:?}");
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_panic_in_the_stream_ends_the_run_with_an_error() {
    let (server, _) = Server::start_with(StandInWorld::misshapen_at(40), Limits::default(), None).await;
    let mut client = PlainClient::join(&server, "client").await;
    while let Ok(message) = client.receive().await {
        if let ServerMessage::FrameEnd { frame, .. } = message {
            client.send_message(&ClientMessage::Ack { frame }).await;
        }
    }
    assert!(matches!(within(server.outcome).await.unwrap(), Err(RunError::StreamStopped)));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_panic_in_the_world_ends_the_run_with_an_error() {
    let world = StandInWorld::failing_at(20);
    let (server, _) = Server::start_with(world, Limits::default(), None).await;
    assert!(matches!(within(server.outcome).await.unwrap(), Err(RunError::WorldStopped)));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn pages_health_and_origins_are_served() {
    let server = Server::start(Limits::default()).await;
    let text = |response: Vec<u8>| String::from_utf8_lossy(&response).into_owned();
    let page = text(server.http("GET / HTTP/1.1").await);
    assert!(page.starts_with("HTTP/1.1 200") && page.contains("text/html"), "{page}");
    let etag = page.lines().find_map(|line| line.strip_prefix("etag: ")).expect("a tag").trim().to_owned();
    assert!(text(server.http(&format!("GET / HTTP/1.1\r\nif-none-match: {etag}")).await).starts_with("HTTP/1.1 304"));
    let packed = server.http("GET / HTTP/1.1\r\naccept-encoding: gzip").await;
    assert!(text(packed.clone()).contains("content-encoding: gzip") && packed.windows(2).any(|pair| pair == [0x1f, 0x8b]));
    assert!(text(server.http("GET /../Cargo.toml HTTP/1.1").await).starts_with("HTTP/1.1 404"));
    assert!(text(server.http("POST / HTTP/1.1").await).starts_with("HTTP/1.1 405"));
    assert!(text(server.http("nonsense").await).starts_with("HTTP/1.1 400"));

    let mut client = PlainClient::join(&server, "client").await;
    client.frame().await;
    // The first frame may show the world before its first step, and may be counted after it has arrived.
    within(async {
        loop {
            let health = text(server.http("GET /healthz HTTP/1.1").await);
            let report: serde_json::Value = serde_json::from_str(health.split("\r\n\r\n").nth(1).unwrap()).unwrap();
            assert_eq!(report["scene"], "small");
            if report["tick"].as_u64().unwrap() > 0 && report["clients"][0]["sent_bytes"].as_u64().unwrap() > 0 {
                break;
            }
            tokio::time::sleep(Duration::from_millis(10)).await;
        }
    })
    .await;

    let address = server.address.to_string();
    assert_eq!(open_web_socket(&server, &address, &format!("http://{address}")).await, 101);
    assert_eq!(open_web_socket(&server, &address, "http://elsewhere.example").await, 403);
    server.stop().await;
}

/// The status of a response and its JSON.
async fn json_of(server: &Server, request: &str) -> (u16, serde_json::Value) {
    let response = String::from_utf8(server.http(request).await).unwrap();
    let (head, body) = response.split_once("\r\n\r\n").unwrap();
    (head.split(' ').nth(1).unwrap().parse().unwrap(), serde_json::from_str(body).unwrap())
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn wind_and_bend_are_read_by_http() {
    let server = Server::start(Limits::default()).await;
    let mut client = PlainClient::join(&server, "client").await;
    client.frame().await;
    let (status, wind) = json_of(&server, "GET /api/wind?x=3.5&z=2&y=9 HTTP/1.1").await;
    assert_eq!(status, 200, "{wind}");
    // The stand-in's wind has the same code everywhere, and no gusts.
    let code = wind["wind_tick"].as_u64().unwrap() % 100;
    let expected = prairie_core::wire::quantise::CodeSteps::default().wind_m_per_s(code as i16);
    let resolved: [f32; 3] = serde_json::from_value(wind["resolved_m_per_s"].clone()).unwrap();
    assert!(resolved.iter().all(|speed| (speed - expected).abs() < 1e-4), "{wind} instead of {expected}");
    assert_eq!(wind["gust_m_per_s"], serde_json::json!([0.0, 0.0]));
    let (status, bend) = json_of(&server, "GET /api/bend?x=3.5&z=2 HTTP/1.1").await;
    assert!(status == 200 && bend["bend_rad"].as_array().is_some_and(|lean| lean.len() == 2), "{bend}");
    let body = r#"{"at_m": [[1, 9, 1], [2, 9, 2], [3, 9, 3]]}"#;
    let post = |path: &str, body: &str| {
        format!("POST {path} HTTP/1.1\r\ncontent-length: {}\r\nconnection: close\r\nhost: {}\r\n\r\n{body}", body.len(), server.address)
    };
    let (status, winds) = json_of(&server, &post("/api/wind", body)).await;
    assert!(status == 200 && winds["wind_m_per_s"].as_array().is_some_and(|winds| winds.len() == 3), "{winds}");
    let (status, error) = json_of(&server, &post("/api/bend", body)).await;
    assert_eq!((status, error["error"].as_str()), (400, Some("`at_m[0]` has 3 numbers; allowed: [x, z]")));
    let (status, error) = json_of(&server, "GET /api/wind?x=1 HTTP/1.1").await;
    assert_eq!((status, error["error"].as_str()), (400, Some("`z` is missing: a number of metres")));
    server.stop().await;
}

/// The status of the response to a WebSocket request with these headers.
async fn open_web_socket(server: &Server, host: &str, origin: &str) -> u16 {
    let mut request = format!("ws://{host}/ws").into_client_request().unwrap();
    request.headers_mut().insert("origin", origin.parse().unwrap());
    let stream = TcpStream::connect(server.address).await.unwrap();
    match within(tokio_tungstenite::client_async(request, stream)).await {
        Ok((_, response)) => response.status().as_u16(),
        Err(tungstenite::Error::Http(response)) => response.status().as_u16(),
        Err(other) => panic!("{host}, {origin}: {other}"),
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn requests_for_other_hosts_are_rejected() {
    let server = Server::start(Limits::default()).await;
    for path in ["/", "/ws", "/healthz", "/nothing"] {
        let response = server.http_at("elsewhere.example", &format!("GET {path} HTTP/1.1")).await;
        let response = String::from_utf8(response).unwrap();
        assert!(response.starts_with("HTTP/1.1 421") && response.contains("`elsewhere.example`"), "{path}: {response}");
    }
    let rebound = open_web_socket(&server, "elsewhere.example", "http://elsewhere.example").await;
    assert_eq!(rebound, 421, "a page whose name leads here");
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn allowed_hosts_and_origins_of_proxies_are_served() {
    let listener = bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap().to_string();
    let config = Config {
        allow_hosts: vec!["prairie.example".parse().unwrap()],
        allow_origins: vec!["https://play.example".parse().unwrap()],
        ..Config::new(scene())
    };
    let server = Server::start_config(StandInWorld::default(), config, listener);
    assert!(server.http_at("prairie.example", "GET / HTTP/1.1").await.starts_with(b"HTTP/1.1 200"));
    for (host, origin, status) in [
        (address.as_str(), "https://play.example", 101),
        ("play.example", "https://play.example", 101),
        ("prairie.example", "https://prairie.example", 101),
        ("prairie.example", "https://elsewhere.example", 403),
        ("elsewhere.example", "https://play.example", 421),
    ] {
        assert_eq!(open_web_socket(&server, host, origin).await, status, "{host}, {origin}");
    }
    server.stop().await;
}
