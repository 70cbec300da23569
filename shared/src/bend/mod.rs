//! The bend field: grass as a 2-D continuum (Chen & Johan, Real-Time Continuum Grass, sections 4 and 5).
//!
//! A cell holds one cluster of grass: its bending angle θ (rad; 0 at rest) and its bending velocity ω = (ωx, ωz)
//! (rad/s), whose direction is the direction in which the cluster leans. Contact sets both ([`Field::press`]); the
//! damped wave equations (2)–(6), with a restoring rate κ, propagate them and return them to rest: with the Laplacian L,
//! `θ'' + k_θ·θ' + κ·θ = (c₀ + μ·|ω|)²·Lθ` and `ω'' + k_ω·ω' + κ·ω = c_ω²·Lω`. A [`Scheme`] integrates them in time;
//! the default, in the form in which a varying speed adds no energy. [`GroundContact`] keeps θ within a right angle.
//!
//! A [`Field`] is made of patches with a halo of ghost cells. The ghosts are filled before they are needed, so a field
//! of many patches equals one big grid bit for bit. A sleeping patch uses no memory and counts as at rest; in an awake one, only
//! 8 × 8 tiles that contain motion, and their neighbours, are stepped.
//!
//! The field is the deviation from the equilibrium lean in the wind, [`wind_lean_rad`]; both leans add up as vectors on the ground. So
//! the wind, known at the nodes of a coarse grid, wakes no patch and is not sent twice; a gust passes over a track without erasing it,
//! and grass recovers to its lean in the wind.
//!
//! # Example
//!
//! A standing wave between free edges, over 2 × 2 patches, is back after one period:
//!
//! ```
//! use prairie_core::bend::{Serial, Bend, Edges, Field, Kinds, Scheme, WaveParams};
//! use prairie_core::grid::PatchLayout;
//! use std::f32::consts::PI;
//!
//! let layout = PatchLayout { count: [2, 2], cells: 32, cell_m: 0.25 };
//! let waves = WaveParams {
//!     c0_m_per_s: 2.0,
//!     mu_m_per_rad: 0.0,
//!     c_omega_m_per_s: 2.0,
//!     theta_damping_per_s: 0.0,
//!     omega_damping_per_s: 0.0,
//!     stiffness_per_s2: 0.0,
//! };
//! let mut field = Field::new(layout, Kinds::one(waves)).with_edges(Edges::Free);
//! let (steps, width_m) = (800, 16.0);
//! let period_secs = 2.0 * width_m / 2.0;
//! let dt_secs = period_secs / steps as f32;
//! let wave = |x_m: f32, secs: f32| (PI * x_m / width_m).cos() * (2.0 * PI * secs / period_secs).cos();
//! field.start(dt_secs, |[x_m, _]| [0.0, -dt_secs].map(|secs| Bend { theta: 0.5 * wave(x_m, secs), omega: [0.0; 2] }));
//! assert!(dt_secs < field.stable_dt_secs(Scheme::Substepped));
//! for _ in 0..steps {
//!     field.step(Scheme::Substepped, dt_secs, &Serial)?;
//! }
//! for x_m in [0.1, 3.0, 12.0] {
//!     let Bend { theta, omega } = field.bend_at(x_m, 5.0);
//!     let cell_m = ((x_m / 0.25_f32).floor() + 0.5) * 0.25;
//!     assert!((theta - 0.5 * wave(cell_m, 0.0)).abs() < 1e-3 && omega == [0.0; 2]);
//! }
//! # Ok::<(), prairie_core::bend::StepError>(())
//! ```

mod checkpoint;
mod exchange;
mod executor;
mod field;
mod ground;
mod halo;
mod implicit;
mod kernel;
mod kinds;
pub mod limits;
#[cfg(feature = "modal")]
mod modal;
mod params;
mod patch;
mod sample;
mod scheme;
mod step;
mod tiles;
mod tridiagonal;
mod verlet;
mod wind;

pub use checkpoint::{FieldState, StateError};
pub use executor::{Executor, Serial};
pub use field::Field;
pub use ground::GroundContact;
pub use halo::{Edges, Seams};
pub use kinds::Kinds;
pub use params::{Coefficients, Damping, WaveParams};
pub use patch::{Bend, CHANNELS, HALO, Patch};
pub use sample::field_lean_at;
pub use scheme::{Report, Scheme, StepError};
pub use tiles::{Rest, TILE};
pub use wind::{BEND_SATURATES_M_PER_S, wind_lean_rad};
