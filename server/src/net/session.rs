//! One visitor's socket, from hello to close.

use super::routes::App;
use crate::bucket::Bucket;
use crate::stream::{Client, Frame, Gaze};
use crate::world::Command;
use axum::extract::ws::{CloseFrame, Message, WebSocket};
use bytes::Bytes;
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use shared::wire::{self, CLIENT_MESSAGE_LIMIT, ClientMessage, Close, Drive, Refusal, ServerMessage, VIEW_RADIUS_LIMIT_M, WireError};
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

/// Largest distance of a camera from the world's corner (m).
const EYE_LIMIT_M: f32 = 1e6;

/// The client's words, taken in no faster than the limit allows.
struct Ear {
    source: Source,
    allowance: Bucket,
    messages_per_sec: f64,
}

impl Ear {
    fn new(source: Source, messages_per_sec: f64) -> Self {
        Self { source, allowance: Bucket::new(2.0 * messages_per_sec, messages_per_sec, Instant::now()), messages_per_sec }
    }

    /// The next message. Those that the WebSocket layer answers itself are passed over, but count. May be given up while it waits; nothing is
    /// lost.
    async fn hear(&mut self) -> Result<ClientMessage, End> {
        loop {
            let message = receive(&mut self.source).await?;
            self.allowance.fill(Instant::now());
            if !self.allowance.try_take(1.0) {
                return Err(End::Closed(Close::RateLimit, format!("more than {} messages a second", self.messages_per_sec)));
            }
            if let Some(message) = message {
                return Ok(message);
            }
        }
    }
}

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

/// Runs a session; `place` is its permit to be here without a hello. It holds that, or a client's seat, until its last word is said.
pub(super) async fn run(socket: WebSocket, app: Arc<App>, mut place: OwnedSemaphorePermit) {
    let (mut sink, source) = socket.split();
    let mut ear = Ear::new(source, app.limits.messages_per_sec);
    let end = match hello(&mut ear, &app).await {
        Ok(name) => match app.seats.clone().try_acquire_owned() {
            Ok(seat) => {
                place = seat;
                visit(&mut sink, &mut ear, &app, &name).await
            }
            Err(_) => End::Closed(Close::ServerFull, format!("all {} places are taken; try again later", app.limits.clients)),
        },
        Err(end) => end,
    };
    if let End::Closed(close, reason) = end {
        tracing::info!(code = close.code(), reason, "closed a connection");
        farewell(sink, ear.source, close, reason).await;
    }
    drop(place);
}

/// Waits for the hello; returns the name in it.
async fn hello(ear: &mut Ear, app: &App) -> Result<String, End> {
    let greeting = app.limits.greeting;
    let first = tokio::select! {
        first = timeout(greeting, ear.hear()) => first,
        end = stopping(app) => return Err(end),
    };
    match first {
        Ok(Ok(ClientMessage::Hello { name })) => Ok(name),
        Ok(Ok(_)) => Err(bad("the first message must be a hello")),
        Ok(Err(end)) => Err(end),
        Err(_) => Err(End::Closed(Close::NoHello, format!("no hello within {} s", greeting.as_secs_f32()))),
    }
}

/// Completes when the server stops.
async fn stopping(app: &App) -> End {
    // A server that is gone has stopped.
    let _ = app.stopping.clone().wait_for(|stopping| *stopping).await;
    End::Closed(Close::Stopping, "the server is stopping".to_owned())
}

/// A joined client's time, from welcome to end; leaves no trace of it.
async fn visit(sink: &mut Sink, ear: &mut Ear, app: &App, name: &str) -> End {
    let id = app.clients.next_id();
    let (server_version, scene_name) = (env!("CARGO_PKG_VERSION").to_owned(), app.scene_name.clone());
    let welcome = ServerMessage::Welcome { client: id, server_version, scene_name };
    let greeting = [wire::encode(&welcome).into(), app.scene.clone()];
    if let Err(end) = write(sink, greeting, app.limits.stall).await {
        return end;
    }
    let (client, mut frames) = app.clients.join(id, name_for(id, name), app.limits.send.in_flight as usize);
    tracing::info!(client = id, name = client.name(), "joined");
    let (replies, mut answers) = mpsc::channel(REPLY_CAPACITY);
    let end = tokio::select! {
        end = listen(ear, app, &client, &replies) => end,
        end = speak(sink, &mut frames, &mut answers, app.limits.stall, &client) => end,
        end = watch_progress(&client, app.limits.stall) => end,
        end = stopping(app) => end,
    };
    app.clients.leave(id);
    // The world is gone only when the server stops; then nothing is left to remove.
    let _ = app.commands.send(Command::Remove { client: id }).await;
    tracing::info!(client = id, ?end, sent_bytes = client.sent_bytes(), "left");
    end
}

/// Reads and carries out what the client says, until it breaks a rule or leaves.
async fn listen(ear: &mut Ear, app: &App, client: &Client, replies: &mpsc::Sender<Bytes>) -> End {
    // The newest that the world has not taken yet; a world that lags misses those in between.
    let mut drive = None;
    loop {
        let message = tokio::select! {
            message = ear.hear() => message,
            Ok(room) = app.commands.reserve(), if drive.is_some() => {
                if let Some(drive) = drive.take() {
                    room.send(Command::Drive { client: client.id, drive });
                }
                continue;
            }
        };
        let done = match message {
            Ok(message) => carry_out(message, app, client, &mut drive, replies).await,
            Err(end) => Err(end),
        };
        if let Err(end) = done {
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
        ClientMessage::Hello { .. } => return Err(bad("a second hello")),
        ClientMessage::View { eye_m, radius_m } => {
            if !eye_m.iter().all(|m| m.abs() <= EYE_LIMIT_M) {
                return Err(bad(format!("view: eye_m is {eye_m:?}; each must be within ±{EYE_LIMIT_M}")));
            }
            if !(0.0..=VIEW_RADIUS_LIMIT_M).contains(&radius_m) {
                return Err(bad(format!("view: radius_m is {radius_m}; allowed: 0..={VIEW_RADIUS_LIMIT_M}")));
            }
            client.look(Gaze { eye_m, radius_m });
        }
        ClientMessage::Choose { vehicle } => {
            // What the hands did was meant for the vehicle before.
            *newest_drive = None;
            let view = vehicle.and(client.view()).map(Command::View);
            let choice = match vehicle {
                Some(kind) => Command::Spawn { client: id, kind },
                None => Command::Remove { client: id },
            };
            // Must not be lost; a world that lags slows this client's own input only.
            for command in view.into_iter().chain([choice]) {
                let _ = app.commands.send(command).await;
            }
        }
        ClientMessage::Drive(drive) => {
            if !drive.is_valid() {
                return Err(bad(format!("drive: {drive:?}; throttle, steer and lift must be -1..=1, brake 0..=1")));
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

/// The name to show of a client that calls itself `name`.
fn name_for(id: u32, name: &str) -> String {
    Some(clean_name(name)).filter(|name| !name.is_empty()).unwrap_or_else(|| format!("visitor {id}"))
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
        assert_eq!(name_for(7, "\u{1b}\u{0}"), "visitor 7");
    }

    #[test]
    fn a_reason_is_cut_between_characters() {
        let reason = close_reason(&"é".repeat(200));
        assert!(reason.len() <= 123 && reason.chars().all(|c| c == 'é'));
    }
}
