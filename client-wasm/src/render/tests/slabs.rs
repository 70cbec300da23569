//! Near blades lie under a sled, as their twins on the CPU do.

use super::*;
use glam::Quat;
use prairie_core::outline;
use prairie_core::plant::blade::contact::{CLEARANCE_M, Slab, settle_under};
use prairie_core::scene::Objects;
use prairie_core::wire::ObjectPose;

/// Pose of a sled on the meadow, a little tilted.
fn sled() -> ObjectPose {
    let rotation = Quat::from_rotation_y(0.7) * Quat::from_rotation_x(0.02);
    let (kind, position_m) = (VehicleKind::Sled, [32.0, 0.37, 30.0]);
    ObjectPose { id: 1, kind, position_m, rotation: rotation.to_array(), velocity_m_per_s: [0.0; 3], part_rad: 0.0 }
}

/// Links, normal with length, and root of a blade.
fn blade_case(n: u32) -> [[f32; 4]; 5] {
    let random = |k: u32| hash3([n, k, 83]).map(unit);
    let link = |i: u32| {
        let [a, b, c] = random(i);
        [a * 1.6 - 0.8, b * 1.6 - 0.8, 4.0 * c - 2.0, 0.0]
    };
    let ([x, z, size], [east, south, _]) = (random(10), random(11));
    let normal = Vec3::new(0.1 * (x - 0.5), 1.0, 0.1 * (z - 0.5)).normalize();
    [link(0), link(1), link(2), [normal.x, normal.y, normal.z, 0.2 + size], [28.5 + 7.0 * east, 0.0, 26.5 + 7.0 * south, 0.0]]
}

/// Leans of the links of blades after the shader has settled them.
fn settled(gpu: &Gpu, mirror: &mut Mirror, cases: &[[[f32; 4]; 5]]) -> Vec<Sway> {
    const SOURCE: &str = "
        struct Case { links: array<Link, 3>, blade: vec4<f32>, root: vec4<f32> }
        @group(1) @binding(0) var<storage, read_write> cases: array<Case>;
        @compute @workgroup_size(1) fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
            let input = cases[id.x];
            cases[id.x].links = settle(Sway(input.links), input.blade.w, input.blade.xyz, input.root.xyz).links;
        }";
    let mut picture = OffscreenRenderer::new(gpu, [16, 16], Quality::Low);
    picture.draw(mirror, &Camera { eye_m: Vec3::new(32.0, 2.0, 32.0), ..Camera::default() }, 0.0, 0.0);
    let outputs = compute(gpu, &picture, &linked("plants/blade", SOURCE), &[], cases.as_flattened(), cases.len() as u32);
    outputs.chunks_exact(5).map(|found| sway_of([found[0], found[1], found[2]])).collect()
}

fn sway_of(links: [[f32; 4]; LINKS]) -> Sway {
    Sway { lean_rad: links.map(|[x, z, ..]| [x, z]), rate_rad_per_s: links.map(|[_, _, x, z]| [x, z]) }
}

/// Heights (m) above the sled's floor of the ends of links that are under its outline.
fn above_floor_m(points_m: [[f32; 3]; LINKS], root: Vec3, objects: &Objects) -> Vec<f32> {
    let (pose, (outline_m, half_m)) = (sled(), objects.underside_m(VehicleKind::Sled).expect("a flat underside"));
    let local = |at_m: [f32; 3]| Quat::from_array(pose.rotation).conjugate() * (root + Vec3::from(at_m) - Vec3::from(pose.position_m));
    let ends = points_m.into_iter().map(local).filter(|at| outline::contains(outline_m, [at.x, at.z]) && at.y < half_m);
    ends.map(|at| at.y + half_m).collect()
}

#[test]
fn near_blades_lie_under_a_sled_like_their_twins() {
    let gpu = Gpu::headless().expect("a Vulkan adapter");
    let objects = Objects::default();
    let cases: Vec<_> = (0..1500).map(blade_case).collect();
    let mut mirror = meadow(0.0);
    let alone = settled(&gpu, &mut mirror, &cases);
    mirror.apply(ServerMessage::Poses { tick: 1, objects: vec![sled()] }).expect("a sound pose");
    let under = settled(&gpu, &mut mirror, &cases);

    let (rotation, (outline_m, half_height_m)) = (Quat::from_array(sled().rotation), objects.underside_m(VehicleKind::Sled).expect("one"));
    let (mut through, mut lying, mut grazing) = (0, 0, 0);
    for ((case, found), alone) in cases.iter().zip(&under).zip(&alone) {
        let [l0, l1, l2, [x, y, z, length_m], root] = *case;
        let root = Vec3::from_slice(&root[..3]);
        let slab = Slab {
            centre_m: (Vec3::from(sled().position_m) - root).to_array(),
            right: (rotation * Vec3::X).to_array(),
            back: (rotation * Vec3::Z).to_array(),
            half_height_m,
            reach_m: 3.3,
            outline_m,
        };
        let twin = settle_under(&sway_of([l0, l1, l2]), length_m, [x, y, z], &[], &[slab]);
        let pairs = twin.points_m(length_m).into_iter().zip(found.points_m(length_m));
        // A link that ends on the edge of the outline or of the floor is under it or not by the last bits.
        grazing += usize::from(pairs.map(|(a, b)| Vec3::from(a).distance(Vec3::from(b))).fold(0.0, f32::max) > 1e-4 * length_m);
        through += above_floor_m(alone.points_m(length_m), root, &objects).iter().filter(|above_m| **above_m > 1e-3).count();
        for above_m in above_floor_m(found.points_m(length_m), root, &objects) {
            // The ground wins where the floor is lower.
            assert!(above_m < CLEARANCE_M + 2e-3, "{above_m} m above the floor at {root}");
            lying += 1;
        }
    }
    assert!(grazing < 4, "{grazing} blades differ from their twins");
    assert!(lying > 500, "{lying} ends of links are under the sled");
    // The control: without the sled, the same blades stand where it would be.
    assert!(through > 300, "{through} ends of links stand in the place of the sled");
}
