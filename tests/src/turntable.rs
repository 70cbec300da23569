//! Air that turns in a closed box, and the dust it carries.

use server::wind::{Advection, Boundary, Config, Dust, Real, Solver};

use crate::air::still_air;
use crate::problems::Rotation;

/// Share of the side within which, about the middle, air turns like a solid body.
pub const SOLID_RADIUS: f64 = 0.42;
/// Share of the side beyond which it is at rest.
const STILL_RADIUS: f64 = 0.49;

/// A square of `cells` × `cells` in x–z, closed all round, in which dust is carried by `advection`, and neither spreads nor settles.
///
/// Air turns as `rotation` says within [`SOLID_RADIUS`], and ever slower beyond: its stream function levels out before the walls. Differences of the stream
/// function between the corners of the cells make the velocity, so that it is free of divergence, and linear where air turns like a solid body.
pub fn turntable<R: Real>(rotation: Rotation, advection: Advection, cells: usize) -> Solver<R> {
    let spacing_m = rotation.side_m / cells as f64;
    let dust = Dust { advection, diffusivity_m2_per_s: 0.0, release_per_sec: 0.0, settling_per_sec: 0.0 };
    let closed = [Boundary::FreeSlip; 2];
    let config =
        Config { dust: Some(dust), ..still_air([cells, 1, cells], [spacing_m, 1.0, spacing_m], [closed, [Boundary::Wrap; 2], closed]) };
    let mut air = Solver::new(&config).expect("settings are allowed");
    let half_m = 0.5 * spacing_m;
    air.set_velocity(|position| {
        let [x, _, z] = position.map(R::wide);
        let u = stream_function(rotation, x, z - half_m) - stream_function(rotation, x, z + half_m);
        let w = stream_function(rotation, x + half_m, z) - stream_function(rotation, x - half_m, z);
        [R::of(u / spacing_m), R::zero(), R::of(w / spacing_m)]
    });
    air
}

/// ψ (m²/s) with u = −∂ψ/∂z and w = ∂ψ/∂x.
fn stream_function(rotation: Rotation, x: f64, z: f64) -> f64 {
    let [_, _, w] = rotation.velocity([0.5 * rotation.side_m + 1.0, 0.0, 0.5 * rotation.side_m]);
    let (x, z) = (x - 0.5 * rotation.side_m, z - 0.5 * rotation.side_m);
    let [solid, still] = [SOLID_RADIUS, STILL_RADIUS].map(|radius| (radius * rotation.side_m).powi(2));
    let square = x * x + z * z;
    // The angular velocity, which is the slope of this over the square of the radius, falls by a smooth step.
    let t = ((square - solid) / (still - solid)).clamp(0.0, 1.0);
    0.5 * w * (square.min(solid) + (still - solid) * (t - t * t * t + 0.5 * t.powi(4)))
}
