//! `prairie run`: simulates a scene without a page, as fast as possible, and writes its fields.

use super::print::print;
use super::stop_signal::stop_flag;
use anyhow::{Context as _, Result, ensure};
use clap::{Args, ValueHint};
use prairie::batch::{Drivers, Schedule, read_drivers, run};
use prairie::escaped::escaped;
use prairie::output::vtk::VtkFolder;
use prairie::output::{ALLOWED_ERROR, Field, Outputs, Sampler, Sink, Station, StationFile};
use prairie::plan::Line;
use prairie::scenes::{self, LoadedScene};
use prairie::world::World;
use std::ffi::OsString;
use std::path::PathBuf;
use std::time::Instant;

pub(super) const EXAMPLES: &str = "\
Examples:
  prairie run meadow --seconds 60 --out run.zarr
                                             fields once a second, for xarray
  prairie run meadow --drive car.toml --out run.zarr --every 0.1 --fields bend,bend-velocity
                                             the grass behind a car, ten times a second
  prairie run storm --out run.zarr --error wind=0.01,bend=0.001
                                             rounded to 0.01 m/s and 0.001 rad
  prairie run meadow --station west=40,128 --station east=200,128 --stations masts.csv
                                             two places, each step
  prairie run storm --seconds 10 --every 0.25 --vtk storm
                                             storm/air.pvd and others, for ParaView

Fields:
  wind           u, v, w at the centres of the solver's cells (m/s)
  dust           its concentration there, in scenes that release some
  ground-wind    wind at the height of the grass with all its gusts, every 8 cells of grass (m/s)
  bend           bending angle theta of each cell of grass, relative to its lean in the wind (rad)
  bend-velocity  bending velocity omega_x, omega_z, in the direction of the bend (rad/s)
  lean           lean_x, lean_z, the whole lean of the grass with that in the wind (rad)

A drive file lists drivers with their inputs, each of which holds until the next:
  [[driver]]
  vehicle = \"car\"                            or monster, helicopter, sled, ball, walker
  at_m = [60.0, 128.0]                       X and Z at which it appears, heading east
  from_secs = 0.0                            when it appears
  inputs = [
    { at_secs = 1.0, throttle = 0.8 },       throttle, steer and lift from -1 to 1
    { at_secs = 9.0, brake = 1.0 },          brake from 0 to 1
  ]

The result is that of a server that receives the same inputs at the same steps, to the last bit, on
any number of threads. After Ctrl-C the files can be read up to the last frame.";

/// Arguments of `prairie run`.
#[derive(Debug, Args)]
pub(super) struct Run {
    /// Built-in scene (`prairie scenes` lists them) or scene file
    #[arg(value_name = "SCENE", value_hint = ValueHint::FilePath)]
    scene: OsString,
    /// Simulated time (s), above 0 to 1000000, rounded to whole steps
    #[arg(long, value_name = "N", default_value_t = 60.0, value_parser = seconds)]
    seconds: f64,
    /// Drivers with timed inputs (TOML)
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    drive: Option<PathBuf>,
    /// Write the fields into a Zarr v3 store, a folder
    #[arg(long, value_name = "PATH", value_hint = ValueHint::DirPath)]
    out: Option<PathBuf>,
    /// Write the fields as VTK ImageData into a folder
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath)]
    vtk: Option<PathBuf>,
    /// Simulated time between two writings of the fields (s), rounded to whole steps
    #[arg(long, value_name = "SECS", default_value_t = 1.0, value_parser = seconds)]
    every: f64,
    /// Fields, listed below, with commas [default: all but lean; dust where there is some]
    #[arg(long, value_name = "FIELD", value_delimiter = ',', value_parser = field)]
    fields: Vec<Field>,
    /// Round a field in the Zarr store by at most this much, in its unit [default: all bits]. Repeatable, or with commas
    #[arg(long, value_name = "FIELD=ERROR", value_delimiter = ',', value_parser = error, requires = "out")]
    error: Vec<(Field, f32)>,
    /// Watch the wind and the grass at a place (m: X, Z). Repeatable
    #[arg(long, value_name = "NAME=X,Z", requires = "stations")]
    station: Vec<Station>,
    /// Write the stations into a CSV file
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath, requires = "station")]
    stations: Option<PathBuf>,
    /// Simulated time between two rows of a station (s), rounded to whole steps [default: each step]
    #[arg(long, value_name = "SECS", value_parser = seconds, requires = "stations")]
    station_every: Option<f64>,
    /// Replace files of an earlier run
    #[arg(long)]
    overwrite: bool,
}

impl Run {
    pub(super) fn run(&self) -> Result<()> {
        ensure!(self.out.is_none() || cfg!(feature = "zarr"), "--out: this binary was built without Zarr; build it with `--features zarr`");
        let loaded = scenes::load(&self.scene)?;
        let drivers = self.drive.as_ref().map(|path| read_drivers(path, &loaded.scene)).transpose()?.unwrap_or_default();
        let mut drivers = Drivers::new(&drivers, loaded.scene.tick_hz);
        let mut world = World::new(&loaded.scene, loaded.maps()).context("the scene makes no world")?;
        // From here on a signal ends the run in good order; before, nothing is written.
        let stop = stop_flag()?;
        let outputs = self.outputs(&loaded)?;
        let schedule = self.schedule(loaded.scene.tick_hz);
        let (begun, mut bar) = (Instant::now(), Bar::new(schedule.ticks, loaded.scene.dt_secs()));
        let ticks = run(&mut world, &mut drivers, schedule, outputs, &stop, |ticks| bar.show(ticks))?;
        drop(bar);
        let (secs, took_secs) = (ticks as f64 * f64::from(loaded.scene.dt_secs()), begun.elapsed().as_secs_f64());
        print(format_args!(
            "{}: {secs:.3} s in {took_secs:.2} s, {:.1} times real time\nsteps 0 to {ticks}, checksum {:016x}",
            escaped(&loaded.name),
            secs / took_secs,
            world.checksum()
        ))?;
        ensure!(ticks == schedule.ticks, "stopped by a signal after {secs:.3} of {} s; the files can be read up to there", self.seconds);
        Ok(())
    }

