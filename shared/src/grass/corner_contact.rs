//! Contact as published (Chen & Johan, §6): velocities of the grass are found at the corners of the swept area, and interpolated inside (Gouraud).
//!
//! The corners and the middle of the area are joined to triangles. A corner moves as the object does there and takes the shape vector of the side beside it that
//! is most nearly parallel to the motion (Eq. 10, Fig. 7); the middle has the moving vector alone. cos²θ of Eq. (12) is that of each cell.

use super::bending::direction;
use super::contact::{Contact, STANDSTILL_M_PER_S};
use super::footprint::{Edge, Footprint};
use super::swept_footprint::Leg;
use super::vector::{length, unit};

/// Weight below zero that counts as rounding on the border between two triangles.
const ROUNDING: f32 = 1e-3;

/// Velocities of grass within the area that one leg sweeps.
pub(super) struct CornerVelocities {
    middle_m: [f32; 2],
    middle_m_per_s: [f32; 2],
    sectors: Vec<Sector>,
}

/// Triangle between the middle and two neighbouring corners.
struct Sector {
    /// Rows that turn a distance from the middle (m) into the weights of the two corners.
    weights_per_m: [[f32; 2]; 2],
    /// Velocities of the two corners less that of the middle (m/s).
    change_m_per_s: [[f32; 2]; 2],
}

impl CornerVelocities {
    /// Velocities within the area of a leg that lasts `leg_secs`.
    pub(super) fn new(contact: &Contact, leg: &Leg<'_>, leg_secs: f32) -> Self {
        let area = leg.cover();
        let (corners_m, sides, middle_m) = (area.corners_m(), area.sides(), area.middle_m());
        let moves = |at_m: [f32; 2]| leg.displacement_m(leg.local_m(at_m)).map(|m| m / leg_secs);
        let middle_m_per_s = moves(middle_m);
        let velocities: Vec<_> = (0..corners_m.len())
            .map(|corner| {
                let beside = [sides[(corner + sides.len() - 1) % sides.len()], sides[corner % sides.len()]];
                let rims: Vec<Edge> = beside.into_iter().filter(|side| contact.parts_grass && !leg.is_seam(side)).collect();
                let out = [0, 1].map(|axis| corners_m[corner][axis] - middle_m[axis]);
                pushed_m_per_s(contact, moves(corners_m[corner]), corners_m[corner], &rims, out)
            })
            .collect();
        let pushed = unit(middle_m_per_s).filter(|_| length(middle_m_per_s) > STANDSTILL_M_PER_S);
        let middle_m_per_s = pushed.map_or([0.0; 2], |unit| unit.map(|u| u * length(middle_m_per_s).max(contact.settling_m_per_s)));
        let sectors = sectors(&area, middle_m, middle_m_per_s, &velocities);
        Self { middle_m, middle_m_per_s, sectors }
    }

    /// Velocity at a position within the area (m/s): its length is the speed at which grass is pushed, its direction that in which it bends.
    pub(super) fn at(&self, at_m: [f32; 2]) -> Option<[f32; 2]> {
        let from_middle_m = [at_m[0] - self.middle_m[0], at_m[1] - self.middle_m[1]];
        self.sectors.iter().find_map(|sector| {
            let [a, b] = sector.weights_per_m.map(|row| row[0] * from_middle_m[0] + row[1] * from_middle_m[1]);
            let [to_a, to_b] = sector.change_m_per_s;
            let velocity = [0, 1].map(|axis| self.middle_m_per_s[axis] + a * to_a[axis] + b * to_b[axis]);
            (a > -ROUNDING && b > -ROUNDING).then_some(velocity)
        })
    }
}

/// Velocity at which a corner with these rims beside it, `out` from the middle, pushes the grass (m/s).
fn pushed_m_per_s(contact: &Contact, velocity: [f32; 2], at_m: [f32; 2], rims: &[Edge], out: [f32; 2]) -> [f32; 2] {
    let moves = unit(velocity).filter(|_| length(velocity) > STANDSTILL_M_PER_S);
    let bends = moves.map_or_else(|| unit(out).unwrap_or([1.0, 0.0]), |moves| direction(moves, at_m, rims, f32::INFINITY));
    let speed = (velocity[0] * bends[0] + velocity[1] * bends[1]).max(contact.settling_m_per_s);
    bends.map(|component| component * speed)
}

