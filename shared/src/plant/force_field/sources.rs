//! What gives the field its forces: air that flows, winds of simple shape, rain, and balls that fly or roll.

use super::ForceField;
use crate::hash::{folded, hash3};
use crate::scene::{Primitive, PrimitiveKind};

/// Density of air (kg/m³), dry at 20 °C.
pub const AIR_KG_PER_M3: f32 = 1.2;

/// Mass of a drop of rain (kg): a sphere of water 2 mm across. In heavy rain, 50 mm/h, half of the water falls in larger ones (Marshall & Palmer 1948).
pub const DROP_KG: f32 = 4.19e-6;

/// Speed at which such a drop falls (m/s; Gunn & Kinzer 1949).
pub const DROP_M_PER_S: f32 = 6.49;

/// Most places that drops fall at in a step. Where more fall, each place takes several at once.
pub const LOTS: u32 = 4096;

/// Water that falls in an hour on a square metre for each mm of rain, over the seconds of that hour (kg/m²/s).
const KG_PER_M2_S_OF_MM_PER_H: f32 = 1.0 / 3600.0;

/// Dynamic pressure of air that flows at a velocity (m/s), along it: ½ρ|u|u (Pa).
pub fn dynamic_pressure_pa([x, y, z]: [f32; 3]) -> [f32; 3] {
    let half = 0.5 * AIR_KG_PER_M3 * (x * x + y * y + z * z).sqrt();
    [half * x, half * y, half * z]
}

/// The force (Pa) that a flow primitive (Wejchert & Haumann 1991) has at a place (X, height above the land, Z; m); its centre is where `primitive.at_m` says,
/// however it drifts.
///
/// Its direction and its course are those of the flow: of one strength for `uniform`; for `source`, `sink` and `vortex` rising from the centre to its greatest
/// at half the radius, 2s/(1 + s²) of its speed at s half-radii; a `cyclone` is a vortex that draws in below its centre and lifts. All fall off to
/// nothing at the radius, by Π (1 − (d/radius)²)² along the three axes. The greatest force is that of air at `speed_m_per_s`.
pub fn primitive_pa(primitive: &Primitive, at_m: [f32; 3]) -> [f32; 3] {
    let offset: [f32; 3] = std::array::from_fn(|axis| (at_m[axis] - primitive.at_m[axis]) / primitive.radius_m);
    let weight: f32 = offset.iter().map(|d| (1.0 - d * d).max(0.0).powi(2)).product();
    // In half-radii.
    let [x, y, z] = offset.map(|d| 2.0 * d);
    let radial = 2.0 / (1.0 + x * x + y * y + z * z);
    let around = 2.0 / (1.0 + x * x + z * z);
    let [east, up, south] = match primitive.kind {
        PrimitiveKind::Uniform => [primitive.heading_rad.sin(), 0.0, -primitive.heading_rad.cos()],
        PrimitiveKind::Source => [radial * x, radial * y, radial * z],
        PrimitiveKind::Sink => [-radial * x, -radial * y, -radial * z],
        PrimitiveKind::Vortex => [around * z, 0.0, -around * x],
        PrimitiveKind::Cyclone => {
            let inwards = if y < 0.0 { 0.5 * around } else { 0.0 };
            let lift = 0.7 / (1.0 + (x * x + z * z) * (x * x + z * z));
            let [east, up, south] = [around * z - inwards * x, lift, -around * x - inwards * z];
            let longest = (east * east + up * up + south * south).sqrt().max(1.0);
            [east / longest, up / longest, south / longest]
        }
    };
    let speed = primitive.speed_m_per_s;
    dynamic_pressure_pa([east * speed, up * speed, south * speed]).map(|force| weight * force)
}

/// Rain over the whole mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rain {
    /// Water that falls (mm/h); 0 or more.
    pub rate_mm_per_h: f32,
    /// Seed of the places where drops fall.
    pub seed: u64,
}

impl Rain {
    /// Mean pressure of the drops that stop (Pa): the momentum that falls on a square metre in a second.
    pub fn mean_pa(&self) -> f32 {
        self.rate_mm_per_h * KG_PER_M2_S_OF_MM_PER_H * DROP_M_PER_S
    }

