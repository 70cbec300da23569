// The listed blades as pairs of a key and a place in the list, which sorted by their keys are far to near (000 section 5.4).

struct Ordering {
    // Capacities of the lists of fine blades and of all others; 1 for the orders made beforehand; unused.
    lists: vec4<u32>,
    // The camera's grid (x, z); unused.
    home: vec4<i32>,
    // Side of a grid (m); unused.
    shape: vec4<f32>,
}

@group(1) @binding(0) var<uniform> ordering: Ordering;
@group(1) @binding(1) var<storage, read> blades: array<Blade>;
@group(1) @binding(2) var<storage, read> drawn: array<u32>;
// As `Spans` in `blades/order.rs`: all pairs; first and number of all but the fine blades, and of those; place of the first of one segment.
@group(1) @binding(3) var<storage, read_write> spans: array<u32>;
// Arguments of the indirect dispatch of `key_blades`, and after four words of the draws of all but the fine blades and of those.
@group(1) @binding(4) var<storage, read_write> arguments: array<u32>;
@group(1) @binding(5) var<storage, read_write> pairs: array<vec2<u32>>;
// For each of 3 x 3 sections about the camera's grid, by row, the place in its sequence of each of 64 x 64 cells of a grid.
@group(1) @binding(6) var<storage, read> sequences: array<u32>;

const FINE: u32 = 0u;
const COARSE: u32 = 1u;
const SINGLE: u32 = 2u;
// Twins of the constants in `order.rs`.
const CELLS: u32 = 64u;
const OFFSET_LIMIT: u32 = 2047u;

@compute @workgroup_size(1)
fn span_blades() {
    let fine = min(drawn[FINE], ordering.lists.x);
    let coarse = min(drawn[COARSE], ordering.lists.y);
    let others = min(coarse + drawn[SINGLE], ordering.lists.y);
    spans[0] = others + fine;
    spans[1] = 0u;
    spans[2] = others;
    spans[3] = others;
    spans[4] = fine;
    spans[5] = ordering.lists.x + coarse;
    arguments[0] = (others + fine + 63u) / 64u;
    arguments[5] = (others + 63u) / 64u;
    arguments[10] = (fine + 63u) / 64u;
}

@compute @workgroup_size(64)
fn key_blades(@builtin(global_invocation_id) id: vec3<u32>) {
    let others = spans[2];
    if id.x >= spans[0] {
        return;
    }
    let coarse = spans[5] - ordering.lists.x;
    var place = id.x - others;
    if id.x < coarse {
        place = ordering.lists.x + id.x;
    } else if id.x < others {
        // Those of one segment lie at the list's end.
        place = ordering.lists.x + ordering.lists.y - 1u - (id.x - coarse);
    }
    let root = blades[place].root.xyz;
    let near = nearness(distance(root, frame.eye.xyz));
    let is_fine = u32(id.x >= others);
    if ordering.lists.z + u32(none_of(root.x)) == 0u {
        pairs[id.x] = vec2<u32>((is_fine << 15u) | near, place);
    } else {
        pairs[id.x] = vec2<u32>((is_fine << 23u) | made_beforehand(root.xz, near), place);
    }
}

// 23 bits: grids by the square of their offset from the camera's, then cells by the sequence of their section, in the camera's own grid by
// distance (000 sections 5.4.1 and 5.4.2).
fn made_beforehand(p: vec2<f32>, near: u32) -> u32 {
    let at = p / ordering.shape.x;
    let grid = floor(at);
    let away = vec2<i32>(grid) - ordering.home.xy;
    let offset = min(u32(dot(away, away)), OFFSET_LIMIT);
    let cell = min(vec2<u32>((at - grid) * f32(CELLS)), vec2<u32>(CELLS - 1u));
    let section = u32(sign(away.x) + 1 + 3 * (sign(away.y) + 1));
    let sequenced = sequences[section * CELLS * CELLS + cell.y * CELLS + cell.x];
    return ((OFFSET_LIMIT - offset) << 12u) | select(sequenced, near >> 3u, offset == 0u);
}
