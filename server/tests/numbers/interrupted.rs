//! A run that is stopped by Ctrl-C.
#![cfg(unix)]

use crate::text;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

#[test]
fn files_of_a_run_that_is_stopped_can_be_read() {
    let folder = tempfile::tempdir().unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_prairie"));
    command.current_dir(folder.path()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.args(["run", "blades", "--seconds", "1000000", "--every", "0.05", "--fields", "wind,bend", "--vtk", "vtk"]);
    command.args(["--station", "a=30,30", "--stations", "a.csv"]);
    if cfg!(feature = "zarr") {
        command.args(["--out", "run.zarr"]);
    }
    let child = command.spawn().unwrap();
    let until = Instant::now() + Duration::from_secs(60);
    while !folder.path().join("vtk/air_000020.vti").exists() {
        assert!(Instant::now() < until, "the run has not begun");
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let stderr = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(
        stderr.contains("error: stopped by a signal after ") && stderr.contains(" of 1000000 s; the files can be read up to there"),
        "{stderr}"
    );

    let rows = std::fs::read_to_string(folder.path().join("a.csv")).unwrap();
    assert!(rows.ends_with('\n') && rows.lines().count() > 60);
    let collection = std::fs::read_to_string(folder.path().join("vtk/grass.pvd")).unwrap();
    let images = collection.matches("<DataSet").count();
    assert!(collection.ends_with("</VTKFile>\n") && images > 20);
    #[cfg(feature = "zarr")]
    {
        use std::sync::Arc;
        use zarrs::array::Array;
        use zarrs::filesystem::FilesystemStore;
        let store = Arc::new(FilesystemStore::new(folder.path().join("run.zarr")).unwrap());
        for name in ["time", "u", "v", "w", "theta"] {
            let array = Array::open(Arc::clone(&store), &format!("/{name}")).unwrap();
            assert_eq!(array.shape()[0], images as u64, "{name}: all frames, also those after the last full chunk");
        }
        let times = Array::open(store, "/time").unwrap();
        let found: Vec<f64> = times.retrieve_array_subset(&times.subset_all()).unwrap();
        assert!(found.is_sorted() && found.iter().all(|secs| secs.is_finite()));
    }
}
