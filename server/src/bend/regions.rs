//! Which patches are awake (001 §4.2): near objects, and where energy arrives; the rest sleep.

use super::View;
use shared::bend::{Extremes, Field, Rim};
use shared::grid::{PatchIndex, PatchLayout};

/// A patch whose bends (rad) and bending speeds (rad/s) are all below these sleeps. The bends are then none on the wire, where half a
/// code is 0.012 rad; the speeds, which tell but the direction of a bend, add at most a hundredth to the wave speed by 001 Eq. (4).
const QUIET_THETA_RAD: f32 = 0.01;
const QUIET_OMEGA_RAD_PER_S: f32 = 0.2;

/// What a step left behind in a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trace {
    /// Which patch.
    pub patch: PatchIndex,
    /// Its extremes.
    pub extremes: Extremes,
    /// Extremes of the outermost cells in the west, east, north and south.
    pub rims: [Rim; 4],
}

impl Trace {
    fn is_quiet(&self) -> bool {
        self.extremes.theta_rad < QUIET_THETA_RAD && self.extremes.omega_rad_per_s < QUIET_OMEGA_RAD_PER_S
    }

    /// Neighbours that energy flows into.
    fn spills(&self, layout: PatchLayout) -> impl Iterator<Item = PatchIndex> + use<> {
        let [x, z] = layout.place(self.patch).map(i64::from);
        let around = [[x - 1, z], [x + 1, z], [x, z - 1], [x, z + 1]];
        let rims = self.rims;
        let loud = |rim: &Rim| rim.theta_rad >= QUIET_THETA_RAD || rim.omega_rad_per_s >= QUIET_OMEGA_RAD_PER_S;
        around.into_iter().zip(rims).filter(move |(_, rim)| loud(rim)).filter_map(move |([x, z], _)| layout.index(x, z))
    }
}

/// Decides who is awake.
#[derive(Clone, Debug)]
pub struct Regions {
    limit: usize,
    evicted: u64,
}

impl Regions {
    /// At most `limit` patches are awake.
    pub fn new(limit: usize) -> Self {
        Self { limit, evicted: 0 }
    }

    /// Patches let go so far because the limit was reached.
    pub fn evicted(&self) -> u64 {
        self.evicted
    }

    /// Wakes the `touched` and those that energy flows into; lets quiet ones sleep; lets those farthest
    /// from any camera go (from the world's middle where there is none) that exceed the limit.
    pub fn update(&mut self, field: &mut Field, touched: &[PatchIndex], traces: &[Trace], views: &[View]) {
        let layout = *field.layout();
        let mut keep: Vec<PatchIndex> = touched.to_vec();
        keep.extend(traces.iter().flat_map(|trace| trace.spills(layout)));
        keep.extend(traces.iter().filter(|trace| !trace.is_quiet()).map(|trace| trace.patch));
        keep.sort_unstable();
        keep.dedup();
        // What is no longer a number cannot be mended.
        let broken = |patch: &PatchIndex| {
            let at = traces.binary_search_by_key(patch, |trace| trace.patch);
            at.is_ok_and(|at| !traces[at].extremes.activity.is_finite())
        };
        keep.retain(|patch| !broken(patch));
        if keep.len() > self.limit {
            let before = keep.clone();
            self.keep_nearest(&mut keep, &layout, views);
            self.evicted +=
                before.iter().filter(|patch| field.patch(**patch).is_some() && keep.binary_search(patch).is_err()).count() as u64;
        }
        for patch in field.awake_indices().to_vec() {
            if keep.binary_search(&patch).is_err() {
                field.sleep(patch);
            }
        }
        for patch in keep {
            if field.patch(patch).is_none() {
                field.wake(patch);
            }
        }
    }

    fn keep_nearest(&self, keep: &mut Vec<PatchIndex>, layout: &PatchLayout, views: &[View]) {
        let middle = layout.extent_m().map(|extent| 0.5 * extent);
        let distance = |patch: &PatchIndex| {
            let center = layout.center_m(*patch);
            let eyes = views.iter().map(|view| [view.eye_m[0], view.eye_m[2]]);
            let nearest = eyes.map(|eye| squared_distance(center, eye)).reduce(f32::min);
            nearest.unwrap_or_else(|| squared_distance(center, middle))
        };
        keep.sort_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b)));
        keep.truncate(self.limit);
        keep.sort_unstable();
    }
}

fn squared_distance(a: [f32; 2], b: [f32; 2]) -> f32 {
    let [x, z] = [a[0] - b[0], a[1] - b[1]];
    x * x + z * z
}
