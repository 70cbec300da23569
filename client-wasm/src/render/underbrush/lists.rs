//! What the plants of each species are made of at each level of detail.

use super::bake::{Baked, LEVELS};
use crate::render::gpu::Gpu;
use crate::render::uniforms::BrushList;
use bytemuck::Zeroable;
use shared::plant::flora::Flora;
use shared::plant::growth::SPECIES_LIMIT;
use shared::plant::underbrush::drops::drops_per_m2_s;
use wgpu::BufferUsages;

/// Vertices of an instance, about: many small plants are drawn as one.
const INSTANCE_VERTICES: u32 = 512;
/// Levels whose leaves tremble in the rain; of coarser ones that is a pixel at most.
const TREMBLING_LEVELS: usize = 2;
/// Lists of plants, one a species and level.
pub(super) const LISTS: usize = SPECIES_LIMIT * LEVELS;
/// Words of an indirect draw.
pub(super) const DRAW_WORDS: usize = 5;

/// The lists of a scene, and what their plants are bent with.
pub(super) struct Lists {
    pub(super) of: Vec<BrushList>,
    pub(super) settings: wgpu::Buffer,
    pub(super) steps: wgpu::Buffer,
    pub(super) rows: wgpu::Buffer,
    pub(super) limbs: wgpu::Buffer,
    /// Of each list that has plants its number and the triangles of an instance.
    pub(super) indices: Vec<(usize, wgpu::Buffer)>,
    /// An indirect draw of each list, of no instances.
    pub(super) draws: wgpu::Buffer,
    /// Places for the plants of all lists.
    pub(super) places: u32,
}

impl Lists {
    /// Of a flora of whose species so many plants grow, in so much rain (mm/h).
    pub(super) fn new(gpu: &Gpu, flora: &Flora, plants: &[u32; SPECIES_LIMIT], rain_mm_per_h: f32) -> Self {
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
                let held = (INSTANCE_VERTICES / (2 * own_rows)).clamp(1, 64);
                let trembles = rain_mm_per_h > 0.0 && level < TREMBLING_LEVELS;
                of[list] = BrushList {
                    rows: [own_rows, held, baked.limb_count(), rows.len() as u32],
                    which: [limbs.len() as u32, places, u32::from(level + 1 == LEVELS), 0],
                    nodes: [nodes.angles as u32, nodes.loads as u32, steps.len() as u32, 0],
                    rain: [if trembles { drops_per_m2_s(rain_mm_per_h) } else { 0.0 }, 0.0, 0.0, 0.0],
                };
                places += own;
                let triangles = baked.indices(held);
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

    /// Blocks of rows that a plant of a species takes at its finest.
    pub(super) fn most_blocks(&self, species: usize) -> u32 {
        self.of[species * LEVELS].rows[0].div_ceil(super::BLOCK)
    }
}
