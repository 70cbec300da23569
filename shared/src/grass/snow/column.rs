//! A column of snow, and how it yields to a load.
//!
//! Mass and depth are whole numbers of quanta, so that mass is conserved exactly.

use crate::scene::Snow;
use serde::{Deserialize, Serialize};

/// Quantum of the mass of a column per area (kg/m²).
pub const MASS_QUANTUM_KG_M2: f64 = 1e-5;
/// Quantum of the depth of a column (m).
pub const DEPTH_QUANTUM_M: f64 = 1e-6;
/// Quanta of mass in a quantum of depth at a density of 1 kg/m³, as a fraction: a tenth.
const QUANTA_PER_DENSITY: f64 = DEPTH_QUANTUM_M / MASS_QUANTUM_KG_M2;
/// Fixed-point unit of fractions.
const UNIT: i64 = 1 << 24;

/// `value · numerator / denominator`, rounded towards 0, whose product may exceed 64 bits.
pub(super) fn scaled(value: i64, numerator: i64, denominator: i64) -> i64 {
    (i128::from(value) * i128::from(numerator) / i128::from(denominator)) as i64
}

/// Snow on a cell, or a difference from it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Column {
    /// Mass per area, in [quanta](MASS_QUANTUM_KG_M2).
    pub mass: i64,
    /// Depth, in [quanta](DEPTH_QUANTUM_M).
    pub depth: i64,
}

impl Column {
    /// A column of this depth and density.
    pub fn new(depth_m: f32, density_kg_m3: f32) -> Self {
        let mass = f64::from(depth_m) * f64::from(density_kg_m3) / MASS_QUANTUM_KG_M2;
        Self { mass: mass.round() as i64, depth: quanta_of(depth_m) }
    }

    /// Depth (m).
    pub fn depth_m(self) -> f32 {
        (self.depth as f64 * DEPTH_QUANTUM_M) as f32
    }

    /// Density (kg/m³); 0 for an empty column.
    pub fn density_kg_m3(self) -> f32 {
        if self.depth > 0 { (self.mass as f64 / (self.depth as f64 * QUANTA_PER_DENSITY)) as f32 } else { 0.0 }
    }

    pub(super) fn plus(self, other: Self) -> Self {
        Self { mass: self.mass + other.mass, depth: self.depth + other.depth }
    }

    pub(super) fn minus(self, other: Self) -> Self {
        Self { mass: self.mass - other.mass, depth: self.depth - other.depth }
    }

    /// The upper part of this depth.
    pub(super) fn top(self, depth: i64) -> Self {
        let depth = depth.clamp(0, self.depth);
        Self { mass: if self.depth > 0 { scaled(self.mass, depth, self.depth) } else { 0 }, depth }
    }
}

/// How columns yield to a load (Sumner, O'Brien and Hodgins 1999): what an object displaces is compacted, up to a limit of density, and pushed aside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Yielding {
    /// Depth of a column at the limit of density, in quanta per quantum of mass over [`UNIT`].
    packed_depth_per_mass: i64,
    /// Fraction of the displaced snow that is pushed aside, in 1/[`UNIT`].
    pushed: i64,
}

impl Yielding {
    pub(super) fn new(snow: &Snow) -> Self {
        let packed = UNIT as f64 / (f64::from(snow.pressed_density_kg_m3) * QUANTA_PER_DENSITY);
        Self { packed_depth_per_mass: packed.round() as i64, pushed: (f64::from(snow.pushed_share) * UNIT as f64).round() as i64 }
    }

    /// Depth of a mass at the limit of density.
    fn packed_depth(self, mass: i64) -> i64 {
        scaled(mass, self.packed_depth_per_mass, UNIT)
    }

    /// Whether a column is at the limit of density, at which it bears any load.
    pub(super) fn is_packed(self, column: Column) -> bool {
        column.depth <= self.packed_depth(column.mass)
    }

