//! Stems that sway in the wind and act back on it.

use super::super::config::error::{ConfigError, above_zero, at_least_zero};
use super::super::solids::drag::speed_squared;
use super::super::{Grid, Location, Real, Velocity};
use super::Canopy;

/// Density of air (kg/m³) at 20 °C.
const AIR_KG_PER_M3: f64 = 1.2;

/// Motion of a canopy as a layer of oscillators, one mode each (Py, de Langre & Moulia, J. Fluid Mech. 568, 2006).
///
/// A stem at height y is displaced horizontally by `χ·q`, q the displacement of its top and χ = y/h, a straight stem that turns about its foot. The drag acts on the
/// relative velocity, with opposite signs on air and grass:
///
/// ```text
/// ∂u/∂t = … − C_d·a·|u − χq'|·(u − χq')
/// M·(q'' + 2ζω₀·q' + ω₀²·q) = ∫ ρ·C_d·a·|u − χq'|·(u − χq')·χ dy,    M = m/h·∫ χ² dy
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CanopyMotion {
    /// Natural frequency ω₀/2π of a stem (Hz). Default 1; above 0. Alfalfa has 1.05, wheat 2.5 (Py et al. 2006).
    pub frequency_hz: f32,
    /// Damping ratio ζ in still air, apart from drag. Default 0.05; 0 or more.
    pub damping_ratio: f32,
    /// Mass m of the plants per area of ground (kg/m²), the same at every height. Default 2; above 0.
    pub mass_kg_per_m2: f32,
}

impl Default for CanopyMotion {
    fn default() -> Self {
        Self { frequency_hz: 1.0, damping_ratio: 0.05, mass_kg_per_m2: 2.0 }
    }
}

impl CanopyMotion {
    pub(super) fn validate(&self) -> Result<(), ConfigError> {
        above_zero("canopy.motion.frequency_hz", self.frequency_hz)?;
        at_least_zero("canopy.motion.damping_ratio", self.damping_ratio)?;
        above_zero("canopy.motion.mass_kg_per_m2", self.mass_kg_per_m2)
    }
}

/// Part of the canopy in a layer of values.
#[derive(Clone, Copy, Debug)]
struct Layer<R> {
    /// Mode shape χ in the middle of the part.
    shape: R,
    /// Drag per length (1/m), averaged over the layer.
    drag_per_m: R,
}

/// Stems of the canopy, and the work arrays of their step.
///
/// Those that sway along x stand on the columns of faces across x, those that sway along z on the faces across z, so that a stem exchanges momentum with the faces
/// above one place alone. The step of a stem and its air is implicit: backward Euler for the drag, with |u − χq'| of its start, and the midpoint rule for the stem.
/// With v the mean of q' at both ends of the step, new air u* and the drag `F = r·(u* − χv)`, the kinetic energy of the air and the energy of the stem change in a step by
///
/// ```text
/// −dt·Σ r·(u* − χv)² − dt²·Σ F²/2 − 2ζω₀·dt·M·v² ≤ 0
/// ```
///
/// whatever the time step and the masses, since the momentum that the air loses is the one that the stem gains.
#[derive(Clone, Debug)]
pub(crate) struct Stems<R> {
    /// Displacement of the tops (m) along x and z, then their velocity (m/s) along x and z; each a value per column of faces, x fastest.
    pub(crate) values: [Vec<R>; 4],
    /// The values at the start of a sub-step, which may be rolled back.
    old: [Vec<R>; 4],
    /// Mean velocity (m/s) of the tops over a step, along x and z.
    middle: [Vec<R>; 2],
    /// Layers of faces across x and z, and of faces across y.
    layers: [Vec<Layer<R>>; 2],
    /// Acceleration of a stem by the drag in a layer, over χ times that of the air there: ratio of their masses.
    per_layer: R,
    frequency_rad_per_s: f64,
    damping_ratio: f64,
    /// Values in a row along x.
    row: usize,
}

