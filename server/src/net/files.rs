//! Serving the client's files: caching, encodings and conditional requests.

use super::assets::{self, Asset};
use super::encoding::{self, Encoding};
use super::security;
use axum::http::{HeaderMap, HeaderName, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};

/// Cache period of files that are named after their contents: a year, the longest that RFC 9111 recommends.
const FOREVER: &str = "public, max-age=31536000, immutable";

/// Header with the size of the uncompressed file (bytes), from which the page computes the progress of a download: scripts receive uncompressed bytes
/// only.
const UNCOMPRESSED_LENGTH: HeaderName = HeaderName::from_static("x-uncompressed-length");

/// Responds with the embedded file at the path of the request.
pub(super) async fn file(uri: Uri, headers: HeaderMap) -> Response {
    match assets::asset(uri.path()) {
        Some(asset) => respond(asset, &headers),
        None => (StatusCode::NOT_FOUND, "no such page\n").into_response(),
    }
}

/// Responds with the page of charts, whose script is in the page itself.
pub(super) async fn charts(headers: HeaderMap) -> Response {
    match assets::asset(assets::CHARTS) {
        Some(page) => security::allow_script_of(page.bytes, respond(page, &headers)),
        None => (StatusCode::NOT_FOUND, "built without the page of charts\n").into_response(),
    }
}

fn respond(asset: &Asset, headers: &HeaderMap) -> Response {
    // Repeated headers mean the same as one with all values.
    let list = |name| {
        let values: Vec<_> = headers.get_all(name).iter().filter_map(|value| value.to_str().ok()).collect();
        (!values.is_empty()).then(|| values.join(","))
    };
    let encoding = encoding::choose(list(header::ACCEPT_ENCODING).as_deref(), |encoding| asset.encoded(encoding).is_some());
    let tag = tag(asset, encoding);
    let common = [
        (header::CACHE_CONTROL, if asset.is_immutable { FOREVER } else { "no-cache" }.to_owned()),
        (header::VARY, "accept-encoding".to_owned()),
        (header::ETAG, tag.clone()),
    ];
    if list(header::IF_NONE_MATCH).is_some_and(|tags| matches(&tags, &tag)) {
        return (StatusCode::NOT_MODIFIED, common).into_response();
    }
    let body = asset.encoded(encoding).unwrap_or(asset.bytes);
    let content = [(header::CONTENT_TYPE, asset.content_type.to_owned()), (UNCOMPRESSED_LENGTH, asset.bytes.len().to_string())];
    match encoding {
        Encoding::Identity => (common, content, body).into_response(),
        _ => (common, content, [(header::CONTENT_ENCODING, encoding.name())], body).into_response(),
    }
}

/// Entity tag of a file in an encoding: the bytes differ, so the tags must.
fn tag(asset: &Asset, encoding: Encoding) -> String {
    match encoding {
        Encoding::Identity => format!("\"{}\"", asset.hash),
        _ => format!("\"{}-{}\"", asset.hash, encoding.name()),
    }
}

/// Whether an `If-None-Match` header contains a tag, by weak comparison (RFC 9110, section 13.1.2).
fn matches(tags: &str, tag: &str) -> bool {
    tags.trim() == "*" || tags.split(',').map(str::trim).any(|known| known.strip_prefix("W/").unwrap_or(known) == tag)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ASSET: Asset = Asset {
        content_type: "text/css; charset=utf-8",
        is_immutable: true,
        bytes: b"long text",
        brotli: Some(b"br"),
        gzip: Some(b"gz"),
        hash: "0123",
    };

    fn response(headers: &[(HeaderName, &str)]) -> Response {
        let headers = headers.iter().map(|(name, value)| (name.clone(), value.parse().unwrap()));
        let mut all = HeaderMap::new();
        headers.for_each(|(name, value)| _ = all.append(name, value));
        respond(&ASSET, &all)
    }

    fn header_of(response: &Response, name: impl header::AsHeaderName) -> Option<&str> {
        response.headers().get(name).map(|value| value.to_str().unwrap())
    }

    #[test]
    fn each_encoding_has_its_own_tag() {
        for (accepted, encoding, tag) in
            [("gzip", Some("gzip"), "\"0123-gzip\""), ("br", Some("br"), "\"0123-br\""), ("gzip;q=0", None, "\"0123\"")]
        {
            let response = response(&[(header::ACCEPT_ENCODING, accepted)]);
            assert_eq!((header_of(&response, header::CONTENT_ENCODING), header_of(&response, header::ETAG)), (encoding, Some(tag)));
            assert_eq!(header_of(&response, header::VARY), Some("accept-encoding"));
            assert_eq!(header_of(&response, header::CACHE_CONTROL), Some(FOREVER));
            assert_eq!(header_of(&response, UNCOMPRESSED_LENGTH), Some("9"));
        }
        let repeated = response(&[(header::ACCEPT_ENCODING, "deflate"), (header::ACCEPT_ENCODING, "br")]);
        assert_eq!(header_of(&repeated, header::CONTENT_ENCODING), Some("br"));
    }

    #[test]
    fn only_the_tag_of_the_same_encoding_is_not_modified() {
        for (tags, status) in [
            ("\"0123-br\"", 304),
            ("W/\"0123-br\"", 304),
            ("\"x\", \"0123-br\"", 304),
            ("*", 304),
            ("\"0123\"", 200),
            ("\"0123-gzip\"", 200),
            ("0123-br", 200),
        ] {
            let response = response(&[(header::ACCEPT_ENCODING, "br"), (header::IF_NONE_MATCH, tags)]);
            assert_eq!(response.status(), status, "{tags}");
            assert_eq!(header_of(&response, header::ETAG), Some("\"0123-br\""));
        }
    }
}
