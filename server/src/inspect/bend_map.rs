//! The map of bending angles that textures the terrain.

use super::palette::{Rgb, bend_rgb};
use crate::snapshot::{BentPatches, WindFrame};
use prairie_core::grid::PatchLayout;
use prairie_core::wind::WindField;
use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

/// Largest number of pixels along one side of the map.
const MAP_LIMIT_PX: u32 = 512;

/// Bending angles of the whole world, including the lean due to the wind: one image of at most 512 × 512 pixels, row by row from the
/// north-west corner.
///
/// A pixel is the largest angle of the cells below it, so that a narrow track stays visible on a small map. The wind is sampled at the
/// centre of the pixel.
pub(super) struct BendMap {
    layout: PatchLayout,
    /// log₂ of the cells along one side of a pixel.
    shift: u32,
    size_px: [u32; 2],
    /// Angle of each pixel; 127 is a right angle.
    codes: Vec<u8>,
    wind: WindField,
    /// Minimum number of steps between redraws that are due to the wind alone.
    wind_ticks: u64,
    /// Step of the wind, and patches, of the last update; `None` before the first.
    shown: Option<(u64, Arc<BentPatches>)>,
}

impl BendMap {
    /// A map of grass at rest in still air.
    pub(super) fn new(layout: PatchLayout, wind: WindField, wind_ticks: u64) -> Self {
        let cells = layout.count.map(|patches| patches * layout.cells);
        let mut shift = 0;
        while (cells[0].max(cells[1]) - 1) >> shift >= MAP_LIMIT_PX {
            shift += 1;
        }
        let size_px = cells.map(|n| ((n - 1) >> shift) + 1);
        Self { layout, shift, size_px, codes: vec![0; (size_px[0] * size_px[1]) as usize], wind, wind_ticks, shown: None }
    }

    /// Pixels along X and Z.
    pub(super) fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// Side of a pixel (m).
    pub(super) fn pixel_m(&self) -> f32 {
        (1_u32 << self.shift) as f32 * self.layout.cell_m
    }

    /// Codes of the angles, 0..=127, row by row.
    pub(super) fn codes(&self) -> &[u8] {
        &self.codes
    }

    /// The map as an RGB image.
    pub(super) fn rgb(&self) -> Vec<u8> {
        let colours: [Rgb; 128] = std::array::from_fn(|code| bend_rgb(degrees(code as u8)));
        self.codes.iter().flat_map(|&code| colours[usize::from(code.min(127))]).collect()
    }

    /// Draws the wind and the patches of a snapshot. Does nothing and returns false when the patches are the same as last time and the wind
    /// is newer by less than `wind_ticks`.
    pub(super) fn update(&mut self, wind: &WindFrame, patches: &Arc<BentPatches>) -> bool {
        let is_recent = |tick: u64| wind.tick.saturating_sub(tick) < self.wind_ticks;
        if self.shown.as_ref().is_some_and(|(tick, shown)| is_recent(*tick) && same(shown, patches)) {
            return false;
        }
        self.wind.set(&wind.codes, &wind.turbulence);

        let leans_rad: Vec<_> = (0..self.codes.len() as u32).map(|pixel| self.wind.lean_at(self.center_m(pixel))).collect();
        for (code, lean_rad) in self.codes.iter_mut().zip(&leans_rad) {
            *code = code_of(*lean_rad);
        }
        for (&index, patch) in patches.range(..self.layout.patches() as u32) {
            self.draw(index, &patch.codes, &leans_rad);
        }
        self.shown = Some((wind.tick, Arc::clone(patches)));
        true
    }

    fn center_m(&self, pixel: u32) -> [f32; 2] {
        [pixel % self.size_px[0], pixel / self.size_px[0]].map(|n| (n as f32 + 0.5) * self.pixel_m())
    }

    fn draw(&mut self, patch: u32, codes: &[i16], wind_rad: &[[f32; 2]]) {
        let (cells, steps) = (self.layout.cells, *self.wind.code_steps());
        let plane = (cells * cells) as usize;
        let [x0, z0] = self.layout.place(patch).map(|n| n * cells);
        let within = (1 << self.shift) - 1;
        for (at, &theta) in codes[..plane].iter().enumerate() {
            let [x, z] = [x0 + at as u32 % cells, z0 + at as u32 / cells];
            let pixel = ((z >> self.shift) * self.size_px[0] + (x >> self.shift)) as usize;
            let omega = [1, 2].map(|channel| steps.omega_rad_per_s(codes[channel * plane + at]));
            let speed = (omega[0] * omega[0] + omega[1] * omega[1]).sqrt();
            let per_speed = if speed > 0.0 { steps.theta_rad(theta) / speed } else { 0.0 };
            let code = code_of([0, 1].map(|axis| wind_rad[pixel][axis] + omega[axis] * per_speed));
            // The first cell of a pixel replaces the value that is due to the wind alone.
            let is_first = x & within == 0 && z & within == 0;
            self.codes[pixel] = if is_first { code } else { code.max(self.codes[pixel]) };
        }
    }
}

