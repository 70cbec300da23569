//! The stream: what clients hold is what the server has, whatever they miss; each grid is encoded once; nobody is sent too much.

mod common;

use common::Picture;
use proptest::prelude::*;
use server::runner::{Published, Request};
use server::snapshot::{BentPatches, PatchCodes, Snapshot, WindFrame};
use server::stream::{Client, Clients, DEAD_BAND, Frame, Gaze, SendLimits, Streamer, interest};
use shared::grid::PatchLayout;
use shared::wire::{BROKEN_LIMIT, BrokenPlant, PATCH_MEMORY, Refusal, SERVER_MESSAGE_LIMIT, ServerMessage, decode};
use std::num::NonZeroU8;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::time::{Duration, Instant};
use tokio::sync::mpsc::Receiver;

const LAYOUT: PatchLayout = PatchLayout { count: [3, 3], cells: 8, cell_m: 1.0 };
const GRID: usize = 3 * 8 * 8;
const WIND_CELLS: [u32; 3] = [4, 2, 4];
const PUBLISH_HZ: f32 = 20.0;
/// Publishes after which even the slowest grid has had a frame.
const SETTLE: usize = 8;

/// A world of nine patches whose codes the test sets.
struct Prairie {
    snapshot: Snapshot,
    requests: std::collections::BTreeMap<u32, Request>,
}

impl Prairie {
    fn at_rest() -> Self {
        Self::in_a_wind_of(3)
    }

    fn in_a_wind_of(planes: usize) -> Self {
        let wind = Arc::new(WindFrame { tick: 0, cells: WIND_CELLS, codes: vec![0; planes * 32] });
        let snapshot = Snapshot { wind, ..Snapshot::default() };
        Self { snapshot, requests: Default::default() }
    }

    fn patches(&mut self) -> &mut BentPatches {
        Arc::make_mut(&mut self.snapshot.patches)
    }

    fn change_patch(&mut self, patch: usize, change: impl FnOnce(&mut [i8])) {
        let mut codes = self.codes(patch);
        change(&mut codes);
        let tick = self.snapshot.tick;
        self.patches().insert(patch as u32, Arc::new(PatchCodes { tick, codes }));
    }

    fn codes(&self, patch: usize) -> Vec<i8> {
        self.snapshot.patches.get(&(patch as u32)).map_or_else(|| vec![0; GRID], |patch| patch.codes.clone())
    }

    fn publish(&mut self) -> Published {
        self.snapshot.tick += 3;
        Published { snapshot: self.snapshot.clone(), requests: self.requests.clone(), dropped_secs: 0.0 }
    }
}

/// A client with the session's end of its channel.
struct Visitor {
    client: Arc<Client>,
    frames: Receiver<Frame>,
    picture: Picture,
}

impl Visitor {
    fn join(clients: &Clients, limits: SendLimits, radius_m: f32) -> Self {
        let (client, frames) = clients.join(clients.next_id(), "visitor".to_owned(), limits.in_flight as usize);
        client.look(Gaze { eye_m: [12.0, 2.0, 12.0], radius_m });
        Self { client, frames, picture: Picture::new(LAYOUT.cells as usize, WIND_CELLS, false) }
    }

    /// Takes every frame that waits; acknowledges the newest.
    fn read(&mut self) -> Vec<Frame> {
        let frames: Vec<_> = std::iter::from_fn(|| self.frames.try_recv().ok()).collect();
        for frame in &frames {
            for message in &frame.messages {
                self.picture.apply(message);
            }
            assert!(self.client.acknowledge(frame.number));
        }
        frames
    }

    fn error_against(&self, prairie: &Prairie) -> u8 {
        self.error_over(0..LAYOUT.patches() as u32, prairie)
    }

    fn error_over(&self, patches: impl IntoIterator<Item = u32>, prairie: &Prairie) -> u8 {
        let patch_error = |patch: u32| {
            let held = self.picture.patches.get(&patch).map_or_else(|| vec![0; GRID], |(_, codes)| codes.clone());
            held.iter().zip(prairie.codes(patch as usize)).map(|(held, code)| held.abs_diff(code)).max().unwrap()
        };
        patches.into_iter().map(patch_error).max().unwrap()
    }
}

