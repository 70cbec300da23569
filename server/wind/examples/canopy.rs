//! Gusts over bare ground and over a grass canopy: a vertical section of the wind along x, and the mean profile.
//!
//! `cargo run --release -p prairie-wind --example canopy [PICTURE.ppm]` prints both, and writes the section over grass as a picture if a file is named.

use std::error::Error;

use prairie_wind::{Boundary, Canopy, Config, Gusts, Profile, WindSolver};

const CELLS: [usize; 3] = [96, 24, 32];
const GRASS_M: f32 = 1.0;
const SECS: f64 = 60.0;

fn main() -> Result<(), Box<dyn Error>> {
    let canopy = Canopy { height_m: GRASS_M, drag_per_m: 0.5, motion: None };
    let [bare, grass] = [run(None)?, run(Some(canopy))?];
    for (name, air) in [("bare ground", &bare), ("grass of 1 m", &grass)] {
        println!("\n{name}: wind along x, from 0 (space) to 8 m/s (@), 48 m long and 6 m high");
        section(air);
    }
    println!("\nmean wind (m/s) by height");
    println!("{:>8} {:>8} {:>8}", "y (m)", "bare", "grass");
    let [bare, grass] = [profile(&bare), profile(&grass)];
    for (j, (bare, grass)) in bare.iter().zip(&grass).enumerate().rev() {
        let note = if (j as f32 + 0.5) * 0.25 < GRASS_M { "  in the grass" } else { "" };
        println!("{:8.2} {bare:8.2} {grass:8.2}{note}", (j as f32 + 0.5) * 0.25);
    }
    Ok(())
}

/// The wind after a minute over ground with or without a canopy. With a canopy, writes a picture if a file is named.
fn run(canopy: Option<Canopy>) -> Result<WindSolver, Box<dyn Error>> {
    let config = Config {
        cells: CELLS,
        spacing_m: [0.5, 0.25, 0.5],
        boundary: [[Boundary::Wrap; 2], [Boundary::FreeSlip; 2], [Boundary::Wrap; 2]],
        viscosity_m2_per_s: 0.01,
        mean_wind_m_per_s: [4.0, 0.0, 0.0],
        profile: Profile::Log { roughness_m: 0.05, reference_m: 4.0 },
        gusts: Gusts { number: 16, strength_m_per_s: 6.0, radius_m: [3.0, 1.5, 3.0], ..Gusts::default() },
        canopy,
        ..Config::default()
    };
    let mut air = WindSolver::new(&config)?;
    while air.time_secs() < SECS {
        air.step(0.05, &[])?;
    }
    if let (Some(_), Some(path)) = (canopy, std::env::args().nth(1)) {
        std::fs::write(&path, picture(&air))?;
        println!("wrote {path}");
    }
    Ok(air)
}

fn section(air: &WindSolver) {
    const SHADES: &[u8] = b" .:-=+*#%@";
    for row in (0..CELLS[1]).rev().step_by(2) {
        let line = (0..CELLS[0]).map(|i| {
            let [u, ..] = air.velocity_at([0.5 * (i as f32 + 0.5), 0.25 * (row as f32 + 0.5), 8.0]);
            char::from(SHADES[((u / 8.0).clamp(0.0, 0.999) * SHADES.len() as f32) as usize])
        });
        println!("{}", line.collect::<String>());
    }
}

/// Mean velocity along x (m/s) of each layer.
fn profile(air: &WindSolver) -> Vec<f32> {
    let mut sums = vec![0.0; CELLS[1]];
    for (n, velocity) in air.cell_velocities().enumerate() {
        sums[n / CELLS[0] % CELLS[1]] += velocity.x;
    }
    sums.iter().map(|sum| sum / (CELLS[0] * CELLS[2]) as f32).collect()
}

/// The section as a binary PPM with eight pixels per metre in both directions: blue is calm, yellow 8 m/s.
fn picture(air: &WindSolver) -> Vec<u8> {
    let (width, height) = (4 * CELLS[0], 2 * CELLS[1]);
    let mut bytes = format!("P6 {width} {height} 255\n").into_bytes();
    for row in (0..height).rev() {
        for column in 0..width {
            let [u, ..] = air.velocity_at([(column as f32 + 0.5) / 8.0, (row as f32 + 0.5) / 8.0, 8.0]);
            let speed = (u / 8.0).clamp(0.0, 1.0);
            bytes.extend([255.0 * speed, 220.0 * speed, 160.0 * (1.0 - speed)].map(|channel| channel as u8));
        }
    }
    bytes
}
