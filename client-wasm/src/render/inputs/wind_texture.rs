//! The streamed wind as a 3-D texture that follows the newest frame smoothly; the fourth channel is dust.

use crate::render::gpu::device::Gpu;
use crate::state::{DecodedScene, WindCodes};
use prairie_core::scene::Wind;
use prairie_core::wind::CellGrid;
use prairie_core::wire::Shape;
use prairie_core::wire::quantise::WIND_FULL_M_PER_S;

/// Time constant with which the displayed wind follows the streamed one (s).
const FOLLOW_SECS: f32 = 0.12;

pub(crate) struct WindTexture {
    pub(crate) texture: wgpu::Texture,
    cells: [u32; 3],
    shown: Vec<f32>,
    seq: Option<u32>,
    settled: bool,
}

impl WindTexture {
    /// A texture of the scene's mean wind, until the first frame arrives.
    pub(crate) fn new(gpu: &Gpu, wind: &Wind) -> Self {
        let cells = wind.cells;
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("wind"),
            size: wgpu::Extent3d { width: cells[0], height: cells[1], depth_or_array_layers: cells[2] },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: wgpu::TextureFormat::Rgba8Snorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let count = cells.iter().map(|&n| n as usize).product::<usize>();
        let [x, z] = wind.mean_m_per_s.map(|v| f32::from(prairie_core::wire::quantise::wind_code(v)));
        let still = [x, 0.0, z, 0.0].into_iter().take(Shape::wind(1, wind.has_dust()).planes);
        let shown = still.flat_map(|v| std::iter::repeat_n(v, count)).collect();
        let new = Self { texture, cells, shown, seq: None, settled: false };
        new.write(gpu);
        new
    }

    /// Moves towards the newest frame, if any; the first is adopted at once.
    pub(crate) fn update(&mut self, gpu: &Gpu, newest: Option<&WindCodes>, dt_secs: f32) {
        let Some(newest) = newest.filter(|codes| codes.cells() == self.cells) else { return };
        if self.seq == Some(newest.seq()) && self.settled {
            return;
        }
        let fraction = if self.seq.is_none() { 1.0 } else { 1.0 - (-dt_secs / FOLLOW_SECS).exp() };
        let mut rest = 0.0_f32;
        for (shown, &code) in self.shown.iter_mut().zip(newest.planes().into_iter().chain(newest.dust()).flatten()) {
            *shown += (f32::from(code) - *shown) * fraction;
            rest = rest.max((f32::from(code) - *shown).abs());
        }
        self.seq = Some(newest.seq());
        self.settled = rest < 0.5;
        self.write(gpu);
    }

    /// Displayed wind (m/s) at X, height above the ground and Z (m), by the trilinear sampling of `air_at` in WGSL.
    pub(crate) fn at(&self, decoded: &DecodedScene, [x, above_m, z]: [f32; 3]) -> [f32; 3] {
        let (grid, count) = (CellGrid::from(&decoded.scene().wind), self.cells.map(|n| n as usize).iter().product::<usize>());
        let codes = decoded
            .tiles()
            .blend([x, z], |[x, z]| grid.trilinear([x, above_m, z], |cell| [0, 1, 2].map(|channel| self.shown[channel * count + cell])));
        codes.map(|code| code * (WIND_FULL_M_PER_S / 127.0))
    }

    fn write(&self, gpu: &Gpu) {
        let [nx, ny, nz] = self.cells;
        let count = (nx * ny * nz) as usize;
        let mut texels = vec![0_u8; count * 4];
        for (channel, plane) in self.shown.chunks_exact(count).enumerate() {
            for (i, value) in plane.iter().enumerate() {
                texels[i * 4 + channel] = value.round() as i8 as u8;
            }
        }
        gpu.queue.write_texture(
            self.texture.as_image_copy(),
            &texels,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(nx * 4), rows_per_image: Some(ny) },
            wgpu::Extent3d { width: nx, height: ny, depth_or_array_layers: nz },
        );
    }
}
