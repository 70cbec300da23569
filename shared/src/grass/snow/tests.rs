use super::*;
use crate::body::{BodyPose, Motion, Prism};
use crate::grass::swept_footprint::SweptFootprint;
use crate::scene::VehicleKind;

const LAYOUT: PatchLayout = PatchLayout { count: [3, 3], cells: 16, cell_m: 0.25 };
const DT_SECS: f32 = 1.0 / 60.0;

fn snow() -> Snow {
    Snow { depth_m: 0.2, ..Snow::default() }
}

fn field(snow: &Snow, tile_limit: usize) -> SnowField {
    SnowField::new(LAYOUT, snow, tile_limit).unwrap()
}

/// A block of 0.5 m × 0.75 m that moves from one position to another on the ground (m).
fn sweep(from_m: [f32; 2], to_m: [f32; 2]) -> SweptFootprint {
    let prism = Prism::cuboid([0.0, 0.2, 0.0], [0.25, 0.2, 0.375]);
    let pose = |[x, z]: [f32; 2]| BodyPose { position_m: [x, 0.0, z], rotation: [0.0, 0.0, 0.0, 1.0] };
    let motion =
        Motion { kind: VehicleKind::Car, from: pose(from_m), to: pose(to_m), velocity_m_per_s: [0.0; 3], part_rad: 0.0, is_at_rest: false };
    SweptFootprint::new(&prism, &motion, LAYOUT.cell_m)
}

/// Drives a block southwards across patches.
fn drive(field: &mut SnowField) {
    for step in 0..60 {
        let z_m = 2.0 + 0.1 * step as f32;
        field.press(&sweep([6.0, z_m], [6.0, z_m + 0.1]), 0.0);
        field.step(DT_SECS);
    }
}

#[test]
fn mass_is_conserved_over_a_drive_and_is_lost_without_the_neighbours() {
    let mut field = field(&snow(), 1000);
    drive(&mut field);
    let cell_m2 = LAYOUT.cell_m * LAYOUT.cell_m;
    let track_kg = f64::from(snow().mass_kg_m2() * cell_m2) * 2.0 * 24.0;
    assert!((field.mass_difference_kg() / track_kg).abs() < 1e-6, "{} kg of {track_kg}", field.mass_difference_kg());
    // Control: what is pushed aside is a noticeable part of the mass below the block, so a push without the neighbours loses it.
    let mut alone = self::field(&snow(), 1000);
    for leg in sweep([6.0, 2.0], [6.0, 6.0]).legs() {
        _ = alone.compact(&press::Below::of(&leg, &LAYOUT), 0);
    }
    assert!(alone.mass_difference_kg() < -0.05 * track_kg, "{} kg", alone.mass_difference_kg());
}

#[test]
fn a_track_is_packed_and_has_rims() {
    let mut field = field(&snow(), 1000);
    drive(&mut field);
    let packed_m = 0.2 * 120.0 / 450.0;
    // The last press of all may have left loose snow ahead of the block.
    for z_m in [3.0, 4.0, 5.0] {
        let [rut_m, rim_m] = [6.1, 6.4].map(|x_m| field.depth_m([x_m, z_m]));
        assert!((0.7 * packed_m..packed_m * 1.2).contains(&rut_m), "{rut_m} m of packed snow");
        assert!(rim_m > 0.2 + 0.005, "the rim is {rim_m} m high");
        let steepest = (0..12).map(|n| 6.4 + 0.25 * n as f32).map(|x_m| field.depth_m([x_m, z_m]) - field.depth_m([x_m + 0.25, z_m]));
        assert!(steepest.fold(0.0, f32::max) < 0.25 * 40.0_f32.to_radians().tan() + 1e-3, "rims slump");
    }
    assert_eq!(field.depth_m([2.0, 2.0]), 0.2);
    assert!(field.column([24, 16]).density_kg_m3() <= 450.5);
}

/// Largest step between neighbours beside the way of [`drive`], in all four directions (m).
fn steepest_m(field: &SnowField) -> f32 {
    let is_beside = |[x, z]: [i64; 2]| !(23..25).contains(&x) || !(6..34).contains(&z);
    let cells = (8..40).flat_map(|x| (0..40).map(move |z| [x, z])).filter(|cell| is_beside(*cell));
    let pairs = cells.flat_map(|[x, z]| [[x, z], [x + 1, z]].into_iter().zip([[x + 1, z], [x + 1, z + 1]]));
    let steps = pairs.filter(|(a, b)| is_beside(*a) && is_beside(*b)).map(|(a, b)| field.column(a).depth_m() - field.column(b).depth_m());
    steps.map(f32::abs).fold(0.0, f32::max)
}

