// Underbrush: how each plant is bent in this frame, which of them are seen and at which level of detail; then their rows, blended
// between postures made beforehand (004 section 4.2), widened to ribbons.

struct UnderbrushFrame {
    // Number of the frame; unused.
    counts: vec4<u32>,
    // Time since the frame before (s); distance at which plants have shrunk to nothing (m); height of the force field (m); unused.
    shape: vec4<f32>,
    // Corner of the force field and its extent, X and Z (m).
    forces: vec4<f32>,
    // Of each species: height (m), time constant (s), how far it reaches from its root at most (m), unused.
    species: array<vec4<f32>, 16>,
    // First place of the species among the listed plants, places of each of its levels, unused.
    places: array<vec4<u32>, 16>,
}

// A plant: place (m), size, species in the low byte, its make in the next, its site in the upper half of `site`.
struct Grown {
    at: vec2<f32>,
    size: f32,
    make: u32,
    heading: f32,
    site: u32,
}

// What a plant feels, as it follows the force field (004 section 4.3): pressure (Pa) and its rate; the frame that it was last seen in.
struct Felt {
    pressure: vec4<f32>,
    frame: u32,
}

// A plant as it is drawn: root (m) and size; lean (rad), light and heading; row of its posture's first, steps to the next heading and
// strength, and how far it is towards them.
struct Stand {
    root: vec4<f32>,
    lean: vec4<f32>,
    posture: vec4<f32>,
    towards: vec4<f32>,
}

struct Tally {
    drawn: array<atomic<u32>, 64>,
}

@group(1) @binding(0) var<uniform> brush: UnderbrushFrame;
@group(1) @binding(1) var<storage, read> grown: array<Grown>;
@group(1) @binding(2) var<storage, read> chunks: array<vec2<u32>>;
@group(1) @binding(3) var<storage, read_write> felt: array<Felt>;
@group(1) @binding(4) var<storage, read_write> stands_out: array<Stand>;
@group(1) @binding(5) var<storage, read_write> tally: Tally;
@group(1) @binding(6) var<storage, read_write> listed: array<u32>;
@group(1) @binding(7) var<storage, read> broken: array<u32>;
@group(1) @binding(8) var<storage, read_write> brush_draws: array<u32>;
@group(1) @binding(9) var forces: texture_3d<f32>;

const HEADINGS: u32 = 8u;
const STRENGTHS: u32 = 7u;
const VARIANTS: u32 = 4u;
const MIDDLE_PA: f32 = 8.0;
const STRONGEST: f32 = 0.93;
const LEVELS: u32 = 4u;

// Force on a silhouette (Pa, X and Z) so high above the ground at a root: that of the force field, or beyond it that of the wind alone.
fn pressure_at(root: vec3<f32>, above_m: f32) -> vec2<f32> {
    let at = (root.xz - brush.forces.xy) / brush.forces.zw;
    let inside = 1.0 - smoothstep(0.40, 0.49, max(abs(at.x - 0.5), abs(at.y - 0.5)));
    // Of the wind, and of what lingers of impulses.
    var force = vec4<f32>(0.0);
    if inside > 0.0 {
        force = textureSampleLevel(forces, clamped, vec3<f32>(at, above_m / brush.shape.z), 0.0) * inside;
    }
    if inside < 1.0 {
        let wind = wind_at(root, above_m);
        force += vec4<f32>(wind.xz * (0.6 * length(wind) * (1.0 - inside)), 0.0, 0.0);
    }
    // The wind comes in gusts, and is stiller down among the plants: a quarter-power law of the height, over the 2 m that the field's wind is from.
    let gust = gust_at(root.xz);
    return force.xy * (gust * gust * sqrt(clamp(0.5 * above_m, 0.02, 1.0))) + force.zw;
}

