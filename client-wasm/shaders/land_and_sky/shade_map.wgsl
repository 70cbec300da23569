// Maps of the shade that the sward casts around the camera: first the sward as columns of leaves, then rays through them to the sun. Twin of
// `depth_toward_sun` in shared/src/light/shade.rs.

import package::constants::{
    GROWTH_BY_TUFT, LEAF_TOP, SHADE_CELLS, SHADE_FIRST, SHADE_MAPS, SHADE_PX, SHADE_RATIO, SHADE_STEPS, WORKGROUP_SIZE,
};
import package::inputs::bend_atlas::lean_in;
import package::inputs::frame::frame;
import package::inputs::grass_kinds::{kinds_blended, leafiness};
import package::inputs::sward_shade::{above_horizon, leaf_area_above, shade_cell_m, shade_corner_m, stance};
import package::inputs::wind::ground_wind_at;
import package::land_and_sky::ground::{fed, grass_fraction_over, ground_height};
import package::land_and_sky::sky_light::sun_heading;
import package::land_and_sky::snow::{laden_mass_at, snow_cell_m};

// Sward at a cell of the map. Twin of `Column`.
struct Column {
    // Elevation of the ground (m).
    ground_m: f32,
    // Mean height of the blades as they lean (m).
    height_m: f32,
    // Optical depth of all leaves towards the sun.
    depth: f32,
}

@group(1) @binding(0) var<storage, read_write> columns: array<Column>;
// Texels of the maps as half floats.
@group(1) @binding(1) var<storage, read_write> texels: array<vec2<u32>>;

// Minimum height of a column relative to that of upright grass: lying blades are piled up.
const LEAST_HEIGHT: f32 = 0.06;

// The sward around a position, averaged over a cell of the map.
fn column_at(p: vec2<f32>, map: u32) -> Column {
    let ground = vec3<f32>(p.x, ground_height(p), p.y);
    let kind = kinds_blended(p);
    let grown = fed(p) * 0.5 * (GROWTH_BY_TUFT[0] + GROWTH_BY_TUFT[1]);
    let cell_m = shade_cell_m(map);
    let lean = lean_in(ground, max(log2(cell_m / snow_cell_m()), 0.0), ground_wind_at(ground), kind.wind_bend_rad);
    let stands = stance(lean, kind.droop * laden_mass_at(p));
    let leaf_area = frame.leaf_area * leafiness(kind) * grown * grass_fraction_over(p, select(0.0, cell_m, map > 0u));
    let height_m = kind.height_m * grown * max(stands.x, LEAST_HEIGHT);
    return Column(ground.y, height_m, leaf_area * stands.y);
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn stand(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < SHADE_MAPS * SHADE_CELLS {
        let map = id.x / SHADE_CELLS;
        let at = id.x % SHADE_CELLS;
        let cell = vec2<u32>(at % SHADE_PX, at / SHADE_PX);
        columns[id.x] = column_at(shade_corner_m(map) + (vec2<f32>(cell) + 0.5) * shade_cell_m(map), map);
    }
}

// The column at a distance (cells) from a cell of a map towards the sun.
fn column_toward_sun(map: u32, cell: vec2<u32>, away: f32) -> Column {
    let place = vec2<i32>(vec2<f32>(cell) + 0.5 + sun_heading() * away);
    let at = vec2<u32>(clamp(place, vec2<i32>(0), vec2<i32>(i32(SHADE_PX) - 1)));
    return columns[map * SHADE_CELLS + at.y * SHADE_PX + at.x];
}

// Optical depths between the sun and three heights above a cell of a map.
fn depths_toward_sun(map: u32, cell: vec2<u32>) -> vec3<f32> {
    let sine = above_horizon().y;
    let rise = sine * inverseSqrt(max(1.0 - sine * sine, 1e-4));
    let own = columns[map * SHADE_CELLS + cell.y * SHADE_PX + cell.x];
    let from_m = own.ground_m + own.height_m * LEAF_TOP * vec3<f32>(0.0, 0.5, 1.0);
    var step_m = SHADE_FIRST * frame.shade_top_m / rise;
    var at_m = 0.0;
    var depths = vec3<f32>(0.0);
    for (var step = 0u; step < SHADE_STEPS; step++) {
        let end_m = at_m + step_m;
        let column = column_toward_sun(map, cell, 0.5 * (at_m + end_m) / shade_cell_m(map));
        let low = (from_m + at_m * rise - column.ground_m) / column.height_m;
        let high = (from_m + end_m * rise - column.ground_m) / column.height_m;
        for (var level = 0; level < 3; level++) {
            depths[level] += column.depth * (leaf_area_above(low[level]) - leaf_area_above(high[level]));
        }
        at_m = end_m;
        step_m *= SHADE_RATIO;
    }
    return depths;
}

// Bits of half floats of two numbers of at least 0, without subnormal ones.
fn halves(x: vec2<f32>) -> u32 {
    let bits = bitcast<vec2<u32>>(clamp(x, vec2<f32>(0.0), vec2<f32>(6e4)));
    let rounded = select(vec2<u32>(0u), (bits - vec2<u32>(0x37fff000u)) >> vec2<u32>(13u), bits >= vec2<u32>(0x38800000u));
    return rounded.x | (rounded.y << 16u);
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn cast_shade(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < SHADE_MAPS * SHADE_CELLS {
        let at = id.x % SHADE_CELLS;
        let depths = depths_toward_sun(id.x / SHADE_CELLS, vec2<u32>(at % SHADE_PX, at / SHADE_PX));
        let roots = sqrt(max(depths, vec3<f32>(0.0)));
        texels[id.x] = vec2<u32>(halves(vec2<f32>(columns[id.x].height_m, roots.x)), halves(roots.yz));
    }
}
