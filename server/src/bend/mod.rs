//! What drives the bend field (001 sections 4 and 5): regions, contact, air, propagation.

pub mod air;
mod breeze;
pub mod contact;
pub mod drawing;
pub mod drawn;
pub mod footprint;
pub mod laid;
pub mod parts;
pub mod regions;
pub mod step;
pub mod sward;
pub mod swath;

use crate::objects::{Motion, MotionError};
use air::GroundWind;
use breeze::Breeze;
use contact::Contact;
use drawing::Drawings;
use drawn::{Blow, Blows};
use laid::Laid;
use parts::Bodies;
use rayon::prelude::*;
use regions::Regions;
use shared::bend::{Field, Kinds, Patch, Report, Scheme, StepError};
use shared::grid::{PatchIndex, PatchLayout};
use shared::scene::Scene;
use shared::terrain::{CoverMap, HeightMap};
use std::sync::Arc;
use sward::{Growth, Sward};
use swath::Swath;

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
    growth: Growth,
    breeze: Option<Breeze>,
    bodies: Bodies,
    blows: Blows,
    laid: Laid,
    motions: Vec<Motion>,
    refused: Vec<MotionError>,
    refused_count: u64,
    broken: u64,
    regions: Regions,
    report: Report,
}

impl Meadow {
    /// A meadow at rest, without drawings for its winds.
    pub fn new(scene: &Scene, height: Arc<HeightMap>, cover: &CoverMap) -> Self {
        Self::with_drawings(scene, height, cover, &Drawings::new())
    }

