//! No crack opens between tiles of land.

use super::*;
use crate::render::Renderer;
use crate::render::gpu::pipeline::{COLOR, DEPTH, DrawDescriptor, bind, storage};
use crate::render::inputs::frustum::Frustum;
use crate::render::land_and_sky::terrain::tile_indices;
use std::f32::consts::TAU;

const SIDE_PX: u32 = 256;
const CAMERAS: u32 = 1000;
/// Pixels that must open where tiles ignore their neighbours.
const CONTROL_PIXELS: usize = 10_000;
/// Maximum number of tiles in view.
const TILES: u64 = 1024;

/// A ragged map of 128 m with hills around it, over a covering map of 128 × 128 pixels.
pub(super) fn ragged_land(change: impl FnOnce(&mut Scene), covering: &[u8]) -> Mirror {
    let maps = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [1.0, 1.0], level_m: 0.05, base_m: 0.0 };
    let mut scene = Scene { patches: Patches { count: [8, 8], ..Patches::default() }, ..Scene::new(maps) };
    change(&mut scene);
    let heights: Vec<u8> = (0..129 * 129)
        .map(|at| {
            let [x, z] = [at % 129, at / 129].map(|n| n as f32);
            let hills = 100.0 + 50.0 * (x * 0.09).sin() + 40.0 * (z * 0.13).cos();
            (hills + 50.0 * unit(hash3([at, 5, 1])[0])) as u8
        })
        .collect();
    let mut mirror = Mirror::default();
    let scene = ServerMessage::Scene {
        scene: Box::new(scene),
        height_png: grey_png([129; 2], &heights),
        covering_png: grey_png([128; 2], covering),
        nutrient_png: Vec::new(),
        models: Vec::new(),
        shapes: Default::default(),
    };
    mirror.apply(scene).expect("a sound scene");
    mirror
}

/// A random level camera above the land, so that columns of pixels are vertical planes.
fn camera(number: u32, mirror: &Mirror) -> Camera {
    let [x, z, up, heading, wide] = [0, 1, 2, 3, 4].map(|axis| unit(hash3([number, axis, 9])[0]));
    let [x, z] = [x, z].map(|fraction| 1.0 + 126.0 * fraction);
    let ground_m = mirror.decoded_scene().expect("a scene").heights().height_m(x, z);
    let eye_m = Vec3::new(x, ground_m + 2.0 + 80.0 * up * up * up, z);
    Camera { eye_m, heading_rad: TAU * heading, pitch_rad: 0.0, fov_rad: 1.0 + 1.2 * wide, ..Camera::default() }
}

/// Draws land in white on black.
struct LandPass {
    gpu: Gpu,
    pipeline: wgpu::RenderPipeline,
    group: wgpu::BindGroup,
    tiles: wgpu::Buffer,
    indices: wgpu::Buffer,
    index_count: u32,
    color: wgpu::Texture,
    depth: wgpu::TextureView,
    pixels: wgpu::Buffer,
}

