//! The wind of a scene.

pub(super) mod check;
mod dust;
mod faces;
mod intensity;
mod primitive;
mod words;

pub use dust::WindDust;
pub use faces::{WindBoundary, WindFaces};
pub use intensity::PrimitiveIntensity;
pub use primitive::{Primitive, PrimitiveKind};
pub(crate) use words::words;
pub use words::{WindAdvection, WindDiffusion, WindMethod, WindPressure, WindTerrain, WindTiling, WindTime};

use serde::{Deserialize, Serialize};

/// The wind: the solver's box, forcing and schemes. The box repeats over the world along periodic axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Wind {
    /// Cells along X, Y and Z. Default 32 × 8 × 32, allowed 2..=256 each and 2097152 in all.
    pub cells: [u32; 3],
    /// Side of a cell along X, Y and Z (m). Default 8 × 2 × 8, allowed 0.1..=1000.
    pub spacing_m: [f32; 3],
    /// How the box covers the world: `box`, one box over the scene that repeats where it is periodic; `patch`, one small box for every
    /// patch, with a random offset per patch (Zhang §5.1), a whole number of patches wide; `follow`, a box that follows the objects.
    /// `patch` and `follow` need all four sides to be `wrap`. Default `box`.
    pub tiling: WindTiling,
    /// How the wind treats the land: `follow`, the floor of the box follows it; `obstacle`, the air of a box of
    /// absolute height flows round it, which needs `explicit` or `gauss-seidel` diffusion and `tiling = "box"`: with the `direct` pressure solver the land is a wall
    /// immersed at its slope, with an iterative one it is solid cells. Default `follow`.
    pub terrain: WindTerrain,
    /// Prevailing wind along X and Z at the height `reference_height_m` (m/s). Default (4, 2.5), allowed
    /// −40..=40 each and a length of at most 40; 0 across closed faces.
    pub mean_m_per_s: [f32; 2],
    /// Height at which the prevailing wind blows (m); below it is weaker, by a logarithmic profile. Default 0, five cells; allowed 0..=1000.
    pub reference_height_m: f32,
    /// Rate at which the mean flow relaxes to the prevailing wind (1/s). Default 0.2, allowed 0..=10.
    pub mean_rate_per_s: f32,
    /// Kinematic (eddy) viscosity ν (m²/s). Default 0.2, allowed 0..=100.
    pub viscosity_m2_per_s: f32,
    /// C_d·a of standing grass (1/m): the canopy drag is `−C_d·a·‖u‖·u` (Py et al. 2006).
    /// Default 0.1, allowed 0..=10; 0 with the method `stable-fluids`, which has no canopy.
    pub canopy_drag_per_m: f32,
    /// Natural frequency of standing grass (Hz). Where it is above 0, the grass sways in the wind and acts back on it: the drag is that on the relative velocity
    /// (Py et al. 2006), and waves are drawn to this frequency where some eight cells per height of the grass resolve them. Pictures show it by the wind alone.
    /// Alfalfa has 1.05, wheat 2.5. Default 0, grass that holds still; allowed 0..=20.
    pub canopy_frequency_hz: f32,
    /// Damping ratio of standing grass that sways, apart from its drag. Default 0.05, allowed 0..=2.
    pub canopy_damping_ratio: f32,
    /// Mass of standing grass that sways, per area of ground (kg/m²). Default 2, allowed 0.01..=100.
    pub canopy_mass_kg_per_m2: f32,
    /// C_d·a of the crowns of trees (1/m), a being their leaf area density: their drag is `−C_d·a·‖u‖·u`, averaged over the cells that a crown touches (Shaw &
    /// Schumann 1992). Leaves have a C_d of about 0.2, crowns 1 to 2 m²/m³ of them. Default 0, no drag; allowed 0..=10; 0 with the method `stable-fluids` or
    /// `tiling = "patch"`.
    pub crown_drag_per_m: f32,
    /// Uniform body force along X and Z, per mass (m/s²). Default (0, 0), allowed −1..=1 each.
    pub body_force_m_per_s2: [f32; 2],
    /// Number of random gusts at any moment (Zhang §2.3.1). Default 24, allowed 0..=1000 and at most the number of cells.
    pub sources: u32,
    /// Speed that the strongest gust gives the air over its life (m/s). Default 14, allowed 0..=40.
    pub source_m_per_s: f32,
    /// Half-widths of a gust along X, Y and Z (m), of which those below the size of a cell count as that. Default (0, 0, 0), 1.75 × 2.5 × 1.75 cells; allowed
    /// 0..=1000 each.
    pub source_radius_m: [f32; 3],
    /// Strength of the gusts that the cells do not resolve, relative to a neutral surface layer (`wind/turbulence.rs`); 0 turns them off.
    /// Default 1, allowed 0..=3.
    pub turbulence: f32,
    /// Longest wavelength of the gusts that the cells do not resolve (m). Default 0, seven of the larger sides of a cell; allowed 0..=10000.
    pub turbulence_below_m: f32,
    /// Least duration of a step of the solver (s): a step is the smallest whole number of ticks that takes at least this long. Default 0.05, allowed 0.004..=0.5.
    pub step_secs: f32,
    /// Time for which the wind blows before the world starts (s). Default 0, 120 steps of the solver, or fewer of a box of more than 8738 cells; allowed 0..=60.
    pub warm_up_secs: f32,
    /// The solver: `staggered`, or `stable-fluids`, the collocated method of Zhang, for comparison. Default `staggered`.
    pub method: WindMethod,
    /// Advection scheme of the wind. Default `conservative`; only `semi-lagrangian` with `stable-fluids`.
    pub advection: WindAdvection,
    /// Time scheme: `split` (first order), `reflection` (second order, not with `conservative`) or `runge-kutta-3` (second order, only
    /// with `conservative`). Default `runge-kutta-3`; only `split` with `stable-fluids`.
    pub time: WindTime,
    /// Diffusion scheme: `explicit`, `gauss-seidel`, `implicit` or `crank-nicolson`. Default `explicit`; only `gauss-seidel` with
    /// `stable-fluids`.
    pub diffusion: WindDiffusion,
    /// Number of sweeps of `gauss-seidel` diffusion. Default 20 (Zhang), allowed 1..=1000.
    pub diffusion_sweeps: u32,
    /// Pressure solver: `direct`, `jacobi`, `gauss-seidel`, `sor`, `conjugate-gradients` or `multigrid`. Default `direct`; only
    /// `gauss-seidel` with `stable-fluids`.
    pub pressure: WindPressure,
    /// Relative rms residual at which an iterative `pressure` stops. Default 1e-5, allowed 1e-12..=0.1.
    pub pressure_tolerance: f32,
    /// Maximum number of sweeps or cycles of an iterative `pressure`. Default 200, allowed 1..=100000; by default 20 with `stable-fluids`.
    pub pressure_sweeps: u32,
    /// Superposed flow primitives, each a section `[[wind.primitives]]`. Default none, allowed at most 64.
    pub primitives: Vec<Primitive>,
    /// Boundary conditions of the box.
    pub faces: WindFaces,
    /// Dust in the air.
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
            reference_height_m: 0.0,
            mean_rate_per_s: 0.2,
            viscosity_m2_per_s: 0.2,
            canopy_drag_per_m: 0.1,
            canopy_frequency_hz: 0.0,
            canopy_damping_ratio: 0.05,
            canopy_mass_kg_per_m2: 2.0,
            crown_drag_per_m: 0.0,
            body_force_m_per_s2: [0.0; 2],
            sources: 24,
            source_m_per_s: 14.0,
            source_radius_m: [0.0; 3],
            turbulence: 1.0,
            turbulence_below_m: 0.0,
            step_secs: 0.05,
            warm_up_secs: 0.0,
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
    /// The defaults of a method, for fields that a scene file omits.
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

    /// Height (m) at which the prevailing wind blows: `reference_height_m`, or five cells.
    pub fn reference_m(&self) -> f32 {
        if self.reference_height_m > 0.0 { self.reference_height_m } else { 5.0 * self.spacing_m[1] }
    }

    /// Half-widths (m) of a gust: `source_radius_m`, or multiples of the cells.
    pub fn gust_radius_m(&self) -> [f32; 3] {
        let of_cells = [1.75, 2.5, 1.75];
        std::array::from_fn(|axis| match self.source_radius_m[axis] {
            radius_m if radius_m > 0.0 => radius_m,
            _ => of_cells[axis] * self.spacing_m[axis],
        })
    }

    /// Extent of the box along X, Y and Z (m).
    pub fn box_m(&self) -> [f32; 3] {
        std::array::from_fn(|axis| self.cells[axis] as f32 * self.spacing_m[axis])
    }
}
