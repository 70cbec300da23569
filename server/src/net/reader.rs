//! Reading a client's messages, at a limited rate.

use super::connection::Connection;
use super::end::End;
use crate::config::Limits;
use crate::token_bucket::TokenBucket;
use futures_util::StreamExt;
use futures_util::stream::SplitStream;
use prairie_core::wire::{self, CLIENT_MESSAGE_LIMIT, ClientMessage, Close, WireError};
use std::sync::Arc;
use std::time::Instant;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio_tungstenite::WebSocketStream;
use tokio_tungstenite::tungstenite::error::{Error, ProtocolError};
use tokio_tungstenite::tungstenite::protocol::Message;

/// Rate-limited reader of a client's messages.
pub(super) struct Reader<S> {
    source: SplitStream<WebSocketStream<S>>,
    connection: Arc<Connection>,
    allowance: TokenBucket,
    messages_per_s: f64,
    bytes_per_s: f64,
}

impl<S: AsyncRead + AsyncWrite + Unpin> Reader<S> {
    pub(super) fn new(source: SplitStream<WebSocketStream<S>>, connection: Arc<Connection>, limits: &Limits) -> Self {
        let Limits { messages_per_s, bytes_per_s, .. } = *limits;
        let allowance = TokenBucket::new(2.0 * messages_per_s, messages_per_s, Instant::now());
        Self { source, connection, allowance, messages_per_s, bytes_per_s }
    }

    /// The next message. Pings and pongs of the WebSocket are skipped, but count towards the rate limit. Cancel-safe.
    pub(super) async fn next(&mut self) -> Result<ClientMessage, End> {
        loop {
            let message = tokio::select! {
                message = self.source.next() => message,
                () = self.connection.flooded() => {
                    return Err(End::Closed(Close::RateLimit, format!("more than {} bytes per second", self.bytes_per_s)));
                }
            };
            let message = decode(message)?;
            self.allowance.fill(Instant::now());
            if !self.allowance.try_take(1.0) {
                return Err(End::Closed(Close::RateLimit, format!("more than {} messages per second", self.messages_per_s)));
            }
            if let Some(message) = message {
                return Ok(message);
            }
        }
    }

    /// Discards all messages up to the client's close frame. Never completes if the connection breaks before.
    pub(super) async fn closed(&mut self) {
        loop {
            match self.source.next().await {
                Some(Ok(Message::Close(_))) => return,
                Some(Ok(_)) => {}
                Some(Err(_)) | None => std::future::pending().await,
            }
        }
    }
}

/// The client's message; `None` for a ping or pong, which the WebSocket layer handles itself.
fn decode(message: Option<Result<Message, Error>>) -> Result<Option<ClientMessage>, End> {
    match message {
        Some(Ok(Message::Binary(bytes))) => match wire::decode(&bytes, CLIENT_MESSAGE_LIMIT) {
            Ok(message) => Ok(Some(message)),
            Err(error @ WireError::Version { .. }) => Err(End::Closed(Close::Version, error.to_string())),
            Err(error) => Err(End::bad(error)),
        },
        Some(Ok(Message::Text(_))) => Err(End::bad("a text message; only binary messages are allowed")),
        Some(Ok(Message::Ping(_) | Message::Pong(_) | Message::Frame(_))) => Ok(None),
        Some(Ok(Message::Close(_))) | None => Err(End::Left),
        Some(Err(Error::Io(_) | Error::Protocol(ProtocolError::ResetWithoutClosingHandshake))) => Err(End::Broken),
        Some(Err(error)) => Err(End::bad(error)),
    }
}