// A value that follows a target by a critically damped spring, in closed form; twin of `Following` in
// shared/src/plant/underbrush/constraint.rs.
fn followed(state: vec4<f32>, goal: vec2<f32>, settle_secs: f32, dt: f32) -> vec4<f32> {
    let taus = dt / settle_secs;
    let decay = exp(-taus);
    let off = state.xy - goal;
    let value = goal + off * ((1.0 + taus) * decay) + state.zw * (dt * decay);
    return vec4<f32>(value, off * (-taus / settle_secs * decay) + state.zw * ((1.0 - taus) * decay));
}

@compute @workgroup_size(64)
fn stand(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let chunk = chunks[group.x];
    if local >= chunk.y {
        return;
    }
    let index = chunk.x + local;
    let plant = grown[index];
    let species = plant.make & 255u;
    let nature = brush.species[species];
    let height = nature.x * plant.size;
    let root = vec3<f32>(plant.at.x, ground_height(plant.at), plant.at.y);
    let tall = max(height, 0.5 * nature.z * plant.size);
    let distance_m = distance(root + vec3<f32>(0.0, 0.5 * tall, 0.0), frame.eye.xyz);
    let reach_m = brush.shape.y;
    if distance_m > reach_m || !is_seen(root, nature.z * plant.size * 1.8) {
        return;
    }
    // What is but a few pixels tall thins out, and what is left is larger.
    let tall_px = tall / (distance_m * frame.screen.z);
    let kept = clamp(tall_px / 7.0, 0.12, 1.0);
    let lot = random3(vec2<i32>(i32(plant.site), 5), 91u).x;
    let left = clamp((kept - lot) / (0.2 * kept), 0.0, 1.0) * (1.0 - smoothstep(0.8, 1.0, distance_m / reach_m));
    if left <= 0.01 {
        return;
    }

    let goal = pressure_at(root, 0.5 * height);
    var feels = felt[index];
    if feels.frame + 1u != brush.counts.x {
        feels.pressure = vec4<f32>(goal, 0.0, 0.0);
    } else {
        feels.pressure = followed(feels.pressure, goal, nature.y, brush.shape.x);
    }
    feels.frame = brush.counts.x;
    felt[index] = feels;

    var lean = lean_of_field(plant.at, 0.0);
    for (var s = 0; s < i32(frame.clouds.w); s++) {
        let sphere = frame.spheres[s];
        let away = plant.at - sphere.xz;
        let apart = length(away);
        let deep = clamp((root.y + height - sphere.y + sphere.w) / height, 0.0, 1.0);
        let pushed = 1.3 * deep * (1.0 - apart / sphere.w);
        if pushed > length(lean) {
            lean = away / max(apart, 1e-3) * pushed;
        }
    }
    let tilt = length(lean);
    lean *= min(1.0, 1.5 / max(tilt, 1e-5));

    let pressure = feels.pressure.xy;
    let size_pa = length(pressure);
    let toward = select(0.0, atan2(pressure.y, pressure.x), size_pa > 1e-6);
    let angle = fract((toward - plant.heading) / TAU + 1.0) * f32(HEADINGS);
    let heading = u32(angle) % HEADINGS;
    let strength = min(size_pa / (size_pa + MIDDLE_PA) / STRONGEST, 0.9999) * f32(STRENGTHS - 1u);
    let is_broken = (broken[plant.site >> 5u] >> (plant.site & 31u)) & 1u;
    let make = (plant.make >> 8u) % VARIANTS + is_broken * VARIANTS;
    let posture = (make * HEADINGS + heading) * STRENGTHS + u32(strength);
    let next_heading = (make * HEADINGS + (heading + 1u) % HEADINGS) * STRENGTHS + u32(strength);

    var out: Stand;
    out.root = vec4<f32>(root, plant.size * left * pow(kept, -0.5));
    let lit = root + vec3<f32>(0.0, 0.6 * height, 0.0);
    out.lean = vec4<f32>(lean, cloud_light(plant.at) * sun_visible(lit), plant.heading);
    out.posture = vec4<f32>(bitcast<f32>(posture), bitcast<f32>(next_heading), fract(angle), fract(strength));
    out.towards = vec4<f32>(height, random3(vec2<i32>(i32(plant.site), 9), 17u).x, distance_m, 0.0);
    stands_out[index] = out;

    let level = select(select(select(3u, 2u, tall_px > 26.0), 1u, tall_px > 90.0), 0u, tall_px > 300.0);
    let list = species * LEVELS + level;
    let number = atomicAdd(&tally.drawn[list], 1u);
    let places = brush.places[species];
    listed[places.x + level * places.y + number] = index;
}

