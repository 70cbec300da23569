//! Daylight: the sky for the position of the sun, in the brightness that an adapted eye perceives.

use crate::render::gpu::device::Gpu;
use crate::render::gpu::f16::half;
use glam::Vec3;
use prairie_core::light::sky::{Air, ELEVATIONS, HEADINGS, NIGHT_CD_PER_M2, Sky};
use prairie_core::light::sun::Sun;
use prairie_core::light::{Rgb, luminance};
use std::f32::consts::PI;

/// Brightness of the picture at the key value of the adapted eye.
const GAIN: f32 = 0.7;
/// Movement of the sun after which the sky is recomputed (rad): a third of its disc.
const SKY_STEP_RAD: f32 = 0.003;
/// Luminance of the sky (cd/m²): no star is visible above the first value, and all are below the second.
const STARS_CD_PER_M2: [f32; 2] = [4.0, 0.05];
/// Brightness of the brightest stars.
const STARS: f32 = 0.5;

/// Sky of the newest position of the sun, and its texture.
pub(crate) struct Daylight {
    air: Air,
    sky: Sky,
    texture: wgpu::Texture,
    is_written: bool,
}

impl Daylight {
    pub(crate) fn new(gpu: &Gpu) -> Self {
        let air = Air::new();
        let sky = air.sky(0.55);
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("sky"),
            size: wgpu::Extent3d { width: HEADINGS as u32, height: 2 * ELEVATIONS as u32, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        Self { air, sky, texture, is_written: false }
    }

    pub(crate) fn texture(&self) -> &wgpu::Texture {
        &self.texture
    }

    /// Updates the sky to a position of the sun.
    pub(crate) fn update(&mut self, gpu: &Gpu, sun: Sun) {
        let has_moved = (sun.elevation_rad - self.sky.elevation_rad).abs() > SKY_STEP_RAD;
        if self.is_written && !has_moved {
            return;
        }
        self.sky = self.air.sky(sun.elevation_rad);
        self.is_written = true;
        let brightness = self.brightness();
        let halves = (0..2).flat_map(|half| self.sky.texels().iter().map(move |texel| texel[half]));
        let texels: Vec<u8> =
            halves.flat_map(|[r, g, b]| [r, g, b, 0.0]).flat_map(|light| half(light * brightness).to_le_bytes()).collect();
        gpu.write_level(&self.texture, 0, [0; 3], [HEADINGS as u32, 2 * ELEVATIONS as u32], &texels);
    }

    /// Brightness of the picture per cd/m².
    pub(crate) fn brightness(&self) -> f32 {
        self.sky.exposure() * GAIN
    }

    /// Sunlight divided by π, on the land and at the height of clouds.
    pub(crate) fn sunlight(&self) -> [Vec3; 2] {
        [self.sky.sun_lx, self.sky.cloud_sun_lx].map(|light| Vec3::from(light) * (self.brightness() / PI))
    }

    /// Ambient light on a surface, divided by π: mean of up and down, excess straight up, excess towards the sun.
    pub(crate) fn ambient(&self) -> [Vec3; 3] {
        [self.sky.mean, self.sky.up, self.sky.toward_sun].map(|light| Vec3::from(light) * self.brightness())
    }

    /// Light of the night sky, and brightness of the stars.
    pub(crate) fn night(&self) -> (Vec3, f32) {
        let [day, night] = STARS_CD_PER_M2.map(f32::ln);
        let visible = (day - self.zenith().max(1e-6).ln()) / (day - night);
        (Vec3::from(NIGHT_CD_PER_M2) * self.brightness(), STARS * visible.clamp(0.0, 1.0))
    }

    /// Luminance straight up (cd/m²).
    fn zenith(&self) -> f32 {
        let overhead: Rgb = self.sky.luminance(1.0, 1.0);
        luminance(overhead)
    }
}
