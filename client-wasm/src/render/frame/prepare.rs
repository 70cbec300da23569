//! First step of a frame: updates textures and uniforms, and builds the draw lists.

use crate::render::frame::moment::Moment;
use crate::render::gpu::device::Gpu;
use crate::render::gpu::uniforms::Frame;
use crate::render::inputs::cascades::SHADOW_CASCADES;
use crate::render::inputs::depth_pyramid::DepthPyramid;
use crate::render::inputs::frustum::{CascadeVolume, Frustum};
use crate::render::inputs::view::View;
use crate::render::inputs::viewpoint::Viewpoint;
use crate::render::land_and_sky::shade_map::ShadeMap;
use crate::render::options::render_options::{BlendOrder, FarPlants};
use crate::render::plants::billboards::{Billboards, ClumpRange};
use crate::render::plants::grid_map::GridMap;
use crate::render::plants::shells::{ShellExtent, ShellRequest, Shells};
use crate::render::plants::weighted_oit::WeightedOit;
use crate::render::renderer::Renderer;
use crate::render::scene_resources::SceneResources;
use crate::render::solids::shadow_cache::ShadowView;
use crate::render::solids::vehicles::headlights;
use crate::render::stage::Stage;
use crate::state::{DecodedScene, Mirror};
use glam::{Mat4, Vec3};
use prairie_core::scene::PlantCover;
use prairie_core::wire::ObjectPose;
use std::ops::Range;

/// Maximum distance of clumps with several segments, relative to that of the last single plants.
const SEVERAL_SEGMENTS_REACH: f32 = 1.6;

/// Decisions of [`Renderer::prepare`] that the passes of the frame follow.
#[derive(Default)]
pub(super) struct FramePlan {
    pub(super) order: BlendOrder,
    pub(super) has_clumps: bool,
    pub(super) shells: Option<ShellExtent>,
    /// Whether the map of the grids is drawn over the picture.
    pub(super) shows_grids: bool,
    pub(super) has_lamps: bool,
    pub(super) has_spheres: bool,
    /// Whether stars are visible, and whether rain clouds are.
    pub(super) sky_shows: [bool; 2],
    /// Shadow cascades that are redrawn.
    pub(super) due_cascades: Vec<u32>,
    /// Batches in which plants are listed and drawn, at least 1.
    pub(super) batches: u32,
    pub(super) patches_written: u32,
    /// Whether grass casts shadows.
    pub(super) grass_shades: bool,
    /// Whether plants and solids behind others are culled.
    pub(super) occludes: bool,
}

impl FramePlan {
    /// The shells, if the frame shows any.
    pub(super) fn shells<'a>(&self, scene: &'a SceneResources) -> Option<&'a Shells> {
        scene.shells.as_ref().filter(|_| self.shells.is_some())
    }

    /// The map of the grids, if the frame shows it.
    pub(super) fn grid_map<'a>(&self, scene: &'a SceneResources) -> Option<&'a GridMap> {
        scene.grid_map.as_ref().filter(|_| self.shows_grids)
    }

    /// The clumps, if the frame shows any.
    pub(super) fn clumps<'a>(&self, scene: &'a SceneResources) -> Option<&'a Billboards> {
        scene.billboards.as_ref().filter(|_| self.has_clumps)
    }
}