#[test]
fn rims_of_ten_passes_are_no_steeper_than_the_angle_of_repose() {
    let [rests, stays] = [40.0, 80.0].map(|repose_deg| {
        let mut field = field(&Snow { repose_deg, pushed_share: 1.0, depth_m: 1.2, ..snow() }, 1000);
        (0..10).for_each(|_| drive(&mut field));
        steepest_m(&field)
    });
    let limit_m = LAYOUT.cell_m * 40.0_f32.to_radians().tan();
    assert!(rests < limit_m + 2e-3, "{rests} m between neighbours, {limit_m} m is the limit");
    assert!(stays > 1.2 * limit_m, "control: {stays} m where snow hardly slumps");
}

#[test]
fn a_state_at_its_limits_is_pressed_and_decays() {
    let mut field = field(&Snow { fall_m_per_h: 7.2, ..snow() }, 1000);
    field.press(&sweep([6.0, 6.0], [6.0, 6.0]), 0.0);
    let mut state = field.state();
    state.fill(Column { mass: (1 << 36) - 1, depth: (1 << 36) - 1 });
    field.restore(&state).unwrap();
    let before = field.column([24, 24]);
    drive(&mut field);
    (0..200).for_each(|_| field.step(DT_SECS));
    assert!(field.column([24, 24]).depth < before.depth && field.column([24, 24]).mass > 0);
    state.fill(Column { mass: 1 << 36, depth: 0 });
    assert!(field.restore(&state).is_err(), "control: beyond the limit");
}

#[test]
fn a_second_pass_pushes_almost_nothing() {
    let mut once = field(&snow(), 1000);
    drive(&mut once);
    let mut twice = once.clone();
    drive(&mut twice);
    for z_m in [3.0, 4.0, 5.0] {
        let [first, second] = [&once, &twice].map(|field| field.depth_m([6.1, z_m]));
        assert!((first - second).abs() < 0.002, "{first} m, then {second} m");
    }
}

#[test]
fn snowfall_fills_ruts_at_its_rate_and_ends_their_memory() {
    // As much as lies falls in 100 s.
    let snow = Snow { fall_m_per_h: 7.2, ..snow() };
    let mut field = field(&snow, 1000);
    drive(&mut field);
    let rut_m = 0.2 - field.depth_m([6.1, 4.0]);
    for _ in 0..6000 {
        field.step(DT_SECS);
    }
    let left = (0.2 - field.depth_m([6.1, 4.0])) / rut_m;
    assert!((left - (-1.0_f32).exp()).abs() < 0.01, "{left} of the rut is left");
    for _ in 0..200_000 {
        field.step(DT_SECS);
    }
    assert_eq!((field.tiles(), field.patches().count()), (0, 0));
}

#[test]
fn tracks_stay_without_snowfall_and_the_oldest_are_dropped_above_the_limit() {
    let mut field = field(&snow(), 4);
    field.press(&sweep([1.0, 1.0], [1.0, 1.0]), 0.0);
    for _ in 0..1000 {
        field.step(DT_SECS);
    }
    let before = field.clone();
    assert!(field.tiles() == 1 && field.depth_m([1.0, 1.0]) < 0.1);
    field.press(&sweep([9.0, 9.0], [9.0, 9.0]), 0.0);
    field.step(DT_SECS);
    assert_eq!((field.dropped(), field.depth_m([1.0, 1.0])), (0, before.depth_m([1.0, 1.0])));
    for at in [[5.0, 1.0], [1.0, 5.0], [5.0, 5.0]] {
        field.press(&sweep(at, at), 0.0);
        field.step(DT_SECS);
        assert!(field.tiles() <= 4);
    }
    assert_eq!((field.dropped(), field.depth_m([1.0, 1.0])), (1, 0.2));
}

#[test]
fn a_restored_field_goes_on_with_the_same_bits_and_misfits_are_rejected() {
    let mut field = field(&snow(), 1000);
    drive(&mut field);
    let mut state = SnowState::default();
    field.save_into(&mut state);
    let mut copy = self::field(&snow(), 1000);
    copy.restore(&state).unwrap();
    drive(&mut field);
    drive(&mut copy);
    assert!(copy.patches == field.patches && (0..9).all(|patch| copy.words_of(patch).eq(field.words_of(patch))));
    let mut other = SnowField::new(PatchLayout { count: [1, 1], ..LAYOUT }, &snow(), 1000).unwrap();
    assert!(other.restore(&state).is_err() && other.patches.is_empty());
}
