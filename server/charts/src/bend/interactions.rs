//! The four interactions of Chen & Johan (section 7) in their setting, and the number of clusters a step can hold, beside grass that is simulated cluster by
//! cluster, as in Guerraz et al. 2003, and the 60 000 clusters of Orthmann et al. 2009.

use std::f32::consts::FRAC_PI_2;
use std::fmt::Write as _;
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context as _, Result};
use prairie_core::bend::{Bend, Field, GroundContact, Kinds, Rest, Scheme, Serial};
use prairie_core::grass::wind_drawing::WindDrawings;
use prairie_core::grass::{BendSimulation, Camera};
use prairie_core::grid::PatchLayout;
use prairie_core::plant::blade::contact::{Sphere, settle};
use prairie_core::plant::blade::{Blade, Integrator, Leans, Sway, advance};
use prairie_core::scene::{Grass, NaturalWind, Patches, Scene, TerrainMaps};
use prairie_core::terrain::{CoverMap, HeightMap, KindMap, grey_png};
use prairie_core::wind::WindField;

use super::super::figure::{Axis, Curve, Drawn, Words, curves_svg};
use crate::problems::bend::Striker;

const DT_SECS: f32 = 1.0 / 60.0;
/// Cells along a side of a patch, and their size (1.5 ft).
const CELLS: u32 = 120;
const CELL_M: f32 = 0.4572;
/// Patches along a side of the simulated region, 225 in all.
const SIDE: u32 = 15;
/// Largest bend at the start (rad): beyond the ground, so that contact with it has work to do.
const START_RAD: f32 = 2.0;
/// Clusters that Orthmann et al. simulate.
const ORTHMANN_CLUSTERS: f64 = 60_000.0;
/// Reach of the natural wind, which pushes four patches about a camera over the corner where they meet (m).
const WIND_REACH_M: f32 = 40.0;

fn layout(side: u32) -> PatchLayout {
    PatchLayout { count: [side; 2], cells: CELLS, cell_m: CELL_M }
}

fn clusters(side: u32) -> f64 {
    f64::from(side * CELLS).powi(2)
}

/// A field in which every cell moves for as long as it is timed.
fn moving(side: u32, ground_contact: GroundContact) -> Field {
    let rest = Rest { theta_rad: 0.0, omega_rad_per_s: 0.0 };
    let mut field = Field::new(layout(side), Kinds::one(Grass::default().waves)).with_rest(rest).with_ground_contact(ground_contact);
    field.start(DT_SECS, |[x, z]| {
        let [theta, u, w] = [0.7, 1.3, 2.1].map(|pitch: f32| START_RAD * (pitch * x).sin() * (0.9 * pitch * z).cos());
        [Bend { theta, omega: [u, w] }; 2]
    });
    field
}

/// A car in a corner of four patches, or in the middle of one.
fn car(step: u32) -> Striker {
    let along_m = 20.0 * DT_SECS * (step % 120) as f32 - 20.0;
    Striker { at_m: [along_m, 0.0], velocity_m_per_s: [20.0, 0.0], radius_m: 1.0, strike_height_m: 0.3 }
}

/// Shortest time of `steps` calls (ms).
fn least_ms(steps: u32, mut step: impl FnMut(u32) -> Result<()>) -> Result<f64> {
    let mut least = f64::INFINITY;
    for number in 0..steps {
        let begun = Instant::now();
        step(number)?;
        least = least.min(1e3 * begun.elapsed().as_secs_f64());
    }
    Ok(least)
}

fn waves_ms(side: u32, ground_contact: GroundContact, steps: u32) -> Result<f64> {
    let mut field = moving(side, ground_contact);
    least_ms(steps, |_| {
        field.step(Scheme::Verlet, DT_SECS, &Serial)?;
        Ok(())
    })
}

/// One car drives to and fro in a world of this size, and everything else sleeps.
fn one_car_ms(side: u32, steps: u32) -> Result<f64> {
    let rest = Rest { theta_rad: 0.01, omega_rad_per_s: 0.2 };
    let mut field = Field::new(layout(side), Kinds::one(Grass::default().waves)).with_rest(rest);
    let mut drive = |number: u32| {
        car(number).press(&mut field, DT_SECS);
        field.step(Scheme::Verlet, DT_SECS, &Serial)?;
        Ok(())
    };
    // The track has its full length after one way.
    (0..120).try_for_each(&mut drive)?;
    least_ms(steps, drive)
}

