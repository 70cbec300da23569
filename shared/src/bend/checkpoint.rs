//! Copies of a field's state, from which it continues bit for bit.

use super::Field;
use super::halo::Seams;
use super::patch::Patch;
use super::tiles::{TILE, Tiles};
use super::{CHANNELS, Executor, Serial};
use crate::grid::PatchIndex;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use thiserror::Error;

/// Channels at both times.
const STATE_PLANES: usize = 2 * CHANNELS;

/// A copy of a [`Field`]'s state. Layout, kinds of grass and settings are not part of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FieldState {
    dt_secs: Option<f32>,
    revision: u64,
    /// Index and tiles of each awake patch, ascending.
    patches: Vec<(PatchIndex, Tiles)>,
    /// Patch by patch. With exact seams, the rows of cells, without those of tiles at rest, in each row channels at both times; ghosts are fetched from the
    /// neighbours before the next step. With overlapping seams, whose ghosts are their own, all planes.
    values: Vec<f32>,
}

/// Reason why the state of a field cannot be restored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum StateError {
    /// A patch is outside the world, has another size or fewer values, or does not follow the one before.
    #[error("patch {0} does not fit the field")]
    Patch(PatchIndex),
    /// More patches are awake than the field allows.
    #[error("{awake} patches are awake; allowed: at most {limit}")]
    Awake {
        /// Number of awake patches.
        awake: usize,
        /// Largest number.
        limit: usize,
    },
    /// The snow of a patch is outside the world, has another size, does not follow the one before, or is out of range.
    #[error("the snow of patch {0} does not fit the field")]
    Snow(PatchIndex),
    /// Snow has other tiles than its patches, or other cells than its tiles.
    #[error("snow has {tiles} tiles of {cells} cells, which its patches do not have")]
    SnowTiles {
        /// Number of tiles.
        tiles: usize,
        /// Number of their cells.
        cells: usize,
    },
    /// There are more values than the patches have.
    #[error("{0} values belong to no patch")]
    Values(usize),
    /// The flattened grass of a patch is outside the world, has another size, or does not follow the one before.
    #[error("the flattened grass of patch {0} does not fit the field")]
    Flattened(PatchIndex),
    /// Flattened grass has other tiles than its patches, or other cells than its tiles.
    #[error("flattened grass has {tiles} tiles of {cells} cells, which its patches do not have")]
    Tiles {
        /// Number of tiles.
        tiles: usize,
        /// Number of their cells.
        cells: usize,
    },
}

impl Field {
    /// Copies the state into `state`, whose memory is used again.
    pub fn save_into(&self, state: &mut FieldState, executor: &impl Executor) {
        let FieldState { dt_secs, revision, patches, values } = state;
        (*dt_secs, *revision) = (self.dt_secs, self.revision.0);
        patches.clear();
        patches.extend(self.patches.iter().map(|patch| (patch.index(), patch.tiles.clone())));
        let parts: Vec<_> = self.patches.iter().map(|patch| patch.saved_parts(self.seams)).collect();
        let len = |parts: &[Range<usize>]| STATE_PLANES * parts.iter().map(Range::len).sum::<usize>();
        values.resize(parts.iter().map(|parts| len(parts)).sum(), 0.0);
        let mut rest = values.as_mut_slice();
        let mut copies = Vec::with_capacity(parts.len());
        for (patch, parts) in self.patches.iter().zip(parts) {
            let (own, others) = rest.split_at_mut(len(&parts));
            rest = others;
            copies.push((patch, parts, own));
        }
        executor.for_each(&mut copies, |(patch, parts, values)| patch.save(parts, values));
    }

    /// A copy of the state.
    pub fn state(&self) -> FieldState {
        let mut state = FieldState::default();
        self.save_into(&mut state, &Serial);
        state
    }

