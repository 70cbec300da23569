//! Shells: frames per second against the number of layers and of lamps, beside Bakay 2003, table 4.1 and §4.1.

mod lamps;
mod layers;

use std::time::Instant;

use crate::scenes;
use anyhow::Result;
use glam::Vec3;
use prairie_client::camera::Camera;
use prairie_client::render::OffscreenRenderer;
use prairie_client::state::Mirror;
use prairie_core::scene::Scene;
use prairie_core::wire::ServerMessage;

use prairie_charts::figure::Figure;

/// The figures.
pub const FIGURES: [Figure; 2] = [
    Figure { name: "layers", title: "Cost of shell layers", draw: layers::draw },
    Figure { name: "lamps", title: "Cost of point lights on shells", draw: lamps::draw },
];

const DT_SECS: f32 = 1.0 / 30.0;

/// The scene `shells` with a change.
fn knolls(change: impl FnOnce(&mut Scene)) -> Result<Mirror> {
    let mut loaded = scenes::load("shells")?;
    change(&mut loaded.scene);
    let mut mirror = Mirror::default();
    mirror.apply(ServerMessage::Scene {
        scene: Box::new(loaded.scene),
        height_png: loaded.height_png,
        covering_png: loaded.covering_png,
        nutrient_png: loaded.nutrient_png,
        models: loaded.models,
        shapes: Default::default(),
    })?;
    Ok(mirror)
}

/// Time (s) of frame number `frame` of a view down onto the knolls.
fn frame_secs(picture: &mut OffscreenRenderer, mirror: &mut Mirror, frame: u32) -> f64 {
    let camera = Camera { eye_m: Vec3::new(66.0, 3.5, 60.0), heading_rad: -0.35, pitch_rad: -0.3, ..Camera::default() };
    let begun = Instant::now();
    picture.draw(mirror, &camera, f64::from(frame) * f64::from(DT_SECS), DT_SECS);
    begun.elapsed().as_secs_f64()
}
