//! The lid-driven cavity at Re = 100: the horizontal velocity on the vertical centreline, compared with Ghia et al. 1982.
//!
//! `cargo run --release -p prairie-wind --example cavity [PICTURE.ppm]` prints the profile, and writes the speed as a picture if a file is named.

use std::error::Error;

use prairie_wind::{Boundary, Config, Gusts, Profile, Solver};

const CELLS: usize = 64;
/// Height and horizontal velocity (table I).
const GHIA: [(f64, f64); 15] = [
    (0.0547, -0.03717),
    (0.0625, -0.04192),
    (0.0703, -0.04775),
    (0.1016, -0.06434),
    (0.1719, -0.10150),
    (0.2813, -0.15662),
    (0.4531, -0.21090),
    (0.5000, -0.20581),
    (0.6172, -0.13641),
    (0.7344, 0.00332),
    (0.8516, 0.23151),
    (0.9531, 0.68717),
    (0.9609, 0.73722),
    (0.9688, 0.78871),
    (0.9766, 0.84123),
];

fn main() -> Result<(), Box<dyn Error>> {
    let air = steady()?;
    print_profile(&air);
    if let Some(path) = std::env::args().nth(1) {
        std::fs::write(&path, picture(&air))?;
        println!("wrote {path}");
    }
    Ok(())
}

/// The flow after 20 s, when it no longer changes.
fn steady() -> Result<Solver<f64>, Box<dyn Error>> {
    let lid = Boundary::Lid { velocity_m_per_s: [1.0, 0.0, 0.0] };
    let config = Config {
        cells: [CELLS, CELLS, 1],
        spacing_m: [1.0 / CELLS as f32; 3],
        boundary: [[Boundary::NoSlip; 2], [Boundary::NoSlip, lid], [Boundary::Wrap; 2]],
        viscosity_m2_per_s: 0.01,
        mean_wind_m_per_s: [0.0; 3],
        profile: Profile::Uniform,
        gusts: Gusts { number: 0, ..Gusts::default() },
        ..Config::default()
    };
    let mut air = Solver::new(&config)?;
    while air.time_secs() < 20.0 {
        air.step(0.005, &[])?;
    }
    Ok(air)
}

fn print_profile(air: &Solver<f64>) {
    let u = |y: f64| air.velocity_at([0.5, y, 0.0])[0];
    println!("horizontal velocity on the centreline, −0.4 to 1 of the lid's; * solver, o Ghia et al.");
    for row in (0..=28).rev() {
        let y = f64::from(row) / 28.0;
        let column = |u: f64| ((u + 0.4) * 50.0).round() as usize;
        let mut line = vec![' '; 72];
        line[column(0.0)] = '|';
        line[column(u(y))] = '*';
        for (_, wanted) in GHIA.iter().filter(|(at, _)| (at * 28.0).round() as i32 == row) {
            line[column(*wanted)] = 'o';
        }
        println!("{y:5.2} {}", line.into_iter().collect::<String>().trim_end());
    }
    let largest = GHIA.iter().map(|&(y, wanted)| (u(y) - wanted).abs()).fold(0.0, f64::max);
    println!("largest difference from Ghia et al.: {largest:.4} of the lid's speed, on {CELLS} × {CELLS} cells");
}

/// The speed in grey levels, brightest at 0.6 m/s, as a binary PPM with four pixels per cell.
fn picture(air: &Solver<f64>) -> Vec<u8> {
    let side = 4 * CELLS;
    let mut bytes = format!("P6 {side} {side} 255\n").into_bytes();
    for row in (0..side).rev() {
        for column in 0..side {
            let [x, y] = [column, row].map(|n| (n as f64 + 0.5) / side as f64);
            let [u, v, _] = air.velocity_at([x, y, 0.0]);
            bytes.extend([(255.0 * (u.hypot(v) / 0.6).min(1.0)) as u8; 3]);
        }
    }
    bytes
}
