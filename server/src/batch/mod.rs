//! Runs without clients, as fast as possible: a world, the inputs of its drivers, and the files of its results.
//!
//! A run is a sequence of commands and steps, as a server makes them, and gives the same bits.

mod drive_file;
mod drivers;

pub use drive_file::{DriveFileError, Driver, read as read_drivers};
pub use drivers::{Drivers, Refused};

use crate::output::{OutputError, Outputs};
use crate::world::World;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use thiserror::Error;

/// Length of a run, and when it writes, in steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Schedule {
    /// Number of steps.
    pub ticks: u64,
    /// Steps from one writing of the fields to the next, at least 1.
    pub ticks_per_frame: u64,
    /// Steps from one row of the stations to the next, at least 1.
    pub ticks_per_row: u64,
}

/// Reasons why a run ends early.
#[derive(Debug, Error)]
pub enum BatchError {
    /// A result cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A vehicle is refused.
    #[error(transparent)]
    Refused(#[from] Refused),
}

/// Steps a world up to the end of the schedule, or until `stop` is set, and writes its state before the first step and after the steps that are due. The files
/// are complete when it returns, also after an error. `progress` is told the number of steps so far. Returns it in the end.
///
/// # Errors
/// [`BatchError`] when a file cannot be written, or the world refuses a vehicle.
pub fn run(
    world: &mut World,
    drivers: &mut Drivers,
    schedule: Schedule,
    mut outputs: Outputs,
    stop: &AtomicBool,
    progress: impl FnMut(u64),
) -> Result<u64, BatchError> {
    let outcome = step_and_write(world, drivers, schedule, &mut outputs, stop, progress);
    let finished = outputs.finish();
    let ticks = outcome?;
    finished?;
    Ok(ticks)
}

fn step_and_write(
    world: &mut World,
    drivers: &mut Drivers,
    schedule: Schedule,
    outputs: &mut Outputs,
    stop: &AtomicBool,
    mut progress: impl FnMut(u64),
) -> Result<u64, BatchError> {
    let mut ticks = 0_u64;
    loop {
        if ticks.is_multiple_of(schedule.ticks_per_row) {
            outputs.write_stations(world)?;
        }
        if ticks.is_multiple_of(schedule.ticks_per_frame) {
            outputs.write_fields(world)?;
        }
        progress(ticks);
        if ticks == schedule.ticks || stop.load(Relaxed) {
            return Ok(ticks);
        }
        let commands = drivers.commands(world);
        world.step(&commands);
        ticks += 1;
        drivers.check_arrivals(world)?;
    }
}
