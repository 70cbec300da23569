//! Writing to a client, with a time limit for phases in which it reads nothing.

use super::connection::Connection;
use super::end::End;
use bytes::Bytes;
use futures_util::SinkExt;
use futures_util::stream::SplitSink;
use prairie_core::wire::{self, Close, Refusal, ServerMessage};
use std::pin::pin;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::time::timeout;
use tokio_tungstenite::WebSocketStream;
use tokio_tungstenite::tungstenite::Error;
use tokio_tungstenite::tungstenite::protocol::Message;
use tokio_tungstenite::tungstenite::protocol::frame::coding::{Data, OpCode};
use tokio_tungstenite::tungstenite::protocol::frame::{CloseFrame, Frame};

/// Size of the fragments of a large message (bytes), and of the WebSocket's write buffer: the memory that a client who does not read takes.
pub(super) const FRAGMENT_BYTES: usize = 32 << 10;

/// Checks per stall timeout whether the client has accepted anything.
const CHECKS: u32 = 8;

/// Writer of messages to a client.
pub(super) struct Writer<S> {
    sink: SplitSink<WebSocketStream<S>, Message>,
    connection: Arc<Connection>,
    stall_timeout: Duration,
    /// Whether the last message is incomplete, so that only control frames may follow.
    is_within_message: bool,
}

impl<S: AsyncRead + AsyncWrite + Unpin> Writer<S> {
    /// A writer that gives up when the socket has accepted no byte for `stall_timeout`.
    pub(super) fn new(sink: SplitSink<WebSocketStream<S>, Message>, connection: Arc<Connection>, stall_timeout: Duration) -> Self {
        Self { sink, connection, stall_timeout, is_within_message: false }
    }

    /// Writes and flushes messages.
    pub(super) async fn send(&mut self, messages: impl IntoIterator<Item = Bytes>) -> Result<(), End> {
        self.write(messages.into_iter().map(Message::Binary)).await
    }

    /// Writes and flushes a message in fragments, so that its bytes are shared by all clients: the WebSocket copies only one fragment at a time.
    pub(super) async fn send_fragmented(&mut self, message: Bytes) -> Result<(), End> {
        self.is_within_message = true;
        self.write(fragments(message)).await?;
        self.is_within_message = false;
        Ok(())
    }

    /// Sends the reason, unless a message is incomplete, and a close frame, within `limit`; false if the client did not read that.
    pub(super) async fn close(&mut self, close: Close, reason: &str, limit: Duration) -> bool {
        let refusal = refusal(close).filter(|_| !self.is_within_message);
        let refused =
            refusal.map(|refusal| Message::Binary(wire::encode(&ServerMessage::Refused { refusal, reason: reason.to_owned() }).into()));
        let last = Message::Close(Some(CloseFrame { code: close.code().into(), reason: close_reason(reason).into() }));
        matches!(timeout(limit, self.write(refused.into_iter().chain([last]))).await, Ok(Ok(())))
    }

    async fn write(&mut self, messages: impl Iterator<Item = Message>) -> Result<(), End> {
        let sink = &mut self.sink;
        let mut writing = pin!(async {
            for message in messages {
                sink.feed(message).await?;
            }
            sink.flush().await
        });
        let (mut written_bytes, mut idle_checks) = (self.connection.written_bytes(), 0);
        while idle_checks < CHECKS {
            if let Ok(written) = timeout(self.stall_timeout / CHECKS, writing.as_mut()).await {
                return written.map_err(|_: Error| End::Broken);
            }
            let now = self.connection.written_bytes();
            idle_checks = if now == written_bytes { idle_checks + 1 } else { 0 };
            written_bytes = now;
        }
        Err(End::Closed(Close::Stalled, format!("the client read nothing for {} s", self.stall_timeout.as_secs_f32())))
    }
}

/// The frames of a message in fragments (RFC 6455, section 5.4).
fn fragments(message: Bytes) -> impl Iterator<Item = Message> {
    (0..message.len()).step_by(FRAGMENT_BYTES).map(move |start| {
        let end = message.len().min(start + FRAGMENT_BYTES);
        let kind = if start == 0 { Data::Binary } else { Data::Continue };
        Message::Frame(Frame::message(message.slice(start..end), OpCode::Data(kind), end == message.len()))
    })
}

