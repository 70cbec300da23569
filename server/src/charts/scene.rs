//! A whole scene: error of its grass after a drive against the time of the world's steps, by scheme and tick rate.

use std::rc::Rc;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result};
use prairie_charts::norms::Norms;
use prairie_charts::{Outcome, Problem, Run};
use prairie_core::bend::Scheme;
use prairie_core::grass::Camera;
use prairie_core::scene::VehicleKind;
use prairie_core::wire::Drive;

use crate::scenes::{self, LoadedScene};
use crate::world::{Command, World};

/// Duration of the drive (s).
const DRIVE_SECS: f32 = 4.0;
const METHODS: [(&str, Scheme); 2] = [("sub-stepped", Scheme::Substepped), ("implicit", Scheme::Implicit)];
const TICK_HZ: [f32; 4] = [15.0, 30.0, 60.0, 120.0];
const REFERENCE_HZ: f32 = 240.0;

/// Bends (rad) of all cells, patch by patch; those at rest are empty.
type Bends = Vec<Vec<f32>>;

/// A built-in scene with a car, for one problem.
struct Case {
    loaded: LoadedScene,
    reference: OnceLock<Bends>,
}

/// Problems of whole scenes; `quick` takes the meadow alone.
pub fn problems(quick: bool) -> Vec<Problem> {
    let cases = [("Drive in the meadow", "meadow"), ("Drive in the storm", "storm")];
    cases.into_iter().take(if quick { 1 } else { 2 }).map(|(name, scene)| problem(name, scene)).collect()
}

fn problem(name: &'static str, scene: &str) -> Problem {
    let loaded = scenes::load(scene).expect("a built-in scene");
    let cells = PatchCells::of(&loaded);
    let case = Rc::new(Case { loaded, reference: OnceLock::new() });
    let run = |(name, scheme): (&str, Scheme), tick_hz: f32| {
        let case = Rc::clone(&case);
        Run {
            method: name.into(),
            cells: [cells.0, 1, cells.1],
            dt_secs: (1.0 / tick_hz).into(),
            solve: Box::new(move || case.outcome(scheme, tick_hz)),
        }
    };
    Problem {
        name,
        error: "rms error of θ (rad) against 240 ticks a second",
        per: "simulated second",
        default_method: Some("sub-stepped"),
        cell_bytes: 0,
        runs: METHODS.into_iter().flat_map(|method| TICK_HZ.map(|tick_hz| run(method, tick_hz))).collect(),
    }
}

/// Cells of the bend field along X and Z.
struct PatchCells(usize, usize);

impl PatchCells {
    fn of(loaded: &LoadedScene) -> Self {
        let [x, z] = loaded.scene.patches.count.map(|count| (count * loaded.scene.patches.cells) as usize);
        Self(x, z)
    }
}

impl Case {
    fn outcome(&self, scheme: Scheme, tick_hz: f32) -> Result<Outcome> {
        let (bends, wall) = self.drive(scheme, tick_hz)?;
        if self.reference.get().is_none() {
            let _ = self.reference.set(self.drive(Scheme::Substepped, REFERENCE_HZ)?.0);
        }
        let reference = self.reference.get().context("just set")?;
        let pairs = bends.iter().zip(reference).flat_map(|(bends, exact)| {
            let at = |values: &[f32], n: usize| values.get(n).copied().unwrap_or(0.0).into();
            (0..bends.len().max(exact.len())).map(move |n| (at(bends, n), at(exact, n)))
        });
        Ok(Outcome { error: Norms::of(pairs), simulated_secs: DRIVE_SECS.into(), wall })
    }

    /// Drives a car round a bend; returns the grass at the end and the time of the steps.
    fn drive(&self, scheme: Scheme, tick_hz: f32) -> Result<(Bends, Duration)> {
        let mut scene = self.loaded.scene.clone();
        (scene.bend.scheme, scene.tick_hz) = (scheme, tick_hz);
        let mut world = World::new(&scene, self.loaded.maps())?;
        let [width_m, depth_m] = scene.extent_m();
        let camera = Camera { client: 1, eye_m: [0.5 * width_m, 20.0, 0.5 * depth_m] };
        let drive = Drive { throttle: 0.8, steer: 0.3, lift: 0.0, brake: 0.0 };
        let mut commands = vec![
            Command::Cameras(vec![camera]),
            Command::Spawn { client: 1, kind: VehicleKind::Car },
            Command::Drive { client: 1, number: 0, drive },
        ];
        let begun = Instant::now();
        for _ in 0..(DRIVE_SECS * tick_hz).round() as u32 {
            world.step(&std::mem::take(&mut commands));
        }
        let wall = begun.elapsed();
        let field = world.bend().field();
        let count = scene.patches.count.iter().product::<u32>();
        let bends = (0..count)
            .map(|index| field.patch(index).map_or_else(Vec::new, |patch| patch.rows().flat_map(|row| row[0].to_vec()).collect()));
        Ok((bends.collect(), wall))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shorter_steps_are_nearer_to_the_reference() {
        let problem = &problems(true)[0];
        let error = |n: usize| (problem.runs[n].solve)().unwrap().error.l2;
        let [coarse, fine] = [error(0), error(3)];
        assert!(fine > 1e-6 && fine < 0.5 * coarse, "{coarse} and {fine}");
    }
}