    fn schedule(&self, tick_hz: f32) -> Schedule {
        let ticks = |secs: f64| ((secs * f64::from(tick_hz)).round() as u64).max(1);
        Schedule { ticks: ticks(self.seconds), ticks_per_frame: ticks(self.every), ticks_per_row: self.station_every.map_or(1, ticks) }
    }

    /// Opens all files, before anything takes time.
    fn outputs(&self, loaded: &LoadedScene) -> Result<Outputs> {
        let fields = if self.fields.is_empty() { Field::usual(&loaded.scene) } else { self.fields.clone() };
        if let Some((field, _)) = self.error.iter().find(|(field, _)| !fields.contains(field)) {
            anyhow::bail!("--error: `{field}` is not written; --fields names what is");
        }
        let mut outputs = Outputs::default();
        // First, since its stations may be wrong, which nothing else has to be replaced for.
        if let Some(file) = &self.stations {
            outputs = outputs.with_stations(StationFile::create(file, loaded, &self.station, self.overwrite)?);
        }
        if self.out.is_some() || self.vtk.is_some() {
            let sampler = Sampler::new(loaded, &fields)?;
            let mut sinks: Vec<Box<dyn Sink>> = Vec::new();
            sinks.extend(self.zarr(loaded, &sampler)?);
            if let Some(folder) = &self.vtk {
                sinks.push(Box::new(VtkFolder::create(folder, loaded, &sampler, self.overwrite)?));
            }
            outputs = outputs.with_fields(sampler, sinks)?;
        }
        Ok(outputs)
    }

    #[cfg(feature = "zarr")]
    fn zarr(&self, loaded: &LoadedScene, sampler: &Sampler) -> Result<Option<Box<dyn Sink>>> {
        use prairie::output::zarr::ZarrStore;
        let Some(path) = &self.out else { return Ok(None) };
        let errors = self.error.iter().copied().collect();
        Ok(Some(Box::new(ZarrStore::create(path, loaded, sampler, &errors, self.overwrite)?)))
    }

    /// None: `run` has refused the option.
    #[cfg(not(feature = "zarr"))]
    #[expect(clippy::unnecessary_wraps, clippy::unused_self, reason = "as with Zarr")]
    fn zarr(&self, _: &LoadedScene, _: &Sampler) -> Result<Option<Box<dyn Sink>>> {
        Ok(None)
    }
}

/// Progress on a terminal, with the factor of real time.
struct Bar {
    line: Line,
    begun: Instant,
    shown: Option<Instant>,
    ticks: u64,
    dt_secs: f32,
}

impl Bar {
    /// Shortest time between two drawings (s).
    const EVERY_SECS: f32 = 0.1;

    fn new(ticks: u64, dt_secs: f32) -> Self {
        Self { line: Line::default(), begun: Instant::now(), shown: None, ticks, dt_secs }
    }

    fn show(&mut self, ticks: u64) {
        if self.shown.is_none_or(|shown| shown.elapsed().as_secs_f32() >= Self::EVERY_SECS) {
            self.shown = Some(Instant::now());
            let speed = ticks as f32 * self.dt_secs / self.begun.elapsed().as_secs_f32().max(1e-3);
            self.line.bar(&format!("{speed:.1} times real time"), ticks as usize, self.ticks as usize);
        }
    }
}

fn seconds(text: &str) -> Result<f64, &'static str> {
    text.parse().ok().filter(|secs| *secs > 0.0 && *secs <= 1e6).ok_or("allowed: above 0 to 1000000")
}

fn field(text: &str) -> Result<Field, String> {
    text.parse()
}

fn error(text: &str) -> Result<(Field, f32), String> {
    let (field, error) = text.split_once('=').ok_or("expected FIELD=ERROR, such as wind=0.01")?;
    let error = error.parse().ok().filter(|error| ALLOWED_ERROR.contains(error));
    let (least, most) = (ALLOWED_ERROR.start(), ALLOWED_ERROR.end());
    Ok((field.parse()?, error.ok_or_else(|| format!("allowed: an error from {least} to {most}, in the unit of the field"))?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_belong_to_fields_and_are_in_range() {
        assert_eq!(error("wind=0.01"), Ok((Field::Wind, 0.01)));
        assert!(error("u=0.01").unwrap_err().starts_with("allowed: wind, dust"));
        for wrong in ["wind", "wind=", "wind=0", "wind=-1", "wind=nan", "wind=1e4"] {
            assert!(error(wrong).is_err(), "{wrong}");
        }
        assert!(seconds("0").is_err() && seconds("inf").is_err() && seconds("0.25") == Ok(0.25));
    }
}
