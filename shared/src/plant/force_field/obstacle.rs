//! Obstacles to the wind.

use super::VolumeMesh;

/// An upright box that shelters the space behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacle {
    /// Its centre: X, height above the land, Z (m).
    pub at_m: [f32; 3],
    /// Half extents along its own axes, the second of them vertical (m); above 0.
    pub half_m: [f32; 3],
    /// Unit vector of its first axis on the ground, X and Z.
    pub along: [f32; 2],
    /// Fraction of a force that a volume full of it stops, 0..=1: 1 if solid.
    pub stops: f32,
}

/// Half the side of a square of the area of a unit circle: √π/2.
const HALF_SIDE_OF_ROUND: f32 = 0.886_227;

impl Obstacle {
    /// A solid ellipsoid, as the box with the same silhouettes.
    pub fn round(at_m: [f32; 3], radii_m: [f32; 3]) -> Self {
        Self { at_m, half_m: radii_m.map(|radius_m| HALF_SIDE_OF_ROUND * radius_m), along: [1.0, 0.0], stops: 1.0 }
    }

    /// Reduces the fraction that each volume lets through, according to the fraction of the volume that the obstacle fills.
    ///
    /// An obstacle narrower than a volume is widened to it, and stops less in proportion to the growth of its silhouette (horizontally, the mean of
    /// two). So up to the size of a volume it takes its silhouette from the wind, about the pressure of a drag coefficient of 1, to 16 % at any
    /// position, and its lee moves continuously. Larger ones take up to 1.4 times theirs, and a long one between two rows of volumes 1.9 times. A
    /// volume is treated as rotated with the body.
    pub(super) fn close(&self, mesh: &VolumeMesh, open: &mut [f32]) {
        let [x_m, height_m, z_m] = mesh.spacing_m;
        let [c, s] = self.along;
        let cell_m = [(c * x_m).hypot(s * z_m), height_m, (s * x_m).hypot(c * z_m)];
        let half_m: [f32; 3] = std::array::from_fn(|axis| self.half_m[axis].max(0.5 * cell_m[axis]));
        let [across, up, back] = std::array::from_fn(|axis| self.half_m[axis] / half_m[axis]);
        let stops = self.stops * up * (across * back).sqrt();
        let filled = |axis: usize, away_m: f32| ((half_m[axis] - away_m.abs()) / cell_m[axis] + 0.5).clamp(0.0, 1.0);

        let end_m: [f32; 3] = std::array::from_fn(|axis| half_m[axis] + 0.5 * cell_m[axis]);
        let reach_m = [c.abs() * end_m[0] + s.abs() * end_m[2], end_m[1], s.abs() * end_m[0] + c.abs() * end_m[2]];
        let [xs, ys, zs] = mesh.within(self.at_m, reach_m);
        for y in ys {
            for z in zs.clone() {
                for x in xs.clone() {
                    let center_m = mesh.center_m([x, y, z]);
                    let [east, rise, south]: [f32; 3] = std::array::from_fn(|axis| center_m[axis] - self.at_m[axis]);
                    let fraction = filled(0, c * east + s * south) * filled(1, rise) * filled(2, c * south - s * east);
                    open[mesh.place([x, y, z])] *= 1.0 - stops * fraction;
                }
            }
        }
    }
}
