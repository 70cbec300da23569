//! HTTP routes: `/ws`, the reports on the server, `/api` with the fields and the scenes, `/report`, `/charts` and the client's files.

use super::app::App;
use super::connection::Connection;
use super::upgrade::upgrade;
use super::{api, files, health, page_errors, plan, scenes, security, session};
use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::{any, get, post};
use axum::{Extension, Router};
use std::sync::Arc;

pub(crate) fn router(app: Arc<App>) -> Router {
    Router::new()
        .route("/ws", any(socket))
        .route("/healthz", get(health::health))
        .route("/readyz", get(health::readiness))
        .route("/metrics", get(health::metrics))
        .route("/api/wind", get(api::wind).post(api::winds))
        .route("/api/bend", get(api::bend).post(api::bends))
        .route("/api/plan", get(plan::plan))
        .route("/api/budget", post(plan::set_budget))
        .route("/api/scenes", get(scenes::list))
        .route("/api/scenes/{name}/picture", get(scenes::picture))
        .route("/api/scene", post(scenes::change))
        .route("/report", post(page_errors::receive))
        .route("/charts", get(files::charts))
        .route("/charts.html", get(files::charts))
        .fallback(get(files::file))
        .layer(middleware::from_fn_with_state(app.clone(), until_stopped))
        .layer(middleware::from_fn_with_state(app.clone(), own_host))
        .layer(middleware::map_response(security::restrict))
        .with_state(app)
}

/// Answers only requests for a host of this server.
async fn own_host(State(app): State<Arc<App>>, request: Request, next: Next) -> Response {
    match app.access.check_host(request.headers(), request.version()) {
        Ok(()) => next.run(request).await,
        Err(rejection) => rejection.into_response(),
    }
}

/// Answers no request for the fields or the scenes once the run has stopped, and ends the connection with the response: the request after it is for the run
/// that follows, if there is one.
async fn until_stopped(State(app): State<Arc<App>>, request: Request, next: Next) -> Response {
    let mut response = if *app.stopping.borrow() && request.uri().path().starts_with("/api/") {
        (StatusCode::SERVICE_UNAVAILABLE, [(header::CONTENT_TYPE, "application/json")], "{\"error\":\"the server is stopping\"}\n")
            .into_response()
    } else {
        next.run(request).await
    };
    if *app.stopping.borrow() {
        response.headers_mut().entry(header::CONNECTION).or_insert(HeaderValue::from_static("close"));
    }
    response
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