/// Every cluster is a blade of its own in the wind, and meets the sphere of one car.
fn one_by_one_ms(count: u32, steps: u32) -> Result<f64> {
    let blade = Blade { length_m: 0.8, frequency_rad_per_s: 9.7, damping_ratio: 0.1, lean_per_wind2: 0.005 };
    let mut sways = vec![Sway::default(); count as usize];
    let side = f64::from(count).sqrt() as usize;
    least_ms(steps, |number| {
        let [car_m, _] = car(number).at_m;
        for (at, sway) in sways.iter_mut().enumerate() {
            let [x, z] = [at % side, at / side].map(|n| (n as f32 - 0.5 * side as f32) * CELL_M);
            let moved = advance(sway, &blade, &Leans::default(), &[[4.0, 1.0]; 3], Integrator::Exact, DT_SECS);
            let sphere = Sphere { centre_m: [car_m - x, 0.5, -z], radius_m: 1.3 };
            *sway = settle(&moved, blade.length_m, [0.0, 1.0, 0.0], &[sphere]);
        }
        black_box(&mut sways);
        Ok(())
    })
}

/// Time that one car adds to a step: that of pressing the cells that it touches.
fn contact_ms(steps: u32) -> Result<f64> {
    let mut field = moving(SIDE, GroundContact::None);
    least_ms(steps, |number| {
        car(number).press(&mut field, DT_SECS);
        Ok(())
    })
}

/// A step of a region of which the natural wind pushes the four patches about a camera.
fn wind_ms(strength_rad_per_s2: f32, steps: u32) -> Result<f64> {
    let extent_m = layout(SIDE - 1).extent_m()[0];
    let terrain = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [extent_m; 2], level_m: 0.1, base_m: 0.0 };
    let mut scene =
        Scene { natural_wind: NaturalWind { strength_rad_per_s2, reach_m: WIND_REACH_M, ..NaturalWind::default() }, ..Scene::new(terrain) };
    scene.patches = Patches { count: [SIDE - 1; 2], cells: CELLS, cell_m: CELL_M, awake_limit: 225 };
    scene.bend.scheme = Scheme::Verlet;
    let height = Arc::new(HeightMap::from_heights(2, 2, [extent_m; 2], vec![0.0; 4]));
    let cover =
        CoverMap::from_png(&grey_png([2; 2], &[255; 4])).map_err(|fault| anyhow::anyhow!("{fault:?}")).context("the covering map")?;
    let mut grass = BendSimulation::new(&scene, height, &cover, &[], &WindDrawings::new());
    let still = WindField::still(&scene, Arc::new(KindMap::uniform()));
    let camera = Camera { client: 0, eye_m: [0.5 * extent_m, 2.0, 0.5 * extent_m] };
    let mut step = |_| {
        grass.step(DT_SECS, &[], &[camera], &still, &Serial);
        Ok(())
    };
    (0..120).try_for_each(&mut step)?;
    least_ms(steps, step)
}

/// A Markdown table of the interactions in a square of `side` patches, with the time of each (ms).
fn table(side: u32, waves_ms: f64, ground_ms: f64, contact_ms: f64, wind_ms: f64) -> String {
    format!(
        "| interaction | here | a step takes |\n|---|---|---:|\n\
         | grass–grass | waves through all {0} patches, Verlet's scheme | {waves_ms:.2} ms |\n\
         | grass–terrain | the same, with bends of at most {1:.2} rad | {ground_ms:.2} ms |\n\
         | grass–object | one car at 20 m/s, in addition | {contact_ms:.4} ms |\n\
         | grass–wind | gusts of noise in four patches about a camera of {2} × {2}, and their waves | {wind_ms:.2} ms |\n",
        side * side,
        FRAC_PI_2,
        SIDE - 1
    )
}

