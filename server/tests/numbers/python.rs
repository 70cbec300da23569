//! The files as the usual readers see them: stores in xarray, images in VTK, the library of ParaView.

use crate::text;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What a program in Python beside this file prints, with the interpreter that has its packages.
fn printed(program: &str, argument: &Path) -> Value {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let in_environment = if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" };
    let interpreter: PathBuf = package.join("../target/python").join(in_environment);
    assert!(interpreter.exists(), "{} is missing: run `.ci/check setup`", interpreter.display());
    let mut command = Command::new(interpreter);
    command.arg(package.join("tests/numbers").join(program)).arg(argument).env("PYTHONDONTWRITEBYTECODE", "1");
    let output = command.output().unwrap();
    let (stdout, stderr) = (text(&output.stdout), text(&output.stderr));
    assert!(output.status.success(), "{stdout}\n{stderr}");
    serde_json::from_str(&stdout).unwrap_or_else(|error| panic!("{error}: {stdout}"))
}

#[cfg(feature = "zarr")]
#[test]
fn xarray_opens_a_store_without_a_warning_and_finds_every_bit() {
    use crate::zarr::{NAMES, TICKS, expected, write};
    use crate::{bytes, scene};
    use prairie::output::zarr::Errors;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.zarr");
    write(&path, &Errors::new());
    let found = printed("check_store.py", &path);
    let expected = expected();
    for (name, values) in NAMES.iter().zip(&expected) {
        let variable = &found["variables"][name];
        assert_eq!((&variable["crc32"], &variable["dtype"]), (&crc32fast::hash(&bytes(values)).into(), &"float32".into()), "{name}");
    }
    let dims =
        |name: &str| found["variables"][name]["dims"].as_array().unwrap().iter().map(|dim| dim.as_str().unwrap()).collect::<Vec<_>>();
    assert_eq!(dims("u"), ["time", "y", "wind_z", "wind_x"]);
    assert_eq!(dims("theta"), ["time", "z", "x"]);
    assert_eq!(dims("ground_u"), ["time", "tile_z", "tile_x"]);
    assert_eq!(dims("ground_height"), ["z", "x"]);
    assert_eq!((&found["variables"]["time"]["dtype"], &found["variables"]["time"]["units"]), (&"float64".into(), &"s".into()));
    assert_eq!(found["attributes"]["Conventions"], "CF-1.11");
    // At (30.5, 2.9, 9) m and 1 s: cell (7, 1, 2) of 16 × 8 × 16 in frame 10.
    let u = expected[0][((10 * 8 + 1) * 16 + 2) * 16 + 7];
    assert_eq!(found["nearest"].as_f64(), Some(f64::from(u)));
    let frame = 256 * 256;
    let last = &expected[NAMES.iter().position(|name| *name == "theta").unwrap()][TICKS as usize / 6 * frame..];
    let cells = (112..144).flat_map(|j| (80..160).map(move |i| 256 * j + i));
    let track = cells.map(|cell| last[cell]).fold(0.0, f32::max);
    assert!(track > 0.5 && found["track"].as_f64() == Some(f64::from(track)), "{} and {track}", found["track"]);
    let mut other = expected[0].clone();
    other[12345] = f32::from_bits(other[12345].to_bits() ^ 1);
    assert_ne!(found["variables"]["u"]["crc32"], crc32fast::hash(&bytes(&other)), "one other bit is noticed");
    let scene = scene();
    assert_eq!((&found["attributes"]["scene"], &found["attributes"]["seed"]), (&"blades".into(), &scene.scene.seed.into()));
}

#[test]
#[ignore = "needs VTK, 150 MB: target/python/bin/pip install -r server/tests/numbers/requirements-long.txt; cargo nextest run --release -p prairie --features zarr --run-ignored only vtk_reads_every_bit"]
fn vtk_reads_every_bit() {
    use crate::bytes;
    let folder = tempfile::tempdir().unwrap();
    let frames = crate::vtk::write(folder.path());
    let found = printed("check_vtk.py", &folder.path().join("grass.pvd"));
    let last = frames.last().unwrap();
    assert_eq!((found["time"].as_f64(), &found["dimensions"]), (Some(last.time_secs), &serde_json::json!([257, 1, 257])));
    let theta = &last.values[5];
    assert_eq!(found["arrays"]["bend"], serde_json::json!([[65536], crc32fast::hash(&bytes(theta))]));
    let velocity: Vec<f32> = (0..65536).flat_map(|cell| [last.values[6][cell], 0.0, last.values[7][cell]]).collect();
    assert_eq!(found["arrays"]["bend-velocity"], serde_json::json!([[65536, 3], crc32fast::hash(&bytes(&velocity))]));
    let air = printed("check_vtk.py", &folder.path().join("air.pvd"));
    assert_eq!((&air["dimensions"], &air["spacing"]), (&serde_json::json!([17, 9, 17]), &serde_json::json!([4.0, 2.0, 4.0])));
}
