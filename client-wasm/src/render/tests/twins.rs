//! Blades move, and are drawn, like their twins on the CPU.

use super::*;
use prairie_core::plant::blade::backbone::{drawn_out_m, segment_points_m};
use prairie_core::plant::blade::contact::{Sphere, settle};
use prairie_core::plant::blade::{Blade, advance};
use prairie_core::wire::ObjectPose;

/// Inputs of a blade of the comparison: links, what acts on them, blade, root, normal, as `Case` in the WGSL below.
fn blade_case(n: u32) -> [[f32; 4]; 9] {
    let random = |k: u32| hash3([n, k, 77]).map(unit);
    let link = |i: u32| {
        let [a, b, c] = random(i);
        [a * 2.0 - 1.0, b * 2.0 - 1.0, c * 8.0 - 4.0, 4.0 * a - 2.0]
    };
    let acts = |i: u32| {
        let [a, b, c] = random(10 + i);
        [a - 0.5, b - 0.5, c * 16.0 - 8.0, a * 10.0 - 5.0]
    };
    let [a, b, c] = random(20);
    let [x, z, way] = random(22);
    // Steps within the stability limit of the schemes that have one.
    let (fastest, longest_secs) = if way < 2.0 / 3.0 { (6.0, 0.004) } else { (44.0, 0.032) };
    let blade = [0.1 + 1.5 * a, 4.0 + (fastest - 4.0) * b, 0.1 + c, 0.004 * a];
    let [rx, rz, t] = random(21);
    let root = [30.0 + 5.0 * rx, 0.0, 30.0 + 5.0 * rz, longest_secs * (0.1 + 0.9 * t)];
    let normal = Vec3::new(0.6 * (x - 0.5), 1.0, 0.6 * (z - 0.5)).normalize();
    let normal = [normal.x, normal.y, normal.z, (way * 3.0).floor()];
    [link(0), link(1), link(2), acts(0), acts(1), acts(2), blade, root, normal]
}

#[test]
fn blades_move_as_their_cpu_twins() {
    const SOURCE: &str = "
        struct Case { links: array<Link, 3>, acts: array<vec4<f32>, 3>, blade: vec4<f32>, root: vec4<f32>, normal: vec4<f32> }
        @group(1) @binding(0) var<storage, read_write> cases: array<Case>;
        @compute @workgroup_size(1) fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
            let input = cases[id.x];
            let held = array<vec2<f32>, 3>(input.acts[0].xy, input.acts[1].xy, input.acts[2].xy);
            let winds_m_per_s = array<vec2<f32>, 3>(input.acts[0].zw, input.acts[1].zw, input.acts[2].zw);
            let nature = BladeNature(input.blade.x, input.blade.y, input.blade.z, input.blade.w);
            var sway = Sway(input.links);
            for (var i = 0; i < 5; i++) {
                sway = advance(sway, nature, held, winds_m_per_s, u32(input.normal.w), input.root.w);
                sway = settle(sway, nature.length_m, input.normal.xyz, input.root.xyz);
            }
            cases[id.x].links = sway.links;
        }";
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut mirror = meadow(0.0);
    let pose = |id: u32, position_m: [f32; 3]| ObjectPose {
        id,
        kind: VehicleKind::Monster,
        position_m,
        rotation: [0.0, 0.0, 0.0, 1.0],
        velocity_m_per_s: [0.0; 3],
        part_rad: 0.0,
    };
    mirror
        .apply(ServerMessage::Poses { tick: 1, objects: vec![pose(1, [31.0, 1.0, 31.5]), pose(2, [34.0, 1.5, 33.0])] })
        .expect("sound poses");
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    picture.draw(&mut mirror, &Camera { eye_m: Vec3::new(32.0, 2.0, 32.0), ..Camera::default() }, 0.0, 0.0);
    let count = probe(&gpu, &picture, "return vec4<f32>(f32(frame.sphere_count));", &[[0.0; 4]])[0][0] as usize;
    let numbers: Vec<_> = (0..count).map(|i| [i as f32, 0.0, 0.0, 0.0]).collect();
    let spheres =
        probe(&gpu, &picture, "let sphere = frame.spheres[u32(at.x)]; return vec4<f32>(sphere.centre_m, sphere.radius_m);", &numbers);
    assert!(count >= 2, "the monsters' feet push plants aside");

    let cases: Vec<_> = (0..600).map(blade_case).collect();
    let source = linked("plants/blade", SOURCE);
    let outputs = compute(&gpu, &picture, &source, &[], cases.as_flattened(), cases.len() as u32);
    let (mut touching, mut grazing) = (0, 0);
    for (case, found) in cases.into_iter().zip(outputs.chunks_exact(9)) {
        let [l0, l1, l2, a0, a1, a2, [length_m, frequency_rad_per_s, damping_ratio, lean_per_wind2], root, [x, y, z, way]] = case;
        let (links, acts) = ([l0, l1, l2], [a0, a1, a2]);
        let blade = Blade { length_m, frequency_rad_per_s, damping_ratio, lean_per_wind2 };
        let integrator = [BladeIntegrator::Euler, BladeIntegrator::Verlet, BladeIntegrator::Exact][way as usize];
        let about =
            spheres.iter().map(|s| Sphere { centre_m: std::array::from_fn(|i| s[i] - root[i]), radius_m: s[3] }).collect::<Vec<_>>();
        let pair = |part: [[f32; 4]; LINKS], first: usize| part.map(|link| [link[first], link[first + 1]]);
        let mut stepped = |changed_rad: f32| {
            let mut sway = Sway { lean_rad: pair(links, 0), rate_rad_per_s: pair(links, 2) };
            sway.lean_rad[0][0] += changed_rad;
            for _ in 0..5 {
                sway = advance(&sway, &blade, &pair(acts, 0), &pair(acts, 2), integrator, root[3]);
                let free = sway;
                sway = settle(&sway, length_m, [x, y, z], &about);
                touching += u32::from(free != sway);
            }
            sway
        };
        let apart = |a: &Sway, b: &Sway| {
            let pairs = a.points_m(length_m).into_iter().zip(b.points_m(length_m));
            pairs.map(|(a, b)| Vec3::from(a).distance(Vec3::from(b)) / length_m).fold(0.0, f32::max)
        };
        let (sway, twin) = (stepped(0.0), Sway::at_rest(pair([found[0], found[1], found[2]], 0)));
        let off = apart(&sway, &twin);
        if off >= 1e-4 {
            // A link that grazes a sphere meets it or not by the last bits: then the blade is the twin of one that starts as close as that.
            let meets = [1e-6, -1e-6].iter().any(|&changed_rad| apart(&stepped(changed_rad), &twin) < 1e-4);
            assert!(meets, "{off} of the length apart: {sway:?} and {twin:?}");
            grazing += 1;
        }
    }
    assert!(grazing < 4, "{grazing} blades graze a sphere");
    assert!(touching > 300, "only {touching} contacts were compared");
}