impl Renderer {
    pub(super) fn prepare(
        &mut self,
        scene: &mut SceneResources,
        mirror: &mut Mirror,
        moment: &Moment<'_>,
        columns: &Range<u32>,
    ) -> FramePlan {
        let &Moment { camera, time_secs, dt_secs } = moment;
        let poses: Vec<ObjectPose> = mirror.objects().collect();
        let eye_xz_m = [camera.eye_m.x, camera.eye_m.z];
        let patches_written = scene.textures.atlas.update(&self.gpu, mirror, eye_xz_m, dt_secs);
        mirror.advance_repeated_patch();
        scene.textures.repeated.update(&self.gpu, mirror, eye_xz_m, dt_secs);
        scene.textures.wind.update(&self.gpu, mirror.shown_wind(time_secs));
        let Some(decoded) = mirror.decoded_scene() else { return FramePlan::default() };

        let sun = self.options.sun.unwrap_or_else(|| decoded.scene().light.sun_at(time_secs));
        self.daylight.update(&self.gpu, sun);
        let detail = self.detail.on(&decoded.scene().plants).with(self.options.far_plants);
        let detail = if scene.stage == Stage::Land { detail.without_blades() } else { detail };
        let view = View::new(camera, self.targets.size_px, self.quality, detail, time_secs, sun);
        let mut frame = view.frame(decoded, &scene.textures, &self.daylight, &poses, &headlights(&poses));
        if self.options.grass_shadows {
            frame.shade_strength = 1.0;
            scene.shade_map.get_or_insert_with(|| ShadeMap::new(&scene.factory));
        }
        let (eye_m, heading_rad) = (camera.eye_m, camera.heading_rad);
        let shadow_view = ShadowView { eye_m, heading_rad, sun, trees_m: detail.trees_m, culls: self.options.culls, time_secs };
        let cascades = update_cascades(scene, decoded, &mut frame, shadow_view, &poses, dt_secs);
        self.bindings.write(&self.gpu, &frame);

        let frustum = self.frustum(&view.projection_from_world);
        let viewpoint = Viewpoint {
            eye_m,
            ground_m: decoded.heights().height_m(eye_m.x, eye_m.z),
            frustum: &frustum,
            detail: &detail,
            options: self.options,
            dt_secs,
            picture_sr: self.picture_sr(frame.pixel_rad),
        };
        let mut plan = self.plan(scene, decoded, &frame, &cascades, patches_written);
        self.set_blend_order(scene, &mut plan);
        scene.prepare_land(&self.gpu, &viewpoint);
        scene.prepare_forces(&self.gpu, decoded, &viewpoint, &poses);
        scene.prepare_grass(&self.gpu, decoded, &viewpoint, &frame, &mut plan);
        if plan.shows_grids {
            self.prepare_grid_map(scene, decoded, &viewpoint, plan.has_clumps, columns);
        }
        scene.prepare_underbrush(&self.gpu, mirror, &viewpoint);
        if let Some(objects) = &mut scene.objects {
            objects.show_race(mirror.next_gate(), mirror.ghost_pose());
            objects.prepare(&self.gpu, &poses, &viewpoint, cascades, time_secs as f32, frame.pixel_rad);
            plan.occludes = objects.occludes();
            if plan.occludes && self.depth_pyramid.is_none() {
                self.depth_pyramid = Some(DepthPyramid::new(&scene.factory, &self.targets.depth, false));
            }
        }
        plan
    }

    /// Creates the map of the grids when it is first shown, and sets its contents.
    fn prepare_grid_map(
        &self,
        scene: &mut SceneResources,
        decoded: &DecodedScene,
        from: &Viewpoint<'_>,
        has_clumps: bool,
        columns: &Range<u32>,
    ) {
        let SceneResources { factory, blades: Some(blades), billboards, grid_map, .. } = scene else { return };
        let grid_m = decoded.scene().plants.grid_m;
        let map = grid_map.get_or_insert_with(|| GridMap::new(factory, blades, &self.quality.detail(), grid_m, self.tone.target()));
        map.prepare(&self.gpu, blades, billboards.as_ref().filter(|_| has_clumps), from.detail, grid_m, (columns, self.size_px));
    }

    /// Solid angle of the picture (sr), as that of its pixels at its middle.
    fn picture_sr(&self, pixel_rad: f32) -> f32 {
        self.targets.size_px.map(|px| px as f32 * pixel_rad).iter().product()
    }

    fn frustum(&self, projection_from_world: &Mat4) -> Frustum {
        if self.options.culls { Frustum::new(projection_from_world) } else { Frustum::ALL }
    }

    /// Which plants are drawn by which method.
    fn plan(&self, scene: &SceneResources, decoded: &DecodedScene, frame: &Frame, cascades: &Cascades, patches_written: u32) -> FramePlan {
        let far_plants = self.options.far_plants;
        let shells = match (decoded.scene().plants.cover, far_plants) {
            (PlantCover::Shells, _) => Some(ShellExtent::All),
            (PlantCover::Blades, FarPlants::Shells) if scene.blades.is_some() => Some(ShellExtent::BeyondBlades),
            _ => None,
        };
        FramePlan {
            order: self.options.blend_order,
            has_clumps: far_plants == FarPlants::Clumps && scene.blades.is_some(),
            shells,
            shows_grids: self.options.shows_grids && scene.blades.is_some(),
            has_lamps: frame.has_lamps(),
            has_spheres: frame.has_spheres(),
            sky_shows: frame.sky_shows(),
            due_cascades: (0..).zip(cascades).filter_map(|(cascade, volume)| volume.map(|_| cascade)).collect(),
            batches: 1,
            patches_written,
            grass_shades: frame.shade_strength > 0.0,
            occludes: false,
        }
    }

