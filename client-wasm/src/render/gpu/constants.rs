//! Constants shared by shaders and Rust. A WGSL file imports them from `package::constants`, where they have the values declared here.

use std::fmt;

use super::flower_kinds;
use glam::Vec3;
use prairie_core::light::snow;
use prairie_core::lod;
use prairie_core::plant::blade::{self, Integrator, deflection};
use prairie_core::plant::tree::statics;
use prairie_core::plant::underbrush::{drops, posture, spline};

pub(crate) use super::flower_kinds::{
    FLOWER_BASE_RGB, FLOWER_DISC_M, FLOWER_DISC_RGB, FLOWER_PETAL_M, FLOWER_PETAL_WIDTH, FLOWER_PETALS, FLOWER_RISE_RAD, FLOWER_SQUARE,
    FLOWER_TIP_RGB, PETAL_ACROSS, PETAL_ALONG, PETAL_FLATTENS,
};
pub(crate) use prairie_core::bend::BEND_SATURATES_M_PER_S;
pub(crate) use prairie_core::hash::{HASH_INCREMENT, HASH_MULTIPLIER, UNIT_STEPS};
pub(crate) use prairie_core::light::air::HAZE_FORWARD;
pub(crate) use prairie_core::light::grass::{LEAF_EXTINCTION, LEAST_SUN_SINE};
pub(crate) use prairie_core::light::lamp::LEAST_LAMP_DISTANCE_M;
pub(crate) use prairie_core::light::shade::{
    BARE_PLACES, BARE_WEIGHTS, FLAT_RAD, LEAF_CLUMPING, LEAF_TOP, RESTING_RAD, SHADE_FIRST, SHADE_RATIO, SHADE_STEPS, THIRD_AREAS,
};
pub(crate) use prairie_core::plant::blade::backbone::{LACK_RANGE, LARGEST_BULGE, LEAST_GROWTH, RIGHT_ANGLE_LACK, SPARE};
pub(crate) use prairie_core::plant::blade::contact::CLEARANCE_M;
pub(crate) use prairie_core::plant::blade::deflection::{DRAG_LEANS, LAID_RAD4, LOST_PER_RAD2, WIND_SHAPE};
pub(crate) use prairie_core::plant::blade::lean::{ARCTANGENT, COSINE, HANGING_RAD2, SINC};
pub(crate) use prairie_core::plant::blade::modes::{AMPLITUDES, BRAKES, FREQUENCIES, MODES};
pub(crate) use prairie_core::plant::force_field::AIR_KG_PER_M3;
pub(crate) use prairie_core::scene::{GROWTH_BY_COVER, GROWTH_BY_MEADOW, GROWTH_BY_SOIL, GROWTH_BY_TUFT};
pub(crate) use prairie_core::wind::{FREE_WIND_M, LEAST_WIND_HEIGHT};
pub(crate) use std::f32::consts::{FRAC_PI_2 as RIGHT_ANGLE, TAU};

/// Gravitational acceleration (m/s²).
pub(crate) const GRAVITY_M_PER_S2: f32 = prairie_core::GRAVITY_M_PER_S2 as f32;
/// Weights of linear red, green and blue in luminance.
pub(crate) const LUMINANCE: Vec3 = Vec3::from_array(prairie_core::light::LUMINANCE);

/// Albedo of fresh snow, and of packed snow.
pub(crate) const SNOW_ALBEDO: Vec3 = Vec3::from_array(snow::SNOW_ALBEDO);
pub(crate) const PACKED_SNOW_ALBEDO: Vec3 = Vec3::from_array(snow::PACKED_SNOW_ALBEDO);

/// Invocations per workgroup of the compute passes.
pub(crate) const WORKGROUP_SIZE: u32 = 64;

// --- horizon ---

/// Samples of the horizon along a ray.
pub(crate) const HORIZON_SAMPLES: u32 = 24;
/// Maximum depth of the drawn land below the height map near the eye (m), and its growth with distance (m/m), since tiles get coarser.
pub(crate) const DRAWN_LOWER_M: f32 = 0.3;
pub(crate) const DRAWN_LOWER: f32 = 0.004;

// --- depth pyramid ---

/// Maximum number of cells along a side of the finest level of the depth pyramid; a power of two.
pub(crate) const PYRAMID_SIDE: u32 = 256;
/// Levels above the finest.
pub(crate) const PYRAMID_LEVELS: u32 = PYRAMID_SIDE.ilog2();
/// Minimum side of a cell of the finest level (px).
pub(crate) const PYRAMID_CELL_PX: u32 = 4;

// --- dust ---

