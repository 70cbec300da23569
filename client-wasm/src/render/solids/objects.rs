//! Draws vehicles, trees, stones, models of the scene's own and gates, in the picture and in the shadow map.

use crate::render::gpu::constants::{DRAW_WORDS, WORKGROUP_SIZE};
use crate::render::gpu::device::Gpu;
use crate::render::gpu::pipeline::{DrawDescriptor, PassFactory, bind_as, bind_at, storage, storage_rw, texture};
use crate::render::gpu::shaders;
use crate::render::gpu::variants::LampVariants;
use crate::render::inputs::frustum::CascadeVolume;
use crate::render::inputs::lowest_land::LowestLand;
use crate::render::inputs::viewpoint::Viewpoint;
use crate::render::options::quality::Quality;
use crate::render::options::render_options::Occlusion;
use crate::render::solids::bounding_sphere::BoundingSphere;
use crate::render::solids::gates::{self, PlacedPart};
use crate::render::solids::grown_trees::GrownTree;
use crate::render::solids::instances::{DrawList, INSTANCE_LIMIT, Instance, InstanceLists, RIGID_MARKS, join};
use crate::render::solids::leaf_texture::{LEAF_PX, leaves};
use crate::render::solids::limb_passes::LimbPasses;
use crate::render::solids::mesh::{VERTEX_ATTRIBUTES, Vertex};
use crate::render::solids::model_meshes::ModelMeshes;
use crate::render::solids::occlusion::{Phase, SolidOcclusion, Tested};
use crate::render::solids::spatial_index::{NearModel, SpatialIndex};
use crate::render::solids::trees_and_stones::{PlacedKind, PlacedModel, TreeDetail};
use crate::render::solids::vehicles::{Motion, vehicle_model};
use crate::state::{DecodedScene, OBJECT_LIMIT};
use glam::{Affine3A, Mat4, Quat, Vec3};
use prairie_core::wire::{ObjectId, ObjectPose};
use std::collections::HashMap;
use std::ops::Range;
use wgpu::BufferUsages;

/// Instances reserved for each vehicle: six parts, in the picture and in two cascades.
const VEHICLE_INSTANCES: usize = 18;
/// Color factor of the ghost's vehicle, which turns every paint into a pale blue.
const GHOST_TINT: [f32; 4] = [0.8, 1.4, 2.4, 0.0];
/// Bytes of a tree's sway in `objects.wgsl`.
const SWAY_BYTES: usize = 16;
/// Minimum height on screen of fine trees, and maximum of distant ones (px), at high quality.
pub(crate) const FINE_TREE_PX: f32 = 130.0;
pub(crate) const DISTANT_TREE_PX: f32 = 26.0;
/// Solids are tested for occlusion if those in view have at least so many triangles, or if the bounding spheres of those that are not trees cover at least this
/// fraction of the picture, each counted by itself.
const OCCLUDING_TRIANGLES: u64 = 65_536;
const OCCLUDING_SHARE: f32 = 0.5;
/// Detail of the trees in each shadow cascade.
const SHADOW_DETAIL: [TreeDetail; 2] = [TreeDetail::Coarse, TreeDetail::Distant];

struct Pipelines {
    /// Pipeline for vehicles and gates, which may be glossy.
    glossy: wgpu::RenderPipeline,
    fine_trees: wgpu::RenderPipeline,
    matte: wgpu::RenderPipeline,
    /// Pipeline for coarse and distant trees; lights them per vertex where the quality is [cheap](Quality::is_cheap).
    coarse_trees: wgpu::RenderPipeline,
}

pub(crate) struct ObjectPasses {
    pipelines: LampVariants<Pipelines>,
    shadow_pipelines: [wgpu::RenderPipeline; 2],
    group: wgpu::BindGroup,
    sway: wgpu::ComputePipeline,
    sway_group: wgpu::BindGroup,
    instances: wgpu::Buffer,
    /// Instances of the newest frame.
    count: u32,
    meshes: ModelMeshes,
    /// Bends the components of trees that have any.
    limbs: Option<LimbPasses>,
    index: SpatialIndex,
    land: LowestLand,
    /// Parts of the gates of the scene's race.
    gates: Vec<PlacedPart>,
    /// Gate that is marked as the next one.
    next_gate: Option<usize>,
    /// The ghost of the fastest lap.
    ghost: Option<ObjectPose>,
    /// Distance that each vehicle has travelled forward (m).
    rolled_m: HashMap<ObjectId, f32>,
    picture_list: DrawList,
    cascade_lists: [DrawList; 2],
    occlusion: SolidOcclusion,
    /// Whether the solids of the newest frame are tested for occlusion.
    occludes: bool,
}

