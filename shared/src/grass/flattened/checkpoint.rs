//! Copies of the state of flattened grass.

use super::FlattenedGrass;
use super::patch::{FlattenedPatch, FlattenedTile};
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
    /// Position of each tile in its patch, and its time of writing (s).
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
            return Err(StateError::Tiles { tiles: state.tiles.len(), cells: state.leans.len() });
        }
        (self.clock.now_secs, self.revision, self.dropped) = (state.now_secs, state.revision, state.dropped);
        self.patches = restored;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::PatchLayout;

    /// A case: its name, the error of restoring, and the change to a valid state.
    type Case = (&'static str, StateError, fn(&mut FlattenedState));

    const LAYOUT: PatchLayout = PatchLayout { count: [4, 4], cells: 16, cell_m: 0.5 };

    fn grass() -> FlattenedGrass {
        let mut grass = FlattenedGrass::new(LAYOUT, 20.0, 1000);
        for (patch, cell) in [(3, [9, 2]), (3, [1, 12]), (7, [0, 0])] {
            let mut detached = grass.detach(patch);
            detached.flatten(cell[0], cell[1], [0.7, -0.2]);
            grass.attach(patch, detached);
        }
        grass.step(1.0 / 60.0, &[]);
        grass
    }

    #[test]
    fn restored_grass_is_equal_also_from_a_state_that_was_another() {
        let grass = grass();
        let mut state = FlattenedGrass::new(LAYOUT, 20.0, 1000).state();
        grass.save_into(&mut state);
        let mut copy = FlattenedGrass::new(LAYOUT, 20.0, 1000);
        copy.restore(&state).unwrap();
        assert!(copy.state() == grass.state() && copy.words().eq(grass.words()) && copy.tiles() == 3);
    }

    #[test]
    fn states_that_do_not_fit_are_rejected_and_change_nothing() {
        let own = grass().state();
        let changes: [Case; 8] = [
            ("a patch outside the world", StateError::Flattened(16), |state| state.patches[1].0 = 16),
            ("a patch before the one before", StateError::Flattened(2), |state| state.patches[1].0 = 2),
            ("a patch without tiles", StateError::Flattened(3), |state| state.patches[0].2 = 0),
            ("a tile outside its patch", StateError::Flattened(3), |state| state.tiles[0].0 = 4),
            ("the same tile twice", StateError::Flattened(3), |state| state.tiles[0].0 = state.tiles[1].0),
            ("more tiles than there are", StateError::Flattened(7), |state| state.patches[1].2 = 2),
            ("a tile of no patch", StateError::Tiles { tiles: 4, cells: 256 }, |state| {
                state.tiles.push((0, 0.0));
                state.leans.extend([[1; 2]; CELLS]);
            }),
            ("a cell too many", StateError::Tiles { tiles: 3, cells: 193 }, |state| state.leans.push([1; 2])),
        ];
        for (name, error, change) in changes {
            let mut state = own.clone();
            change(&mut state);
            let mut grass = grass();
            assert_eq!(grass.restore(&state), Err(error), "{name}");
            assert!(grass.state() == own, "{name}");
        }
    }
}
