//! Copies of a field's state, from which it continues bit for bit.

use super::halo::Seams;
use super::patch::Patch;
use super::tiles::{TILE, Tiles};
use super::{CHANNELS, Field};
use crate::grid::PatchIndex;
use serde::{Deserialize, Serialize};
use thiserror::Error;

/// A copy of a [`Field`]'s state. Layout, kinds of grass and settings are not part of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FieldState {
    dt_secs: Option<f32>,
    revision: u64,
    patches: Vec<PatchState>,
}

/// A copy of the state of one awake patch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PatchState {
    index: PatchIndex,
    tiles: Tiles,
    /// With exact seams, the cells of the tiles that may not be at rest, tile by tile, row by row, channels at both times; ghosts are fetched from the
    /// neighbours before the next step. With overlapping seams, whose ghosts are their own, all planes.
    values: Vec<f32>,
}

/// The state of a field of another layout.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[error("patch {patch} does not fit the field")]
pub struct StateError {
    /// Index of the patch.
    pub patch: PatchIndex,
}

impl Field {
    /// A copy of the state.
    pub fn state(&self) -> FieldState {
        let patch = |patch: &Patch| PatchState { index: patch.index(), tiles: patch.tiles.clone(), values: patch.saved(self.seams) };
        FieldState { dt_secs: self.dt_secs, revision: self.revision.0, patches: self.patches.iter().map(patch).collect() }
    }

    /// Restores a copy of a field with the same layout, kinds and settings. Later steps are bit-identical to those of the original.
    ///
    /// # Errors
    /// [`StateError`] when a patch has another size or is outside the world; the field is then partly restored.
    pub fn restore(&mut self, state: FieldState) -> Result<(), StateError> {
        self.patches.clear();
        (self.dt_secs, self.revision.0) = (state.dt_secs, state.revision);
        for PatchState { index, tiles, values } in state.patches {
            let error = Err(StateError { patch: index });
            if index as usize >= self.layout.patches() || !tiles.fits(self.layout.cells as usize) {
                return error;
            }
            let seams = self.seams;
            if !self.wake(index).restore(seams, tiles, &values) {
                return error;
            }
        }
        Ok(())
    }
}

impl Patch {
    fn saved(&self, seams: Seams) -> Vec<f32> {
        let planes = self.now.iter().chain(&self.before);
        if seams == Seams::Overlap {
            return planes.flatten().copied().collect();
        }
        let rows = self.rows_of_moving_tiles();
        let mut values = Vec::with_capacity(rows.len() * 2 * CHANNELS * TILE);
        for row in rows {
            planes.clone().for_each(|plane| values.extend_from_slice(&plane[row..row + TILE]));
        }
        values
    }

    /// Sets the state of a patch at rest; false if the number of values is wrong, with the patch unchanged but for its tiles.
    fn restore(&mut self, seams: Seams, tiles: Tiles, values: &[f32]) -> bool {
        self.tiles = tiles;
        let rows = self.rows_of_moving_tiles();
        let mut planes: Vec<_> = self.now.iter_mut().chain(&mut self.before).collect();
        if seams == Seams::Overlap {
            let plane_len = planes[0].len();
            let fits = values.len() == planes.len() * plane_len;
            if fits {
                planes.iter_mut().zip(values.chunks_exact(plane_len)).for_each(|(plane, values)| plane.copy_from_slice(values));
            }
            return fits;
        }
        let fits = values.len() == rows.len() * planes.len() * TILE;
        if fits {
            let mut values = values.chunks_exact(TILE);
            for row in rows {
                planes.iter_mut().zip(&mut values).for_each(|(plane, values)| plane[row..row + TILE].copy_from_slice(values));
            }
        }
        fits
    }

    /// Indices in the planes of the rows of all tiles that may not be at rest.
    fn rows_of_moving_tiles(&self) -> Vec<usize> {
        let count = self.tiles.count();
        let tiles = (0..count).flat_map(|z| (0..count).map(move |x| (x, z)));
        let moving = tiles.filter(|&(x, z)| self.tiles.holds(x, z) || self.tiles.steps(x as i64, z as i64));
        moving.flat_map(|(x, z)| (0..TILE).map(move |row| self.at((x * TILE) as i64, (z * TILE + row) as i64))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Bend, Kinds, Rest, Scheme, Serial, WaveParams};
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
        let values = |field: &Field| field.state().patches.iter().map(|patch| patch.values.len()).sum::<usize>();
        assert_eq!(values(&field), TILE * TILE * 2 * CHANNELS, "one tile of four");
    }

    #[test]
    fn states_of_other_sizes_are_rejected() {
        let mut original = field(4);
        run(&mut original, Scheme::Substepped, 0..20);
        assert_eq!(field(2).restore(original.state()), Err(StateError { patch: 4 }), "of a larger field");
        for seams in [Seams::Exact, Seams::Overlap] {
            let mut original = field(4).with_seams(seams);
            run(&mut original, Scheme::Substepped, 0..20);
            for change in [-1_isize, 1] {
                let mut state = original.state();
                let (index, len) = (state.patches[0].index, state.patches[0].values.len());
                state.patches[0].values.resize(len.saturating_add_signed(change), 0.0);
                assert_eq!(field(4).with_seams(seams).restore(state), Err(StateError { patch: index }), "{seams:?}, {change}");
            }
        }
    }
}
