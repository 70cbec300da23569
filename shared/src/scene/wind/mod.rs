//! The wind of a scene.

pub(super) mod check;
mod dust;
mod faces;
mod primitive;
mod words;

pub use dust::WindDust;
pub use faces::{WindBoundary, WindFaces};
pub use primitive::{Primitive, PrimitiveKind};
pub(crate) use words::words;
pub use words::{WindAdvection, WindDiffusion, WindMethod, WindPressure, WindTerrain, WindTiling, WindTime};

use serde::{Deserialize, Serialize};

/// The wind's box, what drives the wind in it, and how it is solved. The box repeats over the world along axes that wrap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Wind {
    /// Cells along X, Y and Z. Default 32 × 8 × 32, allowed 2..=256 each and 2097152 in all.
    pub cells: [u32; 3],
    /// Side of a cell along X, Y and Z (m). Default 8 × 2 × 8, allowed 0.1..=1000.
    pub spacing_m: [f32; 3],
    /// How the box serves the world: `box`, one over the scene that repeats where it wraps; `patch`, one small box for every patch,
    /// moved at random per patch (000 §5.1), a whole number of patches wide; `follow`, the box goes where the action is. `patch` and
    /// `follow` need all four sides to wrap. Default `box`.
    pub tiling: WindTiling,
    /// What the land is to the wind: `follow`, the box's floor follows it; `obstacle`, it is solid cells in a box of absolute
    /// height, which needs an iterative `pressure`, a `diffusion` that is not direct, and `tiling = "box"`. Default `follow`.
    pub terrain: WindTerrain,
    /// Prevailing wind along X and Z at the height of the lowest cells' tops ×5 (m/s). Default (4, 2.5), allowed
    /// −40..=40 each and a length of at most 40; 0 across closed faces.
    pub mean_m_per_s: [f32; 2],
    /// Rate at which the mean flow returns to the prevailing wind (1/s). Default 0.2, allowed 0..=10.
    pub mean_rate_per_s: f32,
    /// Kinematic (eddy) viscosity ν (m²/s). Default 0.2, allowed 0..=100.
    pub viscosity_m2_per_s: f32,
    /// C_d·a of standing grass (1/m): the canopy takes `C_d·a·‖u‖·u` from the wind (Py, de Langre & Moulia, J. Fluid Mech. 2006).
    /// Default 0.1, allowed 0..=10; 0 with the method `stable-fluids`, which has no canopy.
    pub canopy_drag_per_m: f32,
    /// Force on all air along X and Z, per mass (m/s²). Default (0, 0), allowed −1..=1 each.
    pub body_force_m_per_s2: [f32; 2],
    /// Number of random source cells that blow at any moment (000 §2.3.1). Default 24, allowed 0..=1000 and
    /// at most the box's cells.
    pub sources: u32,
    /// Greatest speed that a source gives over its life (m/s). Default 14, allowed 0..=40.
    pub source_m_per_s: f32,
    /// The solver: `staggered`, or `stable-fluids`, the collocated method of 000, for comparison. Default `staggered`.
    pub method: WindMethod,
    /// How the wind carries itself: `semi-lagrangian` (first order), `mac-cormack`, `bfecc` or `conservative` (second order).
    /// Default `conservative`; `semi-lagrangian` with `stable-fluids`, which has no other.
    pub advection: WindAdvection,
    /// How the parts of a step follow each other: `split` (first order), `reflection` (second order, not with `conservative`) or
    /// `runge-kutta-3` (second order, only with `conservative`). Default `runge-kutta-3`; `split` with `stable-fluids`, which has no
    /// other.
    pub time: WindTime,
    /// How viscosity acts: `explicit`, `gauss-seidel`, `implicit` or `crank-nicolson`. Default `explicit`; `gauss-seidel` with
    /// `stable-fluids`, which has no other.
    pub diffusion: WindDiffusion,
    /// Most sweeps of `gauss-seidel` diffusion. Default 20 (000), allowed 1..=1000.
    pub diffusion_sweeps: u32,
    /// How the pressure is found: `direct`, `jacobi`, `gauss-seidel`, `sor`, `conjugate-gradients` or `multigrid`. Default `direct`;
    /// `gauss-seidel` with `stable-fluids`, which has no other.
    pub pressure: WindPressure,
    /// Relative rms residual at which an iterative `pressure` is good enough. Default 1e-5, allowed 1e-12..=0.1.
    pub pressure_tolerance: f32,
    /// Most sweeps or cycles of an iterative `pressure`. Default 200, allowed 1..=100000; by default 20 with `stable-fluids` (000).
    pub pressure_sweeps: u32,
    /// Flow primitives, superposed, each a section `[[wind.primitives]]`. Default none, allowed at most 64.
    pub primitives: Vec<Primitive>,
    /// What the faces of the box do.
    pub faces: WindFaces,
    /// Dust and seed in the air.
    pub dust: WindDust,
}

impl Default for Wind {
    fn default() -> Self {
        Self {
            cells: [32, 8, 32],
            spacing_m: [8.0, 2.0, 8.0],
            tiling: WindTiling::Box,
            terrain: WindTerrain::Follow,
            mean_m_per_s: [4.0, 2.5],
            mean_rate_per_s: 0.2,
            viscosity_m2_per_s: 0.2,
            canopy_drag_per_m: 0.1,
            body_force_m_per_s2: [0.0; 2],
            sources: 24,
            source_m_per_s: 14.0,
            method: WindMethod::Staggered,
            advection: WindAdvection::Conservative,
            time: WindTime::RungeKutta3,
            diffusion: WindDiffusion::Explicit,
            diffusion_sweeps: 20,
            pressure: WindPressure::Direct,
            pressure_tolerance: 1e-5,
            pressure_sweeps: 200,
            primitives: Vec::new(),
            faces: WindFaces::default(),
            dust: WindDust::default(),
        }
    }
}

impl Wind {
    /// The defaults of a method: what a scene file that names it leaves unsaid.
    pub fn of(method: WindMethod) -> Self {
        match method {
            WindMethod::Staggered => Self::default(),
            WindMethod::StableFluids => Self {
                method,
                advection: WindAdvection::SemiLagrangian,
                time: WindTime::Split,
                diffusion: WindDiffusion::GaussSeidel,
                pressure: WindPressure::GaussSeidel,
                pressure_sweeps: 20,
                canopy_drag_per_m: 0.0,
                dust: WindDust { advection: WindAdvection::SemiLagrangian, ..WindDust::default() },
                ..Self::default()
            },
        }
    }

    /// Extent of the box along X, Y and Z (m).
    pub fn box_m(&self) -> [f32; 3] {
        std::array::from_fn(|axis| self.cells[axis] as f32 * self.spacing_m[axis])
    }
}
