//! Fields of the streamed wind: components, slices, vorticity, divergence, dust and the gusts between the cells.
//!
//! Values at cells are in the order of the wind's codes: x fastest, then y, then z, one component after another.

use crate::snapshot::WindFrame;
use glam::Vec3;
use prairie_core::scene::Scene;
use prairie_core::terrain::KindMap;
use prairie_core::wind::{CellGrid, WindField};
use std::sync::Arc;

/// The wind of one frame, and the fields that follow from it.
///
/// The box is taken as flat: where it follows the terrain, Y is the height above the ground.
pub(super) struct WindFields {
    grid: CellGrid,
    wind: WindField,
    /// Concentration of dust at the cell centres; empty in scenes without dust.
    dust: Vec<f32>,
}

impl WindFields {
    /// Still air.
    pub(super) fn new(scene: &Scene) -> Self {
        Self { grid: CellGrid::from(&scene.wind), wind: WindField::still(scene, Arc::new(KindMap::uniform())), dust: Vec::new() }
    }

    /// Takes the wind of a frame; returns false for a frame of another shape.
    pub(super) fn set(&mut self, frame: &WindFrame) -> bool {
        let volume = frame.volume();
        if frame.cells.map(|n| n as usize) != self.grid.cells || frame.codes.len() < 3 * volume {
            return false;
        }
        self.wind.set(&frame.codes, &frame.turbulence);
        self.dust = frame.codes[3 * volume..].iter().map(|code| self.wind.code_steps().dust(*code)).collect();
        true
    }

    /// The wind at any place.
    pub(super) fn field(&self) -> &WindField {
        &self.wind
    }

    /// Cells along X, Y and Z.
    pub(super) fn cells(&self) -> [usize; 3] {
        self.grid.cells
    }

    /// Wind (m/s): u, v and w at the cell centres.
    pub(super) fn velocity(&self) -> Vec<f32> {
        (0..3).flat_map(|axis| self.wind.velocities().iter().map(move |velocity| velocity[axis])).collect()
    }

    /// Concentration of dust at the cell centres; `None` in scenes without dust.
    pub(super) fn dust(&self) -> Option<&[f32]> {
        (!self.dust.is_empty()).then_some(&self.dust)
    }

    /// Speed (m/s) in the lowest cells, row by row from the north.
    pub(super) fn ground_speed(&self) -> Vec<f32> {
        let [nx, ny, nz] = self.grid.cells;
        let velocities = self.wind.velocities();
        (0..nz).flat_map(|k| velocities[nx * ny * k..][..nx].iter().map(|velocity| velocity.length())).collect()
    }

    /// Speed (m/s) in the slice along X and Y through the middle of the box, row by row from the top.
    pub(super) fn section_speed(&self) -> Vec<f32> {
        let [nx, ny, nz] = self.grid.cells;
        let slice = &self.wind.velocities()[nx * ny * (nz / 2)..][..nx * ny];
        slice.rchunks(nx).flat_map(|row| row.iter().map(|velocity| velocity.length())).collect()
    }

    /// Gusts (m/s) that the cells do not resolve, at the cell centres of a box at the world's north-west corner: u, then w, row by row from the north.
    pub(super) fn gusts(&self) -> Vec<f32> {
        let ([nx, _, nz], [dx, _, dz]) = (self.grid.cells, self.grid.spacing_m);
        let places = (0..nx * nz).map(|at| [((at % nx) as f32 + 0.5) * dx, ((at / nx) as f32 + 0.5) * dz]);
        let gusts: Vec<_> = places.map(|at_m| self.wind.gust_at(at_m)).collect();
        (0..2).flat_map(|axis| gusts.iter().map(move |gust| gust[axis])).collect()
    }

    /// Vorticity (1/s) along X, Y and Z at the cell centres.
    pub(super) fn vorticity(&self) -> Vec<f32> {
        vorticity(&self.grid, self.wind.velocities())
    }

