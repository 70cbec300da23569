//! Copies of the state of the snow.

use super::{CELLS, Column, SnowField, SnowPatch};
use crate::bend::StateError;
use crate::grid::PatchIndex;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A copy of the state of a [`SnowField`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SnowState {
    revision: u64,
    dropped: u64,
    /// Index of each patch, ascending, the revisions in which it last changed and was last pressed, and its number of tiles.
    patches: Vec<(PatchIndex, u64, u64, u16)>,
    /// Position of each tile in its patch.
    tiles: Vec<u16>,
    /// Differences of the cells of each tile.
    cells: Vec<Column>,
}

impl SnowState {
    #[cfg(test)]
    pub(super) fn fill(&mut self, difference: Column) {
        self.cells.fill(difference);
    }

    /// Differences from undisturbed snow of the cells of each tile.
    pub fn cells(&self) -> &[Column] {
        &self.cells
    }
}

impl SnowField {
    /// A copy of the state.
    pub fn state(&self) -> SnowState {
        let mut state = SnowState::default();
        self.save_into(&mut state);
        state
    }

    /// Copies the state into `state`, whose memory is used again.
    pub fn save_into(&self, state: &mut SnowState) {
        let SnowState { revision, dropped, patches, tiles, cells } = state;
        (*revision, *dropped) = (self.revision, self.dropped);
        patches.clear();
        patches.extend(self.patches.iter().map(|(&index, patch)| (index, patch.changed_in, patch.pressed_in, patch.count as u16)));
        tiles.clear();
        cells.clear();
        for (at, tile) in self.patches.values().flat_map(|patch| patch.tiles.iter().enumerate()) {
            let Some(tile) = tile else { continue };
            tiles.push(at as u16);
            cells.extend_from_slice(tile.as_slice());
        }
    }

    /// Restores a copy of the state in a world of the same scene.
    ///
    /// # Errors
    /// [`StateError::Snow`] or [`StateError::SnowTiles`] when it is that of another scene; nothing changes then.
    pub fn restore(&mut self, state: &SnowState) -> Result<(), StateError> {
        let across = self.tiles_across();
        let (cells, rest) = state.cells.as_chunks::<CELLS>();
        let mut tiles = state.tiles.iter().zip(cells);
        let mut restored = BTreeMap::new();
        for &(index, changed_in, pressed_in, count) in &state.patches {
            let error = StateError::Snow(index);
            let follows = restored.last_key_value().is_none_or(|(last, _)| *last < index);
            if !follows || index as usize >= self.layout.patches() || count == 0 {
                return Err(error);
            }
            let mut patch = SnowPatch { tiles: vec![None; across * across], count: count.into(), changed_in, pressed_in };
            for _ in 0..count {
                let (&at, cells) = tiles.next().ok_or(error)?;
                let place = patch.tiles.get_mut(usize::from(at)).filter(|place| place.is_none()).ok_or(error)?;
                if !cells.iter().all(|cell| self.is_possible(*cell)) {
                    return Err(error);
                }
                *place = Some(Box::new(*cells));
            }
            restored.insert(index, patch);
        }
        if !rest.is_empty() || cells.len() != state.tiles.len() || tiles.next().is_some() {
            return Err(StateError::SnowTiles { tiles: state.tiles.len(), cells: state.cells.len() });
        }
        (self.revision, self.dropped, self.patches) = (state.revision, state.dropped, restored);
        let differences = state.cells.iter().map(|cell| cell.depth).max().unwrap_or(0);
        self.highest = self.undisturbed.depth + differences.max(0);
        Ok(())
    }

    /// Whether a difference is that of a column that can exist. The sum of all in a world is far from the limits of the arithmetic.
    fn is_possible(&self, difference: Column) -> bool {
        const LIMIT: i64 = 1 << 36;
        let in_range = |least: i64, value: i64| (least..LIMIT).contains(&value);
        in_range(-self.undisturbed.mass, difference.mass) && in_range(-self.undisturbed.depth, difference.depth)
    }
}