/// Cells of the wind domain among which puffs choose where to start.
pub(crate) const DUSTY_CELLS: u32 = 1024;
/// Concentration of dust from which on puffs get denser instead of more.
pub(crate) const FULL_PUFFS_DUST: f32 = 1.5;

// --- bend field ---

/// Mip levels of the bend atlas. The side of a patch is a multiple of 8 cells, so that no level mixes two patches.
pub(crate) const BEND_ATLAS_LEVELS: u32 = 4;
/// Earlier states of the bend field in the atlas.
pub(crate) const PASTS: i32 = lod::PASTS as i32;

// --- shade of the sward ---

/// Maps of the shade: one near the camera, and a coarser one that reaches farther.
pub(crate) const SHADE_MAPS: u32 = SHADE_CELL_M.len() as u32;
/// Cells along a side of a map of the shade, and in all of a map.
pub(crate) const SHADE_PX: u32 = 160;
pub(crate) const SHADE_CELLS: u32 = SHADE_PX * SHADE_PX;
/// Sides of the cells of the maps (m); those of the first are as large as the bend field's.
pub(crate) const SHADE_CELL_M: [f32; 2] = [0.25, 1.0];

// --- blades and flowers ---

/// Links of a blade.
pub(crate) const LINKS: i32 = blade::LINKS as i32;
/// Leans of a blade's links per unit of drag, as vectors.
pub(crate) const MEAN_LEAN: Vec3 = Vec3::from_array(deflection::MEAN_LEAN);
pub(crate) const EXCESS_LEAN: Vec3 = Vec3::from_array(deflection::EXCESS_LEAN);
/// Changes of the leans of its links as it lies down, as vectors.
pub(crate) const LAID_LEANS: Vec3 = Vec3::from_array(deflection::LAID_LEANS);
pub(crate) const LOST_LEANS: Vec3 = Vec3::from_array(deflection::LOST_LEANS);
/// Codes of the integrators.
pub(crate) const EULER: u32 = Integrator::Euler as u32;
pub(crate) const VERLET: u32 = Integrator::Verlet as u32;
/// Simulated grids around the camera.
pub(crate) const NEAR_SLOTS: u32 = 9;
/// Maximum displacement of a plant by its tuft, also across the border of its grid (m).
pub(crate) const TUFT_REACH_M: f32 = 0.5;
/// Distance below which the density of plants no longer grows (m).
pub(crate) const LEAST_DENSITY_DISTANCE_M: f32 = 0.01;
/// Words of the arguments of an indirect dispatch, padded, before those of draws in the same buffer.
pub(crate) const DISPATCH_WORDS: u32 = 4;
/// Words of the arguments of an indirect draw.
pub(crate) const DRAW_WORDS: u32 = 5;
/// Plants in one instance of an indirect draw, and in one workgroup.
pub(crate) const CHUNK: u32 = WORKGROUP_SIZE;
/// Lists of single plants: fine blades, coarse ones, those of one segment, near flower heads, far ones.
pub(crate) const FINE_LIST: u32 = 0;
pub(crate) const COARSE_LIST: u32 = 1;
pub(crate) const SINGLE_LIST: u32 = 2;
pub(crate) const HEAD_LIST: u32 = 3;
pub(crate) const FAR_HEAD_LIST: u32 = 4;
pub(crate) const PLANT_LISTS: u32 = 5;
/// Relative jitter (±) of the maximum distance of fine blades, so that blades do not change in a visible ring.
pub(crate) const FINE_SPREAD: f32 = 0.15;
/// Shapes in the texture of blades, side by side.
pub(crate) const BLADE_SHAPES: u32 = 5;
/// Maximum number of petals of a flower head, and vertices of a petal.
pub(crate) const PETALS: u32 = 12;
pub(crate) const PETAL_VERTICES: u32 = PETAL_ALONG.len() as u32;
/// Vertices of the disc of a flower head: its centre, then its rim.
pub(crate) const DISC_VERTICES: u32 = 7;
/// Vertices of a flower head: petals, then the disc.
pub(crate) const HEAD_VERTICES: u32 = PETALS * PETAL_VERTICES + DISC_VERTICES;
/// Kinds of flowers, and vertices of the square of a textured one.
pub(crate) const FLOWER_KINDS: u32 = flower_kinds::FLOWER_KINDS as u32;
pub(crate) const SQUARE_VERTICES: u32 = 4;
/// Cells along the side of a grid whose order is precomputed.
pub(crate) const ORDER_CELLS: u32 = 64;

// --- clumps and shells ---

