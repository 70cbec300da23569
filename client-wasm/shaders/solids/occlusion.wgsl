// Occlusion culling of solids in two phases (Haar & Aaltonen 2015): those that were visible in the previous frame are drawn first, and of the others
// those that the depth pyramid of these does not hide. Lists keep the order of the instances, so that a picture does not depend on chance.

import package::constants::{DRAW_WORDS, INSTANCE_LIMIT, MESH_LIMIT, WORKGROUP_SIZE};
import package::inputs::depth_pyramid::is_sphere_hidden;

// Bounding sphere of an instance in view.
struct Bounds {
    centre_m: vec3<f32>,
    radius_m: f32,
}

// Consecutive instances of a mesh.
struct MeshRun {
    first: u32,
    count: u32,
}

@group(1) @binding(0) var<storage, read> bounds: array<Bounds>;
@group(1) @binding(1) var<storage, read> runs: array<MeshRun>;
// Index in `visible` of each instance: the same one in all frames.
@group(1) @binding(2) var<storage, read> marks: array<u32>;
// Whether each solid of the scene was visible when it was last in view.
@group(1) @binding(3) var<storage, read_write> visible: array<u32>;
// Whether each instance was listed by `list_known`.
@group(1) @binding(4) var<storage, read_write> known: array<u32>;
// Instances that are drawn in the first phase, then those drawn in the second one.
@group(1) @binding(5) var<storage, read_write> order: array<u32>;
// Indirect draws of the first phase, then of the second one.
@group(1) @binding(6) var<storage, read_write> draws: array<u32>;

var<workgroup> kept: array<u32, WORKGROUP_SIZE>;

// Number of kept invocations before this one, and in the workgroup.
fn ranked(is_kept: bool, local: u32) -> vec2<u32> {
    kept[local] = u32(is_kept);
    workgroupBarrier();
    var rank = vec2<u32>(0u);
    for (var i = 0u; i < WORKGROUP_SIZE; i++) {
        rank += vec2<u32>(select(0u, kept[i], i < local), kept[i]);
    }
    workgroupBarrier();
    return rank;
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn list_known(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let run = runs[group.x];
    var total = 0u;
    for (var first = 0u; first < run.count; first += WORKGROUP_SIZE) {
        let at = run.first + min(first + local, run.count - 1u);
        let is_own = first + local < run.count;
        let is_known = is_own && visible[marks[at]] != 0u;
        if is_own {
            known[at] = u32(is_known);
        }
        let rank = ranked(is_known, local);
        if is_known {
            order[run.first + total + rank.x] = at;
        }
        total += rank.y;
    }
    if local == 0u {
        draws[group.x * DRAW_WORDS + 1u] = total;
    }
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn list_new(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let run = runs[group.x];
    var total = 0u;
    for (var first = 0u; first < run.count; first += WORKGROUP_SIZE) {
        let at = run.first + min(first + local, run.count - 1u);
        let is_own = first + local < run.count;
        let is_visible = is_own && !is_sphere_hidden(bounds[at].centre_m, bounds[at].radius_m);
        let is_new = is_visible && known[at] == 0u;
        if is_own {
            visible[marks[at]] = u32(is_visible);
        }
        let rank = ranked(is_new, local);
        if is_new {
            order[INSTANCE_LIMIT + run.first + total + rank.x] = at;
        }
        total += rank.y;
    }
    if local == 0u {
        draws[(MESH_LIMIT + group.x) * DRAW_WORDS + 1u] = total;
    }
}
