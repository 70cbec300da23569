//! The streamed wind as a 3-D texture, dust in its fourth channel, that follows the newest frame smoothly.

use super::gpu::Gpu;
use crate::state::{Land, WindCodes};
use shared::scene::Wind;
use shared::wire::Shape;
use shared::wire::quantise::WIND_FULL_M_PER_S;

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

    /// The shown wind at a place (m/s): X, height above the ground, Z (m), as `air_at` in `common.wgsl` finds it.
    pub(super) fn at(&self, land: &Land, [x, above_m, z]: [f32; 3]) -> [f32; 3] {
        let wind = &land.scene().wind;
        let wraps = wind.faces.wraps();
        land.tiles().blend([x, z], |[x, z]| {
            let place_m = [x, above_m, z];
            let axes: [([usize; 2], f32); 3] = std::array::from_fn(|axis| {
                let at = place_m[axis] / wind.spacing_m[axis] - 0.5;
                let (low, count) = (at.floor(), self.cells[axis] as i32);
                let is_round = wraps[axis] && axis != 1;
                let cell = |n: i32| if is_round { n.rem_euclid(count) } else { n.clamp(0, count - 1) } as usize;
                ([cell(low as i32), cell(low as i32 + 1)], at - low)
            });
            let [nx, ny, nz] = self.cells.map(|n| n as usize);
            let mut sum = [0.0; 3];
            for corner in 0..8 {
                let far = [corner & 1, corner >> 1 & 1, corner >> 2];
                let share: f32 = (0..3).map(|axis| if far[axis] == 1 { axes[axis].1 } else { 1.0 - axes[axis].1 }).product();
                let [i, j, k]: [usize; 3] = std::array::from_fn(|axis| axes[axis].0[far[axis]]);
                for (channel, sum) in sum.iter_mut().enumerate() {
                    *sum += share * self.shown[channel * nx * ny * nz + i + nx * (j + ny * k)];
                }
            }
            sum.map(|code| code * (WIND_FULL_M_PER_S / 127.0))
        })
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
