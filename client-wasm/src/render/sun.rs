//! Daylight: the sky for where the sun stands, in the brightness that an adapted eye gives it.

use super::forces::half;
use super::gpu::Gpu;
use glam::Vec3;
use shared::light::sky::{Air, ELEVATIONS, HEADINGS, NIGHT_CD_PER_M2, Sky};
use shared::light::sun::Sun;
use shared::light::{Rgb, luminance};
use std::f32::consts::PI;

/// Brightness of the picture for the key that the eye gives to what it sees.
const GAIN: f32 = 0.7;
/// Way of the sun after which the sky is made anew (rad): a third of its disc.
const SKY_STEP_RAD: f32 = 0.003;
/// Luminance of the sky above which no star is seen, and at which all are (cd/m²).
const STARS_CD_PER_M2: [f32; 2] = [4.0, 0.05];
/// Brightness of the brightest stars.
const STARS: f32 = 0.5;

/// The sky as it is shown.
pub(super) struct Daylight {
    air: Air,
    sky: Sky,
    texture: wgpu::Texture,
    is_written: bool,
}

impl Daylight {
    pub(super) fn new(gpu: &Gpu) -> Self {
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

    pub(super) fn texture(&self) -> &wgpu::Texture {
        &self.texture
    }

    /// Brings the sky to where the sun stands.
    pub(super) fn follow(&mut self, gpu: &Gpu, sun: Sun) {
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

    /// Brightness of the picture for each cd/m².
    pub(super) fn brightness(&self) -> f32 {
        self.sky.exposure() * GAIN
    }

    /// Sunlight over π: on the land, and at the height of clouds.
    pub(super) fn sunlight(&self) -> [Vec3; 2] {
        [self.sky.sun_lx, self.sky.cloud_sun_lx].map(|light| Vec3::from(light) * (self.brightness() / PI))
    }

    /// Light of sky and land on a surface, over π: the mean of up and down, what it is more straight up, and towards the sun.
    pub(super) fn ambient(&self) -> [Vec3; 3] {
        [self.sky.mean, self.sky.up, self.sky.toward_sun].map(|light| Vec3::from(light) * self.brightness())
    }

    /// The night's own sky, and the brightness of stars.
    pub(super) fn night(&self) -> (Vec3, f32) {
        let [day, night] = STARS_CD_PER_M2.map(f32::ln);
        let seen = (day - self.zenith().max(1e-6).ln()) / (day - night);
        (Vec3::from(NIGHT_CD_PER_M2) * self.brightness(), STARS * seen.clamp(0.0, 1.0))
    }

    /// Luminance straight up (cd/m²).
    fn zenith(&self) -> f32 {
        let overhead: Rgb = self.sky.luminance(1.0, 1.0);
        luminance(overhead)
    }
}
