//! Scenes by HTTP: the menu: the list, a picture of each, and the change to one.

use super::app::App;
use crate::scene_menu::ChangeError;
use crate::scenes;
use axum::body::{Body, to_bytes};
use axum::extract::{Path, State};
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::sync::Arc;

/// Largest body of a request (bytes).
const BODY_LIMIT: usize = 4096;

/// Cache period of a picture: a day, since its name stays the same when the picture changes.
const PICTURE_CACHE: &str = "public, max-age=86400";

/// `GET /api/scenes`: the running scene, whether pages may change it, and descriptions of all.
pub(super) async fn list(State(app): State<Arc<App>>) -> Response {
    let scenes: Vec<_> = app.scene_menu.scenes().collect();
    answer(StatusCode::OK, &json!({ "running": app.scene_name, "pages_may_change": app.scene_menu.is_open(), "scenes": scenes }))
}

/// `GET /api/scenes/NAME/picture`: a picture of a built-in scene.
pub(super) async fn picture(Path(name): Path<String>) -> Response {
    match scenes::picture(&name) {
        Some(jpeg) => ([(header::CONTENT_TYPE, "image/jpeg"), (header::CACHE_CONTROL, PICTURE_CACHE)], jpeg).into_response(),
        None => (StatusCode::NOT_FOUND, "no such scene\n").into_response(),
    }
}

/// Body of a request for a scene.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Choice {
    name: String,
}

/// `POST /api/scene`: changes to a scene for everyone, and answers when its world is ready.
pub(super) async fn change(State(app): State<Arc<App>>, headers: HeaderMap, body: Body) -> Response {
    let choice: Choice = match read_json(&app, &headers, body, "name").await {
        Ok(choice) => choice,
        Err(refusal) => return refusal,
    };
    match app.scene_menu.change(&choice.name).await {
        Ok(()) => answer(StatusCode::OK, &json!({ "running": choice.name })),
        Err(error) => {
            let status = match error {
                ChangeError::NotAllowed => StatusCode::FORBIDDEN,
                ChangeError::Unknown { .. } => StatusCode::BAD_REQUEST,
                ChangeError::Busy => StatusCode::CONFLICT,
                ChangeError::Failed(_) | ChangeError::Stopping => StatusCode::SERVICE_UNAVAILABLE,
            };
            refuse(status, &error.to_string())
        }
    }
}

/// The JSON object with `field` in the body of a request from a page that may ask, or the answer that says what is wrong.
pub(super) async fn read_json<T: DeserializeOwned>(app: &App, headers: &HeaderMap, body: Body, field: &str) -> Result<T, Response> {
    if let Err((status, reason)) = app.access.check_origin(headers) {
        return Err(refuse(status, reason.trim_end()));
    }
    let Ok(body) = to_bytes(body, BODY_LIMIT).await else {
        return Err(refuse(StatusCode::PAYLOAD_TOO_LARGE, &format!("the body has more than {BODY_LIMIT} bytes")));
    };
    serde_json::from_slice(&body)
        .map_err(|error| refuse(StatusCode::BAD_REQUEST, &format!("the body is not a JSON object with `{field}`: {error}")))
}

pub(super) fn refuse(status: StatusCode, error: &str) -> Response {
    answer(status, &json!({ "error": error }))
}

pub(super) fn answer(status: StatusCode, body: &Value) -> Response {
    (status, [(header::CONTENT_TYPE, "application/json"), (header::CACHE_CONTROL, "no-store")], format!("{body}\n")).into_response()
}
