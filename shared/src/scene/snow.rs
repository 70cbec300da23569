//! Snow on the land.

use serde::{Deserialize, Serialize};

/// Snow that lies on the land, is pressed by wheels and feet (Sumner et al. 1999), and weighs plants down.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Snow {
    /// Depth of undisturbed snow (m). Vehicles go on the land below it, so that deep snow hides them. Default 0, no snow; allowed 0..=2.
    pub depth_m: f32,
    /// Density of undisturbed snow (kg/m³): 50 to 70 where it has just fallen in calm, 200 to 300 settled, 350 to 400 packed by wind (Cuffey and
    /// Paterson 2010). Default 120, allowed 30..=600.
    pub density_kg_m3: f32,
    /// Density at which snow bears wheels and feet and is pressed no further (kg/m³), at least `density_kg_m3`. Default 450, allowed 30..=900.
    pub pressed_density_kg_m3: f32,
    /// Fraction of the displaced snow that is pushed aside and forms rims; the rest is compacted. Default 0.3, allowed 0..=1.
    pub pushed_share: f32,
    /// Angle of repose of pushed snow (degrees): steeper rims slump. Default 40, allowed 10..=80.
    pub repose_deg: f32,
    /// Snowfall (m/h), which drifts into ruts: their depth falls to 1/e while as much falls as lies. Undisturbed snow settles by as much as falls and keeps its
    /// depth. Default 0, allowed 0..=0.5.
    pub fall_m_per_h: f32,
    /// Largest mass of snow that rests on leaves, per leaf area (kg/m²). Default 0.3, allowed 0..=5.
    pub leaf_load_kg_m2: f32,
}

impl Default for Snow {
    fn default() -> Self {
        Self {
            depth_m: 0.0,
            density_kg_m3: 120.0,
            pressed_density_kg_m3: 450.0,
            pushed_share: 0.3,
            repose_deg: 40.0,
            fall_m_per_h: 0.0,
            leaf_load_kg_m2: 0.3,
        }
    }
}

impl Snow {
    /// Whether there is any.
    pub fn lies(&self) -> bool {
        self.depth_m > 0.0
    }

    /// Mass of undisturbed snow per area of ground (kg/m²).
    pub fn mass_kg_m2(&self) -> f32 {
        self.depth_m * self.density_kg_m3
    }
}
