use super::*;
use glam::Vec3;
use prairie_core::scene::{
    Component, ComponentKind, Lamp, Patches, Race, RaceGate, Scene, Species, TerrainMaps, Underbrush, VehicleKind, Wind,
};
use prairie_core::terrain::grey_png;
use prairie_core::wire::quantise::CodeSteps;
use prairie_core::wire::{BrokenPlant, Peer, STANDINGS_LIMIT, Shape, Standing, TurbulenceState, codec, decode};
use prairie_core::wire::{ObjectPose, ServerMessage};
use proptest::prelude::*;
use std::num::NonZeroU8;
use std::sync::LazyLock;

/// Steps of the codes of a scene with the default errors.
static STEPS: LazyLock<CodeSteps> = LazyLock::new(CodeSteps::default);

fn scene() -> Scene {
    let maps = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [1.0, 1.0], level_m: 0.1, base_m: 0.0 };
    Scene {
        patches: Patches { count: [3, 2], cells: 8, ..Patches::default() },
        wind: Wind { cells: [4, 2, 4], ..Wind::default() },
        ..Scene::new(maps)
    }
}

fn scene_message(scene: Scene) -> ServerMessage {
    let map = grey_png([4; 2], &[255; 16]);
    ServerMessage::Scene {
        scene: Box::new(scene),
        height_png: map.clone(),
        covering_png: map,
        nutrient_png: Vec::new(),
        models: Vec::new(),
        shapes: Default::default(),
    }
}

fn loaded() -> Mirror {
    let mut mirror = Mirror::default();
    assert_eq!(mirror.apply(scene_message(scene())), Ok(Some(Event::Scene)));
    mirror
}

#[test]
fn a_race_is_checked_against_the_scene() {
    let gates = vec![RaceGate::new([4.0, 4.0], 0.0), RaceGate::new([12.0, 4.0], 3.1)];
    let race = |standings| ServerMessage::Race { standings };
    let own = Standing { client: 3, next_gate: 1, began_secs: Some(2.0), best_secs: Some(9.5), ..Standing::default() };
    let mut mirror = Mirror::default();
    assert_eq!(mirror.apply(race(vec![own])), Err(MirrorError::BeforeScene("race")));
    mirror.apply(scene_message(Scene { race: Race { gates, ..Race::default() }, ..scene() })).unwrap();
    let faults = [
        vec![Standing { next_gate: 2, ..own }],
        vec![Standing { gap_secs: Some(f32::NAN), ..own }],
        vec![Standing { began_secs: Some(f64::INFINITY), ..own }],
        vec![own; STANDINGS_LIMIT + 1],
    ];
    for standings in faults {
        assert!(matches!(mirror.apply(race(standings)), Err(MirrorError::Range { .. })));
    }
    assert_eq!((mirror.apply(race(vec![own])), mirror.standings()), (Ok(None), [own].as_slice()));
    // The next gate is that of the own vehicle, and the first one before a lap has begun.
    assert_eq!(mirror.next_gate(), None);
    let welcome = |client| ServerMessage::Welcome { client, proof: [0; 32], server_version: String::new(), scene_name: String::new() };
    mirror.apply(welcome(3)).unwrap();
    let roster = |object| ServerMessage::Roster { peers: [3, 4].map(|client| Peer { client, name: String::new(), object }).to_vec() };
    mirror.apply(roster(None)).unwrap();
    assert_eq!(mirror.next_gate(), None, "on foot");
    mirror.apply(roster(Some(1))).unwrap();
    assert_eq!(mirror.next_gate(), Some(1));
    mirror.apply(welcome(4)).unwrap();
    assert_eq!(mirror.next_gate(), Some(0));
    mirror.apply(scene_message(scene())).unwrap();
    assert_eq!((mirror.standings().len(), mirror.next_gate()), (0, None), "another scene has another race");
    assert!(mirror.apply(race(vec![own])).is_err(), "there is no race in it");
}

fn patch(seq: u32, key: bool, base: Option<&[i16]>, codes: &[i16]) -> ServerMessage {
    ServerMessage::Patch { patch: 1, seq, key, payload: codec::encode(Shape::patch(8), codes, base) }
}