/// Code of the angle of a lean (rad): 127 for a right angle or more.
fn code_of([x, z]: [f32; 2]) -> u8 {
    ((x * x + z * z).sqrt() * (127.0 / FRAC_PI_2)).round().min(127.0) as u8
}

/// Angle of a code (degrees).
pub(super) fn degrees(code: u8) -> f32 {
    f32::from(code.min(127)) * (90.0 / 127.0)
}

fn same(a: &BentPatches, b: &BentPatches) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|((i, a), (j, b))| i == j && Arc::ptr_eq(a, b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::snapshot::PatchCodes;
    use prairie_core::terrain::KindMap;
    use prairie_core::wire::TurbulenceState;
    use prairie_core::wire::quantise::CodeSteps;

    const CELLS: usize = 8;

    /// A map of patches of 8 × 8 cells; the wind bends the grass by at most 0.5 rad.
    fn map(cell_m: f32, count: [u32; 2]) -> BendMap {
        let mut scene = crate::scenes::load("meadow").unwrap().scene;
        scene.grass.wind_bend_rad = 0.5;
        BendMap::new(PatchLayout { count, cells: CELLS as u32, cell_m }, WindField::still(&scene, Arc::new(KindMap::uniform())), 60)
    }

    fn wind(tick: u64, east_m_per_s: f32) -> WindFrame {
        let cells = [32, 8, 32];
        let codes = [east_m_per_s, 0.0, 0.0].into_iter().flat_map(|v| std::iter::repeat_n(CodeSteps::default().wind_code(v), 32 * 8 * 32));
        WindFrame { tick, cells, turbulence: TurbulenceState::default(), codes: codes.collect() }
    }

    /// One patch whose cells lean east by the given angle (degrees), or west where it is negative.
    fn bent(index: u32, lean_deg: impl Fn(usize, usize) -> f32) -> Arc<BentPatches> {
        let leans: Vec<f32> = (0..CELLS * CELLS).map(|at| lean_deg(at % CELLS, at / CELLS).to_radians()).collect();
        let thetas = leans.iter().map(|lean| CodeSteps::default().theta_code(lean.abs()));
        let omegas = leans.iter().map(|lean| if *lean == 0.0 { 0 } else { 60 * lean.signum() as i16 });
        let codes = thetas.chain(omegas).chain(std::iter::repeat_n(0, CELLS * CELLS)).collect();
        Arc::new(BentPatches::from([(index, Arc::new(PatchCodes { tick: 1, codes }))]))
    }

    #[test]
    fn a_cell_is_drawn_at_its_own_pixel() {
        let mut map = map(0.5, [2, 2]);
        assert_eq!((map.size_px(), map.pixel_m()), ([16, 16], 0.5));
        let patches = bent(3, |i, j| if (i, j) == (5, 2) { -40.0 } else { 0.0 });
        assert!(map.update(&wind(1, 0.0), &patches));
        let marked: Vec<_> = (0..256).filter(|&at| map.codes()[at] != 0).collect();
        assert_eq!(marked, [(8 + 2) * 16 + 8 + 5]);
        assert!((degrees(map.codes()[marked[0]]) - 40.0).abs() < 1.1);
        assert!(!map.update(&wind(1, 0.0), &patches));
        assert!(map.update(&wind(1, 0.0), &Arc::default()) && map.codes().iter().all(|&code| code == 0));
    }

    #[test]
    fn the_leans_due_to_wind_and_track_add_up() {
        let mut map = map(0.5, [2, 2]);
        let held = 0.5_f32.to_degrees();
        let patches = bent(0, |i, _| [30.0, -100.0][i % 2]);
        assert!(map.update(&wind(1, 20.0), &patches));
        for (at, wanted, what) in [(255, held, "wind alone"), (0, held + 30.0, "with the wind"), (1, 100.0 - held, "against it")] {
            let found = degrees(map.codes()[at]);
            assert!((found - wanted).abs() < 1.2, "{what}: {found}° instead of {wanted}°");
        }
        assert!(!map.update(&wind(60, 0.0), &patches), "a wind of nearly the same age redraws nothing");
        assert!(map.update(&wind(61, 0.0), &patches));
    }

    #[test]
    fn narrow_tracks_stay_visible_in_a_large_world() {
        let mut map = map(0.25, [128, 24]);
        assert_eq!((map.size_px(), map.pixel_m()), ([512, 96], 0.5));
        map.update(&wind(1, 0.0), &bent(130, |i, _| if i == 5 { 90.0 } else { -3.0 }));
        assert!((4..8).all(|row| map.codes()[row * 512 + 8 + 2] >= 126 && (3..6).contains(&map.codes()[row * 512 + 8 + 3])));
        assert_eq!(map.rgb().len(), 3 * 512 * 96);
        let huge = self::map(1.0, [65536, 1]);
        assert_eq!(huge.size_px(), [512, 1]);
    }
}
