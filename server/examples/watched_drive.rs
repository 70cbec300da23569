//! Measures what a client that watches a driving car is sent, by kind of message, without a network.
//!
//! `cargo run --release -p server --no-default-features --example watched_drive -- [SCENE] [RADIUS_M] [SECONDS]`

use anyhow::Context;
use server::runner::{Published, Simulation};
use server::scenes;
use server::stream::{Clients, Gaze, SendLimits, Streamer};
use server::world::{Command, World};
use shared::grid::PatchLayout;
use shared::scene::VehicleKind;
use shared::wire::{Drive, SERVER_MESSAGE_LIMIT, ServerMessage, decode};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

const STEPS_PER_PUBLISH: u64 = 3;
/// Time before the measurement, so that the first key frames and the wind's onset are over (s).
const WARM_UP_SECS: f32 = 5.0;

fn main() -> anyhow::Result<()> {
    let mut arguments = std::env::args().skip(1);
    let scene = arguments.next().unwrap_or_else(|| "meadow".to_owned());
    let radius_m: f32 = arguments.next().map_or(Ok(48.0), |text| text.parse()).context("RADIUS_M")?;
    let seconds: f32 = arguments.next().map_or(Ok(20.0), |text| text.parse()).context("SECONDS")?;
    let loaded = scenes::load(&scene)?;
    let tick_hz = loaded.scene.tick_hz;
    let mut world = World::new(&loaded.scene, loaded.maps())?;
    let layout = PatchLayout::from(&loaded.scene.patches);
    let limits = SendLimits { bytes_per_sec: 1e9, ..SendLimits::default() };
    let mut streamer = Streamer::new(layout, limits, tick_hz / STEPS_PER_PUBLISH as f32);
    let clients = Clients::default();
    let (client, mut frames) = clients.join(clients.next_id(), "driver".to_owned(), limits.in_flight as usize);
    let mut commands = vec![Command::Spawn { client: client.id, kind: VehicleKind::Car }];

    let mut sums: BTreeMap<&str, (usize, usize)> = BTreeMap::new();
    let (mut publishing, mut publishes) = (Duration::ZERO, 0);
    let start = Instant::now();
    for step in 0..((WARM_UP_SECS + seconds) * tick_hz) as u64 {
        let weaving = (step as f32 / tick_hz * 0.7).sin() * 0.5;
        commands.push(Command::Drive { client: client.id, drive: Drive { throttle: 0.7, steer: weaving, ..Drive::default() } });
        world.step(&commands);
        commands.clear();
        if !step.is_multiple_of(STEPS_PER_PUBLISH) {
            continue;
        }
        let published = Published { snapshot: Simulation::snapshot(&mut world), ..Published::default() };
        if let Some(car) = published.snapshot.objects.first() {
            let [x, y, z] = car.position_m;
            client.look(Gaze { eye_m: [x, y + 3.0, z + 8.0], radius_m });
        }
        let begun = Instant::now();
        let views = streamer.publish(&published, &clients.all(), start + Duration::from_secs_f32(step as f32 / tick_hz));
        let took = begun.elapsed();
        commands.push(Command::Views(views));
        let measured = step as f32 > WARM_UP_SECS * tick_hz;
        if measured {
            publishing += took;
            publishes += 1;
        }
        while let Ok(frame) = frames.try_recv() {
            client.acknowledge(frame.number);
            for bytes in frame.messages.iter().filter(|_| measured) {
                let (count, sum) = sums.entry(kind(&decode(bytes, SERVER_MESSAGE_LIMIT)?)).or_default();
                *count += 1;
                *sum += bytes.len();
            }
        }
    }
    println!(
        "{scene}, radius {radius_m} m, {seconds} s at {} Hz; publish {:.2} ms",
        tick_hz / STEPS_PER_PUBLISH as f32,
        publishing.as_secs_f64() * 1e3 / f64::from(publishes)
    );
    for (kind, (count, sum)) in &sums {
        println!(
            "{kind:12} {:8.1} messages/s {:8.1} bytes each {:9.1} kbit/s",
            *count as f32 / seconds,
            *sum as f32 / *count as f32,
            *sum as f32 * 8e-3 / seconds
        );
    }
    println!("total {:.0} kbit/s", sums.values().map(|(_, sum)| *sum as f32).sum::<f32>() * 8e-3 / seconds);
    Ok(())
}

fn kind(message: &ServerMessage) -> &'static str {
    match message {
        ServerMessage::Patch { key: true, payload, .. } if payload.is_empty() => "patch rest",
        ServerMessage::Patch { key: true, .. } => "patch key",
        ServerMessage::Patch { .. } => "patch delta",
        ServerMessage::Wind { .. } => "wind",
        ServerMessage::Poses { .. } => "poses",
        _ => "other",
    }
}