impl<R: Real> Stems<R> {
    /// Upright stems at rest; none without a canopy that moves.
    pub(crate) fn new(grid: &Grid<R>, canopy: Option<&Canopy>) -> Option<Self> {
        let (canopy, motion) = canopy.and_then(|canopy| Some((canopy, canopy.motion?)))?;
        let [nx, ny, nz] = grid.cells;
        let (layer_m, height_m) = (grid.spacing_m[1].wide(), f64::from(canopy.height_m));
        let part = |middle_m: f64| {
            let (low_m, high_m) = ((middle_m - 0.5 * layer_m).max(0.0), middle_m + 0.5 * layer_m);
            let fraction = canopy.fraction(low_m, high_m);
            (0.5 * (low_m + high_m.min(height_m)) / height_m, fraction)
        };
        let heights = |offset: f64, count: usize| {
            (0..count).map(move |j| part((j as f64 + offset) * layer_m)).take_while(|(_, fraction)| *fraction > 0.0)
        };
        let layers = [heights(0.5, ny).collect::<Vec<_>>(), heights(0.0, ny + 1).collect()];
        let squares: f64 = layers[0].iter().map(|(shape, fraction)| fraction * shape * shape).sum();
        let columns = || vec![R::zero(); (nx + 1) * (nz + 1)];
        let layer =
            |(shape, fraction): &(f64, f64)| Layer { shape: R::of(*shape), drag_per_m: R::of(fraction * f64::from(canopy.drag_per_m)) };
        Some(Self {
            values: [columns(), columns(), columns(), columns()],
            old: [columns(), columns(), columns(), columns()],
            middle: [columns(), columns()],
            per_layer: R::of(AIR_KG_PER_M3 * height_m / (f64::from(motion.mass_kg_per_m2) * squares)),
            layers: layers.each_ref().map(|layers| layers.iter().map(layer).collect()),
            frequency_rad_per_s: std::f64::consts::TAU * f64::from(motion.frequency_hz),
            damping_ratio: motion.damping_ratio.into(),
            row: nx + 1,
        })
    }

    /// Keeps the present values for [`Stems::roll_back`].
    pub(crate) fn keep(&mut self) {
        self.old.iter_mut().zip(&self.values).for_each(|(old, values)| old.copy_from_slice(values));
    }

    /// Restores the values that were kept.
    pub(crate) fn roll_back(&mut self) {
        self.values.iter_mut().zip(&self.old).for_each(|(values, old)| values.copy_from_slice(old));
    }

    /// Number of values in memory.
    pub(crate) fn len(&self) -> usize {
        10 * self.middle[0].len()
    }

    /// Displacement (m) of the tops along x and z in the middle of each column of cells, x fastest.
    pub(crate) fn displacements<'a>(&'a self, grid: &'a Grid<R>) -> impl Iterator<Item = [R; 2]> + 'a {
        let ([nx, _, nz], half) = (grid.cells, R::of(0.5));
        (0..nx * nz).map(move |n| {
            let (i, k) = (n % nx, n / nx);
            let [east, south] = [self.after(grid, 0, i), self.after(grid, 2, k)];
            let [x, z] = [&self.values[0], &self.values[1]];
            [half * (x[i + self.row * k] + x[east + self.row * k]), half * (z[i + self.row * k] + z[i + self.row * south])]
        })
    }

    /// Exchanges momentum between stems and air for `dt_secs` (s). `cover` is the fraction of standing grass in each column of cells, x fastest. The ghosts of `velocity` must
    /// be filled; `rates` is a work array.
    pub(crate) fn sway(&mut self, grid: &Grid<R>, cover: &[R], dt_secs: f64, velocity: &mut Velocity<R>, rates: &mut Velocity<R>) {
        let dt = R::of(dt_secs);
        for axis in 0..3 {
            self.set_rates(grid, axis, velocity, rates);
        }
        for (sway, axis) in [0, 2].into_iter().enumerate() {
            self.swing(grid, [sway, axis], cover, dt_secs, velocity, rates);
        }
        for axis in 0..3 {
            let location = Location::Face(axis);
            for k in grid.free(location, 2) {
                for (j, layer) in self.layers_across(grid, axis) {
                    for i in grid.free(location, 0) {
                        let at = grid.at([i, j, k]);
                        let weight = dt * standing(grid, cover, i, k) * rates.0[axis].data[at];
                        let top = if axis == 1 { R::zero() } else { self.middle[axis / 2][i + self.row * k] };
                        let air = &mut velocity.0[axis].data[at];
                        *air = (*air + weight * layer.shape * top) / (R::one() + weight);
                    }
                }
            }
        }
    }

    /// The free layers of faces across `axis` in the canopy, with their indices.
    fn layers_across(&self, grid: &Grid<R>, axis: usize) -> impl Iterator<Item = (usize, &Layer<R>)> {
        let free = grid.free(Location::Face(axis), 1);
        self.layers[usize::from(axis == 1)].iter().enumerate().take(free.end).skip(free.start)
    }