fn sectors(area: &Footprint, middle_m: [f32; 2], middle_m_per_s: [f32; 2], velocities: &[[f32; 2]]) -> Vec<Sector> {
    let corners_m = area.corners_m();
    let next = |corner: usize| (corner + 1) % corners_m.len();
    (0..corners_m.len())
        .filter_map(|corner| {
            let ends = [corner, next(corner)];
            let [a, b] = ends.map(|end| [0, 1].map(|axis| corners_m[end][axis] - middle_m[axis]));
            let area_m2 = a[0] * b[1] - a[1] * b[0];
            let weights_per_m = [[b[1], -b[0]], [-a[1], a[0]]].map(|row| row.map(|m| m / area_m2));
            let change_m_per_s = ends.map(|end| [0, 1].map(|axis| velocities[end][axis] - middle_m_per_s[axis]));
            (area_m2 > 0.0).then_some(Sector { weights_per_m, change_m_per_s })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::swept_footprint::SweptFootprint;
    use super::*;
    use crate::body::{BodyPose, Motion, Prism};
    use crate::scene::{ObjectContact, VehicleKind};
    use std::f32::consts::FRAC_1_SQRT_2;

    const LEG_SECS: f32 = 0.02;

    /// Contact of a prism that moves so far towards −Z in a step.
    fn contact(prism: &Prism, moved_m: f32) -> Contact {
        let pose = |z: f32| BodyPose { position_m: [50.0, 0.0, z], ..BodyPose::IDENTITY };
        let motion = Motion {
            kind: VehicleKind::Car,
            from: pose(50.0),
            to: pose(50.0 - moved_m),
            velocity_m_per_s: [0.0, 0.0, -moved_m / LEG_SECS],
            part_rad: 0.0,
            is_at_rest: false,
        };
        Contact {
            swept: SweptFootprint::new(prism, &motion, 0.25),
            strike_height_m: 0.3,
            slip_bend_rad: 1.3,
            parts_grass: prism.parts_grass,
            settling_m_per_s: 0.3,
            flattened_fraction: 0.0,
            is_at_rest: false,
            method: ObjectContact::Interpolated,
        }
    }

    fn velocity(contact: &Contact, at_m: [f32; 2]) -> [f32; 2] {
        let leg = contact.swept.legs().next().unwrap();
        CornerVelocities::new(contact, &leg, LEG_SECS).at(at_m).unwrap_or_else(|| panic!("{at_m:?} is within the area"))
    }

    fn assert_near(found: [f32; 2], expected: [f32; 2]) {
        assert!((0..2).all(|axis| (found[axis] - expected[axis]).abs() < 0.01), "{found:?} instead of {expected:?}");
    }

    #[test]
    fn corners_bend_aside_as_in_figure_7_and_the_middle_ahead() {
        // 2 m × 4 m, 0.2 m ahead in 20 ms: the area reaches from 47.8 m to 52 m along Z.
        let car = contact(&Prism::cuboid([0.0; 3], [1.0, 0.5, 2.0]), 0.2);
        let aside = 10.0 * FRAC_1_SQRT_2 * FRAC_1_SQRT_2;
        for z in [47.81, 51.99] {
            assert_near(velocity(&car, [49.001, z]), [-aside, -aside]);
            assert_near(velocity(&car, [50.999, z]), [aside, -aside]);
        }
        assert_near(velocity(&car, [50.0, 49.9]), [0.0, -10.0]);
        // Half-way from the middle to a corner, the mean of both.
        assert_near(velocity(&car, [49.5, 48.85]), [-0.5 * aside, -0.5 * (10.0 + aside)]);
    }

    #[test]
    fn what_only_presses_and_what_is_shared_with_another_part_bends_nothing_aside() {
        let runner = contact(&Prism::runner([0.0; 3], [1.0, 0.5, 2.0]), 0.2);
        assert_near(velocity(&runner, [49.001, 48.0]), [0.0, -10.0]);
        // The right side is shared; the left one still parts the grass.
        let part = Prism { seams: vec![false, true, false, false], ..Prism::cuboid([0.0; 3], [1.0, 0.5, 2.0]) };
        let part = contact(&part, 0.2);
        assert!(velocity(&part, [49.001, 50.0])[0] < -4.0);
        assert!(velocity(&part, [50.999, 50.0])[0].abs() < 0.01, "{:?}", velocity(&part, [50.999, 50.0]));
    }

    #[test]
    fn below_what_hardly_moves_grass_sinks_outward() {
        let slow = contact(&Prism::cuboid([0.0; 3], [1.0, 0.5, 2.0]), 1e-5);
        let [x, z] = velocity(&slow, [50.999, 51.999]);
        assert!(x > 0.1 && z > 0.2 && (length([x, z]) - 0.3).abs() < 0.01, "{x}, {z}");
    }

    #[test]
    fn every_cell_of_the_area_has_a_velocity() {
        let sled = contact(&Prism::post(1.3, [-0.5, 0.5]), 0.4);
        let layout = crate::grid::PatchLayout { count: [8, 8], cells: 64, cell_m: 0.25 };
        let leg = sled.swept.legs().next().unwrap();
        let velocities = CornerVelocities::new(&sled, &leg, LEG_SECS);
        let runs = leg.cover().runs(&layout);
        let cells = runs.iter().flat_map(|run| (run.from..run.to).map(|column| [column, run.row].map(|at| (at as f32 + 0.5) * 0.25)));
        assert!(cells.clone().count() > 80 && cells.clone().all(|at_m| velocities.at(at_m).is_some()));
        assert!(velocities.at([60.0, 60.0]).is_some(), "the triangles of the corners reach to infinity");
    }
}