fn theta(mirror: &Mirror) -> Option<i16> {
    mirror.patch(1).map(|codes| codes.planes()[0][0])
}

#[test]
fn fields_before_the_scene_are_rejected() {
    let mut mirror = Mirror::default();
    assert!(matches!(mirror.apply(patch(1, true, None, &[1; 192])), Err(MirrorError::BeforeScene(_))));
}

#[test]
fn a_delta_without_its_base_is_dropped() {
    let mut mirror = loaded();
    let (first, second) = ([5; 192], [9; 192]);
    mirror.apply(patch(2, false, Some(&first), &second)).unwrap();
    assert_eq!(theta(&mirror), None);
    mirror.apply(patch(7, true, None, &first)).unwrap();
    mirror.apply(patch(9, false, Some(&first), &second)).unwrap();
    assert_eq!(theta(&mirror), Some(5), "a delta that skips a frame is dropped");
    mirror.apply(patch(8, false, Some(&first), &second)).unwrap();
    assert_eq!(theta(&mirror), Some(9));
    assert_eq!(mirror.take_dirty_patches(), [1]);
    assert_eq!(mirror.take_dirty_patches(), []);
}

#[test]
fn an_empty_payload_resets_a_patch_and_is_the_base_of_the_next_delta() {
    let mut mirror = loaded();
    mirror.apply(patch(1, true, None, &[5; 192])).unwrap();
    mirror.apply(ServerMessage::Patch { patch: 1, seq: 2, key: true, payload: Vec::new() }).unwrap();
    assert_eq!(theta(&mirror), None);
    mirror.apply(patch(3, false, Some(&[0; 192]), &[3; 192])).unwrap();
    assert_eq!(theta(&mirror), Some(3));
}

#[test]
fn a_damaged_frame_leaves_the_mirror_unchanged() {
    let mut mirror = loaded();
    mirror.apply(patch(1, true, None, &[5; 192])).unwrap();
    let damaged = ServerMessage::Patch { patch: 1, seq: 2, key: false, payload: vec![1, 2, 3] };
    assert!(matches!(mirror.apply(damaged), Err(MirrorError::Field { field: "patch", .. })));
    let beyond = ServerMessage::Patch { patch: 6, seq: 2, key: true, payload: Vec::new() };
    assert!(matches!(mirror.apply(beyond), Err(MirrorError::Range { .. })));
    mirror.apply(patch(2, false, Some(&[5; 192]), &[6; 192])).unwrap();
    assert_eq!(theta(&mirror), Some(6));
}

#[test]
fn wind_deltas_apply_to_their_key_frame() {
    let mut mirror = loaded();
    let (first, second) = (vec![3; 96], vec![-4; 96]);
    let delta = |seq| ServerMessage::Wind {
        tick: 0,
        seq,
        key: false,
        turbulence: TurbulenceState::default(),
        payload: codec::encode(Shape::wind(4, false), &second, Some(first.as_slice())),
    };
    mirror.apply(delta(5)).unwrap();
    assert!(mirror.wind().is_none());
    mirror
        .apply(ServerMessage::Wind {
            tick: 0,
            seq: 4,
            key: true,
            turbulence: TurbulenceState::default(),
            payload: codec::encode(Shape::wind(4, false), &first, None),
        })
        .unwrap();
    mirror.apply(delta(6)).unwrap();
    assert_eq!(mirror.wind().unwrap().codes()[95], 3);
    mirror.apply(delta(5)).unwrap();
    assert_eq!(mirror.wind().unwrap().codes()[95], -4);
}

