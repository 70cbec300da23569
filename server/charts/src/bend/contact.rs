//! Error against cost of the two ways in which an object bends the grass that it touches: exact for each cell, and interpolated between the corners of the swept
//! area (Chen & Johan, §6).

use std::fmt::Write as _;
use std::sync::Arc;
use std::time::Instant;

use anyhow::{Context as _, Result};
use prairie_core::bend::{Bend, Field, Kinds, Serial};
use prairie_core::body::{BodyPose, Motion, Prism};
use prairie_core::grass::contact::Contact;
use prairie_core::grass::flattened::FlattenedGrass;
use prairie_core::grass::grass_properties::GrassProperties;
use prairie_core::grass::grass_state::GrassState;
use prairie_core::grass::swept_footprint::SweptFootprint;
use prairie_core::grid::PatchLayout;
use prairie_core::scene::{Grass, ObjectContact, Scene, TerrainMaps, VehicleKind};
use prairie_core::terrain::{CoverMap, HeightMap, KindMap, grey_png};
use prairie_core::wind::WindField;

use super::super::figure::{Axis, Curve, Drawn, Words, curves_svg};

const LAYOUT: PatchLayout = PatchLayout { count: [4, 4], cells: 64, cell_m: 0.25 };
const SPEED_M_PER_S: f32 = 20.0;
/// Radius of the quarter of a circle that is driven (m), about the corner of the map.
const RADIUS_M: f32 = 32.0;
/// Steps in a second of the reference.
const REFERENCE_HZ: f32 = 7680.0;
/// Height above the ground at which the car pushes the grass (m), and the bend below it (rad).
const STRIKE_HEIGHT_M: f32 = 0.3;
const SLIP_BEND_RAD: f32 = 1.3;
/// Smallest bend of the reference that counts as touched (rad).
const TOUCHED_RAD: f64 = 0.01;

/// Flat land with one kind of grass, without wind.
struct Land {
    scene: Scene,
    height: HeightMap,
    properties: GrassProperties,
    wind: WindField,
}

impl Land {
    fn new() -> Result<Self> {
        let extent_m = LAYOUT.extent_m();
        let maps = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: extent_m, level_m: 0.1, base_m: 0.0 };
        let scene = Scene::new(maps);
        let cover =
            CoverMap::from_png(&grey_png([2; 2], &[255; 4])).map_err(|fault| anyhow::anyhow!("{fault:?}")).context("covering map")?;
        let properties = GrassProperties::new(&scene, &cover);
        let wind = WindField::still(&scene, Arc::new(KindMap::uniform()));
        Ok(Self { height: HeightMap::from_heights(2, 2, extent_m, vec![0.0; 4]), scene, properties, wind })
    }
}

/// Pose of the car, which drives from the X axis to the Z axis.
fn pose(secs: f32) -> BodyPose {
    let angle_rad = secs * SPEED_M_PER_S / RADIUS_M;
    let (sin, cos) = angle_rad.sin_cos();
    // Its front, −Z of its own, points along the circle.
    let half_rad = 0.5 * (std::f32::consts::PI - angle_rad);
    BodyPose { position_m: [RADIUS_M * cos, 0.0, RADIUS_M * sin], rotation: [0.0, half_rad.sin(), 0.0, half_rad.cos()] }
}

/// Leans of all cells after the drive (rad), the time that contact took (s), and the number of presses of a cell.
fn drive(land: &Land, method: ObjectContact, steps_hz: f32) -> (Vec<[f32; 2]>, f64) {
    let mut field = Field::new(LAYOUT, Kinds::one(Grass::default().waves)).with_awake_limit(16);
    field.wake_all();
    let mut flattened = FlattenedGrass::new(LAYOUT, land.scene.grass.laid_recovery_secs, 4096);
    let car = Prism::cuboid([0.0; 3], [0.9, 0.5, 2.1]);
    let dt_secs = 1.0 / steps_hz;
    let steps = (std::f32::consts::FRAC_PI_2 * RADIUS_M / SPEED_M_PER_S * steps_hz).round() as u32;
    let mut secs = 0.0;
    for step in 0..steps {
        let motion = Motion {
            kind: VehicleKind::Car,
            from: pose(step as f32 * dt_secs),
            to: pose((step + 1) as f32 * dt_secs),
            velocity_m_per_s: [0.0; 3],
            part_rad: 0.0,
            is_at_rest: false,
        };
        let begun = Instant::now();
        let contact = Contact {
            swept: SweptFootprint::new(&car, &motion, LAYOUT.cell_m),
            strike_height_m: STRIKE_HEIGHT_M,
            slip_bend_rad: SLIP_BEND_RAD,
            parts_grass: true,
            settling_m_per_s: 0.3,
            flattened_fraction: 0.0,
            is_at_rest: false,
            method,
        };
        let strokes: Vec<_> = contact.strokes(&LAYOUT, dt_secs).collect();
        let mut grass = GrassState {
            field: &mut field,
            flattened: &mut flattened,
            wind: &land.wind,
            height: &land.height,
            properties: &land.properties,
        };
        grass.press(&strokes, &Serial);
        secs += begun.elapsed().as_secs_f64();
    }
    let side = i64::from(LAYOUT.count[0] * LAYOUT.cells);
    let lean = |Bend { theta, omega: [x, z] }: Bend| {
        let length = (x * x + z * z).sqrt().max(f32::MIN_POSITIVE);
        [x, z].map(|component| theta * component / length)
    };
    ((0..side * side).map(|at| lean(field.cell([at % side, at / side]))).collect(), secs)
}

