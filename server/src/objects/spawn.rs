//! Free positions for new objects.

use prairie_vehicles::{Environment, TerrainColliders};

/// Number of candidates along the spiral.
const TRIES: u32 = 4096;
/// Distance of the first candidate from the centre (m).
const FIRST_M: f32 = 9.0;
/// Default distance between candidates, approximately (m).
pub(super) const NEAR_M: f32 = 4.0;
/// Angle from one candidate to the next: the golden angle (rad).
const GOLDEN_RAD: f32 = 2.399_963;
/// Steepest terrain for a new object, as rise over run.
const STEEP: f32 = 0.6;

/// A circle on the terrain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Disc {
    pub(super) at_m: [f32; 2],
    pub(super) radius_m: f32,
}

/// The first position along a spiral around `center_m` where a disc of `radius_m` overlaps no object, tree, stone, model or edge; on gentle terrain if there is
/// any. Turns and candidates of the spiral are about `spacing_m` apart.
pub(super) fn find(
    center_m: [f32; 2],
    spacing_m: f32,
    radius_m: f32,
    taken: &[Disc],
    terrain: &TerrainColliders,
    environment: &Environment,
) -> Option<[f32; 2]> {
    let bounds = environment.bounds_m();
    let center: [f32; 2] = std::array::from_fn(|axis| center_m[axis].clamp(bounds[axis][0], bounds[axis][1]));
    let is_clear = |&at: &[f32; 2]| {
        let inside = (0..2).all(|axis| (bounds[axis][0]..=bounds[axis][1]).contains(&at[axis]));
        let apart = taken.iter().all(|disc| {
            let [x, z] = [at[0] - disc.at_m[0], at[1] - disc.at_m[1]];
            let reach = radius_m + disc.radius_m;
            x * x + z * z > reach * reach
        });
        inside && apart && terrain.is_free(at, radius_m)
    };
    let is_gentle = |at: &[f32; 2]| {
        let [x, z] = terrain.slope(*at);
        x * x + z * z < STEEP * STEEP
    };
    let mut clear = (0..TRIES).map(|n| spiral(center, spacing_m, n)).filter(is_clear).peekable();
    let steep = clear.peek().copied();
    clear.find(is_gentle).or(steep)
}

/// The centre around which an object appears at `at_m`, heading east, if that is free and far enough from the western edge.
pub fn center_for([x_m, z_m]: [f32; 2]) -> [f32; 2] {
    [(x_m - FIRST_M).max(0.0), z_m]
}

fn spiral(center: [f32; 2], spacing_m: f32, n: u32) -> [f32; 2] {
    let radius = (FIRST_M * FIRST_M + spacing_m * spacing_m * n as f32).sqrt();
    let (sin, cos) = (n as f32 * GOLDEN_RAD).sin_cos();
    [center[0] + radius * cos, center[1] + radius * sin]
}
