//! How grass gives way to what touches it: direction (001 Eqs 10–11), speed (Eq. 12), bend (Eq. 1), and the terrain's limit.

use super::air::GroundWind;
use super::footprint::{Edge, Footprint};
use shared::bend::{Bend, Field};
use shared::terrain::HeightMap;
use std::f32::consts::FRAC_PI_2;

/// Slower than this an object counts as standing (m/s).
const STANDING_M_PER_S: f32 = 0.05;
/// Speed at which grass gives way below the weight of a standing object (m/s).
const SETTLING_M_PER_S: f32 = 0.3;
/// Least bending speed of pressed grass (rad/s): its direction is that of the bend, and must outlast the motion.
pub(super) const HELD_RAD_PER_S: f32 = 0.5;

/// What touches the grass.
pub struct Contact {
    /// Area that is touched.
    pub footprint: Footprint,
    /// Velocity over the ground (m/s).
    pub velocity_m_per_s: [f32; 2],
    /// Height above the ground at which it strikes (m), h of Eq. (12).
    pub strike_height_m: f32,
    /// Bend at which the grass slips below it (rad).
    pub slips_rad: f32,
    /// Whether it parts the grass sideways (Eq. 10).
    pub parts_grass: bool,
}

/// Largest bend (rad) of grass that leans along the unit vector `direction` on land of slope (∂h/∂x, ∂h/∂z): the bend of flat land
/// less the rise of the land ahead, at most a right angle (001 §4.3).
pub fn terrain_limit_rad(theta_max_rad: f32, slope: [f32; 2], direction: [f32; 2]) -> f32 {
    let rise = slope[0] * direction[0] + slope[1] * direction[1];
    (theta_max_rad - rise.atan()).clamp(0.0, FRAC_PI_2)
}

/// Bending speed (rad/s) of grass at bend `theta_rad` that an object pushes at `speed_m_per_s` along the bend, at height `height_m`:
/// `s·cos²θ / h` (001 Eq. 12).
pub fn bending_speed_rad_per_s(speed_m_per_s: f32, theta_rad: f32, height_m: f32) -> f32 {
    let cos = theta_rad.cos();
    speed_m_per_s * cos * cos / height_m
}

/// Bending direction (001 Eqs 10–11): the moving vector `moves` (unit), plus, within `rim_m` of the rim, the rim's outward normal where
/// it does not face backward.
pub fn direction(moves: [f32; 2], at_m: [f32; 2], sides: &[Edge], rim_m: f32) -> [f32; 2] {
    let nearest = sides.iter().map(|side| (side.depth_m(at_m), side.normal)).min_by(|a, b| a.0.total_cmp(&b.0));
    match nearest {
        Some((depth, [x, z])) if depth < rim_m && x * moves[0] + z * moves[1] >= 0.0 => unit([x + moves[0], z + moves[1]]).unwrap_or(moves),
        _ => moves,
    }
}

/// Presses the grass of awake patches, which the wind bends too, for a step of `dt_secs`. Returns the largest bending speed (rad/s).
pub fn press(field: &mut Field, contact: &Contact, wind: &GroundWind, height: &HeightMap, theta_max_rad: f32, dt_secs: f32) -> f32 {
    let cell_m = field.layout().cell_m;
    let speed = length(contact.velocity_m_per_s);
    let moves = if speed > STANDING_M_PER_S { unit(contact.velocity_m_per_s) } else { None };
    let (sides, middle) = (if contact.parts_grass { contact.footprint.sides() } else { vec![] }, contact.footprint.middle_m());
    let mut largest = 0.0_f32;
    for_each_cell(field, &contact.footprint, wind, |at_m, bend| {
        let direction = match moves {
            Some(moves) => direction(moves, at_m, &sides, cell_m),
            None => unit(bend.omega).or_else(|| unit([at_m[0] - middle[0], at_m[1] - middle[1]])).unwrap_or([1.0, 0.0]),
        };
        let [vx, vz] = contact.velocity_m_per_s;
        let along = (vx * direction[0] + vz * direction[1]).max(SETTLING_M_PER_S);
        let omega = bending_speed_rad_per_s(along, bend.theta, contact.strike_height_m);
        let terrain = terrain_limit_rad(theta_max_rad, height.slope(at_m[0], at_m[1]), direction);
        let limit = terrain.min(contact.slips_rad);
        let theta = if bend.theta < limit { limit.min(bend.theta + omega * dt_secs) } else { bend.theta.min(terrain) };
        let held = omega.max(HELD_RAD_PER_S);
        largest = largest.max(held);
        Some(Bend { theta, omega: direction.map(|d| d * held) })
    });
    largest
}

