//! Stations: places whose wind and grass are written step by step, as one CSV file.

use super::error::OutputError;
use super::replace::new_file;
use crate::scenes::LoadedScene;
use crate::world::World;
use prairie_core::bend::Bend;
use prairie_core::grass::BendSimulation;
use prairie_core::grass::grass_properties::GrassProperties;
use prairie_core::grass::grass_state::published;
use prairie_core::terrain::HeightMap;
use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Columns of the file.
pub const HEADER: &str = "time_s,station,x_m,z_m,ground_m,height_m,wind_u_m_per_s,wind_v_m_per_s,wind_w_m_per_s,\
                          lean_rad,lean_heading_deg,bend_rad,bend_velocity_x_rad_per_s,bend_velocity_z_rad_per_s";

/// Longest name of a station (characters).
const NAME_LIMIT: usize = 64;

/// A place that is watched.
#[derive(Clone, Debug, PartialEq)]
pub struct Station {
    /// Its name.
    pub name: String,
    /// Position along X and Z (m).
    pub at_m: [f32; 2],
}

impl FromStr for Station {
    type Err = &'static str;

    /// A station from `NAME=X,Z`.
    fn from_str(text: &str) -> Result<Self, &'static str> {
        let wrong = "expected NAME=X,Z, such as west=40,128.5: a name of up to 64 letters, digits, - and _, and two numbers of metres";
        let (name, place) = text.rsplit_once('=').ok_or(wrong)?;
        let (x, z) = place.split_once(',').ok_or(wrong)?;
        let number = |text: &str| text.trim().parse::<f32>().ok().filter(|m| m.is_finite()).ok_or(wrong);
        let is_name = (1..=NAME_LIMIT).contains(&name.chars().count()) && name.chars().all(|c| c.is_alphanumeric() || "-_".contains(c));
        if !is_name {
            return Err(wrong);
        }
        Ok(Self { name: name.to_owned(), at_m: [number(x)?, number(z)?] })
    }
}

/// The file of all stations.
pub struct StationFile {
    path: PathBuf,
    file: BufWriter<File>,
    stations: Vec<Site>,
    dt_secs: f64,
}

/// A station with what does not change there.
struct Site {
    station: Station,
    /// Elevation of the ground, and height of the grass (m).
    ground_m: f32,
    height_m: f32,
}

impl StationFile {
    /// A file with its header.
    ///
    /// # Errors
    /// When two stations have the same name, one is not on the land, or the file cannot be written; when it exists unless `overwrite`.
    pub fn create(path: &Path, loaded: &LoadedScene, stations: &[Station], overwrite: bool) -> Result<Self, OutputError> {
        let extent_m = loaded.scene.extent_m();
        for (number, Station { name, at_m }) in stations.iter().enumerate() {
            if (0..2).any(|axis| !(0.0..extent_m[axis]).contains(&at_m[axis])) {
                return Err(OutputError::Station { name: name.clone(), at_m: *at_m, extent_m });
            }
            if stations[..number].iter().any(|other| other.name == *name) {
                return Err(OutputError::SameName(name.clone()));
            }
        }
        let properties = GrassProperties::new(&loaded.scene, &loaded.cover);
        let site = |station: &Station| Site {
            station: station.clone(),
            ground_m: ground_m(&loaded.height, station.at_m),
            height_m: properties.blade_height_m(station.at_m),
        };
        let mut file = BufWriter::new(new_file(path, overwrite, "file of stations", HEADER)?);
        writeln!(file, "{HEADER}").map_err(OutputError::file(path))?;
        let stations = stations.iter().map(site).collect();
        Ok(Self { path: path.to_owned(), file, stations, dt_secs: f64::from(loaded.scene.dt_secs()) })
    }

    /// Writes a row for each station. Numbers have the digits that are needed to read the same value again.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&mut self, world: &World) -> Result<(), OutputError> {
        let (wind, bend) = (world.weather().field(), world.bend());
        let time_secs = world.tick() as f64 * self.dt_secs;
        for Site { station: Station { name, at_m: [x, z] }, ground_m, height_m } in &self.stations {
            let [u, v, w] = wind.wind_at([*x, *height_m, *z]);
            let [east, south] = bend.lean_rad([*x, *z], wind);
            let Bend { theta, omega: [omega_x, omega_z] } = bend_at(bend, [*x, *z]);
            let (lean_rad, heading_deg) = (east.hypot(south), heading_deg([east, south]));
            let row = format_args!(
                "{time_secs},{name},{x},{z},{ground_m},{height_m},{u},{v},{w},{lean_rad},{heading_deg},{theta},{omega_x},{omega_z}"
            );
            writeln!(self.file, "{row}").map_err(OutputError::file(&self.path))?;
        }
        Ok(())
    }

    /// Writes what is still in memory.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn finish(mut self) -> Result<(), OutputError> {
        self.file.flush().map_err(OutputError::file(&self.path))
    }
}

/// Bend of the cell at a position, bend field and flattened grass together, as the fields have it.
fn bend_at(bend: &BendSimulation, at_m: [f32; 2]) -> Bend {
    let cell = at_m.map(|m| (m / bend.field().layout().cell_m).floor() as i64);
    let in_field = bend.field().cell(cell);
    let flattened_rad = bend.field().locate(cell).map_or([0.0; 2], |(patch, [i, j])| bend.flattened().lean_rad(patch, i, j));
    if flattened_rad == [0.0; 2] { in_field } else { published(in_field, flattened_rad) }
}

fn ground_m(height: &HeightMap, [x, z]: [f32; 2]) -> f32 {
    height.height_m(x, z)
}

/// Heading of a vector on the ground (degrees), from north towards east, 0 to below 360.
fn heading_deg([east, south]: [f32; 2]) -> f32 {
    let degrees = east.atan2(-south).to_degrees();
    // Adding a whole turn to a tiny negative angle gives 360.
    if degrees < 0.0 { (degrees + 360.0) % 360.0 } else { degrees }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stations_are_a_name_and_a_place() {
        assert_eq!("west=40,128.5".parse(), Ok(Station { name: "west".to_owned(), at_m: [40.0, 128.5] }));
        for wrong in ["", "west", "=1,2", "west=1", "west=1;2", "west=x,2", "west=1,inf", "we,st=1,2", "we st=1,2"] {
            assert!(wrong.parse::<Station>().is_err(), "{wrong}");
        }
    }

    #[test]
    fn headings_run_from_north_towards_east() {
        let headings = [[0.0, -1.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]].map(heading_deg);
        assert_eq!(headings, [0.0, 90.0, 180.0, 270.0]);
        assert!((0.0..360.0).contains(&heading_deg([-1e-30, -1.0])));
    }
}
