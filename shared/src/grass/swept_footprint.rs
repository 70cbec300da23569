//! Swept footprints: the area that a convex prism sweeps over in one step (Chen & Johan, §5.1), and the contact time of each position.
//!
//! Seen from the body, a position on the ground moves through the prism on a path that is curved where the body turns. A step is divided into legs so
//! that the path deviates from a straight line by at most an eighth of a cell. The contact time is then that of a line through a convex polygon, at
//! any speed and step. A prism narrower than a cell counts as one cell wide, so that its track is connected.

use super::footprint::{Edge, Footprint};
use super::vector::length;
use crate::body::{BodyPose, Motion, Prism};
use std::f32::consts::{PI, TAU};

/// Cosine of the largest angle (2°) between parallel sides.
const PARALLEL: f32 = 0.9994;

/// Area that a convex prism sweeps over.
#[derive(Clone, Debug)]
pub struct SweptFootprint {
    /// The prism seen from above, in the level frame of its body (m).
    outline: Footprint,
    sides: Vec<Edge>,
    /// Sides that are not shared with another prism of the object.
    rims: Vec<Edge>,
    from: LevelFrame,
    turn_rad: f32,
    moved_m: [f32; 2],
    legs: u16,
}

/// Frame of a body seen from above.
#[derive(Clone, Copy, Debug)]
struct LevelFrame {
    at_m: [f32; 2],
    /// Angle of the body's right from +X towards +Z (rad), with its cosine and sine.
    angle_rad: f32,
    cos: f32,
    sin: f32,
}

impl LevelFrame {
    fn new(at_m: [f32; 2], angle_rad: f32) -> Self {
        let (sin, cos) = libm::sincosf(angle_rad);
        Self { at_m, angle_rad, cos, sin }
    }

    /// A direction of the world in the body's level frame.
    fn to_local(self, [x, z]: [f32; 2]) -> [f32; 2] {
        [self.cos * x + self.sin * z, self.cos * z - self.sin * x]
    }

    /// A direction of the level frame in the world.
    fn to_world(self, [x, z]: [f32; 2]) -> [f32; 2] {
        [self.cos * x - self.sin * z, self.cos * z + self.sin * x]
    }

    fn local(&self, [x, z]: [f32; 2]) -> [f32; 2] {
        self.to_local([x - self.at_m[0], z - self.at_m[1]])
    }

    fn world(&self, at_m: [f32; 2]) -> [f32; 2] {
        let [x, z] = self.to_world(at_m);
        [self.at_m[0] + x, self.at_m[1] + z]
    }
}

impl SweptFootprint {
    /// The area that `prism` sweeps over on cells of side `cell_m`.
    pub fn new(prism: &Prism, motion: &Motion, cell_m: f32) -> Self {
        let to_rad = angle_rad(&motion.to);
        let turn_rad = (to_rad - angle_rad(&motion.from) + PI).rem_euclid(TAU) - PI;
        let from = LevelFrame::new(motion.from.xz(), to_rad - turn_rad);
        let (outline, rims) = outline(prism, &motion.to, &LevelFrame::new(motion.to.xz(), to_rad), cell_m);
        let sides = outline.sides();
        let rims = sides.iter().zip(rims).filter_map(|(side, is_rim)| is_rim.then_some(*side)).collect();

        let [from_x, from_z] = motion.from.xz();
        let [to_x, to_z] = motion.to.xz();
        let moved_m = [to_x - from_x, to_z - from_z];
        let moved = length(moved_m);
        let reach_m = outline.corners_m().iter().copied().map(length).fold(0.0, f32::max) + moved;
        // Upper bound of the curvature of a path in the turning frame. Its sagitta in one of n legs is bend/(8·n²).
        let bend_m = turn_rad * turn_rad * reach_m + 2.0 * turn_rad.abs() * moved;
        let legs = (bend_m / cell_m).sqrt().ceil().max(1.0) as u16;
        Self { outline, sides, rims, from, turn_rad, moved_m, legs }
    }

    /// Lowest and highest coordinates (m).
    pub fn bounds_m(&self) -> [[f32; 2]; 2] {
        let reach_m = self.reach_m();
        let ends = [self.from.at_m, self.level(1.0).at_m];
        let axes = [0, 1];
        [axes.map(|axis| ends[0][axis].min(ends[1][axis]) - reach_m), axes.map(|axis| ends[0][axis].max(ends[1][axis]) + reach_m)]
    }

    /// Upper bound of the distance that any point of the prism moves (m).
    pub fn travel_m(&self) -> f32 {
        length(self.moved_m) + self.turn_rad.abs() * self.reach_m()
    }

    /// Distance of the farthest corner from the body's centre (m).
    fn reach_m(&self) -> f32 {
        self.outline.corners_m().iter().copied().map(length).fold(0.0, f32::max)
    }

    /// The legs of the step, in order.
    pub fn legs(&self) -> impl Iterator<Item = Leg<'_>> {
        let count = f32::from(self.legs);
        let level = move |n: u16| self.level(f32::from(n) / count);
        (0..self.legs).map(move |n| Leg { swept: self, from: level(n), to: level(n + 1), fraction: 1.0 / count })
    }

    fn level(&self, fraction: f32) -> LevelFrame {
        let at_m = [0, 1].map(|axis| self.from.at_m[axis] + self.moved_m[axis] * fraction);
        LevelFrame::new(at_m, self.from.angle_rad + self.turn_rad * fraction)
    }
}

