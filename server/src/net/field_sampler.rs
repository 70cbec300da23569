//! Wind and bend of the newest snapshot at any place, by the rules of the core: the same bits as the page's console for the same codes.

use crate::runner::Published;
use crate::scenes::LoadedScene;
use prairie_core::bend::{Bend, field_lean_at};
use prairie_core::grid::PatchLayout;
use prairie_core::terrain::{HeightMap, KindMap};
use prairie_core::wind::WindField;
use prairie_core::wire::quantise::{CodeSteps, snow_m};
use serde_json::{Value, json};
use std::sync::{Arc, Mutex, PoisonError};

/// Height above the ground of a wind without an elevation (m).
pub(super) const DEFAULT_HEIGHT_M: f32 = 2.0;

/// Samples the fields of a scene.
#[derive(Debug)]
pub(crate) struct FieldSampler {
    layout: PatchLayout,
    heights: HeightMap,
    steps: CodeSteps,
    undisturbed_snow_m: f32,
    /// Tick of the wind, and the wind; `None` before the first request.
    wind: Mutex<(Option<u64>, WindField)>,
}

/// A place on or above the ground (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub(super) x: f32,
    /// Elevation above sea level; `None`: [`DEFAULT_HEIGHT_M`] above the ground.
    pub(super) y: Option<f32>,
    pub(super) z: f32,
}

impl FieldSampler {
    /// A sampler of the fields of `loaded`.
    pub(crate) fn new(loaded: &LoadedScene) -> Self {
        let scene = &loaded.scene;
        let wind = WindField::still(scene, Arc::new(KindMap::new(scene, &loaded.cover)));
        Self {
            layout: PatchLayout::from(&scene.patches),
            heights: loaded.height.clone(),
            steps: CodeSteps::from(&scene.stream),
            undisturbed_snow_m: scene.snow.depth_m,
            wind: Mutex::new((None, wind)),
        }
    }

    /// Wind at places, with its parts: the solver's, and the gust.
    pub(super) fn wind(&self, published: &Published, places: &[Place]) -> Value {
        self.with_wind(published, |wind| {
            let at_m: Vec<_> = places.iter().map(|place| self.above_ground_m(*place)).collect();
            json!({
                "tick": published.snapshot.tick,
                "time_secs": published.snapshot.time_secs,
                "wind_tick": published.snapshot.wind.tick,
                "wind_m_per_s": at_m.iter().map(|at_m| wind.wind_at(*at_m)).collect::<Vec<_>>(),
                "resolved_m_per_s": at_m.iter().map(|at_m| wind.resolved_at(*at_m)).collect::<Vec<_>>(),
                "gust_m_per_s": at_m.iter().map(|[x, _, z]| wind.gust_at([*x, *z])).collect::<Vec<_>>(),
            })
        })
    }

    /// Lean of the bend field at places, and with the lean in the wind; depth of the snow.
    pub(super) fn bend(&self, published: &Published, places: &[Place]) -> Value {
        let snapshot = &published.snapshot;
        let plane = (self.layout.cells * self.layout.cells) as usize;
        let cell = |patch, cell: usize| {
            let codes = snapshot.patches.get(&patch).map(|patch| [0, 1, 2].map(|channel| patch.codes[channel * plane + cell]));
            codes.map(|codes| Bend::of_codes(codes, &self.steps)).unwrap_or_default()
        };
        let bends: Vec<_> = places.iter().map(|place| field_lean_at(&self.layout, [place.x, place.z], cell)).collect();
        let leans: Vec<_> = self.with_wind(published, |wind| {
            let sums = places.iter().zip(&bends).map(|(place, [x, z])| {
                let [wind_x, wind_z] = wind.lean_at([place.x, place.z]);
                [wind_x + x, wind_z + z]
            });
            sums.collect()
        });
        json!({
            "tick": snapshot.tick,
            "time_secs": snapshot.time_secs,
            "bend_rad": bends,
            "lean_rad": leans,
            "snow_m": places.iter().map(|place| self.snow_m(published, [place.x, place.z])).collect::<Vec<_>>(),
        })
    }

    /// Depth of the snow in the cell of a position on the ground.
    fn snow_m(&self, published: &Published, [x_m, z_m]: [f32; 2]) -> f32 {
        let (layout, cells) = (&self.layout, self.layout.cells as usize);
        let code = layout.patch_at(x_m, z_m).and_then(|patch| {
            let [i, j] = [x_m, z_m].map(|m| (m / layout.cell_m) as usize % cells);
            published.snapshot.patches.get(&patch)?.codes.get((3 * cells + j) * cells + i)
        });
        (self.undisturbed_snow_m + code.copied().map_or(0.0, snow_m)).max(0.0)
    }

    fn above_ground_m(&self, Place { x, y, z }: Place) -> [f32; 3] {
        [x, y.map_or(DEFAULT_HEIGHT_M, |y| y - self.heights.height_m(x, z)), z]
    }

    /// Calls `sample` with the wind of the newest snapshot, decoded once per wind frame.
    fn with_wind<T>(&self, published: &Published, sample: impl FnOnce(&WindField) -> T) -> T {
        let frame = &published.snapshot.wind;
        let mut wind = self.wind.lock().unwrap_or_else(PoisonError::into_inner);
        let (tick, field) = &mut *wind;
        if *tick != Some(frame.tick) && frame.codes.len() >= 3 * field.velocities().len() {
            field.set(&frame.codes, &frame.turbulence);
            *tick = Some(frame.tick);
        }
        sample(field)
    }
}