#[test]
fn wind_is_shown_between_frames() {
    let mut mirror = loaded();
    let mut blow = |tick: u64, speed: f32, friction_m_per_s: f32| {
        let codes: Vec<i16> = (0..96).map(|at| if at < 32 { STEPS.wind_code(speed) } else { 0 }).collect();
        let turbulence = TurbulenceState { friction_m_per_s, ..TurbulenceState::default() };
        let payload = codec::encode(Shape::wind(4, false), &codes, None);
        mirror.apply(ServerMessage::Wind { tick, seq: tick as u32, key: true, turbulence, payload }).unwrap();
    };
    (0..112).for_each(|n| blow(100 + 9 * n, n as f32 % 31.0, 0.1 * n as f32));
    let shown = |tick: f64| {
        let shown = mirror.shown_wind(tick / 60.0 + WIND_DELAY_SECS).unwrap();
        (shown.from.tick(), shown.to.tick(), shown.fraction, shown.turbulence().friction_m_per_s)
    };
    let (from, to, fraction, friction) = shown(1093.0);
    assert_eq!((from, to), (1090, 1099));
    assert!((fraction - 3.0 / 9.0).abs() < 1e-4 && (friction - 11.0 - 0.1 / 3.0).abs() < 1e-4, "{fraction}, {friction}");
    assert_eq!(shown(5000.0).0, 1099, "without a later frame the wind stays as it is");
    assert_eq!(shown(0.0).1, 208, "the oldest of a hundred frames");
    let field = mirror.wind_field().unwrap();
    assert!((field.resolved_at([1.0, 1.0, 1.0])[0] - 18.0).abs() < 0.13, "points are sampled in the newest frame");
    let mut again = mirror;
    let payload = codec::encode(Shape::wind(4, false), &[0; 96], None);
    again.apply(ServerMessage::Wind { tick: 5, seq: 1, key: true, turbulence: TurbulenceState::default(), payload }).unwrap();
    assert_eq!(again.shown_wind(9.0).unwrap().from.tick(), 5, "a restarted world begins anew");
    let broken = TurbulenceState { path_m: f64::NAN, ..TurbulenceState::default() };
    let payload = codec::encode(Shape::wind(4, false), &[0; 96], None);
    assert!(again.apply(ServerMessage::Wind { tick: 6, seq: 2, key: true, turbulence: broken, payload }).is_err());
}

#[test]
fn dust_is_the_fourth_wind_plane() {
    let mut dusty = scene();
    dusty.wind.dust.release_per_s = 1.0;
    let mut mirror = Mirror::default();
    mirror.apply(scene_message(dusty)).unwrap();
    let codes: Vec<i16> = [0, 0, 0, STEPS.dust_code(2.0)].into_iter().flat_map(|code| [code; 32]).collect();
    let payload = codec::encode(Shape::wind(4, true), &codes, None);
    mirror
        .apply(ServerMessage::Wind { tick: 0, seq: 1, key: true, turbulence: TurbulenceState::default(), payload: payload.clone() })
        .unwrap();
    assert!((mirror.dust_at(Vec3::new(1.0, 1.0, 1.0)) - 2.0).abs() < 0.05);
    let clear = codec::encode(Shape::wind(4, true), &[0; 128], Some(codes.as_slice()));
    mirror.apply(ServerMessage::Wind { tick: 0, seq: 2, key: false, turbulence: TurbulenceState::default(), payload: clear }).unwrap();
    assert_eq!(mirror.wind().unwrap().codes()[96..], [0; 32]);
    assert!(
        loaded().apply(ServerMessage::Wind { tick: 0, seq: 1, key: true, turbulence: TurbulenceState::default(), payload }).is_err(),
        "four planes in a scene without dust"
    );
}

#[test]
fn too_many_wind_cells_are_rejected() {
    let mut bad = scene();
    bad.wind.cells = [256; 3];
    assert!(matches!(Mirror::default().apply(scene_message(bad)), Err(MirrorError::Range { what: "total number of wind cells", .. })));
}

fn pose(id: u32, x_m: f32) -> ObjectPose {
    ObjectPose {
        id,
        kind: VehicleKind::Car,
        position_m: [x_m, 0.0, 0.0],
        rotation: [0.0, 0.0, 0.0, 1.0],
        velocity_m_per_s: [0.0; 3],
        part_rad: 0.0,
    }
}

