//! Primitives whose intensity changes over time and runs outwards.

use super::*;
use prairie_core::scene::PrimitiveIntensity;

/// Side of a cell (m), number of cells along X and Z, duration (s) and rate (Hz) of ticks.
const CELL_M: f32 = 4.0;
const CELLS: u32 = 32;
const TICK_SECS: f32 = 1.0 / TICK_HZ;
const TICK_HZ: f32 = 60.0;
/// Speed of the fronts (m/s), and distances (m) at which they are awaited.
const FRONT_M_PER_S: f32 = 10.0;
const DISTANCES_M: [f32; 4] = [12.0, 20.0, 28.0, 36.0];

/// A gust that comes once, in the middle of a still world, with dust.
fn gust() -> Primitive {
    Primitive {
        radius_m: 60.0,
        speed_m_per_s: 3.0,
        dust: 1.0,
        intensity: PrimitiveIntensity::Gust,
        attack_secs: 0.05,
        hold_secs: 8.0,
        fall_secs: 1.0,
        front_m_per_s: FRONT_M_PER_S,
        ..Primitive::new(PrimitiveKind::Uniform, [66.0, 4.0, 66.0])
    }
}

/// A still world with one primitive.
fn still(primitive: Primitive) -> (Scene, Maps) {
    let (mut scene, maps) = meadow();
    scene.tick_hz = TICK_HZ;
    (scene.wind.cells, scene.wind.spacing_m) = ([CELLS, 4, CELLS], [CELL_M, 4.0, CELL_M]);
    (scene.wind.sources, scene.wind.mean_m_per_s, scene.wind.turbulence) = (0, [0.0; 2], 0.0);
    (scene.wind.dust.release_per_s, scene.wind.dust.settling_per_s) = (1.0, 0.0);
    scene.wind.primitives = vec![primitive];
    (scene, maps)
}

fn begun(scene: &Scene, maps: &Maps) -> Weather {
    Weather::new(scene, &maps.height, &maps.cover).unwrap()
}

/// Dust in the lowest cell at a distance (m) to the south of the centre of the box.
fn dust_at(weather: &Weather, distance_m: f32) -> f32 {
    let [i, k] = [0.0, distance_m].map(|along_m| ((66.0 + along_m) / CELL_M) as usize);
    let [nx, ny] = [CELLS as usize, 4];
    weather.air.dust().unwrap().nth(i + nx * ny * k).unwrap()
}

/// Times (s) at which the dust at each distance begins to rise: when it has a hundredth of what a full intensity raises in a second.
fn arrivals_secs(primitive: Primitive) -> [f32; 4] {
    let (scene, maps) = still(primitive);
    let (mut weather, grass, mut arrivals) = (begun(&scene, &maps), grass(&scene), [f32::NAN; 4]);
    for tick in 1..=360 {
        weather.step(tick, &[], &maps.height, &grass);
        for (arrival_secs, distance_m) in arrivals.iter_mut().zip(DISTANCES_M) {
            let weight = [0.0, distance_m].map(|d| 1.0 - (d / 60.0).powi(2)).map(|w| w * w);
            if arrival_secs.is_nan() && dust_at(&weather, distance_m) > 0.01 * weight[0] * weight[1] {
                *arrival_secs = tick as f32 * TICK_SECS;
            }
        }
    }
    arrivals
}

#[test]
fn a_gust_reaches_a_point_when_its_front_does() {
    let arrivals = arrivals_secs(gust());
    let together = arrivals_secs(Primitive { front_m_per_s: 0.0, ..gust() });
    let stepped = arrivals_secs(Primitive { step_m: 16.0, ..gust() });
    println!("arrivals {arrivals:?} s with a front, {stepped:?} s in rings, {together:?} s without");
    for ((distance_m, arrival_secs), stepped_secs) in DISTANCES_M.into_iter().zip(arrivals).zip(stepped) {
        let delay_secs = distance_m / FRONT_M_PER_S;
        assert!(
            (delay_secs - 0.01..delay_secs + 0.11).contains(&arrival_secs),
            "at {distance_m} m after {arrival_secs} s, not {delay_secs}"
        );
        let ring_secs = (distance_m / 16.0).floor() * 16.0 / FRONT_M_PER_S;
        assert!((ring_secs - 0.01..ring_secs + 0.11).contains(&stepped_secs), "at {distance_m} m after {stepped_secs} s, not {ring_secs}");
    }
    assert!(together.iter().all(|arrival_secs| *arrival_secs < 0.11), "without a front it is everywhere at once: {together:?}");
}

/// The largest speed (m/s) of the air.
fn fastest(weather: &Weather) -> f32 {
    weather.air.cell_velocities().map(Vec3::length).fold(0.0, f32::max)
}

#[test]
fn the_world_begins_before_the_gust() {
    let (scene, maps) = still(gust());
    assert_eq!(fastest(&begun(&scene, &maps)), 0.0, "the warm-up knows no gust");
    let (scene, maps) = still(Primitive { intensity: PrimitiveIntensity::Steady, front_m_per_s: 0.0, ..gust() });
    assert!(fastest(&begun(&scene, &maps)) > 1.0, "a steady primitive blows from the start");
}

#[test]
fn a_restored_world_goes_on_with_the_same_bits_in_the_middle_of_a_gust() {
    let (scene, maps) = still(Primitive { attack_secs: 3.0, ..gust() });
    let grass = grass(&scene);
    let sum = |weather: &Weather| {
        let mut sum = Checksum::default();
        weather.hash(&mut sum);
        sum.value()
    };
    let mut weather = begun(&scene, &maps);
    (1..=60).for_each(|tick| weather.step(tick, &[], &maps.height, &grass));
    let mut state = WeatherState::default();
    weather.save_into(&mut state);
    let mut restored = Weather::restored(&scene, &maps.height, &maps.cover, &state).unwrap();
    let middle = sum(&weather);
    for tick in 61..=120 {
        weather.step(tick, &[], &maps.height, &grass);
        restored.step(tick, &[], &maps.height, &grass);
        assert_eq!(sum(&weather), sum(&restored), "at tick {tick}");
    }
    assert_ne!(sum(&weather), middle, "the gust goes on");
}

#[test]
fn a_gust_does_not_come_again_after_a_failed_step() {
    let speed_after = |failure_tick: u64| {
        let (scene, maps) = still(Primitive { hold_secs: 0.5, fall_secs: 0.2, front_m_per_s: 0.0, ..gust() });
        let (mut weather, grass) = (begun(&scene, &maps), grass(&scene));
        for tick in 1..=failure_tick + 30 {
            let motions: &[Motion] = if tick == failure_tick { &[hovering([f32::MAX; 3])] } else { &[] };
            weather.step(tick, motions, &maps.height, &grass);
        }
        assert_eq!(weather.resets(), 1);
        fastest(&weather)
    };
    assert_eq!(speed_after(120), 0.0, "the gust was over");
    assert!(speed_after(12) > 0.3, "it was not");
}
