//! Zarr stores, read by zarrs.

use crate::{DRIVE, bytes, drivers, ran, scene, values, world};
use prairie::output::zarr::{Errors, FRAMES_PER_COMMIT, ZarrStore};
use prairie::output::{Field, OutputError, Outputs, Sampler, Sink as _};
use std::path::Path;
use std::sync::Arc;
use zarrs::array::Array;
use zarrs::filesystem::FilesystemStore;
use zarrs::group::Group;

/// Fields of the stores.
pub(crate) const FIELDS: [Field; 4] = [Field::Wind, Field::GroundWind, Field::Bend, Field::BendVelocity];
/// Variables of the stores.
pub(crate) const NAMES: [&str; 8] = ["u", "v", "w", "ground_u", "ground_w", "theta", "omega_x", "omega_z"];
/// Steps, and steps between frames, so that there are more frames than in a commit.
pub(crate) const TICKS: u64 = 120;
pub(crate) const TICKS_PER_FRAME: u64 = 6;
const FRAMES: usize = (TICKS / TICKS_PER_FRAME + 1) as usize;

/// Writes a run into a store.
pub(crate) fn write(path: &Path, errors: &Errors) {
    let loaded = scene();
    let sampler = Sampler::new(&loaded, &FIELDS).unwrap();
    let store = ZarrStore::create(path, &loaded, &sampler, errors, false).unwrap();
    ran(DRIVE, TICKS, TICKS_PER_FRAME, Outputs::default().with_fields(sampler, vec![Box::new(store)]).unwrap());
}

fn open(path: &Path, name: &str) -> Array<FilesystemStore> {
    Array::open(Arc::new(FilesystemStore::new(path).unwrap()), &format!("/{name}")).unwrap()
}

/// All values of a variable, and its shape.
fn read(path: &Path, name: &str) -> (Vec<f32>, Vec<u64>) {
    let array = open(path, name);
    (array.retrieve_array_subset(&array.subset_all()).unwrap(), array.shape().to_vec())
}

/// The values of all variables at all times, found in a world of its own.
pub(crate) fn expected() -> Vec<Vec<f32>> {
    let (loaded, mut world, mut drivers) = (scene(), world(), drivers(DRIVE));
    let mut found = vec![Vec::new(); NAMES.len()];
    for tick in 0..=TICKS {
        if tick.is_multiple_of(TICKS_PER_FRAME) {
            NAMES.iter().zip(&mut found).for_each(|(name, found)| found.extend(values(&world, &loaded, name)));
        }
        let commands = drivers.commands(&world);
        world.step(&commands);
    }
    found
}

#[test]
fn a_store_has_the_bits_of_the_world() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.zarr");
    write(&path, &Errors::new());
    let expected = expected();
    for (name, expected) in NAMES.iter().zip(&expected) {
        let (found, shape) = read(&path, name);
        assert!(shape[0] as usize == FRAMES && found.len() == expected.len(), "{name}: {shape:?}");
        assert!(bytes(&found) == bytes(expected), "{name}");
        // Without the last frame, or with another one, they differ.
        let frame = found.len() / FRAMES;
        assert!(bytes(&found[frame..]) != bytes(&expected[..found.len() - frame]), "{name} changes with time");
    }
    let times = open(&path, "time");
    let found: Vec<f64> = times.retrieve_array_subset(&times.subset_all()).unwrap();
    let secs = |frame: usize| (frame as u64 * TICKS_PER_FRAME) as f64 * f64::from(scene().scene.dt_secs());
    assert_eq!(found, (0..FRAMES).map(secs).collect::<Vec<_>>());
}

#[test]
fn arrays_have_coordinates_units_and_attributes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.zarr");
    write(&path, &Errors::from([(Field::Wind, 0.01)]));
    let loaded = scene();
    for (name, dimensions, units) in [
        ("u", "time y wind_z wind_x", "m s-1"),
        ("ground_w", "time tile_z tile_x", "m s-1"),
        ("theta", "time z x", "rad"),
        ("omega_x", "time z x", "rad s-1"),
        ("ground_height", "z x", "m"),
        ("time", "time", "s"),
        ("y", "y", "m"),
        ("wind_x", "wind_x", "m"),
    ] {
        let array = open(&path, name);
        let found: Vec<_> = array.dimension_names().iter().flatten().map(|name| name.clone().unwrap_or_default()).collect();
        assert_eq!(found.join(" "), dimensions, "{name}");
        assert_eq!(array.attributes()["units"], units, "{name}");
        assert!(array.attributes()["long_name"].is_string() && !array.attributes().contains_key("_zarrs"), "{name}");
        for (length, dimension) in array.shape().iter().zip(&found) {
            assert_eq!(open(&path, dimension).shape(), [*length], "{dimension} of {name}");
        }
    }
    assert_eq!(open(&path, "u").attributes()["standard_name"], "eastward_wind");
    assert_eq!(open(&path, "u").attributes()["comment"], "rounded to multiples of 0.015625");
    assert_eq!((&open(&path, "y").attributes()["axis"], &open(&path, "time").attributes()["axis"]), (&"Z".into(), &"T".into()));
    let y = open(&path, "y");
    let heights_m: Vec<f64> = y.retrieve_array_subset(&y.subset_all()).unwrap();
    assert_eq!(heights_m, [1.0, 3.0, 5.0, 7.0, 9.0, 11.0, 13.0, 15.0]);
    let (ground, _) = read(&path, "ground_height");
    assert_eq!(ground[3 + 256 * 70].to_bits(), loaded.height.height_m(3.5 * 0.25, 70.5 * 0.25).to_bits());
    let group = Group::open(Arc::new(FilesystemStore::new(&path).unwrap()), "/").unwrap();
    let run = group.attributes();
    assert_eq!((&run["Conventions"], &run["scene"], &run["seed"]), (&"CF-1.11".into(), &"blades".into(), &loaded.scene.seed.into()));
    assert_eq!((&run["tick_hz"], &run["error"]), (&60.0.into(), &"wind: at most 0.01".into()));
}

