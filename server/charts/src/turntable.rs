//! Air that rotates in a closed box and carries dust.

use prairie_wind::{Advection, Boundary, Config, Dust, Real, Solver};

use crate::air::still_air;
use crate::problems::Rotation;

/// Radius of solid-body rotation about the middle, as a fraction of the side.
pub const SOLID_RADIUS: f64 = 0.42;
/// Radius beyond which the air is at rest, as a fraction of the side.
const STILL_RADIUS: f64 = 0.49;

/// A closed square of `cells` × `cells` in x–z, in which `advection` carries dust that neither diffuses nor settles.
///
/// Air follows `rotation` within [`SOLID_RADIUS`] and slows down beyond: the stream function levels out before the walls. The velocity is the difference of
/// the stream function between the corners of each cell, hence free of divergence, and linear in the solid-body region.
pub fn turntable<R: Real>(rotation: Rotation, advection: Advection, cells: usize) -> Solver<R> {
    let spacing_m = rotation.side_m / cells as f64;
    let dust = Dust { advection, diffusivity_m2_per_s: 0.0, release_per_s: 0.0, settling_per_s: 0.0 };
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
