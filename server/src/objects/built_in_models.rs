//! Built-in models of the covering map: a house, a piece of a fence and a rock. Like glTF models, they face +Z and have their own size in metres.

use glam::Vec3;
use prairie_core::random::SplitMix64;
use prairie_core::wire::Mesh;

/// Names of the built-in models.
pub const NAMES: [&str; 3] = ["house", "fence", "rock"];

/// The built-in model of this name.
pub fn find(name: &str) -> Option<Mesh> {
    match name {
        "house" => Some(house()),
        "fence" => Some(fence()),
        "rock" => Some(rock()),
        _ => None,
    }
}

const PLASTER: [f32; 3] = [0.58, 0.53, 0.44];
const TILES: [f32; 3] = [0.24, 0.07, 0.045];
const BRICK: [f32; 3] = [0.27, 0.11, 0.07];
const OAK: [f32; 3] = [0.10, 0.055, 0.03];
const PAINTED_WOOD: [f32; 3] = [0.70, 0.69, 0.64];
const GLASS: [f32; 3] = [0.03, 0.045, 0.06];
const WEATHERED_WOOD: [f32; 3] = [0.23, 0.20, 0.16];
const GRANITE: [f32; 3] = [0.26, 0.25, 0.23];

/// Mesh of flat faces.
#[derive(Default)]
struct Faceted(Mesh);

impl Faceted {
    /// Adds a convex polygon, anticlockwise as seen from its front, in a linear colour.
    fn polygon(&mut self, corners: &[Vec3], rgb: [f32; 3]) {
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or(Vec3::Y).to_array();
        let first = self.0.positions_m.len() as u32;
        for corner in corners {
            self.0.positions_m.push(corner.to_array());
            self.0.normals.push(normal);
            self.0.rgb.push(rgb.map(|channel| (channel * 255.0 + 0.5) as u8));
        }
        self.0.indices.extend((1..corners.len() as u32 - 1).flat_map(|i| [first, first + i, first + i + 1]));
    }

    /// Adds the solid between a convex polygon, anticlockwise as seen from its front, and its copy at `depth`, which leads away from the front.
    fn prism(&mut self, front: &[Vec3], depth: Vec3, rgb: [f32; 3]) {
        self.polygon(front, rgb);
        self.polygon(&front.iter().rev().map(|&corner| corner + depth).collect::<Vec<_>>(), rgb);
        for (i, &corner) in front.iter().enumerate() {
            let next = front[(i + 1) % front.len()];
            self.polygon(&[corner, corner + depth, next + depth, next], rgb);
        }
    }

    /// Adds an upright box.
    fn block(&mut self, low: [f32; 3], high: [f32; 3], rgb: [f32; 3]) {
        let ([x0, y0, z0], [x1, y1, z1]) = (low, high);
        let front = [Vec3::new(x0, y0, z1), Vec3::new(x1, y0, z1), Vec3::new(x1, y1, z1), Vec3::new(x0, y1, z1)];
        self.prism(&front, Vec3::Z * (z0 - z1), rgb);
    }
}

/// A house of 8.4 m × 5.6 m × 6.6 m with a gable roof, its ridge from side to side.
fn house() -> Mesh {
    let mut house = Faceted::default();
    let (half_x, half_z, eaves, ridge) = (4.0, 3.0, 2.7, 4.9);
    let gable = [[half_z, 0.0], [-half_z, 0.0], [-half_z, eaves], [0.0, ridge], [half_z, eaves]];
    house.prism(&gable.map(|[z, y]| Vec3::new(half_x, y, z)), Vec3::X * (-2.0 * half_x), PLASTER);
    // Two slabs of roof, which reach beyond the walls.
    let (over_x, over_z, thick) = (0.2, 0.3, 0.16);
    let drop = over_z * (ridge - eaves) / half_z;
    for side in [1.0_f32, -1.0] {
        let at = |[z, y]: [f32; 2]| Vec3::new(half_x + over_x, y, side * z);
        let mut slab =
            [[half_z + over_z, eaves - drop], [0.0, ridge], [0.0, ridge + thick], [half_z + over_z, eaves - drop + thick]].map(at);
        if side < 0.0 {
            slab.reverse();
        }
        house.prism(&slab, Vec3::X * (-2.0 * (half_x + over_x)), TILES);
    }
    house.block([1.6, 3.6, -1.6], [2.3, 5.6, -0.9], BRICK);
    house.block([-0.55, 0.0, 2.9], [0.55, 2.1, 3.05], PAINTED_WOOD);
    house.block([-0.45, 0.0, 2.9], [0.45, 2.0, 3.08], OAK);
    for (x, z) in [(-2.4, half_z), (2.4, half_z), (-2.4, -half_z), (0.0, -half_z), (2.4, -half_z)] {
        house.block([x - 0.6, 0.85, z - 0.06], [x + 0.6, 2.05, z + 0.06], PAINTED_WOOD);
        house.block([x - 0.5, 0.95, z - 0.08], [x + 0.5, 1.95, z + 0.08], GLASS);
    }
    house.0
}

