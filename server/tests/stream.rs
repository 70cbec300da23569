//! The stream: clients converge to the server's state whatever they miss, each grid is encoded once, and byte budgets hold.

mod common;

use common::Replica;
use prairie::runner::{Published, Request};
use prairie::snapshot::{BentPatches, PatchCodes, Snapshot, WindFrame};
use prairie::stream::{AreaOfInterest, Client, Clients, Frame, SendLimits, Streamer, patches_near};
use prairie_core::grid::PatchLayout;
use prairie_core::wire::{
    BROKEN_LIMIT, BrokenPlant, PATCH_MEMORY, Refusal, SERVER_MESSAGE_LIMIT, STANDINGS_LIMIT, ServerMessage, Standing, decode,
};
use proptest::prelude::*;
use std::num::NonZeroU8;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::time::{Duration, Instant};
use tokio::sync::mpsc::Receiver;

const LAYOUT: PatchLayout = PatchLayout { count: [3, 3], cells: 8, cell_m: 1.0 };
const GRID: usize = 3 * 8 * 8;
const WIND_CELLS: [u32; 3] = [4, 2, 4];
const PUBLISH_HZ: f32 = 20.0;
/// Publications after which every client is up to date.
const SETTLE: usize = 8;

/// A world of nine patches whose codes are set by the test.
struct FakeWorld {
    snapshot: Snapshot,
    requests: std::collections::BTreeMap<u32, Request>,
}

impl FakeWorld {
    fn at_rest() -> Self {
        Self::with_wind_planes(3)
    }

    fn with_wind_planes(planes: usize) -> Self {
        let wind = Arc::new(WindFrame { cells: WIND_CELLS, codes: vec![0; planes * 32], ..WindFrame::default() });
        let snapshot = Snapshot { wind, ..Snapshot::default() };
        Self { snapshot, requests: Default::default() }
    }

    fn patches(&mut self) -> &mut BentPatches {
        Arc::make_mut(&mut self.snapshot.patches)
    }

    fn change_patch(&mut self, patch: usize, change: impl FnOnce(&mut [i16])) {
        let mut codes = self.codes(patch);
        change(&mut codes);
        let tick = self.snapshot.tick;
        self.patches().insert(patch as u32, Arc::new(PatchCodes { tick, codes }));
    }

    fn codes(&self, patch: usize) -> Vec<i16> {
        self.snapshot.patches.get(&(patch as u32)).map_or_else(|| vec![0; GRID], |patch| patch.codes.clone())
    }

    fn publish(&mut self) -> Published {
        self.snapshot.tick += 3;
        Published { requests: self.requests.clone(), ..Published::new(self.snapshot.clone()) }
    }
}

/// A client, with the session's end of its frame queue.
struct Viewer {
    client: Arc<Client>,
    frames: Receiver<Frame>,
    replica: Replica,
}

impl Viewer {
    fn join(clients: &Clients, limits: SendLimits, radius_m: f32) -> Self {
        let (client, frames) = clients.join(clients.next_id(), "viewer".to_owned(), limits.in_flight as usize);
        client.set_area_of_interest(AreaOfInterest { eye_m: [12.0, 2.0, 12.0], radius_m });
        Self { client, frames, replica: Replica::new(LAYOUT.cells as usize, WIND_CELLS, false) }
    }

    /// Reads and acknowledges every queued frame.
    fn read(&mut self) -> Vec<Frame> {
        let frames: Vec<_> = std::iter::from_fn(|| self.frames.try_recv().ok()).collect();
        for frame in &frames {
            for message in &frame.messages {
                self.replica.apply(message);
            }
            assert!(self.client.acknowledge(frame.number));
        }
        frames
    }

    fn error_against(&self, prairie: &FakeWorld) -> u16 {
        self.error_over(0..LAYOUT.patches() as u32, prairie)
    }

    fn error_over(&self, patches: impl IntoIterator<Item = u32>, prairie: &FakeWorld) -> u16 {
        let patch_error = |patch: u32| {
            let held = self.replica.patches.get(&patch).map_or_else(|| vec![0; GRID], |(_, codes)| codes.clone());
            held.iter().zip(prairie.codes(patch as usize)).map(|(held, code)| held.abs_diff(code)).max().unwrap()
        };
        patches.into_iter().map(patch_error).max().unwrap()
    }
}

