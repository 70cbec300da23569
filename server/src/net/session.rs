//! A client's session on the WebSocket, from hello to close.

use super::app::App;
use super::connection::Connection;
use super::end::End;
use super::inputs::Inputs;
use super::name::name_for;
use super::reader::Reader;
use super::writer::Writer;
use crate::config::Limits;
use crate::stream::{Client, Frame};
use crate::world::Command;
use bytes::Bytes;
use futures_util::StreamExt;
use prairie_core::wire::{self, ClientMessage, Close, ServerMessage};
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::sync::{OwnedSemaphorePermit, mpsc};
use tokio::time::{Instant, timeout};
use tokio_tungstenite::WebSocketStream;

/// Time limit for sending the close frame, and again for the client's answer to it.
const CLOSE_TIMEOUT: Duration = Duration::from_millis(500);

/// Capacity of the queue of replies; when it is full, replies are dropped.
const REPLY_CAPACITY: usize = 16;

/// Checks per stall timeout whether the client has acknowledged anything.
const CHECKS: u32 = 8;

/// Runs a session. Until it has ended it keeps `slot`, the permit of a connection before its hello, and then that of a client.
pub(super) async fn run<S: AsyncRead + AsyncWrite + Unpin>(
    socket: WebSocketStream<S>,
    app: Arc<App>,
    connection: Arc<Connection>,
    mut slot: OwnedSemaphorePermit,
) {
    let (sink, source) = socket.split();
    let mut writer = Writer::new(sink, connection.clone(), app.limits.stall_timeout);
    let mut reader = Reader::new(source, connection.clone(), &app.limits);
    let end = match read_hello(&mut reader, &app).await {
        Ok(hello) => match admit(&app, &connection) {
            Ok(client_slot) => {
                slot = client_slot;
                serve_client(&mut writer, &mut reader, &app, &connection, &hello).await
            }
            Err(end) => end,
        },
        Err(end) => end,
    };
    if let End::Closed(close, reason) = end {
        if let Some(suppressed) = app.session_log.closed.due() {
            tracing::info!(code = close.code(), reason, suppressed = some(suppressed), "closed a connection");
        }
        if close == Close::RateLimit {
            connection.place.count_rate_limited();
        }
        // With unread input, the system would discard the last messages, so this waits for the client to close.
        if writer.close(close, &reason, CLOSE_TIMEOUT).await {
            let _ = timeout(CLOSE_TIMEOUT, reader.closed()).await;
        }
    }
    drop(slot);
}

/// A number of suppressed messages, left out of the log where it is zero.
fn some(suppressed: u64) -> Option<u64> {
    Some(suppressed).filter(|suppressed| *suppressed > 0)
}

/// The first message of a client.
struct Hello {
    name: String,
    /// The number of a client that is back; the vehicle of that number was kept.
    back: Option<u32>,
}

/// Waits for the hello.
async fn read_hello<S: AsyncRead + AsyncWrite + Unpin>(reader: &mut Reader<S>, app: &App) -> Result<Hello, End> {
    let limit = app.limits.handshake_timeout;
    let first = tokio::select! {
        first = timeout(limit, reader.next()) => first,
        end = stopping(app) => return Err(end),
    };
    match first {
        Ok(Ok(ClientMessage::Hello { name })) => Ok(Hello { name, back: None }),
        Ok(Ok(ClientMessage::Return { name, client, proof })) => {
            let back = (app.proofs.accepts(client, &proof) && app.published.borrow().has_vehicle(client)).then_some(client);
            Ok(Hello { name, back })
        }
        Ok(Ok(_)) => Err(End::bad("the first message must be a hello")),
        Ok(Err(end)) => Err(end),
        Err(_) => Err(End::Closed(Close::NoHello, format!("no hello within {} s", limit.as_secs_f32()))),
    }
}

/// Makes the connection a client, if the server and the client's address have room for one.
fn admit(app: &App, connection: &Connection) -> Result<OwnedSemaphorePermit, End> {
    let slot = app.client_slots.clone().try_acquire_owned();
    let slot =
        slot.map_err(|_| End::Closed(Close::ServerFull, format!("the server is full ({} clients); try again later", app.limits.clients)))?;
    connection.place.become_client().map_err(|reason| End::Closed(Close::ServerFull, reason))?;
    Ok(slot)
}

/// Completes when the server stops.
async fn stopping(app: &App) -> End {
    // An error means that the sender is gone, so the server has stopped.
    let _ = app.stopping.clone().wait_for(|stopping| *stopping).await;
    End::Closed(Close::Stopping, "the server is stopping".to_owned())
}