#[test]
fn an_object_missing_from_a_pose_frame_is_removed() {
    let mut mirror = loaded();
    mirror.apply(ServerMessage::Poses { tick: 60, objects: vec![pose(1, 0.0)] }).unwrap();
    assert!(mirror.object(1).is_some());
    mirror.apply(ServerMessage::Poses { tick: 66, objects: vec![pose(2, 1.0)] }).unwrap();
    mirror.advance(1.0);
    assert_eq!(mirror.object(1), None);
    assert_eq!(mirror.newest_objects(), [pose(2, 1.0)]);
}

#[test]
fn invalid_poses_are_rejected() {
    let mut mirror = loaded();
    for bad in [ObjectPose { position_m: [f32::NAN, 0.0, 0.0], ..pose(1, 0.0) }, ObjectPose { rotation: [0.0; 4], ..pose(1, 0.0) }] {
        assert!(matches!(mirror.apply(ServerMessage::Poses { tick: 1, objects: vec![bad] }), Err(MirrorError::Range { what: "pose", .. })));
    }
}

#[test]
fn scenes_out_of_range_are_rejected() {
    let mut bad = scene();
    bad.plants.grid_m = f32::NAN;
    assert!(matches!(Mirror::default().apply(scene_message(bad)), Err(MirrorError::Range { what: "plants.grid_m", .. })));
    let mut bad = scene();
    bad.patches.cells = 12;
    assert!(matches!(Mirror::default().apply(scene_message(bad)), Err(MirrorError::Range { what: "patches.cells", .. })));
}

proptest! {
    #[test]
    fn arbitrary_bytes_never_make_the_mirror_panic(kind in 0_u8..13, bytes in proptest::collection::vec(any::<u8>(), 0..600)) {
        let mut mirror = loaded();
        let mut message = vec![prairie_core::wire::PROTOCOL, kind];
        message.extend(bytes);
        if let Ok(message) = decode::<ServerMessage>(&message, 1 << 20) {
            let _ = mirror.apply(message);
            mirror.advance(0.1);
            prop_assert!(mirror.objects().all(|pose| pose.position_m.iter().all(|m| m.is_finite())));
        }
    }

    #[test]
    fn arbitrary_payloads_never_make_the_mirror_panic(patch in 0_u32..9, seq in any::<u32>(), key: bool, has_dust: bool, payload in proptest::collection::vec(any::<u8>(), 0..400)) {
        let mut mirror = Mirror::default();
        let mut scene = scene();
        scene.wind.dust.release_per_s = if has_dust { 1.0 } else { 0.0 };
        mirror.apply(scene_message(scene)).unwrap();
        let _ = mirror.apply(ServerMessage::Patch { patch, seq, key, payload: payload.clone() });
        let _ = mirror.apply(ServerMessage::Patch { patch, seq: seq.wrapping_add(1), key: false, payload: payload.clone() });
        let _ = mirror.apply(ServerMessage::Wind { tick: 0, seq, key, turbulence: TurbulenceState::default(), payload });
    }
}

#[test]
fn grass_angle_combines_wind_and_bend_field() {
    let mut scene = scene();
    scene.wind = Wind { cells: [2, 2, 2], ..Wind::default() };
    scene.grass.wind_bend_rad = 0.6;
    let mut mirror = Mirror::default();
    mirror.apply(scene_message(scene)).unwrap();
    // 20 m/s eastward hold the grass at 0.6 rad.
    let codes: Vec<i16> = [STEPS.wind_code(20.0), 0, 0].into_iter().flat_map(|code| [code; 8]).collect();
    let payload = codec::encode(Shape::wind(2, false), &codes, None);
    mirror.apply(ServerMessage::Wind { tick: 1, seq: 1, key: true, turbulence: TurbulenceState::default(), payload }).unwrap();
    assert!((mirror.theta_at(3.0, 1.0) - 0.6).abs() < 1e-3, "{}", mirror.theta_at(3.0, 1.0));
    for (seq, omega, expected_rad) in [(1, [40, 0], 1.4), (2, [-40, 0], 0.2), (3, [0, 40], 1.0)] {
        let planes = [STEPS.theta_code(0.8), omega[0], omega[1]];
        let codes: Vec<i16> = planes.into_iter().flat_map(|code| [code; 64]).collect();
        mirror.apply(patch(seq, true, None, &codes)).unwrap();
        let found_rad = mirror.theta_at(3.0, 1.0);
        assert!((found_rad - expected_rad).abs() < 0.015, "{found_rad} instead of {expected_rad} for ω = {omega:?}");
    }
}

