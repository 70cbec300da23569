//! Trees of components: bent as in the core, and the picture of their sway.

use super::*;
use crate::render::gpu::pipeline::storage;
use crate::render::solids::grown_trees::GrownTree;
use crate::render::solids::limb_passes::{TreeLimb, postures};
use crate::render::solids::trees_and_stones::{TREE_SHAPES, TreeDetail};
use prairie_core::plant::underbrush::plant::{Forces, LookUp, Posed, Stand, posed};
use prairie_core::plant::underbrush::section;
use prairie_core::scene::TreeShape;

const TREE_M: f32 = 7.0;
/// Pressure of the air along X and Z (Pa), heading of the tree (rad), and its height (m).
const CASES: [[f32; 4]; 4] = [[0.0, 0.0, 0.3, 7.0], [60.0, 20.0, 1.9, 7.0], [-150.0, 90.0, -2.0, 5.5], [20.0, -400.0, 0.0, 9.0]];

/// The components of a tree in a case, as the core bends them.
fn posed_in(tree: &GrownTree, [x, z, heading_rad, tall_m]: [f32; 4]) -> Vec<Posed> {
    let mut plan = tree.statics.plan.clone();
    for (number, component) in plan.components.iter_mut().enumerate() {
        // As in `swinging` at the time 0.
        component.drag_per_pa *= 0.75 + 0.25 * (2.4 * number as f32).sin();
    }
    let (sine, cosine) = heading_rad.sin_cos();
    let pressure_pa = Vec3::new(x * cosine - z * sine, 0.0, x * sine + z * cosine);
    let forces = Forces { per_mass_m_per_s2: Vec3::NEG_Y * prairie_core::GRAVITY_M_PER_S2 as f32, pressure_pa };
    let stand = Stand { size: tall_m / TREE_M, heading_rad: 0.0, lean_rad: [0.0; 2] };
    posed(&plan, &tree.statics.placed, stand, forces, LookUp::Interpolated, 0)
}

/// Positions of vertices in a tree one metre tall, in each case: `[right, along, across, number of the component]`. Those with `is_leaf` are blown as
/// leaves are, by a pressure of `[x, 0, z]` of the case in the frame of the tree.
fn followed(gpu: &Gpu, picture: &OffscreenRenderer, tree: &GrownTree, vertices: &[[f32; 4]], is_leaf: bool) -> Vec<[f32; 4]> {
    let count = tree.skeleton.limbs.len();
    let bend = format!(
        "@group(1) @binding(30) var<storage, read_write> bent_out: array<BentLimb>;
        @group(1) @binding(31) var<storage, read> tested: array<vec4<f32>>;
        @compute @workgroup_size(1) fn probe(@builtin(global_invocation_id) id: vec3<u32>) {{
            let own = tested[id.y];
            let turn = mat2x2<f32>(cos(own.z), -sin(own.z), sin(own.z), cos(own.z));
            bent_out[id.y * {count}u + id.x] = bent_in_tree(0u, id.x, own.xy, turn, own.w, 0.0);
        }}"
    );
    let follow = format!(
        "@group(1) @binding(30) var<storage, read_write> found: array<vec4<f32>>;
        @group(1) @binding(31) var<storage, read> tested: array<vec4<f32>>;
        @group(1) @binding(32) var<storage, read> local_places: array<vec4<f32>>;
        @compute @workgroup_size(1) fn probe(@builtin(global_invocation_id) id: vec3<u32>) {{
            let vertex = local_places[id.x];
            let row = id.y * {count}u + u32(vertex.w);
            let pressure = vec3<f32>(tested[id.y].x, 0.0, tested[id.y].y);
            let own = of_limb(row, vertex.xyz, vec3<f32>(0.0, 1.0, 0.0), {is_leaf}, pressure);
            found[id.y * arrayLength(&local_places) + id.x] = vec4<f32>(own.position, 0.0);
        }}"
    );
    let store = |contents: &[u8]| gpu.buffer("cases", contents, wgpu::BufferUsages::STORAGE);
    let room = |bytes: u64| gpu.empty_buffer("found", bytes, wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC);
    let cases = store(bytemuck::cast_slice(&CASES));
    let bent = room(BENT_LIMB_BYTES * (count * CASES.len()) as u64);
    let [limbs, table] = [store(bytemuck::cast_slice(&TreeLimb::of(tree))), store(bytemuck::cast_slice(&postures(tree)))];
    run(gpu, picture, &bend, &[(6, &limbs, false), (7, &table, false), (30, &bent, true), (31, &cases, false)], count);
    let found = room(16 * (vertices.len() * CASES.len()) as u64);
    let places = store(bytemuck::cast_slice(vertices));
    run(gpu, picture, &follow, &[(4, &bent, false), (30, &found, true), (31, &cases, false), (32, &places, false)], vertices.len());
    bytemuck::cast_slice(&read(gpu, &found)).to_vec()
}

