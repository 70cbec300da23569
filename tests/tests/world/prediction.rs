//! Prediction of the own vehicle: what a client shows, over a network with delay, against the poses that the world has later.

use super::replica::{STEPS_PER_PUBLISH, Server, Viewer};
use anyhow::{Context as _, Result, ensure};
use glam::Vec3;
use prairie::charts::worlds;
use prairie::scenes::LoadedScene;
use prairie::stream::Frame;
use prairie::world::{Command, World};
use prairie_client::prediction::Prediction;
use prairie_client::state::Event;
use prairie_core::random::SplitMix64;
use prairie_core::scene::VehicleKind::{self, Ball, Car, Helicopter, Monster, Sled, Walker};
use prairie_core::wire::{AppliedInput, Drive, ObjectId, ObjectPose, SERVER_MESSAGE_LIMIT, ServerMessage, decode};
use std::collections::VecDeque;
use std::time::Instant;

const TICK_HZ: f64 = 60.0;
/// Time between two pictures (s): not that of the steps.
const PICTURE_SECS: f64 = 1.0 / 57.0;
/// Way of a message, one way (s), and its jitter.
const WAY_SECS: f64 = 0.05;
const JITTER_SECS: f64 = 0.004;
/// Time of the first input, time before anything is measured, and end (s).
const START_SECS: f64 = 1.0;
const WARM_UP_SECS: f64 = 3.0;
const END_SECS: f64 = 18.0;
/// Shortest time between two inputs (s), as in the browser.
const INPUT_SECS: f64 = 1.0 / 30.0;

/// Bounds: error of 95 of 100 pictures (m), as a fraction of the error without a prediction, and movement between two pictures beyond that of the speed (m).
const ERROR_M: f64 = 0.25;
const FRACTION: f64 = 0.25;
const JUMP_M: f64 = 0.1;

/// Rolling hills with trees and stones.
fn hills() -> Result<LoadedScene> {
    worlds::loaded_hills(|pixel| match pixel.wrapping_mul(2_654_435_769) >> 20 {
        0..8 => 253,
        8..16 => 254,
        _ => 255,
    })
}

/// Input at a time (s): the same all along, or another one every 0.4 s.
fn input(kind: VehicleKind, changes: bool, secs: f64) -> Drive {
    let lift = match kind {
        Helicopter if secs < 4.0 => 0.6,
        // It runs.
        Walker => -1.0,
        _ => 0.0,
    };
    if !changes {
        return Drive { throttle: 0.9, steer: 0.15, lift, brake: 0.0 };
    }
    let mut random = SplitMix64::new((secs / 0.4) as u64);
    let mut unit = || (random.next_u64() >> 40) as f32 / (1_u64 << 24) as f32;
    let [throttle, steer, brake] = [unit(), unit(), unit()];
    let brake = if brake > 0.95 { 0.6 } else { 0.0 };
    Drive { throttle: 0.4 + 0.6 * throttle, steer: 1.2 * steer - 0.6, lift, brake }
}

/// What was shown in a picture, and the truth.
struct Shown {
    secs: f64,
    pose: ObjectPose,
    interpolated: ObjectPose,
    /// Moment of the picture (steps).
    ticks: f64,
    cost_secs: f64,
}

/// A client that drives, and its server, with the messages on their way.
struct Drives {
    server: Server,
    viewer: Viewer,
    prediction: Prediction,
    kind: VehicleKind,
    changes: bool,
    /// Messages with the time of their arrival (s).
    to_client: VecDeque<(f64, Frame)>,
    to_server: VecDeque<(f64, Command)>,
    /// Poses of the vehicle by step.
    truth: Vec<Option<ObjectPose>>,
    clock_secs: f64,
    sent: (f64, Drive),
    jitter: SplitMix64,
    /// Way of a message, one way (s).
    way_secs: f64,
}

impl Drives {
    fn new(loaded: &LoadedScene, kind: VehicleKind, changes: bool, is_replica: bool) -> Result<Self> {
        let middle_m = loaded.scene.extent_m().map(|extent| 0.5 * extent);
        let server = Server::new(World::new(&loaded.scene, loaded.maps())?, loaded);
        let viewer = server.join(loaded, [middle_m[0], 5.0, middle_m[1]])?;
        viewer.client.request_replica(is_replica);
        let spawn = (0.0, Command::Spawn { client: viewer.client.id, kind });
        let (prediction, sent) = (Prediction::new(true), (0.0, Drive::default()));
        let to_server = VecDeque::from([spawn]);
        let (jitter, to_client, truth) = (SplitMix64::new(5), VecDeque::new(), vec![None]);
        Ok(Self {
            server,
            viewer,
            prediction,
            kind,
            changes,
            to_client,
            to_server,
            truth,
            clock_secs: 0.0,
            sent,
            jitter,
            way_secs: WAY_SECS,
        })
    }

