//! Plants on one core: a step of the near blades and its parts, underbrush postures, growth, the force field, breaking by the wind.
//!
//! Every line has the shortest and the median time of many runs, and the speed-up over another line. The near blades are nine grids of 1024, as around
//! a camera. Their step samples the wind at three control points of every blade, integrates the swing, and corrects blades that lean far or touch a
//! sphere: the CPU twin of the client's GPU code.

use std::hint::black_box;
use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::Vec3;
use prairie::plants::PlantDamage;
use prairie::scenes;
use prairie::weather::Weather;
use prairie_core::grass::BendSimulation;
use prairie_core::hash::hash3;
use prairie_core::plant::blade::contact::{Sphere, settle};
use prairie_core::plant::blade::{Blade, Integrator, LINKS, Leans, Sway, advance};
use prairie_core::plant::flora::Flora;
use prairie_core::plant::force_field::{ForceField, Lingering, Obstacle, VolumeMesh, dynamic_pressure_pa};
use prairie_core::plant::underbrush::plant::{Forces, LookUp, Stand, posed};
use prairie_core::plant::underbrush::posture::{Nodes, Postures};
use prairie_core::plant::underbrush::rest::{Load, balanced, joints};
use prairie_core::plant::underbrush::strength::fractions;
use prairie_core::scene::parse;
use prairie_core::terrain::{CoverMap, grey_png};
use prairie_core::wind::CellGrid;
use prairie_wind::{Air, Config, Method};

/// Nine grids of 8 m with 1024 plants each, at multiples of their side as around a camera.
const GRID_PLANTS: usize = 1024;
const PLANTS: usize = 9 * GRID_PLANTS;
const GRID_M: f32 = 8.0;
const CORNER_M: f32 = 13.0 * GRID_M;
const DT_SECS: f32 = 1.0 / 60.0;
/// Lean of a link (rad) above which a blade may touch the ground.
const FAR_RAD: f32 = 1.0;
/// Timing duration of a line, after its minimum number of runs.
const ENOUGH: Duration = Duration::from_millis(500);
const FEWEST_RUNS: usize = 3;

/// Shortest and median time of a run (s).
#[derive(Clone, Copy)]
struct Times {
    least_secs: f64,
    median_secs: f64,
}

fn time(mut work: impl FnMut()) -> Times {
    let (begun, mut runs) = (Instant::now(), Vec::new());
    while runs.len() < FEWEST_RUNS || begun.elapsed() < ENOUGH {
        let run = Instant::now();
        work();
        runs.push(run.elapsed().as_secs_f64());
    }
    runs.sort_by(f64::total_cmp);
    Times { least_secs: runs[0], median_secs: runs[runs.len() / 2] }
}

/// Prints a line: times divided by `count`, in a unit of `unit_secs`; with `than`, also the speed-up over it.
fn line(name: &str, times: Times, count: usize, (unit, unit_secs): (&str, f64), than: Option<Times>) {
    let per = |secs: f64| secs / count as f64 / unit_secs;
    let ratio = than.map_or(String::new(), |than| format!("{:.1}×", than.least_secs / times.least_secs));
    println!("| {name:<58} | {:>8.3} | {:>8.3} | {unit:<12} | {ratio:>6} |", per(times.least_secs), per(times.median_secs));
}

const MS: (&str, f64) = ("ms", 1e-3);
const US: (&str, f64) = ("µs", 1e-6);
const NS: (&str, f64) = ("ns", 1e-9);

fn heading(of: &str, than: &str) {
    println!("\n| {of:<58} |    least |   median | unit         | {than:>6} |");
    println!("| {} | -------: | -------: | ------------ | -----: |", "-".repeat(58));
}

fn fraction(place: [u32; 3]) -> f32 {
    (hash3(place)[0] >> 8) as f32 / (1 << 24) as f32
}

/// A plant of the meadow: its root, its blade, and its lean without wind.
struct Grown {
    root_m: [f32; 2],
    blade: Blade,
    held_rad: Leans,
}

