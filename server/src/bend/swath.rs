//! The area that a convex part sweeps over in one step (001 §5.1), and how long each place is in contact.
//!
//! A place on the ground passes through the part on a path that is curved where the body turns. A step is cut into as many legs as keep
//! that path within an eighth of a cell of a straight line; then the time in contact is that of a line through a convex polygon, whatever
//! the speed or the step. A part narrower than a cell counts as one cell wide, so that its track is connected.

use super::footprint::{Edge, Footprint};
use super::parts::Part;
use crate::objects::{Motion, Stand};
use std::f32::consts::{PI, TAU};

/// What a convex part sweeps over.
#[derive(Clone, Debug)]
pub struct Swath {
    /// The part seen from above, in the level frame of its body (m).
    outline: Footprint,
    sides: Vec<Edge>,
    /// Those of the sides that no other part of the object goes on beyond.
    rims: Vec<Edge>,
    from: Level,
    turn_rad: f32,
    moved_m: [f32; 2],
    legs: u16,
}

/// A body seen from above.
#[derive(Clone, Copy, Debug)]
struct Level {
    at_m: [f32; 2],
    /// Angle of the body's right from +X towards +Z (rad), with its cosine and sine.
    angle_rad: f32,
    cos: f32,
    sin: f32,
}

impl Level {
    fn new(at_m: [f32; 2], angle_rad: f32) -> Self {
        let (sin, cos) = angle_rad.sin_cos();
        Self { at_m, angle_rad, cos, sin }
    }

    /// A direction of the world in the body's level frame.
    fn turned_in(&self, [x, z]: [f32; 2]) -> [f32; 2] {
        [self.cos * x + self.sin * z, self.cos * z - self.sin * x]
    }

    /// A direction of the level frame in the world.
    fn turned_out(&self, [x, z]: [f32; 2]) -> [f32; 2] {
        [self.cos * x - self.sin * z, self.cos * z + self.sin * x]
    }

    fn local(&self, [x, z]: [f32; 2]) -> [f32; 2] {
        self.turned_in([x - self.at_m[0], z - self.at_m[1]])
    }

    fn world(&self, at_m: [f32; 2]) -> [f32; 2] {
        let [x, z] = self.turned_out(at_m);
        [self.at_m[0] + x, self.at_m[1] + z]
    }
}

impl Swath {
    /// What `part` sweeps over on cells of side `cell_m`.
    pub fn new(part: &Part, motion: &Motion, cell_m: f32) -> Self {
        let to_rad = angle_rad(&motion.to);
        let turn_rad = (to_rad - angle_rad(&motion.from) + PI).rem_euclid(TAU) - PI;
        let from = Level::new(motion.from.xz(), to_rad - turn_rad);
        let (outline, rims) = outline(part, &motion.to, &Level::new(motion.to.xz(), to_rad), cell_m);
        let sides = outline.sides();
        let rims = sides.iter().zip(rims).filter_map(|(side, is_rim)| is_rim.then_some(*side)).collect();

        let [from_x, from_z] = motion.from.xz();
        let [to_x, to_z] = motion.to.xz();
        let moved_m = [to_x - from_x, to_z - from_z];
        let moved = moved_m[0].hypot(moved_m[1]);
        let reach_m = outline.corners_m().iter().map(|[x, z]| x.hypot(*z)).fold(0.0, f32::max) + moved;
        // The path of a place in the turning frame bends by at most this, and its sagitta in one of n legs is bend/(8·n²).
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

    /// Longest way that any of its points goes (m), or a little more.
    pub fn way_m(&self) -> f32 {
        self.moved_m[0].hypot(self.moved_m[1]) + self.turn_rad.abs() * self.reach_m()
    }

    /// Distance of its farthest corner from the body's middle (m).
    fn reach_m(&self) -> f32 {
        self.outline.corners_m().iter().map(|[x, z]| x.hypot(*z)).fold(0.0, f32::max)
    }

    /// The step cut into legs, in order.
    pub fn legs(&self) -> impl Iterator<Item = Leg<'_>> {
        let count = f32::from(self.legs);
        let level = move |n: u16| self.level(f32::from(n) / count);
        (0..self.legs).map(move |n| Leg { swath: self, from: level(n), to: level(n + 1), share: 1.0 / count })
    }

