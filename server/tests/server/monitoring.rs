//! What monitoring sees: `/healthz`, `/readyz`, `/metrics`, and the Grafana dashboard that shows it.

use crate::stand_in::StandInWorld;
use crate::test_client::PlainClient;
use crate::test_server::{Server, within};
use prairie::Limits;
use prairie::metrics::{Format, METRICS};
use serde_json::Value;
use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;

const DASHBOARD: &str = include_str!("../../grafana/prairie.json");

/// Status and body of the response to a request.
async fn get(server: &Server, path: &str) -> (u16, String) {
    split(&server.http(&format!("GET {path} HTTP/1.1")).await)
}

fn split(response: &[u8]) -> (u16, String) {
    let text = String::from_utf8_lossy(response);
    let (head, body) = text.split_once("\r\n\r\n").expect("a response");
    (head.split(' ').nth(1).unwrap().parse().unwrap(), body.to_owned())
}

fn json(body: &str) -> Value {
    serde_json::from_str(body).unwrap_or_else(|error| panic!("{error}: {body}"))
}

/// Waits until the status in the body of `path` is `status`; returns code and body.
async fn until_status(server: &Server, path: &str, status: &str) -> (u16, Value) {
    within(async {
        loop {
            let (code, body) = get(server, path).await;
            let body = json(&body);
            if body["status"] == status {
                return (code, body);
            }
            tokio::time::sleep(Duration::from_millis(10)).await;
        }
    })
    .await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_server_is_ready_from_its_first_step_to_its_end() {
    let halted = Arc::new(AtomicBool::new(true));
    let (server, _) = Server::start_with(StandInWorld::halting(halted.clone()), Limits::default(), None).await;
    let (code, body) = until_status(&server, "/readyz", "starting").await;
    assert_eq!((code, &body["reason"]), (503, &"the world has not made its first step yet".into()));
    halted.store(false, Relaxed);
    assert_eq!(until_status(&server, "/readyz", "ready").await.0, 200);

    // Nothing is accepted any more; a connection that has been used before is told why.
    let mut open = TcpStream::connect(server.address).await.unwrap();
    let request = format!("GET /readyz HTTP/1.1\r\nhost: {}\r\n\r\n", server.address);
    let mut answers = Vec::new();
    let mut server = Some(server);
    for _ in 0..2 {
        open.write_all(request.as_bytes()).await.unwrap();
        let mut response = Vec::new();
        while !response.ends_with(b"}\n") {
            assert_ne!(within(open.read_buf(&mut response)).await.unwrap(), 0, "the connection was closed");
        }
        answers.push(split(&response));
        if let Some(server) = server.take() {
            server.stop().await;
        }
    }
    assert_eq!(answers[0].0, 200);
    let (code, body) = &answers[1];
    assert_eq!((*code, &json(body)["status"]), (503, &"stopping".into()));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn dropped_time_degrades_the_health() {
    let halted = Arc::new(AtomicBool::new(false));
    let (server, _) = Server::start_with(StandInWorld::halting(halted.clone()), Limits::default(), None).await;
    until_status(&server, "/readyz", "ready").await;
    halted.store(true, Relaxed);
    // Far more steps fall due than are caught up.
    tokio::time::sleep(Duration::from_millis(300)).await;
    halted.store(false, Relaxed);
    let (code, body) = until_status(&server, "/healthz", "degraded").await;
    let reason = body["reasons"][0].as_str().unwrap();
    assert!(code == 200 && reason.ends_with("s of simulated time were dropped within the last 60 s"), "{code}: {body}");
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_scrape_is_answered_while_the_world_is_halted() {
    let halted = Arc::new(AtomicBool::new(false));
    let (server, _) = Server::start_with(StandInWorld::halting(halted.clone()), Limits::default(), None).await;
    let mut client = PlainClient::join(&server, "client").await;
    client.frame().await;
    halted.store(true, Relaxed);
    let sent = async {
        loop {
            let text = get(&server, "/metrics").await.1;
            let has = |line: &str| text.lines().any(|found| found == line);
            if has("prairie_connected_clients 1") && !has("prairie_frame_bytes_count 0") && !has("prairie_step_duration_seconds_count 0") {
                return text;
            }
            tokio::time::sleep(Duration::from_millis(10)).await;
        }
    };
    let text = within(sent).await;
    assert!(text.contains("prairie_build_info{version=\"") && text.contains("scene=\"small\"} 1\n"), "{text}");
    assert_eq!(series(&text).iter().find(|series| series.contains("client=")), None, "no series is per client");
    halted.store(false, Relaxed);
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_text_is_well_formed() {
    let server = Server::start(Limits::default()).await;
    for (format, accept) in [(Format::Text, "text/plain"), (Format::OpenMetrics, "application/openmetrics-text;version=1.0.0,*/*;q=0.1")] {
        let response = server.http(&format!("GET /metrics HTTP/1.1\r\naccept: {accept}")).await;
        let (code, text) = split(&response);
        assert_eq!(code, 200);
        let head = String::from_utf8_lossy(&response);
        assert!(head.contains(&format!("content-type: {}\r\n", format.content_type())), "{head}");
        assert_eq!(text.ends_with("\n# EOF\n"), format == Format::OpenMetrics);
        assert_well_formed(text.trim_end_matches("# EOF\n"));
    }
    server.stop().await;
}

/// Every sample follows the description of its family, and is there once.
fn assert_well_formed(text: &str) {
    let (mut family, mut seen) = (String::new(), BTreeSet::new());
    for line in text.lines() {
        if let Some(rest) = line.strip_prefix("# HELP ") {
            family = rest.split(' ').next().unwrap().to_owned();
            assert!(rest.len() > family.len() + 1, "{line}: no help");
        } else if let Some(rest) = line.strip_prefix("# ") {
            let word = rest.split(' ').nth(1).unwrap();
            assert_eq!(word, family, "{line}");
        } else {
            let (series, value) = line.rsplit_once(' ').unwrap();
            assert!(series.starts_with(&family) && seen.insert(series.to_owned()), "{line}: not of {family}, or twice");
            value.parse::<f64>().unwrap_or_else(|error| panic!("{line}: {error}"));
        }
    }
    assert!(seen.len() > 50, "{seen:?}");
}

/// Series in a scrape, without values.
fn series(text: &str) -> BTreeSet<&str> {
    let samples = text.lines().filter(|line| !line.starts_with('#'));
    samples.map(|line| line.rsplit_once(' ').unwrap().0).collect()
}

/// Names that start with `prairie_` in an expression or query.
fn names(expression: &str) -> BTreeSet<&str> {
    let words = expression.split(|c: char| !c.is_ascii_alphanumeric() && c != '_');
    words.filter(|word| word.starts_with("prairie_")).collect()
}

/// Text values of `key` anywhere in the dashboard.
fn texts<'d>(value: &'d Value, key: &str, found: &mut Vec<&'d str>) {
    match value {
        Value::Object(fields) => {
            found.extend(fields.get(key).and_then(Value::as_str));
            fields.values().for_each(|value| texts(value, key, found));
        }
        Value::Array(items) => items.iter().for_each(|item| texts(item, key, found)),
        _ => {}
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_dashboard_shows_every_metric_and_no_other() {
    let server = Server::start(Limits::default()).await;
    let scrape = get(&server, "/metrics").await.1;
    server.stop().await;
    let scraped: BTreeSet<_> = series(&scrape).iter().map(|series| series.split('{').next().unwrap()).collect();
    let dashboard: Value = serde_json::from_str(DASHBOARD).expect("the dashboard is JSON");
    let (mut expressions, mut queries) = (Vec::new(), Vec::new());
    texts(&dashboard, "expr", &mut expressions);
    texts(&dashboard, "query", &mut queries);
    let shown: BTreeSet<_> = expressions.iter().chain(&queries).flat_map(|expression| names(expression)).collect();
    assert_eq!(shown.difference(&scraped).collect::<Vec<_>>(), [&""; 0], "/metrics has no such metric");
    for metric in METRICS.iter().filter(|metric| metric.is_scraped()) {
        let name = metric.prometheus_name();
        assert!(shown.contains(name.as_str()) || shown.contains(format!("{name}_bucket").as_str()), "no panel shows {name}");
    }
}

#[test]
fn the_panels_of_the_dashboard_fit_side_by_side() {
    let dashboard: Value = serde_json::from_str(DASHBOARD).expect("the dashboard is JSON");
    let panels = dashboard["panels"].as_array().unwrap();
    let ids: BTreeSet<_> = panels.iter().map(|panel| panel["id"].as_u64().unwrap()).collect();
    assert_eq!(ids.len(), panels.len(), "an id is used twice");
    let mut taken = BTreeSet::new();
    for panel in panels {
        let [x, y, w, h] = ["x", "y", "w", "h"].map(|key| panel["gridPos"][key].as_u64().unwrap());
        assert!(x + w <= 24, "{} is beyond the right edge", panel["title"]);
        for place in (x..x + w).flat_map(|x| (y..y + h).map(move |y| (x, y))) {
            assert!(taken.insert(place), "{} covers another panel", panel["title"]);
        }
    }
}
