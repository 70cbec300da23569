//! The data rate of a client whose camera follows a driving car, without a network.

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

pub(crate) const STEPS_PER_PUBLISH: u64 = 3;
/// Simulated time before the measurement, to skip the first key frames and the onset of the wind (s).
const WARM_UP_SECS: f32 = 5.0;

/// What is measured.
#[derive(Clone, Debug)]
pub(crate) struct WatchedDrive {
    pub scene: String,
    pub radius_m: f32,
    pub measured_secs: f32,
    /// Whether clients have replicas of the grass instead of patches.
    pub has_replica: bool,
    pub has_car: bool,
    /// Clients beside the measured one, whose rate is not counted.
    pub viewers: u32,
}

/// Messages to the client, by kind: number and bytes; and the mean time of the streamer for a publication to all clients.
pub(crate) struct Measured {
    pub sums: BTreeMap<&'static str, (usize, usize)>,
    pub publishing: Duration,
    pub tick_hz: f32,
}

impl WatchedDrive {
    pub(crate) fn measure(&self) -> anyhow::Result<Measured> {
        let loaded = scenes::load(&self.scene)?;
        let requested = Arc::new(AtomicBool::new(false));
        let tick_hz = loaded.scene.tick_hz;
        let mut world = World::new(&loaded.scene, loaded.maps())?;
        let layout = PatchLayout::from(&loaded.scene.patches);
        let limits = SendLimits { bytes_per_s: 1e9, ..SendLimits::default() };
        let mut streamer = Streamer::new(layout, limits, tick_hz / STEPS_PER_PUBLISH as f32).requesting_states_by(requested.clone());
        let clients = Clients::default();
        let mut joined: Vec<_> =
            (0..=self.viewers).map(|_| clients.join(clients.next_id(), "viewer".to_owned(), limits.in_flight as usize)).collect();
        joined.iter().for_each(|(client, _)| client.request_replica(self.has_replica));
        let driver = joined[0].0.id;
        let mut commands = if self.has_car { vec![Command::Spawn { client: driver, kind: VehicleKind::Car }] } else { vec![] };

        let mut sums = BTreeMap::new();
        let (mut publishing, mut publishes) = (Duration::ZERO, 0);
        let mut quantiser = PatchQuantiser::default();
        let start = Instant::now();
        for step in 0..((WARM_UP_SECS + self.measured_secs) * tick_hz) as u64 {
            let weaving = (step as f32 / tick_hz * 0.7).sin() * 0.5;
            commands.push(Command::Drive { client: driver, number: 0, drive: Drive { throttle: 0.7, steer: weaving, ..Drive::default() } });
            world.step(&commands);
            commands.clear();
            if !step.is_multiple_of(STEPS_PER_PUBLISH) {
                continue;
            }
            let bend_state = requested.swap(false, Relaxed).then(|| world.bend_state()).flatten().map(Arc::new);
            let published = Published { bend_state, ..Published::new(world.publish(&mut quantiser)) };
            if let Some(car) = published.snapshot.objects.first() {
                let [x, y, z] = car.position_m;
                let area = AreaOfInterest { eye_m: [x, y + 3.0, z + 8.0], radius_m: self.radius_m };
                joined.iter().for_each(|(client, _)| client.set_area_of_interest(area));
            }
            let begun = Instant::now();
            let cameras = streamer.publish(&published, &clients.all(), start + Duration::from_secs_f32(step as f32 / tick_hz));
            let duration = begun.elapsed();
            commands.push(Command::Cameras(cameras));
            let is_measured = step as f32 > WARM_UP_SECS * tick_hz;
            if is_measured {
                publishing += duration;
                publishes += 1;
            }
            for (number, (client, frames)) in joined.iter_mut().enumerate() {
                while let Ok(frame) = frames.try_recv() {
                    client.acknowledge(frame.number);
                    for bytes in frame.messages.iter().filter(|_| is_measured && number == 0) {
                        let (count, sum) = sums.entry(kind(&decode(bytes, SERVER_MESSAGE_LIMIT)?)).or_default();
                        *count += 1;
                        *sum += bytes.len();
                    }
                }
            }
        }
        Ok(Measured { sums, publishing: publishing / publishes.max(1), tick_hz })
    }
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
