//! Which patches are awake (001 §4.2): near objects, and where energy arrives; the rest sleep.

use super::View;
use shared::bend::{Field, Patch};
use shared::grid::{PatchIndex, PatchLayout};

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

    /// Lets quiet patches sleep and wakes the `touched`. Where that makes more than the limit, those farthest from any camera go (from the
    /// world's middle where there is none).
    pub fn update(&mut self, field: &mut Field, touched: &[PatchIndex], views: &[View]) {
        let mut touched = touched.to_vec();
        touched.sort_unstable();
        touched.dedup();
        field.sleep_quiet(|patch| touched.binary_search(&patch).is_ok());
        let asleep = touched.iter().filter(|patch| field.patch(**patch).is_none()).count();
        if field.awake_count() + asleep > self.limit {
            self.evict(field, &mut touched, views);
        }
        for patch in touched {
            field.wake(patch);
        }
    }

    fn evict(&mut self, field: &mut Field, touched: &mut Vec<PatchIndex>, views: &[View]) {
        let layout = *field.layout();
        let awake: Vec<PatchIndex> = field.awake().map(Patch::index).collect();
        let mut keep = [awake.as_slice(), touched].concat();
        keep.sort_unstable();
        keep.dedup();
        self.keep_nearest(&mut keep, &layout, views);
        for patch in awake {
            if keep.binary_search(&patch).is_err() {
                field.sleep(patch);
                self.evicted += 1;
            }
        }
        touched.retain(|patch| keep.binary_search(patch).is_ok());
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
