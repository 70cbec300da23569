//! The wind: incompressible air with random gusts in a box of cells (000, chapter 2).
//!
//! The Navier–Stokes equations `∂u/∂t = −(u·∇)u + ν∇²u + f − ∇p`, `∇·u = 0` on a staggered grid, and `∂ρ/∂t = −(u·∇)ρ + κ∇²ρ + S` for dust.
//! Positions are metres from a lower corner of the box, y up; y is the height above the ground.
//!
//! | module | what it does |
//! |---|---|
//! | [`config`] | settings, their defaults and ranges |
//! | [`air`] | one face for both methods |
//! | [`stable_fluids`] | the method of 000 on a collocated grid, the baseline |
//! | [`solver`], [`step`], [`state`] | the state, the order of a step in each time scheme, saving and failing |
//! | [`grid`], [`field`], [`sample`], [`boundary`] | where values live, how they are read between, what faces and solid cells make of them |
//! | [`transport`] | conservative fluxes by Runge–Kutta 3 |
//! | [`trace`], [`advect`] | paths of the air; the semi-Lagrangian family |
//! | [`diffuse`] | friction, explicit and implicit |
//! | [`pressure`], [`separable`] | projection, by iteration and by transforms |
//! | [`profile`], [`sources`], [`primitive`], [`forcing`], [`canopy`], [`footprint`] | mean wind, gusts, simple winds, jets, grass, and the blobs they act on |
//! | [`health`] | Courant number, divergence, energy, finiteness |
//!
//! Kernels take a grid, slices and numbers, run in f32 or f64 ([`Real`]), share work among threads where it pays, and give the same bits on any number of
//! threads.

pub mod advect;
pub mod air;
pub mod boundary;
pub mod canopy;
pub mod config;
pub mod diffuse;
pub mod field;
pub mod footprint;
pub mod forcing;
pub mod grid;
pub mod health;
mod parallel;
pub mod pressure;
pub mod primitive;
pub mod profile;
mod real;
pub mod sample;
pub mod separable;
pub mod solver;
pub mod sources;
pub mod stable_fluids;
pub mod state;
pub mod step;
pub mod trace;
pub mod transport;

pub use air::{Air, Method};
pub use canopy::Canopy;
pub use config::{Advection, Config, ConfigError, Diffusion, Dust, Gusts, Profile, TimeScheme};
pub use field::{Field, Velocity};
pub use forcing::Jet;
pub use grid::{Boundary, GHOST, Grid, Place};
pub use pressure::Pressure;
pub use primitive::{Primitive, Shape};
pub use real::Real;
pub use solver::{Solver, WindSolver};
pub use stable_fluids::StableFluids;
pub use state::{SolidError, State, StateError, StepError, StepReport};
