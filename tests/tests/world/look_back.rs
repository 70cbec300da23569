//! Looking back: the past that a client shows has the bits that its live mirror had.

use super::replica::{Server, Viewer, commands};
use anyhow::{Context as _, Result, ensure};
use prairie::scenes::{self, LoadedScene};
use prairie::world::{Command, World};
use prairie_client::state::{CHECKPOINT_SECS, Event, Mirror, Past, PatchCodes, RECORD_SECS, Record};
use prairie_core::grass::{Replica, ReplicaState};
use prairie_core::grid::PatchIndex;
use prairie_core::random::SplitMix64;
use prairie_core::scene::VehicleKind;
use prairie_core::wire::{Drive, ObjectPose, SERVER_MESSAGE_LIMIT, decode};
use std::collections::BTreeMap;
use std::time::Instant;

/// A server, and a viewer that records.
struct Recording {
    server: Server,
    viewer: Viewer,
    record: Record,
    tick_hz: f32,
    queue: Vec<Command>,
}

impl Recording {
    fn new(loaded: &LoadedScene, record: Record) -> Result<Self> {
        let [extent_x, extent_z] = loaded.scene.extent_m();
        let server = Server::new(World::new(&loaded.scene, loaded.maps())?, loaded);
        let viewer = server.join(loaded, [0.5 * extent_x, 30.0, 0.5 * extent_z])?;
        Ok(Self { server, viewer, record, tick_hz: loaded.scene.tick_hz, queue: vec![] })
    }

    /// Does the steps to the next publication; the viewer receives and records it.
    fn publish(&mut self) -> Result<()> {
        self.server.publish(&mut self.queue, self.tick_hz);
        while let Ok(frame) = self.viewer.frames.try_recv() {
            for message in frame.messages {
                let message = decode(&message, SERVER_MESSAGE_LIMIT)?;
                if let Some(Event::FrameEnd { frame }) = self.record.apply(&mut self.viewer.mirror, message)? {
                    self.viewer.client.acknowledge(frame);
                }
            }
        }
        ensure!(self.viewer.mirror.take_difference().is_none(), "the client has found a difference");
        Ok(())
    }

    /// Records `publications`, always within these bytes and the time of a record. Returns the longest time recorded (s).
    fn longest_secs(&mut self, publications: u32, limit_bytes: usize) -> Result<f64> {
        let mut longest_secs = 0.0_f64;
        for _ in 0..publications {
            self.publish()?;
            let (length_secs, bytes) = (self.record.length_secs(), self.record.memory_bytes());
            longest_secs = longest_secs.max(length_secs);
            ensure!(bytes <= limit_bytes, "the record has {bytes} bytes instead of {limit_bytes}");
            ensure!(length_secs < RECORD_SECS + CHECKPOINT_SECS + 0.1, "the record is {length_secs} s long");
        }
        Ok(longest_secs)
    }

    fn live(&self) -> &Mirror {
        &self.viewer.mirror
    }

    fn secs_of(&self, tick: u64) -> f64 {
        tick as f64 / f64::from(self.tick_hz)
    }

    /// Lets two cars drive in circles.
    fn drive_two_cars(&mut self) {
        for (client, steer) in [(100, 0.3), (101, -0.5)] {
            self.queue.push(Command::Spawn { client, kind: VehicleKind::Car });
            self.queue.push(Command::Drive { client, number: 0, drive: Drive { throttle: 0.7, steer, lift: 0.0, brake: 0.0 } });
        }
    }
}

/// Copies of all that must come back: the replica's state, the codes of all bent patches, the poses, the number of broken plants, and the wind frame.
#[derive(Debug, PartialEq)]
struct Moment {
    /// `None` while the client takes patches.
    replica: Option<ReplicaState>,
    codes: BTreeMap<PatchIndex, PatchCodes>,
    objects: Vec<ObjectPose>,
    broken: u32,
    wind: Option<(u64, Vec<i16>)>,
}

impl Moment {
    fn of(mirror: &Mirror) -> Self {
        let replica = mirror.replica().map(Replica::state);
        // Codes of flattened grass are renewed at times that depend on when a replica began.
        let bent = mirror.bent_patches().filter(|_| replica.is_none());
        Self {
            codes: bent.filter_map(|patch| Some((patch, mirror.patch(patch)?.clone()))).collect(),
            replica,
            objects: mirror.newest_objects().to_vec(),
            broken: mirror.broken_count(),
            wind: mirror.wind().map(|wind| (wind.tick(), wind.codes().to_vec())),
        }
    }
}

