//! Sources of force: moving air, and balls that fly or roll.

use super::ForceField;

/// Density of air (kg/m³), dry at 20 °C.
pub const AIR_KG_PER_M3: f32 = 1.2;

/// Dynamic pressure of air with a velocity (m/s), along it: ½ρ|u|u (Pa).
pub fn dynamic_pressure_pa([x, y, z]: [f32; 3]) -> [f32; 3] {
    let half = 0.5 * AIR_KG_PER_M3 * (x * x + y * y + z * z).sqrt();
    [half * x, half * y, half * z]
}

/// Wind along X and Z (m/s) whose dynamic pressure is the fraction `arriving` of that of a `wind_m_per_s` along each axis. Twin of `sheltered` in WGSL.
pub fn sheltered([x, z]: [f32; 2], arriving: [f32; 2]) -> [f32; 2] {
    let speed = (x * x + z * z).sqrt();
    let [x, z] = [arriving[0] * x * speed, arriving[1] * z * speed];
    let root = (x * x + z * z).sqrt().max(1e-12).sqrt();
    [x / root, z / root]
}

/// A moving ball, and the air that it displaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its centre: X, height above the land, Z (m).
    pub at_m: [f32; 3],
    /// Its radius (m); above 0.
    pub radius_m: f32,
    /// Its velocity (m/s).
    pub velocity_m_per_s: [f32; 3],
}

/// Distance from the centre of a ball, in radii, beyond which the displaced air is neglected; its pressure there is 1/729 of that at the ball.
const BALL_REACH: f32 = 3.0;

impl Ball {
    /// Force (Pa) of the displaced air at an offset from the ball's centre (m).
    ///
    /// Potential flow about a sphere (Lamb, Hydrodynamics, §92): the ball's velocity within it, outside the dipole u = ½(a/d)³·(3(v·n)n − v), n =
    /// offset/d. So air is pushed forward in front, outwards beside the front, back at the waist, and follows behind.
    pub fn force_pa(&self, offset_m: [f32; 3]) -> [f32; 3] {
        let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let (velocity, distance2) = (self.velocity_m_per_s, dot(offset_m, offset_m));
        if distance2 <= self.radius_m * self.radius_m {
            return dynamic_pressure_pa(velocity);
        }
        let fall = (self.radius_m * self.radius_m / distance2).powi(3).sqrt();
        let along = 3.0 * dot(velocity, offset_m) / distance2;
        dynamic_pressure_pa(std::array::from_fn(|axis| 0.5 * fall * (along * offset_m[axis] - velocity[axis])))
    }

    /// Adds the impulse of a step of `dt_secs` (s), above 0, to the field.
    ///
    /// A ball smaller than a volume is widened to half the volume's diagonal and its force reduced by the cube of that factor, so that no ball is lost
    /// between the volume centres and a small one has little effect.
    pub fn push(&self, field: &mut ForceField, dt_secs: f32) {
        let mesh = *field.mesh();
        let half_diagonal_m = 0.5 * mesh.spacing_m.iter().map(|h| h * h).sum::<f32>().sqrt();
        let wide = Self { radius_m: self.radius_m.max(half_diagonal_m), ..*self };
        let reach_m = BALL_REACH * wide.radius_m;
        let strength = dt_secs * (self.radius_m / wide.radius_m).powi(3);
        let [xs, ys, zs] = mesh.within(self.at_m, [reach_m; 3]);
        let volumes = ys.flat_map(|y| zs.clone().map(move |z| (y, z))).flat_map(|(y, z)| xs.clone().map(move |x| [x, y, z]));
        let impulses = volumes.filter_map(|volume| {
            let center_m = mesh.center_m(volume);
            let offset_m: [f32; 3] = std::array::from_fn(|axis| center_m[axis] - self.at_m[axis]);
            let is_near = offset_m.iter().map(|d| d * d).sum::<f32>() <= reach_m * reach_m;
            is_near.then(|| (volume, wide.force_pa(offset_m).map(|force| strength * force)))
        });
        field.strike(impulses, dt_secs);
    }
}
