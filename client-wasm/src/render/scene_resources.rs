//! The passes and textures of one scene.

use crate::render::gpu::constants::TILE_CELLS;
use crate::render::gpu::pipeline::PassFactory;
use crate::render::inputs::frame_bindings::{FrameBindings, SceneTextures};
use crate::render::land_and_sky::dust::Dust;
use crate::render::land_and_sky::rain::Rain;
use crate::render::land_and_sky::shade_map::ShadeMap;
use crate::render::land_and_sky::terrain::Terrain;
use crate::render::land_and_sky::terrain_quadtree::TerrainQuadtree;
use crate::render::options::render_options::BlendOrder;
use crate::render::plants::billboards::Billboards;
use crate::render::plants::blades::Blades;
use crate::render::plants::force_field::CameraForceField;
use crate::render::plants::grid_map::GridMap;
use crate::render::plants::shells::Shells;
use crate::render::plants::underbrush::Underbrush;
use crate::render::solids::objects::ObjectPasses;
use crate::render::solids::shadow_cache::ShadowCache;
use crate::render::solids::trees_and_stones::placed_models;
use crate::render::stage::{Stage, StageResources};
use crate::state::DecodedScene;

/// Height that rims of ruts have above undisturbed snow at most (m).
const RIM_M: f32 = 2.0;

/// Resources that are created for each scene, [stage](Stage) by stage. Those of a stage that is not loaded yet are `None`.
pub(super) struct SceneResources {
    pub(super) factory: PassFactory,
    pub(super) number: u32,
    /// Newest stage.
    pub(super) stage: Stage,
    pub(super) textures: SceneTextures,
    pub(super) quadtree: TerrainQuadtree,
    pub(super) terrain: Terrain,
    /// Created when first needed.
    pub(super) shade_map: Option<ShadeMap>,
    pub(super) blades: Option<Box<Blades>>,
    /// Created when first needed.
    pub(super) billboards: Option<Billboards>,
    /// Created when first needed.
    pub(super) shells: Option<Shells>,
    /// Created when first needed.
    pub(super) grid_map: Option<GridMap>,
    pub(super) objects: Option<Box<ObjectPasses>>,
    pub(super) shadow_cache: ShadowCache,
    pub(super) force_field: Box<CameraForceField>,
    /// `None` also where no underbrush grows, as are rain and dust where there is none.
    pub(super) underbrush: Option<Box<Underbrush>>,
    pub(super) rain: Option<Rain>,
    pub(super) dust: Option<Dust>,
}

impl SceneResources {
    /// The first stage of scene `number` of a mirror: land and sky.
    pub(super) fn new(factory: PassFactory, bindings: &FrameBindings, number: u32, decoded: &DecodedScene) -> Self {
        let (scene, heights) = (decoded.scene(), decoded.heights());
        let grass_m = scene.plants.most_grown() * scene.tallest_m();
        let cover_m = if scene.snow.lies() { grass_m.max(scene.snow.depth_m + RIM_M) } else { grass_m };
        let quadtree = TerrainQuadtree::new(scene.extent_m(), heights.pixel_m(), heights.range_m(), cover_m, scene.light.haze_m);
        Self {
            number,
            stage: Stage::Land,
            textures: SceneTextures::new(&factory.gpu, bindings, decoded),
            terrain: Terrain::new(&factory, decoded, &quadtree),
            // Ruts are as fine as the cells of the bend field.
            quadtree: if scene.snow.lies() { quadtree.finer(TILE_CELLS as f32 * scene.patches.cell_m) } else { quadtree },
            shade_map: None,
            blades: None,
            billboards: None,
            shells: None,
            grid_map: None,
            objects: None,
            shadow_cache: ShadowCache::default(),
            force_field: Box::new(CameraForceField::new(&factory.gpu, decoded, &placed_models(decoded))),
            underbrush: None,
            rain: None,
            dust: None,
            factory,
        }
    }

    /// Adds a stage, so that the next frame shows it.
    pub(super) fn add(&mut self, stage: Stage, resources: StageResources) {
        self.stage = stage;
        match resources {
            StageResources::Grass(blades) => self.blades = Some(blades),
            StageResources::Solids(objects) => {
                self.objects = Some(objects);
                // Cascades drawn so far have no casters.
                self.shadow_cache = ShadowCache::default();
            }
            StageResources::Underbrush(underbrush) => self.underbrush = underbrush,
            StageResources::Weather(rain, dust) => (self.rain, self.dust) = (rain, dust),
        }
    }

    /// The shells, created when first needed.
    pub(super) fn shells(&mut self, decoded: &DecodedScene) -> &mut Shells {
        self.shells.get_or_insert_with(|| Shells::new(&self.factory, decoded, &self.quadtree, &self.force_field))
    }

    /// The clumps, created when first needed.
    pub(super) fn billboards(&mut self) -> &mut Billboards {
        self.billboards.get_or_insert_with(|| Billboards::new(&self.factory, &self.force_field))
    }

    /// Whether a frame may need several batches.
    pub(super) fn by_batches(&self) -> bool {
        self.blades.as_ref().is_some_and(|blades| blades.by_batches())
    }

    /// Sets the blend order of the following frames; clumps only if they are drawn.
    pub(super) fn set_order(&mut self, order: BlendOrder, has_clumps: bool) {
        if let Some(blades) = &mut self.blades {
            blades.set_order(&self.factory, order);
        }
        if has_clumps {
            let factory = self.factory.clone();
            self.billboards().set_order(&factory, order);
        }
    }

    /// Creates a variant of a pipeline that no frame has needed yet. Returns false if there is none.
    pub(super) fn create_next_variant(&self) -> bool {
        self.blades.as_ref().is_some_and(|blades| blades.create_next())
            || self.objects.as_ref().is_some_and(|objects| objects.create_next())
            || self.shells.as_ref().is_some_and(|shells| shells.create_next())
            || self.underbrush.as_ref().is_some_and(|underbrush| underbrush.create_next())
            || self.terrain.create_next()
    }
}
