//! Frame time against the height of the view: from among the blades to an aircraft's (Zhang, Figure 23: heights 1, 5, 10 and 20).

use anyhow::Result;
use glam::Vec3;
use prairie_client::camera::Camera;
use prairie_client::render::Gpu;

use super::sweep::{Sweep, qualities, sweep};
use crate::studio::{Act, Stage, play};
use prairie_charts::figure::Drawn;

/// Heights above the ground (m).
const HEIGHTS_M: [f32; 8] = [1.0, 2.0, 5.0, 10.0, 20.0, 35.0, 60.0, 100.0];
const QUICK_HEIGHTS_M: [f32; 3] = [1.0, 10.0, 100.0];
/// Horizontal position of the camera (m), over the valley of the meadow.
const AT_M: [f32; 2] = [128.0, 200.0];

pub(super) fn draw(quick: bool, caption: &str) -> Result<Drawn> {
    let gpu = Gpu::headless()?;
    let mut stage = Stage::load("meadow")?;
    let [x, z] = AT_M;
    let ground_m = stage.ground_m(x, z);
    play(&mut stage, Act::Wind, [x, ground_m + 2.0, z])?;
    let heights_m: &[f32] = if quick { &QUICK_HEIGHTS_M } else { &HEIGHTS_M };
    let mut found = Sweep::default();
    for &height_m in heights_m {
        let camera = Camera { eye_m: Vec3::new(x, ground_m + height_m, z), heading_rad: 0.35, pitch_rad: -0.25, ..Camera::default() };
        for quality in qualities(quick) {
            found.time(&gpu, quick, *quality, height_m.into(), &mut stage.mirror, &camera);
        }
    }
    sweep(&found, "Frame time against the height of the view", "height above the ground (m)", quick, caption, &gpu)
}
