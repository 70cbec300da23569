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
        /// Unit vector towards the sun; 1 / size of the shadow map (1/px).
        sun: [f32; 4],
        /// Colour of sunlight; haze distance (m).
        sun_color: [f32; 4],
        /// Extent of the world along X and Z (m); distance between pixels of the height map (m).
        world: [f32; 4],
        /// Pixels of the height map along X and Z; side of the bend window (m); distance at which it ends (m).
        maps: [f32; 4],
        /// Extent of the wind's box (m); side of a patch (m) where each shows the box in its own place, else 0.
        wind_box: [f32; 4],
        /// Seed of the patches' places in the wind's box; 1 where the box repeats along X; along Z; unused.
        tiling: [u32; 4],
        /// Unit vector of the mean wind (x, z); its speed (m/s); distance the gusts have travelled (m).
        gust: [f32; 4],
        /// Ages of the atlas's layers of the past (s), youngest first; number of the youngest, or −1 where none is kept.
        past: [f32; 4],
        /// Flowers per square metre; variation of the height of a blade; width of a blade (m); 1 where blades have textured shapes.
        blade: [f32; 4],
        /// Pixels of the picture along X and Y; angle of a pixel (rad); how much it rains, 0..1.
        screen: [f32; 4],
        /// Near blades fade out from (m), to (m); billboards end from (m), to (m).
        reach: [f32; 4],
        /// Offset of the clouds (m, x and z); share of cloud; number of interaction spheres.
        clouds: [f32; 4],
        /// Interaction spheres: centre and radius (m).
        spheres: [[f32; 4]; SPHERE_LIMIT],
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
        /// Grid (x, z) in each of the nine slots; third: 1 when it has just moved in.
        slots: [[i32; 4]; 9],
        /// Plants of a near grid, unused, grids farther away, their plants.
        counts: [u32; 4],
        /// Capacities of the lists of fine blades, coarse blades and flowers.
        capacities: [u32; 4],
        /// Side of a grid (m), distance of full density (m), distance up to which blades are fine (m), damping share of a blade.
        shape: [f32; 4],
        /// Steps of this frame; way of integration, as the constants of `blade.wgsl`; segments of a fine blade, and of a coarse one.
        steps: [u32; 4],
        /// Length of a step (s); share of flowers among the plants; unused.
        time: [f32; 4],
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
        /// Number of the frame; unused.
        counts: [u32; 4],
        /// Time since the frame before (s); distance at which plants have shrunk to nothing (m); height of the force field (m); unused.
        shape: [f32; 4],
        /// Corner of the force field and its extent, X and Z (m).
        forces: [f32; 4],
        /// Of each species: height (m), time constant (s), how far it reaches from its root at most (m), unused.
        species: [[f32; 4]; SPECIES_LIMIT],
        /// First place of the species among the listed plants, places of each of its levels, unused.
        places: [[u32; 4]; SPECIES_LIMIT],
    }
}

uniform_block! {
    /// A species of underbrush at a level of detail, as it is drawn; its twin is in `underbrush.wgsl`.
    BrushList {
        /// Rows of a plant; plants in an instance; components of a plant; unused.
        rows: [u32; 4],
        /// Number of the list; first of the listed plants; 1 if the nearest posture will do; unused.
        which: [u32; 4],
        /// Angles and loads of the tables; unused.
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
