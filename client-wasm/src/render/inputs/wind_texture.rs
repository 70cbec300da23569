//! The streamed wind as a 3-D texture, interpolated between frames; the fourth channel is dust. And the gusts between its cells.

use crate::render::gpu::device::Gpu;
use crate::render::inputs::dusty_cells::DustyCells;
use crate::state::{DecodedScene, ShownWind};
use half::f16;
use prairie_core::scene::Scene;
use prairie_core::wind::{CellGrid, Gusts, Turbulence};
use prairie_core::wire::Shape;
use prairie_core::wire::quantise::CodeSteps;

pub(crate) struct WindTexture {
    pub(crate) texture: wgpu::Texture,
    cells: [u32; 3],
    /// Values of a code of each plane: m/s, and the root of the concentration of dust.
    steps: [f32; 4],
    /// Wind (m/s) and root of the concentration of dust, plane after plane, interpolated in time.
    shown: Vec<f32>,
    dusty: DustyCells,
    cell_m3: f32,
    turbulence: Turbulence,
    gusts: Gusts,
    /// Frames shown, and the fraction of the second.
    moment: Option<([u32; 2], f32)>,
}

impl WindTexture {
    /// A texture of the scene's mean wind without gusts, until the first frame arrives.
    pub(crate) fn new(gpu: &Gpu, scene: &Scene) -> Self {
        let wind = &scene.wind;
        let cells = wind.cells;
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("wind"),
            size: wgpu::Extent3d { width: cells[0], height: cells[1], depth_or_array_layers: cells[2] },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D3,
            format: wgpu::TextureFormat::Rgba16Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let count = cells.iter().map(|&n| n as usize).product::<usize>();
        let CodeSteps { wind_m_per_s, dust_root, .. } = CodeSteps::from(&scene.stream);
        let steps = [wind_m_per_s, wind_m_per_s, wind_m_per_s, dust_root];
        let [x, z] = wind.mean_m_per_s;
        let still = [x, 0.0, z, 0.0].into_iter().take(Shape::wind(1, wind.has_dust()).planes);
        let shown = still.flat_map(|v| std::iter::repeat_n(v, count)).collect();
        let new = Self {
            texture,
            cells,
            steps,
            shown,
            dusty: DustyCells::default(),
            cell_m3: wind.spacing_m.iter().product(),
            turbulence: Turbulence::new(scene),
            gusts: Gusts::default(),
            moment: None,
        };
        new.write(gpu);
        new
    }

    /// Adopts the wind to show, if there is any yet.
    pub(crate) fn update(&mut self, gpu: &Gpu, wind: Option<ShownWind<'_>>) {
        let Some(wind) = wind.filter(|wind| wind.from.cells() == self.cells) else { return };
        let moment = Some(([wind.from.seq(), wind.to.seq()], wind.fraction));
        if std::mem::replace(&mut self.moment, moment) == moment {
            return;
        }
        let count = self.cells.map(|n| n as usize).iter().product::<usize>();
        for (at, (shown, (from, to))) in self.shown.iter_mut().zip(wind.from.codes().iter().zip(wind.to.codes())).enumerate() {
            let [from, to] = [from, to].map(|code| f32::from(*code));
            *shown = (from + (to - from) * wind.fraction) * self.steps[at / count];
        }
        if let Some(roots) = self.shown.get(3 * count..4 * count) {
            self.dusty.update(roots.iter().map(|root| root * root), self.cell_m3);
        }
        self.gusts = self.turbulence.at(&wind.turbulence());
        self.write(gpu);
    }

    /// The gusts of the wind shown.
    pub(crate) fn gusts(&self) -> &Gusts {
        &self.gusts
    }

    /// The dusty cells of the wind shown.
    pub(crate) fn dusty(&self) -> &DustyCells {
        &self.dusty
    }

    /// Displayed wind (m/s) without its gusts at X, height above the ground and Z (m), by the trilinear sampling of `air_at` in WGSL.
    pub(crate) fn resolved_at(&self, decoded: &DecodedScene, [x, above_m, z]: [f32; 3]) -> [f32; 3] {
        let (grid, count) = (CellGrid::from(&decoded.scene().wind), self.cells.map(|n| n as usize).iter().product::<usize>());
        let at_cell = |cell| [0, 1, 2].map(|channel| self.shown[channel * count + cell]);
        decoded.tiles().blend([x, z], |[x, z]| grid.trilinear([x, above_m, z], at_cell))
    }

    /// Mean of the displayed wind (m/s, X and Z) without its gusts over the ground: over all cells of the lowest layer.
    pub(crate) fn ground_mean_m_per_s(&self) -> [f32; 2] {
        let [nx, ny, nz] = self.cells.map(|n| n as usize);
        [0, 2].map(|channel| {
            let plane = &self.shown[channel * nx * ny * nz..][..nx * ny * nz];
            plane.chunks_exact(nx * ny).flat_map(|slice| &slice[..nx]).sum::<f32>() / (nx * nz) as f32
        })
    }

    fn write(&self, gpu: &Gpu) {
        let [nx, ny, nz] = self.cells;
        let count = (nx * ny * nz) as usize;
        let mut texels = vec![f16::ZERO; count * 4];
        for (channel, plane) in self.shown.chunks_exact(count).enumerate() {
            for (i, value) in plane.iter().enumerate() {
                texels[i * 4 + channel] = f16::from_f32(*value);
            }
        }
        gpu.queue.write_texture(
            self.texture.as_image_copy(),
            bytemuck::cast_slice(&texels),
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(nx * 8), rows_per_image: Some(ny) },
            wgpu::Extent3d { width: nx, height: ny, depth_or_array_layers: nz },
        );
    }
}
