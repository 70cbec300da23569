//! Opening of WebSockets.

use super::writer::FRAGMENT_BYTES;
use axum::body::Body;
use axum::extract::Request;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use hyper::upgrade::Upgraded;
use hyper_util::rt::TokioIo;
use prairie_core::wire::CLIENT_MESSAGE_LIMIT;
use tokio_tungstenite::WebSocketStream;
use tokio_tungstenite::tungstenite::handshake::server::create_response_with_body;
use tokio_tungstenite::tungstenite::protocol::{Role, WebSocketConfig};

/// Answers a request for a WebSocket, and runs `session` when it is open.
pub(super) fn upgrade<F: Future<Output = ()> + Send>(
    mut request: Request,
    session: impl FnOnce(WebSocketStream<TokioIo<Upgraded>>) -> F + Send + 'static,
) -> Response {
    let response = match create_response_with_body(&request, Body::empty) {
        Ok(response) => response,
        Err(error) => return (StatusCode::BAD_REQUEST, format!("this address is a WebSocket: {error}\n")).into_response(),
    };
    let upgrading = hyper::upgrade::on(&mut request);
    tokio::spawn(async move {
        match upgrading.await {
            Ok(upgraded) => session(WebSocketStream::from_raw_socket(TokioIo::new(upgraded), Role::Server, Some(config())).await).await,
            Err(error) => tracing::debug!(%error, "a WebSocket was not opened"),
        }
    });
    response
}

/// Limits of a WebSocket: messages that are too long are rejected by their header, and the buffers stay small.
pub(super) fn config() -> WebSocketConfig {
    WebSocketConfig::default()
        .max_message_size(Some(CLIENT_MESSAGE_LIMIT))
        .max_frame_size(Some(CLIENT_MESSAGE_LIMIT))
        .read_buffer_size(2 * CLIENT_MESSAGE_LIMIT)
        .write_buffer_size(FRAGMENT_BYTES)
}
