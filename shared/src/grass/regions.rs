//! Active regions (Chen & Johan, §4.2): patches near objects, and those that energy reaches, are awake; all others sleep.

use super::camera::{Camera, nearest_distance2_m2};
use super::causes::Limits;
use crate::bend::{Field, Patch};
use crate::grid::{PatchIndex, PatchLayout};

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

    pub(super) fn set_limit(&mut self, limit: usize) {
        self.limit = limit;
    }

    /// Number of patches so far that were put to sleep because of the limit.
    pub(super) fn evicted(&self) -> u64 {
        self.evicted
    }

    /// Sets the number of patches so far that were put to sleep because of the limit.
    pub(super) fn set_evicted(&mut self, evicted: u64) {
        self.evicted = evicted;
    }

    /// Puts quiet patches to sleep and wakes the `touched` ones. Above the limit, patches sleep by `limits` (the farthest from the centre of the world when
    /// there is no camera). Returns them, ascending.
    pub(super) fn update(&mut self, field: &mut Field, touched: &[PatchIndex], limits: Limits) -> Vec<PatchIndex> {
        let mut touched = touched.to_vec();
        touched.sort_unstable();
        touched.dedup();
        field.sleep_quiet(|patch| touched.binary_search(&patch).is_ok());
        let evicted = match limits {
            Limits::Farthest(cameras) => self.farthest(field, &touched, cameras),
            Limits::Given { evicted, .. } => evicted.to_vec(),
        };
        for &patch in &evicted {
            self.evicted = self.evicted.wrapping_add(field.patch(patch).is_some().into());
            field.sleep(patch);
        }
        touched.retain(|patch| evicted.binary_search(patch).is_err());
        for patch in touched {
            field.wake(patch);
        }
        evicted
    }

    /// The awake and `touched` patches that exceed the limit, ascending.
    fn farthest(&self, field: &Field, touched: &[PatchIndex], cameras: &[Camera]) -> Vec<PatchIndex> {
        let mut all: Vec<PatchIndex> = field.awake().map(Patch::index).chain(touched.iter().copied()).collect();
        all.sort_unstable();
        all.dedup();
        if all.len() <= self.limit {
            return vec![];
        }
        let mut keep = all.clone();
        self.keep_nearest(&mut keep, field.layout(), cameras);
        all.retain(|patch| keep.binary_search(patch).is_err());
        all
    }

    fn keep_nearest(&self, keep: &mut Vec<PatchIndex>, layout: &PatchLayout, cameras: &[Camera]) {
        let distance2_m2 = |patch: &PatchIndex| nearest_distance2_m2(*patch, layout, cameras);
        keep.sort_by(|a, b| distance2_m2(a).total_cmp(&distance2_m2(b)).then(a.cmp(b)));
        keep.truncate(self.limit);
        keep.sort_unstable();
    }
}
