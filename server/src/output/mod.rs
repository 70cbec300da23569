//! Fields and stations of a run as files: Zarr (the module `zarr`, with the feature of this name) with coordinates, units and attributes after the CF conventions, [VTK](vtk) for ParaView, and CSV of
//! [stations](StationFile).
//!
//! A [`Sampler`] takes the values out of the world; each [`Sink`] writes them into one kind of file, piece by piece, so that a run of any length fits into
//! memory.

mod error;
mod grids;
mod outputs;
mod replace;
#[cfg(any(feature = "zarr", test))]
mod rounding;
#[cfg(feature = "zarr")]
mod run_folder;
mod sampler;
mod sink;
mod stations;
mod variables;
pub mod vtk;
#[cfg(feature = "zarr")]
pub mod zarr;

pub use error::OutputError;
pub use grids::{Axis, Grid};
pub use outputs::Outputs;
pub use sampler::{Frame, Sampler, VALUES_LIMIT};
pub use sink::Sink;
pub use stations::{HEADER, Station, StationFile};
pub use variables::{ALLOWED_ERROR, Field, VARIABLES, Variable};
