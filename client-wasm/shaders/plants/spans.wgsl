// Spans of the sorted blades.

struct Span {
    // Place of its first blade in the sorted order.
    first: u32,
    // Number of blades.
    count: u32,
}

struct Spans {
    // Number of all blades; `gpu/sort.wgsl` reads it as the number of pairs.
    all: u32,
    // Span of the other blades, then of the fine ones.
    parts: array<Span, 2>,
    // Index of the first single-segment blade among the listed ones.
    first_single: u32,
}
