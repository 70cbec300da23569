//! What is behind each path.

use super::{assets, session};
use crate::config::Limits;
use crate::runner::Published;
use crate::stream::{Clients, Counters};
use crate::world::Command;
use axum::Router;
use axum::extract::State;
use axum::extract::ws::WebSocketUpgrade;
use axum::http::{HeaderMap, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};
use axum::routing::{any, get};
use bytes::Bytes;
use serde_json::json;
use shared::wire::CLIENT_MESSAGE_LIMIT;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::time::Instant;
use tokio::sync::{Semaphore, mpsc, watch};

/// What the handlers share.
#[derive(Debug)]
pub(crate) struct App {
    pub(crate) clients: Arc<Clients>,
    pub(crate) counters: Arc<Counters>,
    pub(crate) published: watch::Receiver<Arc<Published>>,
    pub(crate) commands: mpsc::Sender<Command>,
    /// Name of the scene.
    pub(crate) scene_name: String,
    /// The scene message, the same for all.
    pub(crate) scene: Bytes,
    pub(crate) limits: Limits,
    /// One permit for each client that may still come.
    pub(crate) seats: Arc<Semaphore>,
    /// One permit for each socket that may be open before its hello.
    pub(crate) porch: Arc<Semaphore>,
    /// Becomes true when the server stops.
    pub(crate) stopping: watch::Receiver<bool>,
    pub(crate) started: Instant,
}

pub(crate) fn router(app: Arc<App>) -> Router {
    Router::new().route("/ws", any(socket)).route("/healthz", get(health)).fallback(get(asset)).with_state(app)
}

async fn socket(State(app): State<Arc<App>>, headers: HeaderMap, upgrade: WebSocketUpgrade) -> Response {
    if !same_origin(&headers) {
        let origin = headers.get(header::ORIGIN).map(|origin| String::from_utf8_lossy(origin.as_bytes()).into_owned());
        tracing::warn!(origin, "refused a socket to a page from elsewhere");
        return (StatusCode::FORBIDDEN, "the socket is for pages of this server only\n").into_response();
    }
    let Ok(place) = app.porch.clone().try_acquire_owned() else {
        return (StatusCode::SERVICE_UNAVAILABLE, "too many connections are being set up; try again\n").into_response();
    };
    upgrade
        .max_message_size(CLIENT_MESSAGE_LIMIT)
        .max_frame_size(CLIENT_MESSAGE_LIMIT)
        .read_buffer_size(2 * CLIENT_MESSAGE_LIMIT)
        .on_upgrade(move |socket| session::run(socket, app, place))
}

/// Whether a request comes from this server's own page, or from a program that is no browser (and sends no origin).
/// Without this check any page in the visitor's browser could drive a prairie that listens on its machine.
fn same_origin(headers: &HeaderMap) -> bool {
    let Some(origin) = headers.get(header::ORIGIN) else { return true };
    let origin_host = origin.to_str().ok().and_then(|origin| origin.split_once("://")).map(|(_, host)| host);
    let host = headers.get(header::HOST).and_then(|host| host.to_str().ok());
    matches!((origin_host, host), (Some(origin), Some(host)) if origin.eq_ignore_ascii_case(host))
}

async fn health(State(app): State<Arc<App>>) -> impl IntoResponse {
    let published = app.published.borrow().clone();
    let (snapshot, health) = (&published.snapshot, &published.snapshot.health);
    let clients: Vec<_> =
        app.clients.all().iter().map(|client| json!({ "client": client.id, "sent_bytes": client.sent_bytes() })).collect();
    let report = json!({
        "status": "ok",
        "version": env!("CARGO_PKG_VERSION"),
        "scene": app.scene_name,
        "uptime_secs": app.started.elapsed().as_secs_f64(),
        "tick": snapshot.tick,
        "time_secs": snapshot.time_secs,
        "dropped_secs": published.dropped_secs,
        "step_secs": health.step_secs,
        "step_max_secs": health.step_max_secs,
        "objects": snapshot.objects.len(),
        "awake_patches": health.awake_patches,
        "evicted_patches": health.evicted_patches,
        "broken_patches": health.broken_patches,
        "broken_plants": snapshot.broken.len(),
        "laid_tiles": health.laid_tiles,
        "dropped_tracks": health.dropped_tracks,
        "refused_motions": health.refused_motions,
        "bend_energy": health.bend_energy,
        "wind_energy": health.wind_energy,
        "wind_resets": health.wind_resets,
        "divergence_rms": health.divergence_rms,
        "sent_bytes": app.clients.sent_bytes(),
        "encodings": app.counters.encodings.load(Relaxed),
        "tracks": app.counters.tracks.load(Relaxed),
        "held": app.counters.held.load(Relaxed),
        "frames": app.counters.frames.load(Relaxed),
        "frames_skipped": app.counters.skipped.load(Relaxed),
        "clients": clients,
    });
    ([(header::CONTENT_TYPE, "application/json"), (header::CACHE_CONTROL, "no-store")], format!("{report}\n"))
}

async fn asset(uri: Uri, headers: HeaderMap) -> Response {
    let Some(asset) = assets::asset(uri.path()) else { return (StatusCode::NOT_FOUND, "no such page\n").into_response() };
    let lists = |name, value: &str| headers.get(name).and_then(|list| list.to_str().ok()).is_some_and(|list| list.contains(value));
    let common = [
        (header::ETAG, asset.etag),
        (header::CACHE_CONTROL, "no-cache"),
        (header::VARY, "accept-encoding"),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::CONTENT_TYPE, asset.content_type),
    ];
    if lists(header::IF_NONE_MATCH, asset.etag) {
        (StatusCode::NOT_MODIFIED, common).into_response()
    } else if lists(header::ACCEPT_ENCODING, "gzip") {
        (common, [(header::CONTENT_ENCODING, "gzip")], asset.gzip).into_response()
    } else {
        (common, asset.bytes).into_response()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn headers(pairs: &[(header::HeaderName, &str)]) -> HeaderMap {
        pairs.iter().map(|(name, value)| (name.clone(), value.parse().unwrap())).collect()
    }

    #[test]
    fn only_the_own_page_and_programs_get_a_socket() {
        let host = (header::HOST, "prairie.example:8080");
        assert!(same_origin(&headers(std::slice::from_ref(&host))));
        for (origin, allowed) in [
            ("http://prairie.example:8080", true),
            ("https://Prairie.example:8080", true),
            ("http://prairie.example", false),
            ("http://elsewhere.example:8080", false),
            ("null", false),
        ] {
            assert_eq!(same_origin(&headers(&[host.clone(), (header::ORIGIN, origin)])), allowed, "{origin}");
        }
    }
}
