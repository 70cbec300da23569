//! Broken underbrush plants and the directions in which they fell.

use super::error::{MirrorError, range};
use prairie_core::wire::{BROKEN_LIMIT, BrokenPlant};
use std::sync::Arc;

/// One heading code per site, padded to a multiple of four bytes. Empty before a scene with underbrush.
#[derive(Clone, Debug, Default)]
pub(super) struct BrokenPlants {
    sites: usize,
    /// Shared with copies until another plant breaks.
    falls: Arc<Vec<u8>>,
    count: u32,
}

impl BrokenPlants {
    /// Unbroken plants on `sites` sites.
    pub(super) fn new(sites: usize) -> Self {
        Self { sites, falls: Arc::new(vec![0; sites.next_multiple_of(4)]), count: 0 }
    }

    /// Records newly broken plants. A plant that was broken before keeps its direction.
    pub(super) fn record(&mut self, plants: &[BrokenPlant]) -> Result<(), MirrorError> {
        if plants.len() > BROKEN_LIMIT {
            return Err(range("number of broken plants", plants.len(), format!("at most {BROKEN_LIMIT}")));
        }
        if let Some(beyond) = plants.iter().find(|plant| plant.site as usize >= self.sites) {
            return Err(range("site of a broken plant", beyond.site, format!("below {}", self.sites)));
        }
        for plant in plants {
            let fall = &mut Arc::make_mut(&mut self.falls)[plant.site as usize];
            if *fall == 0 {
                *fall = plant.fall.get();
                self.count += 1;
            }
        }
        Ok(())
    }

    pub(super) fn falls(&self) -> &[u8] {
        &self.falls
    }

    pub(super) fn count(&self) -> u32 {
        self.count
    }
}
