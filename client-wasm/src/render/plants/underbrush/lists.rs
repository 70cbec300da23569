//! Draw lists of the underbrush: one for each species at each level of detail.

use super::bake::{Baked, LEVELS};
use super::close_up::curve_indices;
use super::layout::{BLOCK, CHUNK, LISTS};
use crate::render::gpu::constants;
use crate::render::gpu::device::Gpu;
use crate::render::gpu::uniforms::BrushList;
use bytemuck::Zeroable;
use prairie_core::plant::flora::Flora;
use prairie_core::plant::growth::SPECIES_LIMIT;
use prairie_core::plant::underbrush::drops::drops_per_m2_per_s;
use wgpu::BufferUsages;

/// Approximate number of vertices per instance: small plants share instances.
const INSTANCE_VERTICES: u32 = 512;
/// Levels of detail whose leaves tremble in the rain; on coarser ones the motion is at most a pixel.
const TREMBLING_LEVELS: usize = 2;
/// Words per indirect draw.
pub(super) const DRAW_WORDS: usize = constants::DRAW_WORDS as usize;

/// The lists of a scene, and the tables that their plants are bent with.
pub(super) struct Lists {
    pub(super) of: Vec<BrushList>,
    pub(super) settings: wgpu::Buffer,
    pub(super) steps: wgpu::Buffer,
    pub(super) rows: wgpu::Buffer,
    pub(super) limbs: wgpu::Buffer,
    /// For each list with plants: its number and the indices of an instance.
    pub(super) indices: Vec<(usize, wgpu::Buffer)>,
    /// Indirect draws of all lists, without instances.
    pub(super) draws: wgpu::Buffer,
    /// Total capacity of all lists (plants).
    pub(super) places: u32,
}

impl Lists {
    /// Draw lists for a flora with `plants` of each species, at a rain rate (mm/h); if it `curves`, with curves at the finest level.
    pub(super) fn new(gpu: &Gpu, flora: &Flora, plants: &[u32; SPECIES_LIMIT], rain_mm_per_h: f32, curves: bool) -> Self {
        let mut of = vec![BrushList::zeroed(); LISTS];
        let mut draw_words = vec![0_u32; LISTS * DRAW_WORDS];
        let (mut steps, mut rows, mut limbs) = (Vec::new(), Vec::new(), Vec::new());
        let (mut indices, mut places) = (Vec::new(), 0);
        for (number, (plan, own)) in flora.plans().iter().zip(plants).enumerate() {
            let nodes = plan.tables[0].nodes();
            for level in 0..LEVELS {
                let list = number * LEVELS + level;
                let baked = Baked::new(plan, level);
                let own_rows = baked.ribbons.iter().sum::<u32>();
                let held = (INSTANCE_VERTICES / (2 * own_rows)).clamp(1, CHUNK);
                let trembles = rain_mm_per_h > 0.0 && level < TREMBLING_LEVELS;
                of[list] = BrushList {
                    rows: own_rows,
                    instance_plants: held,
                    limbs: baked.limb_count(),
                    first_row: rows.len() as u32,
                    first_limb: limbs.len() as u32,
                    first_listed: places,
                    is_nearest: u32::from(level + 1 == LEVELS),
                    first_step: steps.len() as u32,
                    nodes: [nodes.angles as u32, nodes.loads as u32],
                    drops_per_m2_per_s: if trembles { drops_per_m2_per_s(rain_mm_per_h) } else { 0.0 },
                    _pad: [0; 4],
                };
                places += own;
                let triangles = if curves && level == 0 { curve_indices(&baked.ribbons, held) } else { baked.indices(held) };
                draw_words[list * DRAW_WORDS] = triangles.len() as u32;
                indices.push((list, gpu.buffer("underbrush indices", bytemuck::cast_slice(&triangles), BufferUsages::INDEX)));
                steps.extend(baked.steps);
                rows.extend(baked.rows);
                limbs.extend(baked.limbs);
            }
        }
        let storage = |label, contents: &[u8]| gpu.buffer(label, contents, BufferUsages::STORAGE);
        let drawn = BufferUsages::STORAGE | BufferUsages::INDIRECT | BufferUsages::COPY_SRC;
        Self {
            settings: gpu.buffer("underbrush lists", bytemuck::cast_slice(&of), BufferUsages::UNIFORM),
            steps: storage("steps", bytemuck::cast_slice(&steps)),
            rows: storage("rows", bytemuck::cast_slice(&rows)),
            limbs: storage("limbs", bytemuck::cast_slice(&limbs)),
            draws: gpu.buffer("underbrush draws", bytemuck::cast_slice(&draw_words), drawn),
            of,
            indices,
            places,
        }
    }

    /// Blocks of rows of a plant of a species at the finest level.
    pub(super) fn most_blocks(&self, species: usize) -> u32 {
        self.of[species * LEVELS].rows.div_ceil(BLOCK)
    }
}
