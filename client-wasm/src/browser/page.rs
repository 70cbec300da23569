//! Access to the page and its window.

use wasm_bindgen::prelude::*;
use web_sys::{HtmlCanvasElement, Window};

#[wasm_bindgen(js_namespace = ["window", "prairie"])]
extern "C" {
    /// Shows a status message of `messages.js`, with a detail and the fraction of the start that is done, if known.
    pub(super) fn message(kind: &str, detail: &str, progress: Option<f64>);
    /// Shows that the client has panicked, and where.
    pub(super) fn panicked(report: &str);
    /// Hides the status message.
    pub(super) fn clear();
}

/// The canvas with this id.
pub(super) fn canvas(window: &Window, id: &str) -> Result<HtmlCanvasElement, JsError> {
    let element = window.document().and_then(|document| document.get_element_by_id(id));
    let canvas = element.and_then(|element| element.dyn_into().ok());
    canvas.ok_or_else(|| JsError::new(&format!("the page has no canvas with the id {id}")))
}

/// WebSocket address of the page's own server.
pub(super) fn socket_url(window: &Window) -> Result<String, String> {
    let location = window.location();
    let (Ok(protocol), Ok(host)) = (location.protocol(), location.host()) else {
        return Err("the page has no address".into());
    };
    Ok(format!("{}//{host}/ws", if protocol == "https:" { "wss:" } else { "ws:" }))
}

/// Time since the page was opened (s).
pub(super) fn now_secs(window: &Window) -> f64 {
    window.performance().map_or(0.0, |performance| performance.now() / 1000.0)
}

/// Sets the fragment of the page's address without a history entry. Browsers reject this when it happens too often; the next call makes up for it.
pub(super) fn set_hash(window: &Window, hash: &str) {
    if let Ok(history) = window.history() {
        let _ = history.replace_state_with_url(&JsValue::NULL, "", Some(&format!("#{hash}")));
    }
}