fn grown(number: usize) -> Grown {
    let random = |low: f32, high: f32, what: u32| low + (high - low) * fraction([number as u32, what, 7]);
    let (grid, within) = (number / GRID_PLANTS, [random(0.0, GRID_M, 0), random(0.0, GRID_M, 1)]);
    let corner = [grid % 3, grid / 3].map(|n| CORNER_M + GRID_M * n as f32);
    let length_m = random(0.5, 1.1, 2);
    let droop = [random(-0.2, 0.2, 3), random(-0.2, 0.2, 4)];
    Grown {
        root_m: [corner[0] + within[0], corner[1] + within[1]],
        blade: Blade { length_m, frequency_rad_per_s: 9.74 * 0.8 / length_m, damping_ratio: 0.1, lean_per_wind2: 0.005 },
        held_rad: [0.6, 1.0, 1.4].map(|part| droop.map(|lean| part * lean)),
    }
}

/// All plants of the meadow.
fn meadow(spacing_m: [f32; 3]) -> Vec<Grown> {
    let mut plants: Vec<Grown> = (0..PLANTS).map(grown).collect();
    for grid in plants.chunks_mut(GRID_PLANTS) {
        grid.sort_by_key(|plant| [(plant.root_m[1] / spacing_m[2]) as i32, (plant.root_m[0] / spacing_m[0]) as i32]);
    }
    plants
}

/// The default wind with its gusts, in 32 × 8 × 32 cells.
struct Wind {
    grid: CellGrid,
    cells: Vec<[f32; 2]>,
}

impl Wind {
    fn blown() -> Self {
        let config = Config::default();
        let mut air = Air::<f32>::new(Method::Staggered, &config).expect("the default settings are allowed");
        for _ in 0..240 {
            air.step(f64::from(DT_SECS), &[]).expect("a step within the limits");
        }
        let grid = CellGrid { cells: config.cells, spacing_m: config.spacing_m, periodic: [true, false, true] };
        Self { grid, cells: air.cell_velocities().map(|velocity| [velocity.x, velocity.z]).collect() }
    }

    fn at(&self, at_m: [f32; 3]) -> [f32; 2] {
        self.grid.trilinear(at_m, |cell| self.cells[cell])
    }
}

/// The two ends of a car and a ball, among the plants.
fn spheres_m() -> [Sphere; 3] {
    let sphere = |x: f32, y: f32, z: f32, radius_m: f32| Sphere { centre_m: [CORNER_M + x, y, CORNER_M + z], radius_m };
    [sphere(9.0, 1.0, 12.0, 0.9), sphere(10.8, 1.0, 12.0, 0.9), sphere(16.0, 0.45, 5.0, 0.4)]
}

/// Spheres within reach of a blade, relative to its root.
fn within_reach(spheres: &[Sphere], [x, z]: [f32; 2], length_m: f32) -> Vec<Sphere> {
    let from_root = |sphere: &Sphere| Sphere { centre_m: [sphere.centre_m[0] - x, sphere.centre_m[1], sphere.centre_m[2] - z], ..*sphere };
    let is_near = |sphere: &Sphere| {
        let reach_m = sphere.radius_m + length_m;
        sphere.centre_m.iter().map(|m| m * m).sum::<f32>() < reach_m * reach_m
    };
    spheres.iter().map(from_root).filter(is_near).collect()
}

fn step_one(plant: &Grown, sway: &mut Sway, wind: &Wind, spheres: &[Sphere], integrator: Integrator, dt_secs: f32) {
    let [x, z] = plant.root_m;
    let winds = sway.points_m(plant.blade.length_m).map(|[east, up, south]| wind.at([x + east, up, z + south]));
    *sway = advance(sway, &plant.blade, &plant.held_rad, &winds, integrator, dt_secs);
    let near = within_reach(spheres, plant.root_m, plant.blade.length_m);
    if !near.is_empty() || sway.lean_rad.iter().any(|[x, z]| x * x + z * z > FAR_RAD * FAR_RAD) {
        *sway = settle(sway, plant.blade.length_m, [0.0, 1.0, 0.0], &near);
    }
}

