use super::bake::{Baked, LEVELS, VARIANTS};
use super::layout::LISTS;
use super::*;
use crate::camera::Camera;
use crate::render::gpu::pipeline::{storage, storage_rw, uniform};
use crate::render::gpu::readback::read;
use crate::render::gpu::shaders::tests::linked;
use crate::render::gpu::uniforms::BrushList;
use crate::render::offscreen::OffscreenRenderer;
use crate::render::options::quality::Quality;
use crate::render::tests::{meadow_of, probe};
use crate::state::{DecodedScene, Mirror};
use bytemuck::Zeroable;
use glam::Vec3;
use prairie_core::hash::{hash3, unit};
use prairie_core::plant::underbrush::plan::Plan;
use prairie_core::plant::underbrush::plant::{LookUp, Posed, Stand, posed};
use prairie_core::plant::underbrush::posture::Nodes;
use prairie_core::scene::{Component, ComponentKind, Scene, Underbrush as Species, VehicleKind, parse_underbrush};
use prairie_core::wire::quantise::{heading_code, heading_rad};
use prairie_core::wire::{BrokenPlant, ObjectPose, ServerMessage};
use std::collections::HashMap;
use wgpu::BufferUsages;

mod close_up;
mod drawn;

const SPECIES: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../server/scenes/species.toml"));
/// The root of plants in a world without ground.
const ROOT_M: Vec3 = Vec3::new(32.0, 0.0, 32.0);

fn species() -> Vec<Species> {
    parse_underbrush(SPECIES).expect("sound species")
}

/// Three random numbers in 0..1.
fn random(n: u32, number: u32) -> [f32; 3] {
    hash3([n, number, 31]).map(unit)
}

/// Body of a probe that returns centre and radius of an interaction sphere (m).
const SPHERE: &str = "let sphere = frame.spheres[u32(at.x)]; return vec4<f32>(sphere.centre_m, sphere.radius_m);";

/// A picture of a meadow with monsters, and its interaction spheres.
fn meadow(gpu: &Gpu, monsters_m: &[[f32; 3]]) -> (OffscreenRenderer, Vec<[f32; 4]>) {
    let mut mirror = meadow_of(|_| (), &[255; 16 * 16]);
    show(&mut mirror, monsters_m);
    let mut picture = OffscreenRenderer::new(gpu, [16, 16], Quality::Low);
    picture.draw(&mut mirror, &Camera { eye_m: ROOT_M + Vec3::Y, ..Camera::default() }, 0.0, 0.0);
    let numbers: Vec<_> = (0..monsters_m.len()).map(|i| [i as f32, 0.0, 0.0, 0.0]).collect();
    let spheres = if numbers.is_empty() { Vec::new() } else { probe(gpu, &picture, SPHERE, &numbers) };
    (picture, spheres)
}

fn show(mirror: &mut Mirror, monsters_m: &[[f32; 3]]) {
    let pose = |(id, &position_m): (usize, &[f32; 3])| ObjectPose {
        id: id as u32,
        kind: VehicleKind::Monster,
        position_m,
        rotation: [0.0, 0.0, 0.0, 1.0],
        velocity_m_per_s: [0.0; 3],
        part_rad: 0.0,
    };
    let objects = monsters_m.iter().enumerate().map(pose).collect();
    mirror.apply(ServerMessage::Poses { tick: 1, objects }).expect("sound poses");
}

/// A plant as in `visible_plant.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct VisiblePlant {
    root_m: [f32; 3],
    shown_size: f32,
    lean_rad: [f32; 2],
    sunlight: f32,
    heading_rad: f32,
    pressure_pa: [f32; 2],
    variant_and_kind: u32,
    spheres: u32,
    height_m: f32,
    hue: f32,
    distance_m: f32,
    size: f32,
    grass_rgb: [f32; 3],
    grass_fraction: f32,
    tint: [f32; 3],
    list: u32,
    normal: [f32; 3],
    first_block: u32,
    air: [f32; 4],
}

/// Input of the ribbon pass: a plant as the previous compute pass leaves it.
#[derive(Clone, Copy, Debug)]
struct Case {
    root_m: Vec3,
    stand: Stand,
    pressure_pa: [f32; 2],
    variant: u32,
    spheres: u32,
}