/// Runs `probe` of a WGSL source for each case, `count` times, with buffers: binding, and whether it is written.
fn run(gpu: &Gpu, picture: &OffscreenRenderer, source: &str, buffers: &[(u32, &wgpu::Buffer, bool)], count: usize) {
    let frame_layout = picture.renderer.bindings.layout.clone();
    let pyramid = picture.renderer.bindings.pyramid.clone();
    let factory = PassFactory { gpu: gpu.clone(), frame_layout, pyramid, samples: 1, has_kinds: true, soft_shadows: true, has_snow: false };
    let entries: Vec<_> =
        buffers.iter().map(|&(binding, _, is_written)| if is_written { storage_rw(binding) } else { storage(binding) }).collect();
    let layout = factory.layout("limbs", &entries);
    let pipeline = factory.compute("limbs", &gpu.shader("limbs", linked("", source), &[]), "probe", &layout);
    let group = bind_at(gpu, "limbs", &layout, buffers.iter().map(|&(binding, buffer, _)| (binding, buffer.as_entire_binding())));
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &picture.renderer.scene.as_ref().expect("a scene").textures.group, &[]);
        pass.set_bind_group(1, &group, &[]);
        pass.dispatch_workgroups(count as u32, CASES.len() as u32, 1);
    }
    gpu.queue.submit([encoder.finish()]);
}

#[test]
fn trees_bend_as_in_the_core() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    picture.draw(&mut meadow(0.0), &Camera::default(), 0.0, 0.0);
    for shape in [0, TREE_SHAPES - 1] {
        let tree = GrownTree::new(shape, TREE_M, 0.0);
        let mesh = tree.mesh(TreeDetail::Fine);
        let solid = mesh.vertices.iter().filter(|vertex| vertex.leaf == [0; 2]);
        let vertices: Vec<[f32; 4]> =
            solid.map(|vertex| [vertex.position[0], vertex.position[1], vertex.position[2], f32::from(vertex.normal[3])]).collect();
        let found = followed(&gpu, &picture, &tree, &vertices, false);
        let mut moved = 0.0_f32;
        for (case, found) in CASES.iter().zip(found.chunks(vertices.len())) {
            let (posed, calm) = (posed_in(&tree, *case), posed_in(&tree, [0.0, 0.0, 0.0, case[3]]));
            for (vertex, found) in vertices.iter().zip(found) {
                let [wanted, calm] =
                    [&posed, &calm].map(|all| tree.statics.followed_m(&all[vertex[3] as usize], Vec3::from_slice(&vertex[..3])) / case[3]);
                let off = Vec3::from_slice(&found[..3]).distance(wanted);
                assert!(off < 1e-3, "{off} of the height at {vertex:?} of shape {shape} in {case:?}");
                moved = moved.max(wanted.distance(calm));
            }
        }
        // Negative control: without wind the components are elsewhere.
        assert!(moved > 0.02, "{moved}");
    }
}

