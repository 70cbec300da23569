//! Copies of the state of flattened grass.

use super::{FlattenedGrass, FlattenedPatch, FlattenedTile};
use crate::bend::{StateError, TILE};
use crate::grid::PatchIndex;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

const CELLS: usize = TILE * TILE;

/// A copy of the state of [`FlattenedGrass`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FlattenedState {
    now_secs: f64,
    revision: u64,
    dropped: u64,
    /// Index of each patch, ascending, the revision in which it last changed, and its number of tiles.
    patches: Vec<(PatchIndex, u64, u16)>,
    /// Position of each tile in its patch, ascending in each, and its time of writing (s).
    tiles: Vec<(u16, f64)>,
    /// Leans of the cells of each tile, in quanta.
    leans: Vec<[i16; 2]>,
}

impl FlattenedGrass {
    /// A copy of the state.
    pub fn state(&self) -> FlattenedState {
        let mut state = FlattenedState::default();
        self.save_into(&mut state);
        state
    }

    /// Copies the state into `state`, whose memory is used again.
    pub fn save_into(&self, state: &mut FlattenedState) {
        let FlattenedState { now_secs, revision, dropped, patches, tiles, leans } = state;
        (*now_secs, *revision, *dropped) = (self.clock.now_secs, self.revision, self.dropped);
        patches.clear();
        patches.extend(self.patches.iter().map(|(&index, patch)| (index, patch.changed_in, patch.count as u16)));
        tiles.clear();
        leans.clear();
        for patch in self.patches.values() {
            for (at, tile) in patch.tiles.iter().enumerate() {
                let Some(tile) = tile else { continue };
                tiles.push((at as u16, tile.since_secs));
                leans.extend_from_slice(&tile.leans);
            }
        }
    }

    /// Restores a copy of the state in a world of the same layout.
    ///
    /// # Errors
    /// [`StateError::Flattened`] when it is that of another layout; nothing changes then.
    pub fn restore(&mut self, state: &FlattenedState) -> Result<(), StateError> {
        let across = self.tiles_across();
        let (leans, rest) = state.leans.as_chunks::<CELLS>();
        let mut tiles = state.tiles.iter().zip(leans);
        let mut restored = BTreeMap::new();
        for &(index, changed_in, count) in &state.patches {
            let error = StateError::Flattened(index);
            let follows = restored.last_key_value().is_none_or(|(last, _)| *last < index);
            if !follows || index as usize >= self.layout.patches() || count == 0 {
                return Err(error);
            }
            let mut patch = FlattenedPatch { tiles: vec![None; across * across], count: count.into(), changed_in };
            for _ in 0..count {
                let (&(at, since_secs), &leans) = tiles.next().ok_or(error)?;
                let place = patch.tiles.get_mut(usize::from(at)).filter(|place| place.is_none()).ok_or(error)?;
                *place = Some(Box::new(FlattenedTile { since_secs, leans }));
            }
            restored.insert(index, patch);
        }
        if !rest.is_empty() || leans.len() != state.tiles.len() || tiles.next().is_some() {
            return Err(StateError::Values(rest.len().max(leans.len().abs_diff(state.tiles.len()) * CELLS)));
        }
        (self.clock.now_secs, self.revision, self.dropped) = (state.now_secs, state.revision, state.dropped);
        self.patches = restored;
        Ok(())
    }
}