#[derive(Clone, Debug)]
enum Event {
    /// Adds to some codes of a patch.
    Change { patch: usize, at: usize, count: usize, by: i16 },
    /// Sets a patch to rest.
    Rest { patch: usize },
    /// Adds to the codes of the wind.
    Wind { by: i16 },
    /// Publishes a snapshot.
    Publish,
    /// One client reads and acknowledges.
    Read { viewer: usize },
}

fn event() -> impl Strategy<Value = Event> {
    prop_oneof![
        4 => (0..9_usize, 0..GRID, 1..40_usize, -9..=9_i16).prop_map(|(patch, at, count, by)| Event::Change { patch, at, count, by }),
        1 => (0..9_usize).prop_map(|patch| Event::Rest { patch }),
        1 => (-9..=9_i16).prop_map(|by| Event::Wind { by }),
        4 => Just(Event::Publish),
        3 => (0..3_usize).prop_map(|viewer| Event::Read { viewer }),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    /// For any changes, order of reads and byte budget: once the world is at rest and all clients have read, they hold its codes.
    #[test]
    fn all_clients_converge_to_the_world(
        events in prop::collection::vec(event(), 0..120),
        bytes_per_s in prop_oneof![Just(250_000.0), 200.0..2_000.0],
        has_dust: bool,
    ) {
        let limits = SendLimits { in_flight: 2, bytes_per_s };
        let planes = if has_dust { 4 } else { 3 };
        let (clients, mut prairie, mut now) = (Clients::default(), FakeWorld::with_wind_planes(planes), Instant::now());
        let mut streamer = Streamer::new(LAYOUT, limits, PUBLISH_HZ);
        let mut viewers: Vec<_> = (0..3).map(|_| Viewer::join(&clients, limits, 100.0)).collect();
        for viewer in &mut viewers {
            viewer.replica = Replica::new(LAYOUT.cells as usize, WIND_CELLS, has_dust);
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
                Event::Read { viewer } => drop(viewers[viewer].read()),
            }
        }
        for _ in 0..SETTLE + LAYOUT.patches() {
            now += Duration::from_secs(10);
            streamer.publish(&prairie.publish(), &clients.all(), now);
            viewers.iter_mut().for_each(|viewer| drop(viewer.read()));
        }
        for viewer in &viewers {
            prop_assert_eq!(viewer.error_against(&prairie), 0);
            prop_assert_eq!(&viewer.replica.wind.1, &prairie.snapshot.wind.codes);
        }
    }
}

/// A run in which patches 4 and 5 change at every publication; returns the number of encodings and the last frames of each client.
fn busy_run(viewers: usize, publishes: i32) -> (u64, Vec<Vec<Frame>>) {
    let limits = SendLimits::default();
    let (clients, mut prairie, mut now) = (Clients::default(), FakeWorld::at_rest(), Instant::now());
    let mut streamer = Streamer::new(LAYOUT, limits, PUBLISH_HZ);
    let mut viewers: Vec<_> = (0..viewers).map(|_| Viewer::join(&clients, limits, 100.0)).collect();
    let mut last = Vec::new();
    for publish in 0..publishes {
        for patch in [4, 5] {
            prairie.change_patch(patch, |codes| codes[publish as usize % GRID] = (publish % 100) as i16 + 10);
        }
        now += Duration::from_millis(50);
        streamer.publish(&prairie.publish(), &clients.all(), now);
        last = viewers.iter_mut().map(Viewer::read).collect();
    }
    let encodings = streamer.counters().encodings.load(Relaxed);
    (encodings, last)
}