    /// Divergence (1/s) at the cell centres.
    pub(super) fn divergence(&self) -> Vec<f32> {
        divergence(&self.grid, self.wind.velocities())
    }
}

/// Curl of `velocities`: its components along X, Y and Z, one after another. Second order in the cell spacing.
fn vorticity(grid: &CellGrid, velocities: &[Vec3]) -> Vec<f32> {
    let component = |axis: usize| {
        let [next, last] = [(axis + 1) % 3, (axis + 2) % 3];
        let curl = move |cell| derivative(grid, velocities, cell, next, last) - derivative(grid, velocities, cell, last, next);
        (0..velocities.len()).map(curl)
    };
    (0..3).flat_map(component).collect()
}

/// Divergence of `velocities`. Second order in the cell spacing.
fn divergence(grid: &CellGrid, velocities: &[Vec3]) -> Vec<f32> {
    (0..velocities.len()).map(|cell| (0..3).map(|axis| derivative(grid, velocities, cell, axis, axis)).sum()).collect()
}

/// Derivative along `axis` of a component at a cell centre: central differences, and beside a boundary that is not periodic one-sided ones of the same
/// second order. First order where there are only two cells along the axis, and 0 where there is one.
fn derivative(grid: &CellGrid, velocities: &[Vec3], cell: usize, axis: usize, component: usize) -> f32 {
    let [nx, ny, _] = grid.cells;
    let (stride, count, spacing_m) = ([1, nx, nx * ny][axis], grid.cells[axis], grid.spacing_m[axis]);
    let at = cell / stride % count;
    let value = |n: usize| velocities[cell - at * stride + n * stride][component];
    let difference = match at {
        _ if count == 1 => 0.0,
        _ if grid.periodic[axis] => 0.5 * (value((at + 1) % count) - value((at + count - 1) % count)),
        _ if count == 2 => value(1) - value(0),
        0 => -1.5 * value(0) + 2.0 * value(1) - 0.5 * value(2),
        _ if at + 1 == count => 1.5 * value(at) - 2.0 * value(at - 1) + 0.5 * value(at - 2),
        _ => 0.5 * (value(at + 1) - value(at - 1)),
    };
    difference / spacing_m
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::scene::Wind;
    use prairie_core::wire::TurbulenceState;
    use prairie_core::wire::quantise::CodeSteps;
    use std::f32::consts::TAU;

    fn sampled(grid: &CellGrid, velocity: impl Fn(Vec3) -> Vec3) -> Vec<Vec3> {
        let [nx, ny, nz] = grid.cells;
        let center = |cell: usize| [cell % nx, cell / nx % ny, cell / (nx * ny)];
        let place = |cell| Vec3::from_array(std::array::from_fn(|axis| (center(cell)[axis] as f32 + 0.5) * grid.spacing_m[axis]));
        (0..nx * ny * nz).map(|cell| velocity(place(cell))).collect()
    }

    #[test]
    fn quadratic_winds_are_exact_up_to_the_boundary() {
        let grid = CellGrid { cells: [5, 4, 6], spacing_m: [2.0, 0.5, 1.0], periodic: [false; 3] };
        // Curl (2y, 0, −4x) + that of the solid rotation, divergence 1 + 6z.
        let wind = sampled(&grid, |p| Vec3::new(p.x + 3.0 * p.z, -2.0 * p.x * p.x, p.y * p.y - 2.0 * p.x + 3.0 * p.z * p.z));
        let places = sampled(&grid, |p| p);
        let (curl, div) = (vorticity(&grid, &wind), divergence(&grid, &wind));
        for (cell, place) in places.iter().enumerate() {
            let found = Vec3::new(curl[cell], curl[places.len() + cell], curl[2 * places.len() + cell]);
            let wanted = Vec3::new(2.0 * place.y, 3.0 + 2.0, -4.0 * place.x);
            assert!((found - wanted).length() < 1e-3, "curl {found} instead of {wanted} at {place}");
            assert!((div[cell] - (1.0 + 6.0 * place.z)).abs() < 1e-3, "divergence {} at {place}", div[cell]);
        }
    }

    /// Largest errors of vorticity and divergence of a wind of one wave in a periodic box of `n` cells along each axis.
    fn errors(n: usize) -> [f32; 2] {
        let grid = CellGrid { cells: [n; 3], spacing_m: [1.0 / n as f32; 3], periodic: [true; 3] };
        let wind = sampled(&grid, |p| Vec3::new((TAU * p.x).sin() * (TAU * p.z).cos(), 0.0, (TAU * p.x).cos()));
        let exact = sampled(&grid, |p| {
            let [sin_x, cos_x, sin_z, cos_z] = [(TAU * p.x).sin(), (TAU * p.x).cos(), (TAU * p.z).sin(), (TAU * p.z).cos()];
            TAU * Vec3::new(0.0, -sin_x * sin_z + sin_x, cos_x * cos_z)
        });
        let (curl, div) = (vorticity(&grid, &wind), divergence(&grid, &wind));
        let worst = |found: &[f32], wanted: &dyn Fn(&Vec3) -> f32| {
            found.iter().zip(&exact).map(|(found, exact)| (found - wanted(exact)).abs()).fold(0.0, f32::max)
        };
        [worst(&curl[n * n * n..2 * n * n * n], &|exact: &Vec3| exact.y), worst(&div, &|exact: &Vec3| exact.z)]
    }

    #[test]
    fn differences_are_of_second_order() {
        let [coarse, middle, fine] = [16, 32, 64].map(errors);
        for quantity in 0..2 {
            let orders = [coarse[quantity] / middle[quantity], middle[quantity] / fine[quantity]].map(f32::log2);
            assert!(orders.iter().all(|order| (1.9..2.1).contains(order)), "orders {orders:?}");
        }
    }

    #[test]
    fn fields_have_the_bits_of_the_codes() {
        let mut scene = crate::scenes::load("meadow").unwrap().scene;
        scene.wind = Wind { cells: [3, 2, 4], ..scene.wind };
        let mut fields = WindFields::new(&scene);
        let codes: Vec<i16> = (0..4 * 24).map(|at| 7 * at - 90).collect();
        let frame = WindFrame { cells: [3, 2, 4], codes: codes.clone(), turbulence: TurbulenceState::default(), tick: 1 };
        assert!(fields.set(&frame) && !fields.set(&WindFrame::default()));
        let steps = CodeSteps::from(&scene.stream);
        let velocity = fields.velocity();
        assert!(velocity.iter().zip(&codes).all(|(value, code)| *value == steps.wind_m_per_s(*code)) && velocity.len() == 72);
        assert!(fields.dust().unwrap().iter().zip(&codes[72..]).all(|(value, code)| *value == steps.dust(*code)));
        let speed = |cell: usize| Vec3::new(velocity[cell], velocity[24 + cell], velocity[48 + cell]).length();
        assert_eq!(fields.ground_speed()[3..6], [6, 7, 8].map(speed), "the second row is at z = 1");
        assert_eq!(fields.section_speed(), [15, 16, 17, 12, 13, 14].map(speed), "the top layer at z = 2 comes first");
    }

    #[test]
    fn gusts_are_those_of_the_wind() {
        let scene = crate::scenes::load("meadow").unwrap().scene;
        let mut fields = WindFields::new(&scene);
        let turbulence = TurbulenceState { friction_m_per_s: 0.5, ..TurbulenceState::default() };
        assert!(fields.set(&WindFrame { cells: [32, 8, 32], codes: vec![0; 3 * 8192], turbulence, tick: 1 }));
        let gusts = fields.gusts();
        let [u, w] = fields.field().gust_at([8.0 * 5.5, 8.0 * 2.5]);
        assert!(u != 0.0 && [gusts[2 * 32 + 5], gusts[1024 + 2 * 32 + 5]] == [u, w]);
        assert_eq!(gusts.len(), 2048);
    }
}
