//! Fields and stations of a run as files: [Zarr](zarr) with coordinates, units and attributes after the CF conventions, [VTK](vtk) for ParaView, and CSV of
//! [stations](StationFile).
//!
//! A [`Sampler`] takes the values out of the world; each [`Sink`] writes them into one kind of file, piece by piece, so that a run of any length fits into
//! memory.

mod error;
mod grids;
mod replace;
mod rounding;
mod sampler;
mod stations;
mod variables;
pub mod vtk;
#[cfg(feature = "zarr")]
pub mod zarr;

pub use error::OutputError;
pub use grids::{Axis, Grid};
pub use rounding::ALLOWED_ERROR;
pub use sampler::{Frame, Sampler, VALUES_LIMIT};
pub use stations::{HEADER, Station, StationFile};
pub use variables::{Field, VARIABLES, Variable};

use crate::world::World;

/// A kind of file that takes frames.
pub trait Sink {
    /// Writes the values of the sampler's variables at a later time than before.
    ///
    /// # Errors
    /// When a file cannot be written.
    fn write(&mut self, frame: &Frame) -> Result<(), OutputError>;

    /// Completes the files, which can be read up to the newest frame.
    ///
    /// # Errors
    /// When a file cannot be written.
    fn finish(self: Box<Self>) -> Result<(), OutputError>;
}

/// All files of a run.
#[derive(Default)]
pub struct Outputs {
    /// Takes the values of the fields.
    pub sampler: Option<Sampler>,
    /// Where they go.
    pub sinks: Vec<Box<dyn Sink>>,
    /// Stations.
    pub stations: Option<StationFile>,
}

impl Outputs {
    /// Writes the present fields.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub fn write_fields(&mut self, world: &World) -> Result<(), OutputError> {
        if let (Some(sampler), false) = (&self.sampler, self.sinks.is_empty()) {
            let frame = sampler.sample(world);
            self.sinks.iter_mut().try_for_each(|sink| sink.write(&frame))?;
        }
        Ok(())
    }

    /// Writes the present values at the stations.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write_stations(&mut self, world: &World) -> Result<(), OutputError> {
        self.stations.as_mut().map_or(Ok(()), |stations| stations.write(world))
    }

    /// Completes all files, also after one that fails.
    ///
    /// # Errors
    /// The first error.
    pub fn finish(self) -> Result<(), OutputError> {
        let finished: Vec<_> = self.sinks.into_iter().map(Sink::finish).collect();
        self.stations.map_or(Ok(()), StationFile::finish).and(finished.into_iter().collect())
    }
}
