//! What grows in a scene.

use super::wind::words;
use serde::{Deserialize, Serialize};

words! {
    /// How upper segments find the bend that the root had a while ago.
    LagWay {
        /// From the place that the bend has reached since, 001 Eqs (8)–(9).
        Upwind = "upwind",
        /// From what was streamed then, 001 Eq. (7).
        History = "history",
    }
}

words! {
    /// How grass is drawn.
    PlantCover {
        /// As single blades near the camera (000 §3).
        Blades = "blades",
        /// As shells, near and far (003).
        Shells = "shells",
    }
}

words! {
    /// What a single blade looks like (000 Fig. 5).
    BladeShape {
        /// A strip that tapers to its tip (000 Fig. 5a).
        Simple = "simple",
        /// Five shapes that a texture's alpha cuts out of wider strips, mixed (000 Fig. 5b).
        Textured = "textured",
    }
}

words! {
    /// How the swing of a blade is carried on in time.
    BladeIntegrator {
        /// Explicit Euler; first order, and gains energy where damping is weak.
        Euler = "euler",
        /// The Verlet integration of 000 Eq. (7); second order undamped, else first.
        Verlet = "verlet",
        /// The closed form of each mode; stable for any step.
        Exact = "exact",
    }
}

/// Size, number, colour and swing of what the covering map places.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Plants {
    /// How grass is drawn: `blades`, single ones near the camera (000 §3), which bend and swing each by itself; `shells`, layers of cross-sections near and far
    /// (003), for short grass that grows thick. Default `blades`.
    pub cover: PlantCover,
    /// Side of a grass grid (m), the unit of level of detail (000 §3.1.2). Default 8, allowed 1..=64.
    pub grid_m: f32,
    /// Plants along one side of a grass grid, n of 000 Eq. (9): the levels of detail count with it, and near the camera five times as
    /// many blades stand along a side, up to 60 000 plants a grid. Default 32, allowed 2..=256.
    pub plants_per_side: u32,
    /// Mean height of a blade (m). Default 0.8, allowed 0.02..=5.
    pub height_m: f32,
    /// Random share of the height, plus or minus. Default 0.35, allowed 0..=0.9.
    pub height_variation: f32,
    /// Width of a blade at its root (m). Default 0.02, allowed 0.001..=0.5.
    pub width_m: f32,
    /// Flowers per square metre of grass, beside its blades. Default 0.6, allowed 0..=50.
    pub flowers_per_m2: f32,
    /// Colour of grass at the root, linear RGB. Default (0.03, 0.07, 0.015), allowed 0..=1 each.
    pub root_rgb: [f32; 3],
    /// Colour of grass at the tip, linear RGB. Default (0.3, 0.4, 0.09), allowed 0..=1 each.
    pub tip_rgb: [f32; 3],
    /// Height of a tree (m). Default 7, allowed 0.5..=60.
    pub tree_m: f32,
    /// Size of a stone (m). Default 0.8, allowed 0.05..=20.
    pub stone_m: f32,
    /// Where upper segments of plants find the bend that the root had `grass.lag_secs` ago: `upwind`, at the place that the bend has reached since (001 Eqs
    /// 8–9); `history`, in earlier pictures of the field, which are kept for it (Eq. 7). Default `upwind`.
    pub lag: LagWay,
    /// What single blades look like (000 Fig. 5): `simple`, a strip that tapers; `textured`, five shapes with a texture's alpha, mixed. Default `simple`.
    pub blade_shape: BladeShape,
    /// Natural frequency of a blade of mean height (Hz); others swing in inverse proportion to their height. Default 1.55, allowed 0.05..=50.
    pub swing_hz: f32,
    /// Damping of its swing as a share of critical damping. Default 0.1, allowed 0.005..=5.
    pub swing_damping: f32,
    /// How its swing is carried on in time: `euler`, explicit Euler; `verlet` of 000 Eq. (7); `exact`, the closed form of each mode, stable for any step.
    /// Default `exact`; the others are allowed where the shortest blades take at most 8 steps in 1/60 s.
    pub integrator: BladeIntegrator,
}

impl Default for Plants {
    fn default() -> Self {
        Self {
            cover: PlantCover::Blades,
            grid_m: 8.0,
            plants_per_side: 32,
            height_m: 0.8,
            height_variation: 0.35,
            width_m: 0.02,
            flowers_per_m2: 0.6,
            root_rgb: [0.03, 0.07, 0.015],
            tip_rgb: [0.30, 0.40, 0.09],
            tree_m: 7.0,
            stone_m: 0.8,
            lag: LagWay::Upwind,
            blade_shape: BladeShape::Simple,
            swing_hz: 1.55,
            swing_damping: 0.1,
            integrator: BladeIntegrator::Exact,
        }
    }
}
