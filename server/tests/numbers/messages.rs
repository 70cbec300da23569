//! Messages about what cannot be run or written.

use crate::{DRIVE, prairie, text};
use std::fs;

/// The exit status and the message of a run.
fn refused(arguments: &[&str], folder: &std::path::Path) -> (Option<i32>, String) {
    let output = prairie(&[&["run"], arguments].concat(), folder);
    assert!(output.stdout.is_empty(), "{}", text(&output.stdout));
    (output.status.code(), text(&output.stderr))
}

#[test]
fn wrong_arguments_name_value_and_what_is_allowed() {
    let folder = tempfile::tempdir().unwrap();
    for (arguments, expected) in [
        (&["blades", "--seconds", "0"][..], "'0' for '--seconds <N>': allowed: above 0 to 1000000"),
        (&["blades", "--every", "soon", "--vtk", "a"], "'soon' for '--every <SECS>': allowed: above 0 to 1000000"),
        (
            &["blades", "--fields", "wind,grass"],
            "'grass' for '--fields <FIELD>': allowed: wind, dust, ground-wind, bend, bend-velocity, lean",
        ),
        (&["blades", "--out", "a", "--error", "wind=0"], "allowed: an error from 0.000001 to 1000, in the unit of the field"),
        (&["blades", "--out", "a", "--error", "0.1"], "expected FIELD=ERROR, such as wind=0.01"),
        (&["blades", "--error", "wind=0.1"], "--out <PATH>"),
        (
            &["blades", "--station", "a:1,2", "--stations", "a.csv"],
            "'a:1,2' for '--station <NAME=X,Z>': expected NAME=X,Z, such as west=40,128.5",
        ),
        (&["blades", "--station", "a=1,2"], "--stations <FILE>"),
        (&["blades", "--stations", "a.csv"], "--station <NAME=X,Z>"),
        (&[], "<SCENE>"),
    ] {
        let (status, message) = refused(arguments, folder.path());
        assert!(status == Some(2) && message.contains(expected), "{arguments:?}: {status:?} {message}");
    }
    assert!(fs::read_dir(folder.path()).unwrap().next().is_none(), "nothing is written");
}

#[test]
fn faults_of_scenes_and_drive_files_have_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let (status, message) = refused(&["medow"], folder.path());
    assert!(status == Some(1) && message.contains("did you mean `meadow`?"), "{message}");
    let (status, message) = refused(&["blades", "--drive", "no.toml"], folder.path());
    assert!(status == Some(1) && message.starts_with("error: drive file `no.toml` cannot be read: "), "{message}");
    fs::write(folder.path().join("drive.toml"), DRIVE.replace("throttle = 1.0", "throttle = 1.5")).unwrap();
    let (status, message) = refused(&["blades", "--drive", "drive.toml"], folder.path());
    assert!(status == Some(1) && message.starts_with("error: drive.toml has 1 fault\n"), "{message}");
    for part in ["`driver[0].inputs[0].throttle` is 1.5; allowed: -1 to 1", "--> drive.toml:5:", "throttle = 1.5"] {
        assert!(message.contains(part), "{part} in {message}");
    }
    let many = DRIVE.repeat(9);
    fs::write(folder.path().join("drive.toml"), many).unwrap();
    let (_, message) = refused(&["blades", "--drive", "drive.toml"], folder.path());
    assert!(message.contains("has 9 sections; allowed: the scene's `objects.limit` of 8"), "{message}");
}

#[test]
fn existing_files_are_kept_unless_they_are_to_be_replaced() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.csv"), "mine").unwrap();
    let arguments = ["blades", "--seconds", "0.1", "--station", "a=30,30", "--stations", "a.csv"];
    let overwriting = [&["blades", "--overwrite"], &arguments[1..]].concat();
    let (status, message) = refused(&overwriting, folder.path());
    assert_eq!(status, Some(1));
    assert_eq!(message, "error: `a.csv` exists and is no file of stations of an earlier run, so it is not replaced; name another\n");
    assert_eq!(fs::read_to_string(folder.path().join("a.csv")).unwrap(), "mine");
    fs::remove_file(folder.path().join("a.csv")).unwrap();
    assert!(prairie(&[&["run"], &arguments[..]].concat(), folder.path()).status.success());
    let (status, message) = refused(&arguments, folder.path());
    assert_eq!((status, message.as_str()), (Some(1), "error: `a.csv` exists; --overwrite replaces it\n"));
    assert!(prairie(&[&["run", "--overwrite"], &arguments[..]].concat(), folder.path()).status.success());
    assert!(fs::read_to_string(folder.path().join("a.csv")).unwrap().starts_with("time_s,"));
    fs::create_dir(folder.path().join("thesis")).unwrap();
    fs::write(folder.path().join("thesis/one.tex"), "mine").unwrap();
    let (status, message) = refused(&["blades", "--overwrite", "--vtk", "thesis"], folder.path());
    assert_eq!(status, Some(1));
    assert_eq!(message, "error: `thesis` exists and is no folder of VTK files of an earlier run, so it is not replaced; name another\n");
    assert!(folder.path().join("thesis/one.tex").exists());
    let (_, message) = refused(&["blades", "--vtk", "a.csv/b"], folder.path());
    assert!(message.starts_with("error: `a.csv/b` cannot be written: "), "{message}");
}

#[cfg(not(feature = "zarr"))]
#[test]
fn a_program_without_zarr_says_how_to_build_one() {
    let folder = tempfile::tempdir().unwrap();
    let (status, message) = refused(&["blades", "--out", "run.zarr"], folder.path());
    assert_eq!(
        (status, message.as_str()),
        (Some(1), "error: --out: this binary was built without Zarr; build it with `--features zarr`\n")
    );
}

#[cfg(feature = "zarr")]
#[test]
fn stores_are_checked_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let (status, message) = refused(&["blades", "--out", "run.zarr", "--fields", "bend", "--error", "wind=0.1"], folder.path());
    assert_eq!((status, message.as_str()), (Some(1), "error: --error: `wind` is not written; --fields names what is\n"));
    let (_, message) = refused(&["blades", "--out", "run.zarr", "--fields", "dust"], folder.path());
    assert!(message.starts_with("error: `dust` is asked for, and the scene releases none"), "{message}");
    let (_, message) = refused(&["continuum", "--out", "run.zarr"], folder.path());
    assert!(message.contains("allowed: at most 67108864. Leave it out with --fields"), "{message}");
    assert!(fs::read_dir(folder.path()).unwrap().next().is_none());
    let write =
        |overwrite: &[&str]| prairie(&[&["run", "blades", "--seconds", "0.1", "--out", "run.zarr"], overwrite].concat(), folder.path());
    assert!(write(&[]).status.success());
    assert_eq!(text(&write(&[]).stderr), "error: `run.zarr` exists; --overwrite replaces it\n");
    assert!(write(&["--overwrite"]).status.success());
}
