//! Culling leaves out nothing visible.

use anyhow::{Result, ensure};
use glam::Vec3;
use prairie::charts::still::Still;
use prairie::charts::views::View;
use prairie_charts::random_winds::Random;
use prairie_client::camera::Camera;
use prairie_client::render::{Gpu, Occlusion, Quality, RenderOptions};

use crate::gpu;

/// Views whose scenes are drawn, and number of cameras.
const VIEWS: [(&str, u32); 2] = [("driving-calm", 140), ("ant-calm", 60)];
const SIZE_PX: [u32; 2] = [96, 54];

/// A random camera over a scene's hills: from among the blades to 40 m above, in any direction except straight up or down.
fn camera(random: &mut Random, still: &Still) -> Camera {
    let [width, depth] = still.stage.scene().extent_m().map(f64::from);
    let [x, z] = [random.between(4.0, width - 4.0), random.between(4.0, depth - 4.0)].map(|m| m as f32);
    let above_m = random.scale(0.05, 40.0) as f32;
    Camera {
        eye_m: Vec3::new(x, still.stage.ground_m(x, z) + above_m, z),
        heading_rad: random.between(0.0, std::f64::consts::TAU) as f32,
        pitch_rad: random.between(-1.3, 0.5) as f32,
        ..Camera::default()
    }
}

#[test]
fn culling_changes_no_pixel() -> Result<()> {
    let gpu = gpu()?;
    let mut random = Random::new(6);
    for (name, cameras) in VIEWS {
        compare(&gpu, name, cameras, &mut random)?;
    }
    Ok(())
}

fn compare(gpu: &Gpu, name: &str, cameras: u32, random: &mut Random) -> Result<()> {
    let mut still = Still::of(View::find(name)?, SIZE_PX)?;
    let [mut culled, mut whole] = [true, false].map(|culls| {
        let mut canvas = still.canvas(gpu, Quality::Low);
        canvas.set_options(RenderOptions { culls, occlusion: Occlusion::Always, ..RenderOptions::default() });
        canvas
    });
    let mut bent = [0_u64; 2];
    let mut failures = Vec::new();
    for number in 0..cameras {
        still.camera = camera(random, &still);
        let [with, without] = [&mut culled, &mut whole].map(|canvas| still.draw(canvas).0);
        for (sum, canvas) in bent.iter_mut().zip([&culled, &whole]) {
            *sum += u64::from(canvas.bent_plants());
        }
        let differing = with.rgba.chunks_exact(4).zip(without.rgba.chunks_exact(4)).filter(|(a, b)| a != b).count();
        if differing > 0 {
            failures.push(format!("{name}, camera {number}, {}: {differing} pixels differ", still.camera.to_hash()));
        }
    }
    ensure!(failures.is_empty(), "{} of {cameras}\n{}", failures.len(), failures.join("\n"));
    let [with, without] = bent;
    println!("{name}: {with} of {without} plants are bent");
    ensure!(2 * with < without, "culling saves too little for the claim to mean anything: {with} of {without} plants are bent");
    Ok(())
}
