//! The fields by HTTP, as JSON: `/api/wind` and `/api/bend`, one place by `GET`, many by `POST`.

use super::app::App;
use super::field_sampler::Place;
use axum::body::{Body, to_bytes};
use axum::extract::{RawQuery, State};
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};
use serde::Deserialize;
use serde_json::{Value, json};
use std::sync::Arc;
use std::time::Duration;
use tokio::time::timeout;

/// Largest number of places in a request.
const PLACES_LIMIT: usize = 4096;

/// Largest body of a request (bytes).
const BODY_LIMIT: usize = 96 << 10;

/// Largest coordinate, either way (m).
const COORDINATE_LIMIT_M: f32 = 1e6;

/// Time in which the bend of all patches must be published after a request for it: two publications at the slowest rate.
const BEND_TIMEOUT: Duration = Duration::from_secs(3);

/// A field that can be sampled.
#[derive(Clone, Copy, PartialEq)]
enum Field {
    Wind,
    Bend,
}

impl Field {
    fn has_elevation(self) -> bool {
        self == Self::Wind
    }

    /// The field at places, in the newest publication that has it everywhere.
    async fn sample(self, app: &App, places: &[Place]) -> Result<Value, (StatusCode, String)> {
        match self {
            Self::Wind => {
                app.attendance.note();
                let published = app.published.borrow().clone();
                Ok(app.fields.wind(&published, places))
            }
            Self::Bend => {
                app.attendance.ask_for_bend();
                let mut published = app.published.clone();
                let complete = timeout(BEND_TIMEOUT, published.wait_for(|newest| newest.snapshot.audience.takes_all())).await;
                let Ok(Ok(newest)) = complete else {
                    let error = format!("the world has not published its bend within {} s", BEND_TIMEOUT.as_secs());
                    return Err((StatusCode::SERVICE_UNAVAILABLE, error));
                };
                let published = newest.clone();
                Ok(app.fields.bend(&published, places))
            }
        }
    }
}

/// Body of a `POST`: places in metres, `[x, y, z]` of the wind and `[x, z]` of the bend.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Places {
    at_m: Vec<Vec<f32>>,
}

/// `GET /api/wind?x=&z=&y=`.
pub(super) async fn wind(State(app): State<Arc<App>>, RawQuery(query): RawQuery) -> Response {
    answer(one(&app, query, Field::Wind).await)
}

/// `GET /api/bend?x=&z=`.
pub(super) async fn bend(State(app): State<Arc<App>>, RawQuery(query): RawQuery) -> Response {
    answer(one(&app, query, Field::Bend).await)
}

/// `POST /api/wind`.
pub(super) async fn winds(State(app): State<Arc<App>>, body: Body) -> Response {
    answer(many(&app, body, Field::Wind).await)
}

/// `POST /api/bend`.
pub(super) async fn bends(State(app): State<Arc<App>>, body: Body) -> Response {
    answer(many(&app, body, Field::Bend).await)
}

fn answer(outcome: Result<Value, (StatusCode, String)>) -> Response {
    let (status, body) = match outcome {
        Ok(value) => (StatusCode::OK, value),
        Err((status, error)) => (status, json!({ "error": error })),
    };
    (status, [(header::CONTENT_TYPE, "application/json"), (header::CACHE_CONTROL, "no-store")], format!("{body}\n")).into_response()
}

/// The field at the place of a query. Lists of one place are replaced by their element.
async fn one(app: &App, query: Option<String>, field: Field) -> Result<Value, (StatusCode, String)> {
    let place = queried(&query.unwrap_or_default(), field.has_elevation()).map_err(|error| (StatusCode::BAD_REQUEST, error))?;
    let mut value = field.sample(app, &[place]).await?;
    for field in value.as_object_mut().into_iter().flat_map(|fields| fields.values_mut()) {
        if let Some(only) = field.as_array_mut().and_then(Vec::pop) {
            *field = only;
        }
    }
    Ok(value)
}

async fn many(app: &App, body: Body, field: Field) -> Result<Value, (StatusCode, String)> {
    let too_large = |_| (StatusCode::PAYLOAD_TOO_LARGE, format!("the body has more than {BODY_LIMIT} bytes"));
    let body = to_bytes(body, BODY_LIMIT).await.map_err(too_large)?;
    let places = listed(&body, field.has_elevation()).map_err(|error| (StatusCode::BAD_REQUEST, error))?;
    field.sample(app, &places).await
}

