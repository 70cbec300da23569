//! Bind group 0, which all passes share: uniforms, heights, normals, cover, bend atlas, wind, noise, shadow map, sky, repeated patch, shade of the grass.

use crate::render::gpu::constants::{SHADE_MAPS, SHADE_PX};
use crate::render::gpu::device::Gpu;
use crate::render::gpu::mipmaps::{all_mipmaps, box_mipmaps};
use crate::render::gpu::pipeline::{DEPTH, bind, sampled, sampler, texture, uniform};
use crate::render::gpu::uniforms::Frame;
use crate::render::inputs::bend_atlas::BendAtlas;
use crate::render::inputs::cascades::SHADOW_CASCADES;
use crate::render::inputs::daylight::Daylight;
use crate::render::inputs::depth_pyramid::pyramid_buffer;
use crate::render::inputs::grass_kinds;
use crate::render::inputs::noise_texture::{NOISE_PX, noise};
use crate::render::inputs::repeated_patch::RepeatedTextures;
use crate::render::inputs::wind_texture::WindTexture;
use crate::render::options::quality::Quality;
use crate::state::DecodedScene;
use prairie_core::grass::RepeatedPatch;
use prairie_core::terrain::{Cover, HeightMap};
use wgpu::{TextureFormat, TextureSampleType, TextureViewDimension};

/// Layout of bind group 0, and its resources that outlive a scene.
pub(crate) struct FrameBindings {
    pub(crate) layout: wgpu::BindGroupLayout,
    /// Depth pyramid of the picture, which is not in the group: passes that test it have it in their own.
    pub(crate) pyramid: wgpu::Buffer,
    uniforms: wgpu::Buffer,
    sky: wgpu::TextureView,
    noise: wgpu::TextureView,
    repeated: wgpu::Sampler,
    clamped: wgpu::Sampler,
    shadow_sampler: wgpu::Sampler,
    shadows: wgpu::Texture,
    no_shadows: wgpu::Texture,
}

/// Textures of a scene, and bind group 0 made of all resources.
pub(crate) struct SceneTextures {
    pub(crate) atlas: BendAtlas,
    pub(crate) repeated: RepeatedTextures,
    pub(crate) wind: WindTexture,
    /// Maps of the shade that grass casts.
    pub(crate) shade: wgpu::Texture,
    /// Bind group 0 of all passes but the shadow pass.
    pub(crate) group: wgpu::BindGroup,
    /// Bind group 0 without the shadow map, for the pass that draws it.
    pub(crate) shadow_group: wgpu::BindGroup,
}

