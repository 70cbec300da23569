//! Occlusion culling leaves out nothing visible.

use super::models::red_box;
use super::*;
use crate::render::inputs::depth_pyramid::DepthPyramid;
use crate::render::options::render_options::Occlusion;
use prairie_core::scene::CoverModel;
use prairie_core::wire::{ModelUse, ObjectPose};

const SIZE_PX: [u32; 2] = [96, 54];
/// Side of the land (m).
const SIDE_M: f32 = 64.0;
/// IDs of the covering map.
const TREE: u8 = 253;
const STONE: u8 = 254;
const HOUSE: u8 = 9;
const GRASS: u8 = 255;

/// Hills of up to 8 m with a wood, stones, houses and vehicles, in calm air.
fn village() -> Mirror {
    let heights: Vec<u8> = (0..17 * 17)
        .map(|at| {
            let [x, z] = [(at % 17) as f32, (at / 17) as f32];
            (40.0 * (1.0 + (0.7 * x).sin() * (0.55 * z + 0.4).cos())) as u8
        })
        .collect();
    let covering: Vec<u8> = (0..16 * 16_u32)
        .map(|at| match (hash3([at, 5, 7]).map(unit)[0], at % 16) {
            (random, 8..) if random < 0.35 => TREE,
            (random, _) if random < 0.06 => STONE,
            (random, _) if random < 0.2 => HOUSE,
            (random, _) if random < 0.25 => TREE,
            _ => GRASS,
        })
        .collect();
    let maps = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [4.0; 2], level_m: 0.1, base_m: 0.0 };
    let mut scene = Scene { patches: Patches { count: [4, 4], ..Patches::default() }, ..Scene::new(maps) };
    (scene.wind.mean_m_per_s, scene.plants.stone_m, scene.plants.tree_m) = ([0.0; 2], 2.5, 6.0);
    (scene.plants.plants_per_side, scene.plants.height_m) = (20, 0.4);
    scene.models = vec![CoverModel { size_m: [12.0, 8.0, 8.0], ..CoverModel::new("house", HOUSE, "") }];
    let scene = ServerMessage::Scene {
        scene: Box::new(scene),
        height_png: grey_png([17; 2], &heights),
        covering_png: grey_png([16; 2], &covering),
        nutrient_png: Vec::new(),
        models: vec![(ModelUse::Cover(0), red_box())],
        shapes: Default::default(),
    };
    let mut mirror = Mirror::default();
    mirror.apply(scene).expect("a sound scene");
    let kinds = [VehicleKind::Car, VehicleKind::Monster, VehicleKind::Helicopter, VehicleKind::Sled];
    let objects = kinds.iter().zip(1_u16..).map(|(&kind, id)| vehicle(&mirror, kind, id)).collect();
    mirror.apply(ServerMessage::Poses { tick: 1, objects }).expect("sound poses");
    mirror
}

fn vehicle(mirror: &Mirror, kind: VehicleKind, id: u16) -> ObjectPose {
    let [x, z, _] = hash3([u32::from(id), 11, 3]).map(unit).map(|random| 8.0 + 48.0 * random);
    let position_m = [x, ground_m(mirror, x, z) + 0.8, z];
    ObjectPose { id: id.into(), kind, position_m, rotation: [0.0, 0.0, 0.0, 1.0], velocity_m_per_s: [0.0; 3], part_rad: 0.0 }
}

fn ground_m(mirror: &Mirror, x: f32, z: f32) -> f32 {
    mirror.decoded_scene().expect("a scene").heights().height_m(x, z)
}

/// A random camera: from among the blades to 3 m above, in any direction except straight up or down.
fn camera(mirror: &Mirror, number: u32) -> Camera {
    let [x, z, above] = hash3([number, 1, 9]).map(unit);
    let [heading, pitch, _] = hash3([number, 2, 9]).map(unit);
    let [x, z] = [x, z].map(|random| 1.0 + (SIDE_M - 2.0) * random);
    let above_m = 0.05 * 60.0_f32.powf(above);
    let eye_m = Vec3::new(x, ground_m(mirror, x, z) + above_m, z);
    Camera { eye_m, heading_rad: std::f32::consts::TAU * heading, pitch_rad: -0.9 + 1.2 * pitch, ..Camera::default() }
}

