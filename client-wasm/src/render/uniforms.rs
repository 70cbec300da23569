//! The uniform block that all passes share; its twin is `Frame` in `common.wgsl`.

use bytemuck::{Pod, Zeroable};
use shared::plant::growth::SPECIES_LIMIT;

/// Most interaction spheres in a frame; those nearest to the camera are kept.
pub(super) const SPHERE_LIMIT: usize = 16;

/// Declares a uniform block with the names and offsets of its members, for the comparison with its WGSL twin.
macro_rules! uniform_block {
    ($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident: $type:ty,)* }) => {
        $(#[$doc])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, Pod, Zeroable)]
        pub(super) struct $name { $($(#[$field_doc])* pub(super) $field: $type,)* }

        impl $name {
            /// Names and byte offsets of the members.
            #[cfg(test)]
            pub(super) const LAYOUT: &'static [(&'static str, usize)] =
                &[$((stringify!($field), std::mem::offset_of!($name, $field)),)*];
        }
    };
}

uniform_block! {
    /// What every pass knows of a frame.
    Frame {
        /// World to clip space, reversed depth.
        projection_from_world: [f32; 16],
        /// Clip space to directions in the world; the sky's rays.
        world_from_projection: [f32; 16],
        /// World to the shadow map's clip space.
        shadow_from_world: [f32; 16],
        /// Camera position (m); time (s).
        eye: [f32; 4],
        /// Unit vector towards the sun; unused.
        sun: [f32; 4],
        /// Colour of sunlight; haze distance (m).
        sun_color: [f32; 4],
        /// Extent of the world along X and Z (m); distance between pixels of the height map (m).
        world: [f32; 4],
        /// Pixels of the height map along X and Z; side of the bend window (m); distance at which it ends (m).
        maps: [f32; 4],
        /// Extent of the wind's box (m); side of a patch (m) where each shows the box in its own place, else 0.
        wind_box: [f32; 4],
        /// Seed of the patches' places in the wind's box; 1 where the box repeats along X; along Z; number of lamps.
        tiling: [u32; 4],
        /// Unit vector of the mean wind (x, z); its speed (m/s); distance the gusts have travelled (m).
        gust: [f32; 4],
        /// Ages of the atlas's layers of the past (s), youngest first; number of the youngest, or −1 where none is kept.
        past: [f32; 4],
        /// Flowers per square metre; variation of the height of a blade; width of a blade (m); unused.
        blade: [f32; 4],
        /// Pixels of the picture along X and Y; angle of a pixel (rad); how much it rains, 0..1.
        screen: [f32; 4],
        /// Near blades fade out from (m), to (m); billboards end from (m), to (m).
        reach: [f32; 4],
        /// Leaf area over the ground below it, of blades of mean height as they stand near by; distance up to which they stand so (m); width of a blade (m); unused.
        sward: [f32; 4],
        /// Offset of the clouds (m, x and z); unused; number of interaction spheres.
        clouds: [f32; 4],
        /// Interaction spheres: centre and radius (m).
        spheres: [[f32; 4]; SPHERE_LIMIT],
        /// Light of sky and lamps.
        lights: Lights,
    }
}

/// Most lamps in a frame; those nearest to the camera are kept.
pub(super) const LAMP_LIMIT: usize = 16;

impl Frame {
    /// Whether any lamp is lit.
    pub(super) fn has_lamps(&self) -> bool {
        self.tiling[3] > 0
    }

    /// Whether there is any interaction sphere.
    pub(super) fn has_spheres(&self) -> bool {
        self.clouds[3] > 0.0
    }
}

uniform_block! {
    /// A lamp; its twin is in `light.wgsl`.
    Lamp {
        /// Where it is (m); distance at which it ends (m).
        place: [f32; 4],
        /// Light at 1 m; cosine at which its cone ends.
        rgb: [f32; 4],
        /// Unit vector along its cone; cosine up to which that is full.
        aim: [f32; 4],
        /// Constant, linear (1/m) and quadratic (1/m²) term; unused.
        attenuation: [f32; 4],
    }
}

uniform_block! {
    /// Light of sky and lamps, in the frame's block since Mesa 22's software Vulkan crashes on a third uniform buffer in a group; its twin is in
    /// `light.wgsl`.
    Lights {
        /// World to the clip space of the shadow map's coarse layer.
        far_shadow_from_world: [f32; 16],
        /// Light of sky and land on a surface, mean of up and down; unused.
        mean: [f32; 4],
        /// What it is more straight up; unused.
        up: [f32; 4],
        /// What it is more on a level normal towards the sun's heading; unused.
        toward_sun: [f32; 4],
        /// The night's own sky; brightness of stars.
        night: [f32; 4],
        /// Colour of sunlight at the height of clouds; unused.
        cloud_sun: [f32; 4],
        /// Unit vector on the ground towards the sun; unused.
        heading: [f32; 4],
        /// A sphere about all that the lamps reach: centre and radius (m), below zero where there are none.
        lit: [f32; 4],
        /// Mist on the lowest land (1/m); height over which it is 1/e as dense (m); elevation of that land (m); unused.
        mist: [f32; 4],
        /// Side of a texel and depth of the shadow map's sharp layer (m), and of its coarse one.
        shadow: [f32; 4],
        /// Those beyond the last lamp are zero.
        lamps: [Lamp; LAMP_LIMIT],
    }
}

/// Most kinds of grass: that of `[grass]` and 16 species.
pub(super) const KIND_LIMIT: usize = 17;

uniform_block! {
    /// One kind of grass; its twin is in `common.wgsl`.
    Kind {
        /// Colour at the root; mean height of a blade (m).
        root: [f32; 4],
        /// Colour at the tip; bend by a wind of 10 m/s (rad).
        tip: [f32; 4],
        /// Base speed of a bend (m/s) and its growth with the bending speed (m/rad); lag of the topmost segment (s); share of it while the grass rises.
        lag: [f32; 4],
        /// Segments; first natural frequency of a blade of mean height (rad/s); factors on how it droops of itself, and on its width.
        shape: [f32; 4],
    }
}

uniform_block! {
    /// All kinds of grass by their number; its twin is in `common.wgsl`.
    Kinds {
        /// Those beyond the last kind are zero.
        list: [Kind; KIND_LIMIT],
    }
}

uniform_block! {
    /// What the dust's passes know of its sprites; its twin is in `dust.wgsl`.
    Drift {
        /// Puffs, motes, unused.
        counts: [u32; 4],
        /// Side of the square about the camera that the puffs are in (m), and the motes; height up to which both are (m); time
        /// since the frame before (s).
        shape: [f32; 4],
    }
}

uniform_block! {
    /// What the compute passes know of the single plants; its twin is in `bend.wgsl`.
    Plants {
        /// Grid (x, z) in each of the nine slots; third: number of the frame in which it has moved in; fourth: plants of it that may stand.
        slots: [[i32; 4]; 9],
        /// Plants of a near grid; 1 to leave out what is not seen; 1 where blades narrower than a pixel are drawn as wide as they are; number of the frame, of
        /// those in which time passes or a grid moves in.
        counts: [u32; 4],
        /// Capacities of the lists of fine blades, of all others, and of flower heads; unused.
        capacities: [u32; 4],
        /// Side of a grid (m), distance of full density (m), distance up to which blades are fine (m), damping share of a blade.
        shape: [f32; 4],
        /// Steps of this frame; way of integration, as the constants of `blade.wgsl`; segments of a fine blade, and of a coarse one.
        steps: [u32; 4],
        /// Length of a step (s); lot of the first plant of a grid to be a flower, and the power with which that falls; least width that a blade is
        /// drawn with (px): 0 in the reference alone, where heads are no discs either.
        time: [f32; 4],
        /// Most that a plant reaches beyond its place (m); distance from which on heads thin out, and those left are larger (m); 1 where plants shrink away towards
        /// where the last ones end, 0 where they fade into what stands for far plants; unused.
        reach: [f32; 4],
    }
}

uniform_block! {
    /// What the pass that lists grass grids knows; its twin is in `grids.wgsl`.
    Squares {
        /// First grid of the square about the camera (x, z); grids along its side; 1 to leave out what is not seen.
        window: [i32; 4],
        /// Plants of a grid near the camera; most chunks of single plants; grids on each side of the camera's that are simulated; unused.
        counts: [u32; 4],
        /// Grids of the square that are listed: the first, and the first that is not; unused.
        turn: [u32; 4],
        /// Side of a grid (m), distance of full density (m), distance at which single plants end (m), how far plants reach beyond their grid (m).
        shape: [f32; 4],
        /// Size of a cell of the lowest land (m, X and Z); unused.
        cells: [f32; 4],
    }
}

uniform_block! {
    /// A list of blades or flowers as it is drawn; its twin is in `strip_list.wgsl`.
    StripList {
        /// First of the list, capacity, segments of a blade, number of the list.
        range: [u32; 4],
        /// 1 where those that follow lie after the first, −1 where before it; unused.
        order: [i32; 4],
    }
}

uniform_block! {
    /// What the shells' passes know; its twin is in `shells.wgsl`.
    ShellFrame {
        /// Segments of a blade; most slices between two layers; 1 where no single blades are drawn; samples of a pixel.
        counts: [u32; 4],
        /// Side of the texture on the ground (m); of its texels (m); its last level; least share of light at the roots.
        dots: [f32; 4],
    }
}

uniform_block! {
    /// What the compute pass of the underbrush knows; its twin is in `underbrush.wgsl`.
    UnderbrushFrame {
        /// Number of the frame, of those in which time passes; 1 to leave out what is not seen; plants and blocks of rows that there is room for.
        counts: [u32; 4],
        /// Time since the frame before (s); distance at which plants have shrunk to nothing (m); height of the force field (m); factor on the heights in the
        /// picture below which plants are coarser.
        shape: [f32; 4],
        /// Corner of the force field and its extent, X and Z (m).
        forces: [f32; 4],
        /// Of each species: height (m), time constant (s), how far it reaches from its root at most (m), unused.
        species: [[f32; 4]; SPECIES_LIMIT],
    }
}

uniform_block! {
    /// A species of underbrush at a level of detail; its twin is in `underbrush.wgsl`.
    BrushList {
        /// Rows of a plant; plants in an instance; components of a plant; first of its rows among those of all lists.
        rows: [u32; 4],
        /// First of its components among those of all lists; first of the listed plants; 1 if the nearest posture will do; unused.
        which: [u32; 4],
        /// Angles and loads of the tables; first of their steps among those of all lists; unused.
        nodes: [u32; 4],
        /// Drops of rain that make leaves tremble (1/(m²·s)); unused.
        rain: [f32; 4],
    }
}

uniform_block! {
    /// What the rain's pass knows; its twin is in `rain.wgsl`.
    Shower {
        /// Drops; unused.
        counts: [u32; 4],
        /// Side of the square that they are in, and its height (m); speed at which they fall (m/s); opacity.
        shape: [f32; 4],
    }
}

uniform_block! {
    /// A digit by which pairs are sorted; its twin is in `sort.wgsl`.
    SortDigit {
        /// Lowest bit of the digit; which counter says how many pairs there are; most pairs; unused.
        shape: [u32; 4],
    }
}

uniform_block! {
    /// What the passes that order blades know; its twin is in `order.wgsl`.
    Ordering {
        /// Capacities of the lists of fine blades and of all others; 1 for the orders made beforehand; unused.
        lists: [u32; 4],
        /// The camera's grid (x, z); unused.
        home: [i32; 4],
        /// Side of a grid (m); unused.
        shape: [f32; 4],
    }
}
