//! Wind as an object (Chen & Johan, §5.3): helicopter downwash, cyclones, drawn winds.

use png::{BitDepth, ColorType};
use prairie::charts::worlds;
use prairie::scenes;
use prairie::world::World;
use prairie_core::bend::{Bend, Field, Kinds, Patch, Serial};
use prairie_core::grass::flattened::FlattenedGrass;
use prairie_core::grass::grass_properties::GrassProperties;
use prairie_core::grass::grass_state::GrassState;
use prairie_core::grass::prescribed_wind::{Pattern, PrescribedWind};
use prairie_core::grass::wind_drawing::WindDrawing;
use prairie_core::grid::PatchLayout;
use prairie_core::scene::{DrawnWind, Grass, WindShape};
use prairie_core::terrain::{CoverMap, HeightMap, grey_png};
use std::sync::Arc;
use tests::maps;

const DT_SECS: f32 = 1.0 / 60.0;
const LAYOUT: PatchLayout = PatchLayout { count: [2, 2], cells: 64, cell_m: 0.25 };

/// A field of 32 m after two seconds of a prescribed wind.
fn blown(wind: &PrescribedWind) -> Field {
    let mut field = Field::new(LAYOUT, Kinds::one(Grass::default().waves));
    (0..4).for_each(|index| {
        field.wake(index);
    });
    let mut flattened = FlattenedGrass::new(LAYOUT, 60.0, 0);
    let flat = HeightMap::from_heights(2, 2, [1000.0; 2], vec![0.0; 4]);
    let ground_wind = worlds::still_air(&worlds::scene(1));
    let grass = CoverMap::from_png(&grey_png([2; 2], &[255; 4])).expect("a grey PNG");
    let properties = GrassProperties::new(&worlds::scene(1), &grass);
    let mut state = GrassState { field: &mut field, flattened: &mut flattened, wind: &ground_wind, height: &flat, properties: &properties };
    for _ in 0..120 {
        state.press(&[wind.stroke(&LAYOUT)], &Serial);
    }
    field
}

/// Directions of the bend east, south, west and north of the middle.
fn around(field: &Field) -> [[f32; 2]; 4] {
    [[20.0, 16.1], [15.9, 20.0], [12.0, 15.9], [16.1, 12.0]].map(|[x, z]| {
        let Bend { theta, omega } = field.bend_at(x, z);
        assert!(theta > 0.1, "bent by {theta} rad at {x}, {z}");
        omega.map(|d| d / omega[0].hypot(omega[1]))
    })
}

fn close(found: [[f32; 2]; 4], expected: [[f32; 2]; 4]) -> bool {
    found.iter().zip(expected).all(|(a, b)| (0..2).all(|axis| (a[axis] - b[axis]).abs() < 0.1))
}

#[test]
fn the_effect_of_a_source_falls_with_its_height() {
    let bent = |height_m: f32| {
        let field = PrescribedWind::downwash(Pattern::Outward, [16.0, 16.0], height_m, DT_SECS).map(|wind| blown(&wind))?;
        let cells = field.awake().flat_map(Patch::rows).flat_map(|[theta, _, _]| theta).filter(|theta| **theta > 0.02).count();
        Some((cells, field.awake().map(Patch::theta_max_rad).fold(0.0, f32::max)))
    };
    let steps = [0.0, 5.0, 12.0, 20.0].map(|height_m| bent(height_m).expect("it reaches the ground"));
    for pair in steps.windows(2) {
        assert!(pair[1].0 < pair[0].0 && pair[1].1 < pair[0].1, "{steps:?}");
    }
    assert!((steps[0].1 - 1.2).abs() < 0.01, "on the ground the wash holds its bend: {steps:?}");
    assert_eq!(bent(30.0), None);
}

#[test]
fn outward_swirling_and_drawn_winds_have_their_directions() {
    let wash = |pattern| blown(&PrescribedWind::downwash(pattern, [16.0, 16.0], 0.0, DT_SECS).unwrap());
    let (east, south, west, north) = ([1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]);
    assert!(close(around(&wash(Pattern::Outward)), [east, south, west, north]));
    assert!(close(around(&wash(Pattern::Swirl)), [south, west, north, east]), "{:?}", around(&wash(Pattern::Swirl)));

    // Eastward in the northern half, southward in the southern.
    let pixels = [[255, 128, 200], [255, 128, 200], [128, 255, 200], [128, 255, 200]].concat();
    let drawing = WindDrawing::from_png(&maps::png(ColorType::Rgb, BitDepth::Eight, [2, 2], &pixels)).unwrap();
    let pattern = Pattern::Drawn(Arc::new(drawing));
    let at = |field: &Field, x: f32, z: f32| {
        field.bend_at(x, z).omega.map(|d| d / field.bend_at(x, z).omega[0].hypot(field.bend_at(x, z).omega[1]))
    };
    let straight = wash(pattern.clone());
    assert!(at(&straight, 16.0, 9.0)[0] > 0.99 && at(&straight, 12.0, 23.0)[1] > 0.99);
    // A quarter turn takes north to east and east to south.
    let turned = blown(&PrescribedWind {
        rotation_rad: std::f32::consts::FRAC_PI_2,
        ..PrescribedWind::downwash(pattern, [16.0, 16.0], 0.0, DT_SECS).unwrap()
    });
    assert!(at(&turned, 23.0, 16.0)[1] > 0.99 && at(&turned, 9.0, 16.0)[0] < -0.99);
}