    fn way_secs(&mut self) -> f64 {
        self.way_secs + JITTER_SECS * (self.jitter.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn own(&self) -> Option<ObjectId> {
        self.server.world.object_of(self.viewer.client.id)
    }

    /// The server's step at `secs`.
    fn step(&mut self, secs: f64) {
        let mut commands = vec![];
        while self.to_server.front().is_some_and(|(at_secs, _)| *at_secs <= secs) {
            commands.extend(self.to_server.pop_front().map(|(_, command)| command));
        }
        self.server.world.step(&commands);
        let own = self.own();
        self.truth.push(self.server.world.poses().into_iter().find(|pose| Some(pose.id) == own));
        if self.server.world.tick().is_multiple_of(STEPS_PER_PUBLISH) {
            let mut cameras = vec![];
            self.server.send(&mut cameras, TICK_HZ as f32);
            self.to_server.extend(cameras.into_iter().map(|command| (secs, command)));
            while let Ok(frame) = self.viewer.frames.try_recv() {
                let arrives_secs = self.to_client.back().map_or(0.0, |(secs, _)| *secs).max(secs + self.way_secs());
                self.to_client.push_back((arrives_secs, frame));
            }
        }
    }

    /// Applies the messages that have arrived at the client by `secs`.
    fn receive(&mut self, secs: f64) -> Result<()> {
        while self.to_client.front().is_some_and(|(at_secs, _)| *at_secs <= secs) {
            let (at_secs, frame) = self.to_client.pop_front().context("there is a first")?;
            self.run_clock(at_secs);
            for message in frame.messages {
                if let Some(Event::FrameEnd { frame }) = self.viewer.mirror.apply(decode(&message, SERVER_MESSAGE_LIMIT)?)? {
                    self.viewer.client.acknowledge(frame);
                    self.prediction.receive(&self.viewer.mirror, at_secs);
                }
            }
        }
        self.run_clock(secs);
        Ok(())
    }

    fn run_clock(&mut self, secs: f64) {
        self.viewer.mirror.advance((secs - self.clock_secs).max(0.0));
        self.clock_secs = self.clock_secs.max(secs);
    }

    /// The client's picture at `secs`.
    fn picture(&mut self, secs: f64) -> Result<Option<Shown>> {
        self.receive(secs)?;
        let own = self.own();
        let drive = if secs < START_SECS { Drive::default() } else { input(self.kind, self.changes, secs) };
        if drive != self.sent.1 && secs - self.sent.0 >= INPUT_SECS && own.is_some() {
            let number = self.prediction.send(drive, &self.viewer.mirror, secs);
            let arrives_secs = secs + self.way_secs();
            self.to_server.push_back((arrives_secs, Command::Drive { client: self.viewer.client.id, number, drive }));
            self.to_server.make_contiguous().sort_by(|a, b| a.0.total_cmp(&b.0));
            self.sent = (secs, drive);
        }
        let began = Instant::now();
        let pose = self.prediction.pose(&self.viewer.mirror, own, secs);
        let cost_secs = began.elapsed().as_secs_f64();
        self.prediction.drawn(&self.viewer.mirror, secs);
        let shown = pose.zip(self.prediction.shown_ticks()).zip(own.and_then(|own| self.viewer.mirror.interpolated(own)));
        Ok(shown.map(|((pose, ticks), interpolated)| Shown { secs, pose, interpolated, ticks, cost_secs }))
    }

    /// The true position at a moment (steps).
    fn true_m(&self, ticks: f64) -> Option<Vec3> {
        let at_m = |tick: usize| Some(Vec3::from(self.truth.get(tick)?.as_ref()?.position_m));
        Some(at_m(ticks.floor() as usize)?.lerp(at_m(ticks.floor() as usize + 1)?, ticks.fract() as f32))
    }

    /// All pictures of a drive that show a prediction.
    fn run(&mut self) -> Result<Vec<Shown>> {
        let (mut shown, mut tick, mut picture) = (vec![], 1_u64, 1_u64);
        while (picture as f64) * PICTURE_SECS < END_SECS {
            let (step_secs, picture_secs) = (tick as f64 / TICK_HZ, picture as f64 * PICTURE_SECS);
            if step_secs <= picture_secs {
                self.step(step_secs);
                tick += 1;
            } else {
                shown.extend(self.picture(picture_secs)?);
                picture += 1;
            }
        }
        // The truth of the last pictures.
        (0..30).for_each(|n| self.step((tick + n) as f64 / TICK_HZ));
        Ok(shown)
    }
}

/// The value that 95 of 100 do not exceed.
fn percentile_95(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[(values.len() - 1) * 95 / 100]
}

/// Figures of a drive: errors (m) with and without a prediction, the largest jump beyond the speed (m), the deviation of the moment shown from the present (steps), latencies
/// (s), and mean and longest time of the prediction in a picture (µs).
#[derive(Debug)]
#[allow(dead_code, reason = "costs are printed")]
struct Figures {
    error_m: f64,
    interpolated_m: f64,
    jump_m: f64,
    present_ticks: f64,
    latencies_secs: [f64; 2],
    costs_us: [f64; 2],
}

fn figures(kind: VehicleKind, changes: bool, is_replica: bool) -> Result<Figures> {
    let mut drives = Drives::new(&hills()?, kind, changes, is_replica)?;
    let pictures = drives.run()?;
    let measured: Vec<_> = pictures.iter().filter(|shown| shown.secs > WARM_UP_SECS).collect();
    ensure!(measured.len() as f64 > 0.99 * (END_SECS - WARM_UP_SECS) / PICTURE_SECS, "only {} pictures are predicted", measured.len());
    ensure!(drives.viewer.mirror.replica().is_some() == is_replica, "the client has another kind of stream");
    let (mut errors, mut interpolated, mut jump_m, mut present_ticks) = (vec![], vec![], 0.0_f64, 0.0_f64);
    for shown in &measured {
        let truth = drives.true_m(shown.ticks).context("the world went on")?;
        errors.push(f64::from(truth.distance(shown.pose.position_m.into())));
        interpolated.push(f64::from(truth.distance(shown.interpolated.position_m.into())));
        let ideal_ticks = (shown.secs + WAY_SECS + 0.5 * JITTER_SECS) * TICK_HZ;
        present_ticks = present_ticks.max((shown.ticks - ideal_ticks).abs());
    }
    for pair in measured.windows(2) {
        let speed = |shown: &Shown| f64::from(Vec3::from(shown.pose.velocity_m_per_s).length());
        let moved_m = f64::from(Vec3::from(pair[1].pose.position_m).distance(pair[0].pose.position_m.into()));
        jump_m = jump_m.max(moved_m - speed(pair[0]).max(speed(pair[1])) * (pair[1].secs - pair[0].secs));
    }
    let costs: Vec<_> = measured.iter().map(|shown| shown.cost_secs).collect();
    let costs_us =
        [costs.iter().sum::<f64>() / costs.len() as f64, costs.iter().fold(0.0, |longest, cost| cost.max(longest))].map(|secs| 1e6 * secs);
    let latency = drives.prediction.latency();
    let latencies_secs = [latency.to_picture_secs(), latency.to_server_secs()].map(|secs| secs.unwrap_or(f64::NAN));
    let figures = Figures {
        error_m: percentile_95(errors),
        interpolated_m: percentile_95(interpolated),
        jump_m,
        present_ticks,
        latencies_secs,
        costs_us,
    };
    println!("{} {}: {figures:.3?}", kind.name(), if changes { "with changing input" } else { "with constant input" });
    Ok(figures)
}

fn check(kind: VehicleKind, is_replica: bool) -> Result<()> {
    for changes in [false, true] {
        let Figures { error_m, interpolated_m, jump_m, present_ticks, latencies_secs: [to_picture_secs, to_server_secs], .. } =
            figures(kind, changes, is_replica)?;
        let which = format!("{}, {}", kind.name(), if changes { "changing" } else { "constant" });
        ensure!(error_m <= ERROR_M, "{which}: {error_m} m");
        // Who runs is slower than any vehicle.
        ensure!(interpolated_m > if kind == Walker { 0.5 } else { 0.8 }, "{which}: hardly moves");
        ensure!(error_m < FRACTION * interpolated_m, "{which}: {error_m} m, and {interpolated_m} m without a prediction");
        ensure!(jump_m <= JUMP_M, "{which}: a jump of {jump_m} m");
        ensure!(present_ticks < 1.5, "{which}: {present_ticks} steps from the present");
        ensure!(
            !changes || (to_picture_secs < 0.02 && to_server_secs > 2.0 * WAY_SECS),
            "{which}: {to_picture_secs} s, {to_server_secs} s"
        );
    }
    Ok(())
}

#[test]
fn a_car_is_predicted_within_a_quarter_of_a_metre() -> Result<()> {
    check(Car, true)
}

#[test]
fn a_car_is_predicted_by_a_client_with_patches() -> Result<()> {
    check(Car, false)
}

#[test]
fn a_monster_is_predicted_within_a_quarter_of_a_metre() -> Result<()> {
    check(Monster, true)
}

#[test]
fn a_helicopter_is_predicted_within_a_quarter_of_a_metre() -> Result<()> {
    check(Helicopter, true)
}

#[test]
fn a_sled_is_predicted_within_a_quarter_of_a_metre() -> Result<()> {
    check(Sled, true)
}

#[test]
fn a_ball_is_predicted_within_a_quarter_of_a_metre() -> Result<()> {
    check(Ball, true)
}

#[test]
fn a_walker_is_predicted_within_a_quarter_of_a_metre() -> Result<()> {
    check(Walker, true)
}

#[test]
fn an_input_moves_the_picture_before_the_server_can_answer() -> Result<()> {
    for kind in [Car, Sled] {
        let pictures = Drives::new(&hills()?, kind, false, true)?.run()?;
        let is_early = |shown: &&Shown| shown.secs > START_SECS && shown.secs < START_SECS + 2.0 * WAY_SECS;
        let Shown { pose, interpolated, .. } =
            pictures.iter().rfind(is_early).context("the vehicle is predicted from its first input on")?;
        let [predicted, server] = [pose, interpolated].map(|pose| pose.velocity_m_per_s[0].hypot(pose.velocity_m_per_s[2]));
        ensure!(predicted > 0.2 && server < 0.1, "{}: {predicted} m/s are shown, {server} m/s by the server", kind.name());
    }
    Ok(())
}

#[test]
fn over_a_long_way_the_vehicle_is_interpolated() -> Result<()> {
    let mut drives = Drives::new(&hills()?, Monster, true, true)?;
    drives.way_secs = 0.22;
    drives.prediction.note_round_trip(2.0 * drives.way_secs);
    let predicted = drives.run()?;
    ensure!(predicted.is_empty() && !drives.prediction.is_predicting(), "{} pictures show a prediction", predicted.len());
    let to_picture_secs = drives.prediction.latency().to_picture_secs().context("inputs were measured")?;
    ensure!((0.5..0.7).contains(&to_picture_secs), "{to_picture_secs} s from an input to the picture");
    Ok(())
}

/// A ball at rest, its driver, and one who watches: what each of them was sent.
#[test]
fn an_input_is_reported_once_to_its_driver_only_and_costs_no_frames() -> Result<()> {
    let mut loaded = hills()?;
    (loaded.scene.wind.mean_m_per_s, loaded.scene.wind.sources) = ([0.0; 2], 0);
    let mut server = Server::new(World::new(&loaded.scene, loaded.maps())?, &loaded);
    let mut viewers = [server.join(&loaded, [128.0, 5.0, 128.0])?, server.join(&loaded, [128.0, 5.0, 128.0])?];
    let client = viewers[0].client.id;
    let parked = Drive { brake: 1.0, ..Drive::default() };
    let mut queue = vec![Command::Spawn { client, kind: Ball }];
    let (mut frames, mut applied) = ([0; 2], [vec![], vec![]]);
    for publication in 0..300 {
        if publication == 100 {
            queue.push(Command::Drive { client, number: u32::MAX, drive: parked });
        }
        server.publish(&mut queue, TICK_HZ as f32);
        for (n, viewer) in viewers.iter_mut().enumerate() {
            while let Ok(frame) = viewer.frames.try_recv() {
                frames[n] += usize::from(publication > 100);
                for message in frame.messages {
                    let decoded = decode(&message, SERVER_MESSAGE_LIMIT)?;
                    if let ServerMessage::Applied(input) = decoded {
                        ensure!(message.len() <= 10, "{} bytes", message.len());
                        applied[n].push(input);
                    }
                    if let Some(Event::FrameEnd { frame }) = viewer.mirror.apply(decoded)? {
                        viewer.client.acknowledge(frame);
                    }
                }
            }
        }
    }
    ensure!(viewers.iter().all(|viewer| viewer.mirror.replica().is_some()), "both have a replica");
    ensure!(applied == [vec![AppliedInput { number: u32::MAX, tick: 301 }], vec![]], "{applied:?}");
    ensure!(frames[0] == frames[1] && frames[0] < 150, "{frames:?} frames in 200 publications");

    let inputs = |world: &World| world.snapshot().inputs;
    let mut restored = World::restore(&loaded.scene, loaded.maps(), server.world.save())?;
    ensure!(inputs(&restored) == inputs(&server.world) && inputs(&restored).len() == 1);
    restored.step(&[Command::Leave { client }, Command::Return { client }]);
    ensure!(inputs(&restored).is_empty(), "a lost connection forgets the number");
    Ok(())
}
