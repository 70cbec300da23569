// Simulation of a blade: three links, their modes and contacts. Twin of shared/src/plant/blade, with the same constants and order of
// operations.

import package::constants::{
    AMPLITUDES, ARCTANGENT, BRAKES, CLEARANCE_M, COSINE, DRAG_LEANS, EULER, EXCESS_LEAN, FREQUENCIES, HANGING_RAD2, LAID_LEANS, LAID_RAD4, LINKS,
    LOST_LEANS, LOST_PER_RAD2, MEAN_LEAN, MODES, SINC, VERLET,
};
import package::inputs::frame::{frame, runtime_zero};
import package::uniforms::Slab;

// State of a link, as vectors on the ground.
struct Link {
    // Lean from upright (rad).
    lean_rad: vec2<f32>,
    // Its rate of change (rad/s).
    rate_rad_per_s: vec2<f32>,
}

// State of a blade.
struct Sway {
    links: array<Link, 3>,
}

// Mechanical properties of a blade.
struct BladeNature {
    // Length (m).
    length_m: f32,
    // Lowest natural frequency (rad/s).
    frequency_rad_per_s: f32,
    // Damping ratio.
    damping_ratio: f32,
    // Lean by a wind of 1 m/s (rad s²/m²).
    lean_per_wind2: f32,
}

// Propagator of a mode over a step, on distance x and rate v: x' = x + stay·x + glide·v, v' = v + pull·x + brake·v.
fn propagator(integrator: u32, omega: f32, gamma: f32, dt: f32) -> vec4<f32> {
    let omega2 = omega * omega;
    let way = integrator + u32(runtime_zero(omega));
    if way == EULER || way == VERLET {
        let pull = -omega2 * dt;
        let brake = -2.0 * gamma * dt;
        return select(vec4<f32>(pull * dt, dt + brake * dt, pull, brake), vec4<f32>(0.0, dt, pull, brake), integrator == EULER);
    }
    let h = dt / 8.0;
    let twelfth = h * h / 12.0;
    let gamma2 = 2.0 * gamma;
    let a = 1.0 - omega2 * twelfth;
    let down = -(0.5 * h + gamma2 * twelfth);
    let norm = a * a - gamma2 * a * down + omega2 * down * down;
    var e = omega2 * down * h / norm;
    var p = a * h / norm;
    for (var i = 0; i < 3; i++) {
        let squared = 2.0 * e + e * e - omega2 * p * p;
        p = p * (2.0 + 2.0 * e - gamma2 * p);
        e = squared;
    }
    return vec4<f32>(e, p, -omega2 * p, e - gamma2 * p);
}

// Leans of the links (rad) along X and Z in equilibrium with drag on the control points (rad).
struct Deflection {
    x: vec3<f32>,
    z: vec3<f32>,
}

// Scalar product, summed in the order of the twin.
fn weighted(weights: vec3<f32>, values: vec3<f32>) -> f32 {
    return weights.x * values.x + weights.y * values.y + weights.z * values.z;
}

// Leans by drag along one axis for small loads.
fn drag_leans(drag: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(weighted(DRAG_LEANS[0], drag), weighted(DRAG_LEANS[1], drag), weighted(DRAG_LEANS[2], drag));
}

// Twin of shared/src/plant/blade/deflection.rs.
fn deflection(drag_x: vec3<f32>, drag_z: vec3<f32>) -> Deflection {
    let mean = vec2<f32>(weighted(MEAN_LEAN, drag_x), weighted(MEAN_LEAN, drag_z));
    let rad2 = dot(mean, mean);
    let gained = rad2 * rad2 / (LAID_RAD4 + rad2 * rad2) * mean;
    let lost = rad2 / (1.0 + LOST_PER_RAD2 * rad2) * vec2<f32>(weighted(EXCESS_LEAN, drag_x), weighted(EXCESS_LEAN, drag_z));
    return Deflection(
        drag_leans(drag_x) + LAID_LEANS * gained.x - LOST_LEANS * lost.x,
        drag_leans(drag_z) + LAID_LEANS * gained.y - LOST_LEANS * lost.y,
    );
}