impl Case {
    /// One of many plants, in winds of up to 11 m/s.
    fn new(n: u32) -> Self {
        let ([heading, size, wind], [towards, x, z]) = (random(n, 1), random(n, 2));
        let speed_m_per_s = 11.0 * wind;
        let (sine, cosine) = (std::f32::consts::TAU * towards).sin_cos();
        let pressure_pa = [cosine, sine].map(|fraction| fraction * 0.6 * speed_m_per_s * speed_m_per_s);
        let lean_rad = if n.is_multiple_of(2) { [0.0; 2] } else { [x - 0.5, z - 0.5] };
        let stand = Stand { size: 0.4 + 0.95 * size, heading_rad: std::f32::consts::TAU * heading, lean_rad };
        Self { root_m: ROOT_M, stand, pressure_pa, variant: n % (2 * VARIANTS), spheres: 0 }
    }

    fn visible(&self) -> VisiblePlant {
        let Stand { size, heading_rad, lean_rad } = self.stand;
        VisiblePlant {
            root_m: self.root_m.to_array(),
            shown_size: size,
            lean_rad,
            sunlight: 1.0,
            heading_rad,
            pressure_pa: self.pressure_pa,
            variant_and_kind: self.variant,
            spheres: self.spheres,
            height_m: 1.0,
            distance_m: 1.0,
            size,
            tint: [1.0; 3],
            normal: [0.0, 1.0, 0.0],
            air: [0.0, 0.0, 0.0, 1.0],
            ..VisiblePlant::zeroed()
        }
    }

    fn posed(&self, plan: &Plan, look_up: LookUp) -> Vec<Posed> {
        let [x, z] = self.pressure_pa;
        let forces = prairie_core::plant::underbrush::plant::Forces {
            per_mass_m_per_s2: Vec3::Y * -prairie_core::GRAVITY_M_PER_S2 as f32,
            pressure_pa: Vec3::new(x, 0.0, z),
        };
        let broken = if self.variant < VARIANTS { 0 } else { u64::MAX };
        posed(plan, &plan.placed(self.variant % VARIANTS), self.stand, forces, look_up, broken)
    }
}

/// A row bent by the GPU: position from the root (m), direction and side.
type Found = [[f32; 4]; 3];

/// Bends plants as `ribbons` does.
struct Bender {
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::ComputePipeline,
}

impl Bender {
    fn new(gpu: &Gpu, picture: &OffscreenRenderer) -> Self {
        const SOURCE: &str = "
            @group(1) @binding(30) var<storage, read_write> found: array<vec4<f32>>;
            @compute @workgroup_size(1) fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
                let plant = visible_plants[id.y];
                let list = lists.list[0];
                let bent = bent_row(plant, row_of(plant, id.x, list), vec3<f32>(0.0, 1.0, 0.0), list);
                let at = (id.y * list.rows + id.x) * 3u;
                found[at] = vec4<f32>(bent.at, 0.0);
                found[at + 1u] = vec4<f32>(bent.along, 0.0);
                found[at + 2u] = vec4<f32>(bent.side, 0.0);
            }";
        let factory = PassFactory {
            gpu: gpu.clone(),
            frame_layout: picture.renderer.bindings.layout.clone(),
            pyramid: picture.renderer.bindings.pyramid.clone(),
            samples: 1,
            has_kinds: true,
            soft_shadows: true,
            has_snow: false,
        };
        let layout = factory.layout("bender", &[storage(10), storage(13), storage(14), uniform(15), storage(16), storage_rw(30)]);
        let module = factory.shader("bender", linked("plants/ribbons", SOURCE), &[]);
        Self { pipeline: factory.compute("bender", &module, "probe", &layout), layout }
    }

    /// All rows of plants, case by case.
    fn rows(&self, gpu: &Gpu, picture: &OffscreenRenderer, plan: &Plan, baked: &Baked, level: usize, cases: &[Case]) -> Vec<Found> {
        let rows = baked.ribbons.iter().sum::<u32>();
        let nodes = plan.tables[0].nodes();
        let mut lists = [BrushList::zeroed(); LISTS];
        lists[0] = BrushList {
            rows,
            instance_plants: 1,
            limbs: baked.limb_count(),
            is_nearest: u32::from(level + 1 == LEVELS),
            nodes: [nodes.angles as u32, nodes.loads as u32],
            ..BrushList::zeroed()
        };
        let visible: Vec<_> = cases.iter().map(Case::visible).collect();
        let storage = |contents: &[u8]| gpu.buffer("cases", contents, BufferUsages::STORAGE);
        let found = gpu.empty_buffer("found", 48 * u64::from(rows) * cases.len() as u64, BufferUsages::STORAGE | BufferUsages::COPY_SRC);
        let buffers = [
            (10, &storage(bytemuck::cast_slice(&visible))),
            (13, &storage(bytemuck::cast_slice(&baked.steps))),
            (14, &storage(bytemuck::cast_slice(&baked.rows))),
            (15, &gpu.buffer("lists", bytemuck::cast_slice(&lists), BufferUsages::UNIFORM)),
            (16, &storage(bytemuck::cast_slice(&baked.limbs))),
            (30, &found),
        ];
        let entries = buffers.map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() });
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout: &self.layout, entries: &entries });
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, &picture.renderer.scene.as_ref().expect("a scene").textures.group, &[]);
            pass.set_bind_group(1, &group, &[]);
            pass.dispatch_workgroups(rows, cases.len() as u32, 1);
        }
        gpu.queue.submit([encoder.finish()]);
        bytemuck::cast_slice(&read(gpu, &found)).to_vec()
    }
}