/// The place of a query: `x` and `z`, and `y` where there is an elevation.
fn queried(query: &str, has_elevation: bool) -> Result<Place, String> {
    let [mut x, mut y, mut z] = [None; 3];
    for (name, value) in query.split('&').filter(|pair| !pair.is_empty()).map(|pair| pair.split_once('=').unwrap_or((pair, ""))) {
        let slot = match name {
            "x" => &mut x,
            "y" if has_elevation => &mut y,
            "z" => &mut z,
            _ => return Err(format!("`{}` is unknown; allowed: x, z{}", shortened(name), if has_elevation { ", y" } else { "" })),
        };
        *slot = Some(value.parse().map_err(|_| format!("`{name}` is \"{}\"; allowed: a number of metres", shortened(value)))?);
    }
    let needed = |name: &str, value: Option<f32>| value.ok_or_else(|| format!("`{name}` is missing: a number of metres"));
    let place = Place { x: needed("x", x)?, y, z: needed("z", z)? };
    check(&place, "")?;
    Ok(place)
}

/// The places of a body.
fn listed(body: &[u8], has_elevation: bool) -> Result<Vec<Place>, String> {
    let Places { at_m } = serde_json::from_slice(body).map_err(|error| format!("the body is not a JSON object with `at_m`: {error}"))?;
    if at_m.len() > PLACES_LIMIT {
        return Err(format!("`at_m` has {} places; allowed: at most {PLACES_LIMIT}", at_m.len()));
    }
    let place = |(number, at): (usize, Vec<f32>)| {
        let place = match (at.as_slice(), has_elevation) {
            (&[x, y, z], true) => Place { x, y: Some(y), z },
            (&[x, z], false) => Place { x, y: None, z },
            _ => {
                let wanted = if has_elevation { "[x, y, z]" } else { "[x, z]" };
                return Err(format!("`at_m[{number}]` has {} numbers; allowed: {wanted}", at.len()));
            }
        };
        check(&place, &format!("at_m[{number}]."))?;
        Ok(place)
    };
    at_m.into_iter().enumerate().map(place).collect()
}

fn check(place: &Place, path: &str) -> Result<(), String> {
    for (name, value) in [("x", Some(place.x)), ("y", place.y), ("z", Some(place.z))] {
        if let Some(value) = value.filter(|value| !(-COORDINATE_LIMIT_M..=COORDINATE_LIMIT_M).contains(value)) {
            return Err(format!("`{path}{name}` is {value}; allowed: −1000000 to 1000000"));
        }
    }
    Ok(())
}

/// The start of a text that came from outside.
fn shortened(text: &str) -> String {
    text.chars().take(32).collect::<String>().escape_debug().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn queries_name_one_place() {
        assert_eq!(queried("x=1.5&z=-2e1&y=30", true), Ok(Place { x: 1.5, y: Some(30.0), z: -20.0 }));
        assert_eq!(queried("z=3&x=4", true), Ok(Place { x: 4.0, y: None, z: 3.0 }));
        for (query, error) in [
            ("", "`x` is missing: a number of metres"),
            ("x=1", "`z` is missing: a number of metres"),
            ("x=1&z=two", "`z` is \"two\"; allowed: a number of metres"),
            ("x=1&z=2&q=3", "`q` is unknown; allowed: x, z, y"),
            ("x=inf&z=2", "`x` is inf; allowed: −1000000 to 1000000"),
            ("x=1&z=NaN", "`z` is NaN; allowed: −1000000 to 1000000"),
        ] {
            assert_eq!(queried(query, true), Err(error.to_owned()), "{query}");
        }
        assert_eq!(queried("x=1&z=2&y=3", false), Err("`y` is unknown; allowed: x, z".to_owned()));
    }

    #[test]
    fn bodies_list_places() {
        assert_eq!(listed(b"{\"at_m\": [[1, 2]]}", false), Ok(vec![Place { x: 1.0, y: None, z: 2.0 }]));
        assert_eq!(listed(b"{\"at_m\": []}", true), Ok(vec![]));
        let error = |body: &str| listed(body.as_bytes(), true).expect_err("not places");
        assert_eq!(error("{\"at_m\": [[1, 2, 3], [1, 2]]}"), "`at_m[1]` has 2 numbers; allowed: [x, y, z]");
        assert_eq!(error("{\"at_m\": [[1, 2e9, 3]]}"), "`at_m[0].y` is 2000000000; allowed: −1000000 to 1000000");
        assert!(error("[]").contains("JSON object"));
        let many = format!("{{\"at_m\": [{}[1,2,3]]}}", "[1,2,3],".repeat(PLACES_LIMIT));
        assert_eq!(error(&many), "`at_m` has 4097 places; allowed: at most 4096");
    }
}
