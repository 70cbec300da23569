//! One visitor's socket, from hello to close.

use super::routes::App;
use crate::bucket::Bucket;
use crate::config::Limits;
use crate::stream::{Client, Frame, Gaze};
use crate::world::Command;
use axum::extract::ws::{CloseFrame, Message, WebSocket};
use bytes::Bytes;
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use shared::wire::{self, CLIENT_MESSAGE_LIMIT, ClientMessage, Close, Refusal, ServerMessage, WireError};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::{OwnedSemaphorePermit, mpsc};
use tokio::time::timeout;

type Sink = SplitSink<WebSocket, Message>;
type Source = SplitStream<WebSocket>;

/// Time that the last words to a client may take, and again that the client may take to hang up.
const FAREWELL: Duration = Duration::from_millis(500);

/// Answers that may wait to be written; more are dropped.
const REPLY_CAPACITY: usize = 16;

/// Longest name (characters).
const NAME_LIMIT: usize = 32;

/// Largest distance of a camera from the world's corner (m) and largest radius that it may ask for (m).
const EYE_LIMIT_M: f32 = 1e6;
const RADIUS_LIMIT_M: f32 = 512.0;

/// Why a session is over.
#[derive(Debug)]
enum End {
    /// The client hung up.
    Left,
    /// The connection broke.
    Broken,
    /// The server closes, for this reason.
    Closed(Close, String),
}

fn bad(reason: impl std::fmt::Display) -> End {
    End::Closed(Close::BadMessage, reason.to_string())
}

/// Runs a session; `place` is its permit to be here without a hello.
pub(super) async fn run(socket: WebSocket, app: Arc<App>, place: OwnedSemaphorePermit) {
    let (mut sink, mut source) = socket.split();
    let end = match timeout(app.limits.greeting, hello(&mut source)).await {
        Ok(Ok(name)) => match app.seats.clone().try_acquire_owned() {
            Ok(seat) => {
                drop(place);
                let end = visit(&mut sink, &mut source, &app, name).await;
                drop(seat);
                end
            }
            Err(_) => End::Closed(Close::ServerFull, format!("all {} places are taken; try again later", app.limits.clients)),
        },
        Ok(Err(end)) => end,
        Err(_) => End::Closed(Close::NoHello, format!("no hello within {} s", app.limits.greeting.as_secs_f32())),
    };
    if let End::Closed(close, reason) = end {
        tracing::info!(code = close.code(), reason, "closed a connection");
        farewell(sink, source, close, reason).await;
    }
}

/// Waits for the hello; returns the name in it, cleaned.
async fn hello(source: &mut Source) -> Result<String, End> {
    match receive(source).await? {
        Some(ClientMessage::Hello { name }) => Ok(clean_name(&name)),
        Some(_) => Err(bad("the first message must be a hello")),
        None => Box::pin(hello(source)).await,
    }
}

/// A joined client's time, from welcome to end; leaves no trace of it.
async fn visit(sink: &mut Sink, source: &mut Source, app: &App, name: String) -> End {
    let id = app.clients.next_id();
    let name = if name.is_empty() { format!("visitor {id}") } else { name };
    let welcome = ServerMessage::Welcome { client: id, server_version: env!("CARGO_PKG_VERSION").to_owned() };
    let greeting = [wire::encode(&welcome).into(), app.scene.clone()];
    if let Err(end) = write(sink, greeting, app.limits.stall).await {
        return end;
    }
    let (client, mut frames) = app.clients.join(id, name, app.limits.send.in_flight as usize);
    tracing::info!(client = id, name = client.name, "joined");
    let (replies, mut answers) = mpsc::channel(REPLY_CAPACITY);
    let mut stopping = app.stopping.clone();
    let end = tokio::select! {
        end = listen(source, app, &client, &replies) => end,
        end = speak(sink, &mut frames, &mut answers, app.limits.stall, &client) => end,
        end = watch_progress(&client, app.limits.stall) => end,
        _ = stopping.wait_for(|stopping| *stopping) => End::Closed(Close::Stopping, "the server is stopping".to_owned()),
    };
    app.clients.leave(id);
    // The world is gone only when the server stops; then nothing is left to remove.
    let _ = app.commands.send(Command::Remove { client: id }).await;
    tracing::info!(client = id, ?end, sent_bytes = client.sent_bytes(), "left");
    end
}

