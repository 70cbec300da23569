//! The wind as arrows above the terrain.

use super::palette::{Rgb, wind_rgb};
use crate::snapshot::WindFrame;
use glam::Vec3;
use prairie_core::scene::Scene;
use prairie_core::terrain::{HeightMap, KindMap};
use prairie_core::wind::WindField;
use std::sync::Arc;

/// Largest number of arrows.
const ARROW_LIMIT: u32 = 1500;

/// Length of an arrow per speed (s): the air covers the arrow in this time.
const ARROW_SECS: f32 = 1.2;

/// Place of an arrow.
struct Site {
    /// X, height above the ground, and Z (m).
    at_m: [f32; 3],
    /// Origin in the world (m).
    origin_m: Vec3,
}

/// Origins of the arrows, constant during a run, and the wind that they show.
pub(super) struct WindArrows {
    cells: [u32; 3],
    sites: Vec<Site>,
    wind: WindField,
}

impl WindArrows {
    /// Every n-th cell along each axis, n as small as the limit of 1500 arrows allows. A periodic box is repeated over the world, as in the simulation.
    pub(super) fn new(scene: &Scene, heights: &HeightMap) -> Self {
        let (wind, extent_m) = (&scene.wind, scene.extent_m());
        let [nx, ny, nz] = wind.cells;
        let wraps = wind.faces.wraps();
        let across = |axis: usize, cells: u32| {
            let whole = (extent_m[axis / 2] / wind.spacing_m[axis]).floor().max(1.0) as u32;
            if wraps[axis] { whole } else { whole.min(cells) }
        };
        let span = [across(0, nx), ny, across(2, nz)];
        let count = |step: u32| span.iter().map(|n| n.div_ceil(step) as u64).product::<u64>();
        let step = (1..).find(|&step| count(step) <= u64::from(ARROW_LIMIT)).expect("the largest step leaves one arrow");

        let mut sites = Vec::new();
        for k in (step / 2..span[2]).step_by(step as usize) {
            for j in (0..span[1]).step_by(step as usize) {
                for i in (step / 2..span[0]).step_by(step as usize) {
                    let at_m = [(0, i), (1, j), (2, k)].map(|(axis, n)| (n as f32 + 0.5) * wind.spacing_m[axis]);
                    let [x, above, z] = at_m;
                    sites.push(Site { at_m, origin_m: Vec3::new(x, heights.height_m(x, z) + above, z) });
                }
            }
        }
        Self { cells: wind.cells, sites, wind: WindField::still(scene, Arc::new(KindMap::uniform())) }
    }

    /// Origins (m), vectors (m) and colours of the arrows of a frame; empty for a frame of another shape.
    pub(super) fn of(&mut self, frame: &WindFrame) -> (Vec<[f32; 3]>, Vec<[f32; 3]>, Vec<Rgb>) {
        let volume = self.cells.iter().product::<u32>() as usize;
        if frame.cells != self.cells || frame.codes.len() < 3 * volume {
            return Default::default();
        }
        self.wind.set(&frame.codes, &frame.turbulence);
        let arrow = |site: &Site| {
            let velocity = Vec3::from_array(self.wind.wind_at(site.at_m));
            (site.origin_m.to_array(), (velocity * ARROW_SECS).to_array(), wind_rgb(velocity.length()))
        };
        let (mut origins_m, mut vectors_m, mut colours) = (Vec::new(), Vec::new(), Vec::new());
        for (origin_m, vector_m, colour) in self.sites.iter().map(arrow) {
            origins_m.push(origin_m);
            vectors_m.push(vector_m);
            colours.push(colour);
        }
        (origins_m, vectors_m, colours)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::scene::{Wind, WindBoundary, WindTiling};
    use prairie_core::wire::quantise::CodeSteps;

    /// A world of `count × count` patches of 16 m.
    fn scene(wind: Wind, count: u32) -> Scene {
        let mut scene = crate::scenes::load("meadow").unwrap().scene;
        (scene.wind, scene.patches.count) = (wind, [count; 2]);
        scene
    }

    fn flat(height_m: f32) -> HeightMap {
        HeightMap::from_heights(2, 2, [100.0, 100.0], vec![height_m; 4])
    }

    #[test]
    fn an_arrow_shows_the_wind_of_its_own_cell() {
        let mut wind = Wind { cells: [3, 2, 3], spacing_m: [4.0, 2.0, 5.0], ..Wind::default() };
        (wind.faces.west, wind.faces.north) = (WindBoundary::NoSlip, WindBoundary::NoSlip);
        let mut arrows = WindArrows::new(&scene(wind, 1), &flat(7.0));
        let mut codes = vec![0; 3 * 18];
        let [i, j, k] = [2, 1, 1];
        let cell = (k * 2 + j) * 3 + i;
        codes[18 + cell] = CodeSteps::default().wind_code(-5.0);
        let (origins_m, vectors_m, colours) = arrows.of(&WindFrame { cells: [3, 2, 3], codes, ..WindFrame::default() });
        assert_eq!((origins_m.len(), vectors_m.len(), colours.len()), (18, 18, 18));
        let at = origins_m.iter().position(|o| *o == [10.0, 10.0, 7.5]).unwrap();
        assert!((vectors_m[at][1] + 5.0 * ARROW_SECS).abs() < 0.2, "{:?}", vectors_m[at]);
        assert!(vectors_m.iter().enumerate().all(|(i, v)| i == at || *v == [0.0; 3]));
    }

    #[test]
    fn a_periodic_box_covers_the_world_within_the_limit() {
        let wind = Wind { cells: [4, 2, 4], spacing_m: [8.0, 2.0, 8.0], ..Wind::default() };
        for count in [2, 16, 2500] {
            let extent_m = count as f32 * 16.0;
            let arrows = WindArrows::new(&scene(wind.clone(), count), &flat(0.0));
            assert!(arrows.sites.len() <= ARROW_LIMIT as usize);
            let east = arrows.sites.iter().map(|site| site.origin_m.x).fold(0.0, f32::max);
            assert!(east > 0.85 * extent_m && east < extent_m);
        }
    }

    #[test]
    fn a_box_shared_by_all_patches_is_offset_in_each() {
        let wind = Wind { cells: [4, 2, 4], spacing_m: [4.0; 3], tiling: WindTiling::Patch, ..Wind::default() };
        let scene = scene(wind, 4);
        let mut arrows = WindArrows::new(&scene, &flat(0.0));
        let codes: Vec<i16> = (0..96).map(|at| if at < 32 { at as i16 } else { 0 }).collect();
        let (origins_m, vectors_m, _) = arrows.of(&WindFrame { cells: [4, 2, 4], codes, ..WindFrame::default() });
        for patch in 0..4 {
            let at = origins_m.iter().position(|origin_m| *origin_m == [patch as f32 * 16.0 + 6.0, 2.0, 6.0]).unwrap();
            let [x, z] = prairie_core::wind::offset_cells(scene.seed as u32, [patch, 0], [4, 4]);
            let wanted = CodeSteps::default().wind_m_per_s(((1 + x) % 4 + (1 + z) % 4 * 8) as i16) * ARROW_SECS;
            assert!((vectors_m[at][0] - wanted).abs() < 1e-4, "patch {patch}");
        }
    }

    #[test]
    fn a_frame_of_another_shape_has_no_arrows() {
        let mut arrows = WindArrows::new(&scene(Wind::default(), 16), &flat(0.0));
        assert!(!arrows.sites.is_empty());
        assert!(arrows.of(&WindFrame::default()).0.is_empty());
    }
}