impl ObjectPasses {
    pub(crate) fn new(factory: &PassFactory, quality: Quality, decoded: &DecodedScene, placed: Vec<PlacedModel>) -> Self {
        let gpu = &factory.gpu;
        let trees = GrownTree::of_scene(decoded.scene());
        let is_grown = !trees.is_empty();
        let meshes = ModelMeshes::new(gpu, decoded, &trees);
        let index = SpatialIndex::new(placed.into_iter().map(|placed| (placed, meshes.bounds_of(&placed))).collect());
        let module = factory.shader("objects", shaders::OBJECTS, &[("is_grown", is_grown)]);
        let layout = factory.layout("objects", &[storage(0), texture(1), storage(2), storage(4)]);
        let size = (INSTANCE_LIMIT * size_of::<Instance>()) as u64;
        let instances = gpu.empty_buffer("instances", size, BufferUsages::STORAGE | BufferUsages::COPY_DST);
        let leaves = gpu.texture("leaves", wgpu::TextureFormat::Rgba8Unorm, [LEAF_PX; 2], &leaves());
        let leaves = leaves.create_view(&Default::default());
        let sways = gpu.empty_buffer("sways of objects", (INSTANCE_LIMIT * SWAY_BYTES) as u64, BufferUsages::STORAGE);
        let bent = LimbPasses::bent(gpu, is_grown);
        let texture = wgpu::BindingResource::TextureView(&leaves);
        let resources = [(0, instances.as_entire_binding()), (1, texture), (2, sways.as_entire_binding()), (4, bent.as_entire_binding())];
        let occlusion = SolidOcclusion::new(factory, RIGID_MARKS + index.count());
        let sway_layout = factory.layout("blow", &[storage(0), storage_rw(3)]);
        Self {
            pipelines: pipelines(factory.clone(), quality, layout.clone(), is_grown),
            shadow_pipelines: shadow_pipelines(factory, &module, &layout),
            group: bind_at(gpu, "objects", &layout, resources),
            sway: factory.compute("blow", &module, "blow", &sway_layout),
            sway_group: bind_as(gpu, "blow", &sway_layout, &[(0, &instances), (3, &sways)]),
            count: 0,
            limbs: is_grown.then(|| LimbPasses::new(factory, &module, &trees, [&instances, &sways, &bent])),
            instances,
            meshes,
            index,
            land: LowestLand::new(decoded, decoded.scene().plants.grid_m),
            gates: gates::placed(decoded),
            next_gate: None,
            ghost: None,
            rolled_m: HashMap::new(),
            picture_list: Vec::new(),
            cascade_lists: Default::default(),
            occlusion,
            occludes: false,
        }
    }

    /// Shows a race: the gate to be marked as the next one, and the ghost.
    pub(crate) fn show_race(&mut self, next_gate: Option<usize>, ghost: Option<ObjectPose>) {
        (self.next_gate, self.ghost) = (next_gate, ghost);
    }

    /// Lists the models in view, and the shadow casters of the cascades that are redrawn.
    pub(crate) fn prepare(
        &mut self,
        gpu: &Gpu,
        poses: &[ObjectPose],
        from: &Viewpoint<'_>,
        cascades: [Option<CascadeVolume>; 2],
        time_secs: f32,
        pixel_rad: f32,
    ) {
        let by_mesh = vec![Vec::new(); self.meshes.count()];
        let tested = vec![Vec::new(); self.meshes.count()];
        let mut lists = InstanceLists { cascades: [by_mesh.clone(), by_mesh.clone()], picture: by_mesh, tested, rigid: 0 };
        self.list_vehicles(&mut lists, poses, from, &cascades, time_secs);
        self.list_gates(&mut lists, from, &cascades);
        self.list_ghost(&mut lists, from, time_secs);
        let taken = VEHICLE_INSTANCES * (OBJECT_LIMIT.min(poses.len()) + 1) + 3 * self.gates.len();
        let room = INSTANCE_LIMIT.saturating_sub(taken);
        self.list_placed(&mut lists, from, &cascades, room / 3, pixel_rad);
        let mut all = Vec::new();
        self.picture_list = join(&lists.picture, &mut all);
        self.occludes = from.options.culls
            && match from.options.occlusion {
                Occlusion::Never => false,
                Occlusion::Adaptive => {
                    let trees = self.meshes.tree(0, TreeDetail::Fine)..self.meshes.stone(0);
                    self.triangles() >= OCCLUDING_TRIANGLES || lists.share(&trees, from.eye_m, from.picture_sr) >= OCCLUDING_SHARE
                }
                Occlusion::Always => true,
            };
        if self.occludes {
            self.prepare_occlusion(gpu, &lists.tested);
        }
        self.cascade_lists = lists.cascades.map(|list| join(&list, &mut all));
        if let Some(limbs) = &mut self.limbs {
            limbs.assign(gpu, &mut all);
        }
        self.count = all.len() as u32;
        gpu.queue.write_buffer(&self.instances, 0, bytemuck::cast_slice(&all));
    }

