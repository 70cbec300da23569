//! Writes the wind: arrows, streamlines, slices and volumes.

use super::arrows::WindArrows;
use super::entities::Entity;
use super::error::InspectError;
use super::log::{Log, image, tensor};
use super::palette::wind_rgb;
use super::streamlines::Streamlines;
use super::wind_fields::WindFields;
use crate::snapshot::WindFrame;
use prairie_core::scene::Scene;
use prairie_core::terrain::HeightMap;
use rerun::components::Colormap;
use rerun::{Arrows3D, LineStrips3D, Radius, Rgba32};
use std::sync::Arc;

/// Radius of a wind arrow's shaft (m).
const ARROW_RADIUS_M: f32 = 0.16;

/// Dimensions of a volume, the slowest first.
const ZYX: [&str; 3] = ["z", "y", "x"];

/// Writer of the wind's entities.
pub(super) struct WindWriter {
    arrows: WindArrows,
    fields: WindFields,
    streamlines: Streamlines,
    heights: Arc<HeightMap>,
    /// Step of the wind that was written last.
    tick: Option<u64>,
}

impl WindWriter {
    /// A writer of the wind of a scene over the land.
    pub(super) fn new(scene: &Scene, heights: Arc<HeightMap>) -> Self {
        let (arrows, fields) = (WindArrows::new(scene, &heights), WindFields::new(scene));
        Self { arrows, fields, streamlines: Streamlines::new(scene), heights, tick: None }
    }

    /// Writes the entities that are due, if the wind is a new one.
    pub(super) fn write(&mut self, log: &mut Log, wind: &WindFrame) -> Result<(), InspectError> {
        if self.tick.replace(wind.tick) == Some(wind.tick) {
            return Ok(());
        }
        if log.takes(Entity::WindArrows) {
            let (origins_m, vectors_m, colours) = self.arrows.of(wind);
            let arrows = Arrows3D::from_vectors(vectors_m).with_origins(origins_m).with_radii([ARROW_RADIUS_M]);
            log.write(Entity::WindArrows, &arrows.with_colors(colours.into_iter().map(Rgba32::from)))?;
        }
        if !self.fields.set(wind) {
            return Ok(());
        }
        if log.takes(Entity::Streamlines) {
            let lines = self.streamlines.lines(self.fields.field(), &self.heights);
            let lines = LineStrips3D::new(lines).with_radii([Radius::new_ui_points(1.0)]);
            log.write(Entity::Streamlines, &lines.with_colors([Rgba32::from(wind_rgb(4.0))]))?;
        }
        self.write_slices(log)?;
        self.write_volumes(log)
    }

    fn write_slices(&self, log: &mut Log) -> Result<(), InspectError> {
        let [nx, ny, nz] = self.fields.cells();
        let speed = |values: Vec<f32>, rows: usize| image(&values, [nx as u32, rows as u32]).with_colormap(Colormap::Viridis);
        if log.takes(Entity::WindGround) {
            log.write(Entity::WindGround, &speed(self.fields.ground_speed(), nz))?;
        }
        if log.takes(Entity::WindSection) {
            log.write(Entity::WindSection, &speed(self.fields.section_speed(), ny))?;
        }
        if log.takes(Entity::WindGusts) {
            log.write(Entity::WindGusts, &tensor(self.fields.gusts(), [2, nz, nx], ["u w", "z", "x"]))?;
        }
        Ok(())
    }

    fn write_volumes(&self, log: &mut Log) -> Result<(), InspectError> {
        let [nx, ny, nz] = self.fields.cells();
        if log.takes(Entity::WindVelocity) {
            log.write(Entity::WindVelocity, &tensor(self.fields.velocity(), [3, nz, ny, nx], ["u v w", "z", "y", "x"]))?;
        }
        if log.takes(Entity::WindVorticity) {
            log.write(Entity::WindVorticity, &tensor(self.fields.vorticity(), [3, nz, ny, nx], ["x y z", "z", "y", "x"]))?;
        }
        if log.takes(Entity::WindDivergence) {
            log.write(Entity::WindDivergence, &tensor(self.fields.divergence(), [nz, ny, nx], ZYX))?;
        }
        if let Some(dust) = self.fields.dust()
            && log.takes(Entity::WindDust)
        {
            log.write(Entity::WindDust, &tensor(dust.to_vec(), [nz, ny, nx], ZYX))?;
        }
        Ok(())
    }
}