/// Rows of a plant's components without petals: the index of each component and its rows, foot first.
fn axes<'a>(baked: &Baked, rows: &'a [Found]) -> Vec<(usize, &'a [Found])> {
    let mut first = 0;
    let ribbons = baked.ribbons.iter().map(|&count| {
        first += count as usize;
        first - count as usize..first
    });
    ribbons.filter(|ribbon| !baked.rows[ribbon.start].is_petal()).map(|ribbon| (baked.rows[ribbon.start].limb(), &rows[ribbon])).collect()
}

fn place(found: &Found) -> Vec3 {
    Vec3::from_slice(&found[0])
}

/// Root mean square and maximum of errors.
fn size(errors: &[f32]) -> [f32; 2] {
    [(errors.iter().map(|e| e * e).sum::<f32>() / errors.len() as f32).sqrt(), errors.iter().copied().fold(0.0, f32::max)]
}

/// Errors of the tips of a plant's components, relative to their lengths.
fn tips_off<'a>(plan: &'a Plan, axes: &'a [(usize, &'a [Found])], wanted: &'a [Posed]) -> impl Iterator<Item = f32> + 'a {
    axes.iter().map(|&(limb, rows)| {
        let one = &wanted[limb];
        let tip_m = one.sections()[one.sections().len() - 1].end_m;
        place(&rows[rows.len() - 1]).distance(tip_m) / (plan.components[one.planned].component.length_m * one.size)
    })
}

#[test]
fn plants_bend_as_in_the_core_and_keep_their_lengths() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let (picture, _) = meadow(&gpu, &[]);
    let bender = Bender::new(&gpu, &picture);
    let cases: Vec<Case> = (0..160).map(Case::new).collect();
    let mut all_balanced = Vec::new();
    for species in species() {
        let plan = Plan::new(&species, Nodes::default());
        // Enough nodes to be practically exact.
        let balance = Plan::new(&species, Nodes { angles: 129, loads: 129 });
        let baked = Baked::new(&plan, 0);
        let rows = baked.ribbons.iter().sum::<u32>() as usize;
        let found = bender.rows(&gpu, &picture, &plan, &baked, 0, &cases);
        let (mut tips, mut balanced) = (Vec::new(), Vec::new());
        for (case, found) in cases.iter().zip(found.chunks_exact(rows)) {
            let (axes, wanted) = (axes(&baked, found), case.posed(&plan, LookUp::Interpolated));
            tips.extend(tips_off(&plan, &axes, &wanted));
            if case.variant < VARIANTS {
                balanced.extend(tips_off(&plan, &axes, &case.posed(&balance, LookUp::Interpolated)));
            }
            for (limb, rows) in axes {
                let one = &wanted[limb];
                let section_m = plan.components[one.planned].component.length_m * one.size / one.sections().len() as f32;
                for (pair, section) in rows.windows(2).zip(one.sections()) {
                    let step_m = place(&pair[0]).distance(place(&pair[1]));
                    assert!((step_m / section_m - 1.0).abs() < 1e-5, "{step_m} instead of {section_m} m of {}", species.name);
                    let side = Vec3::from_slice(&pair[1][2]);
                    assert!(side.distance(section.side) < 2e-3, "{side} instead of {}", section.side);
                }
            }
        }
        let [[rms, worst], [rms_balanced, worst_balanced]] = [size(&tips), size(&balanced)];
        assert!(rms < 2e-4 && worst < 5e-3, "{rms} and {worst} off the tables: {}", species.name);
        assert!(rms_balanced < 0.0025 && worst_balanced < 0.08, "{rms_balanced} and {worst_balanced} off balance: {}", species.name);
        all_balanced.extend(balanced);
    }
    all_balanced.sort_by(f32::total_cmp);
    assert!(all_balanced[all_balanced.len() * 99 / 100] < 0.005);
}

