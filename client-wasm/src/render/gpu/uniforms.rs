//! Uniform blocks of the passes. WGSL files import them from `package::uniforms`, with the layout declared here.

use crate::render::gpu::constants::{NEAR_SLOTS, UNDERBRUSH_LISTS};
use crate::render::gpu::uniform_block::uniform_block;
use prairie_core::plant::growth::SPECIES_LIMIT;
use prairie_core::wind::turbulence::WAVES;

/// Maximum number of interaction spheres in a frame; those nearest to the camera are kept.
pub(crate) const SPHERE_LIMIT: usize = 16;
/// Maximum number of slabs in a frame; those nearest to the camera are kept.
pub(crate) const SLAB_LIMIT: usize = 8;
/// Maximum number of corners of the slabs' outline.
pub(crate) const CORNER_LIMIT: usize = 64;
/// Maximum number of lamps in a frame; those nearest to the camera are kept.
pub(crate) const LAMP_LIMIT: usize = 16;
/// Maximum number of grass kinds: that of `[grass]` and 16 species.
pub(crate) const KIND_LIMIT: usize = 17;

uniform_block! {
    /// Camera, light and scene, for all passes.
    Frame {
        /// World to clip space, reversed depth.
        projection_from_world: [f32; 16],
        /// World to the clip space of the shadow map's sharp layer.
        shadow_from_world: [f32; 16],
        /// Camera position (m).
        eye_m: [f32; 3],
        /// Time (s).
        time_secs: f32,
        /// Unit vector towards the sun.
        toward_sun: [f32; 3],
        /// How overcast the sky is by rain, 0..1.
        overcast: f32,
        /// Colour of sunlight.
        sun_rgb: [f32; 3],
        /// Distance over which haze leaves 1/e of the light (m).
        haze_distance_m: f32,
        /// Extent of the world along X and Z (m).
        world_extent_m: [f32; 2],
        /// Distance between pixels of the height map along X and Z (m).
        height_spacing_m: [f32; 2],
        /// Pixels of the height map along X and Z.
        heights_px: [f32; 2],
        /// Side of the bend window (m).
        bend_window_m: f32,
        /// Distance at which the bend atlas ends (m).
        bend_reach_m: f32,
        /// Extent of the wind domain (m).
        wind_box_m: [f32; 3],
        /// Side of a patch (m) if each patch shifts the wind domain by its own offset, else 0.
        wind_patch_m: f32,
        /// 1 if the wind domain repeats along X, and along Z.
        wind_repeats: [u32; 2],
        /// Seed of the patches' offsets.
        patch_seed: u32,
        /// Lamps in the frame.
        lamp_count: u32,
        /// Unit vector of the mean wind (X and Z).
        wind_direction: [f32; 2],
        /// Speed of the mean wind (m/s).
        mean_wind_m_per_s: f32,
        /// Number of waves of the gusts.
        gust_count: u32,
        /// Ages of the atlas's past layers (s), youngest first.
        past_ages_secs: [f32; 3],
        /// Index of the youngest of these layers, or -1 if none is kept.
        youngest_past: f32,
        /// Pixels of the picture along X and Y.
        screen_px: [f32; 2],
        /// Angle subtended by a pixel (rad).
        pixel_rad: f32,
        /// Flowers per square metre.
        flowers_per_m2: f32,
        /// Relative variation of the height of a blade.
        height_variation: f32,
        /// Width of a blade (m).
        blade_width_m: f32,
        /// Leaf area index (leaf area per ground area) of blades of mean height at full density.
        leaf_area: f32,
        /// Maximum distance of plants at full density (m).
        full_density_m: f32,
        /// Distances at which near blades begin to fade out, and end (m).
        blades_fade_from_m: f32,
        blades_end_m: f32,
        /// Distances at which clumps and shells begin to fade out, and end (m).
        far_fade_from_m: f32,
        far_end_m: f32,
        /// Offset of the clouds along X and Z (m).
        cloud_offset_m: [f32; 2],
        /// Interaction spheres in the frame.
        sphere_count: u32,
        /// Repetitions of the repeated patch in a metre; 0 if there is none.
        repeated_per_m: f32,
        /// Position (m) that trees must not hide.
        target_m: [f32; 3],
        /// Radius around the line from the eye to it within which trees fade (m); 0 if there is none.
        fade_m: f32,
        /// Corners of the near and the far map of the shade that grass casts (m).
        shade_corner_m: [f32; 2],
        shade_far_corner_m: [f32; 2],
        /// 1 if grass casts shadows, else 0.
        shade_strength: f32,
        /// Height above the ground that no grass exceeds (m).
        shade_top_m: f32,
        /// Optical depth of an even sward of the first kind towards the sun.
        shade_extinction: f32,
        /// Depth of undisturbed snow (m).
        snow_m: f32,
        /// Mass of snow on leaves, relative to their own.
        snow_load: f32,
        /// Snow on the leaves of trees, as a fraction of the most that they bear.
        crown_snow: f32,
        _pad: [u8; 8],
        /// Interaction spheres; unused entries are zero.
        spheres: [Sphere; SPHERE_LIMIT],
        /// Slabs.
        slabs: Slabs,
        /// Waves of the gusts; unused entries are zero.
        gusts: [GustWave; WAVES],
        /// Light of sky and lamps.
        lights: Lights,
    }
}