fn near_plants() {
    let wind = Wind::blown();
    let spheres = spheres_m();
    let plants = meadow(wind.grid.spacing_m);
    heading("near plants, nine grids of 1024, one step", "");
    for (name, integrator) in [("Euler", Integrator::Euler), ("Verlet", Integrator::Verlet), ("exact", Integrator::Exact)] {
        // Euler and Verlet are unstable at a step of 1/60 s.
        let dt_secs = if integrator == Integrator::Exact { DT_SECS } else { 1.0 / 960.0 };
        let mut sways: Vec<Sway> = plants.iter().map(|plant| Sway::at_rest(plant.held_rad)).collect();
        let whole = time(|| {
            plants.iter().zip(&mut sways).for_each(|(plant, sway)| step_one(plant, sway, &wind, &spheres, integrator, dt_secs));
        });
        line(&format!("{name}: wind, swing and contacts"), whole, 1, MS, None);
        let swing = time(|| {
            for (plant, sway) in plants.iter().zip(&mut sways) {
                *sway = advance(sway, &plant.blade, &plant.held_rad, &[[4.0, 1.0]; LINKS], integrator, dt_secs);
            }
        });
        line(&format!("{name}: swing alone"), swing, 1, MS, None);
        if integrator == Integrator::Exact {
            let wind = time(|| {
                for (plant, sway) in plants.iter().zip(&sways) {
                    let [x, z] = plant.root_m;
                    black_box(sway.points_m(plant.blade.length_m).map(|[east, up, south]| wind.at([x + east, up, z + south])));
                }
            });
            line("wind at three points a plant", wind, 1, MS, None);
            let settled = time(|| {
                for (plant, sway) in plants.iter().zip(&sways) {
                    black_box(settle(sway, plant.blade.length_m, [0.0, 1.0, 0.0], &[]));
                }
            });
            line("contact with the ground, were it for all", settled, 1, MS, None);
        }
    }
}

fn postures() {
    let (joints, fractions) = (joints(8, 0.5), fractions(8, 0.5));
    let table = Postures::new(&joints, &fractions, Nodes::default());
    let asked: Vec<[f32; 2]> = (0..4096)
        .map(|n| [fraction([n, 1, 2]) * std::f32::consts::PI, 0.1 * 2000.0_f32.powf(fraction([n, 2, 2]))])
        .map(|[angle, load]| [angle.cos(), load])
        .collect();
    let balance = time(|| {
        let mut bends_rad = [0.0; 8];
        for &[cosine, load] in &asked {
            balanced(&joints, Load { spread: load.into(), tip: 0.0 }, f64::from(cosine).acos(), &mut bends_rad);
            black_box(&bends_rad);
        }
    });
    let nearest = time(|| {
        asked.iter().for_each(|&[cosine, load]| {
            black_box(table.nearest(cosine, load)[0]);
        })
    });
    let interpolated = time(|| {
        let mut node = [0.0; 9];
        for &[cosine, load] in &asked {
            table.interpolated(cosine, load, &mut node);
            black_box(&node);
        }
    });
    heading("postures, 33 × 33 nodes of eight sections", "faster");
    line("a component in full balance", balance, asked.len(), NS, None);
    line("looked up at the nearest node", nearest, asked.len(), NS, Some(balance));
    line("looked up between nodes", interpolated, asked.len(), NS, Some(balance));
}

/// Terrain of the default size, 256 m square, with the eight built-in species.
fn flora() -> (Times, Flora) {
    let scene = format!(
        "summary = 's'\n[terrain]\nheight_map = 'h.png'\ncovering_map = 'c.png'\npixel_m = [2, 2]\nlevel_m = 0.1\n{}",
        include_str!("../../server/scenes/species.toml")
    );
    let scene = parse(&scene).expect("the species that ship are allowed");
    let cover = CoverMap::from_png(&grey_png([4; 2], &[255; 16])).expect("a covering map");
    let mut found = None;
    let times = time(|| found = Flora::new(&scene, &cover, None));
    (times, found.expect("a scene with underbrush"))
}

