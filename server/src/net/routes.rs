//! HTTP routes: `/ws`, the reports on the server, and the client's files.

use super::app::App;
use super::{assets, health, session};
use axum::Router;
use axum::extract::State;
use axum::extract::ws::WebSocketUpgrade;
use axum::http::{HeaderMap, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};
use axum::routing::{any, get};
use prairie_core::wire::CLIENT_MESSAGE_LIMIT;
use std::sync::Arc;

pub(crate) fn router(app: Arc<App>) -> Router {
    Router::new()
        .route("/ws", any(socket))
        .route("/healthz", get(health::health))
        .route("/readyz", get(health::readiness))
        .route("/metrics", get(health::metrics))
        .fallback(get(asset))
        .with_state(app)
}

async fn socket(State(app): State<Arc<App>>, headers: HeaderMap, upgrade: WebSocketUpgrade) -> Response {
    if !same_origin(&headers) {
        let origin = headers.get(header::ORIGIN).map(|origin| String::from_utf8_lossy(origin.as_bytes()).into_owned());
        tracing::warn!(origin, "rejected a WebSocket from another origin");
        return (StatusCode::FORBIDDEN, "only pages of this server may open the WebSocket\n").into_response();
    }
    let Ok(slot) = app.pending_slots.clone().try_acquire_owned() else {
        return (StatusCode::SERVICE_UNAVAILABLE, "too many connections without a hello; try again later\n").into_response();
    };
    upgrade
        .max_message_size(CLIENT_MESSAGE_LIMIT)
        .max_frame_size(CLIENT_MESSAGE_LIMIT)
        .read_buffer_size(2 * CLIENT_MESSAGE_LIMIT)
        .on_upgrade(move |socket| session::run(socket, app, slot))
}

/// Whether a request comes from a page of this server, or from a program other than a browser (without an origin).
/// Without this check any page in the user's browser could control a server on the same machine.
fn same_origin(headers: &HeaderMap) -> bool {
    let Some(origin) = headers.get(header::ORIGIN) else { return true };
    let origin_host = origin.to_str().ok().and_then(|origin| origin.split_once("://")).map(|(_, host)| host);
    let host = headers.get(header::HOST).and_then(|host| host.to_str().ok());
    matches!((origin_host, host), (Some(origin), Some(host)) if origin.eq_ignore_ascii_case(host))
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
    fn only_own_pages_and_programs_may_open_the_web_socket() {
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
