//! The passes and textures of one scene.

use crate::render::gpu::pipeline::PassFactory;
use crate::render::inputs::frame_bindings::{FrameBindings, SceneTextures};
use crate::render::land_and_sky::dust::Dust;
use crate::render::land_and_sky::rain::Rain;
use crate::render::land_and_sky::terrain::{Terrain, TerrainQuadtree};
use crate::render::options::quality::Quality;
use crate::render::plants::billboards::Billboards;
use crate::render::plants::blades::Blades;
use crate::render::plants::force_field::CameraForceField;
use crate::render::plants::shells::Shells;
use crate::render::plants::underbrush::Underbrush;
use crate::render::solids::objects::ObjectPasses;
use crate::render::solids::shadow_cache::ShadowCache;
use crate::render::solids::trees_and_stones;
use crate::state::DecodedScene;

/// Resources that are created for each scene.
pub(super) struct SceneResources {
    pub(super) number: u32,
    /// Whether more than one kind of grass grows.
    pub(super) has_kinds: bool,
    pub(super) textures: SceneTextures,
    pub(super) quadtree: TerrainQuadtree,
    pub(super) terrain: Terrain,
    pub(super) billboards: Billboards,
    pub(super) blades: Blades,
    pub(super) shells: Shells,
    pub(super) force_field: CameraForceField,
    pub(super) underbrush: Option<Underbrush>,
    pub(super) rain: Option<Rain>,
    pub(super) objects: ObjectPasses,
    pub(super) shadow_cache: ShadowCache,
    pub(super) dust: Option<Dust>,
}

impl SceneResources {
    /// Loads scene `number` of a mirror.
    pub(super) fn new(factory: &PassFactory<'_>, bindings: &FrameBindings, quality: Quality, number: u32, decoded: &DecodedScene) -> Self {
        let (gpu, scene, heights) = (factory.gpu, decoded.scene(), decoded.heights());
        let placed = trees_and_stones::placed_models(decoded);
        let force_field = CameraForceField::new(gpu, decoded, &placed);
        let grass_m = scene.plants.most_grown() * scene.tallest_m();
        let quadtree = TerrainQuadtree::new(scene.extent_m(), heights.pixel_m(), heights.range_m(), grass_m, scene.light.haze_m);
        Self {
            number,
            has_kinds: factory.has_kinds,
            textures: SceneTextures::new(gpu, bindings, decoded),
            shells: Shells::new(factory, decoded, &quadtree),
            quadtree,
            terrain: Terrain::new(factory, scene.extent_m()),
            billboards: Billboards::new(factory),
            blades: Blades::new(factory, quality, decoded),
            underbrush: Underbrush::new(factory, quality, decoded, &force_field),
            force_field,
            rain: Rain::new(factory, quality, decoded),
            objects: ObjectPasses::new(factory, quality, decoded, placed),
            shadow_cache: ShadowCache::default(),
            dust: Dust::new(factory, quality, decoded),
        }
    }
}