    /// Restores a copy of a field with the same layout, kinds and settings. Later steps are bit-identical to those of the original.
    ///
    /// # Errors
    /// [`StateError`] when the state does not fit the field; the field is then partly restored.
    pub fn restore(&mut self, state: FieldState) -> Result<(), StateError> {
        let FieldState { dt_secs, revision, patches, values } = state;
        if patches.len() > self.awake_limit {
            return Err(StateError::Awake { awake: patches.len(), limit: self.awake_limit });
        }
        self.patches.clear();
        (self.dt_secs, self.revision.0) = (dt_secs, revision);
        let mut values = values.as_slice();
        for (index, tiles) in patches {
            let follows = self.patches.last().is_none_or(|last| last.index() < index);
            if !follows || index as usize >= self.layout.patches() || !tiles.fits(self.layout.cells as usize) {
                return Err(StateError::Patch(index));
            }
            let seams = self.seams;
            values = self.wake(index).restore(seams, tiles, values).ok_or(StateError::Patch(index))?;
        }
        if values.is_empty() { Ok(()) } else { Err(StateError::Values(values.len())) }
    }
}

impl Patch {
    fn save(&self, parts: &[Range<usize>], mut values: &mut [f32]) {
        for part in parts {
            for plane in self.now.iter().chain(&self.before) {
                let own = values.split_off_mut(..part.len()).expect("as many values as the parts have");
                own.copy_from_slice(&plane[part.clone()]);
            }
        }
    }

