//! The bend field at any place: the one rule by which server, page and HTTP API sample it.

use super::Bend;
use crate::grid::{PatchIndex, PatchLayout};
use crate::wire::quantise::CodeSteps;

impl Bend {
    /// The bend of the codes of θ, ωx and ωz on the wire.
    pub fn of_codes([theta, x, z]: [i16; 3], steps: &CodeSteps) -> Self {
        Self { theta: steps.theta_rad(theta), omega: [steps.omega_rad_per_s(x), steps.omega_rad_per_s(z)] }
    }

    /// The bend as a lean (rad, vector along X and Z): of length θ, along ω; zero without a direction.
    pub fn lean_rad(&self) -> [f32; 2] {
        let [x, z] = self.omega;
        let speed = (x * x + z * z).sqrt();
        if speed > 0.0 { [x, z].map(|omega| omega / speed * self.theta) } else { [0.0; 2] }
    }
}

/// Lean (rad, vector along X and Z) of the bend field at a place (m, X and Z), relative to [the lean in the wind](super::wind_lean_rad): bilinear between the
/// leans of the four nearest cell centres. `cell` returns the bend of a cell by its patch and its number in it, row by row; cells outside the world are at
/// rest. NaN at a place that is NaN or infinite.
pub fn field_lean_at(layout: &PatchLayout, at_m: [f32; 2], cell: impl Fn(PatchIndex, usize) -> Bend) -> [f32; 2] {
    let cells = i64::from(layout.cells);
    let at = at_m.map(|m| m / layout.cell_m - 0.5);
    let low = at.map(f32::floor);
    let [u, v] = [0, 1].map(|axis| at[axis] - low[axis]);
    let lean = |dx: i64, dz: i64| {
        let [x, z] = [low[0] as i64, low[1] as i64];
        let (x, z) = (x.saturating_add(dx), z.saturating_add(dz));
        let patch = layout.index(x.div_euclid(cells), z.div_euclid(cells));
        patch.map_or([0.0; 2], |patch| cell(patch, (x.rem_euclid(cells) + z.rem_euclid(cells) * cells) as usize).lean_rad())
    };
    let mix = |a: [f32; 2], b: [f32; 2], t: f32| [0, 1].map(|axis| a[axis] * (1.0 - t) + b[axis] * t);
    mix(mix(lean(0, 0), lean(1, 0), u), mix(lean(0, 1), lean(1, 1), u), v)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAYOUT: PatchLayout = PatchLayout { count: [2, 2], cells: 8, cell_m: 0.5 };

    /// Leans that are linear in the place of a cell: east by 0.1 rad/m of X, south by 0.05 rad/m of Z.
    fn linear(patch: PatchIndex, number: usize) -> Bend {
        let [x, z] = LAYOUT.corner_m(patch);
        let lean = [0.1 * (x + (number % 8) as f32 * 0.5 + 0.25), 0.05 * (z + (number / 8) as f32 * 0.5 + 0.25)];
        let theta = (lean[0] * lean[0] + lean[1] * lean[1]).sqrt();
        Bend { theta, omega: lean.map(|lean| lean / theta) }
    }

    #[test]
    fn leans_are_bilinear_across_patches() {
        for at_m in [[0.25, 0.25], [3.9, 4.1], [4.0, 4.0], [7.5, 1.33], [2.2, 6.6]] {
            let [x, z] = field_lean_at(&LAYOUT, at_m, linear);
            assert!((x - 0.1 * at_m[0]).abs() < 1e-5 && (z - 0.05 * at_m[1]).abs() < 1e-5, "{x}, {z} at {at_m:?}");
        }
        let [x, _] = field_lean_at(&LAYOUT, [8.0, 4.25], linear);
        assert!((x - 0.5 * 0.775).abs() < 1e-5, "half-way to the grass at rest outside the world: {x}");
        assert_eq!(field_lean_at(&LAYOUT, [1e30, -1e30], linear), [0.0; 2]);
        assert!(field_lean_at(&LAYOUT, [f32::INFINITY, f32::NAN], linear)[0].is_nan());
    }

    #[test]
    fn a_bend_leans_along_its_velocity() {
        assert_eq!(Bend { theta: 0.5, omega: [0.0, -3.0] }.lean_rad(), [0.0, -0.5]);
        assert_eq!(Bend { theta: 0.5, omega: [0.0; 2] }.lean_rad(), [0.0; 2]);
        let steps = CodeSteps { omega_root: 0.5, ..CodeSteps::default() };
        assert_eq!(Bend::of_codes([0, 6, -4], &steps).omega, [9.0, -4.0]);
    }
}
