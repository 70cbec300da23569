//! Copies of a field's state, from which it continues bit for bit.

use super::tiles::Tiles;
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

/// A copy of the state of one awake patch, ghosts included.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PatchState {
    index: PatchIndex,
    now: [Vec<f32>; CHANNELS],
    before: [Vec<f32>; CHANNELS],
    tiles: Tiles,
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
        let patch = |patch: &super::Patch| PatchState {
            index: patch.index(),
            now: patch.now.clone(),
            before: patch.before.clone(),
            tiles: patch.tiles.clone(),
        };
        FieldState { dt_secs: self.dt_secs, revision: self.revision.0, patches: self.patches.iter().map(patch).collect() }
    }

    /// Restores a copy of a field with the same layout, kinds and settings. Later steps are bit-identical to those of the original.
    ///
    /// # Errors
    /// [`StateError`] when a patch has another size or is outside the world; the field is then partly restored.
    pub fn restore(&mut self, state: FieldState) -> Result<(), StateError> {
        self.patches.clear();
        (self.dt_secs, self.revision.0) = (state.dt_secs, state.revision);
        for PatchState { index, now, before, tiles } in state.patches {
            let error = Err(StateError { patch: index });
            if index as usize >= self.layout.patches() || !tiles.fits(self.layout.cells as usize) {
                return error;
            }
            let patch = self.wake(index);
            let sizes = |planes: &[Vec<f32>; CHANNELS]| planes.each_ref().map(Vec::len);
            if sizes(&now) != sizes(&patch.now) || sizes(&before) != sizes(&patch.before) {
                return error;
            }
            (patch.now, patch.before, patch.tiles) = (now, before, tiles);
        }
        Ok(())
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

    #[test]
    fn a_restored_field_continues_bit_for_bit() {
        let mut original = field(4);
        let run = |field: &mut Field, steps: std::ops::Range<i64>| {
            for n in steps {
                field.sleep_quiet(|_| false);
                field.wake(5);
                field.press([20 + n % 8, 21], Bend { theta: 0.6, omega: [3.0, -1.0] });
                field.step(Scheme::Substepped, 1.0 / 60.0, &Serial).unwrap();
            }
        };
        run(&mut original, 0..50);
        let mut copy = field(4);
        copy.restore(postcard::from_bytes(&postcard::to_allocvec(&original.state()).unwrap()).unwrap()).unwrap();
        for n in (50..150).step_by(10) {
            run(&mut original, n..n + 10);
            run(&mut copy, n..n + 10);
            assert!(original.state() == copy.state() && original.awake_count() > 1);
        }
        assert_eq!(field(2).restore(original.state()), Err(StateError { patch: 4 }), "of a larger field");
    }
}