    /// Sets the bounds and the draws of the listed instances.
    fn prepare_occlusion(&mut self, gpu: &Gpu, tested: &[Vec<Tested>]) {
        let meshes: Vec<(Range<u32>, [u32; DRAW_WORDS as usize])> =
            self.picture_list.iter().map(|(mesh, instances)| (instances.clone(), self.meshes.indirect_draw(*mesh))).collect();
        let listed = |(mesh, instances): &(usize, Range<u32>)| &tested[*mesh][..instances.len()];
        let tested = self.picture_list.iter().flat_map(listed).copied().collect::<Vec<_>>();
        self.occlusion.prepare(gpu, &tested, &meshes);
    }

    fn list_vehicles(
        &mut self,
        lists: &mut InstanceLists,
        poses: &[ObjectPose],
        from: &Viewpoint<'_>,
        cascades: &[Option<CascadeVolume>; 2],
        time_secs: f32,
    ) {
        self.rolled_m.retain(|id, _| poses.iter().any(|pose| pose.id == *id));
        for pose in poses.iter().take(OBJECT_LIMIT) {
            let rotation = Quat::from_array(pose.rotation);
            let forward = rotation * Vec3::NEG_Z;
            let rolled_m = self.rolled_m.entry(pose.id).or_default();
            *rolled_m = (*rolled_m + Vec3::from(pose.velocity_m_per_s).dot(forward) * from.dt_secs) % 1000.0;
            let body = Affine3A::from_rotation_translation(rotation, Vec3::from(pose.position_m));
            let motion = Motion { rolled_m: *rolled_m, time_secs };
            for (part, body_from_part) in (vehicle_model(pose.kind).place)(pose, motion) {
                let mesh = self.meshes.part(pose.kind, part);
                let instance = Instance::new(&Mat4::from(body * body_from_part), [1.0, 1.0, 1.0, 0.0]);
                lists.show_rigid(&self.meshes, mesh, instance, |bounds| is_seen(&self.land, from, bounds));
                for (list, _) in lists.cascades.iter_mut().zip(cascades).filter(|(_, cascade)| cascade.is_some()) {
                    list[mesh].push(instance);
                }
            }
        }
    }

    /// Lists the ghost: a pale vehicle without a shadow.
    fn list_ghost(&self, lists: &mut InstanceLists, from: &Viewpoint<'_>, time_secs: f32) {
        let Some(pose) = &self.ghost else { return };
        let body = Affine3A::from_rotation_translation(Quat::from_array(pose.rotation), Vec3::from(pose.position_m));
        for (part, body_from_part) in (vehicle_model(pose.kind).place)(pose, Motion { rolled_m: 0.0, time_secs }) {
            let instance = Instance::new(&Mat4::from(body * body_from_part), GHOST_TINT);
            let mesh = self.meshes.part(pose.kind, part);
            lists.show_rigid(&self.meshes, mesh, instance, |bounds| is_seen(&self.land, from, bounds));
        }
    }

    /// Lists all gates: there are few.
    fn list_gates(&self, lists: &mut InstanceLists, from: &Viewpoint<'_>, cascades: &[Option<CascadeVolume>; 2]) {
        for placed in &self.gates {
            let [r, g, b] = placed.tint(self.next_gate);
            let instance = Instance::new(&placed.world_from_part, [r, g, b, 0.0]);
            let mesh = self.meshes.gate_part(placed.part);
            lists.show_rigid(&self.meshes, mesh, instance, |bounds| is_seen(&self.land, from, bounds));
            for (list, _) in lists.cascades.iter_mut().zip(cascades).filter(|(_, cascade)| cascade.is_some()) {
                list[mesh].push(instance);
            }
        }
    }