#[test]
fn grass_species_out_of_range_are_rejected() {
    let error_of = |change: fn(&mut Species)| {
        let mut scene = scene();
        let mut species = Species::new("reed", 1, &scene.grass, &scene.plants);
        change(&mut species);
        scene.species = vec![species];
        Mirror::default().apply(scene_message(scene)).err().map(|error| error.to_string())
    };
    assert_eq!(error_of(|_| ()), None);
    assert_eq!(error_of(|species| species.grass.segments = 7).as_deref(), Some("*.segments is 7; allowed: 1..=6"));
    assert_eq!(error_of(|species| species.height_m = f32::NAN).as_deref(), Some("*.height_m is NaN; allowed: 0.02..=5"));
    let mut many = scene();
    many.species = vec![Species::new("reed", 1, &many.grass, &many.plants); 17];
    assert!(Mirror::default().apply(scene_message(many)).is_err());
}

#[test]
fn underbrush_out_of_range_is_rejected() {
    let error_of = |change: fn(&mut Scene)| {
        let mut scene = scene();
        let stalk = Component::new("stalk", ComponentKind::Branch);
        let leaf = Component { on: "stalk".to_owned(), ..Component::new("leaf", ComponentKind::Leaf) };
        scene.underbrush = vec![Underbrush::new("reed", vec![stalk, leaf])];
        change(&mut scene);
        Mirror::default().apply(scene_message(scene)).err().map(|error| error.to_string())
    };
    fn leaf(scene: &mut Scene) -> &mut Component {
        &mut scene.underbrush[0].components[1]
    }
    assert_eq!(error_of(|_| ()), None);
    type Change = fn(&mut Scene);
    let cases: [(Change, &str); 14] = [
        (|scene| scene.light.hour = f32::NAN, "light.hour is NaN; allowed: -1..=24"),
        (|scene| scene.lights = vec![Lamp::new([0.0; 3]); 9], "number of lights is 9; allowed: at most 8"),
        (|scene| scene.plants.swing_hz = 0.0, "*.swing_hz is 0; allowed: 0.05..=50"),
        (|scene| scene.rain.rate_mm_per_h = f32::INFINITY, "rain.rate_mm_per_h is inf; allowed: 0..=200"),
        (|scene| scene.objects.balls = 65, "objects.balls is 65; allowed: 0..=64"),
        (|scene| scene.growth.spacing_m = 0.0, "growth.spacing_m is 0; allowed: 0.05..=20"),
        (|scene| scene.underbrush[0].reach_m = f32::NAN, "underbrush.reach_m is NaN; allowed: 0..=50"),
        (|scene| scene.underbrush[0].components.clear(), "number of components is 0; allowed: 1..=16"),
        (|scene| leaf(scene).sections = 17, "sections is 17; allowed: 1..=16"),
        (|scene| leaf(scene).mass_kg = -1.0, "mass_kg is -1; allowed: 0.000001..=10"),
        (|scene| leaf(scene).from_share = 1.5, "from_share is 1.5; allowed: 0..=1"),
        (|scene| leaf(scene).to_share = 0.5, "to_share is 0.5; allowed: 1..=1"),
        (|scene| leaf(scene).on = "leaf".to_owned(), "parent of a component is leaf; allowed: an earlier branch, or empty"),
        (
            |scene| (scene.patches.count, scene.growth.spacing_m) = ([2048; 2], 0.1),
            "number of plant sites is 1677721600; allowed: at most 4194304",
        ),
    ];
    for (change, message) in cases {
        assert_eq!(error_of(change).as_deref(), Some(message));
    }
    let many = error_of(|scene| scene.underbrush[0].components.iter_mut().for_each(|component| component.count = 32));
    assert_eq!(many.as_deref(), Some("number of parts of a plant is 1056; allowed: at most 64"));
}

