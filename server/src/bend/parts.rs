//! The convex parts of objects, and where they touch the grass.

use super::contact::Contact;
use super::sward::Growth;
use super::swath::Swath;
use crate::objects::{Motion, Stand};
use shared::outline::convex_parts;
use shared::scene::{Objects, Tread, VehicleKind};
use shared::terrain::HeightMap;
use std::f32::consts::FRAC_1_SQRT_2;

/// Heights of the slices that a ball meets the grass with, over its radius; each is about twice as wide as the next.
const BALL_SLICES: [f32; 5] = [1.0, 0.25, 0.0625, 0.015_625, 0.003_906_25];

/// A convex part of an object, an upright prism in the body's axes; concave objects are several (001 §6).
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Corners seen from above: x to the right and z to the back (m), turning from +X towards +Z.
    pub outline_m: Vec<[f32; 2]>,
    /// Whether the edge from each corner to the next lies within the object, where another part goes on.
    pub seams: Vec<bool>,
    /// Lowest and highest point along the body's up axis (m).
    pub span_m: [f32; 2],
    /// Whether it parts the grass sideways (001 Eq. 10), or only rolls it down.
    pub parts_grass: bool,
    /// Whether the object's weight is on it, so that it lays the grass for a while.
    pub bears_weight: bool,
}

impl Part {
    /// A box about `center_m` (X, Y, Z).
    fn cuboid(center_m: [f32; 3], half_m: [f32; 3]) -> Self {
        let [x, y, z] = center_m;
        let [half_x, half_y, half_z] = half_m;
        let outline_m = vec![[x - half_x, z - half_z], [x + half_x, z - half_z], [x + half_x, z + half_z], [x - half_x, z + half_z]];
        Self { outline_m, seams: vec![false; 4], span_m: [y - half_y, y + half_y], parts_grass: true, bears_weight: false }
    }

    /// A wheel's track or a skid, which bears weight and rolls the grass down.
    fn runner(center_m: [f32; 3], half_m: [f32; 3]) -> Self {
        Self { parts_grass: false, bears_weight: true, ..Self::cuboid(center_m, half_m) }
    }

    /// An upright post, as near round as eight corners are, that bears weight and parts the grass.
    fn post(radius_m: f32, span_m: [f32; 2]) -> Self {
        let (r, d) = (radius_m, radius_m * FRAC_1_SQRT_2);
        let outline_m = vec![[r, 0.0], [d, d], [0.0, r], [-d, d], [-r, 0.0], [-d, -d], [0.0, -r], [d, -d]];
        Self { outline_m, seams: vec![false; 8], span_m, parts_grass: true, bears_weight: true }
    }

    /// The part's lowest point (m) where the body stands at `stand`.
    pub fn lowest_m(&self, stand: &Stand) -> f32 {
        self.corners(stand, self.span_m).map(|corner| corner[1]).fold(f32::INFINITY, f32::min)
    }

    /// Corners in the world at the heights `at_m` along the body's up axis, relative to the body's middle (m).
    pub(super) fn corners(&self, stand: &Stand, at_m: [f32; 2]) -> impl Iterator<Item = [f32; 3]> {
        self.outline_m.iter().flat_map(move |&[x, z]| at_m.map(|y| stand.point_m([x, y, z]).to_array()))
    }

    /// Middle of the floor in the world (m).
    fn foot_m(&self, stand: &Stand) -> [f32; 2] {
        let count = self.outline_m.len() as f32;
        let [x, z] = [0, 1].map(|axis| self.outline_m.iter().map(|corner| corner[axis]).sum::<f32>() / count);
        let foot = stand.point_m([x, self.span_m[0], z]);
        [foot.x, foot.z]
    }
}