/// Pictures with occlusion and without any culling from the same cameras.
struct Compared {
    mirror: Mirror,
    tested: OffscreenRenderer,
    whole: OffscreenRenderer,
    /// Cameras whose pictures differ.
    differing: Vec<u32>,
    /// Bent plants with and without occlusion.
    plants: [u64; 2],
    /// Drawn solids, with and without.
    solids: [u64; 2],
}

impl Compared {
    fn new(gpu: &Gpu, quality: Quality) -> Self {
        let [mut tested, whole] = [(); 2].map(|()| OffscreenRenderer::new(gpu, SIZE_PX, quality));
        tested.set_options(RenderOptions { occlusion: Occlusion::Always, ..RenderOptions::default() });
        Self { mirror: village(), tested, whole, differing: Vec::new(), plants: [0; 2], solids: [0; 2] }
    }

    /// Replaces the farthest depths of the pyramid by the nearest ones, which hide too much.
    fn keep_nearest(&mut self, gpu: &Gpu) {
        let renderer = &mut self.tested.renderer;
        let factory = PassFactory {
            gpu: gpu.clone(),
            frame_layout: renderer.bindings.layout.clone(),
            pyramid: renderer.bindings.pyramid.clone(),
            samples: renderer.targets.depth.texture().sample_count(),
            has_kinds: true,
            soft_shadows: true,
            has_snow: false,
        };
        renderer.depth_pyramid = Some(DepthPyramid::new(&factory, &renderer.targets.depth, true));
    }

    /// Compares the pictures of a camera with those without occlusion, and every fourth time without any culling: the first one from there, and every fourth
    /// time also the second one, for which other solids are known to be visible.
    fn compare(&mut self, number: u32) {
        let camera = camera(&self.mirror, number);
        // Every fourth time without any culling, last without occlusion, for the counts.
        let options = RenderOptions { occlusion: Occlusion::Never, ..RenderOptions::default() };
        let mut wholes = Vec::new();
        let ways: &[bool] = if number.is_multiple_of(4) { &[false, true] } else { &[true] };
        for &culls in ways {
            self.whole.set_options(RenderOptions { culls, ..options });
            self.whole.draw(&mut self.mirror, &camera, 0.0, 0.0);
            wholes.push(self.whole.rgba());
        }
        for _ in 0..1 + u32::from(number.is_multiple_of(4)) {
            self.tested.draw(&mut self.mirror, &camera, 0.0, 0.0);
            let tested = self.tested.rgba();
            if wholes.iter().any(|whole| *whole != tested) && self.differing.last() != Some(&number) {
                self.differing.push(number);
            }
        }
        for (n, canvas) in [&self.tested, &self.whole].into_iter().enumerate() {
            self.plants[n] += u64::from(canvas.bent_plants());
            self.solids[n] += canvas.drawn_solids()[1];
        }
    }
}

fn compared(gpu: &Gpu, quality: Quality, cameras: u32) -> Compared {
    let mut compared = Compared::new(gpu, quality);
    (0..cameras).for_each(|number| compared.compare(number));
    println!("{quality:?}: {:?} plants, {:?} solids with and without occlusion", compared.plants, compared.solids);
    compared
}

#[test]
fn occlusion_changes_no_pixel() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    // With one sample per pixel, and with four.
    for (quality, cameras) in [(Quality::Low, 200), (Quality::High, 8)] {
        let Compared { differing, plants, solids, .. } = compared(&gpu, quality, cameras);
        assert!(differing.is_empty(), "{quality:?}: pictures of cameras {differing:?} differ");
        let has_hidden_solids = cameras < 100 || solids[0] < solids[1];
        assert!(plants[0] < plants[1] && has_hidden_solids, "{plants:?} plants, {solids:?} solids: nothing is saved");
    }
}

#[test]
fn a_pyramid_of_nearest_depths_changes_pictures() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    for quality in [Quality::Low, Quality::High] {
        let mut compared = Compared::new(&gpu, quality);
        compared.keep_nearest(&gpu);
        (0..6).for_each(|number| compared.compare(number));
        assert!(compared.differing.len() > 2, "{quality:?}: only the pictures of cameras {:?} differ", compared.differing);
    }
}
