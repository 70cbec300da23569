use super::*;
use crate::scene::{Grass, Species, TerrainMaps, WindBoundary, WindTiling};
use crate::terrain::{CoverMap, grey_png};
use crate::wind::offset_cells;

/// A world of 256 m with calm gusts.
fn scene() -> Scene {
    let maps = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [1.0, 1.0], level_m: 0.1, base_m: 0.0 };
    let mut scene = Scene::new(maps);
    scene.wind.turbulence = 0.0;
    scene
}

/// Code of a wind component (m/s) at the default step.
fn wind_code(m_per_s: f32) -> i16 {
    CodeSteps::default().wind_code(m_per_s)
}

/// A field of wind codes by cell, component after component.
fn field(scene: &Scene, code: impl Fn(usize, usize) -> i16) -> WindField {
    let mut field = WindField::still(scene, Arc::new(KindMap::uniform()));
    let count = field.velocities.len();
    let codes: Vec<_> = (0..3 * count).map(|at| code(at / count, at % count)).collect();
    field.set(&codes, &TurbulenceState::default());
    field
}

fn close(a: [f32; 2], b: [f32; 2]) -> bool {
    (a[0] - b[0]).abs() < 1e-5 && (a[1] - b[1]).abs() < 1e-5
}

#[test]
fn wind_is_trilinear_and_the_box_wraps_or_is_extended() {
    let mut scene = scene();
    (scene.wind.cells, scene.wind.spacing_m) = ([2, 2, 2], [8.0, 2.0, 4.0]);
    let [fast, slow] = [8.0, 4.0].map(wind_code);
    let code = move |component: usize, cell: usize| {
        if component == 0 && cell % 2 == 1 {
            fast
        } else if component == 2 {
            slow
        } else {
            0
        }
    };
    let wind = field(&scene, code);
    assert!(close([wind.resolved_at([8.0, 1.0, 2.0])[0], wind.resolved_at([8.0, 1.0, 2.0])[2]], [4.0, 4.0]));
    assert!((wind.resolved_at([16.0, 1.0, 2.0])[0] - 4.0).abs() < 1e-5, "half-way to the first column again");
    (scene.wind.faces.west, scene.wind.faces.east) = (WindBoundary::FreeSlip, WindBoundary::FreeSlip);
    assert!((field(&scene, code).resolved_at([16.0, 1.0, 2.0])[0] - 8.0).abs() < 1e-5);
    assert_eq!(wind.wind_at([12.0, 0.125, 2.0])[0], 0.5 * wind.resolved_at([12.0, 0.125, 2.0])[0], "half of it near the ground");
}

#[test]
fn each_kind_of_grass_leans_by_its_own_bend() {
    let mut scene = scene();
    let stiff = Grass { wind_bend_rad: 0.1, ..scene.grass };
    scene.species = vec![Species::new("stiff", 1, &stiff, &scene.plants)];
    // The eastern half is stiff.
    let cover = CoverMap::from_png(&grey_png([2; 2], &[255, 1, 255, 1])).unwrap();
    let east_m = scene.extent_m()[0];
    let mut wind = WindField::still(&scene, Arc::new(KindMap::new(&scene, &cover)));
    let count = wind.velocities.len();
    let codes: Vec<_> = (0..3 * count).map(|at| if at < count { wind_code(12.0) } else { 0 }).collect();
    wind.set(&codes, &TurbulenceState::default());
    let [[soft, _], [stiff, _]] = [[0.25 * east_m, 9.0], [0.75 * east_m, 9.0]].map(|at_m| wind.lean_at(at_m));
    assert!((soft - scene.grass.wind_bend_rad).abs() < 1e-6 && (stiff - 0.1).abs() < 1e-6, "{soft} and {stiff}");
}

#[test]
fn gusts_add_to_wind_and_lean() {
    let mut scene = scene();
    scene.wind.turbulence = 1.0;
    let mut wind = field(&scene, |component, _| if component == 0 { wind_code(4.0) } else { 0 });
    let calm = wind.wind_at([30.0, 5.0, 40.0]);
    let codes = vec![wind_code(4.0); wind.velocities.len()].into_iter().chain(vec![0; 2 * wind.velocities.len()]).collect::<Vec<_>>();
    wind.set(&codes, &TurbulenceState { friction_m_per_s: 0.4, ..TurbulenceState::default() });
    let ([u, v, w], [gust_u, gust_w]) = (wind.wind_at([30.0, 5.0, 40.0]), wind.gust_at([30.0, 40.0]));
    assert_eq!([u, v, w], [calm[0] + gust_u, calm[1], calm[2] + gust_w]);
    assert!(gust_u.abs() + gust_w.abs() > 0.01);
    assert_eq!(wind.lean_at([30.0, 40.0]), wind_lean_rad([u, w], scene.grass.wind_bend_rad));
    let places = (0..500).map(|n| [n as f32 * 3.1, 2.5, n as f32 * 1.7]);
    let fastest = places.map(|at_m| wind.wind_at(at_m).map(|speed| speed * speed).iter().sum::<f32>().sqrt()).fold(0.0, f32::max);
    assert!(fastest <= wind.strongest_m_per_s(2.5) && fastest > 4.0);
}

#[test]
fn a_box_tiled_by_patch_is_offset_in_each_patch() {
    let mut scene = scene();
    (scene.wind.tiling, scene.wind.cells, scene.wind.spacing_m) = (WindTiling::Patch, [8, 8, 8], [2.0; 3]);
    let patch_m = scene.patches.cells as f32 * scene.patches.cell_m;
    let wind = field(&scene, |component, cell| match component {
        0 => (cell % 8) as i16,
        2 => (cell / 64) as i16,
        _ => 0,
    });
    let inside = |n: usize| [n as f32 * patch_m + 9.0, patch_m + 9.0];
    let winds: Vec<_> = (0..16).map(|n| wind.resolved_at([inside(n)[0], 1.0, inside(n)[1]])).collect();
    for (n, found) in winds.iter().enumerate() {
        let [x, z] = offset_cells(scene.seed as u32, [n as i32, 1], [8, 8]).map(|cells| cells as f32 * 2.0);
        let [at_x, at_z] = inside(n);
        let wanted = wind.grid.trilinear([at_x + x, 1.0, at_z + z], |cell| wind.velocities[cell].to_array());
        assert!(close([found[0], found[2]], [wanted[0], wanted[2]]), "patch {n}");
    }
    assert!(winds.windows(2).any(|pair| pair[0] != pair[1]));
}