/// The refusal that announces a close.
fn refusal(close: Close) -> Option<Refusal> {
    match close {
        Close::BadMessage => Some(Refusal::BadMessage),
        Close::RateLimit => Some(Refusal::RateLimit),
        Close::ServerFull => Some(Refusal::ServerFull),
        Close::Stopping => Some(Refusal::Stopping),
        Close::Version | Close::NoHello | Close::Stalled => None,
    }
}

/// The reason, cut to the 123 bytes that a close frame can hold.
fn close_reason(reason: &str) -> String {
    reason[..reason.floor_char_boundary(123)].to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::net::admission::Admission;
    use crate::net::connection::Metered;
    use crate::net::upgrade::config;
    use futures_util::StreamExt;
    use std::net::Ipv4Addr;
    use tokio::io::{AsyncReadExt, DuplexStream, duplex};
    use tokio_tungstenite::tungstenite::WebSocket;
    use tokio_tungstenite::tungstenite::protocol::Role;

    /// A writer, and the client's end of its connection, which holds 1000 bytes on the way.
    async fn writer(stall_timeout: Duration) -> (Writer<Metered<DuplexStream>>, DuplexStream) {
        let (socket, client) = duplex(1000);
        let place = Arc::new(Admission::new(1)).admit(Ipv4Addr::LOCALHOST.into()).unwrap();
        let connection = Arc::new(Connection::new(place));
        let socket = Metered::new(socket, connection.clone(), 1e6);
        let (sink, _) = WebSocketStream::from_raw_socket(socket, Role::Server, Some(config())).await.split();
        (Writer::new(sink, connection, stall_timeout), client)
    }

    /// The messages in the bytes of a stream.
    fn messages(bytes: Vec<u8>) -> Vec<Message> {
        let mut socket = WebSocket::from_partially_read(std::io::Cursor::new(Vec::new()), bytes, Role::Client, None);
        std::iter::from_fn(|| socket.read().ok()).collect()
    }

    fn large_message() -> Bytes {
        (0..3 * FRAGMENT_BYTES as u32 + 7).map(|i| (i % 251) as u8).collect()
    }

    #[tokio::test]
    async fn a_message_may_take_longer_than_the_stall_timeout_while_the_client_reads() {
        let (mut writer, mut client) = writer(Duration::from_millis(400)).await;
        let writing = async {
            writer.send_fragmented(large_message()).await.expect("the client reads");
            drop(writer);
        };
        let reading = async {
            let mut bytes = Vec::new();
            // A second in all.
            while client.read_buf(&mut bytes).await.unwrap() > 0 {
                tokio::time::sleep(Duration::from_millis(10)).await;
            }
            bytes
        };
        let ((), bytes) = tokio::join!(writing, reading);
        assert_eq!(messages(bytes), [Message::Binary(large_message())]);
    }

    #[tokio::test]
    async fn a_client_that_stops_reading_is_given_up() {
        let (mut writer, mut client) = writer(Duration::from_millis(80)).await;
        let reading = async { client.read_exact(&mut [0; 5000]).await.unwrap() };
        let (written, _) = tokio::join!(writer.send_fragmented(large_message()), reading);
        assert!(matches!(written, Err(End::Closed(Close::Stalled, _))), "{written:?}");
    }

    #[tokio::test]
    async fn only_the_close_frame_follows_an_incomplete_message() {
        let (mut writer, mut client) = writer(Duration::from_secs(60)).await;
        let writing = async {
            let _ = timeout(Duration::from_millis(20), writer.send_fragmented(large_message())).await;
            assert!(writer.close(Close::Stopping, "the server is stopping", Duration::from_secs(60)).await);
            drop(writer);
        };
        let reading = async {
            tokio::time::sleep(Duration::from_millis(100)).await;
            let mut bytes = Vec::new();
            client.read_to_end(&mut bytes).await.unwrap();
            bytes
        };
        let ((), bytes) = tokio::join!(writing, reading);
        assert!(matches!(&messages(bytes)[..], [Message::Close(Some(close))] if u16::from(close.code) == Close::Stopping.code()));
    }

    #[test]
    fn close_reasons_are_truncated_at_a_character_boundary() {
        let reason = close_reason(&"é".repeat(200));
        assert!(reason.len() <= 123 && reason.chars().all(|c| c == 'é'));
    }
}