/// Lets `change` set the bend of each cell of awake patches within `footprint`, given the cell's centre (m) and the bend that it has
/// together with the wind's lean; what the field then holds is the rest.
pub fn for_each_cell(field: &mut Field, footprint: &Footprint, wind: &GroundWind, mut change: impl FnMut([f32; 2], Bend) -> Option<Bend>) {
    let layout = *field.layout();
    let cells = i64::from(layout.cells);
    for run in footprint.runs(&layout) {
        let (patch_z, j) = (run.row / cells, (run.row % cells) as usize);
        let z_m = (run.row as f32 + 0.5) * layout.cell_m;
        let wind_rad = wind.row(z_m);
        for patch_x in run.from / cells..=(run.to - 1) / cells {
            let Some(patch) = layout.index(patch_x, patch_z).and_then(|index| field.patch_mut(index)) else { continue };
            let first = patch_x * cells;
            for i in run.from.max(first)..run.to.min(first + cells) {
                let at_m = [(i as f32 + 0.5) * layout.cell_m, z_m];
                let i = (i - first) as usize;
                let wind_rad = wind_rad(at_m[0]);
                if let Some(bend) = change(at_m, leaning(patch.bend(i, j), wind_rad)) {
                    patch.press(i, j, leaning(bend, wind_rad.map(|lean| -lean)));
                }
            }
        }
    }
}

/// Least bending speed (rad/s) of grass that leans: ω tells the direction of the lean.
const TELLING_RAD_PER_S: f32 = 1e-3;

/// A bend with a lean (rad) added to it as a vector on the ground; its bending speed stays, and turns with it.
fn leaning(bend: Bend, lean_rad: [f32; 2]) -> Bend {
    let along = unit(bend.omega).unwrap_or_default();
    let lean = [0, 1].map(|axis| along[axis] * bend.theta + lean_rad[axis]);
    match unit(lean) {
        Some(along) => Bend { theta: length(lean), omega: along.map(|d| d * length(bend.omega).max(TELLING_RAD_PER_S)) },
        None => Bend { theta: 0.0, omega: bend.omega },
    }
}

pub(super) fn length([x, z]: [f32; 2]) -> f32 {
    (x * x + z * z).sqrt()
}

/// The vector at length 1, unless it is too short to have a direction.
pub(super) fn unit(v: [f32; 2]) -> Option<[f32; 2]> {
    let length = length(v);
    (length > 1e-6).then(|| v.map(|c| c / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leans_add_up_as_vectors_and_the_speed_turns_with_them() {
        let close = |a: Bend, theta: f32, omega: [f32; 2]| {
            (a.theta - theta).abs() < 1e-5 && (a.omega[0] - omega[0]).abs() < 1e-5 && (a.omega[1] - omega[1]).abs() < 1e-5
        };
        let east = Bend { theta: 0.4, omega: [2.0, 0.0] };
        assert!(close(leaning(east, [0.3, 0.0]), 0.7, [2.0, 0.0]), "along");
        assert!(close(leaning(east, [-0.9, 0.0]), 0.5, [-2.0, 0.0]), "against");
        assert!(close(leaning(east, [0.0, 0.3]), 0.5, [1.6, 1.2]), "across");
        assert!(close(leaning(Bend { theta: -0.4, ..east }, [0.0, 0.0]), 0.4, [-2.0, 0.0]), "a negative angle leans the other way");
        let still = leaning(Bend::default(), [0.0, -0.2]);
        assert!(still.theta == 0.2 && still.omega[0] == 0.0 && still.omega[1] < 0.0, "the wind alone gives a direction: {still:?}");
        assert!(leaning(leaning(Bend::default(), [0.2, 0.1]), [-0.2, -0.1]).theta < 1e-6);
    }
}