    /// Lists at most `limit` of the trees, stones and models of the scene's own.
    fn list_placed(
        &self,
        lists: &mut InstanceLists,
        from: &Viewpoint<'_>,
        cascades: &[Option<CascadeVolume>; 2],
        limit: usize,
        pixel_rad: f32,
    ) {
        let is_seen = |bounds: &BoundingSphere| is_seen(&self.land, from, bounds);
        let casts = |cascade: &Option<CascadeVolume>, bounds: &BoundingSphere| {
            cascade.as_ref().is_some_and(|cascade| !from.options.culls || cascade.meets_sphere(bounds.centre_m, bounds.radius_m))
        };
        let may_show = |bounds: &BoundingSphere| is_seen(bounds) || cascades.iter().any(|cascade| casts(cascade, bounds));
        let mut spare = LimbPasses::spare(INSTANCE_LIMIT) as u32;
        for NearModel { distance_m, number, placed, bounds } in self.index.near(from.eye_m, from.detail.trees_m, limit, may_show) {
            let tall_px = placed.size_m / (distance_m * pixel_rad * from.detail.coarser);
            let detail = match tall_px {
                FINE_TREE_PX.. => TreeDetail::Fine,
                DISTANT_TREE_PX.. => TreeDetail::Coarse,
                _ => TreeDetail::Distant,
            };
            if is_seen(bounds) {
                let (mesh, instance) = self.instance(placed, detail, &mut spare);
                lists.show(mesh, instance, *bounds, RIGID_MARKS + number);
            }
            for ((list, cascade), detail) in lists.cascades.iter_mut().zip(cascades).zip(SHADOW_DETAIL) {
                if casts(cascade, bounds) {
                    let (mesh, instance) = self.instance(placed, detail, &mut spare);
                    list[mesh].push(instance);
                }
            }
        }
    }

    /// Mesh and instance of a placed model at a level of detail: a tree of components is distant if no `spare` ones are left to bend.
    fn instance(&self, placed: &PlacedModel, detail: TreeDetail, spare: &mut u32) -> (usize, Instance) {
        let instance = Instance::new(&placed.world_from_model, placed.tint);
        match (placed.kind, &self.limbs) {
            (PlacedKind::Stone, _) => (self.meshes.stone(placed.shape), instance),
            (PlacedKind::Own, _) => (self.meshes.own_model(placed.shape), instance),
            (PlacedKind::Tree, None) => (self.meshes.tree(placed.shape, detail), instance),
            (PlacedKind::Tree, Some(limbs)) => {
                let more = limbs.range(placed.shape, detail)[1] - 1;
                let detail = if more <= *spare { detail } else { TreeDetail::Distant };
                let range = limbs.range(placed.shape, detail);
                *spare -= range[1] - 1;
                (self.meshes.tree(placed.shape, detail), instance.with_limbs(range))
            }
        }
    }

    /// Creates a variant of a pipeline that no frame has needed yet. Returns false if there is none.
    pub(crate) fn create_next(&self) -> bool {
        self.pipelines.create_next()
    }

    /// Triangles of the solids in view, hidden ones included.
    pub(crate) fn triangles(&self) -> u64 {
        self.picture_list.iter().map(|(mesh, instances)| self.meshes.triangles(*mesh) * instances.len() as u64).sum()
    }

    /// Computes the sway of each instance of this frame, and bends the components of trees.
    pub(crate) fn sway(&self, pass: &mut wgpu::ComputePass<'_>) {
        pass.set_pipeline(&self.sway);
        pass.set_bind_group(1, &self.sway_group, &[]);
        pass.dispatch_workgroups(self.count.div_ceil(WORKGROUP_SIZE), 1, 1);
        self.limbs.iter().for_each(|limbs| limbs.bend(pass));
        if self.occludes {
            self.occlusion.list_known(pass);
        }
    }

    /// Whether this frame tests its solids for occlusion, and plants against them.
    pub(crate) fn occludes(&self) -> bool {
        self.occludes
    }

    /// Lists the solids of the second phase once the depth pyramid of the first one is complete.
    pub(crate) fn list_new(&self, pass: &mut wgpu::ComputePass<'_>) {
        self.occlusion.list_new(pass);
    }

