//! The data rate of a client that watches a drive.

// What only the example prints is not read here.
#[allow(dead_code)]
#[path = "../examples/watched_drive/measure.rs"]
mod measure;

use measure::{Measured, WatchedDrive};

/// Rate beyond the wind (kbit/s), with replicas or with patches of the grass.
fn beyond_the_wind(scene: &str, has_replica: bool, has_car: bool) -> f64 {
    let drive = WatchedDrive { scene: scene.to_owned(), radius_m: 112.0, measured_secs: 8.0, has_replica, has_car, viewers: 0 };
    let Measured { sums, .. } = drive.measure().unwrap();
    let bytes: usize = sums.iter().filter(|(kind, _)| **kind != "wind").map(|(_, (_, bytes))| bytes).sum();
    let kbit_per_s = bytes as f64 * 8e-3 / f64::from(drive.measured_secs);
    println!("{scene}: {kbit_per_s:.1} kbit/s");
    kbit_per_s
}

#[test]
fn a_watched_drive_takes_at_most_24_kbit_per_s_beyond_the_wind() {
    for scene in ["meadow", "continuum"] {
        let [replica, patches] = [true, false].map(|has_replica| beyond_the_wind(scene, has_replica, true));
        assert!(replica <= 24.0, "{scene}: {replica} kbit/s");
        assert!(patches > 5.0 * 24.0, "{scene}: patches take {patches} kbit/s");
    }
}

#[test]
fn a_still_meadow_takes_at_most_1_kbit_per_s_beyond_the_wind() {
    let kbit_per_s = beyond_the_wind("meadow", true, false);
    assert!(kbit_per_s > 0.0 && kbit_per_s <= 1.0, "{kbit_per_s} kbit/s");
}
