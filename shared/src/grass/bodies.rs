//! Contacts of objects with the grass, from their prisms and treads.

use super::contact::{Contact, SETTLING_M_PER_S};
use super::grass_properties::GrassProperties;
use super::swept_footprint::SweptFootprint;
use crate::body::{Body, BodyPose, Motion, Prism, part_code};
use crate::scene::{ObjectContact, Objects, Tread, VehicleKind};
use crate::terrain::HeightMap;

/// Speed of a foot that is set down (m/s).
const TREADING_M_PER_S: f32 = 1.5;

/// Shapes and treads of every kind of object.
#[derive(Clone, Debug)]
pub(super) struct Bodies {
    kinds: Vec<(Body, Tread)>,
    contact: ObjectContact,
}

/// A prism low above the terrain.
struct LowPrism<'a> {
    prism: &'a Prism,
    motion: Motion,
    /// Centre of its floor (m).
    foot_m: [f32; 2],
    /// Height of its lowest point above the terrain (m).
    clearance_m: f32,
    /// Whether it is a foot that stands.
    stands: bool,
}

impl Bodies {
    /// The bodies of a scene's objects, in the order of [`VehicleKind::ALL`]; a kind without a shape does not touch the grass.
    pub(super) fn new(bodies: &[Body], objects: &Objects, contact: ObjectContact) -> Self {
        let body = |(at, kind)| (bodies.get(at).cloned().unwrap_or_default(), objects.tread(kind));
        Self { kinds: VehicleKind::ALL.into_iter().enumerate().map(body).collect(), contact }
    }

    /// Whether a rotor of this kind blows air down.
    pub(super) fn has_downwash(&self, kind: VehicleKind) -> bool {
        self.kinds[kind as usize].0.has_downwash
    }

    /// Contacts of an object with grass taller than the clearance of its prisms.
    pub(super) fn contacts<'a>(
        &'a self,
        motion: &Motion,
        height: &'a HeightMap,
        properties: &'a GrassProperties,
        cell_m: f32,
    ) -> impl Iterator<Item = Contact> + 'a {
        let tread = self.kinds[motion.kind as usize].1;
        self.prisms(motion, height).filter_map(move |LowPrism { prism, motion, foot_m, clearance_m, stands }| {
            let clearance = clearance_m / properties.blade_height_m(foot_m);
            (clearance < 1.0).then(|| Contact {
                swept: SweptFootprint::new(prism, &motion, cell_m),
                strike_height_m: tread.strike_height_m,
                slip_bend_rad: libm::acosf(clearance),
                parts_grass: prism.parts_grass,
                settling_m_per_s: if stands { TREADING_M_PER_S } else { SETTLING_M_PER_S },
                flattened_fraction: if prism.bears_weight { tread.lays_share } else { 0.0 },
                is_at_rest: motion.is_at_rest,
                method: self.contact,
            })
        })
    }

    /// Swept footprints of an object's prisms that are less than `below_m` above the terrain, with their clearance (m).
    pub(super) fn swept_below<'a>(
        &'a self,
        motion: &Motion,
        height: &'a HeightMap,
        below_m: f32,
        cell_m: f32,
    ) -> impl Iterator<Item = (SweptFootprint, f32)> + use<'a> {
        let low = self.prisms(motion, height).filter(move |low| low.clearance_m < below_m);
        low.map(move |LowPrism { prism, motion, clearance_m, .. }| (SweptFootprint::new(prism, &motion, cell_m), clearance_m))
    }

    fn prisms<'a>(&'a self, motion: &Motion, height: &'a HeightMap) -> impl Iterator<Item = LowPrism<'a>> + use<'a> {
        let body = &self.kinds[motion.kind as usize].0;
        let motion = if body.is_round { motion.without_rotation() } else { *motion };
        body.prisms.iter().filter_map(move |prism| {
            let stands = body.stride_m > 0.0 && prism.bears_weight;
            let motion = if stands { standing(&motion, prism, body.stride_m)? } else { motion };
            let foot_m = prism.foot_m(&motion.to);
            let clearance_m = (prism.lowest_m(&motion.to) - height.height_m(foot_m[0], foot_m[1])).max(0.0);
            Some(LowPrism { prism, motion, foot_m, clearance_m, stands })
        })
    }
}

/// The foot of a walk as it stands on the ground: a quarter of a stride ahead of the body's middle when it is set down, and as far behind when it is
/// lifted, so that it stays in its place meanwhile. `None` while it is in the air; of a body that stands still both feet are on the ground.
fn standing(motion: &Motion, foot: &Prism, stride_m: f32) -> Option<Motion> {
    let is_right = foot.outline_m.iter().map(|corner| corner[0]).sum::<f32>() > 0.0;
    // Quanta of the moving part's turn since this foot was set down.
    let since = part_code(motion.part_rad).wrapping_add(if is_right { i16::MIN } else { 0 });
    let (lifted, half) = (since < 0, f32::from(since & i16::MAX) / 32_768.0);
    if lifted && motion.from.position_m != motion.to.position_m {
        return None;
    }
    let ahead_m = 0.25 * stride_m * if lifted { 2.0 * half - 1.0 } else { 1.0 - 2.0 * half };
    let at = BodyPose { position_m: motion.to.point_m([0.0, 0.0, -ahead_m]), ..motion.to };
    Some(Motion { from: at, to: at, ..*motion })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::TAU;

    const STRIDE_M: f32 = 2.0;

    /// Where the feet stand (m north of the start) after a walk north of `walked_m`.
    fn feet_m(walked_m: f32, moves: bool) -> [Option<f32>; 2] {
        let part_rad = walked_m / STRIDE_M * TAU;
        let pose = |z: f32| BodyPose { position_m: [5.0, 1.0, -z], ..BodyPose::IDENTITY };
        let from = pose(if moves { walked_m - 0.02 } else { walked_m });
        let motion =
            Motion { kind: VehicleKind::Walker, from, to: pose(walked_m), velocity_m_per_s: [0.0; 3], part_rad, is_at_rest: false };
        [-0.2, 0.2].map(|x| {
            let foot = Prism::runner([x, -0.85, 0.0], [0.05, 0.05, 0.15]);
            standing(&motion, &foot, STRIDE_M).map(|stands| -stands.to.position_m[2])
        })
    }

    #[test]
    fn feet_stand_in_turn_and_stay_in_their_places() {
        for n in 0..400 {
            let walked_m = 0.013 * n as f32;
            // Of each stride the left foot stands half a metre ahead of its begin, the right one half a metre behind its end.
            let (stride, within_m) = ((walked_m / STRIDE_M).floor(), walked_m % STRIDE_M);
            if [0.0, 1.0, 2.0].iter().any(|change_m: &f32| (within_m - change_m).abs() < 1e-3) {
                continue;
            }
            let [left, right] = feet_m(walked_m, true);
            let (stands, lifted, at_m) = if within_m < 1.0 { (left, right, 0.5) } else { (right, left, 1.5) };
            assert!(lifted.is_none() && (stands.unwrap() - (stride * STRIDE_M + at_m)).abs() < 1e-3, "{walked_m}: {left:?} {right:?}");
        }
    }

    #[test]
    fn who_stands_still_stands_on_both_feet() {
        let [left, right] = feet_m(0.25 * STRIDE_M, false).map(Option::unwrap);
        assert!((left - right).abs() < 1e-3, "side by side half-way: {left} and {right}");
        let [left, right] = feet_m(0.0, false).map(Option::unwrap);
        assert!((left - 0.5).abs() < 1e-3 && (right + 0.5).abs() < 1e-3, "a stride apart: {left} and {right}");
    }
}