#[derive(Clone, Debug)]
enum Event {
    /// Adds to some codes of a patch.
    Change { patch: usize, at: usize, count: usize, by: i8 },
    /// A patch comes to rest.
    Rest { patch: usize },
    /// The wind turns.
    Wind { by: i8 },
    /// A snapshot is published.
    Publish,
    /// A client reads and acknowledges.
    Read { visitor: usize },
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        4 => (0..9_usize, 0..GRID, 1..40_usize, -9..=9_i8).prop_map(|(patch, at, count, by)| Event::Change { patch, at, count, by }),
        1 => (0..9_usize).prop_map(|patch| Event::Rest { patch }),
        1 => (-9..=9_i8).prop_map(|by| Event::Wind { by }),
        4 => Just(Event::Publish),
        3 => (0..3_usize).prop_map(|visitor| Event::Read { visitor }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    /// Whatever changes, whoever reads when, and however little anybody may be sent: once the world is still and all read, all hold its codes.
    #[test]
    fn every_history_ends_with_equal_grids(
        events in prop::collection::vec(event(), 0..120),
        bytes_per_sec in prop_oneof![Just(250_000.0), 200.0..2_000.0],
        has_dust: bool,
    ) {
        let limits = SendLimits { in_flight: 2, bytes_per_sec };
        let planes = if has_dust { 4 } else { 3 };
        let (clients, mut prairie, mut now) = (Clients::default(), Prairie::in_a_wind_of(planes), Instant::now());
        let mut streamer = Streamer::new(LAYOUT, limits, PUBLISH_HZ);
        let mut visitors: Vec<_> = (0..3).map(|_| Visitor::join(&clients, limits, 100.0)).collect();
        for visitor in &mut visitors {
            visitor.picture = Picture::new(LAYOUT.cells as usize, WIND_CELLS, has_dust);
        }
        for event in events {
            match event {
                Event::Change { patch, at, count, by } => prairie.change_patch(patch, |codes| {
                    for code in codes.iter_mut().skip(at).take(count) {
                        *code = code.saturating_add(by).max(-127);
                    }
                }),
                Event::Rest { patch } => drop(prairie.patches().remove(&(patch as u32))),
                Event::Wind { by } => {
                    let mut wind = (*prairie.snapshot.wind).clone();
                    wind.codes.iter_mut().for_each(|code| *code = code.saturating_add(by).max(-127));
                    prairie.snapshot.wind = Arc::new(wind);
                }
                Event::Publish => {
                    now += Duration::from_millis(50);
                    streamer.publish(&prairie.publish(), &clients.all(), now);
                }
                Event::Read { visitor } => drop(visitors[visitor].read()),
            }
        }
        for _ in 0..SETTLE + LAYOUT.patches() {
            now += Duration::from_secs(10);
            streamer.publish(&prairie.publish(), &clients.all(), now);
            visitors.iter_mut().for_each(|visitor| drop(visitor.read()));
        }
        for visitor in &visitors {
            prop_assert_eq!(visitor.error_against(&prairie), 0);
            prop_assert_eq!(&visitor.picture.wind.1, &prairie.snapshot.wind.codes);
        }
    }
}

/// A run in which patches 4 and 5 change at every publish; returns the encodings and what each visitor got last.
fn busy_run(visitors: usize, publishes: i32) -> (u64, Vec<Vec<Frame>>) {
    let limits = SendLimits::default();
    let (clients, mut prairie, mut now) = (Clients::default(), Prairie::at_rest(), Instant::now());
    let mut streamer = Streamer::new(LAYOUT, limits, PUBLISH_HZ);
    let mut visitors: Vec<_> = (0..visitors).map(|_| Visitor::join(&clients, limits, 100.0)).collect();
    let mut last = Vec::new();
    for publish in 0..publishes {
        for patch in [4, 5] {
            prairie.change_patch(patch, |codes| codes[publish as usize % GRID] = (publish % 100) as i8 + 10);
        }
        now += Duration::from_millis(50);
        streamer.publish(&prairie.publish(), &clients.all(), now);
        last = visitors.iter_mut().map(Visitor::read).collect();
    }
    let encodings = streamer.counters().encodings.load(Relaxed);
    (encodings, last)
}

#[test]
fn a_grid_is_encoded_once_however_many_look() {
    let (for_one, _) = busy_run(1, 50);
    let (for_eight, last) = busy_run(8, 50);
    assert!(for_one >= 100, "two patches changed 50 times, {for_one} encodings");
    assert_eq!(for_one, for_eight);
    let patches = |frames: &[Frame]| -> Vec<_> { frames[0].messages[1..frames[0].messages.len() - 1].iter().map(|m| m.as_ptr()).collect() };
    assert_eq!(patches(&last[0]).len(), 2);
    assert!(last.iter().all(|frames| patches(frames) == patches(&last[0])), "all share the same bytes in memory");
}

#[test]
fn a_slow_client_gets_the_newest_state_not_a_queue() {
    let limits = SendLimits::default();
    let (clients, mut prairie, mut now) = (Clients::default(), Prairie::at_rest(), Instant::now());
    let mut streamer = Streamer::new(LAYOUT, limits, PUBLISH_HZ);
    let mut slow = Visitor::join(&clients, limits, 100.0);
    let mut quick = Visitor::join(&clients, limits, 100.0);
    let mut step = |prairie: &mut Prairie, level: i8| {
        prairie.change_patch(4, |codes| codes.fill(level));
        now += Duration::from_millis(50);
        streamer.publish(&prairie.publish(), &clients.all(), now);
    };
    for level in 1..=100 {
        step(&mut prairie, level);
        assert_eq!(quick.read().len(), 1, "the other client is served as ever");
    }
    assert_eq!(slow.read().len(), limits.in_flight as usize, "no more than that waited");
    step(&mut prairie, 120);
    let newest = slow.read();
    assert_eq!(newest.len(), 1);
    assert_eq!(slow.picture.tick, prairie.snapshot.tick);
    assert_eq!(slow.error_against(&prairie), 0, "one key frame instead of 96 deltas");
}

#[test]
fn a_client_is_sent_its_budget_and_the_nearest_patches_first() {
    let limits = SendLimits { in_flight: 4, bytes_per_sec: 2_000.0 };
    let (clients, mut prairie, start) = (Clients::default(), Prairie::at_rest(), Instant::now());
    let mut streamer = Streamer::new(LAYOUT, limits, PUBLISH_HZ);
    let mut visitor = Visitor::join(&clients, limits, 100.0);
    let mut noise = 1_u32;
    let mut largest = 0;
    let mut served = [0; 9];
    for publish in 1..=400 {
        for patch in 0..LAYOUT.patches() {
            prairie.change_patch(patch, |codes| {
                codes.fill_with(|| {
                    noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    (noise >> 26) as i8
                })
            });
        }
        streamer.publish(&prairie.publish(), &clients.all(), start + Duration::from_millis(50 * publish));
        let before = visitor.picture.patches.clone();
        for frame in visitor.read() {
            largest = frame.messages.iter().map(|message| message.len()).max().unwrap().max(largest);
        }
        for (patch, held) in &visitor.picture.patches {
            served[*patch as usize] += u32::from(before.get(patch) != Some(held));
        }
    }
    let allowed = (limits.bytes_per_sec * 20.0 + limits.bytes_per_sec) as usize + 2 * largest;
    assert!(visitor.picture.bytes <= allowed, "{} bytes sent, {allowed} allowed", visitor.picture.bytes);
    assert!(visitor.picture.bytes >= allowed / 2, "{} bytes sent, {allowed} allowed", visitor.picture.bytes);
    assert!((0..9).all(|patch| served[4] >= served[patch]), "the camera's own patch comes first: {served:?}");
}

/// The error bound of the slow frames: at most the dead band while a patch moves, reached, and nothing once it is still.
#[test]
fn a_small_change_waits_within_the_dead_band() {
    let limits = SendLimits::default();
    let (clients, mut prairie, mut now) = (Clients::default(), Prairie::at_rest(), Instant::now());
    let mut streamer = Streamer::new(LAYOUT, limits, PUBLISH_HZ);
    let mut visitor = Visitor::join(&clients, limits, 100.0);
    let mut worst = 0;
    for publish in 0..200_i32 {
        prairie.change_patch(4, |codes| codes[7] = (publish * 7 % 5) as i8);
        now += Duration::from_millis(50);
        streamer.publish(&prairie.publish(), &clients.all(), now);
        visitor.read();
        worst = worst.max(visitor.error_against(&prairie));
    }
    assert_eq!(worst, DEAD_BAND);
    for _ in 0..SETTLE {
        now += Duration::from_millis(50);
        streamer.publish(&prairie.publish(), &clients.all(), now);
        visitor.read();
    }
    assert_eq!(visitor.error_against(&prairie), 0);
}

#[test]
fn what_is_remembered_does_not_grow_with_the_way_flown() {
    const STRIP: PatchLayout = PatchLayout { count: [400, 12], cells: 8, cell_m: 1.0 };
    const RADIUS_M: f32 = 60.0;
    let limits = SendLimits { bytes_per_sec: 1e9, ..SendLimits::default() };
    let (clients, mut prairie, mut now) = (Clients::default(), Prairie::at_rest(), Instant::now());
    let mut streamer = Streamer::new(STRIP, limits, PUBLISH_HZ);
    let mut visitor = Visitor::join(&clients, limits, RADIUS_M);
    for patch in 0..STRIP.patches() {
        prairie.change_patch(patch, |codes| codes.fill(10 + (patch % 50) as i8));
    }
    let column = |x: u32| (0..STRIP.count[1]).map(move |z| (z * STRIP.count[0] + x) as usize);
    for x in (0..STRIP.count[0]).chain((0..STRIP.count[0]).rev()) {
        // On the far side of the world some grass comes to rest and some bends the other way.
        for patch in column((x + STRIP.count[0] / 2) % STRIP.count[0]) {
            if patch.is_multiple_of(3) {
                prairie.patches().remove(&(patch as u32));
            } else {
                prairie.change_patch(patch, |codes| codes.iter_mut().for_each(|code| *code = -*code));
            }
        }
        let eye_m = [(x as f32 + 0.5) * STRIP.patch_m(), 2.0, 48.0];
        visitor.client.look(Gaze { eye_m, radius_m: RADIUS_M });
        now += Duration::from_millis(50);
        streamer.publish(&prairie.publish(), &clients.all(), now);
        visitor.read();
        let near = interest(&STRIP, [eye_m[0], eye_m[2]], RADIUS_M);
        assert_eq!(visitor.error_over(near, &prairie), 0, "at column {x}");
        let counters = streamer.counters();
        let (held, tracks) = (counters.held.load(Relaxed), counters.tracks.load(Relaxed));
        assert!(held <= PATCH_MEMORY as u64, "{held} patches that a client holds");
        assert!(tracks <= STRIP.patches() as u64 / 3, "{tracks} patches whose frames are kept");
    }
}

#[test]
fn what_was_sent_to_those_who_left_stays_counted() {
    let clients = Clients::default();
    for bytes in [100, 20] {
        let visitor = Visitor::join(&clients, SendLimits::default(), 1.0);
        visitor.client.count_sent(bytes);
        assert_eq!(visitor.client.sent_bytes(), bytes as u64);
        clients.leave(visitor.client.id);
    }
    assert_eq!((clients.count(), clients.sent_bytes()), (0, 120));
}

#[test]
fn a_refused_vehicle_is_said_once() {
    let limits = SendLimits::default();
    let (clients, mut prairie, now) = (Clients::default(), Prairie::at_rest(), Instant::now());
    let mut streamer = Streamer::new(LAYOUT, limits, PUBLISH_HZ);
    let mut visitor = Visitor::join(&clients, limits, 100.0);
    prairie.requests.insert(visitor.client.id, Request { tick: 3, object: None });
    let mut refusals = 0;
    for _ in 0..3 {
        streamer.publish(&prairie.publish(), &clients.all(), now);
        for frame in std::iter::from_fn(|| visitor.frames.try_recv().ok()) {
            for message in &frame.messages {
                let message = visitor.picture.apply(message);
                refusals += usize::from(matches!(message, ServerMessage::Refused { refusal: Refusal::ObjectLimit, .. }));
            }
        }
    }
    assert_eq!(refusals, 1);
}

/// A broken plant that fell its own way.
fn plant(site: u32) -> BrokenPlant {
    BrokenPlant { site, fall: NonZeroU8::new((site % 255) as u8 + 1).expect("above 0") }
}

/// Plants told of in frames, in the order of telling.
fn broken_in(frames: &[Frame]) -> Vec<Vec<BrokenPlant>> {
    let messages = frames.iter().flat_map(|frame| &frame.messages);
    let plants = |message: &bytes::Bytes| match decode(message, SERVER_MESSAGE_LIMIT) {
        Ok(ServerMessage::Broken { plants }) => Some(plants),
        _ => None,
    };
    messages.filter_map(plants).collect()
}

#[test]
fn a_newcomer_is_told_of_all_broken_plants_in_bounded_messages() {
    let limits = SendLimits::default();
    let (clients, mut prairie, mut now) = (Clients::default(), Prairie::at_rest(), Instant::now());
    let mut streamer = Streamer::new(LAYOUT, limits, PUBLISH_HZ);
    // In an order of breaking that is not that of the sites.
    let all: Vec<BrokenPlant> = (0..10_000_u32).map(|n| plant(n * 7919 % 10_007)).collect();
    prairie.snapshot.broken = all.iter().copied().collect();
    let mut visitor = Visitor::join(&clients, limits, 100.0);
    let mut told = Vec::new();
    for publish in 0..6 {
        now += Duration::from_millis(50);
        streamer.publish(&prairie.publish(), &clients.all(), now);
        let messages = broken_in(&visitor.read());
        assert!(messages.len() <= 1 && (publish < 3) == (messages.len() == 1), "publish {publish}: {} messages", messages.len());
        assert!(messages.iter().all(|plants| plants.len() <= BROKEN_LIMIT && plants.is_sorted_by_key(|plant| plant.site)));
        told.extend(messages.into_iter().flatten());
    }
    let sorted = |mut plants: Vec<BrokenPlant>| {
        plants.sort_unstable_by_key(|plant| plant.site);
        plants
    };
    assert_eq!(sorted(told), sorted(all));
}

/// Plants that break while a client reads nothing, or has spent its budget, are told later: all of them, each once.
#[test]
fn a_client_that_lags_misses_no_broken_plant() {
    let limits = SendLimits { in_flight: 2, bytes_per_sec: 1_000.0 };
    let (clients, mut prairie, mut now) = (Clients::default(), Prairie::at_rest(), Instant::now());
    let mut streamer = Streamer::new(LAYOUT, limits, PUBLISH_HZ);
    let mut visitors: Vec<_> = (0..3).map(|_| Visitor::join(&clients, limits, 100.0)).collect();
    let mut told = vec![Vec::new(); 3];
    for publish in 0..400_u32 {
        if publish < 200 {
            (0..publish % 5).for_each(|n| prairie.snapshot.broken.push(plant(5 * publish + n)));
        }
        now += Duration::from_millis(50);
        streamer.publish(&prairie.publish(), &clients.all(), now);
        for (n, visitor) in visitors.iter_mut().enumerate() {
            if publish.is_multiple_of([1, 7, 60][n]) || publish >= 300 {
                told[n].extend(broken_in(&visitor.read()).into_iter().flatten());
            }
        }
    }
    assert_eq!(prairie.snapshot.broken.len(), 400);
    for told in told {
        assert_eq!(told.len(), 400, "each once");
        assert!(prairie.snapshot.broken.iter().all(|plant| told.contains(plant)));
    }
}

#[test]
fn news_of_broken_plants_are_encoded_once_for_all() {
    let limits = SendLimits::default();
    let (clients, mut prairie, now) = (Clients::default(), Prairie::at_rest(), Instant::now());
    let mut streamer = Streamer::new(LAYOUT, limits, PUBLISH_HZ);
    prairie.snapshot.broken = [3, 1, 2].map(plant).into_iter().collect();
    let mut visitors: Vec<_> = (0..4).map(|_| Visitor::join(&clients, limits, 100.0)).collect();
    streamer.publish(&prairie.publish(), &clients.all(), now);
    let places = visitors.iter_mut().map(|visitor| {
        let frames = visitor.read();
        assert_eq!(broken_in(&frames), [[1, 2, 3].map(plant)]);
        let is_broken = |message: &&bytes::Bytes| matches!(decode(message, SERVER_MESSAGE_LIMIT), Ok(ServerMessage::Broken { .. }));
        frames[0].messages.iter().find(is_broken).expect("the message is there").as_ptr()
    });
    let places: Vec<_> = places.collect();
    assert!(places.iter().all(|place| *place == places[0]), "all share the same bytes in memory");
}