    /// Lets the drops of a step of `dt_secs` (s), above 0, fall at places that follow from the seed and the number of the step.
    ///
    /// A drop passes all volumes of its column, down to the first that is solid, and each gets its momentum over the column's area: what a silhouette there
    /// would stop. On average over steps that is [`mean_pa`](Self::mean_pa).
    pub fn fall(&self, field: &mut ForceField, tick: u32, dt_secs: f32) {
        let mesh = *field.mesh();
        let [nx, ny, nz] = mesh.count;
        let area_m2 = mesh.spacing_m[0] * mesh.spacing_m[2];
        let drops = self.rate_mm_per_h * KG_PER_M2_S_OF_MM_PER_H / DROP_KG * area_m2 * (nx * nz) as f32 * dt_secs;
        let drops_in_lot = (drops / LOTS as f32).max(1.0);
        let share = |bits: u32| (bits >> 8) as f32 / (1 << 24) as f32;
        let seed = folded(self.seed);
        // As often one more as makes the mean right.
        let lots = (drops / drops_in_lot + share(hash3([u32::MAX, tick, seed])[0])) as u32;
        let force_pa = field.rate_per_s(dt_secs) * drops_in_lot * DROP_KG * DROP_M_PER_S / area_m2;
        let place = |bits: u32, count: usize| ((u64::from(bits) * count as u64) >> 32) as usize;
        for drop in 0..lots {
            let [east, south, _] = hash3([drop, tick, seed]);
            let (x, z) = (place(east, nx), place(south, nz));
            let mut layers = (0..ny).rev();
            while let Some(y) = layers.next().filter(|&y| !field.is_solid([x, y, z])) {
                field.linger([x, y, z], [0.0, -force_pa, 0.0]);
            }
        }
    }
}

/// A ball that flies or rolls, and the air that it pushes along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its centre: X, height above the land, Z (m).
    pub at_m: [f32; 3],
    /// Its radius (m); above 0.
    pub radius_m: f32,
    /// Its velocity (m/s).
    pub velocity_m_per_s: [f32; 3],
}

/// Radii from the centre of a ball beyond which the air it moves is left out; its pressure there is 1/729 of that at the ball.
const BALL_REACH: f32 = 3.0;

impl Ball {
    /// The force (Pa) of the air that the ball moves, at an offset from its centre (m).
    ///
    /// The air flows as a perfect fluid about a sphere (Lamb, Hydrodynamics §92): within the ball with it, outside as the dipole
    /// u = ½(a/d)³·(3(v·n)n − v), n = offset/d. So it is pushed along in front, outwards beside the front, back at the waist, and follows behind.
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

    /// Gives the field the impulse of a step of `dt_secs` (s), above 0.
    ///
    /// A ball smaller than a volume is widened to half the volume's diagonal and its force lowered by the cube of that, so that no ball falls between the
    /// volumes and a small one does little.
    pub fn push(&self, field: &mut ForceField, dt_secs: f32) {
        let mesh = *field.mesh();
        let half_diagonal_m = 0.5 * mesh.spacing_m.iter().map(|h| h * h).sum::<f32>().sqrt();
        let wide = Self { radius_m: self.radius_m.max(half_diagonal_m), ..*self };
        let reach_m = BALL_REACH * wide.radius_m;
        let strength = field.rate_per_s(dt_secs) * dt_secs * (self.radius_m / wide.radius_m).powi(3);
        let index = mesh.index_of(self.at_m);
        let along = |axis: usize| {
            let reach = reach_m / mesh.spacing_m[axis];
            // Casts take what is below zero to zero.
            (index[axis] - reach).ceil() as usize..((index[axis] + reach + 1.0).floor() as usize).min(mesh.count[axis])
        };
        let [xs, ys, zs] = [0, 1, 2].map(along);
        for y in ys {
            for z in zs.clone() {
                for x in xs.clone() {
                    let center_m = mesh.center_m([x, y, z]);
                    let offset_m: [f32; 3] = std::array::from_fn(|axis| center_m[axis] - self.at_m[axis]);
                    if offset_m.iter().map(|d| d * d).sum::<f32>() <= reach_m * reach_m {
                        field.linger([x, y, z], wide.force_pa(offset_m).map(|force| strength * force));
                    }
                }
            }
        }
    }
}