fn advance(sway: Sway, blade: BladeNature, held: array<vec2<f32>, 3>, winds_m_per_s: array<vec2<f32>, 3>, integrator: u32, dt: f32) -> Sway {
    var old = sway;
    var held_in = held;
    var winds_in = winds_m_per_s;
    let link = blade.length_m * (1.0 / 3.0);
    var own = vec2<f32>(0.0);
    var past = vec3<f32>(0.0);
    var drag_x = vec3<f32>(0.0);
    var drag_z = vec3<f32>(0.0);
    for (var j = 0; j < LINKS; j++) {
        own += link * old.links[j].rate_rad_per_s;
        past[j] = length(winds_in[j] - own) * blade.lean_per_wind2;
        drag_x[j] = winds_in[j].x * past[j];
        drag_z[j] = winds_in[j].y * past[j];
    }
    let braked = 0.5 * blade.length_m * blade.frequency_rad_per_s * blade.frequency_rad_per_s;
    let blown = deflection(drag_x, drag_z);
    let apart_x = vec3<f32>(old.links[0].lean_rad.x, old.links[1].lean_rad.x, old.links[2].lean_rad.x)
        - vec3<f32>(held_in[0].x, held_in[1].x, held_in[2].x) - blown.x;
    let apart_z = vec3<f32>(old.links[0].lean_rad.y, old.links[1].lean_rad.y, old.links[2].lean_rad.y)
        - vec3<f32>(held_in[0].y, held_in[1].y, held_in[2].y) - blown.z;
    let rate_x = vec3<f32>(old.links[0].rate_rad_per_s.x, old.links[1].rate_rad_per_s.x, old.links[2].rate_rad_per_s.x);
    let rate_z = vec3<f32>(old.links[0].rate_rad_per_s.y, old.links[1].rate_rad_per_s.y, old.links[2].rate_rad_per_s.y);
    var to = sway;
    for (var m = 0; m < LINKS; m++) {
        var frequencies = FREQUENCIES;
        var modes = MODES;
        var amplitudes = AMPLITUDES;
        var brakes = BRAKES;
        let omega = blade.frequency_rad_per_s * frequencies[m];
        let step = propagator(integrator, omega, blade.damping_ratio * omega + braked * weighted(brakes[m], past), dt);
        let x = vec2<f32>(weighted(amplitudes[m], apart_x), weighted(amplitudes[m], apart_z));
        let v = vec2<f32>(weighted(amplitudes[m], rate_x), weighted(amplitudes[m], rate_z));
        let moved = step.x * x + step.y * v;
        let faster = step.z * x + step.w * v;
        for (var i = 0; i < LINKS; i++) {
            to.links[i].lean_rad += modes[m][i] * moved;
            to.links[i].rate_rad_per_s += modes[m][i] * faster;
        }
    }
    return to;
}

// Unit vector of a link with a lean (rad, as a vector on the ground): Taylor polynomials, as in the twin.
fn direction_of(lean: vec2<f32>) -> vec3<f32> {
    let t = min(dot(lean, lean), HANGING_RAD2);
    var up = COSINE[8];
    up = up * t + COSINE[7];
    up = up * t + COSINE[6];
    up = up * t + COSINE[5];
    up = up * t + COSINE[4];
    up = up * t + COSINE[3];
    up = up * t + COSINE[2];
    up = up * t + COSINE[1];
    up = up * t + COSINE[0];
    var aside = SINC[8];
    aside = aside * t + SINC[7];
    aside = aside * t + SINC[6];
    aside = aside * t + SINC[5];
    aside = aside * t + SINC[4];
    aside = aside * t + SINC[3];
    aside = aside * t + SINC[2];
    aside = aside * t + SINC[1];
    aside = aside * t + SINC[0];
    return vec3<f32>(lean.x * aside, up, lean.y * aside);
}

fn lean_of(direction: vec3<f32>) -> vec2<f32> {
    let aside = length(direction.xz);
    let hangs = direction.y < 0.0;
    var tangent = select(aside, 1.0 - direction.y, hangs) / select(1.0 + direction.y, max(aside, 1e-9), hangs);
    tangent /= 1.0 + sqrt(1.0 + tangent * tangent);
    tangent /= 1.0 + sqrt(1.0 + tangent * tangent);
    let t = tangent * tangent;
    var angle = ARCTANGENT[6];
    angle = angle * t + ARCTANGENT[5];
    angle = angle * t + ARCTANGENT[4];
    angle = angle * t + ARCTANGENT[3];
    angle = angle * t + ARCTANGENT[2];
    angle = angle * t + ARCTANGENT[1];
    angle = (angle * t + ARCTANGENT[0]) * 8.0 * tangent;
    return select(direction.xz * (angle / max(aside, 1e-9)), vec2<f32>(angle, 0.0), hangs && aside < 1e-9);
}

// Offsets of the control points above the root from it (m).
fn points_of(sway: Sway, length_m: f32) -> array<vec3<f32>, 3> {
    var old = sway;
    var points: array<vec3<f32>, 3>;
    var at = vec3<f32>(0.0);
    for (var i = 0; i < LINKS; i++) {
        at += (length_m * (1.0 / 3.0)) * direction_of(old.links[i].lean_rad);
        points[i] = at;
    }
    return points;
}

// Unit vector whose component along `axis` is `fraction`, turned from `out`.
fn toward(out: vec3<f32>, axis: vec3<f32>, fraction: f32) -> vec3<f32> {
    var rest = out - axis * dot(out, axis);
    if dot(rest, rest) < 1e-12 {
        let least = select(vec3<f32>(0.0, 0.0, 1.0), vec3<f32>(1.0, 0.0, 0.0), abs(axis.x) < 0.6);
        rest = least - axis * dot(least, axis);
    }
    return axis * fraction + rest * sqrt(max(1.0 - fraction * fraction, 0.0) / dot(rest, rest));
}

