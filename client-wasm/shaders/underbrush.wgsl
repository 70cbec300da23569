// Underbrush: what each plant feels in this frame, which of them are seen and at which level of detail; then their components, bent by
// tables of postures made beforehand (004 section 4.2), and widened to ribbons.

struct UnderbrushFrame {
    // Number of the frame, of those in which time passes; 1 to leave out what is not seen; unused.
    counts: vec4<u32>,
    // Time since the frame before (s); distance at which plants have shrunk to nothing (m); height of the force field (m); factor on the heights in the
    // picture below which plants are coarser.
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

// What a plant feels, as it follows the force field (004 section 4.3): pressure (Pa) and its rate; the frame that it was last seen in, of those in which time passes.
struct Felt {
    pressure: vec4<f32>,
    frame: u32,
}

// A plant as it is drawn: root (m), and size as it is shown; lean of the ground (rad), light and heading; pressure that it feels along
// X and Z (Pa), its make and the kind of the grass about it, and the spheres that it may touch, a bit each; height (m), hue, distance (m), and its own size.
struct Stand {
    root: vec4<f32>,
    lean: vec4<f32>,
    feels: vec4<f32>,
    about: vec4<f32>,
    // What the grass about it looks like from afar, and how much of that shows between the plants that are drawn.
    sward: vec4<f32>,
    // Tint of the grass there; unused.
    tint: vec4<f32>,
    // The land's normal; unused.
    up: vec4<f32>,
    // What the air before it adds to its colour, and the share of that which the air lets through.
    air: vec4<f32>,
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
// Which way the plant of each site fell, a byte each.
@group(1) @binding(7) var<storage, read> broken: array<u32>;
@group(1) @binding(8) var<storage, read_write> brush_draws: array<u32>;
@group(1) @binding(9) var forces: texture_3d<f32>;

const VARIANTS: u32 = 4u;
const FALL_PA: f32 = 8.0;
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

// Share of plants that is left at least where they are but a few pixels tall; twin of the constant in `underbrush/mod.rs`.
const FEWEST: f32 = 0.06;

// Pressure (Pa) on a plant that fell that way, in 255ths of a turn; 0: it stands. What is broken is bent there for good, as if pressed so; it lies at a fifth
// of its height, where it feels the square root of that of the air.
fn fallen(pressure: vec2<f32>, fall: u32) -> vec2<f32> {
    let heading = f32(fall) * (TAU / 255.0);
    return select(pressure, 0.45 * pressure + FALL_PA * vec2<f32>(cos(heading), sin(heading)), fall != 0u);
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
    // What is but a few pixels tall thins out, and what is left is larger.
    let tall_px = tall / (distance_m * frame.screen.z);
    let kept = clamp(tall_px / 16.0, FEWEST, 1.0);
    let larger = pow(kept, -0.3);
    let may_show = (brush.counts.y == 0u) | is_seen(root, nature.z * plant.size * larger * 1.8);
    if (distance_m > reach_m) | !may_show {
        return;
    }
    let lot = random3(vec2<i32>(i32(plant.site), 5), 91u).x;
    let left = clamp((kept - lot) / (0.2 * kept), 0.0, 1.0) * (1.0 - smoothstep(0.8, 1.0, distance_m / reach_m));
    if left <= 0.01 {
        return;
    }

    let fall = (broken[plant.site >> 2u] >> (8u * (plant.site & 3u))) & 255u;
    let goal = fallen(pressure_at(root, 0.5 * height), fall);
    var feels = felt[index];
    if brush.counts.x - feels.frame > 1u {
        feels.pressure = vec4<f32>(goal, 0.0, 0.0);
    } else {
        feels.pressure = followed(feels.pressure, goal, nature.y, brush.shape.x);
    }
    feels.frame = select(feels.frame, brush.counts.x, brush.shape.x > 0.0);
    felt[index] = feels;

    var lean = lean_of_field(plant.at, 0.0);
    let tilt = length(lean);
    lean *= min(1.0, 1.5 / max(tilt, 1e-5));

    let make = (plant.make >> 8u) % VARIANTS + select(0u, VARIANTS, fall != 0u);
    let shown_size = plant.size * left * larger;
    var spheres = 0u;
    let every = u32(frame.clouds.w + none_of(height));
    for (var s = 0u; s < every; s++) {
        let sphere = frame.spheres[s];
        spheres |= select(0u, 1u << s, distance(sphere.xyz, root) < sphere.w + nature.z * shown_size);
    }

    var out: Stand;
    out.root = vec4<f32>(root, shown_size);
    let lit = root + vec3<f32>(0.0, 0.6 * height, 0.0);
    out.lean = vec4<f32>(lean, cloud_light(plant.at) * sun_visible(lit), plant.heading);
    let kind_number = kind_at(plant.at);
    let kind = kinds.list[kind_number];
    out.feels = vec4<f32>(feels.pressure.xy, f32(make + 2u * VARIANTS * kind_number), f32(spheres));
    out.about = vec4<f32>(height, random3(vec2<i32>(i32(plant.site), 9), 17u).x, distance_m, plant.size);
    let up = ground_normal(plant.at);
    let view = normalize(root - frame.eye.xyz);
    let tint = grass_tint(plant.at);
    let afar = sward_color(root, up, kind, tint, lean, view, out.lean.z);
    out.sward = vec4<f32>(afar, bare_between(distance_m, kind, view, up) * grass_share(plant.at));
    out.tint = vec4<f32>(tint, 0.0);
    out.up = vec4<f32>(up, 0.0);
    out.air = air_before(root + vec3<f32>(0.0, 0.5 * height, 0.0));
    stands_out[index] = out;

    // Not all of those of a height change at once.
    let fine_px = tall_px / (brush.shape.w * (0.85 + 0.3 * lot));
    let level = select(select(select(3u, 2u, fine_px > 26.0), 1u, fine_px > 90.0), 0u, fine_px > 300.0);
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

// What is seen of a part so far up in the grass (1 at its mean height) that hides it.
fn among_grass(color: vec3<f32>, sward: vec4<f32>, up: f32) -> vec3<f32> {
    return mix(color, sward.rgb, sward.w * (1.0 - smoothstep(0.3, 1.1, up)));
}

// --- drawing ----------------------------------------------------------------------------------------------------------

struct BrushList {
    // Rows of a plant; plants in an instance; components of a plant; unused.
    rows: vec4<u32>,
    // Number of the list; first of the listed plants; 1 if the nearest posture will do; unused.
    which: vec4<u32>,
    // Angles and loads of the tables; unused.
    nodes: vec4<u32>,
    // Drops of rain that make leaves tremble (1/(m²·s)); unused.
    rain: vec4<f32>,
}

// A row: half its width and what it is of, its colour, the component that it is on and the steps below it there, unused; of a petal how
// far it is from the tip of the stalk (m), cosine and sine of its turn about that, and sine of the angle at which it stands off.
struct Row {
    look: vec4<u32>,
    petal: vec4<f32>,
}

// A component: cosine and sine of its angle from what it stands on, and of its turn about that; load per force per mass (s²/m) and per
// pressure (1/Pa), length (m), and where it stands, in steps of what it stands on; first step of its table, its steps, what it stands on,
// and on how many, one on the other; speed (m/s) and time (s) of its answer to a drop of rain, area on which drops strike it (m²), unused.
struct Limb {
    turns: vec4<f32>,
    nature: vec4<f32>,
    table: vec4<u32>,
    struck: vec4<f32>,
}

@group(1) @binding(10) var<storage, read> stands: array<Stand>;
@group(1) @binding(11) var<storage, read> shown: array<u32>;
@group(1) @binding(12) var<storage, read> counted: array<u32>;
@group(1) @binding(13) var<storage, read> steps: array<vec2<f32>>;
@group(1) @binding(14) var<storage, read> rows: array<Row>;
@group(1) @binding(15) var<uniform> list: BrushList;
@group(1) @binding(16) var<storage, read> limbs: array<Limb>;

// Whether any sphere is about, and whether leaves tremble in the rain; known as a pipeline is made.
override meets_spheres: bool = true;
override trembles: bool = true;

const GRAVITY_M_PER_S2: f32 = 9.81;
const MIDDLE_LOAD: f32 = 8.0;
const WIDTH_UNIT_M: f32 = 1.0 / 16384.0;
const DROP_M_PER_S: f32 = 6.49;
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

// A place on a component, from the root (m), and how it is directed there.
struct Bent {
    at: vec3<f32>,
    along: vec3<f32>,
    side: vec3<f32>,
}

// What of a vector is across a direction of length 1.
fn square(v: vec3<f32>, direction: vec3<f32>) -> vec3<f32> {
    return v - direction * dot(v, direction);
}

fn unit_or(v: vec3<f32>, other: vec3<f32>) -> vec3<f32> {
    let size = length(v);
    return select(other, v / max(size, 1e-30), size > 1e-30);
}

// Angle (rad) of a cosine, to 7e-5: Abramowitz & Stegun 4.4.45.
fn arc_cosine(cosine: f32) -> f32 {
    let size = abs(cosine);
    let angle = sqrt(max(1.0 - size, 0.0)) * (1.5707288 + size * (-0.2121144 + size * (0.074261 - size * 0.0187293)));
    return select(angle, 0.5 * TAU - angle, cosine < 0.0);
}

// Upright, turned by a heading and tipped by the lean of the ground.
fn ground_frame(plant: Stand) -> Bent {
    let side = vec3<f32>(sin(plant.lean.w), 0.0, -cos(plant.lean.w));
    let angle = length(plant.lean.xy);
    let axis = vec3<f32>(plant.lean.y, 0.0, -plant.lean.x) / max(angle, 1e-9);
    let up = vec3<f32>(0.0, cos(angle), 0.0) + cross(axis, vec3<f32>(0.0, 1.0, 0.0)) * sin(angle);
    let across = side * cos(angle) + cross(axis, side) * sin(angle) + axis * (dot(axis, side) * (1.0 - cos(angle)));
    return Bent(vec3<f32>(0.0), up, across);
}

// A direction of length 1 as it is, or, of a step that ends below the ground, just as steep that it ends on it; one that falls straight
// down lies down towards `front`.
fn above_ground(direction: vec3<f32>, front: vec3<f32>, normal: vec3<f32>, height: f32) -> vec3<f32> {
    let fall = dot(direction, normal);
    let up = max(fall, -max(height, 0.0));
    let level = unit_or(square(direction + front * 1e-4, normal), vec3<f32>(0.0));
    return select(direction, normalize(normal * up + level * sqrt(max(1.0 - up * up, 0.0))), up > fall);
}

// Direction of a step from `below` that passes outside of the spheres, as links of blades do; where the nearest way is through the ground,
// it is one above them.
fn passing(along: vec3<f32>, below: vec3<f32>, length_m: f32, plant: Stand, normal: vec3<f32>) -> vec3<f32> {
    var way = along;
    let steepest = -max(dot(below, normal), 0.0) / length_m;
    for (var round = 0; round < 2; round++) {
        for (var left = u32(plant.feels.w); left != 0u; left &= left - 1u) {
            let sphere = frame.spheres[firstTrailingBit(left)];
            let centre = sphere.xyz - plant.root.xyz;
            let nearest = aside_of(way, below, length_m, centre, sphere.w);
            let above = aside_of(normalize(way + normal), below, length_m, centre, sphere.w);
            way = select(nearest, above, any(nearest != way) && dot(nearest, normal) < steepest);
        }
    }
    return way;
}

// Where a component gets after so many steps, from what it stands on, and how step `last` is directed. Twin of `posed` in
// shared/src/plant/underbrush/plant.rs; spheres turn it beside.
fn bent(host: Bent, limb: Limb, so_many: f32, last: u32, plant: Stand, normal: vec3<f32>) -> Bent {
    let outward = host.side * limb.turns.z - cross(host.along, host.side) * limb.turns.w;
    let axis = normalize(host.along * limb.turns.x + outward * limb.turns.y);
    let across = cross(outward, host.along);
    let side = unit_or(square(cross(axis, vec3<f32>(0.0, 1.0, 0.0)) + across * 1e-3, axis), across);

    let pressure = plant.feels.xy * limb.nature.y;
    let load = vec3<f32>(pressure.x, -GRAVITY_M_PER_S2 * limb.nature.x * plant.about.w, pressure.y);
    let size = length(load);
    let down = load / max(size, 1e-30);
    let away = cross(axis, side);
    let towards = unit_or(square(square(down, axis) + away * 1e-6, axis), away);
    let around = cross(axis, towards);

    let nodes = vec2<f32>(list.nodes.xy - 1u);
    let angle = arc_cosine(clamp(-dot(down, axis), -1.0, 1.0));
    let place = vec2<f32>(sqrt(angle * 2.0 / TAU), 1.0 - MIDDLE_LOAD / (size + MIDDLE_LOAD)) * nodes;
    let is_nearest = list.which.z + u32(none_of(size)) == 1u;
    let node = min(vec2<u32>(place + select(0.0, 0.5, is_nearest)), list.nodes.xy - select(2u, 1u, is_nearest));
    let by = place - vec2<f32>(node);
    let to_load = limb.table.y;
    let to_angle = list.nodes.y * to_load;
    let first = limb.table.x + node.x * to_angle + node.y * to_load;

    let length_m = limb.nature.z * plant.root.w;
    var now = Bent(host.at, axis, side);
    var tangent = vec3<f32>(0.0);
    for (var i = 0u; i <= last; i++) {
        let at = first + i;
        var step = steps[at];
        if !is_nearest {
            let heavier = mix(steps[at + to_angle], steps[at + to_angle + to_load], by.y);
            step = mix(mix(step, steps[at + to_load], by.y), heavier, by.x);
        }
        let step_m = step.y * length_m;
        let free = axis * cos(step.x) + towards * sin(step.x);
        let turned = around * dot(side, around) + (towards * cos(step.x) - axis * sin(step.x)) * dot(side, towards);
        let height = dot(now.at, normal) / step_m;
        now.along = above_ground(free, cross(free, turned), normal, height);
        if meets_spheres && plant.feels.w > 0.0 {
            // From the first that meets a sphere on they go on in its direction.
            let own = select(now.along, tangent, any(tangent != vec3<f32>(0.0)));
            let way = passing(own, now.at, step_m, plant, normal);
            now.along = above_ground(way, cross(way, turned), normal, height);
            tangent = select(tangent, now.along, any(way != own));
        }
        now.side = unit_or(square(turned, now.along), turned);
        now.at += now.along * (step_m * clamp(so_many - f32(i), 0.0, 1.0));
    }
    return now;
}

fn first_limb(plant: Stand) -> u32 {
    return (u32(plant.feels.z) % (2u * VARIANTS)) * list.rows.z;
}

fn limb_of(plant: Stand, row: Row) -> Limb {
    return limbs[first_limb(plant) + (row.look.z & 0xffffu)];
}

// Where a row of a plant is, on ground with that normal: bent from the root on, one component on the other.
fn bent_row(plant: Stand, row: Row, normal: vec3<f32>) -> Bent {
    let limb_0 = first_limb(plant);
    let own = limb_of(plant, row);
    var now = ground_frame(plant);
    for (var above = own.table.w; above > 0u; above--) {
        // The component on which so many more stand, and the next of those.
        var next = own;
        for (var i = 1u; i < above; i++) {
            next = limbs[limb_0 + next.table.z];
        }
        let limb = limbs[limb_0 + next.table.z];
        now = bent(now, limb, next.nature.w, min(u32(next.nature.w), limb.table.y - 1u), plant, normal);
    }
    let so_many = row.look.z >> 16u;
    now = bent(now, own, f32(so_many), max(so_many, 1u) - 1u, plant, normal);
    if row.look.x >> 16u == PETAL {
        let other = cross(now.along, now.side);
        let outward = now.side * row.petal.y + other * row.petal.z;
        let along = now.along * sqrt(1.0 - row.petal.w * row.petal.w) + outward * row.petal.w;
        now = Bent(now.at + along * (row.petal.x * plant.root.w), along, other * row.petal.y - now.side * row.petal.z);
    }
    return now;
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
    let row_count = list.rows.x;
    let number = instance * list.rows.y + index / (2u * row_count);
    let local = index % (2u * row_count);
    var out: Ribbon;
    if number >= counted[list.which.x] {
        out.position = vec4<f32>(0.0, 0.0, 0.0, 1.0);
        return out;
    }
    let plant = stands[shown[list.which.y + number]];
    let row = rows[u32(plant.feels.z) % VARIANTS * row_count + local / 2u];
    let look = row.look;
    let stuff = look.x >> 16u;
    let size = plant.root.w;
    let distance_m = plant.about.z;
    let normal_up = plant.up.xyz;
    let bent = bent_row(plant, row, normal_up);
    let along = bent.along;
    var p = plant.root.xyz + bent.at;
    let own = limb_of(plant, row);
    if trembles && list.rain.x * own.struck.z > 0.0 {
        let number = vec2<u32>(u32(plant.about.y * 16777216.0), look.z & 0xffffu);
        // The larger it is, the less the drop counts beside its mass.
        let speed = 1.0 / mix(1.0 / DROP_M_PER_S, 1.0 / own.struck.x, size * size * size);
        let dip = dip_m(speed, own.struck.y * size, own.struck.z * size * size * list.rain.x, number, frame.eye.w);
        // Along the leaf it does not give.
        let down = vec3<f32>(0.0, 1.0, 0.0) - along * along.y;
        p -= down * (min(dip, FARTHEST_DIP * own.nature.z * size) * bow(f32(look.z >> 16u) / f32(own.table.y)));
    }
    let view = normalize(p - frame.eye.xyz);
    let toward = cross(along, view);
    let facing_side = toward / max(length(toward), 1e-3);
    var side = bent.side;
    let across = f32(local & 1u) * 2.0 - 1.0;
    if stuff == STALK {
        side = facing_side;
    } else if stuff != PETAL {
        // A leaf seen edge on still shows some of its width.
        side = normalize(side + facing_side * (0.35 * sign(dot(facing_side, side) + 1e-4)));
    }
    let half = max(f32(look.x & 0xffffu) * WIDTH_UNIT_M * size, select(0.0, 0.45 * distance_m * frame.screen.z, (look.x & 0xffffu) > 0u));
    p += side * (across * half);
    p += normal_up * max(0.012 - dot(p - plant.root.xyz, normal_up), 0.0);

    var normal = normalize(cross(side, along));
    normal *= -sign(dot(normal, view) + 1e-5);
    let rounded = normalize(normal * select(0.8, 0.55, stuff == STALK) + side * (across * select(0.25, 0.8, stuff == STALK)) + normal_up * 0.35);
    let root_color = vec3<f32>(f32(look.y & 255u), f32((look.y >> 8u) & 255u), f32((look.y >> 16u) & 255u)) / 255.0;
    var albedo = root_color * root_color;
    let hue = plant.about.y;
    if stuff != PETAL {
        albedo *= plant.tint.rgb * mix(vec3<f32>(0.86, 0.98, 0.85), vec3<f32>(1.14, 1.03, 0.9), hue);
    }
    let up = clamp(dot(p - plant.root.xyz, normal_up) / max(plant.about.x, 0.05), 0.0, 1.0);
    let deep = smoothstep(0.0, 0.6, plant.about.x);
    let occlusion = mix(mix(0.62, 0.30, deep), 1.0, smoothstep(0.0, 0.8, up));
    let light = plant.lean.z * sun_in_grass(0.2 + up, plant.about.x);
    var color: vec3<f32>;
    if stuff == PETAL {
        let sun_facing = dot(normal, frame.sun.xyz);
        let diffuse = clamp((abs(sun_facing) + 0.3) / 1.3, 0.0, 1.0);
        let through = 0.4 * max(dot(view, frame.sun.xyz), 0.0) * clamp(0.6 - sun_facing, 0.0, 1.0);
        color = albedo * (frame.sun_color.rgb * light * (diffuse + through) * 0.8 + ambient(rounded) + lamps_on(p, rounded, 0.3));
    } else {
        color = grass_light(albedo, rounded, along, view, light, occlusion) + grass_lamps(albedo, rounded, along, view, p, up);
    }
    let grass_m = kinds.list[u32(plant.feels.z) / (2u * VARIANTS)].root.w;
    out.color = among_grass(color, plant.sward, dot(p - plant.root.xyz, normal_up) / grass_m) * plant.air.a + plant.air.rgb;
    out.across = select(9.0, across, stuff != STALK && stuff != PETAL);
    out.position = frame.projection_from_world * vec4<f32>(p, 1.0);
    return out;
}

@fragment
fn fs(ribbon: Ribbon) -> @location(0) vec4<f32> {
    // A leaf is folded along its middle: one half lighter than the other, the rib darker.
    // Not the number that it should be on ribbons that reach behind the eye.
    let across = clamp(ribbon.across, -9.0, 9.0);
    let fold = 1.0 + 0.10 * across - 0.18 * (1.0 - smoothstep(0.0, 0.25, abs(across)));
    return vec4<f32>(ribbon.color * select(fold, 1.0, abs(across) > 1.5), 1.0);
}
