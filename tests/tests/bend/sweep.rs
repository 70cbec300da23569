//! A moving object touches exactly the cells that it passes over, at any speed, turn rate and tick rate.

use glam::Quat;
use prairie_core::body::{BodyPose, Motion, Prism};
use prairie_core::grass::footprint::Footprint;
use prairie_core::grass::swept_footprint::SweptFootprint;
use prairie_core::grid::PatchLayout;
use prairie_core::scene::{Objects, VehicleKind};
use prairie_vehicles::prisms;
use proptest::prelude::*;
use std::collections::BTreeSet;

/// Number of steps, and of positions per step that the reference samples.
const STEPS: u32 = 4;
const FINE: u32 = 100;

/// A drive along an arc.
#[derive(Clone, Copy, Debug)]
struct Drive {
    speed_m_per_s: f32,
    heading_rad: f32,
    turn_rad_per_s: f32,
    hz: f32,
}

impl Drive {
    /// Heading and position after `ticks`, from the middle of a world of 60 m.
    fn stand(&self, ticks: f32) -> (f32, [f32; 2]) {
        let (secs, turn) = (ticks / self.hz, self.turn_rad_per_s);
        let heading = self.heading_rad + turn * secs;
        // ∫ (sin, −cos) of the heading; by its mean where it hardly turns.
        let half = 0.5 * turn * secs;
        let way = self.speed_m_per_s * secs * if half.abs() < 1e-3 { 1.0 } else { half.sin() / half };
        let (sin, cos) = (self.heading_rad + half).sin_cos();
        (heading, [30.0 + sin * way, 30.0 - cos * way])
    }

    fn motion(&self, kind: VehicleKind, tick: u32) -> Motion {
        let stand = |ticks: u32| {
            let (heading, [x, z]) = self.stand(ticks as f32);
            BodyPose { position_m: [x, 1.0, z], rotation: Quat::from_rotation_y(-heading).to_array() }
        };
        Motion { kind, from: stand(tick), to: stand(tick + 1), velocity_m_per_s: [0.0; 3], part_rad: 0.0, is_at_rest: false }
    }

    /// Allowed difference between reference and swept footprint (m): an eighth of a cell, plus the sagitta of the arc in a step.
    fn margin_m(&self, cell_m: f32) -> f32 {
        cell_m / 8.0 + self.speed_m_per_s * self.turn_rad_per_s.abs() / (8.0 * self.hz * self.hz) + 1e-3
    }
}

/// All cells that the prism touches.
fn touched(prism: &Prism, kind: VehicleKind, drive: &Drive, layout: &PatchLayout) -> BTreeSet<[i64; 2]> {
    let mut cells = BTreeSet::new();
    for tick in 0..STEPS {
        for leg in SweptFootprint::new(prism, &drive.motion(kind, tick), layout.cell_m).legs() {
            for run in leg.cover().runs(layout) {
                let center = |at: i64| (at as f32 + 0.5) * layout.cell_m;
                cells.extend((run.from..run.to).map(|i| [i, run.row]).filter(|&[i, j]| leg.passage([center(i), center(j)]).is_some()));
            }
        }
    }
    cells
}

/// Largest depth of a position within the part (m) over many sampled positions; negative outside.
fn depth_m(outline: &Footprint, drive: &Drive, [x, z]: [f32; 2]) -> f32 {
    let sides = outline.sides();
    let at = |n: u32| {
        let (heading, [at_x, at_z]) = drive.stand(n as f32 / FINE as f32);
        let (sin, cos) = heading.sin_cos();
        let [x, z] = [x - at_x, z - at_z];
        let local = [cos * x + sin * z, cos * z - sin * x];
        sides.iter().map(|side| side.depth_m(local)).fold(f32::INFINITY, f32::min)
    };
    (0..=STEPS * FINE).map(at).fold(f32::NEG_INFINITY, f32::max)
}

/// Number of connected groups of cells; corners connect if `by_corners`.
fn groups(cells: &BTreeSet<[i64; 2]>, by_corners: bool) -> usize {
    let mut left = cells.clone();
    let mut count = 0;
    while let Some(first) = left.pop_first() {
        count += 1;
        let mut edge = vec![first];
        while let Some([i, j]) = edge.pop() {
            for (di, dj) in (-1..=1).flat_map(|di| (-1..=1).map(move |dj| (di, dj))).filter(|(di, dj)| by_corners || di * dj == 0) {
                let near = [i + di, j + dj];
                if left.remove(&near) {
                    edge.push(near);
                }
            }
        }
    }
    count
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(192))]
    #[test]
    fn a_swath_equals_a_finely_sampled_sweep(
        speed_m_per_s in 0.0f32..60.0,
        heading_rad in 0.0f32..std::f32::consts::TAU,
        turn_rad_per_s in -3.0f32..3.0,
        hz in 20.0f32..120.0,
        cell_m in prop::sample::select(vec![0.25f32, 0.4572, 1.0]),
        kind in prop::sample::select(VehicleKind::ALL.to_vec()),
        which in 0usize..3,
    ) {
        let layout = PatchLayout { count: [1, 1], cells: (60.0 / cell_m) as u32, cell_m };
        let drive = Drive { speed_m_per_s, heading_rad, turn_rad_per_s, hz };
        let prisms = prisms(kind, &Objects::default());
        let prism = &prisms[which % prisms.len()];
        let cells = touched(prism, kind, &drive, &layout);

        let shape = Footprint::of(prism.outline_m.clone());
        let shape = shape.widened(cell_m).unwrap_or(shape);
        let margin_m = drive.margin_m(cell_m);
        let reach = (0..=STEPS).map(|tick| drive.stand(tick as f32).1);
        let [mut low, mut high] = [[f32::INFINITY; 2], [f32::NEG_INFINITY; 2]];
        for place in reach {
            for axis in 0..2 {
                low[axis] = low[axis].min(place[axis] - 6.0);
                high[axis] = high[axis].max(place[axis] + 6.0);
            }
        }
        let range = |axis: usize| (low[axis] / cell_m) as i64..(high[axis] / cell_m) as i64;
        for j in range(1) {
            for i in range(0) {
                let depth_m = depth_m(&shape, &drive, [i, j].map(|at| (at as f32 + 0.5) * cell_m));
                let is_touched = cells.contains(&[i, j]);
                prop_assert!(depth_m <= margin_m || is_touched, "{prism:?}: cell {i}, {j} is {depth_m} m deep within and not touched");
                prop_assert!(depth_m >= -margin_m || !is_touched, "{prism:?}: cell {i}, {j} is {depth_m} m off and touched");
            }
        }

        // Between the centres of large cells there is room for a small object at rest.
        let least = usize::from(speed_m_per_s * STEPS as f32 / hz > 1.5 * cell_m);
        prop_assert!((least..=1).contains(&groups(&cells, true)), "the track is connected");
        let around: BTreeSet<_> = range(1).flat_map(|j| range(0).map(move |i| [i, j])).filter(|cell| !cells.contains(cell)).collect();
        prop_assert_eq!(groups(&around, false), 1, "the track has no hole");
    }
}
