//! Round objects that strike the grass (Chen & Johan, Eqs. 1 and 10–12).

use std::f32::consts::FRAC_PI_2;

use prairie_core::bend::{Bend, Field};

use super::{OneGrid, Real};

/// A round object that moves in a straight line during a step. Positions are metres from the centre of the world.
///
/// Every sum has two terms, so a quarter turn of the world only swaps and negates the operands, and the results keep their bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Striker {
    /// Position of the centre at the end of the step (m).
    pub at_m: [f32; 2],
    /// Velocity (m/s).
    pub velocity_m_per_s: [f32; 2],
    /// Radius (m).
    pub radius_m: f32,
    /// Height at which it strikes, h (m).
    pub strike_height_m: f32,
}

impl Striker {
    /// The object turned by a number of quarter turns about the centre of the world.
    pub fn turned(self, quarters: usize) -> Self {
        let turn = |vector: [f32; 2]| (0..quarters).fold(vector, |[x, z], _| [-z, x]);
        Self { at_m: turn(self.at_m), velocity_m_per_s: turn(self.velocity_m_per_s), ..self }
    }

    /// State of a cell at `center_m` (m from the centre of the world) after contact; `None` without contact. Eq. (1), with θ at most π/2, and Eq. (12) in
    /// the direction of Eq. (11).
    pub fn strike(&self, center_m: [f32; 2], theta_rad: f32, dt_secs: f32) -> Option<Bend> {
        let [u, w] = self.velocity_m_per_s;
        let speed = (u * u + w * w).sqrt();
        // Time of closest approach in this step, counted back from its end.
        let behind = [self.at_m[0] - center_m[0], self.at_m[1] - center_m[1]];
        let along = if speed > 0.0 { (behind[0] * u + behind[1] * w) / (speed * speed) } else { 0.0 };
        let back_secs = along.clamp(0.0, dt_secs);
        let away = [0, 1].map(|axis| back_secs * self.velocity_m_per_s[axis] - behind[axis]);
        let distance = (away[0] * away[0] + away[1] * away[1]).sqrt();
        if distance > self.radius_m {
            return None;
        }
        let faces_ahead = away[0] * u + away[1] * w >= 0.0;
        let is_border = distance > 0.6 * self.radius_m;
        let toward = |axis: usize| {
            let moving = if speed > 0.0 { self.velocity_m_per_s[axis] / speed } else { 0.0 };
            moving + if faces_ahead && is_border { away[axis] / distance } else { 0.0 }
        };
        let toward = [toward(0), toward(1)];
        let length = (toward[0] * toward[0] + toward[1] * toward[1]).sqrt();
        let direction = toward.map(|part| if length > 0.0 { part / length } else { 0.0 });
        let push = direction[0] * u + direction[1] * w;
        let omega = push * theta_rad.cos().powi(2) / self.strike_height_m;
        let theta = (theta_rad + omega * dt_secs).min(FRAC_PI_2);
        Some(Bend { theta, omega: direction.map(|part| part * omega) })
    }

    /// Presses every touched cell of a field in a step and wakes its patch.
    pub fn press(&self, field: &mut Field, dt_secs: f32) {
        for (cell, center_m) in self.within_reach(super::size(field), field.layout().cell_m, dt_secs) {
            let cell = cell.map(|n| n as i64);
            if let Some(bend) = self.strike(center_m, field.cell(cell).theta, dt_secs) {
                if let Some((patch, _)) = field.locate(cell) {
                    field.wake(patch);
                }
                field.press(cell, bend);
            }
        }
    }

    /// Presses every touched cell of a single grid.
    pub fn press_grid<T: Real>(&self, grid: &mut OneGrid<T>, dt_secs: f32) {
        for (cell, center_m) in self.within_reach(grid.size(), grid.cell_m(), dt_secs) {
            if let Some(bend) = self.strike(center_m, grid.bend(cell).theta, dt_secs) {
                grid.press(cell, bend);
            }
        }
    }

    /// Cells within reach in a step, with their centres (m from the centre of the world).
    fn within_reach(&self, size: [usize; 2], cell_m: f32, dt_secs: f32) -> impl Iterator<Item = ([usize; 2], [f32; 2])> {
        let reach_m = |axis: usize| self.radius_m + self.velocity_m_per_s[axis].abs() * dt_secs + cell_m;
        let range = |axis: usize| {
            let to_cell = |m: f32| (m / cell_m + 0.5 * size[axis] as f32).clamp(0.0, size[axis] as f32) as usize;
            to_cell(self.at_m[axis] - reach_m(axis))..to_cell(self.at_m[axis] + reach_m(axis))
        };
        let middle = move |n: usize, axis: usize| (2 * n as i64 + 1 - size[axis] as i64) as f32 * (0.5 * cell_m);
        let (columns, rows) = (range(0), range(1));
        rows.flat_map(move |j| columns.clone().map(move |i| ([i, j], [middle(i, 0), middle(j, 1)])))
    }
}
