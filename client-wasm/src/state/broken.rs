//! Which plants of the underbrush are broken, and which way they fell.

use super::{MirrorError, range};
use shared::wire::{BROKEN_LIMIT, BrokenPlant};

/// A byte for each site, and as many more as make whole words; none before a scene with underbrush.
#[derive(Debug, Default)]
pub(super) struct Broken {
    sites: usize,
    falls: Vec<u8>,
    count: u32,
}

impl Broken {
    /// Whole plants on so many sites.
    pub(super) fn new(sites: usize) -> Self {
        Self { sites, falls: vec![0; sites.next_multiple_of(4)], count: 0 }
    }

    /// Takes in what a message says; one that was broken already lies as it fell.
    pub(super) fn take_in(&mut self, plants: &[BrokenPlant]) -> Result<(), MirrorError> {
        if plants.len() > BROKEN_LIMIT {
            return Err(range("number of broken plants", plants.len(), format!("at most {BROKEN_LIMIT}")));
        }
        if let Some(beyond) = plants.iter().find(|plant| plant.site as usize >= self.sites) {
            return Err(range("site of a broken plant", beyond.site, format!("below {}", self.sites)));
        }
        for plant in plants {
            let fall = &mut self.falls[plant.site as usize];
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
