//! Kinds of grass: the wave constants of each, and the map of where each grows.

use super::WaveParams;
use crate::grid::PatchLayout;
use crate::scene::Scene;
use crate::terrain::{CoverMap, KindMap};
use std::sync::Arc;

/// Wave constants of each kind of grass, and where each grows.
#[derive(Clone, Debug, PartialEq)]
pub struct Kinds {
    waves: Vec<WaveParams>,
    map: Option<Arc<Pixels>>,
}

#[derive(Clone, Debug, PartialEq)]
struct Pixels {
    size_px: [usize; 2],
    /// Kind at each pixel, row by row from the north.
    kinds: Vec<u8>,
}

impl Kinds {
    /// One kind everywhere.
    pub fn one(waves: WaveParams) -> Self {
        Self { waves: vec![waves], map: None }
    }

    /// Several kinds, and a map of `size_px` pixels stretched over the world, row by row from the north; each pixel is the index of its kind.
    ///
    /// # Panics
    /// When a pixel names a missing kind, or `kinds` is not of the given size.
    pub fn mapped(waves: Vec<WaveParams>, size_px: [usize; 2], kinds: Vec<u8>) -> Self {
        assert!(size_px[0] * size_px[1] == kinds.len() && kinds.iter().all(|&kind| usize::from(kind) < waves.len()));
        Self { waves, map: Some(Arc::new(Pixels { size_px, kinds })) }
    }

    /// The kinds of a scene, over its covering map.
    pub fn of(scene: &Scene, cover: &CoverMap) -> Self {
        let waves: Vec<_> = scene.kinds().iter().map(|grass| grass.waves).collect();
        if waves.len() == 1 {
            return Self::one(waves[0]);
        }
        let map = KindMap::new(scene, cover);
        Self::mapped(waves, map.size_px().map(|n| n as usize), map.kinds().to_vec())
    }

    /// Constants of all kinds.
    pub fn waves(&self) -> &[WaveParams] {
        &self.waves
    }

    /// Kind of a cell of the world; outside the world, that of the nearest cell.
    pub fn kind(&self, layout: &PatchLayout, cell: [i64; 2]) -> u8 {
        let Some(map) = &self.map else { return 0 };
        let pixel = |axis: usize| {
            let cells = i64::from(layout.count[axis]) * i64::from(layout.cells);
            // In integers, so that every machine finds the same pixel.
            (cell[axis].clamp(0, cells - 1) * 2 + 1) as usize * map.size_px[axis] / (2 * cells as usize)
        };
        map.kinds[pixel(1) * map.size_px[0] + pixel(0)]
    }
}
