// Map of the grass grids around the camera, seen from above with north at the top, drawn over the picture (Zhang, Figs 12 to 14): which grids are
// culled, the level of detail of the others, and where the view meets the ground; below it a legend with the number of grids of each class.

import package::constants::{
    CLUMPS_CULLED, FEWEST_CLUMP_PLANTS, GLYPH_HEIGHT, GLYPH_PITCH, GLYPH_WIDTH, GRID_CLASSES, GRID_HIDDEN, GRID_OUTSIDE, GRID_SHOWN, LEGEND_CHARACTERS,
    LEGEND_DIGITS, LEGEND_LINE, NEAR_CULLED, NEAR_SHOWN, NO_CLASS, WORKGROUP_SIZE,
};
import package::inputs::frame::frame;
import package::land_and_sky::ground::ground_height;
import package::uniforms::GridMapFrame;

@group(1) @binding(0) var<uniform> map: GridMapFrame;
// For each grid of the map, row by row, what the CPU has listed there: a code of a near grid, or the plants of its clumps.
@group(1) @binding(1) var<storage, read> listed: array<u32>;
// What `list_grids` has found, for each grid of its square.
@group(1) @binding(2) var<storage, read> states: array<u32>;
// Class of the single plants and class of the clumps of each grid.
@group(1) @binding(3) var<storage, read_write> classed: array<vec2<u32>>;
// Number of grids of each class.
@group(1) @binding(4) var<storage, read_write> counted: array<atomic<u32>, GRID_CLASSES>;
@group(1) @binding(5) var<storage, read> classes: array<vec2<u32>>;
@group(1) @binding(6) var<storage, read> counts: array<u32, GRID_CLASSES>;
// Pixels of the ten digits, then those of the characters of the legend, line by line: bit n is pixel n, row by row from the top left.
@group(1) @binding(7) var<storage, read> glyphs: array<u32>;

// Classes, in the order of the legend.
const SIMULATED: u32 = 0u;
const SINGLE: u32 = 1u;
// Clumps of 3, of 5, of 9, and of 17 plants or more.
const FIRST_CLUMPS: u32 = 2u;
const LAST_CLUMPS: u32 = 5u;
const OUT_OF_VIEW: u32 = 6u;
const BEHIND_HILLS: u32 = 7u;

