//! The plan of the running scene by HTTP, what the run makes of it at present, and its budget.

use super::app::App;
use super::scenes::{answer, read_json, refuse};
use crate::detail::Decision;
use axum::body::Body;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode};
use axum::response::Response;
use serde::Deserialize;
use serde_json::{Value, json};
use std::ops::RangeInclusive;
use std::sync::Arc;

/// Allowed budgets (ms), as in scene files.
const BUDGET_MS: RangeInclusive<f32> = 0.001..=1000.0;

/// `GET /api/plan`: what the running scene models, by which methods, with which errors and costs, and why; and under `now` in which detail it runs.
pub(super) async fn plan(State(app): State<Arc<App>>) -> Response {
    let mut body = json!(*app.explanation);
    body["now"] = now(&app);
    answer(StatusCode::OK, &body)
}

/// The present detail, its errors and its decisions.
fn now(app: &App) -> Value {
    let published = app.published.borrow().clone();
    let (diagnostics, decisions) = (&published.snapshot.diagnostics, &published.snapshot.decisions);
    let decision = |Decision { tick, detail, level, reason, .. }: &Decision| {
        let time_secs = *tick as f64 / f64::from(app.tick_hz);
        json!({ "tick": tick, "time_secs": time_secs, "detail": detail.to_string(), "level": level, "reason": reason.to_string() })
    };
    json!({
        "control": published.control,
        "may_set_budget": app.scene_menu.is_open() && app.explanation.demands.is_some(),
        "wind_step_secs": diagnostics.wind_step_secs,
        "awake_limit": diagnostics.awake_limit,
        "level": diagnostics.load_level,
        "gives_way": decisions.last().map(Decision::gives_way).unwrap_or_default(),
        "decisions": decisions.iter().map(decision).collect::<Vec<_>>(),
    })
}

/// Body of a request for a budget.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Budget {
    server_ms: f32,
}

/// `POST /api/budget`: sets the time that a tick may take on the server, until the server stops or the world begins anew.
pub(super) async fn set_budget(State(app): State<Arc<App>>, headers: HeaderMap, body: Body) -> Response {
    let Budget { server_ms } = match read_json(&app, &headers, body, "server_ms").await {
        Ok(budget) => budget,
        Err(refusal) => return refusal,
    };
    if !app.scene_menu.is_open() {
        return refuse(
            StatusCode::FORBIDDEN,
            "pages may not change the budget of this server; `--change-scene everyone` at its start lets them",
        );
    }
    if app.explanation.demands.is_none() {
        return refuse(StatusCode::CONFLICT, "the scene has neither `[accuracy]` nor `[budget]`: its detail stays as it is");
    }
    if !BUDGET_MS.contains(&server_ms) {
        let (low, high) = (BUDGET_MS.start(), BUDGET_MS.end());
        return refuse(StatusCode::BAD_REQUEST, &format!("`server_ms` is {server_ms}; allowed: {low} to {high}"));
    }
    app.budget_ms.send_replace(Some(server_ms));
    answer(StatusCode::OK, &json!({ "server_ms": server_ms }))
}