#[test]
fn the_nutrient_map_is_optional() {
    let plants_with = |png: Vec<u8>| {
        let mut own = scene();
        own.underbrush = vec![Underbrush::new("a", vec![Component::new("leaf", ComponentKind::Leaf)])];
        let mut message = scene_message(own);
        if let ServerMessage::Scene { nutrient_png, .. } = &mut message {
            *nutrient_png = png;
        }
        let mut mirror = Mirror::default();
        mirror.apply(message).map(|_| mirror.decoded_scene().and_then(DecodedScene::flora).map_or(0, |flora| flora.grown().plants().len()))
    };
    let [generated, rich, barren] =
        [Vec::new(), grey_png([3, 2], &[255; 6]), grey_png([3, 2], &[7; 6])].map(|png| plants_with(png).expect("a valid map"));
    assert!(rich != generated && rich > 0 && generated > 0 && barren == 0, "{rich}, {generated} and {barren} plants");
    assert!(matches!(plants_with(vec![1, 2, 3]), Err(MirrorError::Map { map: "nutrient map", .. })));
}

/// A mirror of a scene with underbrush, and its number of plant sites.
fn overgrown() -> (Mirror, u32) {
    let mut scene = scene();
    scene.underbrush = vec![Underbrush::new("sedge", vec![Component::new("leaf", ComponentKind::Leaf)])];
    let mut mirror = Mirror::default();
    mirror.apply(scene_message(scene)).unwrap();
    let sites = mirror.decoded_scene().and_then(DecodedScene::flora).expect("it grows").grown().sites.total();
    (mirror, sites as u32)
}

/// Message about broken plants: sites and heading codes.
fn broken(plants: impl IntoIterator<Item = (u32, u8)>) -> ServerMessage {
    let plant = |(site, fall)| BrokenPlant { site, fall: NonZeroU8::new(fall).expect("above 0") };
    ServerMessage::Broken { plants: plants.into_iter().map(plant).collect() }
}

#[test]
fn broken_plants_keep_their_direction_until_the_next_scene() {
    let (mut mirror, sites) = overgrown();
    assert_eq!((mirror.falls().len(), mirror.broken_count()), (sites.next_multiple_of(4) as usize, 0));
    assert_eq!(mirror.apply(broken([(0, 1), (33, 90), (sites - 1, 255)])), Ok(None));
    assert_eq!(mirror.apply(broken([(33, 7), (34, 128)])), Ok(None));
    let fallen = |mirror: &Mirror| (0..sites).zip(mirror.falls().to_vec()).filter(|(_, fall)| *fall != 0).collect::<Vec<_>>();
    assert_eq!(fallen(&mirror), [(0, 1), (33, 90), (34, 128), (sites - 1, 255)]);
    assert_eq!(mirror.broken_count(), 4);
    mirror.apply(scene_message(scene())).unwrap();
    assert_eq!((mirror.falls(), mirror.broken_count()), ([].as_slice(), 0));
    assert!(mirror.decoded_scene().and_then(DecodedScene::flora).is_none());
}

#[test]
fn broken_plants_on_unknown_sites_are_rejected_and_change_nothing() {
    let (mut mirror, sites) = overgrown();
    let error_of = |mirror: &mut Mirror, message| mirror.apply(message).err().map(|error| error.to_string());
    let beyond = error_of(&mut mirror, broken([(1, 9), (sites, 9)]));
    assert_eq!(beyond, Some(format!("site of a broken plant is {sites}; allowed: below {sites}")));
    assert!(error_of(&mut mirror, broken([(u32::MAX, 9)])).is_some());
    let many = error_of(&mut mirror, broken(std::iter::repeat_n((1, 9), 4097)));
    assert_eq!(many.as_deref(), Some("number of broken plants is 4097; allowed: at most 4096"));
    assert_eq!(mirror.broken_count(), 0);
    assert!(mirror.falls().iter().all(|fall| *fall == 0));
    assert!(error_of(&mut Mirror::default(), broken([(0, 9)])).is_some(), "before a scene");
    assert!(error_of(&mut loaded(), broken([(0, 9)])).is_some(), "in a scene without underbrush");
}
