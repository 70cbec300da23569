//! Plants of a scene: the section `[plants]`.

use super::wind::words;
use serde::{Deserialize, Serialize};

words! {
    /// Source of the delayed bend of upper segments.
    LagWay {
        /// The position that the bend has reached since, Chen & Johan Eqs (8)–(9).
        Upwind = "upwind",
        /// Earlier states of the field, Chen & Johan Eq. (7).
        History = "history",
    }
}

words! {
    /// Rendering of grass.
    PlantCover {
        /// Single blades near the camera (Zhang §3).
        Blades = "blades",
        /// Shells, near and far (Bakay).
        Shells = "shells",
    }
}

words! {
    /// Shape of a single blade (Zhang Fig. 5).
    BladeShape {
        /// A strip that tapers to its tip (Zhang Fig. 5a).
        Simple = "simple",
        /// Five shapes cut out of wider strips by a texture's alpha, mixed (Zhang Fig. 5b).
        Textured = "textured",
    }
}

words! {
    /// Shape of a flower head near the camera.
    FlowerShape {
        /// Petals around a disc.
        Modelled = "modelled",
        /// A tilted square with one of six textures (Zhang §3.3).
        Textured = "textured",
    }
}

words! {
    /// Shape of trees.
    TreeShape {
        /// Meshes that sway as a whole.
        Modelled = "modelled",
        /// Trunk, limbs and twigs that bend by themselves, as the components of underbrush do (Endo et al. 2003, §7).
        Grown = "grown",
    }
}

words! {
    /// Time integration of a blade's swing.
    BladeIntegrator {
        /// Explicit Euler; first order, and gains energy where damping is weak.
        Euler = "euler",
        /// Verlet integration, Zhang Eq. (7); second order without damping, else first.
        Verlet = "verlet",
        /// The closed form of each mode; stable for any step.
        Exact = "exact",
    }
}

/// Size, number, colour and swing of the plants that the covering map places.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Plants {
    /// Rendering of grass: `blades`, single blades near the camera (Zhang §3), each of which bends and swings by itself; `shells`, layers of
    /// cross-sections near and far (Bakay), for short, dense grass. Default `blades`.
    pub cover: PlantCover,
    /// Side of a grass grid (m), the unit of level of detail (Zhang §3.1.2). Default 8, allowed 1..=64.
    pub grid_m: f32,
    /// Plants along one side of a grass grid, n of Zhang Eq. (9), which determines the levels of detail. Default 32, allowed 2..=256.
    pub plants_per_side: u32,
    /// Blades along one side of a grid near the camera, relative to `plants_per_side`; up to 60 000 plants a grid are drawn. 1 is Zhang's prairie, whose
    /// ground shows between the blades; 5 closes the sward. Default 5, allowed 1..=5.
    pub near_ratio: f32,
    /// Straight segments of a near and of a farther blade, one less than its backbone points (Zhang §3.1.1); 0: the quality of the picture decides.
    /// Default (0, 0), allowed 0..=12 each.
    pub blade_segments: [u32; 2],
    /// Highest level of detail that automatic quality draws with, from 0 (`low`) to 3 (`ultra`); a quality that somebody chooses goes beyond it. Default 3,
    /// allowed 0..=3.
    pub highest_detail: f32,
    /// Mean height of a blade (m). Default 0.8, allowed 0.02..=5.
    pub height_m: f32,
    /// Random variation of the height, plus or minus, as a fraction. Default 0.35, allowed 0..=0.9.
    pub height_variation: f32,
    /// Width of a blade at its root (m). Default 0.02, allowed 0.001..=0.5.
    pub width_m: f32,
    /// Flowers per square metre of grass, in addition to its blades. Default 0.6, allowed 0..=50.
    pub flowers_per_m2: f32,
    /// Colour of grass at the root, linear RGB. Default (0.03, 0.07, 0.015), allowed 0..=1 each.
    pub root_rgb: [f32; 3],
    /// Colour of grass at the tip, linear RGB. Default (0.3, 0.4, 0.09), allowed 0..=1 each.
    pub tip_rgb: [f32; 3],
    /// Height of a tree (m). Default 7, allowed 0.5..=60.
    pub tree_m: f32,
    /// Size of a stone (m). Default 0.8, allowed 0.05..=20.
    pub stone_m: f32,
    /// Source of the bend that upper segments take from the root `grass.lag_secs` ago: `upwind`, the position that the bend has reached since (Chen &
    /// Johan Eqs 8–9); `history`, earlier states of the field, which are kept for it (Eq. 7). Default `upwind`.
    pub lag: LagWay,
    /// Shape of single blades (Zhang Fig. 5): `simple`, a strip that tapers; `textured`, five shapes with a texture's alpha, mixed. Default `simple`.
    pub blade_shape: BladeShape,
    /// Shape of flower heads near the camera: `modelled`, petals around a disc; `textured`, a tilted square with one of six textures (Zhang §3.3).
    /// Default `modelled`.
    pub flower_shape: FlowerShape,
    /// Shape of trees: `modelled`, meshes that sway as a whole; `grown`, trunk, limbs and twigs that grow by space colonisation (Runions et al. 2007) and
    /// bend by themselves under weight and wind (Endo et al. 2003). Obstacles are the same. Default `modelled`.
    pub tree_shape: TreeShape,
    /// Natural frequency of a blade of mean height (Hz); inversely proportional to the height. Default 1.55, allowed 0.05..=50.
    pub swing_hz: f32,
    /// Damping ratio of its swing (1 is critical damping). Default 0.1, allowed 0.005..=5.
    pub swing_damping: f32,
    /// Time integration of its swing: `euler`, explicit Euler; `verlet`, Zhang Eq. (7); `exact`, the closed form of each mode, stable for any step.
    /// Default `exact`; the others are allowed if the shortest blades take at most 8 steps in 1/60 s.
    pub integrator: BladeIntegrator,
}

impl Default for Plants {
    fn default() -> Self {
        Self {
            cover: PlantCover::Blades,
            grid_m: 8.0,
            plants_per_side: 32,
            near_ratio: 5.0,
            blade_segments: [0; 2],
            highest_detail: 3.0,
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
            flower_shape: FlowerShape::Modelled,
            tree_shape: TreeShape::Modelled,
            swing_hz: 1.55,
            swing_damping: 0.1,
            integrator: BladeIntegrator::Exact,
        }
    }
}
