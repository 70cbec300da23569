//! One wave over a meadow, by the wind solver: growth and frequency while it is small.

use super::stability::MeanFlow;
use super::{Meadow, Wave};
use prairie_wind::{Boundary, Canopy, Config, Gusts, Profile, Solver};
use std::f64::consts::TAU;

/// Speed (m/s over that of the wind) of the first disturbance.
const FIRST: f64 = 1e-7;
/// Courant number of a step.
const COURANT: f64 = 0.4;
/// Times, in heights of the canopy over the wind, at which the amplitude is taken: by then the other modes of this wave number have faded.
const FROM: f64 = 60.0;
const TO: f64 = 100.0;

/// The wind over `meadow` in a slice one wave long, with `cells` per height of the canopy.
fn slice(meadow: &Meadow, flow: &MeanFlow, k_per_m: f64, cells: usize) -> Solver<f64> {
    let (length_m, spacing_m) = (TAU / k_per_m, meadow.height_m / cells as f64);
    let along = (length_m / spacing_m).round() as usize;
    let config = Config {
        cells: [along, Meadow::BOX_HEIGHTS * cells, 1],
        spacing_m: [(length_m / along as f64) as f32, spacing_m as f32, 1.0],
        boundary: [[Boundary::Wrap; 2], [Boundary::FreeSlip; 2], [Boundary::Wrap; 2]],
        damping: 0.0,
        viscosity_m2_per_s: meadow.viscosity_m2_per_s() as f32,
        mean_wind_m_per_s: [meadow.wind_m_per_s as f32, 0.0, 0.0],
        profile: Profile::Uniform,
        relaxation_per_s: meadow.relaxation_per_s() as f32,
        gusts: Gusts { number: 0, ..Gusts::default() },
        canopy: Some(Canopy { height_m: meadow.height_m as f32, drag_per_m: meadow.drag_per_m as f32, motion: meadow.motion }),
        ..Config::default()
    };
    let mut air = Solver::new(&config).expect("settings are allowed");
    let depth_m = 0.5 * meadow.height_m;
    air.set_velocity(|[x, y, _]: [f64; 3]| {
        let off = (y - meadow.height_m) / depth_m;
        let stream = FIRST * meadow.wind_m_per_s * depth_m * (-off * off).exp();
        let (sin, cos) = (k_per_m * x).sin_cos();
        [flow.at(y) - 2.0 * off / depth_m * stream * sin, -k_per_m * stream * cos, 0.0]
    });
    air
}

/// Amplitude of the wave in the speed at the top of the canopy: size and angle (rad).
fn amplitude(air: &Solver<f64>, meadow: &Meadow, k_per_m: f64) -> [f64; 2] {
    let (mut re, mut im) = (0.0, 0.0);
    let near = 0.5 * f64::from(air.config().spacing_m[1]);
    for ([x, y, _], speed) in air.samples(0) {
        if (y - meadow.height_m).abs() < 1.01 * near {
            re += speed * (k_per_m * x).cos();
            im -= speed * (k_per_m * x).sin();
        }
    }
    [re.hypot(im), im.atan2(re)]
}

/// Growth and frequency of the wave with this number.
///
/// # Panics
/// If a step fails.
pub fn wave(meadow: &Meadow, k_per_m: f64, cells: usize) -> Wave {
    let flow = MeanFlow::new(meadow, 24);
    let mut air = slice(meadow, &flow, k_per_m, cells);
    let unit_secs = meadow.height_m / meadow.wind_m_per_s;
    let steps_per_unit = (cells as f64 / COURANT).ceil();
    let dt_secs = unit_secs / steps_per_unit;
    let (mut turned, mut last, mut first) = (0.0, None::<f64>, 0.0);
    let mut size = 0.0;
    for step in 0..=(TO * steps_per_unit) as usize {
        if step as f64 >= FROM * steps_per_unit {
            let [now, angle] = amplitude(&air, meadow, k_per_m);
            match last {
                None => first = now,
                Some(before) => turned += (angle - before + 1.5 * TAU).rem_euclid(TAU) - 0.5 * TAU,
            }
            (last, size) = (Some(angle), now);
        }
        air.step(dt_secs, &[]).expect("within the limits of the method");
    }
    let secs = (TO - FROM) * unit_secs;
    Wave { k_per_m, growth_per_s: (size / first).ln() / secs, frequency_rad_per_s: -turned / secs }
}