#[test]
fn a_grid_is_encoded_once_for_any_number_of_clients() {
    let (for_one, _) = busy_run(1, 50);
    let (for_eight, last) = busy_run(8, 50);
    assert!(for_one >= 100, "two patches changed 50 times, {for_one} encodings");
    assert_eq!(for_one, for_eight);
    let patches = |frames: &[Frame]| -> Vec<_> { frames[0].messages[1..frames[0].messages.len() - 1].iter().map(|m| m.as_ptr()).collect() };
    assert_eq!(patches(&last[0]).len(), 2);
    assert!(last.iter().all(|frames| patches(frames) == patches(&last[0])), "all clients share the same bytes in memory");
}

#[test]
fn a_slow_client_gets_the_newest_state_not_a_queue() {
    let limits = SendLimits::default();
    let (clients, mut prairie, mut now) = (Clients::default(), FakeWorld::at_rest(), Instant::now());
    let mut streamer = Streamer::new(LAYOUT, limits, PUBLISH_HZ);
    let mut slow = Viewer::join(&clients, limits, 100.0);
    let mut quick = Viewer::join(&clients, limits, 100.0);
    let mut step = |prairie: &mut FakeWorld, level: i16| {
        prairie.change_patch(4, |codes| codes.fill(level));
        now += Duration::from_millis(50);
        streamer.publish(&prairie.publish(), &clients.all(), now);
    };
    for level in 1..=100 {
        step(&mut prairie, level);
        assert_eq!(quick.read().len(), 1, "the other client is not affected");
    }
    assert_eq!(slow.read().len(), limits.in_flight as usize, "the queue is bounded");
    step(&mut prairie, 120);
    let newest = slow.read();
    assert_eq!(newest.len(), 1);
    assert_eq!(slow.replica.tick, prairie.snapshot.tick);
    assert_eq!(slow.error_against(&prairie), 0, "one key frame instead of 96 deltas");
}

#[test]
fn a_client_gets_its_byte_budget_and_the_nearest_patches_first() {
    let limits = SendLimits { in_flight: 4, bytes_per_s: 2_000.0 };
    let (clients, mut prairie, start) = (Clients::default(), FakeWorld::at_rest(), Instant::now());
    let mut streamer = Streamer::new(LAYOUT, limits, PUBLISH_HZ);
    let mut viewer = Viewer::join(&clients, limits, 100.0);
    let mut noise = 1_u32;
    let mut largest = 0;
    let mut served = [0; 9];
    for publish in 1..=400 {
        for patch in 0..LAYOUT.patches() {
            prairie.change_patch(patch, |codes| {
                codes.fill_with(|| {
                    noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                    (noise >> 26) as i16
                })
            });
        }
        streamer.publish(&prairie.publish(), &clients.all(), start + Duration::from_millis(50 * publish));
        let before = viewer.replica.patches.clone();
        for frame in viewer.read() {
            largest = frame.messages.iter().map(|message| message.len()).max().unwrap().max(largest);
        }
        for (patch, held) in &viewer.replica.patches {
            served[*patch as usize] += u32::from(before.get(patch) != Some(held));
        }
    }
    let allowed = (limits.bytes_per_s * 20.0 + limits.bytes_per_s) as usize + 2 * largest;
    assert!(viewer.replica.bytes <= allowed, "{} bytes sent, {allowed} allowed", viewer.replica.bytes);
    assert!(viewer.replica.bytes >= allowed / 2, "{} bytes sent, {allowed} allowed", viewer.replica.bytes);
    assert!((0..9).all(|patch| served[4] >= served[patch]), "the camera's patch comes first: {served:?}");
}

