//! Embeds a server in a program, connects a client over WebSocket, and prints the messages that the client receives while it drives a car.
//!
//! `cargo run --release -p prairie --example embed -- [SCENE] [FRAMES]`

use anyhow::Context;
use futures_util::{SinkExt, StreamExt};
use prairie::{Config, run, scenes};
use prairie_core::scene::VehicleKind;
use prairie_core::wire::{ClientMessage, Drive, SERVER_MESSAGE_LIMIT, ServerMessage, decode, encode};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::oneshot;
use tokio_tungstenite::tungstenite::{self, Message};
use tokio_tungstenite::{WebSocketStream, client_async};

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let scene = arguments.next().unwrap_or_else(|| "meadow".to_owned());
    let frames: u32 = arguments.next().map_or(Ok(100), |text| text.parse()).context("FRAMES")?;
    let listener = TcpListener::bind("127.0.0.1:0").await?;
    let address = listener.local_addr()?;
    let (stop, stopped) = oneshot::channel::<()>();
    let server = tokio::spawn(run(Config::new(scenes::load(&scene)?), listener, async {
        let _ = stopped.await;
    }));

    let (mut socket, _) = client_async(format!("ws://{address}/ws"), TcpStream::connect(address).await?).await?;
    send(&mut socket, &ClientMessage::Hello { name: "embed".to_owned() }).await?;
    let mut bytes = 0;
    loop {
        let message = receive(&mut socket, &mut bytes).await?;
        match message {
            ServerMessage::Welcome { client, server_version, scene_name, .. } => {
                println!("client {client} of prairie {server_version}, scene {scene_name}");
            }
            ServerMessage::Scene { scene, .. } => {
                println!("{}; {} kB", scene.summary, bytes / 1000);
                let [x, z] = [0, 1].map(|axis| scene.camera.at[axis] * scene.extent_m()[axis]);
                send(&mut socket, &ClientMessage::View { eye_m: [x, 5.0, z], radius_m: 48.0 }).await?;
                send(&mut socket, &ClientMessage::Choose { vehicle: Some(VehicleKind::Car) }).await?;
                send(&mut socket, &ClientMessage::Drive { number: 1, drive: Drive { throttle: 0.7, steer: 0.2, ..Drive::default() } })
                    .await?;
            }
            ServerMessage::Poses { objects, .. } => {
                if let Some(car) = objects.iter().find(|object| object.kind == VehicleKind::Car) {
                    let speed_m_per_s = car.velocity_m_per_s.iter().map(|v| v * v).sum::<f32>().sqrt();
                    let [x, y, z] = car.position_m;
                    print!("\rcar at {x:6.1} {y:5.1} {z:6.1} m, {speed_m_per_s:4.1} m/s; {:6} kB received", bytes / 1000);
                }
            }
            ServerMessage::FrameEnd { frame, .. } => {
                send(&mut socket, &ClientMessage::Ack { frame }).await?;
                if frame >= frames {
                    break;
                }
            }
            ServerMessage::Refused { reason, .. } => anyhow::bail!("refused: {reason}"),
            _ => {}
        }
    }
    println!();
    drop(stop);
    server.await??;
    Ok(())
}

async fn send(socket: &mut WebSocketStream<TcpStream>, message: &ClientMessage) -> tungstenite::Result<()> {
    socket.send(Message::Binary(encode(message).into())).await
}

/// The next message; adds its length to `bytes`.
async fn receive(socket: &mut WebSocketStream<TcpStream>, bytes: &mut usize) -> anyhow::Result<ServerMessage> {
    loop {
        if let Message::Binary(message) = socket.next().await.context("the server closed the connection")?? {
            *bytes += message.len();
            return Ok(decode(&message, SERVER_MESSAGE_LIMIT)?);
        }
    }
}