    /// A meadow at rest; a wind whose drawing is not among `drawings` blows nothing.
    pub fn with_drawings(scene: &Scene, height: Arc<HeightMap>, cover: &CoverMap, drawings: &Drawings) -> Self {
        let (layout, settings, limit) = (PatchLayout::from(&scene.patches), scene.bend, scene.patches.awake_limit as usize);
        let field = Field::new(layout, Kinds::of(scene, cover))
            .with_edges(settings.edges)
            .with_seams(settings.seams)
            .with_rest(settings.rest())
            .with_awake_limit(limit);
        // As much as the awake patches could hold.
        let tile_limit = limit * (layout.cells as usize / laid::TILE).pow(2);
        Self {
            field,
            scheme: settings.scheme,
            height,
            growth: Growth::new(scene, cover),
            breeze: Breeze::new(scene),
            bodies: Bodies::new(&scene.objects),
            blows: Blows::new(scene, drawings),
            laid: Laid::new(layout, scene.grass.laid_recovery_secs, tile_limit),
            motions: vec![],
            refused: vec![],
            refused_count: 0,
            broken: 0,
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
        let patches: Vec<_> = self.field.awake().collect();
        let activities: Vec<_> = patches.par_iter().map(|patch| patch.activity()).collect();
        // The sum of nothing would be −0.
        activities.into_iter().fold(0.0, |sum, activity| sum + activity)
    }

    /// Patches let go so far because too many were awake.
    pub fn evicted(&self) -> u64 {
        self.regions.evicted()
    }

    /// Patches put to rest so far because their grass moved faster than the scheme can follow, or was no number.
    pub fn broken(&self) -> u64 {
        self.broken
    }

    /// What stays bent below the weight of objects.
    pub fn laid(&self) -> &Laid {
        &self.laid
    }

    /// What the parts of objects swept over in the newest step at less than `below_m` above the land, and how high above it (m).
    pub fn passages(&self, below_m: f32) -> impl Iterator<Item = (Swath, f32)> {
        let cell_m = self.field.layout().cell_m;
        self.motions.iter().flat_map(move |motion| self.bodies.passages(motion, &self.height, below_m, cell_m))
    }

    /// Lean of the grass at a place in a wind (rad, as a vector along X and Z), all that holds it together.
    pub fn lean_rad(&self, at_m: [f32; 2], wind: &GroundWind) -> [f32; 2] {
        sward::standing_rad(&self.field, &self.laid, wind, at_m)
    }

    /// Takes note that a patch was shown as it is.
    pub fn was_shown(&mut self, patch: PatchIndex) {
        self.laid.was_shown(patch);
        if let Some(patch) = self.field.patch_mut(patch) {
            patch.forget_changes();
        }
    }

    /// Motions that the newest step refused, and why; the grass did not feel them.
    pub fn refused(&self) -> &[MotionError] {
        &self.refused
    }

    /// Motions refused so far.
    pub fn refused_count(&self) -> u64 {
        self.refused_count
    }

    /// One step: regions, contact and blowing air (which bend directly), propagation. Motions that are none are [refused](Self::refused).
    pub fn step(&mut self, dt_secs: f32, motions: &[Motion], views: &[View], wind: &GroundWind) {
        let motions = self.sound(motions);
        let cell_m = self.field.layout().cell_m;
        let (bodies, height, growth) = (&self.bodies, &*self.height, &self.growth);
        let contacts: Vec<_> = motions.iter().flat_map(|motion| bodies.contacts(motion, height, growth, cell_m)).collect();
        let blows = self.blows.step(&motions, &self.height, dt_secs);
        let breezy = self.breeze.as_ref().map(|breeze| breeze.patches(self.field.layout(), views)).unwrap_or_default();
        if self.scheme == Scheme::Modal {
            // What was broken and let go comes back at rest.
            self.field.wake_all();
        } else {
            let touched = [self.touched(&contacts, &blows), breezy.clone()].concat();
            self.regions.update(&mut self.field, &touched, views);
        }
        let mut sward = Sward { field: &mut self.field, laid: &mut self.laid, wind, height: &self.height, growth: &self.growth };
        for contact in &contacts {
            contact::press(&mut sward, contact, dt_secs);
        }
        for blow in &blows {
            blow.press(&mut sward);
        }
        if let Some(breeze) = &mut self.breeze {
            breeze.blow(&mut self.field, &breezy, dt_secs);
        }
        self.motions = motions;
        self.laid.step(dt_secs, views);
        self.report = self.propagate(dt_secs);
        self.broken += u64::from(self.report.broken);
    }

    /// Carries the waves on. Grass that bends too fast for as many sub-steps as allowed is put to rest and counts as broken.
    fn propagate(&mut self, dt_secs: f32) -> Report {
        let mut broken = 0;
        loop {
            match self.field.step(self.scheme, dt_secs, &step::Pool) {
                Ok(report) => return Report { broken: report.broken + broken, ..report },
                Err(StepError::TooFast { omega_rad_per_s, .. }) => {
                    let is_fastest = |patch: &&Patch| patch.omega_max_rad_per_s() >= omega_rad_per_s;
                    let fastest: Vec<_> = self.field.awake().filter(is_fastest).map(Patch::index).collect();
                    broken += fastest.len() as u32;
                    fastest.into_iter().for_each(|patch| self.field.sleep(patch));
                }
                // A checked scene gives a step of some length, and the modal scheme only what it can carry.
                Err(_) => return Report { broken, ..Report::default() },
            }
        }
    }

    /// The motions that are some; the others are kept as refused.
    fn sound(&mut self, motions: &[Motion]) -> Vec<Motion> {
        self.refused = motions.iter().filter_map(|motion| motion.check().err()).collect();
        self.refused_count += self.refused.len() as u64;
        motions.iter().filter(|motion| motion.check().is_ok()).copied().collect()
    }

    fn touched(&self, contacts: &[Contact], blows: &[Blow]) -> Vec<PatchIndex> {
        let layout = self.field.layout();
        let around = |[low, high]: [[f32; 2]; 2]| layout.patches_touching(low.map(|m| m - MARGIN_M), high.map(|m| m + MARGIN_M));
        let bodies = contacts.iter().filter(|contact| !contact.rests).flat_map(|contact| around(contact.swath.bounds_m()));
        bodies.chain(blows.iter().flat_map(|blow| around(blow.footprint().bounds_m()))).collect()
    }
}