#[test]
fn memory_does_not_grow_with_the_distance_travelled() {
    const STRIP: PatchLayout = PatchLayout { count: [400, 12], cells: 8, cell_m: 1.0 };
    const RADIUS_M: f32 = 60.0;
    let limits = SendLimits { bytes_per_s: 1e9, ..SendLimits::default() };
    let (clients, mut prairie, mut now) = (Clients::default(), FakeWorld::at_rest(), Instant::now());
    let mut streamer = Streamer::new(STRIP, limits, PUBLISH_HZ);
    let mut viewer = Viewer::join(&clients, limits, RADIUS_M);
    for patch in 0..STRIP.patches() {
        prairie.change_patch(patch, |codes| codes.fill(10 + (patch % 50) as i16));
    }
    let column = |x: u32| (0..STRIP.count[1]).map(move |z| (z * STRIP.count[0] + x) as usize);
    for x in (0..STRIP.count[0]).chain((0..STRIP.count[0]).rev()) {
        // On the far side of the world some grass comes to rest, and some bends the other way.
        for patch in column((x + STRIP.count[0] / 2) % STRIP.count[0]) {
            if patch.is_multiple_of(3) {
                prairie.patches().remove(&(patch as u32));
            } else {
                prairie.change_patch(patch, |codes| codes.iter_mut().for_each(|code| *code = -*code));
            }
        }
        let eye_m = [(x as f32 + 0.5) * STRIP.patch_m(), 2.0, 48.0];
        viewer.client.set_area_of_interest(AreaOfInterest { eye_m, radius_m: RADIUS_M });
        now += Duration::from_millis(50);
        streamer.publish(&prairie.publish(), &clients.all(), now);
        viewer.read();
        let near = patches_near(&STRIP, [eye_m[0], eye_m[2]], RADIUS_M);
        assert_eq!(viewer.error_over(near, &prairie), 0, "at column {x}");
        let counters = streamer.counters();
        let (held, cached) = (counters.held_patches.load(Relaxed), counters.cached_patches.load(Relaxed));
        assert!(held <= PATCH_MEMORY as u64, "{held} patches held");
        assert!(cached <= STRIP.patches() as u64 / 3, "{cached} patches cached");
    }
}

#[test]
fn bytes_sent_to_departed_clients_stay_counted() {
    let clients = Clients::default();
    for bytes in [100, 20] {
        let viewer = Viewer::join(&clients, SendLimits::default(), 1.0);
        viewer.client.count_sent(bytes);
        assert_eq!(viewer.client.sent_bytes(), bytes as u64);
        clients.leave(&viewer.client);
    }
    assert_eq!((clients.count(), clients.sent_bytes()), (0, 120));
}

#[test]
fn a_refused_vehicle_is_reported_once() {
    let limits = SendLimits::default();
    let (clients, mut prairie, now) = (Clients::default(), FakeWorld::at_rest(), Instant::now());
    let mut streamer = Streamer::new(LAYOUT, limits, PUBLISH_HZ);
    let mut viewer = Viewer::join(&clients, limits, 100.0);
    prairie.requests.insert(viewer.client.id, Request { tick: 3, object: None });
    let mut refusals = 0;
    for _ in 0..3 {
        streamer.publish(&prairie.publish(), &clients.all(), now);
        for frame in std::iter::from_fn(|| viewer.frames.try_recv().ok()) {
            for message in &frame.messages {
                let message = viewer.replica.apply(message);
                refusals += usize::from(matches!(message, ServerMessage::Refused { refusal: Refusal::ObjectLimit, .. }));
            }
        }
    }
    assert_eq!(refusals, 1);
}

/// A broken plant whose fall direction depends on its site.
fn plant(site: u32) -> BrokenPlant {
    BrokenPlant { site, fall: NonZeroU8::new((site % 255) as u8 + 1).expect("above 0") }
}

/// Broken plants in each message of the frames.
fn broken_in(frames: &[Frame]) -> Vec<Vec<BrokenPlant>> {
    let messages = frames.iter().flat_map(|frame| &frame.messages);
    let plants = |message: &bytes::Bytes| match decode(message, SERVER_MESSAGE_LIMIT) {
        Ok(ServerMessage::Broken { plants }) => Some(plants),
        _ => None,
    };
    messages.filter_map(plants).collect()
}