/// Leg of a step: a fraction during which the prism moves along a nearly straight line.
pub struct Leg<'a> {
    swept: &'a SweptFootprint,
    from: LevelFrame,
    to: LevelFrame,
    /// Fraction of the step.
    pub fraction: f32,
}

/// Passage of a position on the ground through a prism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Fraction of the leg during which the position is within the prism.
    pub fraction: f32,
    /// Displacement over the whole leg of the prism's point at that position (m), as a vector on the ground.
    pub moves_m: [f32; 2],
    /// Position within the prism half-way through (m), in the level frame.
    pub local_m: [f32; 2],
}

impl Leg<'_> {
    /// Area that contains all positions that the prism passes over.
    pub fn cover(&self) -> Footprint {
        let corners = self.swept.outline.corners_m();
        Footprint::around([self.from, self.to].iter().flat_map(|level| corners.iter().map(|&corner| level.world(corner))).collect())
    }

    /// The passage of a position through the prism, or `None` when they do not meet.
    pub fn passage(&self, at_m: [f32; 2]) -> Option<Passage> {
        let (enters, leaves) = (self.from.local(at_m), self.to.local(at_m));
        let (mut first, mut last) = (0.0_f32, 1.0_f32);
        for side in &self.swept.sides {
            let [before, after] = [side.depth_m(enters), side.depth_m(leaves)];
            match (before < 0.0, after < 0.0) {
                (true, true) => return None,
                (true, false) => first = first.max(before / (before - after)),
                (false, true) => last = last.min(before / (before - after)),
                (false, false) => {}
            }
        }
        (first < last).then(|| {
            let middle = 0.5 * (first + last);
            let local_m = [0, 1].map(|axis| enters[axis] + (leaves[axis] - enters[axis]) * middle);
            Passage { fraction: last - first, moves_m: self.displacement_m(local_m), local_m }
        })
    }

    /// Displacement of a point of the prism over the whole leg (m), as a vector on the ground.
    pub fn displacement_m(&self, local_m: [f32; 2]) -> [f32; 2] {
        let ([from_x, from_z], [to_x, to_z]) = (self.from.world(local_m), self.to.world(local_m));
        [to_x - from_x, to_z - from_z]
    }

    /// A position of the world in the level frame half-way (m).
    pub fn local_m(&self, at_m: [f32; 2]) -> [f32; 2] {
        let (enters, leaves) = (self.from.local(at_m), self.to.local(at_m));
        [0, 1].map(|axis| 0.5 * (enters[axis] + leaves[axis]))
    }

    /// Whether a side of the area, in axes of the world, belongs to a side that is shared with another prism of the object.
    pub fn is_seam(&self, side: &Edge) -> bool {
        let normal = self.to_local(side.normal);
        let is_parallel = |own: &&Edge| own.normal[0] * normal[0] + own.normal[1] * normal[1] > PARALLEL;
        self.swept.sides.iter().filter(is_parallel).any(|own| !self.swept.rims.contains(own))
    }

    /// A direction of the world in the level frame half-way.
    pub fn to_local(&self, direction: [f32; 2]) -> [f32; 2] {
        self.middle().to_local(direction)
    }

    /// A direction of the level frame half-way in the world.
    pub fn to_world(&self, direction: [f32; 2]) -> [f32; 2] {
        self.middle().to_world(direction)
    }

    /// Sides in the level frame that are not shared with another prism of the object.
    pub fn rims(&self) -> &[Edge] {
        &self.swept.rims
    }

    /// Centre of the prism in the level frame (m).
    pub fn middle_m(&self) -> [f32; 2] {
        self.swept.outline.middle_m()
    }

    fn middle(&self) -> LevelFrame {
        LevelFrame::new(self.from.at_m, 0.5 * (self.from.angle_rad + self.to.angle_rad))
    }
}

/// Angle (rad) of the body's right axis from +X towards +Z, computed from its back axis, or from its right axis where the back axis is steep.
fn angle_rad(pose: &BodyPose) -> f32 {
    let along = |axis: [f32; 3]| {
        let tip = pose.point_m(axis);
        [tip[0] - pose.position_m[0], tip[2] - pose.position_m[2]]
    };
    let ([back_x, back_z], [right_x, right_z]) = (along([0.0, 0.0, 1.0]), along([1.0, 0.0, 0.0]));
    if length([back_x, back_z]) > 0.5 { libm::atan2f(-back_x, back_z) } else { libm::atan2f(right_z, right_x) }
}

/// Smallest vertical component of the body's up axis at which the prism touches the ground with its floor.
const UPRIGHT: f32 = 0.7;

/// The prism seen from above in its level frame, at least one cell wide, and which of its sides are rims.
fn outline(prism: &Prism, pose: &BodyPose, level: &LevelFrame, cell_m: f32) -> (Footprint, Vec<bool>) {
    let up = pose.point_m([0.0, 1.0, 0.0])[1] - pose.position_m[1];
    let [low, _] = prism.span_m;
    let seen = |heights: [f32; 2]| prism.corners(pose, heights).map(|[x, _, z]| level.local([x, z]));
    // From above, an upright prism is the affine image of its floor: convex, with the same sides.
    let (outline, rims) = if up > UPRIGHT {
        (Footprint::of(seen([low, low]).step_by(2).collect()), prism.seams.iter().map(|seam| !seam).collect())
    } else {
        let hull = Footprint::around(seen(prism.span_m).collect());
        let count = hull.corners_m().len();
        (hull, vec![true; count])
    };
    match outline.widened(cell_m) {
        Some(wide) => {
            let count = wide.corners_m().len();
            (wide, vec![true; count])
        }
        None => (outline, rims),
    }
}
