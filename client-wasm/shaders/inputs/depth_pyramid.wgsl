// Depth pyramid: the farthest depth of the solids drawn so far, by cells of the picture (Greene et al. 1993). What is behind it in all cells that it
// may cover is hidden.

import package::constants::{PYRAMID_CELL_PX, PYRAMID_SIDE};
import package::inputs::frame::frame;

// Farthest depth in each cell, reversed: 0 is infinitely far. Levels follow each other, each a square of half the side of the one before.
@group(1) @binding(40) var<storage, read> pyramid: array<f32>;

// Whether anything is tested. Fixed at pipeline creation.
override tests_occlusion: bool = true;

// Margin of depths, relative to them, for rounding.
const DEPTH_MARGIN: f32 = 1e-3;
// Margin around an area on the screen, for rounding and soft borders (px).
const AREA_MARGIN_PX: f32 = 2.0;
// Things are tested beyond this multiple of the distance of the near plane.
const TESTED_BEYOND: f32 = 2.0;

// Side of a cell of the finest level (px). Twin of `cell_px` in depth_pyramid.rs.
fn pyramid_cell_px() -> u32 {
    let longest_px = u32(max(frame.screen_px.x, frame.screen_px.y));
    return max(PYRAMID_CELL_PX, (longest_px + PYRAMID_SIDE - 1u) / PYRAMID_SIDE);
}

// Place of a cell of a level.
fn pyramid_index(level: u32, cell: vec2<u32>) -> u32 {
    let side = PYRAMID_SIDE >> level;
    return (PYRAMID_SIDE * PYRAMID_SIDE - side * side) / 3u * 4u + cell.y * side + cell.x;
}

// Whether something is hidden whose corners are at most `low` and `high` on the screen (−1..1, Y up), and whose nearest depth is `nearest`.
fn is_area_hidden(low: vec2<f32>, high: vec2<f32>, nearest: f32) -> bool {
    let last_px = frame.screen_px - 1.0;
    let start_px = (vec2<f32>(low.x, -high.y) * 0.5 + 0.5) * frame.screen_px - AREA_MARGIN_PX;
    let end_px = (vec2<f32>(high.x, -low.y) * 0.5 + 0.5) * frame.screen_px + AREA_MARGIN_PX;
    let cell_px = pyramid_cell_px();
    let first = vec2<u32>(clamp(start_px, vec2<f32>(0.0), last_px)) / cell_px;
    let last = vec2<u32>(clamp(end_px, vec2<f32>(0.0), last_px)) / cell_px;
    // At this level the area covers at most three cells along a side.
    let wide = max(last.x - first.x, last.y - first.y);
    let level = select(firstLeadingBit(wide), 0u, wide < 2u);
    var farthest = 1.0;
    for (var y = first.y >> level; y <= last.y >> level; y++) {
        for (var x = first.x >> level; x <= last.x >> level; x++) {
            farthest = min(farthest, pyramid[pyramid_index(level, vec2<u32>(x, y))]);
        }
    }
    return nearest * (1.0 + DEPTH_MARGIN) < farthest;
}

// Whether the solids drawn so far hide a sphere (m).
fn is_sphere_hidden(centre: vec3<f32>, radius: f32) -> bool {
    let m = transpose(frame.projection_from_world);
    let c = vec4<f32>(centre, 1.0);
    let middle = vec2<f32>(dot(m[0], c), dot(m[1], c));
    let reach = radius * vec2<f32>(length(m[0].xyz), length(m[1].xyz));
    let w = dot(m[3], c);
    // Distances along the view of its nearest and farthest point.
    let near_m = w - radius;
    let far_m = w + radius;
    // The depth of all points is that of the near plane over their distance.
    let near_plane_m = m[2].w;
    if !tests_occlusion || near_m < TESTED_BEYOND * near_plane_m {
        return false;
    }
    let low = middle - reach;
    let high = middle + reach;
    let widest_low = low / select(vec2<f32>(far_m), vec2<f32>(near_m), low < vec2<f32>(0.0));
    let widest_high = high / select(vec2<f32>(near_m), vec2<f32>(far_m), high < vec2<f32>(0.0));
    return is_area_hidden(widest_low, widest_high, near_plane_m / near_m);
}

// Whether the solids drawn so far hide a box (m).
fn is_box_hidden(low: vec3<f32>, high: vec3<f32>) -> bool {
    if !tests_occlusion {
        return false;
    }
    let near_plane_m = transpose(frame.projection_from_world)[2].w;
    var least = vec2<f32>(1e9);
    var most = vec2<f32>(-1e9);
    var near_m = 1e9;
    for (var i = 0u; i < 8u; i++) {
        let upper = (vec3<u32>(i) & vec3<u32>(1u, 2u, 4u)) != vec3<u32>(0u);
        let corner = frame.projection_from_world * vec4<f32>(select(low, high, upper), 1.0);
        let at = corner.xy / max(corner.w, near_plane_m);
        least = min(least, at);
        most = max(most, at);
        near_m = min(near_m, corner.w);
    }
    if near_m < TESTED_BEYOND * near_plane_m {
        return false;
    }
    return is_area_hidden(least, most, near_plane_m / near_m);
}
