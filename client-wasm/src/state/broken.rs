//! Which plants of the underbrush are broken.

use super::{MirrorError, range};
use shared::wire::BROKEN_LIMIT;

/// One bit for each site; none before a scene with underbrush.
#[derive(Debug, Default)]
pub(super) struct Broken {
    sites: usize,
    words: Vec<u32>,
    count: u32,
}

impl Broken {
    /// Whole plants on so many sites.
    pub(super) fn new(sites: usize) -> Self {
        Self { sites, words: vec![0; sites.div_ceil(32)], count: 0 }
    }

    /// Takes in what a message says; one that was broken already counts once.
    pub(super) fn take_in(&mut self, plants: &[u32]) -> Result<(), MirrorError> {
        if plants.len() > BROKEN_LIMIT {
            return Err(range("number of broken plants", plants.len(), format!("at most {BROKEN_LIMIT}")));
        }
        if let Some(beyond) = plants.iter().find(|&&site| site as usize >= self.sites) {
            return Err(range("site of a broken plant", beyond, format!("below {}", self.sites)));
        }
        for site in plants {
            let (word, bit) = (&mut self.words[*site as usize / 32], 1 << (site % 32));
            self.count += u32::from(*word & bit == 0);
            *word |= bit;
        }
        Ok(())
    }

    pub(super) fn words(&self) -> &[u32] {
        &self.words
    }

    pub(super) fn count(&self) -> u32 {
        self.count
    }
}
