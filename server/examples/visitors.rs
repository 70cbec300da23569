//! Loads a running server with viewers and drivers, and prints how its memory and metrics develop.
//!
//! `cargo run --release -p prairie --example visitors -- HOST:PORT VIEWERS DRIVERS SECONDS [PID]`
//!
//! Viewers walk, drivers steer cars from one random place to the next, so that their tracks cover the whole world. With the server's process number and on
//! Linux, the resident memory is printed too. All visitors have one address: start the server with `--max-clients` and `--max-per-address` for so many.

use anyhow::Context;
use futures_util::{SinkExt, StreamExt};
use prairie_core::scene::VehicleKind;
use prairie_core::wire::{ClientMessage, Drive, ObjectPose, SERVER_MESSAGE_LIMIT, ServerMessage, decode, encode};
use std::f32::consts::PI;
use std::time::{Duration, Instant};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::protocol::WebSocketConfig;
use tokio_tungstenite::{WebSocketStream, client_async_with_config};

/// Time between two lines (s).
const REPORT_SECS: u64 = 10;
/// Radius of the visitors' views (m), as in the page at its highest quality.
const RADIUS_M: f32 = 112.0;
/// Metrics printed with the memory.
const METRICS: [&str; 6] = ["laid_tiles", "awake_patches", "cached_patches", "held_patches", "broken_plants", "dropped_secs"];

#[tokio::main]
async fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let address = arguments.next().context("HOST:PORT")?;
    let mut number = |name| arguments.next().map(|text| text.parse::<u64>()).transpose().with_context(|| format!("{name}: a whole number"));
    let (viewers, drivers, seconds, pid) = (number("VIEWERS")?, number("DRIVERS")?, number("SECONDS")?, number("PID")?);
    for index in 0..viewers.unwrap_or(20) + drivers.unwrap_or(5) {
        let (address, drives) = (address.clone(), index >= viewers.unwrap_or(20));
        tokio::spawn(async move {
            if let Err(error) = visit(&address, index, drives).await {
                eprintln!("visitor {index}: {error:#}");
            }
        });
    }
    let start = Instant::now();
    while start.elapsed() < Duration::from_secs(seconds.unwrap_or(600)) {
        tokio::time::sleep(Duration::from_secs(REPORT_SECS)).await;
        let health = health(&address).await?;
        let metrics: Vec<_> = METRICS.iter().map(|name| format!("{name} {}", health[name])).collect();
        let memory = pid.and_then(resident_mib).map_or_else(String::new, |mib| format!("{mib:6.1} MiB resident, "));
        println!("{:5.0} s: {memory}{}", start.elapsed().as_secs_f32(), metrics.join(", "));
    }
    Ok(())
}

/// Resident memory of a process (MiB); `None` where the system does not tell.
fn resident_mib(pid: u64) -> Option<f64> {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    line.split_whitespace().next()?.parse::<f64>().ok().map(|kib| kib / 1024.0)
}

async fn health(address: &str) -> anyhow::Result<serde_json::Value> {
    let mut stream = TcpStream::connect(address).await?;
    stream.write_all(format!("GET /healthz HTTP/1.1\r\nhost: {address}\r\nconnection: close\r\n\r\n").as_bytes()).await?;
    let mut response = String::new();
    stream.read_to_string(&mut response).await?;
    Ok(serde_json::from_str(response.split_once("\r\n\r\n").context("a response without a body")?.1)?)
}

/// Pseudo-random numbers in 0..1 (xorshift).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 40) as f32 / (1 << 24) as f32
    }

    /// A place at least 20 m from the border.
    fn place_m(&mut self, extent_m: [f32; 2]) -> [f32; 2] {
        extent_m.map(|extent_m| 20.0 + self.next() * (extent_m - 40.0))
    }
}

