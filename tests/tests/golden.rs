//! The renderer against stored pictures: the same world, camera and frames, drawn without a window.
//!
//! The pictures were drawn by Mesa's lavapipe. Other drivers round differently, so the bounds are loose: a mean difference of
//! 3/255 and 6 % of the pixels visibly off. `PRAIRIE_BLESS=1 cargo nextest run --release -p tests --test golden` draws them anew.

use anyhow::{Context as _, Result, ensure};
use client_wasm::camera::Camera;
use client_wasm::render::{Gpu, Quality};
use std::path::PathBuf;
use tests::picture::Picture;
use tests::stage::{Act, Stage, play};

const SIZE_PX: [u32; 2] = [480, 270];
const FRAMES: u32 = 12;
const DT_SECS: f32 = 1.0 / 30.0;

fn draw(scene: &str, act: Act) -> Result<Picture> {
    let mut stage = Stage::load(scene)?;
    let scene = stage.scene();
    let camera = Camera::start(&scene.camera, scene.extent_m(), |x, z| stage.ground_m(x, z));
    play(&mut stage, act, camera.eye_m.to_array())?;
    let gpu = Gpu::headless().context("no Vulkan driver: install mesa-vulkan-drivers")?;
    let mut picture = client_wasm::render::Picture::new(&gpu, SIZE_PX, Quality::Low);
    for frame in 0..FRAMES {
        stage.run(DT_SECS);
        stage.show()?;
        picture.draw(&mut stage.mirror, &camera, f64::from(frame) * f64::from(DT_SECS), DT_SECS);
    }
    Ok(Picture { width: SIZE_PX[0], height: SIZE_PX[1], rgba: picture.rgba() })
}

fn stored(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("golden").join(format!("{name}.png"))
}

fn compare(name: &str, scene: &str, act: Act) -> Result<()> {
    let (drawn, path) = (draw(scene, act)?, stored(name));
    if std::env::var_os("PRAIRIE_BLESS").is_some() {
        return drawn.save(&path);
    }
    let difference = drawn.difference(&Picture::load(&path)?)?;
    if difference.mean > 3.0 || difference.changed > 0.06 {
        let seen = std::env::temp_dir().join(format!("prairie-{name}.png"));
        drawn.save(&seen)?;
        ensure!(false, "{} differs from {}: {difference:?}", seen.display(), path.display());
    }
    Ok(())
}

#[test]
fn the_meadow_looks_as_stored() -> Result<()> {
    compare("meadow", "meadow", Act::Wind)
}

#[test]
fn a_track_looks_as_stored_and_unlike_the_untouched_meadow() -> Result<()> {
    compare("track", "meadow", Act::Track)?;
    let difference = Picture::load(&stored("track"))?.difference(&Picture::load(&stored("meadow"))?)?;
    ensure!(difference.changed > 0.005, "the track's picture shows no track: {difference:?}");
    Ok(())
}

#[test]
fn species_side_by_side_look_as_stored() -> Result<()> {
    compare("species", "scenes/species/species.toml", Act::Wind)
}

#[test]
fn underbrush_looks_as_stored() -> Result<()> {
    compare("underbrush", "underbrush", Act::Wind)
}

#[test]
fn textured_blades_look_as_stored() -> Result<()> {
    compare("blades", "blades", Act::Wind)
}

#[test]
fn shells_look_as_stored() -> Result<()> {
    compare("shells", "shells", Act::Wind)
}
