//! The same scene and commands give the same bits on any number of threads.

use prairie::charts::worlds;
use prairie::world::{Camera, Command};
use prairie_core::scene::VehicleKind;
use prairie_core::wire::Drive;

const CLIENTS: u32 = 6;

/// Commands of a tick: all kinds of vehicles drive about, a camera moves, one client leaves and returns.
fn commands(tick: u32) -> Vec<Command> {
    let mut commands = vec![];
    if tick == 0 {
        let kind = |client: u32| VehicleKind::ALL[client as usize % VehicleKind::ALL.len()];
        commands.extend((0..CLIENTS).map(|client| Command::Spawn { client, kind: kind(client) }));
    }
    if tick.is_multiple_of(30) {
        let eye_m = [40.0 + 0.05 * tick as f32, 2.0, 60.0];
        commands.push(Command::Cameras(vec![Camera { client: 0, eye_m }]));
        let swing = |client: u32| ((tick / 30 * 7 + client * 3) % 11) as f32 / 5.0 - 1.0;
        commands.extend((0..CLIENTS).map(|client| {
            let drive = Drive { throttle: 1.0, steer: swing(client), lift: swing(client + 1), brake: 0.0 };
            Command::Drive { client, number: 0, drive }
        }));
    }
    if tick == 200 {
        commands.push(Command::Remove { client: 3 });
    }
    if tick == 260 {
        commands.push(Command::Spawn { client: 3, kind: VehicleKind::Helicopter });
    }
    commands
}

fn run(threads: usize) -> Vec<u64> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
    pool.install(|| {
        let mut scene = worlds::scene(7);
        (scene.objects.self_driving, scene.objects.balls) = (3, 4);
        let mut world = worlds::hills(&scene);
        let mut sums = vec![];
        for tick in 0..600 {
            world.step(&commands(tick));
            if tick % 100 == 99 {
                sums.push(world.checksum());
            }
        }
        sums
    })
}

#[test]
fn two_runs_agree_on_any_number_of_threads() {
    let once = run(1);
    assert!(once.windows(2).all(|pair| pair[0] != pair[1]), "the world moves");
    assert_eq!(once, run(1), "a second run");
    assert_eq!(once, run(2), "two threads");
}
