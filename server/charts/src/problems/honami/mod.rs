//! Waving grass: waves that grow in the shear layer over a canopy of oscillators (Py, de Langre & Moulia, J. Fluid Mech. 568, 2006).

pub mod simulation;
pub mod stability;

use prairie_wind::CanopyMotion;

/// Density of air (kg/m³), as in the solver.
pub(super) const AIR_KG_PER_M3: f64 = 1.2;

/// A uniform field in a steady wind.
#[derive(Clone, Copy, Debug)]
pub struct Meadow {
    /// Height of the canopy (m).
    pub height_m: f64,
    /// C_d·a (1/m).
    pub drag_per_m: f64,
    /// Wind far above (m/s).
    pub wind_m_per_s: f64,
    /// Motion of the grass; `None` for a rigid canopy.
    pub motion: Option<CanopyMotion>,
}

impl Meadow {
    /// Height of the box over that of the canopy.
    pub const BOX_HEIGHTS: usize = 6;

    /// Eddy viscosity (m²/s). It grows with the wind, so that flows over a rigid canopy are alike.
    pub fn viscosity_m2_per_s(&self) -> f64 {
        0.004 * self.wind_m_per_s * self.height_m
    }

    /// Rate (1/s) at which the wind of each layer relaxes to that far above; grows with the wind, too.
    pub fn relaxation_per_s(&self) -> f64 {
        0.05 * self.wind_m_per_s / self.height_m
    }
}

/// A field like alfalfa (Py et al. 2006: 0.69 m, 1.05 Hz), in a wind whose waves over rigid grass would have nearly its frequency.
pub const ALFALFA: Meadow = Meadow {
    height_m: 0.7,
    drag_per_m: 1.0,
    wind_m_per_s: 5.0,
    motion: Some(CanopyMotion { frequency_hz: 1.05, damping_ratio: 0.05, mass_kg_per_m2: 2.0 }),
};

/// The same field of rigid grass.
pub fn rigid(meadow: Meadow) -> Meadow {
    Meadow { motion: None, ..meadow }
}

/// A wave over a meadow.
#[derive(Clone, Copy, Debug)]
pub struct Wave {
    /// Wave number (1/m).
    pub k_per_m: f64,
    /// Growth rate (1/s).
    pub growth_per_s: f64,
    /// Angular frequency (rad/s).
    pub frequency_rad_per_s: f64,
}
