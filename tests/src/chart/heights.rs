//! One view from four heights as a series in one picture (Zhang, Fig. 23).

use anyhow::Result;
use prairie::studio::Act;
use prairie_client::render::{FarPlants, Gpu, OffscreenRenderer, Quality, RenderOptions};

use prairie::charts::image::Picture;
use prairie::charts::still::Still;
use prairie::charts::views::{View, over};

/// Height above the ground (m) and pitch (degrees) of each view: those of the source, and of the keys `1` to `4` of the page.
const VIEWS: [(f32, f32); 4] = [(1.0, -3.0), (5.0, -9.0), (10.0, -15.0), (20.0, -24.0)];
/// The lowest view.
const LOWEST: View = View {
    name: "heights",
    scene: "meadow",
    act: Act::Wind,
    eye: over([128.0, 158.0], VIEWS[0].0, 20.0, VIEWS[0].1),
    shows: "the meadow from 1, 5, 10 and 20 m",
    answers: "Zhang, Figure 23",
};
/// Views beside each other.
const COLUMNS: usize = 2;

/// Draws the meadow from each height, at one moment, at `size_px`, with single plants near the camera and clumps beyond as in the source, and joins them, the lowest
/// at the top left.
///
/// # Errors
/// When the view cannot be drawn.
pub fn series(gpu: &Gpu, size_px: [u32; 2], quality: Quality) -> Result<Picture> {
    let mut still = Still::of(&LOWEST, size_px)?;
    let mut canvas = OffscreenRenderer::new(gpu, size_px, quality);
    canvas.set_options(RenderOptions { far_plants: FarPlants::Clumps, ..RenderOptions::default() });
    let lowest_m = still.camera.eye_m.y;
    let pictures: Vec<_> = VIEWS
        .iter()
        .map(|&(height_m, pitch_deg)| {
            still.camera.eye_m.y = lowest_m - VIEWS[0].0 + height_m;
            still.camera.pitch_rad = pitch_deg.to_radians();
            still.draw(&mut canvas).0
        })
        .collect();
    Picture::tiled(&pictures, COLUMNS)
}
