//! The world of a run.

use crate::{DRIVE, drivers, ran, scene, text};
use prairie::journal::{WorldFolder, open, recorded};
use prairie::output::Outputs;
use prairie::runner::Simulation as _;
use prairie_core::scene::VehicleKind;

const TICKS: u64 = 150;

#[test]
fn a_run_is_that_of_a_server_with_the_same_commands() {
    let folder = tempfile::tempdir().unwrap();
    let mut served = open(Some(&WorldFolder::new(folder.path().to_owned())), &scene()).unwrap();
    let mut drivers = drivers(DRIVE);
    for _ in 0..TICKS {
        let commands = drivers.commands(served.world());
        served.step(&commands);
    }
    let sum = served.world().checksum();
    drop(served);
    let world = ran(DRIVE, TICKS, 7, Outputs::default());
    assert_eq!(world.checksum(), sum, "a server that keeps its world");
    let (_, mut player) = recorded(folder.path(), None).unwrap();
    player.advance(u64::MAX);
    assert_eq!((player.world.tick(), player.world.checksum()), (TICKS, sum), "a replay of its journal");
    let alone = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(alone.install(|| ran(DRIVE, TICKS, 1, Outputs::default()).checksum()), sum, "one thread, and another interval");
    let other = DRIVE.replace("steer = 0.4", "steer = 0.41");
    assert_ne!(ran(&other, TICKS, 7, Outputs::default()).checksum(), sum, "another drive");
}

#[test]
fn the_program_prints_the_checksum_of_its_world() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("drive.toml"), DRIVE).unwrap();
    let output = crate::prairie(&["run", "blades", "--seconds", "2.5", "--drive", "drive.toml"], folder.path());
    let sum = ran(DRIVE, TICKS, 1, Outputs::default()).checksum();
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success() && stdout.contains(&format!("steps 0 to {TICKS}, checksum {sum:016x}")), "{stdout}{stderr}");
    assert!(stdout.starts_with("blades: 2.500 s in ") && stdout.contains(" times real time\n"), "{stdout}");
}

#[test]
fn vehicles_appear_at_their_place_and_time_and_follow_their_inputs() {
    let (mut world, mut drivers) = (crate::world(), drivers(&DRIVE.replace("inputs = [", "from_secs = 0.1\ninputs = [")));
    let car = |world: &prairie::world::World| {
        let object = world.object_of(1)?;
        world.poses().into_iter().find(|pose| pose.id == object)
    };
    let mut step = |world: &mut prairie::world::World| {
        let commands = drivers.commands(world);
        world.step(&commands);
        drivers.check_arrivals(world).unwrap();
    };
    for _ in 0..6 {
        step(&mut world);
        assert!(car(&world).is_none(), "at step {}", world.tick());
    }
    step(&mut world);
    let pose = car(&world).unwrap();
    assert!(pose.kind == VehicleKind::Car && (pose.position_m[0] - 20.0).hypot(pose.position_m[2] - 32.0) < 0.1, "{pose:?}");
    (0..60).for_each(|_| step(&mut world));
    let fast = car(&world).unwrap();
    assert!(fast.velocity_m_per_s[0] > 2.0 && fast.velocity_m_per_s[2].abs() < 0.5, "it drives east: {fast:?}");
    (0..180).for_each(|_| step(&mut world));
    let end = car(&world).unwrap();
    assert!(
        end.position_m[2] > 32.5 && end.velocity_m_per_s[0].hypot(end.velocity_m_per_s[2]) < 0.5,
        "it has turned right and stopped: {end:?}"
    );
}