/// Clumps in one instance.
pub(crate) const CLUMPS: u32 = 32;
/// Plants that a clump joins: one on its axis and one at the outer end of each of its six rectangles.
pub(crate) const CLUMP_PLANTS: u32 = 7;
/// Half the range of distances (m) over which clumps fade in.
pub(crate) const CLUMP_FADE_SPREAD_M: f32 = 1.0;
/// Mean radius of the blades on the texture of shells (px).
pub(crate) const SHELL_BLADE_PX: f32 = 2.1;

// --- map of the grids ---

/// States of a grid beyond the near ones: beyond the reach of single plants, outside the view, behind hills, shown.
pub(crate) const GRID_BEYOND: u32 = 0;
pub(crate) const GRID_OUTSIDE: u32 = 1;
pub(crate) const GRID_HIDDEN: u32 = 2;
pub(crate) const GRID_SHOWN: u32 = 3;
/// Codes of a near grid outside the view, and of one in it. Codes of other grids are the numbers of plants along a side of their clumps, at least
/// `FEWEST_CLUMP_PLANTS`, or 0 without clumps.
pub(crate) const NEAR_CULLED: u32 = 1;
pub(crate) const NEAR_SHOWN: u32 = 2;
/// Plants along a side of the nearest clumps.
pub(crate) const FEWEST_CLUMP_PLANTS: u32 = 3;
/// Added to the code of a grid of clumps outside the view; more than the plants along a side of any clump.
pub(crate) const CLUMPS_CULLED: u32 = 1 << 16;
/// Classes of the legend, and the code of a grid without one.
pub(crate) const GRID_CLASSES: u32 = 8;
pub(crate) const NO_CLASS: u32 = 0xff;
/// Size of a glyph of the legend, distance between two of them, and between two lines (px).
pub(crate) const GLYPH_WIDTH: u32 = 3;
pub(crate) const GLYPH_HEIGHT: u32 = 5;
pub(crate) const GLYPH_PITCH: u32 = 4;
pub(crate) const LEGEND_LINE: u32 = 7;
/// Digits of the numbers of grids, and characters of a line of the legend.
pub(crate) const LEGEND_DIGITS: u32 = 6;
pub(crate) const LEGEND_CHARACTERS: u32 = 17;

// --- underbrush ---

/// Plant variants of each species.
pub(crate) const VARIANTS: u32 = 4;
/// Levels of detail of a species.
pub(crate) const UNDERBRUSH_LEVELS: u32 = 4;
/// Lists of plants: one for each species and level.
pub(crate) const UNDERBRUSH_LISTS: u32 = prairie_core::plant::growth::SPECIES_LIMIT as u32 * UNDERBRUSH_LEVELS;
/// Rows per allocation block of a plant.
pub(crate) const BLOCK_ROWS: u32 = 8;
/// One in this number of blocks is a reserve for plants that found no room at their own level.
pub(crate) const SPARE_DIVISOR: u32 = 4;
/// Minimum fraction of plants kept when they are only a few pixels tall.
pub(crate) const MIN_KEPT_FRACTION: f32 = 0.06;
/// Exponent of the kept fraction in the enlargement of the plants.
pub(crate) const ENLARGEMENT_EXPONENT: f32 = -0.3;
/// Pressure (Pa) that bends a fallen plant.
pub(crate) const FALL_PA: f32 = 8.0;
/// Unit of half-widths (m).
pub(crate) const WIDTH_UNIT_M: f32 = 1.0 / 16_384.0;
/// Materials of a row; leaves are 0.
pub(crate) const STALK: u32 = 1;
pub(crate) const PETAL: u32 = 2;
pub(crate) const MIDDLE_LOAD: f32 = posture::MIDDLE_LOAD;
pub(crate) const ARC_COSINE: [f32; 4] = posture::ARC_COSINE;
pub(crate) const DROP_M_PER_S: f32 = drops::DROP_M_PER_S;
/// Height of a plant (px) above which every section is drawn, and from which sections bend into curves and veins appear; and the factor on it from
/// which on they do so fully.
pub(crate) const CLOSE_PX: f32 = 300.0;
pub(crate) const FULLY_CLOSE: f32 = 1.5;
/// Straight parts of the curve of a section. From a section of length h that turns by θ they are h·θ/(8·6²) away: 0.2 px for 330 px and 10 degrees.
pub(crate) const CURVE_PARTS: u32 = 6;
pub(crate) const TANGENT_DEPARTURE: f32 = spline::TANGENT_DEPARTURE;
/// Marks of the first and the last row of a ribbon.
pub(crate) const FIRST_ROW: u32 = 1;
pub(crate) const LAST_ROW: u32 = 2;
/// Kinds of veins of a ribbon: side veins of a midrib, veins along it, and the streaks of a petal; others have none.
pub(crate) const PINNATE: u32 = 1;
pub(crate) const PARALLEL: u32 = 2;
pub(crate) const STREAKED: u32 = 3;