impl Frame {
    /// Whether any lamp is lit.
    pub(crate) fn has_lamps(&self) -> bool {
        self.lamp_count > 0
    }

    /// Whether there is any interaction sphere or slab.
    pub(crate) fn has_spheres(&self) -> bool {
        self.sphere_count + self.slabs.count > 0
    }

    /// Whether stars are visible, and whether rain clouds are.
    pub(crate) fn sky_shows(&self) -> [bool; 2] {
        [self.lights.star_brightness > 0.0 && self.overcast < 1.0, self.overcast > 0.0]
    }
}

uniform_block! {
    /// Wave of the gusts, of velocity `strength · cos(τ(per_m · p + phase))` times `per_m` turned by a right angle.
    GustWave {
        /// Wave vector along X and Z (turns per metre).
        per_m: [f32; 2],
        /// Phase (turns).
        phase: f32,
        /// Amplitude over the length of the wave vector.
        strength: f32,
    }
}

uniform_block! {
    /// Interaction sphere.
    Sphere {
        /// Centre (m).
        centre_m: [f32; 3],
        /// Radius (m).
        radius_m: f32,
    }
}

uniform_block! {
    /// Slabs, and the outline that all of them have; unused entries are zero.
    Slabs {
        /// Slabs.
        list: [Slab; SLAB_LIMIT],
        /// Corners of the outline, in order.
        outline: [Corner; CORNER_LIMIT],
        /// Slabs in the frame, and corners of their outline.
        count: u32,
        corner_count: u32,
        _pad: [u8; 8],
    }
}

uniform_block! {
    /// Upright prism of the outline, under which blades lie.
    Slab {
        /// Centre (m).
        centre_m: [f32; 3],
        /// Half its height (m).
        half_height_m: f32,
        /// Unit vector to its right.
        right: [f32; 3],
        /// Distance of its farthest point from the centre (m).
        reach_m: f32,
        /// Unit vector to its back.
        back: [f32; 3],
        _pad: [u8; 4],
    }
}

uniform_block! {
    /// Corner of an outline seen from above.
    Corner {
        /// Distance to the right and to the back of the centre (m).
        at_m: [f32; 2],
        _pad: [u8; 8],
    }
}

uniform_block! {
    /// A lamp.
    Lamp {
        /// Position (m).
        position_m: [f32; 3],
        /// Distance at which its light ends (m).
        reach_m: f32,
        /// Light at 1 m.
        rgb: [f32; 3],
        /// Cosine of the angle from the cone's axis at which its light ends.
        edge_cosine: f32,
        /// Unit vector along the axis of its cone.
        direction: [f32; 3],
        /// Cosine of the angle from the axis up to which its light is full.
        full_cosine: f32,
        /// Constant, linear (1/m) and quadratic (1/m²) term.
        attenuation: [f32; 3],
        _pad: [u8; 4],
    }
}