    /// A column after an object has come down to `clearance` above the ground, and what is pushed aside, with the density that it had. The column is
    /// compacted to the clearance, or to the limit of density; of the snow that an object displaces below its limit, a share is pushed aside.
    pub(super) fn pressed(self, column: Column, clearance: i64) -> (Column, Column) {
        let floor = self.packed_depth(column.mass);
        if column.depth <= clearance.max(floor) {
            return (column, Column::default());
        }
        if floor <= clearance {
            return (Column { depth: clearance, ..column }, Column::default());
        }
        let displaced = column.top(column.depth - floor);
        // As much as the room below the object holds stays in any case.
        let room = scaled(clearance, UNIT, self.packed_depth_per_mass);
        let mass = scaled(displaced.mass, self.pushed, UNIT).min(column.mass - room).max(0);
        let aside = Column { mass, depth: if column.mass > 0 { scaled(column.depth, mass, column.mass) } else { 0 } };
        let mass = column.mass - mass;
        (Column { mass, depth: self.packed_depth(mass).max(clearance) }, aside)
    }
}

/// A length (m) in quanta of depth.
pub(super) fn quanta_of(m: f32) -> i64 {
    (f64::from(m) / DEPTH_QUANTUM_M).round() as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const SNOW: Snow = Snow {
        depth_m: 0.2,
        density_kg_m3: 120.0,
        pressed_density_kg_m3: 450.0,
        pushed_share: 0.3,
        repose_deg: 40.0,
        fall_m_per_h: 0.0,
        leaf_load_kg_m2: 0.3,
    };

    /// Closed form of one press: depth (m) and mass (kg/m²) that stay of a column of `depth_m`.
    fn closed_form(snow: &Snow, clearance_m: f64) -> [f64; 2] {
        let (depth_m, density, limit) = (f64::from(snow.depth_m), f64::from(snow.density_kg_m3), f64::from(snow.pressed_density_kg_m3));
        let mass = depth_m * density;
        if clearance_m >= depth_m {
            return [depth_m, mass];
        }
        if clearance_m >= mass / limit {
            return [clearance_m, mass];
        }
        let stays = (mass * (1.0 - f64::from(snow.pushed_share) * (1.0 - density / limit))).max(clearance_m * limit);
        [stays / limit, stays]
    }

    #[test]
    fn one_press_leaves_the_depth_and_the_mass_of_the_closed_form() {
        for clearance_m in [0.0, 0.02, 0.04, 0.045, 0.05, 0.06, 0.1, 0.19, 0.25] {
            let column = Column::new(SNOW.depth_m, SNOW.density_kg_m3);
            let (stays, aside) = Yielding::new(&SNOW).pressed(column, quanta_of(clearance_m));
            let [depth_m, mass] = closed_form(&SNOW, clearance_m.into());
            assert!((f64::from(stays.depth_m()) - depth_m).abs() < 1e-5, "{clearance_m} m: {} m, not {depth_m}", stays.depth_m());
            let found = stays.mass as f64 * MASS_QUANTUM_KG_M2;
            assert!((found - mass).abs() < 2e-3 * mass, "{clearance_m} m: {found} kg/m², not {mass}");
            assert_eq!(stays.mass + aside.mass, column.mass);
        }
    }

    proptest! {
        #[test]
        fn a_press_conserves_mass_and_the_second_changes_nothing(
            depth_m in 0.0_f32..2.0, density in 30.0_f32..600.0, denser in 1.0_f32..10.0, pushed_share in 0.0_f32..1.0, clearance_m in 0.0_f32..1.0,
        ) {
            let snow = Snow { pressed_density_kg_m3: (density * denser).min(900.0), pushed_share, ..SNOW };
            let (column, yielding) = (Column::new(depth_m, density), Yielding::new(&snow));
            let clearance = quanta_of(clearance_m);
            let (stays, aside) = yielding.pressed(column, clearance);
            prop_assert!(stays.mass + aside.mass == column.mass && stays.mass >= 0 && aside.mass >= 0);
            prop_assert!(stays.depth >= 0 && stays.depth <= column.depth && aside.depth >= 0);
            prop_assert_eq!(yielding.pressed(stays, clearance), (stays, Column::default()));
        }
    }
}
