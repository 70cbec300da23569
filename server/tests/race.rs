//! A race in a whole world: times follow from the poses, and replays and restored worlds have the same.

use prairie::journal::{Player, WorldFolder, find, open};
use prairie::runner::Simulation as _;
use prairie::scenes::{self, LoadedScene};
use prairie::world::{Camera, Command, RestoreError, World, WorldState};
use prairie_core::scene::{Race, RaceGate, VehicleKind};
use prairie_core::wire::{self, Standing};
use std::f64::consts::TAU;

const TICKS: u64 = 1300;

/// Speed at which the car drives its circles (m/s).
const SPEED_M_PER_S: f64 = 4.0;

/// A drive: the scene with its race, the commands before each step, and the places (m) of the car of client 1 after each.
struct Drive {
    scene: LoadedScene,
    commands: Vec<Vec<Command>>,
    places: Vec<[f64; 2]>,
}

impl Drive {
    /// A small scene in which client 1 drives a car in circles through three gates. The car of client 2 stands.
    fn in_circles() -> Self {
        let scene = scenes::load("blades").unwrap();
        let mut world = World::new(&scene.scene, scene.maps()).unwrap();
        let (mut commands, mut places): (Vec<Vec<Command>>, Vec<[f64; 2]>) = (vec![], vec![]);
        for tick in 0..TICKS {
            let speed_m_per_s = places.last_chunk().map_or(0.0, |[[x0, z0], [x1, z1]]| (x1 - x0).hypot(z1 - z0) * 60.0);
            let throttle = if speed_m_per_s < SPEED_M_PER_S { 0.4 } else { 0.0 };
            let drive = wire::Drive { throttle, steer: 1.0, ..wire::Drive::default() };
            commands.push(match tick {
                0 => (1..=2).flat_map(|client| [Command::Join { client }, Command::Spawn { client, kind: VehicleKind::Car }]).collect(),
                _ => vec![Command::Drive { client: 1, number: 0, drive }],
            });
            world.step(commands.last().unwrap());
            let own = world.object_of(1);
            let [x, _, z] = world.poses().into_iter().find(|pose| Some(pose.id) == own).unwrap().position_m;
            places.push([x, z].map(f64::from));
        }
        Self { scene, commands, places }.with_gates()
    }

    /// Lays gates across the circle.
    fn with_gates(mut self) -> Self {
        let heading_rad = |tick: usize| {
            let [x, z] = [0, 1].map(|axis| self.places[tick + 1][axis] - self.places[tick - 1][axis]);
            x.atan2(-z)
        };
        let first = 200;
        let turned_rad = |tick: usize| (heading_rad(tick) - heading_rad(first)).rem_euclid(TAU);
        let gate = |tick: usize| RaceGate { width_m: 6.0, ..RaceGate::new(self.places[tick].map(|m| m as f32), heading_rad(tick) as f32) };
        let after = |least_rad: f64| (first + 1..).find(|tick| (least_rad..least_rad + 1.0).contains(&turned_rad(*tick))).unwrap();
        self.scene.scene.race = Race { laps: 2, light_period_secs: 0.0, gates: vec![gate(first), gate(after(2.0)), gate(after(4.0))] };
        self
    }
}