#[test]
fn a_new_client_gets_all_broken_plants_in_bounded_messages() {
    let limits = SendLimits::default();
    let (clients, mut prairie, mut now) = (Clients::default(), FakeWorld::at_rest(), Instant::now());
    let mut streamer = Streamer::new(LAYOUT, limits, PUBLISH_HZ);
    // The order of breaking differs from that of the sites.
    let all: Vec<BrokenPlant> = (0..10_000_u32).map(|n| plant(n * 7919 % 10_007)).collect();
    prairie.snapshot.broken = all.iter().copied().collect();
    let mut viewer = Viewer::join(&clients, limits, 100.0);
    let mut received = Vec::new();
    for publish in 0..6 {
        now += Duration::from_millis(50);
        streamer.publish(&prairie.publish(), &clients.all(), now);
        let messages = broken_in(&viewer.read());
        assert!(messages.len() <= 1 && (publish < 3) == (messages.len() == 1), "publish {publish}: {} messages", messages.len());
        assert!(messages.iter().all(|plants| plants.len() <= BROKEN_LIMIT && plants.is_sorted_by_key(|plant| plant.site)));
        received.extend(messages.into_iter().flatten());
    }
    let sorted = |mut plants: Vec<BrokenPlant>| {
        plants.sort_unstable_by_key(|plant| plant.site);
        plants
    };
    assert_eq!(sorted(received), sorted(all));
}

/// Plants that break while a client does not read or is out of budget are sent later, each exactly once.
#[test]
fn a_slow_client_misses_no_broken_plant() {
    let limits = SendLimits { in_flight: 2, bytes_per_s: 1_000.0 };
    let (clients, mut prairie, mut now) = (Clients::default(), FakeWorld::at_rest(), Instant::now());
    let mut streamer = Streamer::new(LAYOUT, limits, PUBLISH_HZ);
    let mut viewers: Vec<_> = (0..3).map(|_| Viewer::join(&clients, limits, 100.0)).collect();
    let mut received = vec![Vec::new(); 3];
    for publish in 0..400_u32 {
        if publish < 200 {
            (0..publish % 5).for_each(|n| prairie.snapshot.broken.push(plant(5 * publish + n)));
        }
        now += Duration::from_millis(50);
        streamer.publish(&prairie.publish(), &clients.all(), now);
        for (n, viewer) in viewers.iter_mut().enumerate() {
            if publish.is_multiple_of([1, 7, 60][n]) || publish >= 300 {
                received[n].extend(broken_in(&viewer.read()).into_iter().flatten());
            }
        }
    }
    assert_eq!(prairie.snapshot.broken.len(), 400);
    for received in received {
        assert_eq!(received.len(), 400, "each once");
        assert!(prairie.snapshot.broken.iter().all(|plant| received.contains(plant)));
    }
}

#[test]
fn broken_plants_are_encoded_once_for_all_clients() {
    let limits = SendLimits::default();
    let (clients, mut prairie, now) = (Clients::default(), FakeWorld::at_rest(), Instant::now());
    let mut streamer = Streamer::new(LAYOUT, limits, PUBLISH_HZ);
    prairie.snapshot.broken = [3, 1, 2].map(plant).into_iter().collect();
    let mut viewers: Vec<_> = (0..4).map(|_| Viewer::join(&clients, limits, 100.0)).collect();
    streamer.publish(&prairie.publish(), &clients.all(), now);
    let addresses = viewers.iter_mut().map(|viewer| {
        let frames = viewer.read();
        assert_eq!(broken_in(&frames), [[1, 2, 3].map(plant)]);
        let is_broken = |message: &&bytes::Bytes| matches!(decode(message, SERVER_MESSAGE_LIMIT), Ok(ServerMessage::Broken { .. }));
        frames[0].messages.iter().find(is_broken).expect("the message is there").as_ptr()
    });
    let addresses: Vec<_> = addresses.collect();
    assert!(addresses.iter().all(|address| *address == addresses[0]), "all clients share the same bytes in memory");
}