// --- ground, objects and sorting ---

/// Range of the heights of the hills beyond the edge of the world (m).
pub(crate) const HILLS_RANGE_M: f32 = 150.0;
/// Mean height of these hills, relative to the range.
pub(crate) const HILLS_MEAN: f32 = 0.42;
/// Slope of the land away from the edge.
pub(crate) const HILLS_SLOPE: f32 = 0.006;
/// Distance from the edge at which the hills reach their full height (m).
pub(crate) const HILLS_FULL_M: f32 = 900.0;
/// Cells along one side of a ground tile, and vertices of the tile.
pub(crate) const TILE_CELLS: u32 = 16;
pub(crate) const TILE_VERTICES: u32 = (TILE_CELLS + 1).pow(2);
/// Distance at which coarser tiles take over, relative to the side of a tile: at least 2√2, so that neighbours differ by at most one level.
pub(crate) const RANGE_SIDES: f32 = 2.84;
/// Least distance of a tile, in spacings of its vertices.
pub(crate) const TILE_SPACINGS: f32 = 0.5 * RANGE_SIDES * TILE_CELLS as f32;
/// Headings and rings of the dome of the sky.
pub(crate) const SKY_HEADINGS: u32 = 64;
pub(crate) const SKY_RINGS: u32 = 26;
/// Codes of the border of a tile with a coarser neighbour, and with finer ones.
pub(crate) const COARSER: u32 = 1;
pub(crate) const FINER: u32 = 2;
/// Ranges of the coarse and the fine displacement of the borders of kinds of grass, relative to the pixels of their map.
pub(crate) const RAGGED: [f32; 2] = [1.7, 0.8];
/// Least and greatest size of these pixels to which displacements are relative (m).
pub(crate) const RAGGED_PX_M: [f32; 2] = [1.0, 5.0];
/// Distance up to which litter on the ground is resolved (m).
pub(crate) const LITTER_END_M: f32 = 2.5;
/// Straight sections of a component of a tree, and angles and loads of its table of postures.
pub(crate) const TREE_SECTIONS: u32 = statics::SECTIONS as u32;
pub(crate) const TREE_ANGLES: u32 = statics::NODES.angles as u32;
pub(crate) const TREE_LOADS: u32 = statics::NODES.loads as u32;
/// First bent component of an instance that has none.
pub(crate) const NO_LIMBS: u32 = u32::MAX;
/// Maximum number of instances of solids in a frame.
pub(crate) const INSTANCE_LIMIT: u32 = 12_288;
/// Maximum number of meshes with instances in a frame.
pub(crate) const MESH_LIMIT: u32 = 512;
/// Pressure that turns the leaves of a tree of components by an eighth of a turn, if it blows across them (Pa): that of a wind of 20 m/s.
pub(crate) const LEAF_STIFFNESS_PA: f32 = 240.0;
/// Maximum flutter of tree leaves (m along X).
pub(crate) const FLUTTER_M: f32 = 0.035;
/// Pairs per tile of a sort.
pub(crate) const SORT_TILE: u32 = 1024;
/// Number of values of a digit of a sort.
pub(crate) const DIGITS: u32 = 256;

/// Value that can be declared as a constant in WGSL.
pub(crate) trait Constant: fmt::Debug + Sync {
    /// WGSL declaration of a constant of that name.
    fn declaration(&self, name: &str) -> String;
}

macro_rules! constants {
    ($($type:ident)*) => {
        $(impl Constant for $type {
            fn declaration(&self, name: &str) -> String {
                format!("const {name}: {} = {self:?};", stringify!($type))
            }
        })*
    };
}

constants! { f32 u32 i32 }

impl Constant for f64 {
    fn declaration(&self, name: &str) -> String {
        format!("const {name}: f32 = {self:?};")
    }
}

impl Constant for Vec3 {
    fn declaration(&self, name: &str) -> String {
        format!("const {name} = vec3<f32>({});", listed(&self.to_array()))
    }
}

impl<const N: usize> Constant for [f32; N] {
    fn declaration(&self, name: &str) -> String {
        format!("const {name} = array<f32, {N}>({});", listed(self))
    }
}

impl<const N: usize> Constant for [[f32; 3]; N] {
    fn declaration(&self, name: &str) -> String {
        let rows: Vec<_> = self.iter().map(|row| format!("vec3<f32>({})", listed(row))).collect();
        format!("const {name} = array<vec3<f32>, {N}>({});", rows.join(", "))
    }
}

fn listed(values: &[f32]) -> String {
    values.iter().map(|value| format!("{value:?}")).collect::<Vec<_>>().join(", ")
}