// Indirect draws: as many instances as hold the listed plants; word 5 of each is how many plants an instance holds.
@compute @workgroup_size(64)
fn finish(@builtin(local_invocation_index) list: u32) {
    let held = brush_draws[list * 8u + 5u];
    brush_draws[list * 8u + 1u] = (atomicLoad(&tally.drawn[list]) + held - 1u) / max(held, 1u);
}

// --- drawing ----------------------------------------------------------------------------------------------------------

struct BrushList {
    // Rows of a plant; plants in an instance; unused.
    rows: vec4<u32>,
    // Number of the list; first of the listed plants; 1 if the nearest posture will do; unused.
    which: vec4<u32>,
    // Unit of the places of rows (m); drops of rain that make leaves tremble (1/(m²·s)); unused.
    scale: vec4<f32>,
}

@group(1) @binding(10) var<storage, read> stands: array<Stand>;
@group(1) @binding(11) var<storage, read> shown: array<u32>;
@group(1) @binding(12) var<storage, read> counted: array<u32>;
@group(1) @binding(13) var<storage, read> postures: array<u32>;
@group(1) @binding(14) var<storage, read> looks: array<vec4<u32>>;
@group(1) @binding(15) var<uniform> list: BrushList;

const WIDTH_UNIT_M: f32 = 1.0 / 16384.0;
const DROP_M_PER_S: f32 = 6.49;
const SETTLE_FULL_SECS: f32 = 4.0;
const CATCHES_FULL_M2: f32 = 0.1;
// Share of its length by which a component dips at most; then its own weight has bent it as far as it goes.
const FARTHEST_DIP: f32 = 0.25;
const STALK: u32 = 1u;
const PETAL: u32 = 2u;

struct Ribbon {
    @builtin(position) position: vec4<f32>,
    @location(0) color: vec3<f32>,
    // From the left border, -1, to the right one, 1; beyond that where there is no fold between them.
    @location(1) @interpolate(linear) across: f32,
}

struct BentRow {
    at: vec3<f32>,
    side: vec3<f32>,
    along: vec3<f32>,
}

fn octahedral(word: u32) -> vec3<f32> {
    let flat = vec2<f32>(vec2<i32>(i32(word << 24u) >> 24u, i32(word << 16u) >> 24u)) / 127.0;
    let y = 1.0 - abs(flat.x) - abs(flat.y);
    let folded = (1.0 - abs(flat.yx)) * select(vec2<f32>(-1.0), vec2<f32>(1.0), flat >= vec2<f32>(0.0));
    let xz = select(flat, folded, y < 0.0);
    return normalize(vec3<f32>(xz.x, y, xz.y));
}

fn row_of(posture: u32, row: u32) -> BentRow {
    let at = (posture * list.rows.x + row) * 3u;
    let a = postures[at];
    let b = postures[at + 1u];
    let place = vec3<f32>(vec3<i32>(i32(a << 16u) >> 16u, i32(a) >> 16u, i32(b << 16u) >> 16u));
    return BentRow(place / 32767.0, octahedral(b >> 16u), octahedral(postures[at + 2u]));
}

fn blended(a: BentRow, b: BentRow, share: f32) -> BentRow {
    return BentRow(mix(a.at, b.at, share), mix(a.side, b.side, share), mix(a.along, b.along, share));
}

