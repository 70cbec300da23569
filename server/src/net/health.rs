//! Reports on the server for people, monitoring and load balancers: `/healthz`, `/readyz` and `/metrics`.
//!
//! All three report the last published state and never wait for the simulation.

use super::app::App;
use crate::metrics;
use crate::runner::RECENT;
use axum::extract::State;
use axum::http::{HeaderMap, HeaderName, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde_json::{Map, Value, json};
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::time::Duration;

/// Age of the newest publication from which the world counts as stuck. The slowest server publishes once a second.
const STUCK: Duration = Duration::from_secs(10);

const NO_STORE: (HeaderName, &str) = (header::CACHE_CONTROL, "no-store");

/// `/healthz`: the status with the reasons why it is degraded, and the metrics, as JSON. Always 200: a restart does not make a slow machine faster.
pub(super) async fn health(State(app): State<Arc<App>>) -> Response {
    let published = app.published.borrow().clone();
    let reasons = degradations(published.dropped_recently_secs, published.at.elapsed(), app.journal.failure());
    let clients: Vec<_> =
        app.clients.all().iter().map(|client| json!({ "client": client.id, "sent_bytes": client.sent_bytes() })).collect();
    let stats = app.stats(&published);
    let metrics = metrics::report(&published.snapshot, &stats);
    let mut report: Map<String, Value> = metrics.map(|(name, value)| (name.to_owned(), json!(value))).collect();
    report.insert("status".to_owned(), if reasons.is_empty() { "ok" } else { "degraded" }.into());
    report.insert("reasons".to_owned(), reasons.into());
    report.insert("paused".to_owned(), published.is_paused.into());
    report.insert("version".to_owned(), env!("CARGO_PKG_VERSION").into());
    report.insert("scene".to_owned(), app.scene_name.as_str().into());
    report.insert("clients".to_owned(), clients.into());
    json_response(StatusCode::OK, &Value::Object(report))
}

/// `/readyz`: 200 while the world steps and the stream runs, else 503 with the reason, as JSON.
pub(super) async fn readiness(State(app): State<Arc<App>>) -> Response {
    let published = app.published.borrow().clone();
    let is_stopping = *app.stopping.borrow();
    match obstacle(is_stopping, published.snapshot.tick, app.counters.publications.load(Relaxed), published.at.elapsed()) {
        None => json_response(StatusCode::OK, &json!({ "status": "ready" })),
        Some((status, reason)) => json_response(StatusCode::SERVICE_UNAVAILABLE, &json!({ "status": status, "reason": reason })),
    }
}

/// `/metrics`: the metrics for Prometheus.
pub(super) async fn metrics(State(app): State<Arc<App>>, headers: HeaderMap) -> Response {
    let format = metrics::Format::accepted_by(headers.get(header::ACCEPT).and_then(|accept| accept.to_str().ok()).unwrap_or_default());
    let published = app.published.borrow().clone();
    match metrics::exposition(format, &app.scene_name, &published.snapshot, &app.stats(&published)) {
        Ok(text) => ([(header::CONTENT_TYPE, format.content_type()), NO_STORE], text).into_response(),
        Err(error) => (StatusCode::INTERNAL_SERVER_ERROR, format!("the metrics cannot be written: {error}\n")).into_response(),
    }
}

fn json_response(status: StatusCode, body: &Value) -> Response {
    (status, [(header::CONTENT_TYPE, "application/json"), NO_STORE], format!("{body}\n")).into_response()
}

/// Reasons why the server is degraded: simulated time dropped within the last minute, the age of the newest publication, and the journal's failure.
fn degradations(dropped_recently_secs: f64, age: Duration, journal_failure: Option<String>) -> Vec<String> {
    let dropped = (dropped_recently_secs > 0.0)
        .then(|| format!("{dropped_recently_secs:.2} s of simulated time were dropped within the last {} s", RECENT.as_secs()));
    let unkept = journal_failure.map(|failure| format!("{failure}; a crash loses what happens until it can be"));
    dropped.into_iter().chain(stuck(age)).chain(unkept).collect()
}

/// Why the server is not ready: a status and the reason. `tick` and `age` are those of the newest publication, `streamed` is the number of publications
/// that the stream has handled.
fn obstacle(is_stopping: bool, tick: u64, streamed: u64, age: Duration) -> Option<(&'static str, String)> {
    if is_stopping {
        return Some(("stopping", "the server is stopping".to_owned()));
    }
    if tick == 0 {
        return Some(("starting", "the world has not made its first step yet".to_owned()));
    }
    if streamed == 0 {
        return Some(("starting", "the stream to the clients does not run yet".to_owned()));
    }
    stuck(age).map(|reason| ("stuck", reason))
}

fn stuck(age: Duration) -> Option<String> {
    (age >= STUCK).then(|| format!("the world has published nothing for {} s", age.as_secs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_server_is_degraded_while_it_drops_time_or_is_stuck_or_keeps_nothing() {
        let full = || Some("a checkpoint of the world cannot be written: no space".to_owned());
        assert!(degradations(0.0, Duration::from_secs(9), None).is_empty());
        assert_eq!(degradations(1.504, Duration::ZERO, None), ["1.50 s of simulated time were dropped within the last 60 s"]);
        assert_eq!(degradations(0.0, Duration::from_secs(12), None), ["the world has published nothing for 12 s"]);
        let unkept = degradations(0.0, Duration::ZERO, full());
        assert_eq!(unkept, ["a checkpoint of the world cannot be written: no space; a crash loses what happens until it can be"]);
        assert_eq!(degradations(0.1, Duration::from_secs(12), full()).len(), 3);
    }

    #[test]
    fn a_server_is_ready_between_its_first_publication_and_its_end() {
        let status = |is_stopping, tick, streamed, age| obstacle(is_stopping, tick, streamed, age).map(|(status, _)| status);
        assert_eq!(status(false, 3, 1, Duration::ZERO), None);
        assert_eq!(status(false, 0, 1, Duration::ZERO), Some("starting"));
        assert_eq!(status(false, 3, 0, Duration::ZERO), Some("starting"));
        assert_eq!(status(true, 3, 1, Duration::ZERO), Some("stopping"));
        assert_eq!(status(false, 3, 1, STUCK), Some("stuck"));
    }
}