async fn visit(address: &str, index: u64, drives: bool) -> anyhow::Result<()> {
    let config = WebSocketConfig::default().max_message_size(Some(SERVER_MESSAGE_LIMIT)).max_frame_size(Some(SERVER_MESSAGE_LIMIT));
    let stream = TcpStream::connect(address).await?;
    let (mut socket, _) = client_async_with_config(format!("ws://{address}/ws"), stream, Some(config)).await?;
    let mut random = Random(0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(index + 1));
    let (mut id, mut object, mut extent_m, mut at_m, mut target_m) = (0, None, [0.0; 2], [0.0; 2], [0.0; 2]);
    let (mut next_input, mut moved) = (Instant::now(), Instant::now());
    send(&mut socket, &ClientMessage::Hello { name: format!("visitor {index}") }).await?;
    while let Some(message) = socket.next().await {
        let bytes = match message? {
            Message::Binary(bytes) => bytes,
            Message::Close(close) => anyhow::bail!("closed: {close:?}"),
            _ => continue,
        };
        match decode::<ServerMessage>(&bytes, SERVER_MESSAGE_LIMIT)? {
            ServerMessage::Welcome { client, .. } => id = client,
            ServerMessage::Scene { scene, .. } => {
                extent_m = scene.extent_m();
                (at_m, target_m) = (random.place_m(extent_m), random.place_m(extent_m));
                send(&mut socket, &view(at_m)).await?;
                if drives {
                    send(&mut socket, &ClientMessage::Choose { vehicle: Some(VehicleKind::Car) }).await?;
                }
            }
            ServerMessage::Roster { peers } => object = peers.iter().find(|peer| peer.client == id).and_then(|peer| peer.object),
            ServerMessage::Poses { objects, .. } if Instant::now() >= next_input => {
                next_input = Instant::now() + Duration::from_millis(100);
                if let Some(car) = objects.iter().find(|pose| Some(pose.id) == object) {
                    at_m = [car.position_m[0], car.position_m[2]];
                    if car.velocity_m_per_s[0].hypot(car.velocity_m_per_s[2]) > 0.5 {
                        moved = Instant::now();
                    }
                    if moved.elapsed() > Duration::from_secs(5) {
                        // Something holds the car: take another one elsewhere.
                        (at_m, moved) = (random.place_m(extent_m), Instant::now());
                        send(&mut socket, &view(at_m)).await?;
                        send(&mut socket, &ClientMessage::Choose { vehicle: Some(VehicleKind::Car) }).await?;
                        continue;
                    }
                    send(&mut socket, &ClientMessage::Drive { number: 1, drive: steer_to(car, target_m) }).await?;
                } else if !drives {
                    let [x, z] = [0, 1].map(|axis| target_m[axis] - at_m[axis]);
                    // Walking speed, 1.5 m/s.
                    at_m = [at_m[0] + 0.15 * x / x.hypot(z), at_m[1] + 0.15 * z / x.hypot(z)];
                }
                send(&mut socket, &view(at_m)).await?;
                if (at_m[0] - target_m[0]).hypot(at_m[1] - target_m[1]) < 8.0 || random.next() < 0.005 {
                    target_m = random.place_m(extent_m);
                }
            }
            ServerMessage::FrameEnd { frame, .. } => send(&mut socket, &ClientMessage::Ack { frame }).await?,
            _ => {}
        }
    }
    Ok(())
}

fn view([x, z]: [f32; 2]) -> ClientMessage {
    ClientMessage::View { eye_m: [x, 3.0, z], radius_m: RADIUS_M }
}

/// Steers a car towards a place.
fn steer_to(car: &ObjectPose, target_m: [f32; 2]) -> Drive {
    let [qx, qy, qz, qw] = car.rotation;
    // The body's forward axis, −Z, in the world.
    let forward = [-2.0 * (qx * qz + qw * qy), -(1.0 - 2.0 * (qx * qx + qy * qy))];
    let to = [target_m[0] - car.position_m[0], target_m[1] - car.position_m[2]];
    let angle_rad = (forward[0] * to[1] - forward[1] * to[0]).atan2(forward[0] * to[0] + forward[1] * to[1]);
    Drive { throttle: 0.7, steer: (angle_rad / (PI / 4.0)).clamp(-1.0, 1.0), ..Drive::default() }
}

async fn send(socket: &mut WebSocketStream<TcpStream>, message: &ClientMessage) -> anyhow::Result<()> {
    Ok(socket.send(Message::Binary(encode(message).into())).await?)
}