uniform_block! {
    /// Light of sky and lamps. It is in the frame's block, since Mesa 22's software Vulkan crashes on a third uniform buffer in a group.
    Lights {
        /// World to the clip space of the shadow map's coarse layer.
        far_shadow_from_world: [f32; 16],
        /// Light of sky and land on a surface, mean of up and down.
        mean_rgb: [f32; 3],
        /// Brightness of stars.
        star_brightness: f32,
        /// Additional light on a normal straight up.
        up_rgb: [f32; 3],
        /// Density of mist on the lowest land (1/m).
        mist_per_m: f32,
        /// Additional light on a level normal towards the sun's heading.
        toward_sun_rgb: [f32; 3],
        /// Height over which mist thins out to 1/e (m).
        mist_height_m: f32,
        /// Light of the night sky.
        night_rgb: [f32; 3],
        /// Elevation of the lowest land (m).
        mist_ground_m: f32,
        /// Colour of sunlight at the height of clouds.
        cloud_sun_rgb: [f32; 3],
        _pad: [u8; 4],
        /// Unit vector on the ground towards the sun.
        sun_heading: [f32; 2],
        /// Texel size and depth of the shadow map's sharp layer, then of its coarse one (m).
        near_texel_m: f32,
        near_depth_m: f32,
        far_texel_m: f32,
        far_depth_m: f32,
        _pad_2: [u8; 8],
        /// Sphere around everything that the lamps reach: centre and radius (m). The radius is negative without lamps.
        lit_centre_m: [f32; 3],
        lit_radius_m: f32,
        /// Lamps; unused entries are zero.
        lamps: [Lamp; LAMP_LIMIT],
    }
}

uniform_block! {
    /// A kind of grass.
    Kind {
        /// Colour at the root.
        root_rgb: [f32; 3],
        /// Mean height of a blade (m).
        height_m: f32,
        /// Colour at the tip.
        tip_rgb: [f32; 3],
        /// Bend by a wind of 10 m/s (rad).
        wind_bend_rad: f32,
        /// Base speed at which a bend travels (m/s), and its growth with the bending speed (m/rad).
        bend_m_per_s: f32,
        bend_m_per_rad: f32,
        /// Lag of the topmost segment (s), and the fraction of it while the grass recovers.
        lag_secs: f32,
        rising_lag: f32,
        /// Number of segments.
        segments: f32,
        /// First natural frequency of a blade of mean height (rad/s).
        frequency_rad_per_s: f32,
        /// Factors on its droop by its own weight, and on its width.
        droop: f32,
        width: f32,
    }
}

uniform_block! {
    /// All kinds of grass by index.
    Kinds {
        /// Kinds; unused entries are zero.
        list: [Kind; KIND_LIMIT],
    }
}

uniform_block! {
    /// Settings of the dust passes.
    Drift {
        /// Number of puffs, and of motes.
        puffs: u32,
        motes: u32,
        /// Side of the square around the camera over which the puffs spread where the wind domain is smaller, and of the square that contains the motes (m).
        puff_square_m: f32,
        mote_square_m: f32,
        /// Maximum height of motes (m).
        top_m: f32,
        /// Time since the previous frame (s).
        step_secs: f32,
        /// Air that a puff stands for (m³); 0 in clear air.
        puff_m3: f32,
        _pad: [u8; 4],
    }
}

uniform_block! {
    /// A simulated grid of plants.
    GridSlot {
        /// Position in the plane of grids (x, z).
        grid: [i32; 2],
        /// Number of the frame in which the grid became near.
        moved_in: u32,
        /// Number of plants at its density; 0 if out of view.
        plants: u32,
    }
}

uniform_block! {
    /// Settings of the compute passes of single plants.
    Plants {
        /// Simulated grids around the camera.
        slots: [GridSlot; NEAR_SLOTS as usize],
        /// Plants per near grid.
        grid_plants: u32,
        /// 1 to cull plants outside the view.
        culls: u32,
        /// 1 if blades are drawn in order: those narrower than a pixel keep their width.
        is_ordered: u32,
        /// Frame number; counts frames in which time advances or a grid moves in.
        frame_number: u32,
        /// Capacities of the lists of fine blades, of all others, and of flower heads.
        fine_capacity: u32,
        other_capacity: u32,
        head_capacity: u32,
        /// Number of integration steps in this frame.
        step_count: u32,
        /// Integrator: `EULER`, `VERLET`, or exact.
        integrator: u32,
        /// Segments of a fine blade, and of a coarse one.
        fine_segments: u32,
        coarse_segments: u32,
        /// Side of a grid (m).
        grid_m: f32,
        /// Distance of full density (m).
        full_density_m: f32,
        /// Maximum distance of fine blades (m).
        fine_m: f32,
        /// Damping ratio of a blade.
        damping_ratio: f32,
        /// Length of a step (s).
        step_secs: f32,
        /// Probability that the first plant of a grid is a flower.
        first_flower: f32,
        /// Exponent of that probability along the sequence of the grid's plants.
        flower_power: f32,
        /// Minimum width of a drawn blade (px); 0 only in the reference, which does not draw heads as discs either.
        thinnest_px: f32,
        /// Maximum distance of a part of a plant from its position (m).
        plant_reach_m: f32,
        /// Distance from which heads thin out and the remaining ones are larger (m).
        heads_thin_m: f32,
        /// 1 if plants shrink towards the maximum distance, 0 if they fade into the representation of far plants.
        shrinks: f32,
        _pad: [u8; 8],
    }
}

