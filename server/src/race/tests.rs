//! Times of vehicles that drive along known ways.

use super::*;
use prairie_core::body::{BodyPose, POSITION_QUANTUM_M};
use prairie_core::scene::{RaceGate, TerrainMaps, VehicleKind};
use prairie_core::wire::ObjectId;
use std::f32::consts::{FRAC_PI_2, PI};

/// Speed of the test's drivers (m/s), which passes no gate at the end of a step.
const SPEED_M_PER_S: f64 = 12.3;
/// Length of a lap, and way from the start of the drive to the first gate (m).
const LAP_M: f64 = 240.0;
const START_M: f64 = 20.0;

/// A square of 60 m with a gate in each side; `light_period_secs` as in scene files.
fn scene(light_period_secs: f32) -> Scene {
    let terrain = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [1.0; 2], level_m: 0.0, base_m: 0.0 };
    let mut scene = Scene::new(terrain);
    scene.race.light_period_secs = light_period_secs;
    scene.race.laps = 2;
    let gates = [([20.0, 60.0], 0.0), ([50.0, 20.0], FRAC_PI_2), ([80.0, 50.0], PI), ([50.0, 80.0], -FRAC_PI_2)];
    scene.race.gates = gates.map(|(at_m, heading_rad)| RaceGate::new(at_m, heading_rad)).to_vec();
    scene
}

/// The place (m) on the square after a way (m) from its south-western corner, clockwise.
fn on_square(way_m: f64) -> [f32; 2] {
    let way_m = way_m.rem_euclid(LAP_M);
    let along_m = way_m % 60.0;
    let place = [[20.0, 80.0 - along_m], [20.0 + along_m, 20.0], [80.0, 20.0 + along_m], [80.0 - along_m, 80.0]];
    place[(way_m / 60.0) as usize].map(|m| m as f32)
}

/// A car that moves on level ground.
fn motion(client: u32, object: ObjectId, way_m: [[f32; 2]; 2]) -> DrivenMotion {
    let [from, to] = way_m.map(|[x, z]| BodyPose { position_m: [x, 0.0, z], ..BodyPose::IDENTITY });
    DrivenMotion { client, object, kind: VehicleKind::Car, from, to }
}

/// A race with one driver of `object` whose place follows from the simulated time (s).
struct Drive {
    race: Race,
    dt_secs: f64,
    tick: u64,
    object: ObjectId,
}

impl Drive {
    fn new(scene: &Scene) -> Self {
        Self { race: Race::new(scene), dt_secs: f64::from(scene.dt_secs()), tick: 0, object: 7 }
    }

    /// Drives until `secs`; returns the standing then.
    fn until(&mut self, secs: f64, place_m: impl Fn(f64) -> [f32; 2]) -> Option<Standing> {
        while (self.tick + 1) as f64 * self.dt_secs <= secs {
            let [from_m, to_m] = [self.tick, self.tick + 1].map(|tick| place_m(tick as f64 * self.dt_secs));
            self.tick += 1;
            self.race.step(self.tick, [motion(3, self.object, [from_m, to_m])].into_iter());
        }
        self.standing()
    }

    /// The driver gets out.
    fn rest(&mut self) -> Option<Standing> {
        self.tick += 1;
        self.race.step(self.tick, std::iter::empty());
        self.standing()
    }

    fn standing(&self) -> Option<Standing> {
        self.race.standings().first().copied()
    }
}

fn at_speed(secs: f64) -> [f32; 2] {
    on_square(SPEED_M_PER_S * secs)
}

#[test]
fn times_at_constant_speed_are_exact_between_the_steps() {
    const BOUND_SECS: f64 = 1e-4;
    let (scene, secs_of) = (scene(0.0), |way_m: f64| way_m / SPEED_M_PER_S);
    let mut drive = Drive::new(&scene);
    assert_eq!(drive.until(secs_of(START_M) - 0.1, at_speed), None, "nobody has begun");
    let begun = drive.until(secs_of(START_M + 60.0), at_speed).unwrap();
    assert!((begun.began_secs.unwrap() - secs_of(START_M)).abs() < BOUND_SECS);
    assert_eq!((begun.next_gate, begun.laps, begun.best_secs), (1, 0, None));
    assert_eq!(drive.until(secs_of(START_M + 200.0), at_speed).unwrap().next_gate, 0);
    let lap = drive.until(secs_of(START_M + LAP_M + 5.0), at_speed).unwrap();
    assert_eq!((lap.next_gate, lap.laps, lap.race_secs, lap.best_secs), (1, 1, None, lap.last_secs));
    let exact_secs = secs_of(LAP_M);
    assert!((f64::from(lap.best_secs.unwrap()) - exact_secs).abs() < BOUND_SECS, "{lap:?}, exactly {exact_secs}");
    // Times of whole steps would miss the bound.
    let step = |way_m: f64| (secs_of(way_m) / drive.dt_secs).ceil() * drive.dt_secs;
    assert!((step(START_M + LAP_M) - step(START_M) - exact_secs).abs() > 10.0 * BOUND_SECS);
    // The second lap is as long, also at each gate, and completes the race.
    let second = drive.until(secs_of(START_M + LAP_M + 150.0), at_speed).unwrap();
    assert!(f64::from(second.gap_secs.unwrap()).abs() < BOUND_SECS, "{second:?}");
    let race = drive.until(secs_of(START_M + 2.0 * LAP_M + 5.0), at_speed).unwrap();
    assert!((f64::from(race.race_secs.unwrap()) - 2.0 * exact_secs).abs() < BOUND_SECS, "{race:?}");
    assert_eq!(race.laps, 0, "the next race has begun");
}

