//! A pulse crosses the bend field and is reflected at its free edge, drawn in the terminal.
//!
//! ```sh
//! cargo run --release -p prairie-core --example pulse
//! ```

use prairie_core::bend::{Bend, Edges, Field, Kinds, Scheme, Serial, StepError, WaveParams};
use prairie_core::grid::PatchLayout;

/// Largest bend of the pulse (rad).
const BEND_RAD: f32 = 1.0;

fn main() -> Result<(), StepError> {
    let layout = PatchLayout { count: [2, 1], cells: 64, cell_m: 0.25 };
    let waves = WaveParams { c0_m_per_s: 4.0, mu_m_per_rad: 0.0, theta_damping_per_s: 0.3, stiffness_per_s2: 0.0, ..WaveParams::default() };
    let mut field = Field::new(layout, Kinds::one(waves)).with_edges(Edges::Free);
    let dt_secs = 1.0 / 60.0;
    // Equal states at both times: the pulse starts at rest and spreads as a ring.
    field.start(dt_secs, |[x_m, z_m]| {
        let distance_m = (x_m - 9.0).hypot(z_m - 8.0);
        [Bend { theta: BEND_RAD * (-(distance_m / 1.5).powi(2)).exp(), omega: [0.0; 2] }; 2]
    });
    for frame in 0..4 {
        draw(&field, frame as f32 * 1.25);
        for _ in 0..75 {
            field.step(Scheme::Substepped, dt_secs, &Serial)?;
        }
    }
    Ok(())
}

/// Prints the bending angle: one character for a quarter by half a metre.
fn draw(field: &Field, time_secs: f32) {
    let most_rad = field.awake().map(|patch| patch.theta_max_rad()).fold(0.0, f32::max);
    println!("t = {time_secs:.2} s, largest bend {most_rad:.2} rad");
    for row in 0..32 {
        let line: String = (0..128).map(|column| shade(field.cell([column, 2 * row]).theta)).collect();
        println!("{}", line.trim_end());
    }
}

/// A character by the bend: symbols of growing weight for positive bends, letters for negative ones, blank near zero.
fn shade(theta_rad: f32) -> char {
    let level = (theta_rad.abs() / BEND_RAD * 30.0) as usize;
    let signs = if theta_rad >= 0.0 { " .:-=+*#%@" } else { " 'abcdefgh" };
    signs.chars().nth(level.min(9)).unwrap_or(' ')
}