    /// Replaces a transparency order that the scene or target does not support, and creates the resources that the order needs.
    fn set_blend_order(&mut self, scene: &mut SceneResources, plan: &mut FramePlan) {
        let samples = self.quality.samples(self.gpu.is_software);
        plan.order = plan.order.supported(samples, scene.by_batches());
        scene.set_order(plan.order, plan.has_clumps);
        if plan.order == BlendOrder::Weighted && self.weighted.is_none() {
            self.weighted = Some(WeightedOit::new(&scene.factory, self.targets.size_px));
        }
    }
}

/// Volumes of the shadow cascades that are redrawn.
type Cascades = [Option<CascadeVolume>; SHADOW_CASCADES as usize];

/// Decides which cascades are redrawn, and gives the others the projections of their cached drawings.
fn update_cascades(
    scene: &mut SceneResources,
    decoded: &DecodedScene,
    frame: &mut Frame,
    shadow_view: ShadowView,
    poses: &[ObjectPose],
    dt_secs: f32,
) -> Cascades {
    // Rotors and custom models reach beyond the collision box.
    let reach_m = |pose: &ObjectPose| 2.0 * Vec3::from(decoded.scene().objects.half_extents_m(pose.kind)).length();
    let is_due = scene.shadow_cache.update(frame, shadow_view, poses, reach_m, dt_secs);
    let projections = [&frame.shadow_from_world, &frame.lights.far_shadow_from_world];
    std::array::from_fn(|cascade| is_due[cascade].then(|| CascadeVolume::new(projections[cascade])))
}

impl SceneResources {
    fn prepare_land(&mut self, gpu: &Gpu, from: &Viewpoint<'_>) {
        let tiles = self.quadtree.tiles(from.eye_m, from.frustum);
        self.terrain.prepare(gpu, from.eye_m, &tiles, &self.textures.atlas.bent_patches(self.textures.repeated.per_m() > 0.0));
        if let Some(dust) = &self.dust {
            dust.prepare(gpu, self.textures.wind.dusty(), from.dt_secs);
        }
    }

    fn prepare_grass(&mut self, gpu: &Gpu, decoded: &DecodedScene, from: &Viewpoint<'_>, frame: &Frame, plan: &mut FramePlan) {
        if let Some(blades) = &mut self.blades {
            blades.prepare(gpu, decoded, from);
            plan.batches = blades.batches();
        }
        if let Some(extent) = plan.shells {
            let request =
                ShellRequest { extent, from_m: frame.blades_fade_from_m, end_m: frame.far_end_m, layers: from.options.shell_layers };
            self.shells(decoded).prepare(gpu, decoded, from.eye_m, from.frustum, request);
        } else if plan.has_clumps {
            let several_m = SEVERAL_SEGMENTS_REACH * frame.blades_end_m;
            let raised_over_m_per_s = from.options.raises_far_wind.then(|| self.textures.wind.ground_mean_m_per_s());
            let range = ClumpRange { from_m: frame.blades_fade_from_m, several_m, to_m: frame.far_end_m, raised_over_m_per_s };
            self.billboards().prepare(gpu, decoded, from.eye_m, from.frustum, &range);
        }
    }

    /// Advances the force field if plants feel it.
    fn prepare_forces(&mut self, gpu: &Gpu, decoded: &DecodedScene, from: &Viewpoint<'_>, poses: &[ObjectPose]) {
        if self.blades.is_some() || self.shells.is_some() || self.underbrush.is_some() {
            self.force_field.update(gpu, decoded, &self.textures.wind, poses, [from.eye_m.x, from.eye_m.z], from.dt_secs);
        }
    }

    fn prepare_underbrush(&mut self, gpu: &Gpu, mirror: &Mirror, from: &Viewpoint<'_>) {
        let Some(underbrush) = &mut self.underbrush else { return };
        underbrush.show_broken(gpu, mirror.falls(), mirror.broken_count());
        underbrush.prepare(gpu, from);
    }
}