#[test]
fn only_gates_in_order_forwards_and_between_their_posts_count() {
    let lap_secs = LAP_M / SPEED_M_PER_S;
    let mut backwards = Drive::new(&scene(0.0));
    assert_eq!(backwards.until(2.0 * lap_secs, |secs| on_square(-SPEED_M_PER_S * secs)), None);
    let mut outside = Drive::new(&scene(0.0));
    let beside = |secs: f64| at_speed(secs).map(|m| 50.0 + 1.2 * (m - 50.0));
    assert_eq!(outside.until(2.0 * lap_secs, beside), None, "6 m from the middle of gates of 10 m");
    // Without the third gate, the lap goes on until it is passed.
    let mut short_cut = Drive::new(&scene(0.0));
    let inside = |secs: f64| {
        let [x, z] = at_speed(secs);
        [if x > 60.0 { 60.0 } else { x }, z]
    };
    let missed = short_cut.until(2.5 * lap_secs, inside).unwrap();
    assert_eq!((missed.next_gate, missed.laps, missed.best_secs), (2, 0, None));
    let began_secs = missed.began_secs;
    let late = short_cut.until(3.0 * lap_secs, at_speed).unwrap();
    assert_eq!((late.next_gate, late.began_secs), (0, began_secs));
}

#[test]
fn leaving_the_vehicle_loses_the_running_lap_but_not_the_best() {
    let lap_secs = LAP_M / SPEED_M_PER_S;
    let mut drive = Drive::new(&scene(0.0));
    let driving = drive.until(1.5 * lap_secs, at_speed).unwrap();
    assert!(driving.began_secs.is_some() && driving.best_secs.is_some());
    let on_foot = drive.rest().unwrap();
    assert_eq!((on_foot.began_secs, on_foot.best_secs, on_foot.next_gate), (None, driving.best_secs, 0));
    // Another vehicle in place of the first begins anew, too.
    let mut changed = Drive::new(&scene(0.0));
    changed.until(0.5 * lap_secs, at_speed);
    changed.object = 8;
    assert_eq!(changed.until(0.6 * lap_secs, at_speed), None);
    drive.race.forget(3);
    assert_eq!(drive.standing(), None);
}

/// A driver waits 5 m behind the first gate until `start_secs`, and drives on from there.
fn from_grid(secs: f64, start_secs: f64) -> [f32; 2] {
    on_square(START_M - 5.0 + SPEED_M_PER_S * (secs - start_secs).max(0.0))
}

#[test]
fn a_start_by_the_light_is_timed_from_green() {
    let green_secs = 20.0;
    let exact_secs = |start_secs: f64| start_secs - green_secs + (5.0 + LAP_M) / SPEED_M_PER_S;
    for start_secs in [20.0, 21.3] {
        let mut drive = Drive::new(&scene(20.0));
        let begun = drive.until(start_secs + 2.0, |secs| from_grid(secs, start_secs)).unwrap();
        assert!(!begun.is_false_start && (begun.began_secs.unwrap() - green_secs).abs() < 1e-4, "{begun:?}");
        let lap = drive.until(start_secs + 22.0, |secs| from_grid(secs, start_secs)).unwrap();
        assert!((f64::from(lap.best_secs.unwrap()) - exact_secs(start_secs)).abs() < 1e-4, "{lap:?}");
    }
    // While the light is red nobody waits for it: the lap begins at the gate.
    let mut flying = Drive::new(&scene(20.0));
    let begun = flying.until(32.0, |secs| from_grid(secs, 31.0)).unwrap();
    assert!(!begun.is_false_start && (begun.began_secs.unwrap() - 31.0 - 5.0 / SPEED_M_PER_S).abs() < 1e-4, "{begun:?}");
}

