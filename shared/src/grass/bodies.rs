//! Contacts of objects with the grass, from their prisms and treads.

use super::contact::Contact;
use super::grass_properties::GrassProperties;
use super::swept_footprint::SweptFootprint;
use crate::body::{Body, Motion, Prism};
use crate::scene::{Objects, Tread, VehicleKind};
use crate::terrain::HeightMap;

/// Shapes and treads of every kind of object.
#[derive(Clone, Debug)]
pub(super) struct Bodies {
    kinds: Vec<(Body, Tread)>,
}

/// A prism low above the terrain.
struct LowPrism<'a> {
    prism: &'a Prism,
    motion: Motion,
    /// Centre of its floor (m).
    foot_m: [f32; 2],
    /// Height of its lowest point above the terrain (m).
    clearance_m: f32,
}

impl Bodies {
    /// The bodies of a scene's objects, in the order of [`VehicleKind::ALL`]; a kind without a shape does not touch the grass.
    pub(super) fn new(bodies: &[Body], objects: &Objects) -> Self {
        let body = |(at, kind)| (bodies.get(at).cloned().unwrap_or_default(), objects.tread(kind));
        Self { kinds: VehicleKind::ALL.into_iter().enumerate().map(body).collect() }
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
        self.prisms(motion, height).filter_map(move |LowPrism { prism, motion, foot_m, clearance_m }| {
            let clearance = clearance_m / properties.blade_height_m(foot_m);
            (clearance < 1.0).then(|| Contact {
                swept: SweptFootprint::new(prism, &motion, cell_m),
                strike_height_m: tread.strike_height_m,
                slip_bend_rad: libm::acosf(clearance),
                parts_grass: prism.parts_grass,
                flattened_fraction: if prism.bears_weight { tread.lays_share } else { 0.0 },
                is_at_rest: motion.is_at_rest,
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
        body.prisms.iter().map(move |prism| {
            let foot_m = prism.foot_m(&motion.to);
            let clearance_m = (prism.lowest_m(&motion.to) - height.height_m(foot_m[0], foot_m[1])).max(0.0);
            LowPrism { prism, motion, foot_m, clearance_m }
        })
    }
}