impl LandPass {
    fn new(renderer: &Renderer) -> Self {
        use wgpu::{BufferUsages, TextureUsages};
        let gpu = renderer.gpu.clone();
        let factory = &renderer.scene.as_ref().expect("land").factory;
        let layout = factory.layout("land", &[storage(0)]);
        let tiles = gpu.empty_buffer("tiles", TILES * size_of::<GroundTile>() as u64, BufferUsages::STORAGE | BufferUsages::COPY_DST);
        let group = bind(&gpu, "land", &layout, &[tiles.as_entire_binding()]);
        let vertices = factory.shader("terrain", shaders::TERRAIN, &[]);
        let white = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("white"),
            source: wgpu::ShaderSource::Wgsl("@fragment fn fs() -> @location(0) vec4<f32> { return vec4<f32>(1.0); }".into()),
        });
        // Both faces: at a ridge, vertices rounded to fractions of a pixel turn triangles away that are seen from their edge.
        let draw = DrawDescriptor { label: "land", cull: None, fragment_module: Some(&white), ..DrawDescriptor::default() };
        let color = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("land"),
            size: wgpu::Extent3d { width: SIDE_PX, height: SIDE_PX, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: COLOR,
            usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let indices = tile_indices();
        Self {
            pipeline: factory.draw(&vertices, Some(&layout), &draw),
            group,
            tiles,
            index_count: indices.len() as u32,
            indices: gpu.buffer("tile", bytemuck::cast_slice(&indices), BufferUsages::INDEX),
            color,
            depth: gpu.render_target("depth", DEPTH, [SIDE_PX; 2], 1),
            pixels: gpu.empty_buffer("pixels", u64::from(SIDE_PX * SIDE_PX) * 8, BufferUsages::COPY_DST | BufferUsages::COPY_SRC),
            gpu,
        }
    }

    /// Number of pixels without land below a pixel with land: over a height field, a ray hits land if one above it in a vertical plane does.
    fn cracks(&self, renderer: &Renderer, tiles: &[GroundTile]) -> usize {
        self.gpu.queue.write_buffer(&self.tiles, 0, bytemuck::cast_slice(tiles));
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        let attachment = wgpu::RenderPassColorAttachment {
            view: &self.color.create_view(&Default::default()),
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
        };
        let depth_ops = Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(attachment)],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment { view: &self.depth, depth_ops, stencil_ops: None }),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &renderer.scene.as_ref().expect("land").textures.group, &[]);
        pass.set_bind_group(1, &self.group, &[]);
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint16);
        pass.draw_indexed(0..self.index_count, 0, 0..tiles.len() as u32);
        drop(pass);
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(SIDE_PX * 8), rows_per_image: None };
        let target = wgpu::TexelCopyBufferInfo { buffer: &self.pixels, layout };
        encoder.copy_texture_to_buffer(self.color.as_image_copy(), target, self.color.size());
        self.gpu.queue.submit([encoder.finish()]);
        let pixels: Vec<u64> = bytemuck::pod_collect_to_vec(&read(&self.gpu, &self.pixels));
        let is_land = |row: u32, column: u32| pixels[(row * SIDE_PX + column) as usize] & 0xFFFF != 0;
        let below = |column: u32| (0..SIDE_PX).map(move |row| is_land(row, column)).skip_while(|land| !land).filter(|land| !land).count();
        (0..SIDE_PX).map(below).sum()
    }
}

#[test]
fn no_sky_is_seen_through_land() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = ragged_land(|_| {}, &[255; 128 * 128]);
    let mut picture = OffscreenRenderer::new(&gpu, [16; 2], Quality::Low);
    (picture.renderer, _) = Renderer::with_land(&gpu, wgpu::TextureFormat::Rgba8UnormSrgb, [16; 2], Quality::Low, &mirror);
    let pass = LandPass::new(&picture.renderer);
    let (mut levels, mut cracks, mut without_borders) = (0, 0, 0);
    for number in 0..CAMERAS {
        let camera = camera(number, &mirror);
        // Writes the uniforms.
        picture.draw(&mut mirror, &camera, 0.0, 0.0);
        let scene = picture.renderer.scene.as_ref().expect("land");
        let tiles = scene.quadtree.tiles(camera.eye_m, &Frustum::new(&camera.projection_from_world(1.0)));
        cracks += pass.cracks(&picture.renderer, &tiles);
        levels += u32::from(tiles.iter().any(|tile| tile.side_m != tiles[0].side_m));
        let tiles: Vec<_> = tiles.iter().map(|tile| GroundTile { borders_and_kind: 0, ..*tile }).collect();
        without_borders += pass.cracks(&picture.renderer, &tiles);
    }
    println!(
        "{levels} cameras see tiles of several sizes; {cracks} pixels in cracks, {without_borders} where tiles ignore their neighbours"
    );
    assert!(levels > CAMERAS * 9 / 10, "{levels} cameras see tiles of several sizes");
    assert_eq!(cracks, 0, "pixels in cracks");
    assert!(without_borders > CONTROL_PIXELS, "{without_borders} pixels in cracks where tiles ignore their neighbours");
}