// Turned about the upright by a heading, then tipped by a lean.
fn turned(v: vec3<f32>, heading: f32, lean: vec2<f32>) -> vec3<f32> {
    let c = cos(heading);
    let s = sin(heading);
    let p = vec3<f32>(v.x * c - v.z * s, v.y, v.x * s + v.z * c);
    let angle = length(lean);
    if angle < 1e-4 {
        return p;
    }
    let axis = vec3<f32>(lean.y, 0.0, -lean.x) / angle;
    return p * cos(angle) + cross(axis, p) * sin(angle) + axis * (dot(axis, p) * (1.0 - cos(angle)));
}

// How far drops of rain have struck the tip of a component out of its posture (m), if they strike it straight: `speed` and `settle` are those of `Struck` in
// shared/src/plant/underbrush/drops.rs, `per_s` how many come; `number` tells the component from others. In each span of `settle` one strikes somewhere on it, or
// none. Where more come than every other span takes, strikes are as strong as the root of their number and the rest press steadily: so the mean is that of
// drops that come singly, and the deviation at least 0.84 of theirs.
fn dip_m(speed: f32, settle: f32, per_s: f32, number: vec2<u32>, secs: f32) -> f32 {
    let drops = per_s * settle;
    let chance = min(drops, 0.5);
    let strength = sqrt(drops / chance);
    // The mean of `bow` over the component.
    var dip = 0.375 * (drops - chance * strength);
    let now = secs / settle;
    let span = i32(floor(now));
    for (var i = 0; i < 8; i++) {
        let lot = random3(vec2<i32>(span - i, i32(number.x)), number.y);
        let since = now - (f32(span - i) + lot.x);
        if since > 0.0 && lot.y < chance {
            dip += strength * bow(lot.z) * since * exp(-since);
        }
    }
    return speed * settle * dip;
}

// Shape of a cantilever that a force at its tip has bent by 1 there.
fn bow(share: f32) -> f32 {
    return share * share * (1.5 - 0.5 * share);
}

