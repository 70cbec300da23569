//! Files of timed drivers' inputs.

use crate::escaped::escaped;
use crate::file;
use crate::scenes::FaultyScene;
use prairie_core::scene::{Positions, Scene, SceneFault, VehicleKind};
use prairie_core::wire::Drive;
use serde::Deserialize;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Largest file (bytes).
const FILE_LIMIT: u64 = 16 << 20;

/// A driver with a vehicle and timed inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Driver {
    /// Kind of the vehicle.
    pub vehicle: VehicleKind,
    /// Position along X and Z at which it appears, heading east (m).
    pub at_m: [f32; 2],
    /// Simulated time at which it appears (s).
    pub from_secs: f64,
    /// Inputs with the simulated times from which they hold (s), ascending.
    pub inputs: Vec<(f64, Drive)>,
}

/// Reasons why a file is refused.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum DriveFileError {
    /// It cannot be read.
    #[error("drive file `{}` cannot be read: {reason}", escaped(.path))]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The reason.
        reason: String,
    },
    /// It contains faults.
    #[error("{0}")]
    Faulty(FaultyScene),
}

/// A file as TOML has it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Listed {
    #[serde(default)]
    driver: Vec<ListedDriver>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ListedDriver {
    vehicle: VehicleKind,
    at_m: [f32; 2],
    #[serde(default)]
    from_secs: f64,
    #[serde(default)]
    inputs: Vec<ListedInput>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ListedInput {
    at_secs: f64,
    #[serde(default)]
    throttle: f32,
    #[serde(default)]
    steer: f32,
    #[serde(default)]
    lift: f32,
    #[serde(default)]
    brake: f32,
}

/// Reads the drivers of a TOML file:
///
/// ```toml
/// [[driver]]
/// vehicle = "car"        # or another kind of vehicle
/// at_m = [60.0, 128.0]   # X and Z at which it appears, heading east
/// from_secs = 0.0        # simulated time at which it appears; default 0
/// inputs = [             # each holds until the next; what is left out is 0
///     { at_secs = 1.0, throttle = 0.8 },
///     { at_secs = 4.0, throttle = 0.5, steer = -0.3 },
///     { at_secs = 9.0, brake = 1.0 },
/// ]
/// ```
///
/// # Errors
/// When the file cannot be read, or for all its faults with line and column.
pub fn read(path: &Path, scene: &Scene) -> Result<Vec<Driver>, DriveFileError> {
    let unreadable = |reason: String| DriveFileError::Unreadable { path: path.to_owned(), reason };
    let bytes = file::read(path, FILE_LIMIT).map_err(unreadable)?;
    let text = String::from_utf8(bytes).map_err(|error| unreadable(format!("it is not UTF-8 text: {error}")))?;
    parse(&text, scene).map_err(|faults| DriveFileError::Faulty(FaultyScene { file: escaped(path), text, faults }))
}

/// The drivers of a file's text.
fn parse(text: &str, scene: &Scene) -> Result<Vec<Driver>, Vec<SceneFault>> {
    let positions = Positions::new(text);
    let listed: Listed = toml::from_str(text).map_err(|error| {
        let span = error.span().unwrap_or(0..0);
        vec![positions.spanning(span, "", error.message())]
    })?;
    let mut faults = Vec::new();
    if listed.driver.is_empty() {
        faults.push(positions.at("", "the file has no driver; expected at least one section [[driver]]"));
    }
    if listed.driver.len() > scene.objects.limit as usize {
        let (count, limit) = (listed.driver.len(), scene.objects.limit);
        faults.push(positions.at("driver", format!("has {count} sections; allowed: the scene's `objects.limit` of {limit}")));
    }
    for (number, driver) in listed.driver.iter().enumerate() {
        check(driver, &format!("driver[{number}]"), scene, &mut |path, message| faults.push(positions.at(path, message)));
    }
    if !faults.is_empty() {
        faults.sort_by_key(|fault| (fault.line, fault.column));
        return Err(faults);
    }
    Ok(listed.driver.into_iter().map(Driver::from).collect())
}

/// Latest time of a driver (s): that of the longest run.
const LATEST_SECS: f64 = 1e6;

/// Checks the values of a driver, which is at `path` of the file.
fn check(driver: &ListedDriver, path: &str, scene: &Scene, note: &mut dyn FnMut(&str, String)) {
    let extent_m = scene.extent_m();
    for (axis, at_m) in driver.at_m.into_iter().enumerate() {
        if !(0.0..=extent_m[axis]).contains(&at_m) {
            note(&format!("{path}.at_m[{axis}]"), format!("is {at_m}; allowed: 0 to {}", extent_m[axis]));
        }
    }
    if !(0.0..=LATEST_SECS).contains(&driver.from_secs) {
        note(&format!("{path}.from_secs"), format!("is {}; allowed: 0 to {LATEST_SECS}", driver.from_secs));
    }
    let mut earliest_secs = driver.from_secs;
    for (number, input) in driver.inputs.iter().enumerate() {
        let path = format!("{path}.inputs[{number}]");
        if !(input.at_secs.is_finite() && input.at_secs >= earliest_secs) {
            let rule = if number == 0 { "the time at which the vehicle appears" } else { "that of the input before" };
            note(&format!("{path}.at_secs"), format!("is {}; allowed: {earliest_secs}, {rule}, or more", input.at_secs));
        }
        earliest_secs = earliest_secs.max(input.at_secs);
        for (name, value) in [("throttle", input.throttle), ("steer", input.steer), ("lift", input.lift)] {
            if !(-1.0..=1.0).contains(&value) {
                note(&format!("{path}.{name}"), format!("is {value}; allowed: -1 to 1"));
            }
        }
        if !(0.0..=1.0).contains(&input.brake) {
            note(&format!("{path}.brake"), format!("is {}; allowed: 0 to 1", input.brake));
        }
    }
}

impl From<ListedDriver> for Driver {
    fn from(ListedDriver { vehicle, at_m, from_secs, inputs }: ListedDriver) -> Self {
        let timed = |ListedInput { at_secs, throttle, steer, lift, brake }| (at_secs, Drive { throttle, steer, lift, brake });
        Self { vehicle, at_m, from_secs, inputs: inputs.into_iter().map(timed).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes;

    fn parsed(text: &str) -> Result<Vec<Driver>, Vec<String>> {
        let scene = scenes::load("meadow").unwrap().scene;
        let shown = |fault: &SceneFault| format!("{}:{} {fault}", fault.line, fault.column);
        parse(text, &scene).map_err(|faults| faults.iter().map(shown).collect())
    }

    #[test]
    fn drivers_have_vehicles_and_timed_inputs() {
        let text = "[[driver]]\nvehicle = \"car\"\nat_m = [60, 128.5]\ninputs = [{ at_secs = 1, throttle = 0.8 }, { at_secs = 4.5, brake = 1 }]\n\
                    [[driver]]\nvehicle = \"helicopter\"\nat_m = [90.0, 90.0]\nfrom_secs = 2.0\n";
        let drivers = parsed(text).unwrap();
        let inputs = vec![(1.0, Drive { throttle: 0.8, ..Drive::default() }), (4.5, Drive { brake: 1.0, ..Drive::default() })];
        assert_eq!(drivers[0], Driver { vehicle: VehicleKind::Car, at_m: [60.0, 128.5], from_secs: 0.0, inputs });
        assert_eq!((drivers[1].vehicle, drivers[1].from_secs, drivers[1].inputs.len()), (VehicleKind::Helicopter, 2.0, 0));
    }

    #[test]
    fn every_fault_has_its_place_its_value_and_what_is_allowed() {
        let text = "[[driver]]\nvehicle = \"car\"\nat_m = [-5.0, 300.0]\nfrom_secs = 2.0\ninputs = [\n  { at_secs = 1.0, throttle = 2.0 },\n  \
                    { at_secs = 0.5, brake = -1.0, steer = nan },\n]\n";
        let faults = parsed(text).unwrap_err();
        let expected = [
            "3:9 `driver[0].at_m[0]` is -5; allowed: 0 to 256",
            "3:15 `driver[0].at_m[1]` is 300; allowed: 0 to 256",
            "6:15 `driver[0].inputs[0].at_secs` is 1; allowed: 2, the time at which the vehicle appears, or more",
            "6:31 `driver[0].inputs[0].throttle` is 2; allowed: -1 to 1",
            "7:15 `driver[0].inputs[1].at_secs` is 0.5; allowed: 2, that of the input before, or more",
            "7:28 `driver[0].inputs[1].brake` is -1; allowed: 0 to 1",
            "7:42 `driver[0].inputs[1].steer` is NaN; allowed: -1 to 1",
        ];
        assert_eq!(faults, expected);
    }

    #[test]
    fn what_is_no_list_of_drivers_is_refused_at_its_place() {
        for (text, expected) in [
            ("", "1:1 the file has no driver"),
            ("[[driver]]\nvehicle = \"truck\"\nat_m = [60, 60]\n", "2:11 unknown variant `truck`, expected one of `car`"),
            ("[[driver]]\nvehicle = \"car\"\n", "1:1 missing field `at_m`"),
            ("[[driver]]\nvehicle = \"car\"\nat_m = [60, 60]\nspeed = 3\n", "4:1 unknown field `speed`, expected one of"),
            ("[[driver]]\nvehicle = \"car\"\nat_m = \"here\"\n", "3:8 invalid type: string \"here\""),
            ("[[driver\n", "1:9 "),
        ] {
            let faults = parsed(text).unwrap_err();
            assert!(faults.len() == 1 && faults[0].starts_with(expected), "{text}: {faults:?}");
        }
    }
}
