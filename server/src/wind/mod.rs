//! The wind: incompressible air with random gusts in a box of cells (000, chapter 2).
//!
//! The Navier–Stokes equations `∂u/∂t = −(u·∇)u + ν∇²u + f − ∇p`, `∇·u = 0` on a staggered grid, and `∂ρ/∂t = −(u·∇)ρ + κ∇²ρ + S` for dust. A step
//! ([`Solver::step`]) is: advect, push (sources, jets, mean wind), close walls, diffuse, project, measure. Positions are metres from a lower corner of the
//! box, y up; y is the height above the ground.
//!
//! | module | what it does |
//! |---|---|
//! | [`config`] | settings, their defaults and ranges |
//! | [`solver`] | the state and the order of a step |
//! | [`grid`], [`field`], [`sample`] | where values live and how they are read between |
//! | [`trace`], [`advect`] | paths of the air, carrying fields along them |
//! | [`diffuse`] | explicit diffusion and its limit |
//! | [`pressure`] | direct projection by cosine and Hartley transforms |
//! | [`boundary`] | walls |
//! | [`profile`], [`sources`], [`forcing`], [`footprint`] | mean wind, gusts, jets, and the blobs they act on |
//! | [`health`] | Courant number, divergence, energy, finiteness |
//!
//! Kernels take a grid, slices and numbers, run in f32 or f64 ([`Real`]), share work among threads where it pays, and give the same bits on any number of
//! threads.

pub mod advect;
pub mod boundary;
pub mod config;
pub mod diffuse;
pub mod field;
pub mod footprint;
pub mod forcing;
pub mod grid;
pub mod health;
mod parallel;
pub mod pressure;
pub mod profile;
mod real;
pub mod sample;
pub mod solver;
pub mod sources;
pub mod trace;

pub use config::{Advection, Config, ConfigError, Dust, Gusts, Profile};
pub use field::{Field, Velocity};
pub use forcing::Jet;
pub use grid::{Boundary, Grid, Place};
pub use real::Real;
pub use solver::{Solver, State, StateError, StepError, StepReport, WindSolver};
