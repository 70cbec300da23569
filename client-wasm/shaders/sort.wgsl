// Stable radix sort, a digit of eight bits at a time from the lowest, of pairs of a key and a number, as many as a counter on the GPU says.
//
// A digit takes three dispatches: each tile of pairs counts its digits; one workgroup turns the counts into places; each tile writes its
// pairs there. Workgroups never wait for each other, and nothing is asked of subgroups.

struct SortDigit {
    // Lowest bit of the digit; which counter says how many pairs there are; most pairs; unused.
    shape: vec4<u32>,
}

@group(1) @binding(0) var<storage, read> counters: array<u32>;
@group(1) @binding(1) var<uniform> sorting: SortDigit;
// How many tiles there are, as the arguments of an indirect dispatch.
@group(1) @binding(2) var<storage, read_write> dispatched: array<u32>;
@group(1) @binding(3) var<storage, read> unsorted: array<vec2<u32>>;
@group(1) @binding(4) var<storage, read_write> sorted: array<vec2<u32>>;
// For each tile 256 counts, then the places of the first pair with each digit.
@group(1) @binding(5) var<storage, read_write> places: array<u32>;

// Pairs of a tile, and how many of them it takes at once; twins of the constants in `sort.rs`.
const TILE: u32 = 1024u;
const THREADS: u32 = 256u;

fn pair_count() -> u32 {
    return min(counters[sorting.shape.y], sorting.shape.z);
}

fn tile_count() -> u32 {
    return (pair_count() + TILE - 1u) / TILE;
}

fn digit_of(key: u32) -> u32 {
    return (key >> sorting.shape.x) & 255u;
}

@compute @workgroup_size(1)
fn plan_tiles() {
    dispatched[0] = tile_count();
    dispatched[1] = 1u;
    dispatched[2] = 1u;
}

var<workgroup> tile_counts: array<atomic<u32>, 256>;

@compute @workgroup_size(256)
fn count_digits(@builtin(workgroup_id) tile: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    atomicStore(&tile_counts[thread], 0u);
    workgroupBarrier();
    for (var at = tile.x * TILE + thread; at < min((tile.x + 1u) * TILE, pair_count()); at += THREADS) {
        atomicAdd(&tile_counts[digit_of(unsorted[at].x)], 1u);
    }
    workgroupBarrier();
    places[tile.x * 256u + thread] = atomicLoad(&tile_counts[thread]);
}

var<workgroup> sums: array<u32, 256>;

// Each thread takes a digit: its pairs come after those of all lower digits, tile after tile.
@compute @workgroup_size(256)
fn place_digits(@builtin(local_invocation_index) thread: u32) {
    let tiles = tile_count();
    var total = 0u;
    for (var tile = 0u; tile < tiles; tile++) {
        total += places[tile * 256u + thread];
    }
    sums[thread] = total;
    workgroupBarrier();
    for (var reach = 1u; reach < 256u; reach *= 2u) {
        var lower = 0u;
        if thread >= reach {
            lower = sums[thread - reach];
        }
        workgroupBarrier();
        sums[thread] += lower;
        workgroupBarrier();
    }
    var place = sums[thread] - total;
    for (var tile = 0u; tile < tiles; tile++) {
        let own = places[tile * 256u + thread];
        places[tile * 256u + thread] = place;
        place += own;
    }
}

// Which of the 256 pairs at hand have a digit: eight words of bits for each.
var<workgroup> holders: array<atomic<u32>, 2048>;
var<workgroup> next_places: array<u32, 256>;

@compute @workgroup_size(256)
fn move_pairs(@builtin(workgroup_id) tile: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    next_places[thread] = places[tile.x * 256u + thread];
    for (var word = 0u; word < 8u; word++) {
        atomicStore(&holders[thread * 8u + word], 0u);
    }
    let count = pair_count();
    for (var first = 0u; first < TILE; first += THREADS) {
        workgroupBarrier();
        let at = tile.x * TILE + first + thread;
        var pair = vec2<u32>(0u);
        var digit = 0u;
        if at < count {
            pair = unsorted[at];
            digit = digit_of(pair.x);
            atomicOr(&holders[digit * 8u + thread / 32u], 1u << (thread % 32u));
        }
        workgroupBarrier();
        if at < count {
            // As many places on as pairs before it have the same digit.
            var before = countOneBits(atomicLoad(&holders[digit * 8u + thread / 32u]) & ((1u << (thread % 32u)) - 1u));
            for (var word = 0u; word < thread / 32u; word++) {
                before += countOneBits(atomicLoad(&holders[digit * 8u + word]));
            }
            sorted[next_places[digit] + before] = pair;
        }
        workgroupBarrier();
        for (var word = 0u; word < 8u; word++) {
            next_places[thread] += countOneBits(atomicExchange(&holders[thread * 8u + word], 0u));
        }
    }
}