#[test]
fn blades_are_drawn_as_by_their_cpu_twins() {
    const SOURCE: &str = "
        struct Case { links: array<Link, 3>, how: vec4<f32> }
        @group(1) @binding(0) var<storage, read_write> cases: array<Case>;
        @compute @workgroup_size(1) fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
            let input = cases[id.x];
            let points = drawn_out(points_of(Sway(input.links), input.how.x), input.how.x, u32(input.how.w));
            let at = backbone_at(points, input.how.z);
            let side = side_at(points[2], input.how.y, input.how.z);
            cases[id.x].links[0] = Link(at.xy, vec2<f32>(at.z, 0.0));
            cases[id.x].links[1] = Link(side.xy, vec2<f32>(side.z, 0.0));
        }";
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    picture.draw(&mut meadow(0.0), &Camera::default(), 0.0, 0.0);
    let cases: Vec<_> = (0..400)
        .map(|n| {
            let [l0, l1, l2, .., blade, root, _] = blade_case(n);
            [l0, l1, l2, [blade[0], root[0] * 3.0 - 100.0, (n % 11) as f32 * 0.1, (2 + n % 7) as f32]]
        })
        .collect();
    let source = linked("plants/blade", SOURCE);
    let outputs = compute(&gpu, &picture, &source, &[], cases.as_flattened(), cases.len() as u32);
    for ([l0, l1, l2, [length_m, side_rad, t, segments]], found) in cases.into_iter().zip(outputs.chunks_exact(4)) {
        let points_m = Sway::at_rest([l0, l1, l2].map(|[x, z, ..]| [x, z])).points_m(length_m);
        let [left, right] = segment_points_m(&drawn_out_m(&points_m, length_m, segments as u32), side_rad, t, 1.0).map(Vec3::from);
        let [at, side] = [Vec3::from_slice(&found[0][..3]), Vec3::from_slice(&found[1][..3])];
        assert!(at.distance(0.5 * (left + right)) < 1e-4 * length_m, "{at} instead of {} at {t}", 0.5 * (left + right));
        // Where the lean is along the side, both turns are equally small.
        let is_even =
            (points_m[2][0] * side_rad.cos() + points_m[2][2] * side_rad.sin()).abs() > 0.9999 * points_m[2][0].hypot(points_m[2][2]);
        assert!(is_even || side.distance(right - left) < 1e-3, "{side} instead of {} at {t}", right - left);
    }
}

#[test]
fn textured_blades_are_wide_up_to_their_tips_and_tapered_ones_end_in_a_point() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let mut picture = OffscreenRenderer::new(&gpu, [16, 16], Quality::Low);
    picture.draw(&mut meadow(0.0), &Camera::default(), 0.0, 0.0);
    let body =
        "let corner = corner_of(u32(at.x), 7u); return vec4<f32>(corner, width_fraction(corner.x, false), width_fraction(corner.x, true));";
    let vertices: Vec<_> = [0, 1, 14, 15].map(|vertex| [vertex as f32, 0.0, 0.0, 0.0]).to_vec();
    let found = probe_in(&gpu, &picture, "plants/backbone", body, &vertices);
    let wide = found[0][3];
    assert!(wide > 1.0, "{found:?}");
    for ([t, across, tapered, textured], wanted) in
        found.into_iter().zip([[0.0, -1.0, 0.8], [0.0, 1.0, 0.8], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0]])
    {
        assert_eq!([t, across, tapered, textured], [wanted[0], wanted[1], wanted[2], wide]);
    }
}