/// Mean difference of the leans of the cells that the reference bends or that are bent (°).
fn error_deg(leans: &[[f32; 2]], reference: &[[f32; 2]]) -> f64 {
    let length = |[x, z]: [f32; 2]| f64::from(x.hypot(z));
    let pairs = || leans.iter().zip(reference).filter(|(a, b)| length(**a).max(length(**b)) > TOUCHED_RAD);
    let sum: f64 = pairs().map(|(a, b)| length([a[0] - b[0], a[1] - b[1]])).sum();
    (sum / pairs().count().max(1) as f64).to_degrees()
}

pub(super) fn draw(quick: bool, caption: &str) -> Result<Drawn> {
    let (repeats, rates): (u32, &[f32]) = if quick { (2, &[60.0, 120.0]) } else { (15, &[15.0, 30.0, 60.0, 120.0, 240.0, 480.0]) };
    let land = Land::new()?;
    let (reference, _) = drive(&land, ObjectContact::Exact, REFERENCE_HZ);
    let way_m = f64::from(std::f32::consts::FRAC_PI_2 * RADIUS_M);
    let mut csv = String::from("method,steps_per_sec,mean_error_deg,us_per_m\n");
    let mut rows = String::from(
        "# Contact of a car with the grass\n\nMean error of the lean of touched cells, and time per metre driven.\n\n| steps per second | exact | interpolated |\n|---:|---|---|\n",
    );
    let mut curves = [ObjectContact::Exact, ObjectContact::Interpolated].map(|method| Curve {
        name: method.word().to_owned(),
        points: vec![],
        marked: true,
        joined: true,
    });
    for &rate in rates {
        write!(rows, "| {rate:.0} ")?;
        for (method, curve) in [ObjectContact::Exact, ObjectContact::Interpolated].into_iter().zip(&mut curves) {
            let mut us_per_m = f64::INFINITY;
            let mut leans = vec![];
            for _ in 0..repeats {
                let secs;
                (leans, secs) = drive(&land, method, rate);
                us_per_m = us_per_m.min(1e6 * secs / way_m);
            }
            let error = error_deg(&leans, &reference);
            writeln!(csv, "{},{rate},{error:e},{us_per_m:e}", method.word())?;
            write!(rows, "| {error:.2}°, {us_per_m:.0} µs/m ")?;
            curve.points.push([error, us_per_m]);
        }
        rows.push_str("|\n");
    }
    let at_60 = |curve: &Curve| curve.points[rates.iter().position(|rate| *rate == 60.0).unwrap_or(0)];
    let [exact, interpolated] = [at_60(&curves[0]), at_60(&curves[1])];
    let summary = format!(
        "at 60 steps a second, interpolated contact takes {:.2} of the time of exact contact ({:.0} and {:.0} µs per metre driven); its mean error is {:.1}°, that of exact contact {:.2}°\n",
        interpolated[1] / exact[1],
        interpolated[1],
        exact[1],
        interpolated[0],
        exact[0]
    );
    let range = |axis: usize| {
        let values = || curves.iter().flat_map(|curve| &curve.points).map(move |point| point[axis]);
        [values().fold(f64::INFINITY, f64::min) / 1.5, values().fold(0.0, f64::max) * 1.5]
    };
    let axes = [
        Axis { name: "mean error of the lean of touched cells (°)", range: range(0), logarithmic: true },
        Axis { name: "time per metre driven (µs)", range: range(1), logarithmic: true },
    ];
    let words = Words {
        title: "Contact of a car with the grass",
        subtitle: "a car on a quarter of a circle at 20 m/s; cells of 0.25 m; 15 to 480 steps a second, against 7680, exact",
        caption,
    };
    let svg = curves_svg(&curves, axes, words)?;
    Ok(Drawn { svg, csv, summary, tables: Some(rows), map: None })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A user sees a wrong direction of some 10°; at the default rate exact contact must be far below, at any rate.
    const EXACT_DEG: f64 = 2.0;

    #[test]
    fn exact_contact_hardly_depends_on_the_step_and_interpolated_contact_does_not_converge_to_it() {
        let land = Land::new().unwrap();
        let (reference, _) = drive(&land, ObjectContact::Exact, 1920.0);
        let error = |method, rate| error_deg(&drive(&land, method, rate).0, &reference);
        for rate in [30.0, 60.0, 240.0] {
            let (exact, interpolated) = (error(ObjectContact::Exact, rate), error(ObjectContact::Interpolated, rate));
            assert!(exact < EXACT_DEG, "{rate} Hz: {exact}°");
            assert!(interpolated > EXACT_DEG && interpolated < 30.0, "{rate} Hz: {interpolated}°");
        }
    }
}
