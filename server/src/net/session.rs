//! A client's session on the WebSocket, from hello to close.

use super::app::App;
use crate::stream::{AreaOfInterest, Client, Frame};
use crate::token_bucket::TokenBucket;
use crate::world::Command;
use axum::extract::ws::{CloseFrame, Message, WebSocket};
use bytes::Bytes;
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use prairie_core::wire::{self, CLIENT_MESSAGE_LIMIT, ClientMessage, Close, Drive, Refusal, ServerMessage, VIEW_RADIUS_LIMIT_M, WireError};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::{OwnedSemaphorePermit, mpsc};
use tokio::time::timeout;

type Sink = SplitSink<WebSocket, Message>;
type Source = SplitStream<WebSocket>;

/// Time limit for sending the close frame, and again for the client's answer to it.
const CLOSE_TIMEOUT: Duration = Duration::from_millis(500);

/// Capacity of the queue of replies; when it is full, replies are dropped.
const REPLY_CAPACITY: usize = 16;

/// Longest name (characters).
const NAME_LIMIT: usize = 32;

/// Largest absolute camera coordinate (m).
const EYE_LIMIT_M: f32 = 1e6;

/// Rate-limited reader of the client's messages.
struct Reader {
    source: Source,
    allowance: TokenBucket,
    messages_per_s: f64,
}

impl Reader {
    fn new(source: Source, messages_per_s: f64) -> Self {
        Self { source, allowance: TokenBucket::new(2.0 * messages_per_s, messages_per_s, Instant::now()), messages_per_s }
    }

    /// The next message. Pings and pongs of the WebSocket are skipped, but count towards the rate limit. Cancel-safe.
    async fn next(&mut self) -> Result<ClientMessage, End> {
        loop {
            let message = receive(&mut self.source).await?;
            self.allowance.fill(Instant::now());
            if !self.allowance.try_take(1.0) {
                return Err(End::Closed(Close::RateLimit, format!("more than {} messages per second", self.messages_per_s)));
            }
            if let Some(message) = message {
                return Ok(message);
            }
        }
    }
}

/// Reasons why a session ended.
#[derive(Debug)]
enum End {
    /// The client closed the connection.
    Left,
    /// The connection broke.
    Broken,
    /// The server closes the connection, with a code and a reason.
    Closed(Close, String),
}

fn bad(reason: impl std::fmt::Display) -> End {
    End::Closed(Close::BadMessage, reason.to_string())
}

/// Runs a session. Until it has ended it keeps `slot`, the permit of a connection before its hello, and then that of a client.
pub(super) async fn run(socket: WebSocket, app: Arc<App>, mut slot: OwnedSemaphorePermit) {
    let (mut sink, source) = socket.split();
    let mut reader = Reader::new(source, app.limits.messages_per_s);
    let end = match read_hello(&mut reader, &app).await {
        Ok(name) => match app.client_slots.clone().try_acquire_owned() {
            Ok(client_slot) => {
                slot = client_slot;
                serve_client(&mut sink, &mut reader, &app, &name).await
            }
            Err(_) => End::Closed(Close::ServerFull, format!("the server is full ({} clients); try again later", app.limits.clients)),
        },
        Err(end) => end,
    };
    if let End::Closed(close, reason) = end {
        tracing::info!(code = close.code(), reason, "closed a connection");
        send_close(sink, reader.source, close, reason).await;
    }
    drop(slot);
}

/// Waits for the hello; returns the client's name.
async fn read_hello(reader: &mut Reader, app: &App) -> Result<String, End> {
    let limit = app.limits.handshake_timeout;
    let first = tokio::select! {
        first = timeout(limit, reader.next()) => first,
        end = stopping(app) => return Err(end),
    };
    match first {
        Ok(Ok(ClientMessage::Hello { name })) => Ok(name),
        Ok(Ok(_)) => Err(bad("the first message must be a hello")),
        Ok(Err(end)) => Err(end),
        Err(_) => Err(End::Closed(Close::NoHello, format!("no hello within {} s", limit.as_secs_f32()))),
    }
}

/// Completes when the server stops.
async fn stopping(app: &App) -> End {
    // An error means that the sender is gone, so the server has stopped.
    let _ = app.stopping.clone().wait_for(|stopping| *stopping).await;
    End::Closed(Close::Stopping, "the server is stopping".to_owned())
}