// Class of the plants that `list_grids` lists in a grid.
fn single_class(grid: vec2<i32>) -> u32 {
    let at = grid - map.listed_first;
    if any(at < vec2<i32>(0)) || any(at >= vec2<i32>(map.listed_side)) {
        return NO_CLASS;
    }
    let state = states[u32(at.y * map.listed_side + at.x)];
    if state == GRID_SHOWN {
        return SINGLE;
    }
    if state == GRID_OUTSIDE {
        return OUT_OF_VIEW;
    }
    return select(NO_CLASS, BEHIND_HILLS, state == GRID_HIDDEN);
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn class_grids(@builtin(global_invocation_id) id: vec3<u32>) {
    let side = u32(map.side);
    if id.x >= side * side {
        return;
    }
    let grid = map.first_grid + vec2<i32>(i32(id.x % side), i32(id.x / side));
    let code = listed[id.x];
    var found = vec2<u32>(NO_CLASS);
    if code == NEAR_SHOWN {
        found.x = SIMULATED;
    } else if code == NEAR_CULLED {
        found.x = OUT_OF_VIEW;
    } else {
        found.x = single_class(grid);
        let plants = code & (CLUMPS_CULLED - 1u);
        if code >= CLUMPS_CULLED {
            found.y = OUT_OF_VIEW;
        } else if plants >= FEWEST_CLUMP_PLANTS {
            found.y = min(FIRST_CLUMPS + firstLeadingBit((plants - 1u) / (FEWEST_CLUMP_PLANTS - 1u)), LAST_CLUMPS);
        }
    }
    classed[id.x] = found;
    if found.x != NO_CLASS {
        atomicAdd(&counted[found.x], 1u);
    }
    if found.y != NO_CLASS && found.y != found.x {
        atomicAdd(&counted[found.y], 1u);
    }
}

@vertex
fn vs(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

// Displayed colour of a class.
fn class_color(number: u32) -> vec3<f32> {
    return array<vec3<f32>, GRID_CLASSES>(
        vec3<f32>(1.00, 0.93, 0.45),
        vec3<f32>(0.55, 0.86, 0.32),
        vec3<f32>(0.20, 0.72, 0.55),
        vec3<f32>(0.25, 0.62, 0.90),
        vec3<f32>(0.48, 0.47, 0.93),
        vec3<f32>(0.76, 0.42, 0.85),
        vec3<f32>(0.26, 0.26, 0.26),
        vec3<f32>(0.62, 0.32, 0.16),
    )[number];
}

const PAPER: vec3<f32> = vec3<f32>(0.10, 0.12, 0.09);
const INK: vec3<f32> = vec3<f32>(0.94, 0.93, 0.86);

// Whether the ground at a position is in view.
fn is_ground_in_view(p: vec2<f32>) -> bool {
    let clip = frame.projection_from_world * vec4<f32>(p.x, ground_height(p), p.y, 1.0);
    return clip.w > 0.0 && all(abs(clip.xy) <= vec2<f32>(clip.w));
}

// Colour of the map at a position in it, 0..1 from west to east and from north to south; `pixel` is the size of a pixel there.
fn map_color(at: vec2<f32>, pixel: f32) -> vec3<f32> {
    let side = f32(map.side);
    let cell = min(at * side, vec2<f32>(side - 0.001));
    let within = fract(cell);
    let found = classes[u32(cell.y) * u32(map.side) + u32(cell.x)];
    // A grid of two representations is divided along its diagonal.
    let is_lower = within.x + within.y > 1.0;
    var shown = select(found.x, found.y, is_lower);
    if shown == NO_CLASS {
        shown = select(found.y, found.x, is_lower);
    }
    var color = PAPER;
    if shown != NO_CLASS {
        color = class_color(shown);
    }
    let line = pixel * side;
    if any(within < vec2<f32>(line)) && line < 0.25 {
        color *= 0.7;
    }
    let to_m = side * map.grid_m;
    let p = (vec2<f32>(map.first_grid) + at * side) * map.grid_m;
    let is_in_view = is_ground_in_view(p);
    let beside = vec2<f32>(pixel * to_m, 0.0);
    let is_border = is_ground_in_view(p + beside) != is_in_view || is_ground_in_view(p + beside.yx) != is_in_view;
    color = select(color * 0.8, color, is_in_view);
    let is_eye = distance(p, frame.eye_m.xz) < 3.0 * pixel * to_m;
    return select(color, INK, is_border || is_eye);
}

// Whether a pixel of a glyph is set.
fn is_set(glyph: u32, at: vec2<u32>) -> bool {
    return at.x < GLYPH_WIDTH && at.y < GLYPH_HEIGHT && ((glyph >> (at.y * GLYPH_WIDTH + at.x)) & 1u) == 1u;
}

// Colour of the legend at a pixel of it.
fn legend_color(at: vec2<u32>) -> vec3<f32> {
    let number = at.y / LEGEND_LINE;
    let row = at.y % LEGEND_LINE;
    if number >= GRID_CLASSES || row == 0u {
        return PAPER;
    }
    let column = at.x / GLYPH_PITCH;
    let pixel = vec2<u32>(at.x % GLYPH_PITCH, row - 1u);
    if column == 0u {
        return select(PAPER, class_color(number), row <= GLYPH_HEIGHT);
    }
    var glyph = 0u;
    if column <= LEGEND_DIGITS {
        // Right-aligned decimal digits, without leading zeros.
        var rest = counts[number];
        for (var i = column; i < LEGEND_DIGITS; i++) {
            rest /= 10u;
        }
        if rest > 0u || column == LEGEND_DIGITS {
            glyph = glyphs[rest % 10u];
        }
    } else if column < 2u + LEGEND_DIGITS + LEGEND_CHARACTERS && column > 1u + LEGEND_DIGITS {
        glyph = glyphs[10u + number * LEGEND_CHARACTERS + column - 2u - LEGEND_DIGITS];
    }
    return select(PAPER, INK, is_set(glyph, pixel));
}

@fragment
fn fs(@builtin(position) position: vec4<f32>) -> @location(0) vec4<f32> {
    let at = (position.xy - map.corner_px) / map.pixel_px;
    var color = PAPER;
    if at.y < map.map_px {
        color = map_color(at / map.map_px, 1.0 / (map.map_px * map.pixel_px));
    } else {
        color = legend_color(vec2<u32>(vec2<f32>(at.x, at.y - map.map_px)));
    }
    // The target encodes what it is given, or shows it as it is.
    return vec4<f32>(select(color, pow(color, vec3<f32>(2.2)), map.target_encodes != 0u), 1.0);
}
