//! List of broken plants, which only grows and is cheap to copy.

use prairie_core::wire::{BROKEN_LIMIT, BrokenPlant};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Broken plants, oldest first, in chunks of the size of a message. A copy shares all chunks. While a copy exists, the next `push` clones the newest chunk,
/// at most 32 KiB.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "Vec<BrokenPlant>", into = "Vec<BrokenPlant>")]
pub struct BrokenPlants {
    chunks: Vec<Arc<Vec<BrokenPlant>>>,
}

impl BrokenPlants {
    /// Adds the newest broken plant.
    pub fn push(&mut self, plant: BrokenPlant) {
        match self.chunks.last_mut() {
            Some(newest) if newest.len() < BROKEN_LIMIT => Arc::make_mut(newest).push(plant),
            _ => self.chunks.push(Arc::new(vec![plant])),
        }
    }

    /// Number of broken plants.
    pub fn len(&self) -> usize {
        self.chunks.last().map_or(0, |newest| (self.chunks.len() - 1) * BROKEN_LIMIT + newest.len())
    }

    /// Whether the list is empty.
    pub fn is_empty(&self) -> bool {
        self.chunks.is_empty()
    }

    /// All broken plants, oldest first.
    pub fn iter(&self) -> impl Iterator<Item = &BrokenPlant> {
        self.chunks.iter().flat_map(|chunk| chunk.iter())
    }

    /// Broken plants after the first `known`: at most [`BROKEN_LIMIT`], fewer at the end of a chunk, empty when all are known.
    pub fn after(&self, known: usize) -> &[BrokenPlant] {
        self.chunks.get(known / BROKEN_LIMIT).and_then(|chunk| chunk.get(known % BROKEN_LIMIT..)).unwrap_or_default()
    }
}

impl From<Vec<BrokenPlant>> for BrokenPlants {
    fn from(plants: Vec<BrokenPlant>) -> Self {
        plants.into_iter().collect()
    }
}

impl From<BrokenPlants> for Vec<BrokenPlant> {
    fn from(plants: BrokenPlants) -> Self {
        plants.iter().copied().collect()
    }
}

impl FromIterator<BrokenPlant> for BrokenPlants {
    fn from_iter<I: IntoIterator<Item = BrokenPlant>>(plants: I) -> Self {
        let mut all = Self::default();
        plants.into_iter().for_each(|plant| all.push(plant));
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::num::NonZeroU8;

    fn plant(site: u32) -> BrokenPlant {
        BrokenPlant { site, fall: NonZeroU8::MAX }
    }

    #[test]
    fn plants_after_the_known_ones_come_in_order() {
        let all: BrokenPlants = (0..10_000).map(plant).collect();
        assert_eq!((all.len(), all.is_empty()), (10_000, false));
        for start in [0, 1, 4095, 4096, 9_999, 10_000] {
            let (mut known, mut found) = (start, Vec::new());
            while let news = all.after(known)
                && !news.is_empty()
            {
                assert!(news.len() <= BROKEN_LIMIT);
                known += news.len();
                found.extend_from_slice(news);
            }
            assert!(found.into_iter().eq((start as u32..10_000).map(plant)), "after {start}");
        }
        assert!(all.after(10_001).is_empty() && all.after(usize::MAX).is_empty());
        assert_eq!((BrokenPlants::default().len(), BrokenPlants::default().is_empty()), (0, true));
    }

    #[test]
    fn a_copy_is_unchanged_by_later_plants_and_shares_all_but_the_newest_chunk() {
        let mut all: BrokenPlants = (0..9000).map(plant).collect();
        let held = all.clone();
        all.push(plant(9000));
        assert_eq!((held.len(), all.len()), (9000, 9001));
        assert!(held.iter().eq(all.iter().take(9000)));
        let shared = held.chunks.iter().zip(&all.chunks).filter(|(one, other)| Arc::ptr_eq(one, other));
        assert_eq!((shared.count(), all.chunks.len()), (2, 3));
    }
}