#[test]
fn a_cyclone_follows_its_path_and_leaves_no_flattened_grass() {
    let mut scene = worlds::scene(8);
    let mut cyclone = DrawnWind::new(WindShape::Swirl, vec![[30.0, 40.0], [90.0, 40.0]]);
    (cyclone.radius_m, cyclone.travel_m_per_s) = (8.0, 5.0);
    scene.drawn_winds = vec![cyclone];
    // Grass that rises fast shows the present wind.
    (scene.grass.waves.stiffness_per_s2, scene.grass.waves.mu_m_per_rad) = (25.0, 0.0);
    let mut world = worlds::flat(&scene);
    let middle = |world: &World| {
        let field = world.bend().field();
        let cell = |n: u32| (n as f32 + 0.5) * 0.25;
        let bent = (0..512 * 512).map(|n| [cell(n % 512), cell(n / 512)]).filter(|[x, z]| field.bend_at(*x, *z).theta > 0.5);
        let (sum, count) = bent.fold(([0.0; 2], 0.0), |(sum, count), [x, z]| ([sum[0] + x, sum[1] + z], count + 1.0));
        sum.map(|m| m / count)
    };
    for (secs, x_m) in [(4.0, 50.0), (6.0, 80.0), (4.0, 80.0)] {
        (0..(secs * 60.0) as u32).for_each(|_| world.step(&[]));
        let found = middle(&world);
        assert!((found[0] - x_m).abs() < 2.0 && (found[1] - 40.0).abs() < 1.0, "{found:?}, and it is at {x_m}");
    }
    assert_eq!(world.bend().flattened().tiles(), 0);
    assert!(world.snapshot().diagnostics.awake_patches < 30);
}

#[test]
fn a_drawn_wind_from_a_scene_file_bends_the_grass() {
    let folder = tempfile::tempdir().unwrap();
    let west = maps::png(ColorType::Rgb, BitDepth::Eight, [2, 2], &[1, 128, 255].repeat(4));
    std::fs::write(folder.path().join("west.png"), west).unwrap();
    std::fs::write(folder.path().join("h.png"), grey_png([64, 64], &[0; 4096])).unwrap();
    std::fs::write(folder.path().join("c.png"), grey_png([2, 2], &[255; 4])).unwrap();
    let text = "summary = \"s\"\n[patches]\ncount = [4, 4]\n[terrain]\nheight_map = \"h.png\"\ncovering_map = \"c.png\"\npixel_m = [2, 2]\n\
                level_m = 1\n[objects.helicopter]\nwash_shape = \"west.png\"\n[[drawn_winds]]\nshape = \"west.png\"\npath_m = [[32, 32]]\nradius_m = 5\n";
    let path = folder.path().join("s.toml");
    std::fs::write(&path, text).unwrap();
    let loaded = scenes::load(path.to_str().unwrap()).unwrap();
    assert_eq!(loaded.scene.drawn_winds[0].shape, WindShape::Drawn("1.png".to_owned()), "clients are told no paths");
    let mut world = World::new(&loaded.scene, loaded.maps()).unwrap();
    (0..120).for_each(|_| world.step(&[]));
    let Bend { theta, omega } = world.bend().field().bend_at(32.0, 32.0);
    assert!(theta > 0.5 && omega[0] < 0.0 && omega[1].abs() < 0.1 * -omega[0], "{theta} rad along {omega:?}");

    let bare = World::new(&loaded.scene, prairie::world::Maps { drawings: Default::default(), ..loaded.maps() });
    assert_eq!(bare.err().unwrap().to_string(), "`drawn_winds` names the drawing `1.png`, which is not among the maps");
}

#[test]
fn a_wind_painted_over_the_world_bends_the_grass_along_its_vectors() {
    let loaded = scenes::load("scenes/painted.toml").unwrap();
    let [wind] = &loaded.scene.drawn_winds[..] else { panic!("one painted wind") };
    assert_eq!([wind.path_m[0], [wind.radius_m; 2]], [loaded.scene.extent_m().map(|side| 0.5 * side); 2], "it covers the world");
    let painted = WindDrawing::from_png(&std::fs::read("scenes/painted.png").unwrap()).unwrap();
    let mut world = World::new(&loaded.scene, loaded.maps()).unwrap();
    (0..120).for_each(|_| world.step(&[]));
    let field = world.bend().field();
    let places: Vec<[f32; 2]> = (0..64).map(|n| [n % 8, n / 8].map(|at| 8.0 + 16.0 * at as f32)).collect();
    // Along the painted vectors, and as a control along vectors turned by a right angle.
    let mut along = [0.0, 0.0];
    for [x, z] in &places {
        let [east, south] = painted.at([x / 64.0 - 1.0, z / 64.0 - 1.0]);
        let strength = east.hypot(south);
        let Bend { theta, omega } = field.bend_at(*x, *z);
        let direction = omega.map(|d| d / omega[0].hypot(omega[1]));
        let expected_rad = wind.bend_rad * strength;
        assert!((theta - expected_rad).abs() < 0.15 * wind.bend_rad, "{theta} instead of {expected_rad} rad at {x}, {z}");
        let cosines = [[east, south], [-south, east]].map(|[x, z]| (direction[0] * x + direction[1] * z) / strength);
        assert!(cosines[0] > 0.95, "along {direction:?} instead of {east}, {south} at {x}, {z}");
        along = [0, 1].map(|n: usize| along[n] + cosines[n] / places.len() as f32);
    }
    assert!(along[0] > 0.98 && along[1].abs() < 0.2, "{along:?}");
}
