//! Writes the objects: boxes, outlines, footprints, velocities, trails and positions on the map.

use super::entities::Entity;
use super::error::InspectError;
use super::log::Log;
use super::outlines::Outlines;
use super::trails::Trails;
use crate::snapshot::Snapshot;
use prairie_core::body::Motion;
use prairie_core::scene::{Objects, Scene};
use prairie_core::terrain::HeightMap;
use prairie_core::wire::ObjectPose;
use prairie_vehicles::trail_rgb;
use rerun::components::FillMode;
use rerun::{Arrows3D, Boxes3D, LineStrips3D, Points2D, Quaternion, Radius, Rgba32};
use std::sync::Arc;

/// Colour of footprints and of their moving corners.
const CONTACT_RGB: [u8; 3] = [255, 110, 190];

/// Writer of the entities of the objects.
pub(super) struct ObjectWriter {
    settings: Objects,
    outlines: Outlines,
    heights: Arc<HeightMap>,
    trails: Trails,
    /// Side of a pixel of the map (m).
    pixel_m: f32,
}

impl ObjectWriter {
    /// A writer of the objects of a scene, on a map of pixels of `pixel_m`.
    pub(super) fn new(scene: &Scene, heights: Arc<HeightMap>, pixel_m: f32) -> Self {
        Self { settings: scene.objects.clone(), outlines: Outlines::new(scene), heights, trails: Trails::default(), pixel_m }
    }

    /// Writes the entities that are due.
    pub(super) fn write(&mut self, log: &mut Log, snapshot: &Snapshot) -> Result<(), InspectError> {
        let objects = &snapshot.objects;
        self.trails.update(objects);
        if log.takes(Entity::Objects) {
            log.write(Entity::Objects, &boxes(objects, &self.settings))?;
        }
        if log.takes(Entity::Velocities) {
            let arrows = Arrows3D::from_vectors(objects.iter().map(|object| object.velocity_m_per_s));
            let arrows = arrows.with_origins(objects.iter().map(|object| object.position_m)).with_colors(colours(objects));
            log.write(Entity::Velocities, &arrows.with_radii([Radius::new_ui_points(1.5)]))?;
        }
        if log.takes(Entity::Trails) {
            let (strips, colours) = self.trails.strips();
            let trails = LineStrips3D::new(strips).with_colors(colours.into_iter().map(Rgba32::from));
            log.write(Entity::Trails, &trails.with_radii([Radius::new_ui_points(1.0)]))?;
        }
        if log.takes(Entity::MapObjects) {
            let places = objects.iter().map(|object| [object.position_m[0] / self.pixel_m, object.position_m[2] / self.pixel_m]);
            log.write(Entity::MapObjects, &Points2D::new(places).with_colors(colours(objects)).with_radii([Radius::new_ui_points(4.0)]))?;
        }
        self.write_shapes(log, snapshot.steps.last().map_or(&[][..], |step| step.causes.motions.as_slice()))
    }

    /// Writes the shapes of the objects in the newest step of the grass.
    fn write_shapes(&self, log: &mut Log, motions: &[Motion]) -> Result<(), InspectError> {
        if log.takes(Entity::Outlines) {
            let lines = LineStrips3D::new(self.outlines.edges(motions)).with_radii([Radius::new_ui_points(1.0)]);
            log.write(Entity::Outlines, &lines)?;
        }
        let (footprints, corners) = (log.takes(Entity::Footprints), log.takes(Entity::Contacts));
        if !footprints && !corners {
            return Ok(());
        }
        let contacts = self.outlines.contacts(motions, &self.heights);
        if footprints {
            let lines = LineStrips3D::new(contacts.footprints_m).with_radii([Radius::new_ui_points(2.0)]);
            log.write(Entity::Footprints, &lines.with_colors([Rgba32::from(CONTACT_RGB)]))?;
        }
        if corners {
            let arrows = Arrows3D::from_vectors(contacts.velocities_m_per_s).with_origins(contacts.corners_m);
            log.write(Entity::Contacts, &arrows.with_colors([Rgba32::from(CONTACT_RGB)]).with_radii([Radius::new_ui_points(1.0)]))?;
        }
        Ok(())
    }
}

/// The boxes of the objects, in the dimensions that the scene gives them.
fn boxes(objects: &[ObjectPose], settings: &Objects) -> Boxes3D {
    let half_extents_m = objects.iter().map(|object| settings.half_extents_m(object.kind));
    Boxes3D::from_centers_and_half_sizes(objects.iter().map(|object| object.position_m), half_extents_m)
        .with_quaternions(objects.iter().map(|object| Quaternion::from_xyzw(object.rotation)))
        .with_fill_mode(FillMode::TransparentFillMajorWireframe)
        .with_colors(colours(objects))
        .with_labels(objects.iter().map(label))
        .with_radii([Radius::new_ui_points(1.0)])
}

fn colours(objects: &[ObjectPose]) -> impl Iterator<Item = Rgba32> {
    objects.iter().map(|object| Rgba32::from(trail_rgb(object.kind)))
}

/// "car 3, 14 m/s".
fn label(object: &ObjectPose) -> String {
    let speed_m_per_s = object.velocity_m_per_s.iter().map(|v| v * v).sum::<f32>().sqrt();
    format!("{} {}, {speed_m_per_s:.0} m/s", object.kind.name(), object.id)
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::scene::VehicleKind;

    fn pose(kind: VehicleKind, x_m: f32) -> ObjectPose {
        let (rotation, velocity_m_per_s) = ([0.0, 0.0, 0.0, 1.0], [60.0, 0.0, 0.0]);
        ObjectPose { id: 7, kind, position_m: [x_m, 4.0, 50.0], rotation, velocity_m_per_s, part_rad: 0.0 }
    }

    #[test]
    fn the_boxes_have_the_dimensions_of_the_scene() {
        let sled_outline_m = vec![[-3.0, -1.0], [0.5, -1.0], [0.0, 4.0]];
        let settings = Objects { ball_radius_m: 2.5, sled_outline_m, ..Objects::default() };
        let found = boxes(&[pose(VehicleKind::Ball, 1.0), pose(VehicleKind::Sled, 2.0)], &settings);
        let [_, half_height_m, _] = Objects::default().half_extents_m(VehicleKind::Sled);
        assert_eq!(found.half_sizes, Boxes3D::from_half_sizes([[2.5, 2.5, 2.5], [3.0, half_height_m, 4.0]]).half_sizes);
    }
}
