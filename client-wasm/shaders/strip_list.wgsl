// Lists of single plants that are drawn, 64 an instance.

struct StripList {
    // First of the list, capacity, segments of a blade, number of the list.
    range: vec4<u32>,
    // 1 where those that follow lie after the first, -1 where before it; unused.
    order: vec4<i32>,
}

@group(1) @binding(0) var<storage, read> blades: array<Blade>;
// Lengths of the lists; where blades are drawn far to near, their spans in that order, as `order.wgsl` has them.
@group(1) @binding(1) var<storage, read> drawn: array<u32>;
@group(1) @binding(2) var<uniform> list: StripList;

// Which plant of the list a vertex belongs to, where each has so many.
fn number_of(index: u32, instance: u32, vertices: u32) -> u32 {
    return instance * 64u + index / vertices;
}

fn is_listed(number: u32) -> bool {
    return number < min(drawn[list.range.w], list.range.y);
}

fn listed(number: u32) -> Blade {
    return blades[u32(i32(list.range.x) + i32(number) * list.order.x)];
}