uniform_block! {
    /// Settings of the pass that lists grass grids.
    Squares {
        /// First grid of the square around the camera (x, z).
        first_grid: [i32; 2],
        /// Grids along its side.
        side: i32,
        /// 1 to cull grids outside the view.
        culls: i32,
        /// Plants per grid near the camera.
        grid_plants: u32,
        /// Maximum number of chunks of single plants.
        chunk_limit: u32,
        /// Grids on each side of the camera's that are simulated.
        near_grids: u32,
        /// Listed grids of the square: index of the first, and one past the last.
        first: u32,
        end: u32,
        /// Side of a grid (m).
        grid_m: f32,
        /// Distance of full density (m).
        full_density_m: f32,
        /// Distance at which single plants end (m).
        reach_m: f32,
        /// Size of a cell of the grid of minimum ground heights along X and Z (m).
        lowest_cell_m: [f32; 2],
        /// Maximum distance of plants beyond their grid (m).
        plant_reach_m: f32,
        /// Distance from which heads thin out and the remaining ones are larger (m).
        heads_thin_m: f32,
        /// Minimum width of a drawn blade (px).
        thinnest_px: f32,
        _pad: [u8; 12],
    }
}

uniform_block! {
    /// Map of the grass grids.
    GridMapFrame {
        /// First grid of the map (x, z).
        first_grid: [i32; 2],
        /// First grid of the square of the pass that lists grids (x, z).
        listed_first: [i32; 2],
        /// Grids along a side of the map, and of that square.
        side: i32,
        listed_side: i32,
        /// Side of a grid (m).
        grid_m: f32,
        /// Pixels of the target along a side of a pixel of the legend.
        pixel_px: f32,
        /// Top left corner of the map in the target (px).
        corner_px: [f32; 2],
        /// Side of the map (pixels of the legend).
        map_px: f32,
        /// 1 if the target encodes sRGB.
        target_encodes: u32,
    }
}

uniform_block! {
    /// A draw list of blades or flowers.
    StripList {
        /// Index of its first plant.
        first: u32,
        /// Capacity.
        capacity: u32,
        /// Segments of a blade.
        segments: u32,
        /// Index of the list; for blades in order, of the span.
        number: u32,
        /// 1 if the list grows upwards from the first plant, -1 if downwards.
        step: i32,
        _pad: [u8; 12],
    }
}

uniform_block! {
    /// Clumps in a frame.
    ClumpList {
        /// Number of clumps.
        count: u32,
        /// Instances whose clumps have several segments, the maximum number of these segments, and the number of these clumps.
        several_instances: u32,
        several_segments: u32,
        several: u32,
        /// Distance from which clumps begin to bend as a whole (m).
        straightens_m: f32,
        /// Distance beyond which all do (m).
        straight_m: f32,
        /// Mean of the solver's wind over the ground (m/s, X and Z).
        mean_wind_m_per_s: [f32; 2],
        /// Distance from which the deviation of the wind from it grows in proportion to distance (m).
        raised_from_m: f32,
        _pad: [u8; 12],
    }
}

uniform_block! {
    /// Settings of the shells' passes.
    ShellFrame {
        /// Segments of a blade.
        segments: u32,
        /// Maximum number of slices between two layers.
        slice_limit: u32,
        /// 1 if no single blades are drawn.
        is_alone: u32,
        /// Samples per pixel.
        samples: u32,
        /// Side of the texture, and of its texels, on the ground (m).
        texture_m: f32,
        texel_m: f32,
        /// Its last mip level.
        last_level: f32,
        /// Minimum fraction of the light at the roots.
        root_light: f32,
        /// Exponent of the tilt along a blade, less 1; 0 for a constant increment.
        stiffness_profile: f32,
        /// 1 if layers are grown straight up, 0 if along the normal of the ground.
        is_upright: u32,
        _pad: [u8; 8],
    }
}