impl FrameBindings {
    pub(crate) fn new(gpu: &Gpu, quality: Quality, daylight: &Daylight) -> Self {
        let entries = [
            uniform(0),
            sampled(1, TextureSampleType::Float { filterable: false }, TextureViewDimension::D2),
            texture(2),
            texture(3),
            sampled(4, TextureSampleType::Float { filterable: true }, TextureViewDimension::D2Array),
            sampled(5, TextureSampleType::Float { filterable: true }, TextureViewDimension::D3),
            texture(6),
            sampler(7, wgpu::SamplerBindingType::Filtering),
            sampler(8, wgpu::SamplerBindingType::Filtering),
            sampled(9, TextureSampleType::Depth, TextureViewDimension::D2Array),
            sampler(10, wgpu::SamplerBindingType::Comparison),
            sampled(11, TextureSampleType::Uint, TextureViewDimension::D2),
            uniform(12),
            texture(13),
            texture(14),
            texture(15),
            sampled(16, TextureSampleType::Float { filterable: true }, TextureViewDimension::D2Array),
        ];
        let layout = gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("frame"), entries: &entries });
        let linear = |mode, compare| {
            gpu.device.create_sampler(&wgpu::SamplerDescriptor {
                address_mode_u: mode,
                address_mode_v: mode,
                address_mode_w: mode,
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                mipmap_filter: wgpu::MipmapFilterMode::Linear,
                compare,
                ..Default::default()
            })
        };
        let noise = gpu.texture("noise", TextureFormat::Rgba8Unorm, [NOISE_PX; 2], &noise());
        Self {
            layout,
            pyramid: pyramid_buffer(gpu),
            uniforms: gpu.empty_buffer("frame", size_of::<Frame>() as u64, wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST),
            sky: view(daylight.texture()),
            noise: view(&noise),
            repeated: linear(wgpu::AddressMode::Repeat, None),
            clamped: linear(wgpu::AddressMode::ClampToEdge, None),
            shadow_sampler: linear(wgpu::AddressMode::ClampToEdge, Some(wgpu::CompareFunction::LessEqual)),
            shadows: depth_texture(gpu, quality.shadow_px(), SHADOW_CASCADES),
            no_shadows: depth_texture(gpu, 1, 1),
        }
    }

    pub(crate) fn write(&self, gpu: &Gpu, frame: &Frame) {
        gpu.queue.write_buffer(&self.uniforms, 0, bytemuck::bytes_of(frame));
    }

    /// A cascade of the shadow map.
    pub(crate) fn shadow_map(&self, cascade: u32) -> wgpu::TextureView {
        let descriptor = wgpu::TextureViewDescriptor {
            dimension: Some(TextureViewDimension::D2),
            base_array_layer: cascade,
            array_layer_count: Some(1),
            ..Default::default()
        };
        self.shadows.create_view(&descriptor)
    }
}

fn depth_texture(gpu: &Gpu, side_px: u32, layers: u32) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("shadows"),
        size: wgpu::Extent3d { width: side_px, height: side_px, depth_or_array_layers: layers },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: DEPTH,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    })
}

/// Maps of the shade that grass casts, without shade.
fn shade_texture(gpu: &Gpu) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("shade of grass"),
        size: wgpu::Extent3d { width: SHADE_PX, height: SHADE_PX, depth_or_array_layers: SHADE_MAPS },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

fn view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&Default::default())
}

impl SceneTextures {
    pub(crate) fn new(gpu: &Gpu, frame: &FrameBindings, decoded: &DecodedScene) -> Self {
        let heights = decoded.heights();
        let height_texture =
            gpu.texture("heights", TextureFormat::R32Float, heights.size_px(), &[bytemuck::cast_slice(heights.heights_m()).to_vec()]);
        let normal_texture = gpu.texture("normals", TextureFormat::Rgba8Snorm, heights.size_px(), &[normals(heights)]);
        let (cover, kind_map) = (decoded.cover(), decoded.kinds());
        let cover_texture = gpu.texture("cover", TextureFormat::Rg8Unorm, cover.size_px(), &grass(decoded));
        let kind_texture = gpu.texture("kinds", TextureFormat::R8Uint, kind_map.size_px(), &[kind_map.kinds().to_vec()]);
        let kinds = gpu.buffer("kinds", bytemuck::bytes_of(&grass_kinds::table(decoded.scene())), wgpu::BufferUsages::UNIFORM);
        let atlas = BendAtlas::new(gpu, *decoded.layout(), decoded.scene());
        let repeated = RepeatedTextures::new(gpu, &atlas, RepeatedPatch::new(decoded.scene()).as_ref());
        let wind = WindTexture::new(gpu, decoded.scene());
        let shade = shade_texture(gpu);
        let group = |label, shadows: &wgpu::Texture| {
            use wgpu::BindingResource::{Sampler, TextureView};
            let views = [&height_texture, &normal_texture, &cover_texture, &wind.texture, &kind_texture].map(view);
            let [heights, normals, cover, winds, kind_map] = &views;
            let [leans, near] = &[&repeated.leans, &repeated.near].map(view);
            let layers = wgpu::TextureViewDescriptor { dimension: Some(TextureViewDimension::D2Array), ..Default::default() };
            let bends = &atlas.texture.create_view(&layers);
            let [shadows, shade] = &[shadows, &shade].map(|texture| texture.create_view(&layers));
            let resources = [
                frame.uniforms.as_entire_binding(),
                TextureView(heights),
                TextureView(normals),
                TextureView(cover),
                TextureView(bends),
                TextureView(winds),
                TextureView(&frame.noise),
                Sampler(&frame.repeated),
                Sampler(&frame.clamped),
                TextureView(shadows),
                Sampler(&frame.shadow_sampler),
                TextureView(kind_map),
                kinds.as_entire_binding(),
                TextureView(&frame.sky),
                TextureView(leans),
                TextureView(near),
                TextureView(shade),
            ];
            bind(gpu, label, &frame.layout, &resources)
        };
        let (all, shadow) = (group("frame", &frame.shadows), group("frame without shadows", &frame.no_shadows));
        Self { group: all, shadow_group: shadow, atlas, repeated, wind, shade }
    }
}

