//! Sizes that the files of the underbrush share with its shaders.

use crate::render::gpu::constants::UNDERBRUSH_LISTS;
pub(super) use crate::render::gpu::constants::{BLOCK_ROWS as BLOCK, CHUNK};

/// Number of draw lists, one per species and level of detail.
pub(super) const LISTS: usize = UNDERBRUSH_LISTS as usize;
/// Maximum number of workgroups per dispatch that every device allows; the last rows of further plants are left out.
pub(super) const CHUNKS_LIMIT: usize = 65_535;
/// Bytes of the forces on a plant, of its posture and of the borders of a row in `underbrush.wgsl` and `ribbons.wgsl`.
pub(super) const RESPONSE_BYTES: u64 = 32;
pub(crate) const VISIBLE_PLANT_BYTES: u64 = 128;
pub(crate) const ROW_BYTES: u64 = 64;
/// Bytes of the lengths of all lists and of the numbers of requested blocks.
pub(super) const COUNTER_BYTES: usize = (LISTS + 2) * 4;