#[test]
fn coarse_levels_bend_like_the_finest() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let (picture, _) = meadow(&gpu, &[]);
    let bender = Bender::new(&gpu, &picture);
    let cases: Vec<Case> = (0..80).map(|n| Case { variant: n % VARIANTS, ..Case::new(n) }).collect();
    let mut off: [Vec<f32>; LEVELS] = Default::default();
    for species in species() {
        let plan = Plan::new(&species, Nodes::default());
        for (level, off) in off.iter_mut().enumerate().skip(1) {
            let baked = Baked::new(&plan, level);
            let rows = baked.ribbons.iter().sum::<u32>() as usize;
            let found = bender.rows(&gpu, &picture, &plan, &baked, level, &cases);
            for (case, found) in cases.iter().zip(found.chunks_exact(rows)) {
                let wanted = case.posed(&plan, LookUp::Interpolated);
                let tip_m = |one: &Posed| one.sections()[one.sections().len() - 1].end_m;
                let reach_m = flora::reach_m(&species) * case.stand.size;
                off.extend(
                    axes(&baked, found).iter().map(|&(limb, rows)| place(&rows[rows.len() - 1]).distance(tip_m(&wanted[limb])) / reach_m),
                );
            }
        }
    }
    for (level, (rms, worst)) in [(0.002, 0.04), (0.006, 0.08), (0.02, 0.15)].into_iter().enumerate() {
        let found = size(&off[level + 1]);
        assert!(found[0] < rms && found[1] < worst, "{found:?} at level {}", level + 1);
    }
}

/// Depth in a sphere (m) and length (m) of the axis of a plant's component, for the one that is deepest relative to its length.
fn deepest_m(case: &Case, axes: &[(usize, &[Found])], sphere: [f32; 4]) -> [f32; 2] {
    let centre_m = Vec3::from_slice(&sphere) - case.root_m;
    let of_axis = |rows: &[Found]| {
        let points: Vec<Vec3> = rows.iter().map(place).collect();
        let along = points.windows(2).flat_map(|pair| (0..=16).map(move |step| pair[0].lerp(pair[1], step as f32 / 16.0)));
        let length_m: f32 = points.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        [along.map(|point| sphere[3] - point.distance(centre_m)).fold(f32::NEG_INFINITY, f32::max), length_m]
    };
    axes.iter()
        .map(|&(_, rows)| of_axis(rows))
        .fold([f32::NEG_INFINITY, 1.0], |most, one| if one[0] / one[1] > most[0] / most[1] { one } else { most })
}

#[test]
fn plants_are_tangent_to_touching_spheres() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let (picture, spheres) = meadow(&gpu, &[[31.0, 1.0, 32.0], [34.2, 1.2, 32.3]]);
    let bender = Bender::new(&gpu, &picture);
    let mut touching = 0;
    for species in species() {
        let plan = Plan::new(&species, Nodes::default());
        let cases: Vec<Case> = (0..160)
            .map(|n| {
                let [x, z, y] = random(n, 3);
                let root_m = Vec3::new(29.5 + 6.5 * x, 0.1 * y, 30.0 + 4.0 * z);
                Case { root_m, spheres: 3, variant: n % VARIANTS, ..Case::new(n) }
            })
            .collect();
        for level in 0..LEVELS {
            let baked = Baked::new(&plan, level);
            let rows = baked.ribbons.iter().sum::<u32>() as usize;
            let found = bender.rows(&gpu, &picture, &plan, &baked, level, &cases);
            let untouched: Vec<Case> = cases.iter().map(|case| Case { spheres: 0, ..*case }).collect();
            let free = bender.rows(&gpu, &picture, &plan, &baked, level, &untouched);
            for ((case, found), free) in cases.iter().zip(found.chunks_exact(rows)).zip(free.chunks_exact(rows)) {
                let beside = spheres.iter().filter(|s| case.root_m.distance(Vec3::from_slice(&s[..3])) > s[3]);
                if beside.clone().count() < spheres.len() {
                    continue;
                }
                touching += usize::from(found != free);
                for sphere in beside {
                    let [depth_m, length_m] = deepest_m(case, &axes(&baked, found), *sphere);
                    assert!(depth_m < 0.01 * length_m, "{depth_m} m of {length_m} m of {} at level {level}: {case:?}", species.name);
                }
            }
        }
    }
    assert!(touching > 500, "only {touching} plants touch a sphere");
}