#[test]
fn a_false_start_does_not_count() {
    let mut drive = Drive::new(&scene(20.0));
    let start_secs = 19.4;
    let begun = drive.until(20.0, |secs| from_grid(secs, start_secs)).unwrap();
    assert!(begun.is_false_start, "{begun:?}");
    let lap_secs = LAP_M / SPEED_M_PER_S;
    let next = drive.until(21.0 + lap_secs, |secs| from_grid(secs, start_secs)).unwrap();
    assert!(
        !next.is_false_start && next.laps == 0 && next.best_secs.is_none() && next.gap_secs.is_none(),
        "the next lap counts again: {next:?}"
    );
    let lap = drive.until(21.0 + 2.0 * lap_secs, |secs| from_grid(secs, start_secs)).unwrap();
    assert!((f64::from(lap.best_secs.unwrap()) - lap_secs).abs() < 1e-4, "{lap:?}");
}

#[test]
fn standings_are_ordered_by_race_then_by_lap_and_bounded() {
    let scene = scene(0.0);
    let mut race = Race::new(&scene);
    let dt_secs = f64::from(scene.dt_secs());
    // The higher the number of a client, the faster; only the fastest complete a race in this time.
    let way_m = |client: u32, tick: u64| (8.0 + 0.1 * f64::from(client)) * tick as f64 * dt_secs;
    for tick in 1..=(36.0 / dt_secs) as u64 {
        let drive = |client| {
            let [from_m, to_m] = [tick - 1, tick].map(|tick| on_square(way_m(client, tick)));
            motion(client, client, [from_m, to_m])
        };
        race.step(tick, (1..=80).map(drive));
    }
    let standings = race.standings();
    assert_eq!(standings.len(), STANDINGS_LIMIT);
    assert_eq!(race.clients().count(), 80);
    assert!(standings.iter().map(|standing| standing.client).eq((17..=80).rev()));
    assert!(standings[0].race_secs.is_some() && standings[63].race_secs.is_none());
    assert!(standings.iter().all(|standing| standing.best_secs.is_some()));
}

#[test]
fn the_fastest_lap_becomes_the_ghost() {
    let lap_secs = LAP_M / SPEED_M_PER_S;
    let mut drive = Drive::new(&scene(0.0));
    drive.until(lap_secs, at_speed);
    assert_eq!(drive.race.ghost(), None);
    drive.until(1.5 * lap_secs, at_speed);
    let ghost = drive.race.ghost().unwrap();
    assert!((f64::from(ghost.lap_secs) - lap_secs).abs() < 1e-4 && (0.0..=0.1).contains(&ghost.first_secs), "{ghost:?}");
    assert_eq!(ghost.poses.len(), ((lap_secs - f64::from(ghost.first_secs)) / 0.1) as usize + 1);
    for (n, code) in ghost.poses.iter().enumerate() {
        let way_m = START_M + SPEED_M_PER_S * (f64::from(ghost.first_secs) + n as f64 * f64::from(ghost.period_secs));
        let (found, wanted) = (code.pose().xz(), on_square(way_m));
        assert!((0..2).all(|axis| (found[axis] - wanted[axis]).abs() < POSITION_QUANTUM_M + 1e-3), "{found:?}, exactly {wanted:?}");
    }
    // Neither a slower lap nor the driver's leave replaces it; a faster one does.
    drive.rest();
    drive.race.forget(3);
    let at = |m_per_s: f64, since_secs: f64| move |secs: f64| on_square(m_per_s * (secs - since_secs));
    let now_secs = drive.tick as f64 * drive.dt_secs;
    drive.until(now_secs + 35.0, at(10.0, now_secs));
    assert_eq!(drive.race.ghost(), Some(ghost.clone()));
    drive.rest();
    let now_secs = drive.tick as f64 * drive.dt_secs;
    drive.until(now_secs + 25.0, at(15.0, now_secs));
    assert!(drive.race.ghost().unwrap().lap_secs < ghost.lap_secs);
}

#[test]
fn a_state_of_another_race_is_refused() {
    let mut drive = Drive::new(&scene(0.0));
    drive.until(1.4 * LAP_M / SPEED_M_PER_S, at_speed);
    let state = drive.race.state().clone();
    let mut shorter = scene(0.0);
    shorter.race.gates.truncate(3);
    assert!(!Race::new(&shorter).restore(state.clone()));
    let mut copy = Race::new(&scene(0.0));
    assert!(copy.restore(state.clone()) && copy.state() == &state);
}