uniform_block! {
    /// A species of underbrush.
    Nature {
        /// Height (m).
        height_m: f32,
        /// Time constant (s).
        settle_secs: f32,
        /// Maximum distance of a part of it from its root (m).
        reach_m: f32,
        _pad: [u8; 4],
    }
}

uniform_block! {
    /// Settings of the compute pass of the underbrush.
    UnderbrushFrame {
        /// Species by index.
        species: [Nature; SPECIES_LIMIT],
        /// Frame number; counts frames in which time advances.
        frame_number: u32,
        /// 1 to cull plants outside the view.
        culls: u32,
        /// Capacity in plants, and in blocks of rows.
        plant_limit: u32,
        block_limit: u32,
        /// Time since the previous frame (s).
        step_secs: f32,
        /// Distance at which plants have shrunk to nothing (m).
        reach_m: f32,
        /// Factor on the screen heights below which plants are coarser.
        coarseness: f32,
        /// Screen height from which they are drawn as curves (px), huge if never.
        close_px: f32,
    }
}

uniform_block! {
    /// Extent of the force field around the camera.
    ForceFieldFrame {
        /// Its corner, X and Z (m).
        corner_m: [f32; 2],
        /// Its size along X and Z (m).
        extent_m: [f32; 2],
        /// Its height (m).
        height_m: f32,
        _pad: [u8; 12],
    }
}

uniform_block! {
    /// A species of underbrush at a level of detail.
    BrushList {
        /// Rows per plant.
        rows: u32,
        /// Plants per instance.
        instance_plants: u32,
        /// Components per plant.
        limbs: u32,
        /// Index of its first row among the rows of all lists.
        first_row: u32,
        /// Index of its first component among the components of all lists.
        first_limb: u32,
        /// Index of its first listed plant.
        first_listed: u32,
        /// 1 to use the nearest posture instead of interpolating.
        is_nearest: u32,
        /// Index of the first step of its tables among the steps of all lists.
        first_step: u32,
        /// Number of angles and of loads in the tables.
        nodes: [u32; 2],
        /// Rate of the drops of rain that make leaves tremble (1/(m²·s)).
        drops_per_m2_per_s: f32,
        _pad: [u8; 4],
    }
}

uniform_block! {
    /// All species at all levels.
    BrushLists {
        list: [BrushList; UNDERBRUSH_LISTS as usize],
    }
}

uniform_block! {
    /// The underbrush list being drawn.
    DrawnList {
        /// Its index.
        number: u32,
        _pad: [u8; 12],
    }
}

uniform_block! {
    /// Rain around the camera.
    Shower {
        /// Side of the square that contains the drops or flakes, and its height (m).
        side_m: f32,
        height_m: f32,
        /// Fall speed of the drops or flakes (m/s).
        fall_m_per_s: f32,
        /// Opacity.
        opacity: f32,
        /// Exposure time of their streaks (s), and half of the width of these (m).
        streak_secs: f32,
        half_width_m: f32,
        _pad: [u8; 8],
    }
}

uniform_block! {
    /// Settings of tone mapping.
    Tone {
        /// 1 if the target itself encodes sRGB.
        target_encodes: f32,
        /// Exposure.
        exposure: f32,
        /// Rendered pixels per pixel of the target, along X and Y.
        scale: [f32; 2],
    }
}

uniform_block! {
    /// A digit of a sort.
    SortDigit {
        /// Its lowest bit.
        lowest_bit: u32,
        /// Index of the counter of pairs.
        counter: u32,
        /// Maximum number of pairs.
        limit: u32,
        _pad: [u8; 4],
    }
}

uniform_block! {
    /// Settings of the passes that order blades.
    Ordering {
        /// The camera's grid (x, z).
        camera_grid: [i32; 2],
        /// Capacities of the lists of fine blades and of all others.
        fine_capacity: u32,
        other_capacity: u32,
        /// 1 for precomputed orders.
        is_precomputed: u32,
        /// Side of a grid (m).
        grid_m: f32,
        _pad: [u8; 8],
    }
}