fn underbrush() {
    let (growing, flora) = flora();
    let forces = Forces {
        per_mass_m_per_s2: Vec3::Y * -prairie_core::GRAVITY_M_PER_S2 as f32,
        pressure_pa: dynamic_pressure_pa([5.0, 0.0, 1.5]).into(),
    };
    heading("underbrush, a component posed", "slower");
    for (species, plan) in flora.species().iter().zip(flora.plans()) {
        let plants: Vec<_> = (0..64).map(|number| plan.placed(number)).collect();
        let count: usize = plants.iter().map(Vec::len).sum();
        let pose = |look_up: LookUp| {
            time(|| {
                for (number, placed) in plants.iter().enumerate() {
                    let stand = Stand { size: 1.0, heading_rad: number as f32, lean_rad: [0.1, 0.0] };
                    black_box(posed(plan, placed, stand, forces, look_up, 0));
                }
            })
        };
        let [nearest, interpolated] = [LookUp::Nearest, LookUp::Interpolated].map(pose);
        line(&format!("{}, interpolated; nearest beside", species.name), interpolated, count, NS, Some(nearest));
    }
    let [columns, rows] = flora.grown().sites.count();
    heading("growing, with the tables of all species", "");
    line(&format!("{columns} × {rows} sites, {} plants of eight species", flora.grown().plants().len()), growing, 1, MS, None);
}

fn force_field() {
    let mesh = VolumeMesh { count: [64, 4, 64], spacing_m: [1.0, 0.5, 1.0], corner: [0, 0] };
    let mut field = ForceField::new(mesh, Lingering { spread_m2_per_s: 0.2, decay_per_s: 3.0 });
    field.strike([([32, 1, 32], [40.0, 0.0, 0.0])], DT_SECS);
    let spread = time(|| field.step(DT_SECS));
    let stones = (0..100).map(|i| Obstacle::round([0.64 * i as f32, 0.5, (7 * i % 64) as f32], [0.8; 3]));
    let obstructed = time(|| field.obstruct(stones.clone()));
    let blown = time(|| field.blow(|[x, _, z]| dynamic_pressure_pa([5.0 + 0.01 * x, 0.0, 1.5 - 0.01 * z])));
    let sheltered = time(|| field.shelter());
    heading("force field, 64 × 4 × 64 volumes", "");
    line("what lingers spreads and decays", spread, 1, MS, None);
    line("100 stones get in the way", obstructed, 1, MS, None);
    line("the wind blows", blown, 1, MS, None);
    line("lees go on, and the wind arrives", sheltered, 1, MS, None);
}

/// Time per step to check whether the wind breaks anything, in the default wind and in one that breaks the weakest plants.
fn breaking() {
    let loaded = scenes::load("underbrush").expect("a built-in scene is sound");
    let maps = loaded.maps();
    let flora = Flora::new(&loaded.scene, &maps.cover, None).expect("a scene with underbrush");
    let meadow = BendSimulation::new(
        &loaded.scene,
        Arc::new(maps.height.clone()),
        &maps.cover,
        &prairie_vehicles::bodies(&loaded.scene.objects),
        &maps.drawings,
    );
    heading(&format!("a look at the wind for {} plants, a step", flora.grown().plants().len()), "slower");
    let mut calm = None;
    for (name, wind_m_per_s) in [("in the scene's own wind", loaded.scene.wind.mean_m_per_s), ("in a storm", [40.0, 0.0])] {
        let mut scene = loaded.scene.clone();
        (scene.wind.mean_m_per_s, scene.wind.canopy_drag_per_m) = (wind_m_per_s, 0.0);
        let weather = Weather::new(&scene, &maps.height, &maps.cover).expect("a wind that blows");
        let (mut plants, mut tick) = (PlantDamage::new(Some(flora.clone()), DT_SECS), 0);
        let times = time(|| {
            for _ in 0..120 {
                plants.step(tick, DT_SECS, &meadow, &weather);
                tick += 1;
            }
        });
        let strongest_m_per_s = weather.field().strongest_m_per_s(1.0);
        line(&format!("{name}, up to {strongest_m_per_s:.0} m/s: {} broken", plants.broken().len()), times, 120, US, calm);
        calm = calm.or(Some(times));
    }
}

fn main() {
    // `cargo test` and `--test` run each benchmark once; this one, of half a minute, is skipped.
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    let asked: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with('-')).collect();
    let parts: [(&str, fn()); 5] =
        [("near", near_plants), ("postures", postures), ("underbrush", underbrush), ("field", force_field), ("breaking", breaking)];
    for (name, part) in parts {
        if asked.is_empty() || asked.iter().any(|word| name.contains(word.as_str())) {
            part();
        }
    }
}