/// The race comes when it has changed, and at once to a client that joins; however often it changes, it takes at most a tenth of the data rate.
#[test]
fn the_race_is_sent_when_it_changes() {
    const SECS: u32 = 10;
    let limits = SendLimits { bytes_per_s: 20_000.0, ..SendLimits::default() };
    let (clients, mut prairie, mut now) = (Clients::default(), FakeWorld::at_rest(), Instant::now());
    let mut streamer = Streamer::new(LAYOUT, limits, PUBLISH_HZ);
    let mut viewer = Viewer::join(&clients, limits, 100.0);
    let races = |frames: &[Frame]| -> Vec<(usize, Vec<Standing>)> {
        let race = |message: &bytes::Bytes| match decode(message, SERVER_MESSAGE_LIMIT) {
            Ok(ServerMessage::Race { standings }) => Some((message.len(), standings)),
            _ => None,
        };
        frames.iter().flat_map(|frame| &frame.messages).filter_map(race).collect()
    };
    let mut publish = |prairie: &mut FakeWorld| {
        now += Duration::from_millis(50);
        streamer.publish(&prairie.publish(), &clients.all(), now);
    };
    publish(&mut prairie);
    assert_eq!(races(&viewer.read()), [], "nobody has begun");
    let standing = Standing { client: 1, best_secs: Some(20.0), ..Standing::default() };
    prairie.snapshot.standings = vec![standing];
    publish(&mut prairie);
    assert!(races(&viewer.read()).iter().map(|(_, standings)| standings).eq([&vec![standing]]));
    publish(&mut prairie);
    assert_eq!(races(&viewer.read()), [], "nothing has changed");
    let mut late = Viewer::join(&clients, limits, 100.0);
    publish(&mut prairie);
    assert_eq!([races(&late.read()).len(), races(&viewer.read()).len()], [1, 0]);
    let (mut bytes, mut largest, mut shown) = (0, 0, vec![]);
    for change in 0..SECS * PUBLISH_HZ as u32 + 40 {
        if change < SECS * PUBLISH_HZ as u32 {
            let row = |client| Standing { client, next_gate: (change % 32) as u8, began_secs: Some(f64::from(change)), ..standing };
            prairie.snapshot.standings = (0..STANDINGS_LIMIT as u32).map(row).collect();
        }
        publish(&mut prairie);
        for (length, standings) in races(&viewer.read()) {
            (bytes, largest, shown) = (bytes + length, largest.max(length), standings);
        }
    }
    assert_eq!(shown, prairie.snapshot.standings, "the newest race comes last");
    assert!(largest <= 40 * STANDINGS_LIMIT, "{largest} bytes for {STANDINGS_LIMIT} clients");
    let allowed = 0.1 * limits.bytes_per_s * (f64::from(SECS) + 2.0 + 1.0) + largest as f64;
    assert!(bytes > largest && bytes as f64 <= allowed, "{bytes} bytes of races, allowed {allowed}");
}

/// Rosters take at most a tenth of the data rate, and a burst of a second of that, however often clients change their names.
#[test]
fn a_client_that_renames_itself_often_costs_the_others_little() {
    const SECS: u32 = 10;
    let limits = SendLimits { bytes_per_s: 20_000.0, ..SendLimits::default() };
    let (clients, mut prairie, mut now) = (Clients::default(), FakeWorld::at_rest(), Instant::now());
    let mut streamer = Streamer::new(LAYOUT, limits, PUBLISH_HZ);
    let mut viewers: Vec<_> = (0..50).map(|_| Viewer::join(&clients, limits, 100.0)).collect();
    let (mut bytes, mut largest, mut name, mut shown) = (0, 0, String::new(), String::new());
    for publish in 0..SECS * PUBLISH_HZ as u32 + 40 {
        if publish < SECS * PUBLISH_HZ as u32 {
            name = format!("number {publish}");
            viewers[0].client.rename(name.clone());
        }
        now += Duration::from_millis(50);
        streamer.publish(&prairie.publish(), &clients.all(), now);
        for message in viewers.iter_mut().map(Viewer::read).next_back().unwrap().iter().flat_map(|frame| &frame.messages) {
            if let Ok(ServerMessage::Roster { peers }) = decode(message, SERVER_MESSAGE_LIMIT) {
                (bytes, largest) = (bytes + message.len(), largest.max(message.len()));
                shown.clone_from(&peers[0].name);
            }
        }
    }
    assert_eq!(shown, name, "the newest name comes last");
    let allowed = 0.1 * limits.bytes_per_s * (f64::from(SECS) + 2.0 + 1.0) + largest as f64;
    assert!(bytes > largest && bytes as f64 <= allowed, "{bytes} bytes of rosters, allowed {allowed}");
}
