//! The wind of a scene at one tick, at any place: the one rule by which server, page, HTTP API and recordings sample it.

use super::{CellGrid, Gusts, Turbulence, WindTiles, near_ground_fraction};
use crate::bend::wind_lean_rad;
use crate::scene::Scene;
use crate::terrain::KindMap;
use crate::wire::TurbulenceState;
use crate::wire::quantise::CodeSteps;
use glam::Vec3;
use std::sync::Arc;

/// The wind as it goes out to clients: codes at the cell centres, and the gusts between them. Two fields with the same codes and the same state of the gusts
/// give the same bits on every machine.
#[derive(Clone, Debug)]
pub struct WindField {
    tiles: WindTiles,
    grid: CellGrid,
    turbulence: Turbulence,
    state: TurbulenceState,
    gusts: Gusts,
    /// Wind (m/s) at the cell centres, x fastest, then y, then z.
    velocities: Vec<Vec3>,
    /// Dust concentration at the cell centres; empty in a scene without dust.
    dust: Vec<f32>,
    /// Bend of each kind of grass in a wind of 10 m/s (rad).
    bends_rad: Vec<f32>,
    kinds: Arc<KindMap>,
    steps: CodeSteps,
}

impl WindField {
    /// Still air over `scene`, whose kinds of grass are mapped by `kinds`.
    pub fn still(scene: &Scene, kinds: Arc<KindMap>) -> Self {
        let grid = CellGrid::from(&scene.wind);
        Self {
            tiles: WindTiles::new(scene),
            grid,
            turbulence: Turbulence::new(scene),
            state: TurbulenceState::default(),
            gusts: Gusts::default(),
            velocities: vec![Vec3::ZERO; grid.cells.iter().product()],
            dust: Vec::new(),
            bends_rad: scene.kinds().iter().map(|grass| grass.wind_bend_rad).collect(),
            kinds,
            steps: CodeSteps::from(&scene.stream),
        }
    }

    /// Sets the wind to the planes u, v, w of wind codes, and a fourth of dust codes where there is one, and the gusts to `state`.
    ///
    /// # Panics
    /// When there are fewer than three planes of all cells.
    pub fn set(&mut self, codes: &[i16], state: &TurbulenceState) {
        let count = self.velocities.len();
        for (cell, velocity) in self.velocities.iter_mut().enumerate() {
            *velocity = Vec3::from_array([0, 1, 2].map(|plane| self.steps.wind_m_per_s(codes[plane * count + cell])));
        }
        self.dust = codes[3 * count..].iter().map(|code| self.steps.dust(*code)).collect();
        self.state = *state;
        self.gusts = self.turbulence.at(state);
    }

    /// Steps of the codes.
    pub fn code_steps(&self) -> &CodeSteps {
        &self.steps
    }

    /// Wind (m/s) at the cell centres, x fastest, then y, then z.
    pub fn velocities(&self) -> &[Vec3] {
        &self.velocities
    }

    /// State of the gusts.
    pub fn state(&self) -> &TurbulenceState {
        &self.state
    }

    /// The gusts of this moment.
    pub fn gusts(&self) -> &Gusts {
        &self.gusts
    }

    /// Wind (m/s) at a place (m: X, height above the ground, Z): [resolved](Self::resolved_at) and [gust](Self::gust_at), reduced
    /// [near the ground](near_ground_fraction).
    pub fn wind_at(&self, [x_m, above_m, z_m]: [f32; 3]) -> [f32; 3] {
        let ([u, v, w], [gust_u, gust_w]) = (self.resolved_at([x_m, above_m, z_m]), self.gust_at([x_m, z_m]));
        [u + gust_u, v, w + gust_w].map(|speed| speed * near_ground_fraction(above_m))
    }

    /// The solver's wind (m/s) at a place (m: X, height above the ground, Z): trilinear between cell centres, extended by the nearest cell, or periodically
    /// where the box wraps.
    pub fn resolved_at(&self, [x_m, above_m, z_m]: [f32; 3]) -> [f32; 3] {
        self.tiles.blend([x_m, z_m], |[x_m, z_m]| self.grid.trilinear([x_m, above_m, z_m], |cell| self.velocities[cell].to_array()))
    }

    /// Gust (m/s, along X and Z) at a place (m, X and Z): the turbulence that the solver's cells do not resolve, the same at all heights.
    pub fn gust_at(&self, at_m: [f32; 2]) -> [f32; 2] {
        self.gusts.at(at_m)
    }

    /// Equilibrium lean (rad, as a vector along X and Z) of the grass at a place (m, X and Z) in the wind of the lowest cells and its gusts.
    pub fn lean_at(&self, [x_m, z_m]: [f32; 2]) -> [f32; 2] {
        let ([u, _, w], [gust_u, gust_w]) = (self.resolved_at([x_m, 0.0, z_m]), self.gust_at([x_m, z_m]));
        wind_lean_rad([u + gust_u, w + gust_w], self.bends_rad[usize::from(self.kinds.at(x_m, z_m))])
    }

    /// Dust concentration at a place (m: X, height above the ground, Z); 0 in a scene without dust.
    pub fn dust_at(&self, [x_m, above_m, z_m]: [f32; 3]) -> f32 {
        if self.dust.is_empty() {
            return 0.0;
        }
        let [concentration] = self.tiles.blend([x_m, z_m], |[x_m, z_m]| self.grid.trilinear([x_m, above_m, z_m], |cell| [self.dust[cell]]));
        concentration
    }

    /// Upper bound of the wind speed (m/s) up to a height above the ground (m).
    pub fn strongest_m_per_s(&self, height_m: f32) -> f32 {
        let [nx, ny, nz] = self.grid.cells;
        let layers = ((height_m / self.grid.spacing_m[1] - 0.5).ceil().max(0.0) as usize).min(ny - 1) + 1;
        let columns = (0..nz).flat_map(|k| &self.velocities[nx * ny * k..][..nx * layers]);
        let square = columns.map(|velocity| velocity.length_squared()).fold(0.0, f32::max);
        square.sqrt() + self.gusts.bound_m_per_s()
    }
}

#[cfg(test)]
mod tests;
