// Sort keys of the listed blades, far to near (Zhang, section 5.4).

import package::constants::{CHUNK, COARSE_LIST, DISPATCH_WORDS, DRAW_WORDS, FINE_LIST, ORDER_CELLS, SINGLE_LIST};
import package::inputs::frame::{frame, runtime_zero};
import package::plants::drawn_blade::Blade;
import package::plants::nearness::nearness;
import package::plants::spans::{Span, Spans};
import package::uniforms::Ordering;

@group(1) @binding(0) var<uniform> ordering: Ordering;
@group(1) @binding(1) var<storage, read> blades: array<Blade>;
@group(1) @binding(2) var<storage, read> drawn: array<u32>;
@group(1) @binding(3) var<storage, read_write> spans: Spans;
// Arguments of the indirect dispatch of `key_blades`, and after `DISPATCH_WORDS` those of the draws of the other and of the fine blades.
@group(1) @binding(4) var<storage, read_write> arguments: array<u32>;
@group(1) @binding(5) var<storage, read_write> pairs: array<vec2<u32>>;
// For each of 3 x 3 sections around the camera's grid, row by row, the rank of each of 64 x 64 cells of a grid.
@group(1) @binding(6) var<storage, read> sequences: array<u32>;

const OFFSET_LIMIT: u32 = 2047u;

@compute @workgroup_size(1)
fn span_blades() {
    let fine = min(drawn[FINE_LIST], ordering.fine_capacity);
    let coarse = min(drawn[COARSE_LIST], ordering.other_capacity);
    let others = min(coarse + drawn[SINGLE_LIST], ordering.other_capacity);
    spans.all = others + fine;
    spans.parts[0] = Span(0u, others);
    spans.parts[1] = Span(others, fine);
    spans.first_single = ordering.fine_capacity + coarse;
    arguments[0] = (others + fine + CHUNK - 1u) / CHUNK;
    arguments[DISPATCH_WORDS + 1u] = (others + CHUNK - 1u) / CHUNK;
    arguments[DISPATCH_WORDS + DRAW_WORDS + 1u] = (fine + CHUNK - 1u) / CHUNK;
}

@compute @workgroup_size(CHUNK)
fn key_blades(@builtin(global_invocation_id) id: vec3<u32>) {
    let others = spans.parts[0].count;
    if id.x >= spans.all {
        return;
    }
    let coarse = spans.first_single - ordering.fine_capacity;
    var place = id.x - others;
    if id.x < coarse {
        place = ordering.fine_capacity + id.x;
    } else if id.x < others {
        // Blades of one segment are at the end of the buffer.
        place = ordering.fine_capacity + ordering.other_capacity - 1u - (id.x - coarse);
    }
    let root = blades[place].root_m;
    let near = nearness(distance(root, frame.eye_m));
    let is_fine = u32(id.x >= others);
    if ordering.is_precomputed + u32(runtime_zero(root.x)) == 0u {
        pairs[id.x] = vec2<u32>((is_fine << 15u) | near, place);
    } else {
        pairs[id.x] = vec2<u32>((is_fine << 23u) | made_beforehand(root.xz, near), place);
    }
}

// 23-bit precomputed key: grids by their squared offset from the camera's, then cells by the sequence of their section; in the camera's grid
// by distance (Zhang, sections 5.4.1 and 5.4.2).
fn made_beforehand(p: vec2<f32>, near: u32) -> u32 {
    let at = p / ordering.grid_m;
    let grid = floor(at);
    let away = vec2<i32>(grid) - ordering.camera_grid;
    let offset = min(u32(dot(away, away)), OFFSET_LIMIT);
    let cell = min(vec2<u32>((at - grid) * f32(ORDER_CELLS)), vec2<u32>(ORDER_CELLS - 1u));
    let section = u32(sign(away.x) + 1 + 3 * (sign(away.y) + 1));
    let sequenced = sequences[section * ORDER_CELLS * ORDER_CELLS + cell.y * ORDER_CELLS + cell.x];
    return ((OFFSET_LIMIT - offset) << 12u) | select(sequenced, near >> 3u, offset == 0u);
}