/// Reads and carries out what the client says, until it breaks a rule or leaves.
async fn listen(source: &mut Source, app: &App, client: &Client, replies: &mpsc::Sender<Bytes>) -> End {
    let Limits { messages_per_sec, .. } = app.limits;
    let mut allowance = Bucket::new(2.0 * messages_per_sec, messages_per_sec, Instant::now());
    loop {
        let message = match receive(source).await {
            Ok(message) => message,
            Err(end) => return end,
        };
        allowance.fill(Instant::now());
        if !allowance.try_take(1.0) {
            return End::Closed(Close::RateLimit, format!("more than {messages_per_sec} messages a second"));
        }
        let Some(message) = message else { continue };
        if let Err(end) = carry_out(message, app, client, replies).await {
            return end;
        }
    }
}

async fn carry_out(message: ClientMessage, app: &App, client: &Client, replies: &mpsc::Sender<Bytes>) -> Result<(), End> {
    let id = client.id;
    match message {
        ClientMessage::Hello { .. } => return Err(bad("a second hello")),
        ClientMessage::View { eye_m, radius_m } => {
            if !eye_m.iter().all(|m| m.abs() <= EYE_LIMIT_M) {
                return Err(bad(format!("view: eye_m is {eye_m:?}; each must be within ±{EYE_LIMIT_M}")));
            }
            if !(0.0..=RADIUS_LIMIT_M).contains(&radius_m) {
                return Err(bad(format!("view: radius_m is {radius_m}; allowed: 0..={RADIUS_LIMIT_M}")));
            }
            client.look(Gaze { eye_m, radius_m });
        }
        ClientMessage::Choose { vehicle } => {
            let command = match vehicle {
                Some(kind) => Command::Spawn { client: id, kind },
                None => Command::Remove { client: id },
            };
            // Must not be lost; a world that lags slows this client's own input only.
            let _ = app.commands.send(command).await;
        }
        ClientMessage::Drive(drive) => {
            if !drive.is_valid() {
                return Err(bad(format!("drive: {drive:?}; throttle, steer and lift must be -1..=1, brake 0..=1")));
            }
            // May be lost when the world lags; the next input follows soon.
            let _ = app.commands.try_send(Command::Drive { client: id, drive });
        }
        ClientMessage::Ack { frame } => {
            if !client.acknowledge(frame) {
                return Err(bad(format!("ack: frame {frame} was never sent")));
            }
        }
        ClientMessage::Ping { nonce } => {
            let _ = replies.try_send(wire::encode(&ServerMessage::Pong { nonce }).into());
        }
    }
    Ok(())
}

/// Writes frames and answers as they come.
async fn speak(
    sink: &mut Sink,
    frames: &mut mpsc::Receiver<Frame>,
    answers: &mut mpsc::Receiver<Bytes>,
    patience: Duration,
    client: &Client,
) -> End {
    loop {
        let messages = tokio::select! {
            Some(frame) = frames.recv() => frame.messages,
            Some(answer) = answers.recv() => vec![answer],
            else => return End::Broken,
        };
        let bytes = messages.iter().map(Bytes::len).sum();
        if let Err(end) = write(sink, messages, patience).await {
            return end;
        }
        client.count_sent(bytes);
    }
}

/// Ends when frames are on their way and none has been acknowledged for `patience`.
async fn watch_progress(client: &Client, patience: Duration) -> End {
    let mut since = (client.progress().1, Instant::now());
    loop {
        tokio::time::sleep(patience / 8).await;
        let (sent, acknowledged) = client.progress();
        if sent == acknowledged || acknowledged != since.0 {
            since = (acknowledged, Instant::now());
        } else if since.1.elapsed() > patience {
            let reason = format!("no frame was acknowledged for {} s", patience.as_secs_f32());
            return End::Closed(Close::Stalled, reason);
        }
    }
}

