//! Writes the bend of the grass: the map on the terrain and from above, and the exact fields.

use super::bend_fields::BendFields;
use super::bend_map::{BendMap, degrees};
use super::entities::Entity;
use super::error::InspectError;
use super::log::{Log, image, tensor};
use super::palette::bend_rgb;
use crate::snapshot::Snapshot;
use prairie_core::grass::StepRecord;
use rerun::components::{Colormap, ImageFormat};
use rerun::datatypes::ChannelDatatype;
use rerun::{AnnotationContext, LineStrips2D, Mesh3D, Rgba32, SegmentationImage};
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// Number of steps in the colour scale of the angles.
const SCALE_STEPS: usize = 9;

/// Writer of the entities of the grass.
pub(super) struct GrassWriter {
    map: BendMap,
    fields: BendFields,
    /// Whether the map has changed since it was drawn on the terrain, and since it was written from above.
    is_stale: [bool; 2],
}

impl GrassWriter {
    /// A writer of a map and fields of grass at rest.
    pub(super) fn new(map: BendMap, fields: BendFields) -> Self {
        Self { map, fields, is_stale: [false; 2] }
    }

    /// Writes the classes of the map and its colour scale.
    pub(super) fn write_static(&self, log: &Log) -> Result<(), InspectError> {
        let names: Vec<_> =
            (0..=127).map(|code| (u16::from(code), format!("{:.0}°", degrees(code)), Rgba32::from(bend_rgb(degrees(code))))).collect();
        log.keep(Entity::Map, &AnnotationContext::new(names.iter().map(|(code, name, rgb)| (*code, name.as_str(), *rgb))))?;
        log.keep(Entity::MapScale, &self.scale())
    }

    /// Writes the entities that are due, and counts the evictions of the new steps.
    pub(super) fn write(&mut self, log: &mut Log, snapshot: &Snapshot, new_steps: &[Arc<StepRecord>]) -> Result<(), InspectError> {
        new_steps.iter().for_each(|step| self.fields.count_evictions(step));
        self.write_map(log, snapshot)?;
        self.write_cells(log, snapshot)?;
        let size = self.fields.patches().size();
        if log.takes(Entity::BendActivity) {
            log.write(Entity::BendActivity, &image(&self.fields.activity(&snapshot.patches), size).with_colormap(Colormap::Inferno))?;
        }
        if log.takes(Entity::BendEvictions) {
            log.write(Entity::BendEvictions, &image(&self.fields.evictions(), size).with_colormap(Colormap::Inferno))?;
        }
        Ok(())
    }

    fn write_map(&mut self, log: &mut Log, snapshot: &Snapshot) -> Result<(), InspectError> {
        let due = [log.takes(Entity::Ground), log.takes(Entity::MapBend)];
        if due.contains(&true) && self.map.update(&snapshot.wind, &snapshot.patches) {
            self.is_stale = [true; 2];
        }
        if due[0] && std::mem::take(&mut self.is_stale[0]) {
            log.write(Entity::Ground, &Mesh3D::update_fields().with_albedo_texture_buffer(self.map.rgb()))?;
        }
        if due[1] && std::mem::take(&mut self.is_stale[1]) {
            let format = ImageFormat::segmentation(self.map.size_px(), ChannelDatatype::U8);
            log.write(Entity::MapBend, &SegmentationImage::new(self.map.codes().to_vec(), format).with_opacity(1.0))?;
        }
        Ok(())
    }

    fn write_cells(&self, log: &mut Log, snapshot: &Snapshot) -> Result<(), InspectError> {
        let [width, depth] = self.fields.cells().size();
        if log.takes(Entity::BendAngle) {
            let angle = image(&self.fields.angle_rad(&snapshot.patches), [width, depth]).with_colormap(Colormap::Viridis);
            log.write(Entity::BendAngle, &angle.with_depth_range([0.0, FRAC_PI_2]))?;
        }
        if log.takes(Entity::BendVelocity) {
            let velocity = self.fields.velocity_rad_per_s(&snapshot.patches);
            log.write(Entity::BendVelocity, &tensor(velocity, [2, depth as usize, width as usize], ["x z", "z", "x"]))?;
        }
        Ok(())
    }

    /// The colour scale of the angles, a bar above the map.
    fn scale(&self) -> LineStrips2D {
        let width_px = self.map.size_px()[0] as f32;
        let radius_px = 0.015 * width_px;
        let step_px = (width_px - 2.0 * radius_px) / SCALE_STEPS as f32;
        let place = |i: usize| [radius_px + i as f32 * step_px, -2.0 * radius_px];
        let bars = (0..SCALE_STEPS).map(|i| [place(i), place(i + 1)]);
        let middles_deg: Vec<_> = (0..SCALE_STEPS).map(|i| 90.0 * (i as f32 + 0.5) / SCALE_STEPS as f32).collect();
        LineStrips2D::new(bars)
            .with_colors(middles_deg.iter().map(|&at| Rgba32::from(bend_rgb(at))))
            .with_labels(middles_deg.iter().map(|at| format!("{at:.0}°")))
            .with_radii([radius_px])
    }
}
