//! What drives the bend field (001 sections 4 and 5): regions, contact, air, propagation.

pub mod air;
pub mod contact;
pub mod footprint;
pub mod regions;
pub mod step;

use crate::objects::Motion;
use air::{GroundWind, Wash};
use contact::Contact;
use regions::Regions;
use shared::bend::{Field, Kinds, Patch, Report, Scheme, StepError};
use shared::grid::{PatchIndex, PatchLayout};
use shared::scene::{Scene, VehicleKind};
use shared::terrain::{CoverMap, HeightMap};
use std::sync::Arc;

/// A camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Whose.
    pub client: u32,
    /// Where (m).
    pub eye_m: [f32; 3],
}

/// Margin around what touches the grass within which patches are woken (m).
const MARGIN_M: f32 = 1.0;

/// The bend field and everything that drives it.
pub struct Meadow {
    field: Field,
    scheme: Scheme,
    height: Arc<HeightMap>,
    blade_m: f32,
    theta_max_rad: f32,
    regions: Regions,
    report: Report,
}

impl Meadow {
    /// A meadow at rest.
    pub fn new(scene: &Scene, height: Arc<HeightMap>, cover: &CoverMap) -> Self {
        let (settings, limit) = (scene.bend, scene.patches.awake_limit as usize);
        let mut field = Field::new(PatchLayout::from(&scene.patches), Kinds::of(scene, cover))
            .with_edges(settings.edges)
            .with_seams(settings.seams)
            .with_rest(settings.rest())
            .with_awake_limit(limit);
        if settings.scheme == Scheme::Modal {
            field.wake_all();
        }
        Self {
            field,
            scheme: settings.scheme,
            height,
            blade_m: scene.plants.height_m,
            theta_max_rad: scene.grass.theta_max_rad,
            regions: Regions::new(limit),
            report: Report::default(),
        }
    }

    /// The field.
    pub fn field(&self) -> &Field {
        &self.field
    }

    /// What the newest step took.
    pub fn report(&self) -> Report {
        self.report
    }

    /// Sum of θ² + ω² over all cells (mixed units).
    pub fn activity(&self) -> f64 {
        // The sum of nothing would be −0.
        self.field.awake().map(Patch::activity).fold(0.0, |sum, activity| sum + activity)
    }

    /// Patches let go so far because too many were awake.
    pub fn evicted(&self) -> u64 {
        self.regions.evicted()
    }

    /// One step: regions, contact and wash (which bend directly), propagation.
    pub fn step(&mut self, dt_secs: f32, motions: &[Motion], views: &[View], wind: &GroundWind) {
        let contacts: Vec<_> = motions.iter().flat_map(|motion| self.contacts(motion)).collect();
        let washes: Vec<_> = motions.iter().filter_map(|motion| self.wash(motion)).collect();
        if self.scheme != Scheme::Modal {
            let touched = self.touched(&contacts, &washes);
            self.regions.update(&mut self.field, &touched, views);
        }
        for contact in &contacts {
            contact::press(&mut self.field, contact, wind, &self.height, self.theta_max_rad, dt_secs);
        }
        for wash in &washes {
            wash.press(&mut self.field, wind, dt_secs);
        }
        self.report = self.propagate(dt_secs);
    }

    /// Carries the waves on. Grass that bends too fast for any number of sub-steps allowed is put to rest and counts as broken.
    fn propagate(&mut self, dt_secs: f32) -> Report {
        let mut broken = 0;
        loop {
            match self.field.step(self.scheme, dt_secs, &step::Pool) {
                Ok(report) => return Report { broken: report.broken + broken, ..report },
                Err(StepError::TooFast { omega_rad_per_s, .. }) => {
                    let fastest: Vec<_> =
                        self.field.awake().filter(|patch| patch.omega_max_rad_per_s() >= omega_rad_per_s).map(Patch::index).collect();
                    broken += fastest.len() as u32;
                    fastest.into_iter().for_each(|patch| self.field.sleep(patch));
                }
                // A checked scene gives a step of some length, and the modal scheme only what it can carry.
                Err(_) => return Report { broken, ..Report::default() },
            }
        }
    }

    /// Where a motion touches grass: parts that are lower than the grass is high.
    fn contacts(&self, motion: &Motion) -> Vec<Contact> {
        let cell_m = self.field.layout().cell_m;
        let [x, z] = motion.to.xz();
        let land_m = self.height.height_m(x, z);
        let [u, _, w] = motion.velocity_m_per_s;
        let touching = footprint::parts(motion.kind).iter().filter_map(|part| {
            let clearance = (part.lowest_m(&motion.to) - land_m).max(0.0) / self.blade_m;
            (clearance < 1.0).then(|| Contact {
                footprint: part.swept(motion, cell_m),
                velocity_m_per_s: [u, w],
                strike_height_m: motion.kind.strike_height_m(),
                slips_rad: clearance.acos(),
                parts_grass: part.parts_grass,
            })
        });
        touching.collect()
    }

    fn wash(&self, motion: &Motion) -> Option<Wash> {
        let at = motion.to.xz();
        let skids_m = motion.to.position_m[1] - motion.kind.half_extents_m()[1];
        (motion.kind == VehicleKind::Helicopter).then(|| Wash::below(at, skids_m - self.height.height_m(at[0], at[1])))?
    }

    fn touched(&self, contacts: &[Contact], washes: &[Wash]) -> Vec<PatchIndex> {
        let layout = self.field.layout();
        let around = |[low, high]: [[f32; 2]; 2]| layout.patches_touching(low.map(|m| m - MARGIN_M), high.map(|m| m + MARGIN_M));
        let bodies = contacts.iter().flat_map(|contact| around(contact.footprint.bounds_m()));
        bodies.chain(washes.iter().flat_map(|wash| around(wash.footprint().bounds_m()))).collect()
    }
}
