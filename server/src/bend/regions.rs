//! Active regions (Chen & Johan, §4.2): patches near objects, and those that energy reaches, are awake; all others sleep.

use super::camera::{Camera, nearest_distance2_m2};
use prairie_core::bend::{Field, Patch};
use prairie_core::grid::{PatchIndex, PatchLayout};

/// Chooses the awake patches.
#[derive(Clone, Debug)]
pub(super) struct Regions {
    limit: usize,
    evicted: u64,
}

impl Regions {
    /// Regions with at most `limit` awake patches.
    pub(super) fn new(limit: usize) -> Self {
        Self { limit, evicted: 0 }
    }

    /// Number of patches so far that were put to sleep because of the limit.
    pub(super) fn evicted(&self) -> u64 {
        self.evicted
    }

    /// Sets the number of patches so far that were put to sleep because of the limit.
    pub(super) fn set_evicted(&mut self, evicted: u64) {
        self.evicted = evicted;
    }

    /// Puts quiet patches to sleep and wakes the `touched` ones. Above the limit, the patches farthest from any camera sleep (farthest from the centre
    /// of the world when there is no camera).
    pub(super) fn update(&mut self, field: &mut Field, touched: &[PatchIndex], cameras: &[Camera]) {
        let mut touched = touched.to_vec();
        touched.sort_unstable();
        touched.dedup();
        field.sleep_quiet(|patch| touched.binary_search(&patch).is_ok());
        let asleep = touched.iter().filter(|patch| field.patch(**patch).is_none()).count();
        if field.awake_count() + asleep > self.limit {
            self.evict(field, &mut touched, cameras);
        }
        for patch in touched {
            field.wake(patch);
        }
    }

    fn evict(&mut self, field: &mut Field, touched: &mut Vec<PatchIndex>, cameras: &[Camera]) {
        let layout = *field.layout();
        let awake: Vec<PatchIndex> = field.awake().map(Patch::index).collect();
        let mut keep = [awake.as_slice(), touched].concat();
        keep.sort_unstable();
        keep.dedup();
        self.keep_nearest(&mut keep, &layout, cameras);
        for patch in awake {
            if keep.binary_search(&patch).is_err() {
                field.sleep(patch);
                self.evicted += 1;
            }
        }
        touched.retain(|patch| keep.binary_search(patch).is_ok());
    }

    fn keep_nearest(&self, keep: &mut Vec<PatchIndex>, layout: &PatchLayout, cameras: &[Camera]) {
        let distance2_m2 = |patch: &PatchIndex| nearest_distance2_m2(*patch, layout, cameras);
        keep.sort_by(|a, b| distance2_m2(a).total_cmp(&distance2_m2(b)).then(a.cmp(b)));
        keep.truncate(self.limit);
        keep.sort_unstable();
    }
}
