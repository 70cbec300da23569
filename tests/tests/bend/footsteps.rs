//! A walker leaves footprints: each foot presses the grass where it stands, in turn, and the grass rises again.

use glam::Quat;
use prairie::bend::pool::Pool;
use prairie::charts::worlds;
use prairie_core::body::{BodyPose, Motion};
use prairie_core::grass::BendSimulation;
use prairie_core::grass::wind_drawing::WindDrawings;
use prairie_core::scene::{Objects, Scene, VehicleKind};
use prairie_core::terrain::{CoverMap, HeightMap, grey_png};
use std::f32::consts::TAU;
use std::sync::Arc;

const DT_SECS: f32 = 1.0 / 60.0;
const WALK_M_PER_S: f32 = 1.8;
/// Distance of two steps (m).
const STRIDE_M: f32 = 2.0;
/// Start of the walk to the north (m), on the edge between two columns of cells.
const START_M: [f32; 2] = [24.0, 40.0];

/// Short grass that only feet touch; nothing spreads.
fn scene() -> Scene {
    let mut scene = worlds::scene(3);
    scene.plants.height_m = 0.4;
    scene.grass.laid_recovery_secs = 4.0;
    (scene.grass.waves.c0_m_per_s, scene.grass.waves.mu_m_per_rad) = (0.0, 0.0);
    scene
}

/// The grass after a walk of `walked_m` to the north by a walker or another kind.
fn walked(scene: &Scene, kind: VehicleKind, walked_m: f32) -> BendSimulation {
    let flat = HeightMap::from_heights(2, 2, [1000.0; 2], vec![0.0; 4]);
    let grass = CoverMap::from_png(&grey_png([2; 2], &[255; 4])).expect("a grey PNG");
    let mut meadow = BendSimulation::new(scene, Arc::new(flat), &grass, &prairie_vehicles::bodies(&scene.objects), &WindDrawings::new());
    let stand = |m: f32| BodyPose {
        position_m: [START_M[0], Objects::default().half_extents_m(kind)[1], START_M[1] - m],
        rotation: Quat::IDENTITY.to_array(),
    };
    let step_m = WALK_M_PER_S * DT_SECS;
    for step in 0..(walked_m / step_m) as u32 {
        let [from_m, to_m] = [step, step + 1].map(|step| step as f32 * step_m);
        let velocity_m_per_s = [0.0, 0.0, -WALK_M_PER_S];
        let part_rad = (to_m / STRIDE_M * TAU) % TAU;
        let motion = Motion { kind, from: stand(from_m), to: stand(to_m), velocity_m_per_s, part_rad, is_at_rest: false };
        meadow.step(DT_SECS, &[motion], &[], &worlds::still_air(scene), &Pool);
    }
    meadow
}

/// Bend (rad) that far along the walk, to its left and to its right.
fn bends_rad(meadow: &BendSimulation, along_m: f32) -> [f32; 2] {
    [-0.125, 0.125].map(|x| meadow.field().bend_at(START_M[0] + x, START_M[1] - along_m).theta)
}

#[test]
fn feet_press_the_grass_in_turn_and_it_rises_again() {
    let scene = scene();
    let mut meadow = walked(&scene, VehicleKind::Walker, 6.0);
    // In the third stride the left foot has stood at 4.5 m, and the right one at 5.5 m.
    let pressed_rad = bends_rad(&meadow, 4.5)[0];
    println!("prints: left {:?}, right {:?}", [2.5, 4.5].map(|m| bends_rad(&meadow, m)), [3.5, 5.5].map(|m| bends_rad(&meadow, m)));
    for along_m in [2.5, 4.5] {
        let [left, right] = bends_rad(&meadow, along_m);
        assert!(left > 0.3 && right < 0.02, "{along_m} m along: {left} and {right} rad");
        let [left, right] = bends_rad(&meadow, along_m + 1.0);
        assert!(right > 0.3 && left < 0.02, "{} m along: {left} and {right} rad", along_m + 1.0);
        assert!(bends_rad(&meadow, along_m + 0.5).iter().all(|bend_rad| *bend_rad < 0.02), "between the prints");
    }
    // The control: a monster, which has no feet of its own, leaves a track without gaps.
    let track = walked(&scene, VehicleKind::Monster, 6.0);
    assert!((0..8).all(|n| bends_rad(&track, 2.5 + 0.25 * n as f32).iter().all(|bend_rad| *bend_rad > 0.3)));
    let rise_secs = 3.0 * scene.grass.laid_recovery_secs;
    for _ in 0..(rise_secs / DT_SECS) as u32 {
        meadow.step(DT_SECS, &[], &[], &worlds::still_air(&scene), &Pool);
    }
    let risen_rad = bends_rad(&meadow, 4.5)[0];
    assert!(risen_rad < 0.1 * pressed_rad, "after {rise_secs} s the print is bent by {risen_rad} rad instead of {pressed_rad}");
}
