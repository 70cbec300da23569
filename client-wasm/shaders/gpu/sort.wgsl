// Stable radix sort of pairs of a key and a number, one eight-bit digit at a time, least significant digit first. A counter on the GPU
// holds the number of pairs.
//
// A digit takes three dispatches: each tile of pairs counts its digits; one workgroup for each of the 256 values turns the counts into
// positions among the pairs with that value; each tile adds the start of its value and writes its pairs there. Workgroups never wait for
// each other, and no subgroup operations are needed.

import package::constants::{DIGITS, SORT_TILE, WORKGROUP_SIZE};
import package::uniforms::SortDigit;

@group(1) @binding(0) var<storage, read> counters: array<u32>;
@group(1) @binding(1) var<uniform> sorting: SortDigit;
// Number of tiles, as the arguments of an indirect dispatch.
@group(1) @binding(2) var<storage, read_write> dispatched: array<u32>;
@group(1) @binding(3) var<storage, read> unsorted: array<vec2<u32>>;
@group(1) @binding(4) var<storage, read_write> sorted: array<vec2<u32>>;
// Number of pairs with each digit; then 256 counts per tile, which become the positions of the tile's first pair with each digit among
// all pairs with that digit.
@group(1) @binding(5) var<storage, read_write> places: array<u32>;

fn pair_count() -> u32 {
    return min(counters[sorting.counter], sorting.limit);
}

fn tile_count() -> u32 {
    return (pair_count() + SORT_TILE - 1u) / SORT_TILE;
}

fn digit_of(key: u32) -> u32 {
    return (key >> sorting.lowest_bit) & (DIGITS - 1u);
}

// Index of the count of a digit in a tile.
fn of_tile(tile: u32, digit: u32) -> u32 {
    return (tile + 1u) * DIGITS + digit;
}

@compute @workgroup_size(1)
fn plan_tiles() {
    dispatched[0] = tile_count();
    dispatched[1] = 1u;
    dispatched[2] = 1u;
}

var<workgroup> tile_counts: array<atomic<u32>, DIGITS>;

@compute @workgroup_size(DIGITS)
fn count_digits(@builtin(workgroup_id) tile: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    atomicStore(&tile_counts[thread], 0u);
    workgroupBarrier();
    for (var at = tile.x * SORT_TILE + thread; at < min((tile.x + 1u) * SORT_TILE, pair_count()); at += DIGITS) {
        atomicAdd(&tile_counts[digit_of(unsorted[at].x)], 1u);
    }
    workgroupBarrier();
    places[of_tile(tile.x, thread)] = atomicLoad(&tile_counts[thread]);
}

var<workgroup> sums: array<u32, DIGITS>;

// Inclusive prefix sum of the first `count` elements of `sums`, one per thread.
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

// Threads per digit value, each with a run of tiles.
const RUNS: u32 = WORKGROUP_SIZE;

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

// Bit mask, per digit value, of the 256 current pairs that have it: eight words each.
var<workgroup> holders: array<atomic<u32>, 8u * DIGITS>;
var<workgroup> next_places: array<u32, DIGITS>;

@compute @workgroup_size(DIGITS)
fn move_pairs(@builtin(workgroup_id) tile: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    let with_digit = places[thread];
    sums[thread] = with_digit;
    add_up(thread, DIGITS);
    next_places[thread] = sums[thread] - with_digit + places[of_tile(tile.x, thread)];
    for (var word = 0u; word < 8u; word++) {
        atomicStore(&holders[thread * 8u + word], 0u);
    }
    let count = pair_count();
    for (var first = 0u; first < SORT_TILE; first += DIGITS) {
        workgroupBarrier();
        let at = tile.x * SORT_TILE + first + thread;
        var pair = vec2<u32>(0u);
        var digit = 0u;
        if at < count {
            pair = unsorted[at];
            digit = digit_of(pair.x);
            atomicOr(&holders[digit * 8u + thread / 32u], 1u << (thread % 32u));
        }
        workgroupBarrier();
        if at < count {
            // Offset: the number of earlier pairs with the same digit.
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