pub(super) fn draw(quick: bool, caption: &str) -> Result<Drawn> {
    let (steps, sides): (u32, &[u32]) = if quick { (5, &[1, 2, 4]) } else { (40, &[1, 2, 4, 8, 15]) };
    let mut csv = String::from("method,clusters,ms_a_step\n");
    let mut curve = |name: &str, sizes: Vec<f64>, time: &dyn Fn(usize) -> Result<f64>| -> Result<Curve> {
        let mut points = vec![];
        for (number, size) in sizes.into_iter().enumerate() {
            let ms = time(number)?;
            writeln!(csv, "{name},{size},{ms:e}")?;
            points.push([size, ms]);
        }
        Ok(Curve { name: name.to_owned(), points, marked: true, joined: true })
    };
    let worlds: &[u32] = if quick { &[2, 8, 88] } else { &[2, 4, 8, 16, 32, 88] };
    let counts = if quick { vec![1_000, 10_000] } else { vec![1_000, 10_000, 60_000, 250_000, 1_000_000] };
    let all = curve("continuum, every cluster moves", sides.iter().copied().map(clusters).collect(), &|n| {
        waves_ms(sides[n], GroundContact::None, steps)
    })?;
    let one = curve("continuum, one car drives", worlds.iter().copied().map(clusters).collect(), &|n| one_car_ms(worlds[n], steps))?;
    let single = curve("cluster by cluster", counts.iter().copied().map(f64::from).collect(), &|n| one_by_one_ms(counts[n], steps))?;
    let per_cluster_ns = |curve: &Curve| curve.points.last().map_or(f64::NAN, |[count, ms]| 1e6 * ms / count);
    let [all_ns, single_ns] = [&all, &single].map(per_cluster_ns);
    let fits = |ns: f64| 1e9 * f64::from(DT_SECS) / ns;
    let summary = format!(
        "a cluster takes {all_ns:.1} ns of the continuum and {single_ns:.0} ns by itself ({:.0} times as much)\n\
         at 60 steps a second one core holds {:.1} million moving clusters of the continuum, {:.2} million by themselves; Orthmann et al. have 0.06 million\n",
        single_ns / all_ns,
        1e-6 * fits(all_ns),
        1e-6 * fits(single_ns)
    );
    let wind = wind_ms(2.0, steps)? - wind_ms(0.0, steps)?;
    let side = if quick { 4 } else { SIDE };
    let tables = table(
        side,
        waves_ms(side, GroundContact::None, steps)?,
        waves_ms(side, GroundContact::Inelastic, steps)?,
        contact_ms(steps)?,
        wind,
    );
    let times = || [&all, &one, &single].into_iter().flat_map(|curve| &curve.points).map(|point| point[1]);
    let range = [times().fold(f64::INFINITY, f64::min) / 2.0, 2.0 * times().fold(0.0, f64::max).max(1e3 * f64::from(DT_SECS))];
    let line = |name: &str, points: [[f64; 2]; 2]| Curve { name: name.to_owned(), points: points.to_vec(), marked: false, joined: true };
    let frame = line("a step at 60 Hz", [500.0, 3e8].map(|count| [count, 1e3 * f64::from(DT_SECS)]));
    let orthmann = line("60 000 clusters (Orthmann et al. 2009)", range.map(|ms| [ORTHMANN_CLUSTERS, ms]));
    let axes = [
        Axis { name: "clusters of grass", range: [500.0, 3e8], logarithmic: true },
        Axis { name: "time of a step (ms)", range, logarithmic: true },
    ];
    let words = Words {
        title: "Clusters of grass and the time of a step",
        subtitle: "one thread; a cluster by itself is a blade of three links in the wind that meets one sphere, as Guerraz et al. 2003 simulate blades",
        caption,
    };
    let svg = curves_svg(&[all, one, single, frame, orthmann], axes, words)?;
    Ok(Drawn { svg, csv, summary, tables: Some(tables), map: None })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_car_costs_the_same_in_a_world_of_any_size_and_wakes_few_patches() {
        let rest = Rest { theta_rad: 0.01, omega_rad_per_s: 0.2 };
        let awake = [2, 88].map(|side| {
            let mut field = Field::new(layout(side), Kinds::one(Grass::default().waves)).with_rest(rest);
            for step in 0..60 {
                car(step).press(&mut field, DT_SECS);
                field.step(Scheme::Verlet, DT_SECS, &Serial).unwrap();
            }
            field.awake_count()
        });
        assert!(awake[0] == awake[1] && awake[0] <= 4, "{awake:?} patches are awake");
    }

    #[test]
    fn the_ground_stops_some_of_the_moving_grass() {
        let largest_rad = |ground_contact| {
            let mut field = moving(1, ground_contact);
            field.step(Scheme::Verlet, DT_SECS, &Serial).unwrap();
            let cells = (0..i64::from(CELLS)).flat_map(|z| (0..i64::from(CELLS)).map(move |x| [x, z]));
            cells.map(|cell| field.cell(cell).theta.abs()).fold(0.0, f32::max)
        };
        assert!(largest_rad(GroundContact::Inelastic) <= FRAC_PI_2 && largest_rad(GroundContact::None) > FRAC_PI_2);
    }

    #[test]
    fn the_table_names_the_four_interactions() {
        let table = table(SIDE, 1.0, 2.0, 0.0125, 4.0);
        for (row, ms) in
            [("grass–grass", "1.00 ms"), ("grass–terrain", "2.00 ms"), ("grass–object", "0.0125 ms"), ("grass–wind", "4.00 ms")]
        {
            assert!(table.lines().any(|line| line.contains(row) && line.contains(ms)), "{table}");
        }
    }
}
