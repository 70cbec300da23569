//! Bits on the wire against the error of the grass: causes, a closed loop, the codec of patches, and general compressors beside them.
//!
//! | file | what it does |
//! |---|---|
//! | `drive` | recordings of the bend field, with the bytes of its causes |
//! | `patches` | the codec of patches, and a closed loop with it |
//! | `compressors` | zstd, zfp and SZ3; with the feature `compressors` |
//!
//! All methods get the same window of 384 × 384 cells at 20 frames a second. Headers of messages and the wind are left out.

#[cfg(feature = "compressors")]
mod compressors;
mod drive;
mod patches;

use std::fmt::Write as _;

use anyhow::{Result, ensure};
use prairie_core::scene::{Stream, VehicleKind};
use prairie_core::wire::quantise::CodeSteps;

use drive::{Drive, Recording};
use prairie_charts::figure::{Axis, Curve, Drawn, Figure, Words, curves_svg};

/// All figures.
pub const FIGURES: [Figure; 4] = [
    Figure { name: "drive", title: "Streaming a drive of two cars", draw: |quick, caption| draw(&DRIVES[0], quick, caption) },
    Figure { name: "wash", title: "Streaming the wash of a helicopter", draw: |quick, caption| draw(&DRIVES[1], quick, caption) },
    Figure { name: "cyclone", title: "Streaming a cyclone", draw: |quick, caption| draw(&DRIVES[2], quick, caption) },
    Figure { name: "storm", title: "Streaming a drive in a storm", draw: |quick, caption| draw(&DRIVES[3], quick, caption) },
];

const DRIVES: [Drive; 4] = [
    Drive { title: "A drive of two cars", scene: "meadow", vehicles: &[VehicleKind::Car; 2] },
    Drive { title: "The wash of a helicopter", scene: "meadow", vehicles: &[VehicleKind::Helicopter] },
    Drive { title: "A cyclone", scene: "tests/scenes/cyclone.toml", vehicles: &[] },
    Drive { title: "A drive of two cars in a storm", scene: "storm", vehicles: &[VehicleKind::Car; 2] },
];

/// A way to send the field with an error of at most that of the steps.
struct Method {
    name: &'static str,
    /// Bytes of the whole recording, and the largest error of θ (rad) in it.
    send: fn(&Recording, &CodeSteps) -> Result<Sent>,
}

/// What a method sends.
#[derive(Clone, Copy, Debug)]
struct Sent {
    bytes: usize,
    /// Largest error of θ (rad).
    error_rad: f32,
}

const METHODS: &[Method] = &[
    Method { name: "closed loop, θ and ω", send: patches::closed_loop },
    Method { name: "codec of patches, θ and ω", send: |recording, steps| patches::codec(recording, steps, 3) },
    Method { name: "codec of patches, θ alone", send: |recording, steps| patches::codec(recording, steps, 1) },
    #[cfg(feature = "compressors")]
    Method { name: "zstd 19, differences of θ", send: compressors::zstd },
    #[cfg(feature = "compressors")]
    Method { name: "zfp, θ frame by frame", send: compressors::zfp },
    #[cfg(feature = "compressors")]
    Method { name: "SZ3, all of θ at once", send: compressors::sz3 },
];

/// Largest errors of θ of the chart (degrees).
const ERRORS_DEG: [f32; 5] = [0.1, 0.25, 0.5, 1.0, 2.0];

fn draw(drive: &Drive, quick: bool, caption: &str) -> Result<Drawn> {
    let (secs, errors_deg) = if quick { (3.0, &ERRORS_DEG[2..3]) } else { (30.0, &ERRORS_DEG[..]) };
    let recording = drive.record(secs)?;
    let per_cell = 8.0 / (recording.frames.len() * drive::WINDOW_CELLS * drive::WINDOW_CELLS) as f64;
    let mut csv = String::from("method,error_deg,largest_error_deg,bits_per_cell_and_frame\n");
    let mut summary = String::new();
    let causes = (recording.cause_bytes as f64 * per_cell).max(1e-6);
    writeln!(csv, "causes,0,0,{causes:e}")?;
    writeln!(summary, "causes, exact: {causes:.5} bits")?;
    let ends = [ERRORS_DEG[0], ERRORS_DEG[ERRORS_DEG.len() - 1]].map(f64::from);
    let mut curves = vec![Curve {
        name: "causes, θ and ω exactly".to_owned(),
        points: ends.map(|error_deg| [error_deg, causes]).into(),
        marked: false,
        joined: true,
    }];
    for method in METHODS {
        let mut points = vec![];
        for &error_deg in errors_deg {
            // The error of ω keeps its ratio to that of θ.
            let Stream { theta_error_deg, omega_error_rad_per_s, .. } = Stream::default();
            let omega_error_rad_per_s = omega_error_rad_per_s * error_deg / theta_error_deg;
            let steps = CodeSteps::from(&Stream { theta_error_deg: error_deg, omega_error_rad_per_s, ..Stream::default() });
            let Sent { bytes, error_rad } = (method.send)(&recording, &steps)?;
            let (largest_deg, bits) = (error_rad.to_degrees(), (bytes as f64 * per_cell).max(1e-6));
            ensure!(largest_deg <= 1.001 * error_deg, "{}: off by {largest_deg}° instead of {error_deg}°", method.name);
            writeln!(csv, "\"{}\",{error_deg},{largest_deg},{bits:e}", method.name)?;
            if error_deg == Stream::default().theta_error_deg {
                writeln!(summary, "{}, 0.5°: {bits:.5} bits", method.name)?;
            }
            points.push([f64::from(error_deg), bits]);
        }
        curves.push(Curve { name: method.name.to_owned(), points, marked: true, joined: true });
    }
    let bits = || curves.iter().flat_map(|curve| &curve.points).map(|point| point[1]);
    let [least, most] = [bits().fold(f64::INFINITY, f64::min), bits().fold(0.0, f64::max)];
    let axes = [
        Axis { name: "largest error of θ (degrees)", range: [ends[0] / 1.15, ends[1] * 1.15], logarithmic: true },
        Axis { name: "bits per cell and frame", range: [least / 1.5, most * 1.5], logarithmic: true },
    ];
    let subtitle = "a window of 384 × 384 cells, 20 frames a second for 30 s; bits, without headers and wind";
    let svg = curves_svg(&curves, axes, Words { title: drive.title, subtitle, caption })?;
    Ok(Drawn::new(svg, csv, summary))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn causes_take_less_than_a_closed_loop_and_that_less_than_the_codec() {
        let recording = DRIVES[0].record(3.0).unwrap();
        let steps = CodeSteps::default();
        let sent = |method: fn(&Recording, &CodeSteps) -> Result<Sent>| method(&recording, &steps).unwrap();
        let (closed, codec) = (sent(patches::closed_loop), sent(|recording, steps| patches::codec(recording, steps, 3)));
        assert!(recording.cause_bytes > 100 && 2 * recording.cause_bytes < closed.bytes && closed.bytes < codec.bytes);
        let half_step = 0.5 * steps.theta_rad;
        assert!(codec.error_rad > 0.9 * half_step && codec.error_rad < 1.001 * half_step, "{codec:?}");
        assert!(closed.error_rad > 0.5 * half_step && closed.error_rad < 1.001 * half_step, "{closed:?}");
    }
}
