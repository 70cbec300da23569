// Stable radix sort, a digit of eight bits at a time from the lowest, of pairs of a key and a number, as many as a counter on the GPU says.
//
// A digit takes three dispatches: each tile of pairs counts its digits; a workgroup for each of the 256 turns its counts into places among
// the pairs that have it; each tile adds where those begin, and writes its pairs there. Workgroups never wait for each other, and nothing is
// asked of subgroups.

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
// How many pairs have each digit; then for each tile 256 counts, which become the places of its first pair with each digit among all that have it.
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

// Where the count of a digit in a tile is.
fn of_tile(tile: u32, digit: u32) -> u32 {
    return (tile + 1u) * 256u + digit;
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
    places[of_tile(tile.x, thread)] = atomicLoad(&tile_counts[thread]);
}

var<workgroup> sums: array<u32, 256>;

// Makes of the first `count` of `sums`, one a thread, the sums of all up to each.
fn add_up(thread: u32, count: u32) {
    for (var reach = 1u; reach < count; reach *= 2u) {
        workgroupBarrier();
        var lower = 0u;
        if thread >= reach {
            lower = sums[thread - reach];
        }
        workgroupBarrier();
        sums[thread] += lower;
    }
    workgroupBarrier();
}

// Threads that place a digit, each in a run of tiles.
const RUNS: u32 = 64u;

@compute @workgroup_size(RUNS)
fn place_digits(@builtin(workgroup_id) digit: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let tiles = tile_count();
    let run = (tiles + RUNS - 1u) / RUNS;
    let end = min((thread + 1u) * run, tiles);
    var total = 0u;
    for (var tile = thread * run; tile < end; tile++) {
        total += places[of_tile(tile, digit.x)];
    }
    sums[thread] = total;
    add_up(thread, RUNS);
    var place = sums[thread] - total;
    for (var tile = thread * run; tile < end; tile++) {
        let own = places[of_tile(tile, digit.x)];
        places[of_tile(tile, digit.x)] = place;
        place += own;
    }
    if thread == RUNS - 1u {
        places[digit.x] = sums[thread];
    }
}

// Which of the 256 pairs at hand have a digit: eight words of bits for each.
var<workgroup> holders: array<atomic<u32>, 2048>;
var<workgroup> next_places: array<u32, 256>;

@compute @workgroup_size(256)
fn move_pairs(@builtin(workgroup_id) tile: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let with_digit = places[thread];
    sums[thread] = with_digit;
    add_up(thread, 256u);
    next_places[thread] = sums[thread] - with_digit + places[of_tile(tile.x, thread)];
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