#[test]
fn rounded_fields_are_within_their_errors_and_the_others_exact() {
    let folder = tempfile::tempdir().unwrap();
    let [exact, rounded] = ["exact.zarr", "rounded.zarr"].map(|name| folder.path().join(name));
    let errors = Errors::from([(Field::Wind, 0.02), (Field::Bend, 0.001)]);
    write(&exact, &Errors::new());
    write(&rounded, &errors);
    for name in NAMES {
        let ((found, _), (expected, _)) = (read(&rounded, name), read(&exact, name));
        let largest = found.iter().zip(&expected).map(|(a, b)| (f64::from(*a) - f64::from(*b)).abs()).fold(0.0, f64::max);
        let error = match name {
            "u" | "v" | "w" => 0.02_f32,
            "theta" => 0.001,
            _ => 0.0,
        };
        assert!(largest <= f64::from(error), "{name}: {largest}");
        // They are rounded in fact, by nearly as much as half of a step.
        assert!(largest >= 0.3 * f64::from(error), "{name}: {largest}");
    }
    let size = |path: &Path, name: &str| folder_bytes(&path.join(name).join("c"));
    assert!(2 * size(&rounded, "u") < size(&exact, "u"), "{} and {} bytes", size(&rounded, "u"), size(&exact, "u"));
}

fn folder_bytes(path: &Path) -> u64 {
    let entries = std::fs::read_dir(path).unwrap().map(Result::unwrap);
    entries.map(|entry| if entry.path().is_dir() { folder_bytes(&entry.path()) } else { entry.metadata().unwrap().len() }).sum()
}

#[test]
fn a_store_can_be_read_while_it_is_written_and_grass_at_rest_takes_no_space() {
    let folder = tempfile::tempdir().unwrap();
    let (path, loaded, world) = (folder.path().join("run.zarr"), scene(), world());
    let sampler = Sampler::new(&loaded, &FIELDS).unwrap();
    let mut store = ZarrStore::create(&path, &loaded, &sampler, &Errors::new(), false).unwrap();
    assert_eq!((read(&path, "u").1[0], read(&path, "theta").1[0]), (0, 0));
    let frame = sampler.sample(&world);
    (0..FRAMES_PER_COMMIT + 3).for_each(|_| store.write(&frame).unwrap());
    for name in NAMES.into_iter().chain(["time"]) {
        assert_eq!(open(&path, name).shape()[0] as usize, FRAMES_PER_COMMIT, "{name}");
    }
    Box::new(store).finish().unwrap();
    for name in NAMES.into_iter().chain(["time"]) {
        assert_eq!(open(&path, name).shape()[0] as usize, FRAMES_PER_COMMIT + 3, "{name}");
    }
    assert!(!path.join("theta/c").exists() && path.join("u/c").exists());
    let create = |overwrite| ZarrStore::create(&path, &loaded, &sampler, &Errors::new(), overwrite).err();
    assert!(matches!(create(false), Some(OutputError::Exists { .. })));
    assert!(create(true).is_none() && read(&path, "u").1[0] == 0);
    std::fs::write(path.join("notes.txt"), "mine").unwrap();
    assert!(matches!(create(true), Some(OutputError::NotOurs { .. })) && path.join("notes.txt").exists());
}

#[test]
fn a_store_keeps_its_length_when_a_file_cannot_be_written() {
    let folder = tempfile::tempdir().unwrap();
    let (path, loaded) = (folder.path().join("run.zarr"), scene());
    let sampler = Sampler::new(&loaded, &FIELDS).unwrap();
    let mut store = ZarrStore::create(&path, &loaded, &sampler, &Errors::new(), false).unwrap();
    let frame = sampler.sample(&world());
    (0..FRAMES_PER_COMMIT).for_each(|_| store.write(&frame).unwrap());
    std::fs::remove_dir_all(path.join("w/c/1")).ok();
    std::fs::write(path.join("w/c/1"), "in the way").unwrap();
    let outcome: Result<Vec<()>, _> = (0..FRAMES_PER_COMMIT).map(|_| store.write(&frame)).collect();
    let error = outcome.unwrap_err().to_string();
    assert!(error.starts_with("the Zarr store `") && error.contains("run.zarr` cannot be written: "), "{error}");
    Box::new(store).finish().unwrap();
    for name in NAMES.into_iter().chain(["time"]) {
        assert_eq!(open(&path, name).shape()[0] as usize, FRAMES_PER_COMMIT, "{name}");
    }
}
