//! Errors that pages send to the server's log: bounded in size, limited in rate, and only with `--report`.

use super::app::App;
use crate::token_bucket::TokenBucket;
use axum::body::{Body, to_bytes};
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

/// Longest report (bytes).
const REPORT_LIMIT: usize = 4096;

/// Longest description of the browser in the log (bytes).
const BROWSER_LIMIT: usize = 256;

/// Reports accepted at once, and their mean rate (1/s), of all pages together, so that a fault in every page cannot fill the disk.
const BURST: f64 = 20.0;
const RATE_PER_S: f64 = 0.2;

/// The gate of the reports.
#[derive(Debug)]
pub(crate) struct PageErrors(Mutex<Gate>);

#[derive(Debug)]
struct Gate {
    allowance: TokenBucket,
    /// Reports dropped since the last one in the log.
    dropped: u64,
}

impl PageErrors {
    /// A gate that lets the first [`BURST`] reports pass.
    pub(crate) fn new(now: Instant) -> Self {
        Self(Mutex::new(Gate { allowance: TokenBucket::new(BURST, RATE_PER_S, now), dropped: 0 }))
    }

    /// Whether a report may be logged now; if so, the number of reports dropped before it.
    fn admit(&self, now: Instant) -> Option<u64> {
        let mut gate = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        gate.allowance.fill(now);
        if gate.allowance.try_take(1.0) {
            return Some(std::mem::take(&mut gate.dropped));
        }
        gate.dropped += 1;
        None
    }
}

/// Receives one report, plain text, and logs it. Without `--report` it is discarded.
pub(super) async fn receive(State(app): State<Arc<App>>, headers: HeaderMap, body: Body) -> Response {
    if let Err(rejection) = app.access.check_origin(&headers) {
        return rejection.into_response();
    }
    let Some(errors) = &app.page_errors else { return StatusCode::NO_CONTENT.into_response() };
    let Some(dropped) = errors.admit(Instant::now()) else {
        return (StatusCode::TOO_MANY_REQUESTS, "too many reports\n").into_response();
    };
    let Ok(text) = to_bytes(body, REPORT_LIMIT).await else {
        return (StatusCode::PAYLOAD_TOO_LARGE, format!("a report has at most {REPORT_LIMIT} bytes\n")).into_response();
    };
    let browser = headers.get(header::USER_AGENT).map_or(&[][..], |agent| agent.as_bytes());
    let browser = String::from_utf8_lossy(&browser[..browser.len().min(BROWSER_LIMIT)]);
    // Logged in quotes, with control characters escaped: the text may be anyone's.
    tracing::warn!(report = ?String::from_utf8_lossy(&text), ?browser, dropped, "a page reports an error");
    StatusCode::NO_CONTENT.into_response()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn a_burst_passes_and_the_next_report_says_how_many_were_dropped() {
        let start = Instant::now();
        let errors = PageErrors::new(start);
        for _ in 0..20 {
            assert_eq!(errors.admit(start), Some(0));
        }
        for _ in 0..100_000 {
            assert_eq!(errors.admit(start), None);
        }
        let later = start + Duration::from_secs(5);
        assert_eq!([errors.admit(later), errors.admit(later)], [Some(100_000), None]);
    }
}