/// Normals of the pixels by central differences, as signed bytes.
fn normals(heights: &HeightMap) -> Vec<u8> {
    let [width, depth] = heights.size_px().map(|n| n as usize);
    let [pixel_x, pixel_z] = heights.pixel_m();
    let h = heights.heights_m();
    let mut texels = Vec::with_capacity(width * depth * 4);
    for z in 0..depth {
        for x in 0..width {
            let at = |x: usize, z: usize| h[z * width + x];
            let (west, east) = (x.saturating_sub(1), (x + 1).min(width - 1));
            let (north, south) = (z.saturating_sub(1), (z + 1).min(depth - 1));
            let slope_x = (at(east, z) - at(west, z)) / ((east - west) as f32 * pixel_x);
            let slope_z = (at(x, south) - at(x, north)) / ((south - north) as f32 * pixel_z);
            let normal = glam::Vec3::new(-slope_x, 1.0, -slope_z).normalize();
            texels.extend(normal.to_array().map(|v| (v * 127.0).round() as i8 as u8));
            texels.push(0);
        }
    }
    texels
}

/// For each pixel the cover fraction of grass, which grows up to the trunks of trees, and the nutrients of the soil relative to twice their mean;
/// all mip levels.
fn grass(decoded: &DecodedScene) -> Vec<Vec<u8>> {
    let (scene, cover) = (decoded.scene(), decoded.cover());
    let fraction = |id: u8| match Cover::from(id) {
        cover if scene.is_grass(cover) => 255,
        Cover::Tree => 190,
        Cover::Stone => 110,
        _ => 0,
    };
    let nutrients = nutrients(decoded);
    let texels = cover.ids().iter().zip(nutrients).flat_map(|(&id, nutrients)| [fraction(id), nutrients]).collect();
    box_mipmaps::<2>(texels, cover.size_px(), all_mipmaps(cover.size_px()))
}

/// Nutrients at the pixels of the covering map, relative to twice their mean; one half in scenes without underbrush, which have no soil.
fn nutrients(decoded: &DecodedScene) -> Vec<u8> {
    let [width, depth] = decoded.cover().size_px();
    let Some(flora) = decoded.flora() else { return vec![128; width as usize * depth as usize] };
    let (soil, [columns, rows]) = (flora.grown().soil.levels(), flora.grown().sites.count());
    let sums: Vec<u64> = soil.iter().map(|levels| levels.iter().map(|&level| u64::from(level)).sum()).collect();
    let mean = (sums.iter().sum::<u64>() / sums.len() as u64).max(1);
    let site = |x: u32, z: u32| {
        (u64::from(z) * u64::from(rows) / u64::from(depth) * u64::from(columns) + u64::from(x) * u64::from(columns) / u64::from(width))
            as usize
    };
    let relative = |sum: u64| (128 * sum / mean).min(255) as u8;
    (0..depth).flat_map(|z| (0..width).map(move |x| [x, z])).map(|[x, z]| relative(sums[site(x, z)])).collect()
}
