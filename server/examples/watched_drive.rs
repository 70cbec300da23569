//! Measures the data rate of a client whose camera follows a driving car, by kind of message, without a network.
//!
//! `cargo run --release -p prairie --example watched_drive -- [SCENE] [RADIUS_M] [SECONDS] [patches|replica] [car|none]`: with patches or with a replica of the
//! grass, and with or without the car.

use anyhow::Context;
use prairie::runner::Published;
use prairie::scenes;
use prairie::snapshot::PatchQuantiser;
use prairie::stream::{AreaOfInterest, Clients, SendLimits, Streamer};
use prairie::world::{Command, World};
use prairie_core::grid::PatchLayout;
use prairie_core::scene::VehicleKind;
use prairie_core::wire::{Drive, SERVER_MESSAGE_LIMIT, ServerMessage, decode};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::{Duration, Instant};

const STEPS_PER_PUBLISH: u64 = 3;
/// Simulated time before the measurement, to skip the first key frames and the onset of the wind (s).
const WARM_UP_SECS: f32 = 5.0;

/// Messages of the measurement by kind: number and bytes.
type Sums = BTreeMap<&'static str, (usize, usize)>;

fn main() -> anyhow::Result<()> {
    let Arguments { scene, radius_m, measured_secs, has_replica, has_car } = arguments()?;
    let loaded = scenes::load(&scene)?;
    let requested = Arc::new(AtomicBool::new(false));
    let tick_hz = loaded.scene.tick_hz;
    let mut world = World::new(&loaded.scene, loaded.maps())?;
    let layout = PatchLayout::from(&loaded.scene.patches);
    let limits = SendLimits { bytes_per_s: 1e9, ..SendLimits::default() };
    let mut streamer = Streamer::new(layout, limits, tick_hz / STEPS_PER_PUBLISH as f32).requesting_states_by(requested.clone());
    let clients = Clients::default();
    let (client, mut frames) = clients.join(clients.next_id(), "driver".to_owned(), limits.in_flight as usize);
    client.request_replica(has_replica);
    let mut commands = if has_car { vec![Command::Spawn { client: client.id, kind: VehicleKind::Car }] } else { vec![] };

    let mut sums = Sums::new();
    let (mut publishing, mut publishes) = (Duration::ZERO, 0);
    let mut quantiser = PatchQuantiser::default();
    let start = Instant::now();
    for step in 0..((WARM_UP_SECS + measured_secs) * tick_hz) as u64 {
        let weaving = (step as f32 / tick_hz * 0.7).sin() * 0.5;
        commands.push(Command::Drive { client: client.id, number: 0, drive: Drive { throttle: 0.7, steer: weaving, ..Drive::default() } });
        world.step(&commands);
        commands.clear();
        if !step.is_multiple_of(STEPS_PER_PUBLISH) {
            continue;
        }
        let bend_state = requested.swap(false, Relaxed).then(|| world.bend_state()).flatten().map(Arc::new);
        let published = Published { bend_state, ..Published::new(world.publish(&mut quantiser)) };
        if let Some(car) = published.snapshot.objects.first() {
            let [x, y, z] = car.position_m;
            client.set_area_of_interest(AreaOfInterest { eye_m: [x, y + 3.0, z + 8.0], radius_m });
        }
        let begun = Instant::now();
        let cameras = streamer.publish(&published, &clients.all(), start + Duration::from_secs_f32(step as f32 / tick_hz));
        let duration = begun.elapsed();
        commands.push(Command::Cameras(cameras));
        let measured = step as f32 > WARM_UP_SECS * tick_hz;
        if measured {
            publishing += duration;
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
        "{scene}, radius {radius_m} m, {measured_secs} s at {} Hz; {:.2} ms per publication",
        tick_hz / STEPS_PER_PUBLISH as f32,
        publishing.as_secs_f64() * 1e3 / f64::from(publishes)
    );
    print_rates(&sums, measured_secs);
    Ok(())
}

/// Arguments of the program.
struct Arguments {
    scene: String,
    radius_m: f32,
    measured_secs: f32,
    has_replica: bool,
    has_car: bool,
}

fn arguments() -> anyhow::Result<Arguments> {
    let mut arguments = std::env::args().skip(1);
    Ok(Arguments {
        scene: arguments.next().unwrap_or_else(|| "meadow".to_owned()),
        radius_m: arguments.next().map_or(Ok(48.0), |text| text.parse()).context("RADIUS_M")?,
        measured_secs: arguments.next().map_or(Ok(20.0), |text| text.parse()).context("SECONDS")?,
        has_replica: arguments.next().is_some_and(|way| way == "replica"),
        has_car: arguments.next().is_none_or(|car| car == "car"),
    })
}

/// Prints the rate of each kind of message, and that of all.
fn print_rates(sums: &Sums, measured_secs: f32) {
    for (kind, (count, sum)) in sums {
        println!(
            "{kind:12} {:8.1} messages/s {:8.1} bytes each {:9.1} kbit/s",
            *count as f32 / measured_secs,
            *sum as f32 / *count as f32,
            *sum as f32 * 8e-3 / measured_secs
        );
    }
    println!("total {:.0} kbit/s", sums.values().map(|(_, sum)| *sum as f32).sum::<f32>() * 8e-3 / measured_secs);
}

fn kind(message: &ServerMessage) -> &'static str {
    match message {
        ServerMessage::Patch { key: true, payload, .. } if payload.is_empty() => "patch rest",
        ServerMessage::Patch { key: true, .. } => "patch key",
        ServerMessage::Patch { .. } => "patch delta",
        ServerMessage::Wind { .. } => "wind",
        ServerMessage::Poses { .. } => "poses",
        ServerMessage::Roster { .. } => "roster",
        ServerMessage::Broken { .. } => "broken",
        ServerMessage::FrameEnd { .. } => "frame end",
        ServerMessage::ReplicaState { .. } => "state",
        ServerMessage::Steps { .. } => "steps",
        _ => "other",
    }
}
