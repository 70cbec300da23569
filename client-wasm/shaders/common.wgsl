// Bindings and the frame's uniform block, shared by all passes; the block's twin is `uniforms.rs`.

struct Frame {
    projection_from_world: mat4x4<f32>,
    world_from_projection: mat4x4<f32>,
    shadow_from_world: mat4x4<f32>,
    eye: vec4<f32>,
    sun: vec4<f32>,
    sun_color: vec4<f32>,
    world: vec4<f32>,
    maps: vec4<f32>,
    wind_box: vec4<f32>,
    tiling: vec4<u32>,
    gust: vec4<f32>,
    past: vec4<f32>,
    blade: vec4<f32>,
    screen: vec4<f32>,
    reach: vec4<f32>,
    sward: vec4<f32>,
    clouds: vec4<f32>,
    spheres: array<vec4<f32>, 16>,
    lights: Lights,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var heights: texture_2d<f32>;
@group(0) @binding(2) var normals: texture_2d<f32>;
@group(0) @binding(3) var cover: texture_2d<f32>;
@group(0) @binding(4) var bends: texture_2d_array<f32>;
@group(0) @binding(5) var winds: texture_3d<f32>;
@group(0) @binding(6) var noises: texture_2d<f32>;
@group(0) @binding(7) var repeated: sampler;
@group(0) @binding(8) var clamped: sampler;
@group(0) @binding(9) var shadows: texture_depth_2d_array;
@group(0) @binding(10) var shadow_sampler: sampler_comparison;
@group(0) @binding(11) var kind_map: texture_2d<u32>;
@group(0) @binding(12) var<uniform> kinds: Kinds;

// One kind of grass; its twin is in `uniforms.rs`.
struct Kind {
    root: vec4<f32>,
    tip: vec4<f32>,
    lag: vec4<f32>,
    shape: vec4<f32>,
}

struct Kinds {
    list: array<Kind, 17>,
}

// A plant to be drawn.
struct Blade {
    // Root (m), width at the root (m).
    root: vec4<f32>,
    // Offsets of the control points from the root (m); w: angle of the side; number of its kind and hue 0..1 as a fraction, or of a
    // flower the kind of its petals 0..1; light 0..1.
    points: array<vec4<f32>, 3>,
    // What the grass about it looks like from afar; how much of that it shows at its root.
    about: vec4<f32>,
    // Drift of the grass's colour there, as `drift_at` has it; slope of the land, X and Z of its normal.
    place: vec4<f32>,
    // What the air before it adds to its colour, and the share of that which the air lets through.
    air: vec4<f32>,
}

const TAU: f32 = 6.2831853;
const THETA_FULL_RAD: f32 = 3.1415927;
const OMEGA_FULL_RAD_PER_S: f32 = 80.0;
const WIND_FULL_M_PER_S: f32 = 31.75;
const DUST_FULL: f32 = 16.0;

// Integer hash (pcg3d) of a place and a number; twin of `hash3` in shared/src/hash.rs.
fn hash3(v_in: vec3<u32>) -> vec3<u32> {
    var v = v_in * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> vec3<u32>(16u);
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

// Three random numbers in 0..1 for a place and a number.
fn random3(place: vec2<i32>, number: u32) -> vec3<f32> {
    let h = hash3(vec3<u32>(bitcast<u32>(place.x), bitcast<u32>(place.y), number));
    return vec3<f32>(h >> vec3<u32>(8u)) / 16777216.0;
}

// Interleaved gradient noise (J. Jimenez, "Next generation post processing in Call of Duty: Advanced Warfare", 2014): numbers in 0..1, far apart at any few
// pixels side by side.
fn gradient_noise(pixel: vec2<f32>) -> f32 {
    return fract(52.9829189 * fract(dot(pixel, vec2<f32>(0.06711056, 0.00583715))));
}

// Threshold, within 0..1, of what fades by dither at a pixel.
fn dither_at(pixel: vec2<f32>) -> f32 {
    return 0.01 + 0.98 * gradient_noise(floor(pixel));
}

fn noise(uv: vec2<f32>) -> vec4<f32> {
    return textureSampleLevel(noises, repeated, uv, 0.0);
}

// The same no finer than what a pixel spans of it.
fn noise_over(uv: vec2<f32>, span: f32) -> vec4<f32> {
    return textureSampleLevel(noises, repeated, uv, max(log2(span * f32(textureDimensions(noises).x)), 0.0));
}

// --- land -----------------------------------------------------------------------------------------------------------

// Whether places beyond the world's edge are asked for. Known as a pipeline is made, as all overrides are, since software drivers run what a branch leaves out.
override reaches_beyond: bool = true;

fn metres_outside(p: vec2<f32>) -> f32 {
    if !reaches_beyond {
        return 0.0;
    }
    return length(max(max(-p, p - frame.world.xy), vec2<f32>(0.0)));
}

// Rolling land beyond the world's edge, so that the horizon is no table. Of a loop that has no turn, software drivers run the first:
// what is rarely needed is in small turns, here as below.
fn far_hills(p: vec2<f32>, outside_m: f32) -> f32 {
    var n = 0.0;
    for (var i = 0; i < select(0, 2, outside_m > 0.0); i++) {
        let found = noise(p / select(2600.0, 790.0, i == 1));
        n += select(found.r * 0.7, found.g * 0.3, i == 1);
    }
    let rise = smoothstep(0.0, 900.0, outside_m);
    return rise * ((n - 0.42) * 150.0 + outside_m * 0.006);
}

fn ground_height(p: vec2<f32>) -> f32 {
    let size = frame.maps.xy;
    let at = clamp(p / frame.world.zw, vec2<f32>(0.0), size - 1.001);
    let low = floor(at);
    let share = at - low;
    let i = vec2<i32>(low);
    let nw = textureLoad(heights, i, 0).r;
    let ne = textureLoad(heights, i + vec2<i32>(1, 0), 0).r;
    let sw = textureLoad(heights, i + vec2<i32>(0, 1), 0).r;
    let se = textureLoad(heights, i + vec2<i32>(1, 1), 0).r;
    let height = mix(mix(nw, ne, share.x), mix(sw, se, share.x), share.y);
    return height + far_hills(p, metres_outside(p));
}

// Its normal, from four places 20 m about.
fn far_normal(p: vec2<f32>, outside_m: f32) -> vec3<f32> {
    var slope = vec2<f32>(0.0);
    for (var i = 0u; i < select(0u, 4u, outside_m > 20.0); i++) {
        let way = select(vec2<f32>(20.0, 0.0), vec2<f32>(0.0, 20.0), i > 1u) * select(1.0, -1.0, (i & 1u) == 1u);
        slope += way * far_hills(p + way, outside_m);
    }
    return normalize(vec3<f32>(-slope.x, 800.0, -slope.y));
}

fn ground_normal(p: vec2<f32>) -> vec3<f32> {
    let outside_m = metres_outside(p);
    if outside_m > 20.0 {
        return far_normal(p, outside_m);
    }
    let uv = (p / frame.world.zw + 0.5) / frame.maps.xy;
    return normalize(textureSampleLevel(normals, clamped, uv, 0.0).xyz);
}

// Share of grass at a place as the map has it, blurred: 0 on bare ground, stones and at trunks.
fn soft_share(p: vec2<f32>) -> f32 {
    return textureSampleLevel(cover, clamped, p / frame.world.xy, 0.0).r;
}

// The same with a ragged border.
fn grass_share(p: vec2<f32>) -> f32 {
    return ragged_share(p, soft_share(p));
}

fn ragged_share(p: vec2<f32>, soft: f32) -> f32 {
    let is_border = soft > 0.0 && soft < 1.0;
    var ragged = 0.0;
    for (var i = 0; i < select(0, 2, is_border); i++) {
        let found = noise(p / select(7.0, 2.1, i == 1));
        ragged += 0.3 * select(found.b, found.g, i == 1);
    }
    return select(soft, smoothstep(0.35, 0.65, soft + (ragged - 0.3) * (1.0 - abs(2.0 * soft - 1.0))), is_border);
}

// Height of grass over that of its kind, 1 on the average: by the nutrients that underbrush leaves in the soil, and from one part of the meadow to the next;
// low where it borders on bare ground.
fn fed(p: vec2<f32>) -> f32 {
    let covered = textureSampleLevel(cover, clamped, p / frame.world.xy, 0.0);
    return mix(0.78, 1.22, covered.g) * mix(0.74, 1.20, noise(p / 14.0).a) * mix(0.35, 1.0, smoothstep(0.35, 0.85, covered.r));
}

// --- kinds of grass ---------------------------------------------------------------------------------------------------

// Whether more than one grows.
override has_kinds: bool = true;

// The four pixels of the map of kinds about a place, and how much each of them counts there.
struct KindsAbout {
    kinds: vec4<u32>,
    shares: vec4<f32>,
}

// A pixel inside of a map that is mirrored at its edges over and over.
fn mirrored(pixel: vec2<i32>, size: vec2<i32>) -> vec2<i32> {
    let at = ((pixel % (2 * size)) + 2 * size) % (2 * size);
    return min(at, 2 * size - 1 - at);
}

fn kinds_about(p: vec2<f32>) -> KindsAbout {
    let size = textureDimensions(kind_map);
    let px_m = frame.world.xy / vec2<f32>(size);
    // Ragged borders: a place is taken for one beside it, and the farther beyond the world's edge, the farther away.
    let ragged_m = clamp(px_m, vec2<f32>(1.0), vec2<f32>(5.0));
    let scales_m = array<vec2<f32>, 3>(1.7 * ragged_m, 0.8 * ragged_m, vec2<f32>(metres_outside(p)));
    let sizes_m = vec3<f32>(13.0, 3.7, 830.0);
    var beside_m = vec2<f32>(0.0);
    for (var i = 0; i < 3; i++) {
        let at = p / sizes_m[i];
        beside_m += (vec2<f32>(noise(at).r, noise(at + 0.37).r) - 0.5) * scales_m[i];
    }
    let at = (p + beside_m) / px_m - 0.5;
    let low = floor(at);
    let share = at - low;
    let nw = mirrored(vec2<i32>(low), vec2<i32>(size));
    let se = mirrored(vec2<i32>(low) + 1, vec2<i32>(size));
    var about: KindsAbout;
    about.kinds = vec4<u32>(
        textureLoad(kind_map, nw, 0).r,
        textureLoad(kind_map, vec2<i32>(se.x, nw.y), 0).r,
        textureLoad(kind_map, vec2<i32>(nw.x, se.y), 0).r,
        textureLoad(kind_map, se, 0).r,
    );
    let west = 1.0 - share.x;
    let north = 1.0 - share.y;
    about.shares = vec4<f32>(west * north, share.x * north, west * share.y, share.x * share.y);
    return about;
}

// Number of the kind that grows at a place: the one that counts most there.
fn kind_at(p: vec2<f32>) -> u32 {
    if !has_kinds {
        return 0u;
    }
    var about = kinds_about(p);
    var found = 0u;
    var most = 0.0;
    for (var i = 0; i < 4; i++) {
        let same = select(vec4<f32>(0.0), about.shares, about.kinds == vec4<u32>(about.kinds[i]));
        let counts = dot(same, vec4<f32>(1.0));
        if counts > most {
            most = counts;
            found = about.kinds[i];
        }
    }
    return found;
}

// The kinds at a place blended: what is seen of them from afar.
fn kinds_blended(p: vec2<f32>) -> Kind {
    if !has_kinds {
        return kinds.list[0];
    }
    var about = kinds_about(p);
    var blend = Kind(vec4<f32>(0.0), vec4<f32>(0.0), vec4<f32>(0.0), vec4<f32>(0.0));
    for (var i = 0; i < 4; i++) {
        let kind = kinds.list[about.kinds[i]];
        blend.root += kind.root * about.shares[i];
        blend.tip += kind.tip * about.shares[i];
        blend.lag += kind.lag * about.shares[i];
        blend.shape += kind.shape * about.shares[i];
    }
    return blend;
}

// Whether any of a sphere (m) may be in view.
fn is_seen(centre: vec3<f32>, radius: f32) -> bool {
    let m = transpose(frame.projection_from_world);
    let c = vec4<f32>(centre, 1.0);
    let left = m[3] + m[0];
    let right = m[3] - m[0];
    let low = m[3] + m[1];
    let high = m[3] - m[1];
    return dot(left, c) > -radius * length(left.xyz) && dot(right, c) > -radius * length(right.xyz)
        && dot(low, c) > -radius * length(low.xyz) && dot(high, c) > -radius * length(high.xyz) && dot(m[3], c) > -radius;
}

// Whether any of a box (m) may be in view.
fn is_box_seen(low: vec3<f32>, high: vec3<f32>) -> bool {
    let m = transpose(frame.projection_from_world);
    let planes = array<vec4<f32>, 5>(m[3] + m[0], m[3] - m[0], m[3] + m[1], m[3] - m[1], m[3]);
    for (var i = 0; i < 5; i++) {
        let plane = planes[i];
        let farthest = select(low, high, plane.xyz >= vec3<f32>(0.0));
        if dot(plane.xyz, farthest) + plane.w < 0.0 {
            return false;
        }
    }
    return true;
}

// Share of the plants that stand at a distance, where all do up to `full_m`: as many to a pixel wherever they are.
fn density(distance_m: f32, full_m: f32) -> f32 {
    let near = full_m / max(distance_m, 0.01);
    return min(near * near, 1.0);
}

// --- wind and bend --------------------------------------------------------------------------------------------------

// Wind (m/s), and the root of the dust's concentration over `DUST_FULL`, at a place in the wind's box.
fn air_in_box(place_m: vec3<f32>) -> vec4<f32> {
    let edge = 0.5 / vec3<f32>(textureDimensions(winds));
    let uvw = place_m / frame.wind_box.xyz;
    let held = clamp(uvw, edge, 1.0 - edge);
    let at = select(held, uvw, vec3<bool>(frame.tiling.y != 0u, false, frame.tiling.z != 0u));
    return textureSampleLevel(winds, repeated, at, 0.0) * vec4<f32>(vec3<f32>(WIND_FULL_M_PER_S), 1.0);
}

// Cells along X and Z by which a patch shows the wind's box moved; twin of `offset_cells` in shared/src/wind/tiling.rs.
fn offset_cells(patch_place: vec2<i32>, cells: vec2<u32>) -> vec2<u32> {
    let hash = hash3(vec3<u32>(bitcast<u32>(patch_place.x), bitcast<u32>(patch_place.y), frame.tiling.x));
    return (hash.xy >> vec2<u32>(8u)) % cells;
}

// Zero, which only the invocation finds: a branch on uniforms alone makes some drivers compile the shader anew for each draw.
fn none_of(p: f32) -> f32 {
    return min(abs(p), 0.0);
}

// The air so high above the ground at `p`, as the box covers the world; twin of `Tiles::taps` in shared/src/wind/tiling.rs.
fn air_at(p: vec2<f32>, above_m: f32) -> vec4<f32> {
    let is_one_box = frame.wind_box.w <= none_of(p.x);
    let patch_m = max(frame.wind_box.w, 1.0);
    let cells = textureDimensions(winds).xz;
    let spacing_m = frame.wind_box.xz / vec2<f32>(cells);
    let at = p / patch_m - 0.5;
    let low = floor(at);
    let far = clamp((at - low - 0.5) * patch_m / spacing_m + 0.5, vec2<f32>(0.0), vec2<f32>(1.0));
    var air = vec4<f32>(0.0);
    for (var i = 0; i < select(4, 1, is_one_box); i++) {
        let corner = vec2<i32>(i & 1, i >> 1u);
        let shares = select(1.0 - far, far, corner == vec2<i32>(1));
        let moved = vec2<f32>(offset_cells(vec2<i32>(low) + corner, cells)) * spacing_m;
        let at = p + select(moved, vec2<f32>(0.0), is_one_box);
        air += air_in_box(vec3<f32>(at.x, above_m, at.y)) * select(shares.x * shares.y, 1.0, is_one_box);
    }
    return air;
}

fn wind_at(p: vec3<f32>, above_m: f32) -> vec3<f32> {
    return air_at(p.xz, above_m).xyz;
}

// Concentration of dust where `air_at` gave this.
fn dust_of(air: vec4<f32>) -> f32 {
    return air.w * air.w * DUST_FULL;
}

// Fine structure of the wind below the solver's cells: fronts that travel with the mean wind, as a factor about 1.
fn gust_at(p: vec2<f32>) -> f32 {
    let along = dot(p, frame.gust.xy) - frame.gust.w;
    let across = dot(p, vec2<f32>(-frame.gust.y, frame.gust.x));
    let broad = noise(vec2<f32>(along / 60.0, across / 120.0)).r;
    let fine = noise(vec2<f32>(along / 23.0, across / 60.0)).g;
    return 0.45 + 1.35 * smoothstep(0.28, 0.74, broad * 0.62 + fine * 0.38);
}

// Lean (rad, as a vector on the ground) that a steady wind sustains in what one of 10 m/s bends by `bend_rad`; twin of
// `wind_lean_rad` in shared/src/bend/wind.rs.
fn lean_of_wind(wind: vec2<f32>, bend_rad: f32) -> vec2<f32> {
    let speed = length(wind);
    let share = min(speed, 10.0) * 0.1;
    return wind / max(speed, 1e-3) * (bend_rad * share * share);
}

// The streamed bend field at a place, at a mip level and in a layer of the atlas: θ (rad), ω (rad/s). Layer 0 is the newest.
fn bend_at(p: vec2<f32>, level: f32, layer: i32) -> vec3<f32> {
    let code = textureSampleLevel(bends, repeated, p / frame.maps.z, layer, level);
    return vec3<f32>(code.x * THETA_FULL_RAD, code.yz * abs(code.yz) * OMEGA_FULL_RAD_PER_S);
}

// Lean (rad, as a vector on the ground) of a state of the bend field.
fn lean_of_bend(bend: vec3<f32>) -> vec2<f32> {
    return bend.yz * (bend.x / max(length(bend.yz), 1e-10));
}

// Lean that the field had at a place so many seconds ago, where its newest state is `now`.
fn earlier_lean(p: vec2<f32>, level: f32, now: vec3<f32>, kind: Kind, secs: f32) -> vec2<f32> {
    if frame.past.w < none_of(p.x) {
        let speed = length(now.yz);
        if speed < 1e-6 {
            return vec2<f32>(0.0);
        }
        let direction = now.yz / speed;
        let reached_m = (kind.lag.x + kind.lag.y * speed) * min(secs, 0.25 * TAU / speed);
        return direction * bend_at(p + direction * reached_m, level, 0).x;
    }
    // Earlier pictures of the field: the youngest is in layer `past.w`, each older one in the next below, round about.
    var lean = lean_of_bend(now);
    var younger_secs = 0.0;
    for (var i = 0; i < 3 && younger_secs < secs; i++) {
        let age_secs = frame.past[i];
        let older = lean_of_bend(bend_at(p, level, 1 + (i32(frame.past.w) + 2 - i) % 3));
        lean = mix(lean, older, clamp((secs - younger_secs) / max(age_secs - younger_secs, 1e-6), 0.0, 1.0));
        younger_secs = age_secs;
    }
    return lean;
}

// Lean of a segment that trails the lowest by `secs`; less where the grass rises. Twin of `Lag::lean_rad` in shared/src/lod/lag.rs.
fn trailing_lean(p: vec2<f32>, level: f32, now: vec3<f32>, kind: Kind, secs: f32) -> vec2<f32> {
    let lean = lean_of_bend(now);
    if secs <= 0.0 {
        return lean;
    }
    var then = lean;
    var back_secs = secs;
    for (var i = 0; i < 2; i++) {
        then = earlier_lean(p, level, now, kind, back_secs);
        if dot(then, then) <= dot(lean, lean) {
            break;
        }
        back_secs = secs * kind.lag.w;
    }
    return then;
}

// How much of the streamed field is shown at a place: none where the atlas ends.
fn field_share(p: vec2<f32>) -> f32 {
    let from_eye = abs(p - frame.eye.xz);
    return 1.0 - smoothstep(0.8, 1.0, max(from_eye.x, from_eye.y) / frame.maps.w);
}

// Lean (rad) of the streamed bend field at a place: how the grass departs from where the wind alone holds it.
fn lean_of_field(p: vec2<f32>, level: f32) -> vec2<f32> {
    let share = field_share(p);
    if share <= 0.0 {
        return vec2<f32>(0.0);
    }
    return lean_of_bend(bend_at(p, level, 0)) * share;
}

// Lean (rad) of what grows at a place on the ground, in its wind times a factor, where one of 10 m/s bends it by `bend_rad`.
fn lean_at(ground: vec3<f32>, level: f32, gust: f32, bend_rad: f32) -> vec2<f32> {
    return lean_of_field(ground.xz, level) + lean_of_wind(wind_at(ground, 0.0).xz * gust, bend_rad);
}

fn field_level(distance_m: f32) -> f32 {
    return clamp(log2(distance_m * frame.screen.z * 4.0 * 6.0), 0.0, 3.0);
}

// --- colours of plants ----------------------------------------------------------------------------------------------

// Grass that lies shows its pale undersides: a factor on its colour for a bend (rad).
fn trodden(tilt: f32) -> vec3<f32> {
    return mix(vec3<f32>(1.0), vec3<f32>(1.85, 1.70, 2.1), smoothstep(0.60, 1.20, tilt));
}

// Colour of a plant a share `up` of its height above the root, between its colours there and at the tip; hue 0..1 runs from
// fresh to dry.
fn plant_color(root_rgb: vec3<f32>, tip_rgb: vec3<f32>, up: f32, hue: f32) -> vec3<f32> {
    let own = mix(vec3<f32>(0.82, 0.98, 0.80), vec3<f32>(1.16, 1.04, 0.86), hue);
    return mix(root_rgb, tip_rgb, up * 0.85 + up * up * 0.15) * own;
}

// Drift of colour over the land: how lush, and how dry and reddish a place is.
fn drift_at(p: vec2<f32>) -> vec2<f32> {
    let broad = noise(p / 97.0).r;
    let middle = noise(p / 31.0).a;
    let fine = noise(p / 6.3).g;
    return vec2<f32>(fine, smoothstep(0.40, 0.72, broad * 0.5 + middle * 0.35 + fine * 0.15));
}

// The same as a factor on the grass's colours.
fn tint_of(drift: vec2<f32>) -> vec3<f32> {
    let lush = mix(vec3<f32>(0.66, 0.84, 0.72), vec3<f32>(0.84, 0.93, 0.84), drift.x);
    return mix(lush, vec3<f32>(1.28, 1.04, 1.12), drift.y * 0.85);
}

fn grass_tint(p: vec2<f32>) -> vec3<f32> {
    return tint_of(drift_at(p));
}
