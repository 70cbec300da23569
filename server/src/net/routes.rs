//! HTTP routes: `/ws`, the reports on the server, and the client's files.

use super::app::App;
use super::connection::Connection;
use super::upgrade::upgrade;
use super::{assets, health, session};
use axum::extract::{Request, State};
use axum::http::{HeaderMap, StatusCode, Uri, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::{any, get};
use axum::{Extension, Router};
use std::sync::Arc;

pub(crate) fn router(app: Arc<App>) -> Router {
    Router::new()
        .route("/ws", any(socket))
        .route("/healthz", get(health::health))
        .route("/readyz", get(health::readiness))
        .route("/metrics", get(health::metrics))
        .fallback(get(asset))
        .layer(middleware::from_fn_with_state(app.clone(), own_host))
        .with_state(app)
}

/// Answers only requests for a host of this server.
async fn own_host(State(app): State<Arc<App>>, request: Request, next: Next) -> Response {
    match app.access.check_host(request.headers(), request.version()) {
        Ok(()) => next.run(request).await,
        Err(rejection) => rejection.into_response(),
    }
}

async fn socket(
    State(app): State<Arc<App>>,
    Extension(connection): Extension<Arc<Connection>>,
    headers: HeaderMap,
    request: Request,
) -> Response {
    if let Err(rejection) = app.access.check_origin(&headers) {
        return rejection.into_response();
    }
    let Ok(slot) = app.pending_slots.clone().try_acquire_owned() else {
        return (StatusCode::SERVICE_UNAVAILABLE, "too many connections without a hello; try again later\n").into_response();
    };
    upgrade(request, move |socket| session::run(socket, app, connection, slot))
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