#[test]
fn plants_inside_a_sphere_lean_away_from_its_centre() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let (picture, spheres) = meadow(&gpu, &[[32.0, 1.0, 32.0]]);
    let [x, y, z, radius_m] = spheres[0];
    let centre_m = Vec3::new(x, y, z);
    let bender = Bender::new(&gpu, &picture);
    let stalk = Component {
        angle_rad: 0.0,
        angle_variation_rad: 0.0,
        length_m: 1.0,
        sections: 8,
        stiffness_n_m2: 10.0,
        ..Component::new("stalk", ComponentKind::Branch)
    };
    let plan = Plan::new(&Species::new("stalk", vec![stalk]), Nodes::default());
    let calm = Stand { size: 1.0, heading_rad: 1.0, lean_rad: [0.0; 2] };
    // From its very centre outwards.
    let cases: Vec<Case> = (0..=60)
        .map(|step| {
            let root_m = Vec3::new(x + 0.02 * radius_m * step as f32, 0.0, z);
            Case { root_m, stand: calm, pressure_pa: [0.0; 2], variant: 0, spheres: 1 }
        })
        .collect();
    for level in 0..LEVELS {
        let baked = Baked::new(&plan, level);
        let rows = baked.ribbons.iter().sum::<u32>() as usize;
        let found = bender.rows(&gpu, &picture, &plan, &baked, level, &cases);
        let mut before_rad = f32::INFINITY;
        for (case, found) in cases.iter().zip(found.chunks_exact(rows)) {
            let tip_m = place(&found[rows - 1]);
            assert!(tip_m.is_finite() && tip_m.y > -1e-5, "{tip_m} at {case:?}");
            let apart_m = |at_m: Vec3| at_m.distance(centre_m);
            assert!(apart_m(case.root_m + tip_m) > apart_m(case.root_m), "{tip_m} at {case:?}");
            let lean_rad = tip_m.angle_between(Vec3::Y);
            assert!(lean_rad < before_rad + 1e-3, "{lean_rad} after {before_rad} rad at {case:?}");
            before_rad = lean_rad;
        }
    }
}

