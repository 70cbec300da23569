//! Writes what does not change: axes, terrain, height map and covering map.

use super::bend_map::BendMap;
use super::entities::Entity;
use super::error::InspectError;
use super::land::cover_names;
use super::log::{Log, image};
use super::terrain_mesh::TerrainMesh;
use prairie_core::grid::PatchLayout;
use prairie_core::scene::Scene;
use prairie_core::terrain::{CoverMap, HeightMap};
use rerun::components::{Colormap, ImageFormat};
use rerun::datatypes::ChannelDatatype;
use rerun::{AnnotationContext, Mesh3D, Rgba32, SegmentationImage, ViewCoordinates};

/// Writes the land, whose terrain is textured with `map`.
pub(super) fn write_land(log: &Log, scene: &Scene, heights: &HeightMap, cover: &CoverMap, map: &BendMap) -> Result<(), InspectError> {
    log.keep(Entity::World, &ViewCoordinates::RIGHT_HAND_Y_UP())?;
    let mesh = TerrainMesh::new(&PatchLayout::from(&scene.patches), heights, &scene.light);
    let ground = Mesh3D::new(&mesh.positions_m)
        .with_triangle_indices(&mesh.triangles)
        .with_vertex_colors(mesh.shades.iter().copied().map(Rgba32::from))
        .with_vertex_texcoords(&mesh.texcoords)
        .with_albedo_texture_format(ImageFormat::rgb8(map.size_px()));
    log.keep(Entity::Ground, &ground)?;
    let [low_m, high_m] = heights.range_m().map(f64::from);
    let height = image(heights.heights_m(), heights.size_px()).with_colormap(Colormap::Viridis);
    log.keep(Entity::LandHeight, &height.with_depth_range([low_m, high_m]))?;
    let names = cover_names(scene, cover);
    log.keep(Entity::Land, &AnnotationContext::new(names.iter().map(|(id, name)| (u16::from(*id), name.as_str()))))?;
    let format = ImageFormat::segmentation(cover.size_px(), ChannelDatatype::U8);
    log.keep(Entity::LandCover, &SegmentationImage::new(cover.ids().to_vec(), format).with_opacity(1.0))
}