/// The parts of a kind that can touch grass, the higher first: from where those leave it, the lower press it on.
pub fn parts(kind: VehicleKind, objects: &Objects) -> Vec<Part> {
    match kind {
        VehicleKind::Car => {
            let wheels = |x: f32| Part::runner([x, -0.45, 0.0], [0.13, 0.25, 1.6]);
            vec![Part::cuboid([0.0, 0.1, 0.0], [0.95, 0.5, 2.2]), wheels(-0.8), wheels(0.8)]
        }
        VehicleKind::Monster => vec![Part::post(0.6, [-0.9, 0.9])],
        VehicleKind::Helicopter => {
            let skid = |x: f32| Part::runner([x, -1.2, 0.0], [0.15, 0.1, 1.8]);
            vec![Part::cuboid([0.0, -0.35, 0.0], [0.9, 0.65, 2.6]), skid(-0.95), skid(0.95)]
        }
        VehicleKind::Sled => {
            let [_, half_m, _] = objects.half_extents_m(kind);
            let whole = convex_parts(&objects.sled_outline_m).into_iter();
            let part = |part: shared::outline::ConvexPart| Part {
                outline_m: part.corners_m,
                seams: part.seams,
                span_m: [-half_m, half_m],
                parts_grass: true,
                bears_weight: true,
            };
            whole.map(part).collect()
        }
        VehicleKind::Ball => {
            let radius_m = objects.ball_radius_m;
            // At the height q·r above its foot a ball of radius r is r·√(2q − q²) wide; only what is lower than the grass touches it.
            let slice = |q: f32| Part::post(radius_m * (2.0 * q - q * q).sqrt(), [(q - 1.0) * radius_m, radius_m]);
            BALL_SLICES.map(slice).to_vec()
        }
    }
}

/// The parts and the tread of every kind.
#[derive(Clone, Debug)]
pub struct Bodies {
    kinds: Vec<(Vec<Part>, Tread)>,
}

impl Bodies {
    /// The bodies of a scene's objects.
    pub fn new(objects: &Objects) -> Self {
        Self { kinds: VehicleKind::ALL.map(|kind| (parts(kind, objects), objects.tread(kind))).to_vec() }
    }

    /// Where a motion touches grass: parts that are lower than the grass is high.
    pub fn contacts<'a>(
        &'a self,
        motion: &Motion,
        height: &'a HeightMap,
        growth: &'a Growth,
        cell_m: f32,
    ) -> impl Iterator<Item = Contact> + 'a {
        let tread = self.kinds[motion.kind as usize].1;
        self.passing(motion, height).filter_map(move |(part, motion, foot_m, clearance_m)| {
            let clearance = clearance_m / growth.blade_m(foot_m);
            (clearance < 1.0).then(|| Contact {
                swath: Swath::new(part, &motion, cell_m),
                strike_height_m: tread.strike_height_m,
                slips_rad: clearance.acos(),
                parts_grass: part.parts_grass,
                lays_share: if part.bears_weight { tread.lays_share } else { 0.0 },
                rests: motion.rests,
            })
        })
    }

    /// What a motion's parts sweep over at less than `below_m` above the land, and how high above it (m).
    pub fn passages<'a>(
        &'a self,
        motion: &Motion,
        height: &'a HeightMap,
        below_m: f32,
        cell_m: f32,
    ) -> impl Iterator<Item = (Swath, f32)> + use<'a> {
        let low = self.passing(motion, height).filter(move |&(.., clearance_m)| clearance_m < below_m);
        low.map(move |(part, motion, _, clearance_m)| (Swath::new(part, &motion, cell_m), clearance_m))
    }

    /// Parts of a moving body, where their feet are (m), and how high above the land (m).
    fn passing<'a>(&'a self, motion: &Motion, height: &'a HeightMap) -> impl Iterator<Item = (&'a Part, Motion, [f32; 2], f32)> + use<'a> {
        // A ball is as round one way as the other.
        let motion = if motion.kind == VehicleKind::Ball { motion.unturned() } else { *motion };
        self.kinds[motion.kind as usize].0.iter().map(move |part| {
            let foot_m = part.foot_m(&motion.to);
            (part, motion, foot_m, (part.lowest_m(&motion.to) - height.height_m(foot_m[0], foot_m[1])).max(0.0))
        })
    }
}
