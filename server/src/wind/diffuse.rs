//! Diffusion, explicit, in as many equal parts as its limit asks for.
//!
//! Air on a grid of metres has ν·dt/h² far below the limit, so that one sweep of seven reads a cell, a small part of the cost of an implicit solve, is
//! the rule.

use super::parallel::for_each_chunk;
use super::{Field, Grid, Place, Real};

/// Longest step (s) that [`diffuse`] bears: `1 / (2·ν·Σ 1/h²)`, which is `a = ν·dt/h² = 1/6` on cubes. Above it the checkerboard mode grows.
///
/// Infinite for a diffusivity of 0.
pub fn stable_dt_secs<R: Real>(grid: &Grid<R>, diffusivity_m2_per_s: R) -> R {
    let curvature = grid.spacing_m.iter().fold(R::zero(), |sum, &h| sum + (h * h).recip());
    (R::of(2.0) * diffusivity_m2_per_s * curvature).recip()
}

/// One explicit step of `∂φ/∂t = ν∇²φ` (forward Euler, central differences: first order in dt, second in h), from `field` into `target`.
///
/// No flux through walls; a velocity component that lives on a wall keeps its value there.
pub fn diffuse<R: Real>(grid: &Grid<R>, diffusivity_m2_per_s: R, dt_secs: R, field: &Field<R>, target: &mut Field<R>) {
    let [nx, ny, nz] = field.shape;
    let weight: [R; 3] = grid.spacing_m.map(|h| diffusivity_m2_per_s * dt_secs / (h * h));
    let on_wall = |axis: usize, i: usize| field.place == Place::Face(axis) && !grid.wraps(axis) && (i == 0 || i == grid.cells[axis]);
    let beside = |axis: usize, i: usize| {
        let last = field.shape[axis] - 1;
        let (first_below, last_above) = if grid.wraps(axis) { (last, 0) } else { (0, last) };
        (if i == 0 { first_below } else { i - 1 }, if i == last { last_above } else { i + 1 })
    };
    let row = |j: usize, k: usize| &field.data[nx * (j + ny * k)..][..nx];
    for_each_chunk(&mut target.data, nx * ny, |k, plane| {
        let (k_below, k_above) = beside(2, k);
        for (j, out) in plane.chunks_mut(nx).enumerate() {
            let here = row(j, k);
            if on_wall(1, j) || on_wall(2, k) {
                out.copy_from_slice(here);
                continue;
            }
            let (j_below, j_above) = beside(1, j);
            let (south, north, down, up) = (row(j, k_below), row(j, k_above), row(j_below, k), row(j_above, k));
            let spread = |i: usize, west: R, east: R| {
                let twice = here[i] + here[i];
                here[i]
                    + weight[0] * (west + east - twice)
                    + weight[1] * (down[i] + up[i] - twice)
                    + weight[2] * (south[i] + north[i] - twice)
            };
            for i in 1..nx.max(1) - 1 {
                out[i] = spread(i, here[i - 1], here[i + 1]);
            }
            for i in [0, nx - 1] {
                let (west, east) = beside(0, i);
                out[i] = if on_wall(0, i) { here[i] } else { spread(i, here[west], here[east]) };
            }
        }
    });
    debug_assert_eq!(target.data.len(), nx * ny * nz);
}