/// Serves a client from welcome to end, then removes it and its vehicle.
async fn serve_client(sink: &mut Sink, reader: &mut Reader, app: &App, name: &str) -> End {
    let id = app.clients.next_id();
    let (server_version, scene_name) = (env!("CARGO_PKG_VERSION").to_owned(), app.scene_name.clone());
    let welcome = ServerMessage::Welcome { client: id, server_version, scene_name };
    let first = [wire::encode(&welcome).into(), app.scene.clone()];
    if let Err(end) = write(sink, first, app.limits.stall_timeout).await {
        return end;
    }
    let (client, mut frames) = app.clients.join(id, name_for(id, name), app.limits.send.in_flight as usize);
    tracing::info!(client = id, name = client.name(), "joined");
    let (replies, mut queued_replies) = mpsc::channel(REPLY_CAPACITY);
    let end = tokio::select! {
        end = receive_all(reader, app, &client, &replies) => end,
        end = send_all(sink, &mut frames, &mut queued_replies, app.limits.stall_timeout, &client) => end,
        end = watch_acknowledgements(&client, app.limits.stall_timeout) => end,
        end = stopping(app) => end,
    };
    app.clients.leave(id);
    // An error means that the world has stopped, so there is nothing to remove.
    let _ = app.commands.send(Command::Remove { client: id }).await;
    tracing::info!(client = id, ?end, sent_bytes = client.sent_bytes(), "left");
    end
}

/// Receives and carries out the client's messages until it leaves or violates the protocol.
async fn receive_all(reader: &mut Reader, app: &App, client: &Client, replies: &mpsc::Sender<Bytes>) -> End {
    // The newest input that the world has not accepted yet; a world that lags skips older ones.
    let mut drive = None;
    loop {
        let message = tokio::select! {
            message = reader.next() => message,
            Ok(room) = app.commands.reserve(), if drive.is_some() => {
                if let Some(drive) = drive.take() {
                    room.send(Command::Drive { client: client.id, drive });
                }
                continue;
            }
        };
        let outcome = match message {
            Ok(message) => carry_out(message, app, client, &mut drive, replies).await,
            Err(end) => Err(end),
        };
        if let Err(end) = outcome {
            return end;
        }
    }
}

async fn carry_out(
    message: ClientMessage,
    app: &App,
    client: &Client,
    newest_drive: &mut Option<Drive>,
    replies: &mpsc::Sender<Bytes>,
) -> Result<(), End> {
    let id = client.id;
    match message {
        ClientMessage::Hello { .. } => return Err(bad("a second hello; a session has one")),
        ClientMessage::View { eye_m, radius_m } => {
            if !eye_m.iter().all(|m| m.abs() <= EYE_LIMIT_M) {
                return Err(bad(format!("view: eye_m is {eye_m:?}; allowed: each within ±{EYE_LIMIT_M}")));
            }
            if !(0.0..=VIEW_RADIUS_LIMIT_M).contains(&radius_m) {
                return Err(bad(format!("view: radius_m is {radius_m}; allowed: 0..={VIEW_RADIUS_LIMIT_M}")));
            }
            client.set_area_of_interest(AreaOfInterest { eye_m, radius_m });
        }
        ClientMessage::Choose { vehicle } => {
            // The input was meant for the previous vehicle.
            *newest_drive = None;
            // A new vehicle appears below the client's newest camera.
            let cameras = vehicle.map(|_| Command::Cameras(app.clients.cameras()));
            let choice = match vehicle {
                Some(kind) => Command::Spawn { client: id, kind },
                None => Command::Remove { client: id },
            };
            // These commands must not be lost, so this waits for a lagging world, which delays only this client's own input.
            for command in cameras.into_iter().chain([choice]) {
                let _ = app.commands.send(command).await;
            }
        }
        ClientMessage::Drive(drive) => {
            if !drive.is_valid() {
                return Err(bad(format!("drive: {drive:?}; allowed: throttle, steer and lift -1..=1, brake 0..=1")));
            }
            *newest_drive = Some(drive);
        }
        ClientMessage::Ack { frame } => {
            if !client.acknowledge(frame) {
                return Err(bad(format!("ack: frame {frame} was never sent")));
            }
        }
        ClientMessage::Ping { nonce } => {
            let _ = replies.try_send(wire::encode(&ServerMessage::Pong { nonce }).into());
        }
        ClientMessage::Rename { name } => client.rename(name_for(id, &name)),
    }
    Ok(())
}

/// Sends frames and replies as they come.
async fn send_all(
    sink: &mut Sink,
    frames: &mut mpsc::Receiver<Frame>,
    replies: &mut mpsc::Receiver<Bytes>,
    stall_timeout: Duration,
    client: &Client,
) -> End {
    loop {
        let messages = tokio::select! {
            Some(frame) = frames.recv() => frame.messages,
            Some(reply) = replies.recv() => vec![reply],
            else => return End::Broken,
        };
        let bytes = messages.iter().map(Bytes::len).sum();
        if let Err(end) = write(sink, messages, stall_timeout).await {
            return end;
        }
        client.count_sent(bytes);
    }
}