// Direction of a link from `below` that passes outside a sphere around `centre` (both from the root), as near to `along` as possible.
fn aside_of(along: vec3<f32>, below: vec3<f32>, link: f32, centre: vec3<f32>, radius: f32) -> vec3<f32> {
    let to = centre - below;
    let distance_m = max(length(to), 1e-6);
    let tangent2 = dot(to, to) - radius * radius;
    let ahead = dot(along, to);
    var cosine = -sqrt(max(-tangent2, 0.0)) / distance_m;
    if tangent2 > 0.0 {
        let entry2 = ahead * ahead - tangent2;
        if ahead <= 0.0 || entry2 <= 0.0 || ahead - sqrt(max(entry2, 0.0)) >= link {
            return along;
        }
        let tangent = sqrt(tangent2);
        cosine = select(0.5 * (link + tangent2 / link), tangent, link >= tangent) / distance_m;
    }
    if ahead <= cosine * distance_m {
        return along;
    }
    let out = select(along, vec3<f32>(-to.x, 0.0, -to.z), dot(to.xz, to.xz) < radius * radius);
    return toward(out, to / distance_m, clamp(cosine, -1.0, 1.0));
}

// Whether a point is within the outline of the slabs, in their own axes (m).
fn is_in_outline(p: vec2<f32>) -> bool {
    let corners = i32(frame.slabs.corner_count) + i32(runtime_zero(p.x));
    var is_in = false;
    var a = frame.slabs.outline[max(corners - 1, 0)].at_m;
    for (var i = 0; i < corners; i++) {
        let b = frame.slabs.outline[i].at_m;
        let crosses = (a.y <= p.y) != (b.y <= p.y) && a.x + (b.x - a.x) * ((p.y - a.y) / (b.y - a.y)) > p.x;
        is_in = is_in != crosses;
        a = b;
    }
    return is_in;
}

// Direction of a link from `below` (from the root) that ends below the floor of a slab if it starts under the slab or ends within it, as
// near to `along` as possible.
fn beneath(along: vec3<f32>, below: vec3<f32>, link: f32, root: vec3<f32>, slab: Slab) -> vec3<f32> {
    let start = below - (slab.centre_m - root);
    let reach = slab.reach_m + link;
    if dot(start, start) > reach * reach {
        return along;
    }
    let end = start + along * link;
    let up = cross(slab.back, slab.right);
    let low = dot(start, up);
    let high = dot(end, up);
    let starts = is_in_outline(vec2<f32>(dot(start, slab.right), dot(start, slab.back)));
    let ends = high < slab.half_height_m && is_in_outline(vec2<f32>(dot(end, slab.right), dot(end, slab.back)));
    if high <= -slab.half_height_m || low >= slab.half_height_m || !(starts || ends) {
        return along;
    }
    return toward(along, up, clamp((-slab.half_height_m - low) / link, -1.0, 1.0));
}

// Whether there are interaction spheres or slabs. Fixed at pipeline creation, since software drivers execute one iteration even of an empty
// loop.
override meets_spheres: bool = true;

// Resolves contacts of a blade with the ground, the interaction spheres and the slabs; links above the first that meets a sphere or a slab
// continue in its direction.
fn settle(sway: Sway, length_m: f32, normal: vec3<f32>, root: vec3<f32>) -> Sway {
    let link = length_m / 3.0;
    let spheres = i32(frame.sphere_count) + i32(runtime_zero(root.x));
    let slabs = i32(frame.slabs.count) + i32(runtime_zero(root.x));
    var settled = sway;
    var below = vec3<f32>(0.0);
    var tangent = vec3<f32>(0.0);
    for (var i = 0; i < LINKS; i++) {
        let own = direction_of(settled.links[i].lean_rad);
        var along = select(own, tangent, dot(tangent, tangent) > 0.0);
        var is_turned = false;
        if meets_spheres {
            for (var round = 0; round < 2; round++) {
                for (var s = 0; s < spheres; s++) {
                    let sphere = frame.spheres[s];
                    let turned = aside_of(along, below, link, sphere.centre_m - root, sphere.radius_m);
                    is_turned = is_turned || any(turned != along);
                    along = turned;
                }
            }
            for (var s = 0; s < slabs; s++) {
                let turned = beneath(along, below, link, root, frame.slabs.list[s]);
                is_turned = is_turned || any(turned != along);
                along = turned;
            }
        }
        if is_turned {
            tangent = along;
        }
        let needed = min((CLEARANCE_M - dot(below, normal)) / link, 1.0);
        if dot(along, normal) < needed {
            along = toward(along, normal, needed);
        }
        if any(along != own) {
            let lean = lean_of(along);
            let moved = lean - settled.links[i].lean_rad;
            let rate = settled.links[i].rate_rad_per_s;
            let approach = min(dot(rate, moved), 0.0) / max(dot(moved, moved), 1e-20);
            settled.links[i] = Link(lean, rate - approach * moved);
        }
        below += along * link;
    }
    return settled;
}