#[test]
fn the_compute_pass_computes_each_posture_and_lists_each_plant_once() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let covering: Vec<u8> = (0..256).map(|at| if at % 16 < 8 { 20 } else { 21 }).collect();
    let mut mirror = meadow_of(
        |scene: &mut Scene| {
            scene.wind.mean_m_per_s = [4.0, 3.0];
            scene.growth.richness = [1.0; 3];
            scene.underbrush = species().into_iter().filter(|species| species.cover > 0).collect();
        },
        &covering,
    );
    show(&mut mirror, &[[32.0, 1.0, 56.0]]);
    let sites: Vec<u32> =
        mirror.decoded_scene().and_then(DecodedScene::flora).expect("plants").grown().plants().iter().map(|plant| plant.site).collect();
    let mut broken: Vec<u32> = sites.into_iter().filter(|site| site % 3 == 0).collect();
    broken.sort_unstable();
    let fall = heading_code([0.0, 1.0]);
    let broken = broken.into_iter().map(|site| BrokenPlant { site, fall }).collect();
    mirror.apply(ServerMessage::Broken { plants: broken }).expect("sound sites");
    let camera = Camera { eye_m: Vec3::new(32.0, 1.2, 60.0), ..Camera::default() };
    let size_px = [640, 1280];
    let mut picture = OffscreenRenderer::new(&gpu, size_px, Quality::Low);
    picture.draw(&mut mirror, &camera, 3.0, 0.0);

    let scene = picture.renderer.scene.as_ref().expect("a scene");
    let brush = scene.underbrush.as_ref().expect("underbrush");
    let words = |buffer: &wgpu::Buffer| bytemuck::cast_slice::<u8, u32>(&read(&gpu, buffer)).to_vec();
    let (visible, listed, counters) = (read(&gpu, &brush.seen.visible_plants), words(&brush.seen.listed), words(brush.counters()));
    let owners = words(&brush.seen.owners);
    let draws = words(&brush.draws);
    let visible: &[VisiblePlant] = bytemuck::cast_slice(&visible);

    let decoded = mirror.decoded_scene().expect("a scene");
    let flora = decoded.flora().expect("plants");
    let place = |at_m: [f32; 2]| at_m.map(f32::to_bits);
    let plants: HashMap<_, _> = flora.grown().plants().iter().map(|plant| (place(flora.instance(plant).at_m), plant)).collect();
    let projection = camera.projection_from_world(size_px[0] as f32 / size_px[1] as f32);
    let px_rad = camera.fov_rad / size_px[1] as f32;
    let spheres = probe(&gpu, &picture, SPHERE, &[[0.0; 4]]);
    let (mut seen, mut touched, mut feeling) = (HashMap::new(), 0, Vec::new());
    for (number, level) in (0..flora.species().len()).flat_map(|number| (0..LEVELS).map(move |level| (number, level))) {
        let count = counters[number * LEVELS + level];
        let BrushList { rows, instance_plants: held, first_listed: places, .. } = brush.seen.lists[number * LEVELS + level];
        let instances = draws[(number * LEVELS + level) * DRAW_WORDS + 1];
        assert_eq!(instances, count.div_ceil(held), "instances of list {number}, {level}");
        for &block in &listed[places as usize..(places + count) as usize] {
            // Its rows have their own blocks.
            let own_blocks = &owners[block as usize..(block + rows.div_ceil(BLOCK)) as usize];
            assert!(own_blocks.iter().all(|owner| *owner == own_blocks[0]), "{own_blocks:?}");
            let found = visible[own_blocks[0] as usize];
            assert_eq!([found.list as usize, found.first_block as usize], [number * LEVELS + level, block as usize]);
            let [x, y, z] = found.root_m;
            let at_m = [x, z];
            let plant = plants[&place(at_m)];
            assert!(seen.insert(plant.site, level).is_none(), "{plant:?} is listed twice");
            let (instance, own): (_, &Species) = (flora.instance(plant), &flora.species()[number]);
            assert_eq!(instance.species, number);
            // Its level of detail matches its height in pixels.
            let (height_m, reach_m): (f32, f32) = (height_m(own) * instance.size, flora::reach_m(own) * instance.size);
            let tall_m = height_m.max(0.5 * reach_m);
            let distance_m = Vec3::new(x, y + 0.5 * tall_m, z).distance(camera.eye_m);
            let tall_px = tall_m / (distance_m * px_rad);
            let lot = unit(hash3([plant.site, 5, 91])[0]);
            let fine_px = tall_px / (Quality::detail_at(0.0).coarser * (0.85 + 0.3 * lot));
            let is_at = |px: &[f32]| px.iter().filter(|&&least| fine_px <= least).count();
            let least_px = [300.0, 90.0, 26.0];
            assert!(
                least_px.iter().any(|px| (fine_px / px - 1.0).abs() < 1e-3) || is_at(&least_px) == level,
                "{fine_px} px at level {level}"
            );
            assert!((found.height_m / height_m - 1.0).abs() < 1e-4 && (found.distance_m / distance_m - 1.0).abs() < 1e-4, "{found:?}");
            assert_eq!((found.size, found.heading_rad, found.lean_rad), (instance.size, instance.heading_rad, [0.0; 2]), "{found:?}");
            // Its size, if it is taller than 16 px.
            let fades = ((1.0 - lot) / 0.2).min(1.0);
            if tall_px > 16.0 && distance_m < 0.79 * 45.0 {
                assert!((found.shown_size / (instance.size * fades) - 1.0).abs() < 1e-3, "{found:?} of {instance:?}");
            }
            // Its variant, and whether it is broken.
            let variant = instance.number % VARIANTS + if plant.site % 3 == 0 { VARIANTS } else { 0 };
            assert_eq!(found.variant_and_kind, variant, "{plant:?}");
            let apart_m = Vec3::from(found.root_m).distance(Vec3::from_slice(&spheres[0]));
            let reaches_m = spheres[0][3] + reach_m * found.shown_size / instance.size;
            if (apart_m / reaches_m - 1.0).abs() > 1e-3 {
                assert_eq!(found.spheres, u32::from(apart_m < reaches_m), "{plant:?}");
            }
            touched += u32::from(found.spheres != 0);
            // In front of the object and in its lee the wind is weaker.
            let [aside_m, beyond_m] = [at_m[0] - 32.0, at_m[1] - 56.0];
            if 0.8 * aside_m + 0.6 * beyond_m > -8.0 && (0.8 * beyond_m - 0.6 * aside_m).abs() < 8.0 {
                continue;
            }
            let wind = scene.textures.wind.resolved_at(decoded, [at_m[0], 0.5 * height_m, at_m[1]]);
            let still: f32 = (0.25 * height_m).clamp(0.02, 1.0).sqrt();
            feeling.push(([at_m[0], 0.0, at_m[1], still], [wind[0], wind[2]], plant.site % 3 == 0, found.pressure_pa));
        }
    }
    // Expected pressure: the dynamic pressure of wind and gust at half its height; for a broken plant less of it, plus that of its fall.
    let places: Vec<_> = feeling.iter().map(|&(at, ..)| at).collect();
    let gusts = probe(&gpu, &picture, "return vec4<f32>(gust_at(at.xz), 0.0, 0.0);", &places);
    for ((at, wind, is_broken, found_pa), [gust_u, gust_w, ..]) in feeling.iter().zip(gusts) {
        let blown = [wind[0] + gust_u, wind[1] + gust_w];
        let [east_pa, south_pa] = blown.map(|speed| 0.6 * speed * blown[0].hypot(blown[1]) * at[3]);
        let fall = heading_rad(fall);
        let wanted_pa =
            if *is_broken { [0.45 * east_pa + 8.0 * fall.cos(), 0.45 * south_pa + 8.0 * fall.sin()] } else { [east_pa, south_pa] };
        assert!(
            (0..2).all(|i| (wanted_pa[i] - found_pa[i]).abs() < 0.01 * wanted_pa[i].abs()),
            "{found_pa:?} instead of {wanted_pa:?} at {at:?}"
        );
    }
    let levels: Vec<usize> = (0..LEVELS).map(|level| seen.values().filter(|&&own| own == level).count()).collect();
    assert!(levels.iter().all(|&count| count > 20) && touched > 20, "{levels:?} at the levels, {touched} touched");
    // All plants whose root is in the picture are listed, except for the few that thin out, and none behind the camera.
    for plant in flora.grown().plants() {
        let instance = flora.instance(plant);
        let (own, [x, z]) = (&flora.species()[instance.species], instance.at_m);
        let clip = projection * Vec3::new(x, decoded.heights().height_m(x, z), z).extend(1.0);
        let is_within = clip.w > 0.2 && clip.x.abs() < clip.w && clip.y.abs() < clip.w;
        let lot = unit(hash3([plant.site, 5, 91])[0]);
        // Of plants less than 16 px tall, only the fraction height / 16 px is listed.
        let tall_m = height_m(own).max(0.5 * flora::reach_m(own)) * instance.size;
        let kept = (tall_m / (clip.w * px_rad) / 16.0).min(1.0);
        if is_within && clip.w < 34.0 && lot < 0.75 * kept {
            assert!(seen.contains_key(&plant.site), "{plant:?} is not listed");
        }
        assert!(clip.w > -4.0 || !seen.contains_key(&plant.site), "{plant:?} is behind the camera");
    }
}

#[test]
fn rain_changes_the_picture() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = meadow_of(|scene| scene.rain.rate_mm_per_h = 30.0, &[255; 16 * 16]);
    let camera = Camera { eye_m: Vec3::new(32.0, 1.8, 50.0), ..Camera::default() };
    let mut picture = OffscreenRenderer::new(&gpu, [160, 90], Quality::Low);
    let mut drawn = |picture: &mut OffscreenRenderer| {
        picture.draw(&mut mirror, &camera, 2.0, 0.0);
        picture.rgba()
    };
    let wet = [drawn(&mut picture), drawn(&mut picture)];
    picture.renderer.scene.as_mut().and_then(|scene| scene.rain.take()).expect("it rains");
    let dry = drawn(&mut picture);
    let changed = |other: &[u8]| wet[0].chunks_exact(4).zip(other.chunks_exact(4)).filter(|(a, b)| a != b).count();
    assert_eq!(changed(&wet[1]), 0, "the same frame once more");
    assert!(changed(&dry) > 160 * 90 / 100, "{} pixels are of rain", changed(&dry));
}