#[test]
fn leaves_turn_from_the_wind_as_sections_do() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    picture.draw(&mut meadow(0.0), &Camera::default(), 0.0, 0.0);
    let tree = GrownTree::new(0, TREE_M, 0.0);
    let around = |n: usize| (std::f32::consts::TAU * n as f32 / 12.0).sin_cos();
    let vertices: Vec<[f32; 4]> = (0..12).map(|n| [0.1 * around(n).0, 0.05, 0.1 * around(n).1, 3.0]).collect();
    let on_axis: Vec<[f32; 4]> = vertices.iter().map(|at| [0.0, at[1], 0.0, at[3]]).collect();
    let [still, blown, feet] =
        [(&vertices, false), (&vertices, true), (&on_axis, false)].map(|(at, is_leaf)| followed(&gpu, &picture, &tree, at, is_leaf));
    let mut most_rad = 0.0_f64;
    for (number, ((still, blown), foot)) in still.iter().zip(&blown).zip(&feet).enumerate() {
        let [still, blown] = [still, blown].map(|at| (Vec3::from_slice(&at[..3]) - Vec3::from_slice(&foot[..3])).as_dvec3());
        let [x, z, ..] = CASES[number / vertices.len()].map(f64::from);
        let load = glam::DVec3::new(x, 0.0, z);
        assert!((still.length() - blown.length()).abs() < 1e-4);
        let unbent_rad = if load.length() > 0.0 { (-load).angle_between(still) } else { 0.0 };
        let stiffness = f64::from(crate::render::gpu::constants::LEAF_STIFFNESS_PA) / load.length();
        let wanted_rad = if load.length() > 0.0 { section::bend_rad(unbent_rad, stiffness) } else { 0.0 };
        let found_rad = still.angle_between(blown);
        assert!((found_rad - wanted_rad).abs() < 3e-3, "{found_rad} instead of {wanted_rad} rad");
        most_rad = most_rad.max(found_rad);
    }
    assert!(most_rad > 0.2, "{most_rad}");
}

/// Fraction of the pixels that are leaves or wood against the sky at one of two times only.
fn silhouette_change(gpu: &Gpu, tree_shape: TreeShape, wind_m_per_s: f32) -> f64 {
    let mut covering = [255; 16 * 16];
    covering[8 + 16 * 8] = 253;
    let change = |scene: &mut Scene| {
        (scene.wind.mean_m_per_s, scene.plants.tree_shape, scene.plants.height_m) = ([wind_m_per_s, 0.0], tree_shape, 0.1);
    };
    let mut mirror = meadow_of(change, &covering);
    let mut picture = OffscreenRenderer::new(gpu, [96, 96], Quality::Low);
    let camera = Camera { eye_m: Vec3::new(34.0, 1.0, 44.0), pitch_rad: 0.35, ..Camera::default() };
    let [before, after] = [1.0, 1.4].map(|time_secs| {
        picture.draw(&mut mirror, &camera, time_secs, 0.0);
        let is_dark = |rgba: &[u8]| u32::from(rgba[2]) < 110;
        picture.rgba().chunks(4).take(96 * 70).map(is_dark).collect::<Vec<bool>>()
    });
    let leaves = before.iter().filter(|is_dark| **is_dark).count();
    assert!((300..6000).contains(&leaves), "{leaves} pixels of leaves");
    before.iter().zip(&after).filter(|(before, after)| before != after).count() as f64 / leaves as f64
}

#[test]
fn the_picture_of_a_tree_of_components_sways_in_the_wind() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let [calm, windy] = [0.0, 10.0].map(|wind_m_per_s| silhouette_change(&gpu, TreeShape::Grown, wind_m_per_s));
    println!("{calm} of the silhouette changes without wind, {windy} at 10 m/s");
    assert!(calm < 0.002 && windy > 0.01, "{calm} and {windy}");
}
