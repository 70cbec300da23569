// Reduction of the depth buffer to the depth pyramid.

import package::constants::{PYRAMID_LEVELS, WORKGROUP_SIZE};
import package::inputs::depth_pyramid::{pyramid_cell_px, pyramid_index};
import package::inputs::frame::frame;

// Whether cells hold the nearest instead of the farthest depth, which hides too much: for tests. Fixed at pipeline creation.
override keeps_nearest: bool = false;

@group(1) @binding(0) var depths: texture_depth_2d;
@group(1) @binding(1) var depth_samples: texture_depth_multisampled_2d;
@group(1) @binding(2) var<storage, read_write> reduced: array<f32>;

// Cells of the finest level along X and Y.
fn finest_cells() -> vec2<u32> {
    let cell_px = pyramid_cell_px();
    return (vec2<u32>(frame.screen_px) + cell_px - 1u) / cell_px;
}

// The depth of two that a cell with both keeps.
fn kept(a: f32, b: f32) -> f32 {
    if keeps_nearest {
        return max(a, b);
    }
    return min(a, b);
}

// First pixel of a cell of the finest level, and the one after its last.
fn pixels_of(cell: vec2<u32>) -> array<vec2<u32>, 2> {
    let cell_px = pyramid_cell_px();
    return array<vec2<u32>, 2>(cell * cell_px, min((cell + 1u) * cell_px, vec2<u32>(frame.screen_px)));
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn reduce_depths(@builtin(global_invocation_id) id: vec3<u32>) {
    let cells = finest_cells();
    let cell = vec2<u32>(id.x % cells.x, id.x / cells.x);
    if cell.y >= cells.y {
        return;
    }
    let pixels = pixels_of(cell);
    var found = textureLoad(depths, pixels[0], 0);
    for (var y = pixels[0].y; y < pixels[1].y; y++) {
        for (var x = pixels[0].x; x < pixels[1].x; x++) {
            found = kept(found, textureLoad(depths, vec2<u32>(x, y), 0));
        }
    }
    reduced[pyramid_index(0u, cell)] = found;
}

// As `reduce_depths`, with several samples per pixel.
@compute @workgroup_size(WORKGROUP_SIZE)
fn reduce_samples(@builtin(global_invocation_id) id: vec3<u32>) {
    let cells = finest_cells();
    let cell = vec2<u32>(id.x % cells.x, id.x / cells.x);
    if cell.y >= cells.y {
        return;
    }
    let pixels = pixels_of(cell);
    let samples = textureNumSamples(depth_samples);
    var found = textureLoad(depth_samples, pixels[0], 0);
    for (var y = pixels[0].y; y < pixels[1].y; y++) {
        for (var x = pixels[0].x; x < pixels[1].x; x++) {
            for (var sample = 0u; sample < samples; sample++) {
                found = kept(found, textureLoad(depth_samples, vec2<u32>(x, y), i32(sample)));
            }
        }
    }
    reduced[pyramid_index(0u, cell)] = found;
}

// The coarser levels, by one workgroup.
@compute @workgroup_size(WORKGROUP_SIZE)
fn reduce_levels(@builtin(local_invocation_index) local: u32) {
    var cells = finest_cells();
    for (var level = 1u; level <= PYRAMID_LEVELS; level++) {
        let last = cells - 1u;
        cells = (cells + 1u) / 2u;
        for (var at = local; at < cells.x * cells.y; at += WORKGROUP_SIZE) {
            let cell = vec2<u32>(at % cells.x, at / cells.x);
            let end = min(2u * cell + 1u, last);
            let first = 2u * cell;
            let upper = kept(reduced[pyramid_index(level - 1u, first)], reduced[pyramid_index(level - 1u, vec2<u32>(end.x, first.y))]);
            let lower = kept(reduced[pyramid_index(level - 1u, vec2<u32>(first.x, end.y))], reduced[pyramid_index(level - 1u, end)]);
            reduced[pyramid_index(level, cell)] = kept(upper, lower);
        }
        storageBarrier();
    }
}
