//! Security headers that limit the damage from a faulty page or a hostile scene.

use axum::http::{HeaderName, HeaderValue, header};
use axum::response::Response;
use data_encoding::BASE64;
use ring::digest::{SHA256, digest};
use std::sync::OnceLock;

/// Everything comes from this server, scripts and styles from files only, and WebAssembly is compiled but no JavaScript. `connect-src 'self'`
/// includes the WebSocket of the same host (CSP 3); every browser with WebGPU implements that.
const CONTENT_SECURITY_POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self'; \
     media-src 'self'; connect-src 'self'; manifest-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'; \
     require-trusted-types-for 'script'; trusted-types 'none'";

const HEADERS: [(HeaderName, &str); 7] = [
    (header::CONTENT_SECURITY_POLICY, CONTENT_SECURITY_POLICY),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (header::REFERRER_POLICY, "no-referrer"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
    (HeaderName::from_static("permissions-policy"), "camera=(), display-capture=(), geolocation=(), microphone=(), payment=(), usb=()"),
];

/// Adds the headers to a response; one that it has already stays, such as the policy of the page of charts.
pub(super) async fn restrict(mut response: Response) -> Response {
    for (name, value) in HEADERS {
        response.headers_mut().entry(name).or_insert(HeaderValue::from_static(value));
    }
    response
}

/// Beginning and end of the script in a page.
const SCRIPT: [&[u8]; 2] = [b"<script type=\"module\">", b"</script>"];

/// Allows the script that is in the page of charts itself, by its hash, and nothing else: no other script, no connection. Styles and pictures in the page are allowed.
pub(super) fn allow_script_of(page: &'static [u8], mut response: Response) -> Response {
    static POLICY: OnceLock<HeaderValue> = OnceLock::new();
    let policy = POLICY.get_or_init(|| policy_of(page)).clone();
    response.headers_mut().insert(header::CONTENT_SECURITY_POLICY, policy);
    response
}

fn policy_of(page: &[u8]) -> HeaderValue {
    let [begin, end] = SCRIPT;
    let find = |text: &[u8], word: &[u8]| text.windows(word.len()).position(|window| window == word);
    let script =
        find(page, begin).map(|at| &page[at + begin.len()..]).and_then(|rest| find(rest, end).map(|at| &rest[..at])).unwrap_or_default();
    let hash = BASE64.encode(digest(&SHA256, script).as_ref());
    let policy = format!(
        "default-src 'none'; script-src 'sha256-{hash}'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    );
    HeaderValue::try_from(policy).expect("base64 is visible ASCII")
}
