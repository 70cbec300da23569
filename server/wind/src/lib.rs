//! Incompressible wind in a box of cells: the Navier–Stokes equations `∂u/∂t = −(u·∇)u + ν∇²u + f − ∇p`, `∇·u = 0` on a staggered grid, and
//! `∂ρ/∂t = −(u·∇)ρ + κ∇²ρ + S` for dust.
//!
//! Positions are in metres from the lower corner of the box, y up; y is the height above the ground. Start with [`Solver`] and [`Config`].
//!
//! | module | content |
//! |---|---|
//! | [`config`] | settings, their defaults and ranges |
//! | [`solver`], [`state`] | the solver; checkpoints, step reports and errors |
//! | [`air`], [`stable_fluids`] | one interface to both solvers; the collocated method of Zhang's thesis, as the baseline |
//! | [`checkpoint`] | complete copies, from which either solver continues bit for bit |
//! | [`grid`], [`field`], [`sample`] | staggered grid, fields, trilinear interpolation |
//! | [`boundary`] | boundary conditions, ghost values, solid cells |
//! | [`advect`], [`trajectory`] | advection schemes; the semi-Lagrangian family |
//! | [`transport`] | conservative fluxes by Runge–Kutta 3 |
//! | [`diffuse`] | explicit and implicit diffusion |
//! | [`pressure`], [`separable`] | projection by iteration (multigrid, conjugate gradients, relaxation) and by transforms |
//! | [`solids`] | immersed walls, moving bodies, drag of bodies and crowns |
//! | [`profile`], [`sources`], [`primitive`], [`intensity`], [`forcing`], [`canopy`], [`footprint`] | mean wind, gusts, flow primitives and their intensity over time, jets, grass drag, and the weights of local forces |
//! | [`diagnostics`] | speed, divergence, kinetic energy, finiteness |
//!
//! Kernels run in `f32` or `f64` ([`Real`]). Results are bit-identical on any number of threads.

pub mod advect;
pub mod air;
pub mod boundary;
pub mod canopy;
pub mod checkpoint;
pub mod config;
pub mod diagnostics;
pub mod diffuse;
mod dust;
pub mod field;
pub mod footprint;
pub mod forcing;
pub mod grid;
pub mod intensity;
mod limits;
mod named;
mod parallel;
pub mod pressure;
pub mod primitive;
pub mod profile;
mod real;
pub mod sample;
pub mod separable;
pub mod solids;
pub mod solver;
pub mod sources;
pub mod stable_fluids;
pub mod state;
mod step;
mod time_schemes;
pub mod trajectory;
pub mod transport;

pub use advect::Advection;
pub use air::{Air, Method};
pub use boundary::Boundary;
pub use canopy::{Canopy, CanopyMotion};
pub use checkpoint::AirState;
pub use config::{Config, ConfigError, Diffusion, Dust, Gusts, Profile, TimeScheme};
pub use field::{Field, Velocity};
pub use forcing::Jet;
pub use grid::{GHOST, Grid, Location};
pub use intensity::{Front, Intensity};
pub use pressure::Pressure;
pub use primitive::{Primitive, Shape};
pub use real::Real;
pub use solids::{Body, DragBody};
pub use solver::{Solver, WindSolver};
pub use stable_fluids::StableFluids;
pub use state::{SolidError, State, StateError, StepError, StepReport};

/// Compiles and runs the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
pub struct ReadmeExamples;