/// Durations of the laps (s) that follow from the places after each step.
fn lap_secs(Drive { scene, places, .. }: &Drive) -> Vec<f64> {
    let (gates, dt_secs) = (&scene.scene.race.gates, f64::from(scene.scene.dt_secs()));
    let (mut next, mut starts_secs) = (0, vec![]);
    for (tick, way) in (2..).zip(places.windows(2)) {
        let gate = gates[next];
        let (sin, cos) = f64::from(gate.heading_rad).sin_cos();
        let [[before_m, _], [after_m, _]] = [way[0], way[1]].map(|[x, z]| {
            let [x, z] = [x - f64::from(gate.at_m[0]), z - f64::from(gate.at_m[1])];
            [x * sin - z * cos, x * cos + z * sin]
        });
        let is_near = (way[1][0] - f64::from(gate.at_m[0])).hypot(way[1][1] - f64::from(gate.at_m[1])) < 2.0;
        if before_m < 0.0 && after_m >= 0.0 && is_near {
            if next == 0 {
                starts_secs.push((f64::from(tick - 1) - after_m / (after_m - before_m) + 1.0) * dt_secs);
            }
            next = (next + 1) % gates.len();
        }
    }
    starts_secs.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

fn own(standings: &[Standing]) -> Standing {
    *standings.iter().find(|standing| standing.client == 1).expect("client 1 has begun")
}

#[test]
fn times_follow_from_the_poses_and_replays_have_the_same() {
    let drive = Drive::in_circles();
    let (scene, laps_secs) = (&drive.scene, lap_secs(&drive));
    assert!(laps_secs.len() >= 2, "the car drives {laps_secs:?}");
    let folder = tempfile::tempdir().unwrap();
    let mut world = open(Some(&WorldFolder::new(folder.path().to_owned())), scene).unwrap();
    let mut middle = WorldState::default();
    for (tick, commands) in (0..).zip(&drive.commands) {
        world.step(commands);
        if tick == TICKS / 2 {
            middle = world.world().save();
        }
    }
    let standings = world.world().snapshot().standings;
    let Standing { last_secs, best_secs, race_secs, .. } = own(&standings);
    let near = |found: Option<f32>, wanted: f64| (f64::from(found.unwrap()) - wanted).abs() < 1e-4;
    assert!(near(last_secs, *laps_secs.last().unwrap()), "{last_secs:?}: {laps_secs:?}");
    assert!(near(best_secs, laps_secs.iter().copied().fold(f64::INFINITY, f64::min)), "{best_secs:?}: {laps_secs:?}");
    let races = laps_secs.chunks_exact(2).map(|laps| laps[0] + laps[1]);
    assert!(near(race_secs, races.fold(f64::INFINITY, f64::min)), "{race_secs:?}: {laps_secs:?}");

    let sum = world.world().checksum();
    drop(world);
    let mut player = Player::open_oldest(&find(folder.path()).unwrap(), scene).unwrap().unwrap();
    player.advance(u64::MAX);
    assert_eq!((player.world.tick(), player.world.snapshot().standings), (TICKS, standings.clone()), "replayed");
    assert_eq!(player.world.checksum(), sum);
    let mut copy = World::restore(&scene.scene, scene.maps(), WorldState::decode(&middle.encode()).unwrap()).unwrap();
    drive.commands[TICKS as usize / 2 + 1..].iter().for_each(|commands| copy.step(commands));
    assert_eq!(copy.snapshot().standings, standings, "restored in the middle");
    leave(copy);
}

/// A client keeps its times on foot until its number is gone.
fn leave(mut world: World) {
    let driving = own(&world.snapshot().standings);
    world.step(&[Command::Remove { client: 1 }]);
    let on_foot = own(&world.snapshot().standings);
    assert_eq!((on_foot.best_secs, on_foot.began_secs), (driving.best_secs, None));
    assert!(world.racers_on_foot().eq([1]));
    let without_gates = scenes::load("blades").unwrap();
    let restored = World::restore(&without_gates.scene, without_gates.maps(), world.save());
    assert!(matches!(restored, Err(RestoreError::Race)), "its lap has gates");
    world.step(&[Command::Leave { client: 1 }]);
    assert!(world.snapshot().standings.iter().all(|standing| standing.client != 1));
}

/// A driver who steers for the middle of the next gate of the built-in scene completes a lap, and passes each gate in turn.
#[test]
fn the_built_in_circuit_can_be_driven() {
    let scene = scenes::load("race").unwrap();
    let (gates, extent_m) = (&scene.scene.race.gates, scene.scene.extent_m());
    let mut world = World::new(&scene.scene, scene.maps()).unwrap();
    let start = [scene.scene.camera.at[0] * extent_m[0], scene.scene.camera.at[1] * extent_m[1]];
    let camera = Camera { client: 1, eye_m: [start[0], 2.0, start[1]] };
    world.step(&[Command::Cameras(vec![camera]), Command::Join { client: 1 }, Command::Spawn { client: 1, kind: VehicleKind::Car }]);
    world.step(&[Command::Cameras(vec![])]);
    let mut best_secs = None;
    for _ in 0..6000 {
        let standing = world.snapshot().standings.first().copied().unwrap_or_default();
        best_secs = standing.best_secs;
        if best_secs.is_some() {
            break;
        }
        let gate = gates[usize::from(standing.next_gate)];
        let pose = world.poses()[0];
        let [_, qy, _, qw] = pose.rotation;
        let (x, z) = (gate.at_m[0] - pose.position_m[0], gate.at_m[1] - pose.position_m[2]);
        // A heading is a rotation by its opposite about the upward axis.
        let (sin, cos) = (x.atan2(-z) + 2.0 * qy.atan2(qw)).sin_cos();
        let turn_rad = sin.atan2(cos);
        let speed_m_per_s = pose.velocity_m_per_s[0].hypot(pose.velocity_m_per_s[2]);
        let wanted_m_per_s = if turn_rad.abs() > 0.4 { 5.0 } else { 12.0 };
        let throttle = ((wanted_m_per_s - speed_m_per_s) * 0.5).clamp(-1.0, 1.0);
        let drive = wire::Drive { throttle, steer: (2.0 * turn_rad).clamp(-1.0, 1.0), ..wire::Drive::default() };
        world.step(&[Command::Drive { client: 1, number: 0, drive }]);
    }
    assert!(best_secs.is_some(), "at {:?} on the way to {:?}", world.poses()[0].position_m, world.snapshot().standings);
}
