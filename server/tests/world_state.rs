//! A world that is saved and restored continues bit for bit, on any number of threads.

use prairie::detail::{Decision, Detail, Reason};
use prairie::scenes;
use prairie::world::{Camera, Command, World, WorldState};
use prairie_core::scene::VehicleKind;
use prairie_core::wire::Drive;

/// Commands of a tick: all kinds of vehicles drive about, a camera moves, and one client leaves and returns.
fn commands(tick: u64, middle_m: [f32; 2]) -> Vec<Command> {
    let kind = |client: u32| VehicleKind::ALL[client as usize % VehicleKind::ALL.len()];
    let [x, z] = middle_m;
    let mut commands = vec![];
    if tick == 0 {
        commands.push(Command::Cameras(vec![Camera { client: 1, eye_m: [x, 2.0, z] }]));
        commands.extend((1..=5).flat_map(|client| [Command::Join { client }, Command::Spawn { client, kind: kind(client) }]));
    }
    if tick.is_multiple_of(10) {
        let swing = |client: u32| ((tick / 10 * 7 + u64::from(client) * 3) % 11) as f32 / 5.0 - 1.0;
        let drive = |client| Drive { throttle: 1.0, steer: swing(client), lift: swing(client + 1), brake: 0.0 };
        commands.extend((1..=5).map(|client| Command::Drive { client, number: 0, drive: drive(client) }));
        commands.push(Command::Cameras(vec![Camera { client: 1, eye_m: [x + 0.02 * tick as f32, 2.0, z] }]));
    }
    match tick {
        120 => commands.push(Command::Leave { client: 4 }),
        260 => commands.push(Command::Return { client: 4 }),
        _ => {}
    }
    commands
}

/// A change of detail, as the server decides on it.
fn adapt(world: &World, tick: u64) -> Option<Command> {
    let range = world.detail_range();
    let (longest, own) = (*range.wind_ticks.last().unwrap(), range.own);
    let detail = match tick {
        100 => Detail { wind_ticks: longest, ..own },
        149 => Detail { awake_limit: 3, publish_divisor: 2, ..own },
        260 => own,
        _ => return None,
    };
    Some(Command::Adapt(Decision { tick, detail, unloaded: detail, level: 3, reason: Reason::Overload { busy_ms: 9.0, budget_ms: 8.0 } }))
}

fn on_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(run)
}

fn step(world: &mut World, tick: u64, middle_m: [f32; 2]) {
    let adapt = adapt(world, tick);
    world.step(&[commands(tick, middle_m), adapt.into_iter().collect()].concat());
}

/// Compares a world with a copy that was saved after `before` ticks, for `after` more.
fn continues(scene: &str, before: u64, after: u64) {
    let loaded = scenes::load(scene).unwrap();
    let middle_m = loaded.scene.extent_m().map(|m| 0.5 * m);
    let mut world = World::new(&loaded.scene, loaded.maps()).unwrap();
    let mut younger = world.save();
    on_threads(2, || (0..before).for_each(|tick| step(&mut world, tick, middle_m)));
    let bytes = world.save().encode();
    world.save_into(&mut younger);
    assert!(younger.encode() == bytes, "{scene}: nothing remains of the state whose memory is used again");
    let state = WorldState::decode(&bytes).unwrap();
    assert!(state.tick() == before && state.encode() == bytes, "{scene}: the encoding is that of the same state");
    let mut copy = World::restore(&loaded.scene, loaded.maps(), state).unwrap();
    assert!(copy.save().encode() == bytes, "{scene}: everything is restored");
    assert_eq!(copy.checksum(), world.checksum(), "{scene}");
    let run = |world: &mut World| {
        let step = |tick| {
            step(world, tick, middle_m);
            world.checksum()
        };
        (before..before + after).map(step).collect::<Vec<_>>()
    };
    let sums = on_threads(2, || run(&mut world));
    let copied = on_threads(1, || run(&mut copy));
    let first = sums.iter().zip(&copied).position(|(one, other)| one != other);
    assert_eq!(first, None, "{scene}: the first of {after} ticks that differs");
    assert!(sums.windows(2).any(|pair| pair[0] != pair[1]), "{scene}: the world moves");
    assert!(world.save().encode() == copy.save().encode(), "{scene}: the whole state is equal at the end");
}

macro_rules! scenes {
    ($($name:ident)*) => {
        $(#[test]
        fn $name() {
            continues(stringify!($name), 150, 300);
        })*

        #[test]
        #[ignore = "takes minutes; cargo nextest run --release -p prairie --run-ignored only restored_worlds_stay_equal"]
        fn restored_worlds_stay_equal() {
            for scene in [$(stringify!($name)),*] {
                continues(scene, 1000, 6000);
            }
        }
    };
}

scenes!(meadow storm continuum devil underbrush);

#[test]
fn the_vehicle_of_a_lost_client_is_kept_for_a_minute() {
    let loaded = scenes::load("blades").unwrap();
    let kept_ticks = (prairie::world::KEPT_SECS / loaded.scene.dt_secs()).round() as u64;
    let mut world = World::new(&loaded.scene, loaded.maps()).unwrap();
    let take = |client| [Command::Join { client }, Command::Spawn { client, kind: VehicleKind::Car }];
    world.step(&take(1));
    world.step(&take(2));
    let [first, second] = [1, 2].map(|client| world.object_of(client));
    assert!(first.is_some() && second.is_some());
    world.step(&[Command::Leave { client: 1 }, Command::Leave { client: 2 }]);
    (0..kept_ticks / 2).for_each(|_| world.step(&[]));
    assert_eq!([1, 2].map(|client| world.object_of(client)), [first, second], "both wait");
    world.step(&[Command::Return { client: 2 }]);
    (0..kept_ticks).for_each(|_| world.step(&[]));
    assert_eq!([1, 2].map(|client| world.object_of(client)), [None, second], "the first has not returned");
}
