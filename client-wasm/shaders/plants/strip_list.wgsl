// Draw lists of single plants, 64 per instance.

import package::constants::CHUNK;
import package::plants::drawn_blade::Blade;
import package::uniforms::StripList;

@group(1) @binding(0) var<storage, read> blades: array<Blade>;
// Lengths of the lists.
@group(1) @binding(1) var<storage, read> drawn: array<u32>;
@group(1) @binding(2) var<uniform> list: StripList;

// List index of the plant that a vertex belongs to, for plants of `vertices` vertices each.
fn number_of(index: u32, instance: u32, vertices: u32) -> u32 {
    return instance * CHUNK + index / vertices;
}

fn is_listed(number: u32) -> bool {
    return number < min(drawn[list.number], list.capacity);
}

fn listed(number: u32) -> Blade {
    return blades[u32(i32(list.first) + i32(number) * list.step)];
}