/// A piece of a fence, 3 m × 1.15 m × 0.14 m: a post at either end of its three rails.
fn fence() -> Mesh {
    let mut fence = Faceted::default();
    for x in [-1.43, 1.43] {
        fence.block([x - 0.07, 0.0, -0.07], [x + 0.07, 1.15, 0.07], WEATHERED_WOOD);
    }
    for y in [0.25, 0.6, 0.95] {
        fence.block([-1.5, y, -0.025], [1.5, y + 0.12, 0.025], WEATHERED_WOOD);
    }
    fence.0
}

/// A rock about 1.6 m wide: a ball cut by planes, one of them the ground.
fn rock() -> Mesh {
    const SIDE: i32 = 6;
    let mut random = SplitMix64::new(77);
    let mut between = |low: f32, high: f32| low + (high - low) * random.unit() as f32;
    let mut cuts = vec![(Vec3::NEG_Y, 0.35)];
    for _ in 0..9 {
        let normal = Vec3::new(between(-1.0, 1.0), between(-0.3, 1.0), between(-1.0, 1.0)).normalize_or(Vec3::Y);
        cuts.push((normal, between(0.62, 0.9)));
    }
    let surface = |direction: Vec3| {
        let depth = |&(normal, depth): &(Vec3, f32)| {
            let along = direction.dot(normal);
            if along > 0.0 { depth / along } else { 1.0 }
        };
        direction * cuts.iter().map(depth).fold(1.0, f32::min) * Vec3::new(0.9, 0.75, 0.75)
    };
    let mut rock = Faceted::default();
    for (u, v) in [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::X)] {
        for (u, v) in [(u, v), (v, u)] {
            let corner = |i: i32, j: i32| {
                let [a, b] = [i, j].map(|n| 2.0 * n as f32 / SIDE as f32 - 1.0);
                surface((u.cross(v) + u * a + v * b).normalize_or(Vec3::Y))
            };
            for (i, j) in (0..SIDE).flat_map(|i| (0..SIDE).map(move |j| (i, j))) {
                let shade = between(0.85, 1.12);
                rock.polygon(
                    &[corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)],
                    GRANITE.map(|channel| channel * shade),
                );
            }
        }
    }
    rock.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::objects::gltf::stretched;

    /// Volume that the triangles enclose (m³), positive where they face outward; overlapping solids count twice.
    fn volume_m3(mesh: &Mesh) -> f32 {
        let at = |index: &u32| Vec3::from_array(mesh.positions_m[*index as usize]);
        mesh.indices.chunks_exact(3).map(|t| at(&t[0]).dot(at(&t[1]).cross(at(&t[2])))).sum::<f32>() / 6.0
    }

    #[test]
    fn built_in_models_enclose_their_volume_and_have_their_size() {
        let sizes = [[8.4, 5.6, 6.6], [3.0, 1.15, 0.14], [1.6, 0.9, 1.35]];
        let volumes_m3 = [[180.0, 215.0], [0.09, 0.11], [0.6, 1.2]];
        for ((name, size_m), [least, most]) in NAMES.iter().zip(sizes).zip(volumes_m3) {
            let mesh = find(name).expect("it is built in");
            let volume = volume_m3(&mesh);
            let (_, found_m) = stretched(mesh, [0.0; 3]).expect("a sound model");
            assert!(found_m.iter().zip(size_m).all(|(found, wanted)| (found / wanted - 1.0).abs() < 0.15), "{name}: {found_m:?} m");
            assert!((least..most).contains(&volume), "{name}: {volume} m³");
        }
        assert!(find("barn").is_none());
    }
}
