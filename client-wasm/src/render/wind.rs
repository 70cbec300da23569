//! The streamed wind as a 3-D texture, dust in its fourth channel, that follows the newest frame smoothly.

use super::gpu::Gpu;
use crate::state::WindCodes;
use shared::scene::Wind;
use shared::wire::Shape;

/// Time in which the shown wind takes up 63 % of a change (s).
const FOLLOW_SECS: f32 = 0.12;

pub(super) struct WindTexture {
    pub(super) texture: wgpu::Texture,
    cells: [u32; 3],
    shown: Vec<f32>,
    seq: Option<u32>,
    settled: bool,
}

impl WindTexture {
    /// A texture that shows the scene's mean wind until a frame comes.
    pub(super) fn new(gpu: &Gpu, wind: &Wind) -> Self {
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
        let [x, z] = wind.mean_m_per_s.map(|v| f32::from(shared::wire::quantise::wind_code(v)));
        let still = [x, 0.0, z, 0.0].into_iter().take(Shape::wind(1, wind.has_dust()).planes);
        let shown = still.flat_map(|v| std::iter::repeat_n(v, count)).collect();
        let new = Self { texture, cells, shown, seq: None, settled: false };
        new.write(gpu);
        new
    }

    /// Moves towards the newest frame, if there is one; the first is shown at once.
    pub(super) fn follow(&mut self, gpu: &Gpu, newest: Option<&WindCodes>, dt_secs: f32) {
        let Some(newest) = newest.filter(|codes| codes.cells() == self.cells) else { return };
        if self.seq == Some(newest.seq()) && self.settled {
            return;
        }
        let share = if self.seq.is_none() { 1.0 } else { 1.0 - (-dt_secs / FOLLOW_SECS).exp() };
        let mut rest = 0.0_f32;
        for (shown, &code) in self.shown.iter_mut().zip(newest.planes().into_iter().chain(newest.dust()).flatten()) {
            *shown += (f32::from(code) - *shown) * share;
            rest = rest.max((f32::from(code) - *shown).abs());
        }
        self.seq = Some(newest.seq());
        self.settled = rest < 0.5;
        self.write(gpu);
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