    /// Sets the rate of drag `C_d·a·|u − χq'|` (1/s) on the faces across `axis`, of standing grass.
    fn set_rates(&self, grid: &Grid<R>, axis: usize, velocity: &Velocity<R>, rates: &mut Velocity<R>) {
        let (location, strides) = (Location::Face(axis), grid.strides());
        for k in grid.free(location, 2) {
            for (j, layer) in self.layers_across(grid, axis) {
                for i in grid.free(location, 0) {
                    let at = grid.at([i, j, k]);
                    let [x, z] = self.top_velocity(grid, axis, [i, k]);
                    let squares = speed_squared(velocity, strides, axis, at, [layer.shape * x, R::zero(), layer.shape * z]);
                    rates.0[axis].data[at] = layer.drag_per_m * squares.sqrt();
                }
            }
        }
    }

    /// Velocity (m/s) of the tops along x and z at a column of faces across `axis`: the mean of the nearest stems.
    fn top_velocity(&self, grid: &Grid<R>, axis: usize, [i, k]: [usize; 2]) -> [R; 2] {
        let (half, [x, z]) = (R::of(0.5), [&self.values[2], &self.values[3]]);
        let [west, east] = [self.before(grid, 0, i), self.after(grid, 0, i)];
        let [north, south] = [self.before(grid, 2, k), self.after(grid, 2, k)];
        let along_x = |k: usize| half * (x[i + self.row * k] + x[east + self.row * k]);
        let along_z = |i: usize| half * (z[i + self.row * k] + z[i + self.row * south]);
        match axis {
            0 => [x[i + self.row * k], half * (along_z(west) + along_z(i.min(grid.cells[0] - 1)))],
            2 => [half * (along_x(north) + along_x(k.min(grid.cells[2] - 1))), z[i + self.row * k]],
            _ => [along_x(k), along_z(i)],
        }
    }

    /// The place after place `n` along `axis`.
    fn after(&self, grid: &Grid<R>, axis: usize, n: usize) -> usize {
        if grid.wraps(axis) && n + 1 == grid.cells[axis] { 0 } else { n + 1 }
    }

    /// The place before place `n` along `axis`; the first one itself where the box ends.
    fn before(&self, grid: &Grid<R>, axis: usize, n: usize) -> usize {
        if n == 0 && grid.wraps(axis) { grid.cells[axis] - 1 } else { n.saturating_sub(1) }
    }

    /// Moves the stems that sway along `axis`.
    fn swing(&mut self, grid: &Grid<R>, [sway, axis]: [usize; 2], cover: &[R], dt_secs: f64, velocity: &Velocity<R>, rates: &Velocity<R>) {
        let location = Location::Face(axis);
        let [dt, half_dt] = [R::of(dt_secs), R::of(0.5 * dt_secs)];
        let turn = 0.5 * dt_secs * self.frequency_rad_per_s;
        let inertia = R::of(1.0 + 2.0 * self.damping_ratio * turn + turn * turn);
        let stiffness = R::of(turn * self.frequency_rad_per_s);
        for k in grid.free(location, 2) {
            for i in grid.free(location, 0) {
                let (column, standing) = (i + self.row * k, standing(grid, cover, i, k));
                let [mut push, mut drag] = [R::zero(); 2];
                for (j, layer) in self.layers[0].iter().enumerate() {
                    let at = grid.at([i, j, k]);
                    let rate = rates.0[axis].data[at];
                    let felt = layer.shape * rate / (R::one() + dt * standing * rate);
                    push = push + felt * velocity.0[axis].data[at];
                    drag = drag + felt * layer.shape;
                }
                let gain = half_dt * self.per_layer;
                let (place, speed) = (self.values[sway][column], self.values[2 + sway][column]);
                let middle = (speed - stiffness * place + gain * push) / (inertia + gain * drag);
                self.middle[sway][column] = middle;
                self.values[sway][column] = place + dt * middle;
                self.values[2 + sway][column] = middle + middle - speed;
            }
        }
    }
}

/// Fraction of standing grass at a column of faces.
fn standing<R: Real>(grid: &Grid<R>, cover: &[R], i: usize, k: usize) -> R {
    let [nx, _, nz] = grid.cells;
    cover[i.min(nx - 1) + nx * k.min(nz - 1)]
}

#[cfg(test)]
#[path = "motion_tests.rs"]
mod tests;