/// Writes messages and flushes them, within `patience`.
async fn write(sink: &mut Sink, messages: impl IntoIterator<Item = Bytes>, patience: Duration) -> Result<(), End> {
    let writing = async {
        for message in messages {
            sink.feed(Message::Binary(message)).await?;
        }
        sink.flush().await
    };
    match timeout(patience, writing).await {
        Ok(written) => written.map_err(|_: axum::Error| End::Broken),
        Err(_) => Err(End::Closed(Close::Stalled, format!("nothing was read for {} s", patience.as_secs_f32()))),
    }
}

/// The next message; none for one that the WebSocket layer answers itself.
async fn receive(source: &mut Source) -> Result<Option<ClientMessage>, End> {
    match source.next().await {
        Some(Ok(Message::Binary(bytes))) => match wire::decode(&bytes, CLIENT_MESSAGE_LIMIT) {
            Ok(message) => Ok(Some(message)),
            Err(error @ WireError::Version { .. }) => Err(End::Closed(Close::Version, error.to_string())),
            Err(error) => Err(bad(error)),
        },
        Some(Ok(Message::Text(_))) => Err(bad("a text message; only binary ones are understood")),
        Some(Ok(Message::Ping(_) | Message::Pong(_))) => Ok(None),
        Some(Ok(Message::Close(_))) | None => Err(End::Left),
        Some(Err(error)) if is_broken(&error) => Err(End::Broken),
        Some(Err(error)) => Err(bad(error)),
    }
}

/// Whether an error is the connection's rather than the client's.
fn is_broken(error: &axum::Error) -> bool {
    let mut causes = std::iter::successors(Some(error as &dyn std::error::Error), |error| error.source());
    causes.any(|cause| cause.is::<std::io::Error>()) || error.to_string().contains("without closing handshake")
}

/// Says why, closes, and waits a little for the client to hang up, lest unread bytes make the system discard the last words.
async fn farewell(mut sink: Sink, mut source: Source, close: Close, reason: String) {
    let refusal = match close {
        Close::BadMessage => Some(Refusal::BadMessage),
        Close::RateLimit => Some(Refusal::RateLimit),
        Close::ServerFull => Some(Refusal::ServerFull),
        Close::Stopping => Some(Refusal::Stopping),
        Close::Version | Close::NoHello | Close::Stalled => None,
    };
    let refused = refusal.map(|refusal| wire::encode(&ServerMessage::Refused { refusal, reason: reason.clone() }).into());
    let last = CloseFrame { code: close.code(), reason: close_reason(&reason).into() };
    let said = timeout(FAREWELL, async {
        write(&mut sink, refused, FAREWELL).await.ok()?;
        sink.send(Message::Close(Some(last))).await.ok()
    });
    if let Ok(Some(())) = said.await {
        let hung_up = async {
            loop {
                match source.next().await {
                    Some(Ok(Message::Close(_))) => return,
                    Some(Ok(_)) => {}
                    Some(Err(_)) | None => std::future::pending().await,
                }
            }
        };
        let _ = timeout(FAREWELL, hung_up).await;
    }
}

/// A close frame holds at most 123 bytes of reason.
fn close_reason(reason: &str) -> String {
    reason[..reason.floor_char_boundary(123)].to_owned()
}

/// A name without control characters and surrounding space, at most [`NAME_LIMIT`] characters long.
fn clean_name(name: &str) -> String {
    let printable: String = name.chars().filter(|c| !c.is_control()).collect();
    printable.trim().chars().take(NAME_LIMIT).collect::<String>().trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_cleaned_and_cut() {
        assert_eq!(clean_name("  Ada\u{7}\n "), "Ada");
        assert_eq!(clean_name(&"ü".repeat(500)).chars().count(), NAME_LIMIT);
        assert_eq!(clean_name("\u{1b}\u{0}"), "");
    }

    #[test]
    fn a_reason_is_cut_between_characters() {
        let reason = close_reason(&"é".repeat(200));
        assert!(reason.len() <= 123 && reason.chars().all(|c| c == 'é'));
    }
}
