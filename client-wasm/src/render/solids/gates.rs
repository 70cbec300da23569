//! Gates of a race: two posts with a banner between them.

use super::mesh::{Paint, Solid};
use crate::state::DecodedScene;
use glam::{Mat4, Quat, Vec3};
use prairie_core::race::{GatePost, POST_HALF_M};

/// Height of a banner (m).
const BANNER_M: f32 = 0.8;
/// Half the thickness of a banner (m), so that its sides don't hide each other.
const HALF_THICK_M: f32 = 0.03;
/// Checks of the banner over start and finish: along it, and from top to bottom.
const CHECKS: [u32; 2] = [12, 2];

/// Color factor of the gate that the driver has to pass next, of start and finish, and of all others.
const NEXT_TINT: [f32; 3] = [1.0, 0.35, 0.04];
const START_TINT: [f32; 3] = [1.0, 1.0, 1.0];
const OTHER_TINT: [f32; 3] = [0.35, 0.5, 0.75];

/// Mesh of a gate's part, by its number in [`solids`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum GatePart {
    Post,
    Banner,
    Checkered,
}

/// The meshes of all parts: a post a metre tall, and banners a metre wide with their upper edge at the origin, seen from both sides.
pub(crate) fn solids() -> [Solid; 3] {
    let mut post = Solid::default();
    post.block(Vec3::new(0.0, 0.5, 0.0), Vec3::new(POST_HALF_M, 0.5, POST_HALF_M), 0.01, Paint::new(0.8, 0.8, 0.76, 0.2));
    [post, banner([1, 1]), banner(CHECKS)]
}

/// A banner of white and, alternately, black checks.
fn banner([along, down]: [u32; 2]) -> Solid {
    const PAINTS: [Paint; 2] = [Paint::new(0.85, 0.85, 0.82, 0.1), Paint::new(0.02, 0.02, 0.02, 0.1)];
    let corner =
        |across: u32, below: u32| Vec3::new(across as f32 / along as f32 - 0.5, -BANNER_M * below as f32 / down as f32, HALF_THICK_M);
    let mut banner = Solid::default();
    for (across, below) in (0..along).flat_map(|across| (0..down).map(move |below| (across, below))) {
        let mut corners = [corner(across, below + 1), corner(across + 1, below + 1), corner(across + 1, below), corner(across, below)];
        let paint = PAINTS[((across + below) % 2) as usize];
        banner.polygon(&corners, paint);
        corners.reverse();
        corners.iter_mut().for_each(|corner| corner.z = -HALF_THICK_M);
        banner.polygon(&corners, paint);
    }
    banner
}

/// A part of a gate in its place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedPart {
    pub(crate) part: GatePart,
    pub(crate) world_from_part: Mat4,
    /// Number of its gate.
    gate: usize,
}

impl PlacedPart {
    /// Its color factor, if the driver has to pass the gate `next`.
    pub(crate) fn tint(&self, next: Option<usize>) -> [f32; 3] {
        match self.part {
            _ if next == Some(self.gate) => NEXT_TINT,
            GatePart::Banner => OTHER_TINT,
            GatePart::Post | GatePart::Checkered => START_TINT,
        }
    }
}

/// All parts of the scene's gates.
pub(crate) fn placed(decoded: &DecodedScene) -> Vec<PlacedPart> {
    let parts = |(gate, settings)| {
        let posts = GatePost::pair(settings, |x, z| decoded.heights().height_m(x, z));
        let turn = Quat::from_rotation_y(-settings.heading_rad);
        let post = |GatePost { at_m: [x, z], span_m: [bottom_m, top_m], .. }: GatePost| {
            let tall = Vec3::new(1.0, top_m - bottom_m, 1.0);
            let world_from_part = Mat4::from_scale_rotation_translation(tall, turn, Vec3::new(x, bottom_m, z));
            PlacedPart { part: GatePart::Post, world_from_part, gate }
        };
        let ([x, z], [_, top_m]) = (settings.at_m, posts[0].span_m);
        let wide = Vec3::new(settings.width_m, 1.0, 1.0);
        let banner = PlacedPart {
            part: if gate == 0 { GatePart::Checkered } else { GatePart::Banner },
            world_from_part: Mat4::from_scale_rotation_translation(wide, turn, Vec3::new(x, top_m, z)),
            gate,
        };
        [post(posts[0]), post(posts[1]), banner]
    };
    decoded.scene().race.gates.iter().enumerate().flat_map(parts).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::tests::meadow_of;
    use prairie_core::race::{POST_DEPTH_M, POST_TOP_M};
    use prairie_core::scene::RaceGate;

    #[test]
    fn posts_stand_in_the_ground_at_the_ends_of_the_line() {
        let eastwards = RaceGate { width_m: 8.0, ..RaceGate::new([20.0, 30.0], std::f32::consts::FRAC_PI_2) };
        let mirror = meadow_of(|scene| scene.race.gates = vec![eastwards, RaceGate::new([40.0, 30.0], 0.0)], &[255; 256]);
        let decoded = mirror.decoded_scene().expect("a scene");
        let parts = placed(decoded);
        assert!(parts.iter().map(|part| part.gate).eq([0, 0, 0, 1, 1, 1]));
        let kinds = [0, 1, 2, 5].map(|number| parts[number].part);
        assert_eq!(kinds, [GatePart::Post, GatePart::Post, GatePart::Checkered, GatePart::Banner]);
        let ground_m = decoded.heights().height_m(20.0, 30.0);
        let top_m = ground_m + POST_TOP_M;
        // North is to the left of who drives east.
        for (part, z) in parts.iter().zip([26.0, 34.0]) {
            let [foot, head] = [0.0, 1.0].map(|up| part.world_from_part.transform_point3(up * Vec3::Y));
            assert!(foot.distance(Vec3::new(20.0, ground_m - POST_DEPTH_M, z)) < 1e-4 && head.distance(Vec3::new(20.0, top_m, z)) < 1e-4);
        }
        let ends = [-0.5, 0.5].map(|across| parts[2].world_from_part.transform_point3(across * Vec3::X));
        assert!(ends[0].distance(Vec3::new(20.0, top_m, 26.0)) < 1e-4 && ends[1].distance(Vec3::new(20.0, top_m, 34.0)) < 1e-4, "{ends:?}");
        assert_eq!([None, Some(0), Some(1)].map(|next| parts[5].tint(next)), [OTHER_TINT, OTHER_TINT, NEXT_TINT]);
    }

    #[test]
    fn a_banner_has_both_sides_in_whole_checks() {
        let [post, plain, checkered] = solids();
        assert!(!post.indices.is_empty());
        assert_eq!([plain.indices.len(), checkered.indices.len()], [2 * 6, 2 * 6 * (CHECKS[0] * CHECKS[1]) as usize]);
    }
}