/// Goes to a moment in slices of `frames` frames each.
fn catch_up(past: &mut Past, recording: &Recording, frames: u32) -> Result<()> {
    for _ in 0..10_000 {
        let mut left = frames;
        past.catch_up(&recording.record, recording.live(), || {
            left = left.saturating_sub(1);
            left == 0
        })?;
        if past.is_caught_up() {
            return Ok(());
        }
    }
    anyhow::bail!("the moment at {} s is not reached", past.goal_secs())
}

/// Compares the past at `tick` with the copy of the moment.
fn compare(past: &Past, tick: u64, moment: &Moment) -> Result<()> {
    let mirror = past.mirror().context("a past is shown")?;
    ensure!(mirror.tick() == tick, "step {} is shown instead of {tick}", mirror.tick());
    ensure!(Moment::of(mirror) == *moment, "the past differs at step {tick}");
    let awake = mirror.replica().map_or(0, |replica| replica.grass().field().awake_count());
    ensure!(mirror.bent_patches().count() >= awake.min(1), "no patch is shown at step {tick}");
    Ok(())
}

/// Records `publications` of a random drive in a scene, and visits moments of it in random order, and then some in a row.
fn look_back_at(scene: &str, publications: u64) -> Result<()> {
    let loaded = scenes::load(scene)?;
    let mut recording = Recording::new(&loaded, Record::default())?;
    let (mut random, mut moments) = (SplitMix64::new(11), BTreeMap::new());
    for publication in 0..publications {
        commands(&mut random, publication, &mut recording.queue);
        recording.publish()?;
        if recording.record.newest_secs().is_some() && publication % 7 == 0 {
            moments.insert(recording.live().tick(), Moment::of(recording.live()));
        }
    }
    let ticks: Vec<u64> = moments.keys().copied().collect();
    ensure!(ticks.len() as u64 > publications / 7 - 10, "the record has {} of {publications} publications", 7 * ticks.len());
    let mut past = Past::new(recording.secs_of(ticks[0]));
    for visit in 0..12 {
        let tick = ticks[random.next_u64() as usize % ticks.len()];
        past.seek(recording.secs_of(tick));
        catch_up(&mut past, &recording, if visit % 2 == 0 { 20 } else { u32::MAX })?;
        compare(&past, tick, &moments[&tick])?;
    }
    for tick in ticks {
        past.seek(recording.secs_of(tick));
        catch_up(&mut past, &recording, u32::MAX)?;
        compare(&past, tick, &moments[&tick])?;
    }
    Ok(())
}

#[test]
fn the_past_has_the_bits_that_the_live_mirror_had() -> Result<()> {
    look_back_at("meadow", 600)
}

#[test]
fn the_past_has_these_bits_in_every_built_in_scene() -> Result<()> {
    scenes::list().into_iter().try_for_each(|(scene, _)| look_back_at(scene, 160).with_context(|| scene.to_owned()))
}

#[test]
fn a_record_is_bounded_in_time_and_in_memory() -> Result<()> {
    let loaded = scenes::load("meadow")?;
    for (limit_bytes, publications) in [(usize::MAX, 2700), (3 << 20, 800), (1 << 10, 60)] {
        let mut recording = Recording::new(&loaded, Record::with_limit(limit_bytes))?;
        recording.drive_two_cars();
        let longest_secs = recording.longest_secs(publications, limit_bytes)?;
        let is_expected = match limit_bytes {
            usize::MAX => longest_secs > RECORD_SECS && recording.record.length_secs() > RECORD_SECS - 0.1,
            1024 => longest_secs == 0.0,
            _ => longest_secs > CHECKPOINT_SECS && longest_secs < 35.0,
        };
        ensure!(is_expected, "with {limit_bytes} bytes, the record was up to {longest_secs} s long");
    }
    Ok(())
}

#[test]
fn a_record_goes_on_while_patches_come_instead_of_a_replica() -> Result<()> {
    let loaded = scenes::load("meadow")?;
    let mut recording = Recording::new(&loaded, Record::default())?;
    recording.drive_two_cars();
    let mut moments = BTreeMap::new();
    // Longer than the server pauses between two states.
    for (publications, has_replica) in [(150, true), (130, false), (150, true)] {
        recording.viewer.client.request_replica(has_replica);
        for publication in 0..publications {
            recording.publish()?;
            if publication % 10 == 9 {
                moments.insert(recording.live().tick(), Moment::of(recording.live()));
            }
        }
        ensure!(recording.live().replica().is_some() == has_replica, "replica: {}", !has_replica);
    }
    let is_taken = |moment: &&Moment| moment.replica.is_none() && !moment.codes.is_empty() && !moment.objects.is_empty();
    ensure!(moments.values().filter(is_taken).count() >= 10, "bent patches came without a replica");
    let mut past = Past::new(0.0);
    catch_up(&mut past, &recording, u32::MAX)?;
    ensure!(Some(past.goal_secs()) == recording.record.oldest_secs(), "the past begins before the record");
    // One after the other, back in leaps, and at random.
    let ticks: Vec<u64> = moments.keys().copied().collect();
    let mut random = SplitMix64::new(5);
    let random_ticks: Vec<u64> = (0..20).map(|_| ticks[random.next_u64() as usize % ticks.len()]).collect();
    for &tick in ticks.iter().chain(ticks.iter().rev().step_by(7)).chain(&random_ticks) {
        past.seek(recording.secs_of(tick));
        catch_up(&mut past, &recording, u32::MAX)?;
        compare(&past, tick, &moments[&tick])?;
    }
    Ok(())
}

