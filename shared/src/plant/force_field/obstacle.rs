//! What gets in the way of the wind.

use super::Mesh;

/// A body that keeps the wind away from what is behind it: a box that stands upright.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacle {
    /// Its centre: X, height above the land, Z (m).
    pub at_m: [f32; 3],
    /// Half its extents along its own axes, the second of them upright (m); above 0.
    pub half_m: [f32; 3],
    /// Direction of its first axis on the ground, X and Z; of length 1.
    pub along: [f32; 2],
    /// Share of a force that a volume full of it stops, 0..=1: 1 for what is solid.
    pub stops: f32,
}

/// Half the side of a square as large as a circle of radius 1: √π/2.
const HALF_SIDE_OF_ROUND: f32 = 0.886_227;

impl Obstacle {
    /// A solid ellipsoid, as the box of the same silhouettes.
    pub fn round(at_m: [f32; 3], radii_m: [f32; 3]) -> Self {
        Self { at_m, half_m: radii_m.map(|radius_m| HALF_SIDE_OF_ROUND * radius_m), along: [1.0, 0.0], stops: 1.0 }
    }

    /// Takes the share that it stops from what each volume lets through, by how much of the volume it fills.
    ///
    /// One narrower than a volume is widened to it, and stops the less the more its silhouette grows (level, the mean of its two). So up to the size of a
    /// volume it takes its silhouette from the wind, the pressure that a drag coefficient of 1 is about, to 16 % wherever it is, and its lee goes with it and
    /// not by leaps; larger ones take up to 1.4 times theirs, and a long one astride of two rows of volumes 1.9 times. A volume counts as turned as the body is.
    pub(super) fn close(&self, mesh: &Mesh, open: &mut [f32]) {
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
                    let share = filled(0, c * east + s * south) * filled(1, rise) * filled(2, c * south - s * east);
                    open[mesh.place([x, y, z])] *= 1.0 - stops * share;
                }
            }
        }
    }
}