    fn level(&self, share: f32) -> Level {
        let at_m = [0, 1].map(|axis| self.from.at_m[axis] + self.moved_m[axis] * share);
        Level::new(at_m, self.from.angle_rad + self.turn_rad * share)
    }
}

/// A share of a step during which a part moves as good as straight.
pub struct Leg<'a> {
    swath: &'a Swath,
    from: Level,
    to: Level,
    /// Share of the step that it takes.
    pub share: f32,
}

/// How a place on the ground passes through a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Share of the leg during which the place is within the part.
    pub share: f32,
    /// Way of the part's own point at that place (m), as a vector on the ground, over the whole leg.
    pub moves_m: [f32; 2],
    /// Where in the part the place is half-way through (m), in the level frame.
    pub local_m: [f32; 2],
}

impl Leg<'_> {
    /// An area that holds all places that the part passes over, and others.
    pub fn cover(&self) -> Footprint {
        let corners = self.swath.outline.corners_m();
        Footprint::around([self.from, self.to].iter().flat_map(|level| corners.iter().map(|&corner| level.world(corner))).collect())
    }

    /// How a place passes through the part; none where it does not.
    pub fn passage(&self, at_m: [f32; 2]) -> Option<Passage> {
        let (enters, leaves) = (self.from.local(at_m), self.to.local(at_m));
        let (mut first, mut last) = (0.0_f32, 1.0_f32);
        for side in &self.swath.sides {
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
            let ([from_x, from_z], [to_x, to_z]) = (self.from.world(local_m), self.to.world(local_m));
            Passage { share: last - first, moves_m: [to_x - from_x, to_z - from_z], local_m }
        })
    }

    /// A direction in the world as the level frame half-way sees it.
    pub fn turned_in(&self, direction: [f32; 2]) -> [f32; 2] {
        self.middle().turned_in(direction)
    }

    /// A direction of the level frame half-way in the world.
    pub fn turned_out(&self, direction: [f32; 2]) -> [f32; 2] {
        self.middle().turned_out(direction)
    }

    /// Sides of the part in the level frame, without those that another part goes on beyond.
    pub fn rims(&self) -> &[Edge] {
        &self.swath.rims
    }

    /// Middle of the part in the level frame (m).
    pub fn middle_m(&self) -> [f32; 2] {
        self.swath.outline.middle_m()
    }

    fn middle(&self) -> Level {
        Level::new(self.from.at_m, 0.5 * (self.from.angle_rad + self.to.angle_rad))
    }
}

/// Angle (rad) of the body's right from +X towards +Z: by its back, or where that points up, by its right.
fn angle_rad(stand: &Stand) -> f32 {
    let along = |axis: [f32; 3]| {
        let tip = stand.point_m(axis);
        [tip.x - stand.position_m[0], tip.z - stand.position_m[2]]
    };
    let ([back_x, back_z], [right_x, right_z]) = (along([0.0, 0.0, 1.0]), along([1.0, 0.0, 0.0]));
    if back_x.hypot(back_z) > 0.5 { (-back_x).atan2(back_z) } else { right_z.atan2(right_x) }
}

/// Least height of the tip of the body's unit up axis above its foot at which its floor is what touches the ground.
const UPRIGHT: f32 = 0.7;

/// The part seen from above in its level frame, at least one cell wide, and which of its sides are rims.
fn outline(part: &Part, stand: &Stand, level: &Level, cell_m: f32) -> (Footprint, Vec<bool>) {
    let up = stand.point_m([0.0, 1.0, 0.0]).y - stand.position_m[1];
    let [low, _] = part.span_m;
    let seen = |heights: [f32; 2]| part.corners(stand, heights).map(|[x, _, z]| level.local([x, z]));
    // An upright prism looks like its floor: an affine picture of it, so convex, with the same sides.
    let (outline, rims) = if up > UPRIGHT {
        (Footprint::of(seen([low, low]).step_by(2).collect()), part.seams.iter().map(|seam| !seam).collect())
    } else {
        let hull = Footprint::around(seen(part.span_m).collect());
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