@vertex
fn vs(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Ribbon {
    let rows = list.rows.x;
    let number = instance * list.rows.y + index / (2u * rows);
    let local = index % (2u * rows);
    let row = local / 2u;
    var out: Ribbon;
    if number >= counted[list.which.x] {
        out.position = vec4<f32>(0.0, 0.0, 0.0, 1.0);
        return out;
    }
    let plant = stands[shown[list.which.y + number]];
    let posture = bitcast<u32>(plant.posture.x);
    let aside = bitcast<u32>(plant.posture.y);
    var bent: BentRow;
    if list.which.z == 1u {
        let near = select(posture, aside, plant.posture.z > 0.5) + select(0u, 1u, plant.posture.w > 0.5);
        bent = row_of(near, row);
    } else {
        let lower = blended(row_of(posture, row), row_of(aside, row), plant.posture.z);
        let upper = blended(row_of(posture + 1u, row), row_of(aside + 1u, row), plant.posture.z);
        bent = blended(lower, upper, plant.posture.w);
    }
    let look = looks[posture / (HEADINGS * STRENGTHS) * rows + row];
    let stuff = (look.x >> 16u) & 3u;
    let size = plant.root.w;
    let distance_m = plant.towards.z;
    var offset = turned(bent.at, plant.lean.w, plant.lean.xy) * (list.scale.x * size);
    let along = normalize(turned(bent.along, plant.lean.w, plant.lean.xy));
    if list.scale.y > 0.0 {
        let struck = unpack2x16unorm(look.z) * vec2<f32>(DROP_M_PER_S, SETTLE_FULL_SECS);
        let per_s = unpack2x16unorm(look.w).x * CATCHES_FULL_M2 * size * size * list.scale.y;
        if per_s > 0.0 {
            let number = vec2<u32>(u32(plant.towards.y * 16777216.0), look.w >> 24u);
            // The larger it is, the less the drop counts beside its mass.
            let speed = 1.0 / mix(1.0 / DROP_M_PER_S, 1.0 / struck.x, size * size * size);
            let dip = min(dip_m(speed, struck.y * size, per_s, number, frame.eye.w), FARTHEST_DIP * f32(look.x >> 18u) * 0.001 * size);
            // Along the leaf it does not give.
            offset -= (vec3<f32>(0.0, 1.0, 0.0) - along * along.y) * (dip * bow(f32((look.w >> 16u) & 255u) / 255.0));
        }
    }
    var p = plant.root.xyz + offset;
    let view = normalize(p - frame.eye.xyz);
    let toward = cross(along, view);
    let facing_side = toward / max(length(toward), 1e-3);
    var side = normalize(turned(bent.side, plant.lean.w, plant.lean.xy));
    let across = f32(local & 1u) * 2.0 - 1.0;
    if stuff == STALK {
        side = facing_side;
    } else if stuff != PETAL {
        // A leaf seen edge on still shows some of its width.
        side = normalize(side + facing_side * (0.35 * sign(dot(facing_side, side) + 1e-4)));
    }
    let half = max(f32(look.x & 0xffffu) * WIDTH_UNIT_M * size, select(0.0, 0.45 * distance_m * frame.screen.z, (look.x & 0xffffu) > 0u));
    p += side * (across * half);
    let normal_up = ground_normal(plant.root.xz);
    p += normal_up * max(0.012 - dot(p - plant.root.xyz, normal_up), 0.0);

    var normal = normalize(cross(side, along));
    normal *= -sign(dot(normal, view) + 1e-5);
    let rounded = normalize(normal * select(0.8, 0.55, stuff == STALK) + side * (across * select(0.25, 0.8, stuff == STALK)) + normal_up * 0.35);
    let root_color = vec3<f32>(f32(look.y & 255u), f32((look.y >> 8u) & 255u), f32((look.y >> 16u) & 255u)) / 255.0;
    var albedo = root_color * root_color;
    let hue = plant.towards.y;
    if stuff != PETAL {
        albedo *= grass_tint(plant.root.xz) * mix(vec3<f32>(0.86, 0.98, 0.85), vec3<f32>(1.14, 1.03, 0.9), hue);
    }
    let up = clamp(dot(p - plant.root.xyz, normal_up) / max(plant.towards.x, 0.05), 0.0, 1.0);
    let deep = smoothstep(0.0, 0.6, plant.towards.x);
    let occlusion = mix(mix(0.62, 0.30, deep), 1.0, smoothstep(0.0, 0.8, up));
    let light = plant.lean.z * mix(mix(0.8, 0.42, deep), 1.0, smoothstep(0.05, 0.7, up));
    if stuff == PETAL {
        let sun_facing = dot(normal, frame.sun.xyz);
        let diffuse = clamp((abs(sun_facing) + 0.3) / 1.3, 0.0, 1.0);
        let through = 0.4 * max(dot(view, frame.sun.xyz), 0.0) * clamp(0.6 - sun_facing, 0.0, 1.0);
        let lit = albedo * (frame.sun_color.rgb * light * (diffuse + through) * 0.8 + ambient(rounded));
        out.color = hazed(lit, p);
    } else {
        out.color = hazed(grass_light(albedo, rounded, along, view, light, occlusion), p);
    }
    out.across = select(9.0, across, stuff != STALK && stuff != PETAL);
    out.position = frame.projection_from_world * vec4<f32>(p, 1.0);
    return out;
}

@fragment
fn fs(ribbon: Ribbon) -> @location(0) vec4<f32> {
    // A leaf is folded along its middle: one half lighter than the other, the rib darker.
    let fold = 1.0 + 0.10 * ribbon.across - 0.18 * (1.0 - smoothstep(0.0, 0.25, abs(ribbon.across)));
    return vec4<f32>(ribbon.color * select(fold, 1.0, abs(ribbon.across) > 1.5), 1.0);
}