    /// Sets the state of a patch at rest from the first of the values; the others, or `None` when there are too few.
    fn restore<'a>(&mut self, seams: Seams, tiles: Tiles, mut values: &'a [f32]) -> Option<&'a [f32]> {
        self.tiles = tiles;
        let parts = self.saved_parts(seams);
        let mut planes: Vec<_> = self.now.iter_mut().chain(&mut self.before).collect();
        for part in parts {
            for plane in &mut planes {
                let own;
                (own, values) = values.split_at_checked(part.len())?;
                plane[part.clone()].copy_from_slice(own);
            }
        }
        Some(values)
    }

    /// Ranges in the planes that a state has: rows of cells in runs of tiles that may not be at rest, or everything.
    fn saved_parts(&self, seams: Seams) -> Vec<Range<usize>> {
        if seams == Seams::Overlap {
            return std::iter::once(0..self.now[0].len()).collect();
        }
        let count = self.tiles.count();
        let mut parts = vec![];
        for z in 0..count {
            let moves = |x: &usize| self.tiles.holds(*x, z) || self.tiles.steps(*x as i64, z as i64);
            let mut runs: Vec<Range<usize>> = vec![];
            for x in (0..count).filter(moves) {
                match runs.last_mut().filter(|run| run.end == x) {
                    Some(run) => run.end = x + 1,
                    None => runs.push(x..x + 1),
                }
            }
            for row in z * TILE..(z + 1) * TILE {
                parts.extend(runs.iter().map(|run| {
                    let begin = self.at((run.start * TILE) as i64, row as i64);
                    begin..begin + run.len() * TILE
                }));
            }
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Bend, Kinds, Rest, Scheme, WaveParams};
    use super::*;
    use crate::grid::PatchLayout;

    fn field(count: u32) -> Field {
        let waves = WaveParams {
            c0_m_per_s: 2.0,
            mu_m_per_rad: 0.5,
            c_omega_m_per_s: 2.0,
            theta_damping_per_s: 3.0,
            omega_damping_per_s: 3.0,
            stiffness_per_s2: 4.0,
        };
        let rest = Rest { theta_rad: 1e-4, omega_rad_per_s: 1e-3 };
        Field::new(PatchLayout { count: [count; 2], cells: 16, cell_m: 0.25 }, Kinds::one(waves)).with_rest(rest)
    }

    fn run(field: &mut Field, scheme: Scheme, steps: std::ops::Range<i64>) {
        for n in steps {
            field.sleep_quiet(|_| false);
            field.wake(5);
            if n < 60 {
                field.press([20 + n % 8, 21], Bend { theta: 0.6, omega: [3.0, -1.0] });
            }
            // Steps of two lengths, which move the earlier state.
            let dt_secs = if n % 7 < 3 { 1.0 / 60.0 } else { 1.0 / 90.0 };
            field.step(scheme, dt_secs, &Serial).unwrap();
        }
    }

    fn bits(field: &Field) -> Vec<u32> {
        let rows = field.awake().flat_map(|patch| patch.rows().chain(patch.rows_before()));
        rows.flatten().flatten().map(|value| value.to_bits()).collect()
    }

    #[test]
    fn a_restored_field_continues_bit_for_bit() {
        for seams in [Seams::Exact, Seams::Overlap] {
            for scheme in [Scheme::Verlet, Scheme::Substepped, Scheme::Implicit] {
                for rest in [Rest { theta_rad: 1e-4, omega_rad_per_s: 1e-3 }, Rest::EXACT] {
                    let new = || field(4).with_seams(seams).with_rest(rest);
                    let mut original = new();
                    run(&mut original, scheme, 0..50);
                    let mut copy = new();
                    copy.restore(postcard::from_bytes(&postcard::to_allocvec(&original.state()).unwrap()).unwrap()).unwrap();
                    for n in (50..150).step_by(10) {
                        run(&mut original, scheme, n..n + 10);
                        run(&mut copy, scheme, n..n + 10);
                        assert!(bits(&original) == bits(&copy), "{seams:?}, {scheme:?}, {rest:?}, step {n}");
                        assert!(original.state() == copy.state(), "{seams:?}, {scheme:?}, {rest:?}, step {n}");
                        assert!(original.awake_count() > usize::from(seams == Seams::Exact));
                    }
                }
            }
        }
    }

    #[test]
    fn a_state_has_only_the_cells_that_move() {
        let mut field = field(4);
        field.press([20, 21], Bend { theta: 0.6, omega: [3.0, -1.0] });
        assert!(field.state().patches.is_empty(), "all patches sleep");
        field.wake(5);
        field.press([20, 21], Bend { theta: 0.6, omega: [3.0, -1.0] });
        assert_eq!(field.state().values.len(), TILE * TILE * STATE_PLANES, "one tile of four");
    }

    #[test]
    fn a_state_is_saved_into_the_memory_of_another() {
        let mut original = field(4);
        run(&mut original, Scheme::Substepped, 0..50);
        let mut state = original.state();
        // The field grows, and the memory with it, by more than this field needs later.
        run(&mut original, Scheme::Substepped, 50..60);
        original.save_into(&mut state, &Serial);
        let capacity = state.values.capacity();
        for n in 60..70 {
            run(&mut original, Scheme::Substepped, n..n + 1);
            original.save_into(&mut state, &Serial);
            assert!(state == original.state() && state.values.capacity() == capacity, "step {n}");
        }
    }

    #[test]
    fn states_that_do_not_fit_are_rejected() {
        let mut original = field(4);
        run(&mut original, Scheme::Substepped, 0..20);
        let state = original.state();
        assert_eq!(field(2).restore(state.clone()), Err(StateError::Patch(4)), "of a larger field");
        let awake = state.patches.len();
        assert!(awake > 1);
        let error = field(4).with_awake_limit(awake - 1).restore(state.clone());
        assert_eq!(error, Err(StateError::Awake { awake, limit: awake - 1 }));
        let last = state.patches[awake - 1].0;
        let mut twice = state.clone();
        twice.patches.push(state.patches[awake - 1].clone());
        assert_eq!(field(4).restore(twice), Err(StateError::Patch(last)), "twice the same patch");
        for seams in [Seams::Exact, Seams::Overlap] {
            let mut original = field(4).with_seams(seams);
            run(&mut original, Scheme::Substepped, 0..20);
            let mut state = original.state();
            let last = state.patches.last().unwrap().0;
            state.values.push(0.0);
            assert_eq!(field(4).with_seams(seams).restore(state.clone()), Err(StateError::Values(1)), "{seams:?}");
            state.values.truncate(state.values.len() - 2);
            assert_eq!(field(4).with_seams(seams).restore(state), Err(StateError::Patch(last)), "{seams:?}");
        }
    }
}