/// Serves a client from welcome to end, then removes it, and its vehicle unless that is kept.
async fn serve_client<S: AsyncRead + AsyncWrite + Unpin>(
    writer: &mut Writer<S>,
    reader: &mut Reader<S>,
    app: &App,
    connection: &Connection,
    hello: &Hello,
) -> End {
    let id = hello.back.unwrap_or_else(|| app.clients.next_id());
    let welcomed = tokio::select! {
        welcomed = welcome(writer, app, id) => welcomed,
        end = stopping(app) => Err(end),
    };
    if let Err(end) = welcomed {
        return end;
    }
    let (client, mut frames) = app.clients.join(id, name_for(id, &hello.name), app.limits.send.in_flight as usize);
    app.attendance.note();
    let arrival = if hello.back.is_some() { Command::Return { client: id } } else { Command::Join { client: id } };
    // An error means that the world has stopped, as for all commands here.
    let _ = app.commands.send(arrival).await;
    if let Some(suppressed) = app.session_log.joined.due() {
        let joined = if hello.back.is_some() { "returned" } else { "joined" };
        tracing::info!(client = id, name = client.name(), suppressed = some(suppressed), "{joined}");
    }
    let (replies, mut queued_replies) = mpsc::channel(REPLY_CAPACITY);
    let end = tokio::select! {
        end = receive_all(reader, app, &client, &replies) => end,
        end = send_all(writer, &mut frames, &mut queued_replies, &client) => end,
        end = watch_acknowledgements(&client, connection, &app.limits) => end,
        () = client.replaced() => End::Replaced,
        end = stopping(app) => end,
    };
    if app.clients.leave(&client) {
        for command in departure(&end, id) {
            let _ = app.commands.send(command).await;
        }
    }
    if let Some(suppressed) = app.session_log.left.due() {
        tracing::info!(client = id, ?end, sent_bytes = client.sent_bytes(), suppressed = some(suppressed), "left");
    }
    end
}

/// The commands for a client whose session has ended: its vehicle is kept if it may want to return. Without a vehicle its times in the race are forgotten.
fn departure(end: &End, client: u32) -> Vec<Command> {
    match end {
        End::Broken | End::Replaced | End::Closed(Close::Stopping | Close::Stalled, _) => vec![Command::Leave { client }],
        End::Left | End::Closed(..) => vec![Command::Remove { client }, Command::Leave { client }],
    }
}

/// Sends the welcome and the scene.
async fn welcome<S: AsyncRead + AsyncWrite + Unpin>(writer: &mut Writer<S>, app: &App, client: u32) -> Result<(), End> {
    let proof = app.proofs.issue(client);
    let (server_version, scene_name) = (env!("CARGO_PKG_VERSION").to_owned(), app.scene_name.clone());
    writer.send([wire::encode(&ServerMessage::Welcome { client, proof, server_version, scene_name }).into()]).await?;
    writer.send_fragmented(app.scene.clone()).await
}

/// Receives and carries out the client's messages until it leaves or violates the protocol.
async fn receive_all<S: AsyncRead + AsyncWrite + Unpin>(
    reader: &mut Reader<S>,
    app: &App,
    client: &Client,
    replies: &mpsc::Sender<Bytes>,
) -> End {
    let mut inputs = Inputs::new(&app.limits);
    loop {
        inputs.carry_out(app, client).await;
        let wait = inputs.wait();
        let message = tokio::select! {
            message = reader.next() => message,
            Ok(room) = app.commands.reserve(), if inputs.has_drive() => {
                if let Some((number, drive)) = inputs.take_drive() {
                    room.send(Command::Drive { client: client.id, number, drive });
                }
                continue;
            }
            () = tokio::time::sleep(wait.unwrap_or_default()), if wait.is_some() => continue,
        };
        if let Err(end) = message.and_then(|message| inputs.take_in(message, client, replies)) {
            return end;
        }
    }
}

/// Sends frames and replies as they come.
async fn send_all<S: AsyncRead + AsyncWrite + Unpin>(
    writer: &mut Writer<S>,
    frames: &mut mpsc::Receiver<Frame>,
    replies: &mut mpsc::Receiver<Bytes>,
    client: &Client,
) -> End {
    loop {
        let (number, messages) = tokio::select! {
            Some(frame) = frames.recv() => (Some(frame.number), frame.messages),
            Some(reply) = replies.recv() => (None, vec![reply]),
            else => return End::Broken,
        };
        let bytes = messages.iter().map(Bytes::len).sum();
        if let Err(end) = writer.send(messages).await {
            return end;
        }
        client.count_sent(bytes);
        if let Some(number) = number {
            client.note_written(number);
        }
    }
}

/// Ends when frames have been written and none has been acknowledged for `stall_timeout`, but not in the first `load_timeout`, in which a client builds the
/// scene and compiles its shaders. The bytes of a frame that is being written count as progress.
async fn watch_acknowledgements(client: &Client, connection: &Connection, limits: &Limits) -> End {
    let period = limits.stall_timeout / CHECKS;
    let (began, mut before, mut idle_checks) = (Instant::now(), None, 0);
    loop {
        tokio::time::sleep(period).await;
        let progress = client.progress();
        let writing_bytes = (progress.handed_out > progress.written).then(|| connection.written_bytes());
        let now = Some((progress.written, progress.acknowledged, writing_bytes));
        idle_checks = if progress.written <= progress.acknowledged || now != before { 0 } else { idle_checks + 1 };
        before = now;
        if idle_checks >= CHECKS && began.elapsed() >= limits.load_timeout {
            let idle = period * idle_checks;
            return End::Closed(Close::Stalled, format!("no frame was acknowledged for {} s", idle.as_secs_f32()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_leaves_for_good_leaves_nothing() {
        let gone = [Command::Remove { client: 3 }, Command::Leave { client: 3 }];
        assert_eq!(departure(&End::Left, 3), gone);
        assert_eq!(departure(&End::Closed(Close::RateLimit, String::new()), 3), gone);
        for lost in [End::Broken, End::Replaced, End::Closed(Close::Stopping, String::new())] {
            assert_eq!(departure(&lost, 3), [Command::Leave { client: 3 }]);
        }
    }
}
