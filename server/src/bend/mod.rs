//! What drives the bend field (001 sections 4 and 5): regions, contact, air, propagation.

pub mod air;
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
use contact::Contact;
use drawing::Drawings;
use drawn::{Blow, Blows};
use laid::Laid;
use parts::Bodies;
use regions::{Regions, Trace};
use shared::bend::{Field, WaveParams};
use shared::grid::{PatchIndex, PatchLayout};
use shared::scene::Scene;
use shared::terrain::HeightMap;
use std::sync::Arc;
use sward::Sward;

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
    params: WaveParams,
    height: Arc<HeightMap>,
    theta_max_rad: f32,
    bodies: Bodies,
    blows: Blows,
    laid: Laid,
    refused: Vec<MotionError>,
    refused_count: u64,
    regions: Regions,
    traces: Vec<Trace>,
    report: step::Report,
}

impl Meadow {
    /// A meadow at rest, without drawings for its winds.
    pub fn new(scene: &Scene, height: Arc<HeightMap>) -> Self {
        Self::with_drawings(scene, height, &Drawings::new())
    }

    /// A meadow at rest; a wind whose drawing is not among `drawings` blows nothing.
    pub fn with_drawings(scene: &Scene, height: Arc<HeightMap>, drawings: &Drawings) -> Self {
        let layout = PatchLayout::from(&scene.patches);
        // As much as the awake patches could hold.
        let tile_limit = scene.patches.awake_limit as usize * (layout.cells as usize / laid::TILE).pow(2);
        Self {
            field: Field::new(layout),
            params: WaveParams::from(&scene.grass),
            height,
            theta_max_rad: scene.grass.theta_max_rad,
            bodies: Bodies::new(&scene.objects, scene.plants.height_m),
            blows: Blows::new(scene, drawings),
            laid: Laid::new(layout, scene.grass.laid_recovery_secs, tile_limit),
            refused: vec![],
            refused_count: 0,
            regions: Regions::new(scene.patches.awake_limit as usize),
            traces: vec![],
            report: step::Report::default(),
        }
    }

    /// The field.
    pub fn field(&self) -> &Field {
        &self.field
    }

    /// What the newest step took.
    pub fn report(&self) -> step::Report {
        self.report
    }

    /// Sum of θ² + ω² over all cells (mixed units).
    pub fn activity(&self) -> f64 {
        // The sum of nothing would be −0.
        self.traces.iter().fold(0.0, |sum, trace| sum + f64::from(trace.extremes.activity))
    }

    /// Patches let go so far because too many were awake.
    pub fn evicted(&self) -> u64 {
        self.regions.evicted()
    }

    /// What stays bent below the weight of objects.
    pub fn laid(&self) -> &Laid {
        &self.laid
    }

    /// Takes note that the laid grass was shown as it is; patches that are awake are shown anew each time.
    pub fn laid_was_shown(&mut self) {
        let field = &self.field;
        self.laid.shown(|patch| field.patch(patch).is_some());
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
        let contacts: Vec<_> = motions.iter().flat_map(|motion| self.bodies.contacts(motion, &self.height, cell_m)).collect();
        let blows = self.blows.step(&motions, &self.height, dt_secs);
        let touched = self.touched(&contacts, &blows);
        self.regions.update(&mut self.field, &touched, &self.traces, views);

        let carried = self.traces.iter().map(|trace| trace.extremes.omega_rad_per_s).fold(0.0, f32::max);
        let (height, theta_max_rad) = (&*self.height, self.theta_max_rad);
        let mut sward = Sward { field: &mut self.field, laid: &mut self.laid, wind, height, theta_max_rad };
        let pressed = contacts.iter().map(|contact| contact::press(&mut sward, contact, dt_secs)).fold(carried, f32::max);
        let omega_max = blows.iter().map(|blow| blow.press(&mut sward)).fold(pressed, f32::max);
        self.laid.step(dt_secs, views);
        (self.report, self.traces) = step::propagate(&mut self.field, &self.params, dt_secs, omega_max);
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
        let bodies = contacts.iter().flat_map(|contact| around(contact.swath.bounds_m()));
        bodies.chain(blows.iter().flat_map(|blow| around(blow.footprint().bounds_m()))).collect()
    }
}