/// Ends when frames are in flight and none has been acknowledged for `stall_timeout`.
async fn watch_acknowledgements(client: &Client, stall_timeout: Duration) -> End {
    let mut since = (client.progress().1, Instant::now());
    loop {
        tokio::time::sleep(stall_timeout / 8).await;
        let (sent, acknowledged) = client.progress();
        if sent == acknowledged || acknowledged != since.0 {
            since = (acknowledged, Instant::now());
        } else if since.1.elapsed() > stall_timeout {
            let reason = format!("no frame was acknowledged for {} s", stall_timeout.as_secs_f32());
            return End::Closed(Close::Stalled, reason);
        }
    }
}

/// Writes and flushes messages within a time limit.
async fn write(sink: &mut Sink, messages: impl IntoIterator<Item = Bytes>, limit: Duration) -> Result<(), End> {
    let writing = async {
        for message in messages {
            sink.feed(Message::Binary(message)).await?;
        }
        sink.flush().await
    };
    match timeout(limit, writing).await {
        Ok(written) => written.map_err(|_: axum::Error| End::Broken),
        Err(_) => Err(End::Closed(Close::Stalled, format!("the client read nothing for {} s", limit.as_secs_f32()))),
    }
}

/// The next message; `None` for a ping or pong, which the WebSocket layer handles itself.
async fn receive(source: &mut Source) -> Result<Option<ClientMessage>, End> {
    match source.next().await {
        Some(Ok(Message::Binary(bytes))) => match wire::decode(&bytes, CLIENT_MESSAGE_LIMIT) {
            Ok(message) => Ok(Some(message)),
            Err(error @ WireError::Version { .. }) => Err(End::Closed(Close::Version, error.to_string())),
            Err(error) => Err(bad(error)),
        },
        Some(Ok(Message::Text(_))) => Err(bad("a text message; only binary messages are allowed")),
        Some(Ok(Message::Ping(_) | Message::Pong(_))) => Ok(None),
        Some(Ok(Message::Close(_))) | None => Err(End::Left),
        Some(Err(error)) if is_broken(&error) => Err(End::Broken),
        Some(Err(error)) => Err(bad(error)),
    }
}

/// Whether an error is due to the connection rather than to the client's data.
fn is_broken(error: &axum::Error) -> bool {
    let mut causes = std::iter::successors(Some(error as &dyn std::error::Error), |error| error.source());
    causes.any(|cause| cause.is::<std::io::Error>()) || error.to_string().contains("without closing handshake")
}

/// Sends the reason and a close frame, then waits for the client to close: with unread input, the system would discard the last messages.
async fn send_close(mut sink: Sink, mut source: Source, close: Close, reason: String) {
    let refusal = match close {
        Close::BadMessage => Some(Refusal::BadMessage),
        Close::RateLimit => Some(Refusal::RateLimit),
        Close::ServerFull => Some(Refusal::ServerFull),
        Close::Stopping => Some(Refusal::Stopping),
        Close::Version | Close::NoHello | Close::Stalled => None,
    };
    let refused = refusal.map(|refusal| wire::encode(&ServerMessage::Refused { refusal, reason: reason.clone() }).into());
    let last = CloseFrame { code: close.code(), reason: close_reason(&reason).into() };
    let sent = timeout(CLOSE_TIMEOUT, async {
        write(&mut sink, refused, CLOSE_TIMEOUT).await.ok()?;
        sink.send(Message::Close(Some(last))).await.ok()
    });
    if let Ok(Some(())) = sent.await {
        let answered = async {
            loop {
                match source.next().await {
                    Some(Ok(Message::Close(_))) => return,
                    Some(Ok(_)) => {}
                    Some(Err(_)) | None => std::future::pending().await,
                }
            }
        };
        let _ = timeout(CLOSE_TIMEOUT, answered).await;
    }
}

/// The reason, cut to the 123 bytes that a close frame can hold.
fn close_reason(reason: &str) -> String {
    reason[..reason.floor_char_boundary(123)].to_owned()
}

/// Display name of a client that calls itself `name`.
fn name_for(id: u32, name: &str) -> String {
    Some(clean_name(name)).filter(|name| !name.is_empty()).unwrap_or_else(|| format!("guest {id}"))
}

/// A name without control characters and surrounding whitespace, cut to [`NAME_LIMIT`] characters.
fn clean_name(name: &str) -> String {
    let printable: String = name.chars().filter(|c| !c.is_control()).collect();
    printable.trim().chars().take(NAME_LIMIT).collect::<String>().trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_cleaned_and_truncated() {
        assert_eq!(clean_name("  Ada\u{7}\n "), "Ada");
        assert_eq!(clean_name(&"ü".repeat(500)).chars().count(), NAME_LIMIT);
        assert_eq!(name_for(7, "\u{1b}\u{0}"), "guest 7");
    }

    #[test]
    fn close_reasons_are_truncated_at_a_character_boundary() {
        let reason = close_reason(&"é".repeat(200));
        assert!(reason.len() <= 123 && reason.chars().all(|c| c == 'é'));
    }
}