    /// Numbers of solids in view and of those drawn, and of the triangles of the latter.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn drawn(&self, read: impl Fn(&wgpu::Buffer) -> Vec<u8>) -> [u64; 3] {
        let all = self.picture_list.iter().map(|(_, instances)| instances.len() as u64).sum();
        let [solids, triangles] = if self.occludes { self.occlusion.drawn(&read(self.occlusion.draws())) } else { [all, self.triangles()] };
        [all, solids, triangles]
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, phase: Phase, has_lamps: bool) {
        let Pipelines { glossy, fine_trees, matte, coarse_trees } = self.pipelines.of(has_lamps);
        let ends = [self.meshes.tree(0, TreeDetail::Fine), self.meshes.tree(0, TreeDetail::Coarse), self.meshes.stone(0), usize::MAX];
        let mut next = 0;
        self.meshes.set(pass);
        pass.set_vertex_buffer(1, self.occlusion.all());
        for (pipeline, end) in [glossy, fine_trees, coarse_trees, matte].into_iter().zip(ends) {
            let first = next;
            next = self.picture_list.partition_point(|&(mesh, _)| mesh < end);
            pass.set_pipeline(pipeline);
            pass.set_bind_group(1, &self.group, &[]);
            for (number, (mesh, instances)) in self.picture_list.iter().enumerate().take(next).skip(first) {
                match phase {
                    Phase::Whole => self.meshes.draw(pass, *mesh, instances.clone()),
                    Phase::Known | Phase::New => self.occlusion.draw(pass, phase, number, instances.start),
                }
            }
        }
    }

    /// Draws the shadow casters of a cascade.
    pub(crate) fn draw_shadows(&self, pass: &mut wgpu::RenderPass<'_>, cascade: usize) {
        pass.set_pipeline(&self.shadow_pipelines[cascade]);
        pass.set_bind_group(1, &self.group, &[]);
        self.meshes.set(pass);
        pass.set_vertex_buffer(1, self.occlusion.all());
        for (mesh, instances) in &self.cascade_lists[cascade] {
            self.meshes.draw(pass, *mesh, instances.clone());
        }
    }
}

/// Vertices, and the indices of the instances.
const VERTEX_BUFFERS: [Option<wgpu::VertexBufferLayout<'static>>; 2] = [
    Some(wgpu::VertexBufferLayout {
        array_stride: size_of::<Vertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &VERTEX_ATTRIBUTES,
    }),
    Some(wgpu::VertexBufferLayout {
        array_stride: size_of::<u32>() as u64,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &wgpu::vertex_attr_array![4 => Uint32],
    }),
];

/// Whether a bounding sphere is in view and not behind hills.
fn is_seen(land: &LowestLand, from: &Viewpoint<'_>, bounds: &BoundingSphere) -> bool {
    let [low_m, high_m] = bounds.corners_m();
    from.frustum.sees_box(low_m, high_m) && !(from.options.culls && land.hides(from.eye_m, from.ground_m, [low_m, high_m]))
}

fn pipelines(factory: PassFactory, quality: Quality, layout: wgpu::BindGroupLayout, is_grown: bool) -> LampVariants<Pipelines> {
    let draw = DrawDescriptor { label: "objects", buffers: &VERTEX_BUFFERS, ..DrawDescriptor::default() };
    LampVariants::new(move |[lamps]| {
        let [glossy_module, matte_module] =
            [true, false].map(|gloss| factory.shader("objects", shaders::OBJECTS, &[lamps, ("is_glossy", gloss), ("is_grown", false)]));
        let [glossy, matte] = [&glossy_module, &matte_module].map(|module| factory.draw(module, Some(&layout), &draw));
        let per_vertex = DrawDescriptor { vertex: "vs_afar", fragment: Some("fs_afar"), ..draw };
        let is_per_vertex = quality.is_cheap(factory.gpu.is_software);
        let trees = [lamps, ("is_glossy", false), ("is_grown", true)];
        let trees_module = if is_grown { factory.shader("objects", shaders::OBJECTS, &trees) } else { matte_module };
        let fine_trees = if is_grown { factory.draw(&trees_module, Some(&layout), &draw) } else { matte.clone() };
        let coarse_trees = if is_per_vertex { factory.draw(&trees_module, Some(&layout), &per_vertex) } else { fine_trees.clone() };
        Pipelines { glossy, fine_trees, matte, coarse_trees }
    })
}

fn shadow_pipelines(factory: &PassFactory, module: &wgpu::ShaderModule, layout: &wgpu::BindGroupLayout) -> [wgpu::RenderPipeline; 2] {
    ["vs_shadow", "vs_shadow_far"].map(|vertex| {
        let shadow =
            DrawDescriptor { label: "shadows", vertex, fragment: Some("fs_shadow"), buffers: &VERTEX_BUFFERS, ..DrawDescriptor::default() };
        factory.draw(module, Some(layout), &shadow)
    })
}
