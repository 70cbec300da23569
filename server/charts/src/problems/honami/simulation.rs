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
const FROM: usize = 60;
const TO: usize = 100;
/// Nodes per height of the canopy of the wind at the start.
const NODES: usize = 24;

/// The wind over `meadow` in a slice of this length, with `cells` per height of the canopy, and the disturbance that `stream` (m²/s) describes, a function of x (m).
fn slice(meadow: &Meadow, length_m: f64, cells: usize, stream: impl Fn(f64) -> [f64; 2]) -> Solver<f64> {
    let (flow, spacing_m) = (MeanFlow::new(meadow, NODES), meadow.height_m / cells as f64);
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
        let [stream, rise] = stream(x).map(|value| value * depth_m * (-off * off).exp());
        [flow.at(y) - 2.0 * off / depth_m * stream, -rise, 0.0]
    });
    air
}

/// Number of steps in the time in which the wind passes the height of the canopy.
fn steps_per_unit(cells: usize) -> usize {
    (cells as f64 / COURANT).ceil() as usize
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
    let first_m_per_s = FIRST * meadow.wind_m_per_s;
    let stream = |x: f64| [(k_per_m * x).sin(), k_per_m * (k_per_m * x).cos()].map(|value| first_m_per_s * value);
    let mut air = slice(meadow, TAU / k_per_m, cells, stream);
    let unit_secs = meadow.height_m / meadow.wind_m_per_s;
    let steps = steps_per_unit(cells);
    let mut amplitudes = vec![];
    for step in 0..=TO * steps {
        if step >= FROM * steps {
            amplitudes.push(amplitude(&air, meadow, k_per_m));
        }
        air.step(unit_secs / steps as f64, &[]).expect("within the limits of the method");
    }
    let turned: f64 = amplitudes.windows(2).map(|pair| (pair[1][1] - pair[0][1] + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU).sum();
    let (secs, growth) = ((TO - FROM) as f64 * unit_secs, amplitudes[amplitudes.len() - 1][0] / amplitudes[0][0]);
    Wave { k_per_m, growth_per_s: growth.ln() / secs, frequency_rad_per_s: -turned / secs }
}

/// Waves over a long field, by time and place.
#[derive(Clone, Debug)]
pub struct WaveField {
    /// Time between rows (s).
    pub interval_secs: f64,
    /// Distance between columns (m).
    pub spacing_m: f64,
    /// Displacement of the tops (m): a row for each time, from the west.
    pub displacement_m: Vec<Vec<f64>>,
}

/// Columns and rows of a wave field.
const PLACES: usize = 32;
const TIMES: usize = 25;
/// Length of the field in heights of the canopy, and times of its first and last row as above.
const FIELD_LENGTH: f64 = 24.0;
const FIELD_FROM: usize = 120;
const FIELD_UNITS: usize = 40;

/// Waves that have grown from a faint random disturbance over a field that moves.
///
/// # Panics
/// If a step fails, or the canopy is rigid.
pub fn field(meadow: &Meadow, cells: usize) -> WaveField {
    let length_m = FIELD_LENGTH * meadow.height_m;
    // Waves of all numbers that fit, with phases that follow no pattern.
    let stream = |x: f64| {
        let of = |n: f64| {
            let (k, phase) = (n * TAU / length_m, 2.4 * n * n);
            [(k * x + phase).sin(), k * (k * x + phase).cos()]
        };
        (3..16).map(f64::from).map(of).fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d]).map(|value| 2e-3 * meadow.wind_m_per_s * value)
    };
    let mut air = slice(meadow, length_m, cells, stream);
    let unit_secs = meadow.height_m / meadow.wind_m_per_s;
    let steps = steps_per_unit(cells);
    let (every, mut displacement_m) = (FIELD_UNITS * steps / TIMES, vec![]);
    for step in 0..FIELD_FROM * steps + TIMES * every {
        if step >= FIELD_FROM * steps && (step - FIELD_FROM * steps).is_multiple_of(every) {
            let tops: Vec<f64> = air.canopy_displacements_m().expect("a canopy that moves").map(|[x, _]| x).collect();
            displacement_m.push((0..PLACES).map(|n| tops[n * tops.len() / PLACES]).collect());
        }
        air.step(unit_secs / steps as f64, &[]).expect("within the limits of the method");
    }
    let interval_secs = every as f64 / steps as f64 * unit_secs;
    WaveField { interval_secs, spacing_m: length_m / PLACES as f64, displacement_m }
}