#[test]
fn a_record_of_patches_is_bounded_in_time_and_in_memory() -> Result<()> {
    let loaded = scenes::load("meadow")?;
    for (limit_bytes, publications) in [(usize::MAX, 2700), (3 << 20, 800), (1 << 10, 60)] {
        let mut recording = Recording::new(&loaded, Record::with_limit(limit_bytes))?;
        recording.viewer.client.request_replica(false);
        recording.drive_two_cars();
        let longest_secs = recording.longest_secs(publications, limit_bytes)?;
        println!("up to {longest_secs:.1} s in {} kB", recording.record.memory_bytes() / 1000);
        let is_expected = match limit_bytes {
            usize::MAX => longest_secs > RECORD_SECS,
            1024 => longest_secs == 0.0,
            _ => longest_secs > CHECKPOINT_SECS,
        };
        ensure!(is_expected, "with {limit_bytes} bytes, the record was up to {longest_secs} s long");
    }
    Ok(())
}

#[test]
fn time_goes_on_in_the_past_until_it_meets_the_present() -> Result<()> {
    let loaded = scenes::load("meadow")?;
    let mut recording = Recording::new(&loaded, Record::default())?;
    recording.drive_two_cars();
    for _ in 0..200 {
        recording.publish()?;
    }
    let newest_secs = recording.record.newest_secs().context("a record")?;
    let mut past = Past::new(newest_secs - 4.0);
    catch_up(&mut past, &recording, u32::MAX)?;
    past.advance(1.0);
    ensure!(past.goal_secs() == newest_secs - 4.0, "time does not stand still");
    past.play(true);
    for frame in 1..=600 {
        past.advance(0.01);
        catch_up(&mut past, &recording, u32::MAX)?;
        let expected_secs = (newest_secs - 4.0 + 0.01 * f64::from(frame)).min(newest_secs);
        let shown_secs = past.mirror().context("a past")?.shown_secs();
        ensure!((shown_secs - expected_secs).abs() < 1e-6, "{shown_secs} s is shown instead of {expected_secs}");
    }
    Ok(())
}

#[test]
#[ignore = "a measurement: cargo nextest run --release -p tests --run-ignored only a_record_of_two_cars --no-capture"]
fn a_record_of_two_cars_is_measured() -> Result<()> {
    let mut recording = Recording::new(&scenes::load("meadow")?, Record::default())?;
    recording.drive_two_cars();
    let (mut slowest_secs, mut total_secs) = (0.0_f64, 0.0);
    for _ in 0..2500 {
        let began = Instant::now();
        recording.publish()?;
        slowest_secs = slowest_secs.max(began.elapsed().as_secs_f64());
        total_secs += began.elapsed().as_secs_f64();
    }
    let (length_secs, bytes) = (recording.record.length_secs(), recording.record.memory_bytes());
    println!(
        "{length_secs:.0} s in {:.1} MB; a publication takes {:.1} ms, at most {:.1} ms",
        bytes as f64 / 1e6,
        total_secs / 2.5,
        slowest_secs * 1e3
    );
    let began = Instant::now();
    let state = recording.live().replica().context("a replica")?.state().encode();
    println!("a checkpoint has {} kB and takes {:.1} ms", state.len() / 1000, began.elapsed().as_secs_f64() * 1e3);
    let (oldest_secs, mut random) = (recording.record.oldest_secs().context("a record")?, SplitMix64::new(3));
    let mut past = Past::new(oldest_secs);
    let mut secs: Vec<f64> = vec![];
    for _ in 0..40 {
        past.seek(oldest_secs + length_secs * (random.next_u64() % 1000) as f64 / 1000.0);
        let began = Instant::now();
        catch_up(&mut past, &recording, u32::MAX)?;
        secs.push(began.elapsed().as_secs_f64());
    }
    secs.sort_unstable_by(f64::total_cmp);
    println!("going to a random moment takes {:.0} ms in the median, at most {:.0} ms", secs[20] * 1e3, secs[39] * 1e3);
    Ok(())
}
