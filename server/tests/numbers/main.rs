//! `prairie run` and its files: the world is that of a server, and the files have its values.

mod drive;
mod interrupted;
mod messages;
mod python;
mod stations;
mod vtk;
#[cfg(feature = "zarr")]
mod zarr;

use prairie::batch::{Drivers, Schedule, read_drivers, run};
use prairie::output::{Frame, OutputError, Outputs, Sampler, Sink};
use prairie::scenes::{self, LoadedScene};
use prairie::world::World;
use prairie_core::bend::Bend;
use prairie_core::grass::grass_state::published;
use std::path::Path;
use std::process::{Command, Output};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};

/// A car that drives over the land, brakes and turns.
const DRIVE: &str = "\
[[driver]]
vehicle = \"car\"
at_m = [20.0, 32.0]
inputs = [
    { at_secs = 0.2, throttle = 1.0 },
    { at_secs = 1.2, throttle = 0.5, steer = 0.4 },
    { at_secs = 1.9, brake = 1.0 },
]
";

/// A small scene: 64 m a side, 256 × 256 cells of grass.
fn scene() -> LoadedScene {
    scenes::load("blades").unwrap()
}

/// The drivers of a file with this text.
fn drivers(text: &str) -> Drivers {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.toml");
    std::fs::write(&path, text).unwrap();
    let scene = scene().scene;
    Drivers::new(&read_drivers(&path, &scene).unwrap(), scene.tick_hz)
}

fn world() -> World {
    let scene = scene();
    World::new(&scene.scene, scene.maps()).unwrap()
}

/// A world after a run with the drivers of a file, which writes fields every `ticks_per_frame` steps and stations each step.
fn ran(text: &str, ticks: u64, ticks_per_frame: u64, outputs: Outputs) -> World {
    let (mut world, mut drivers) = (world(), drivers(text));
    let schedule = Schedule { ticks, ticks_per_frame, ticks_per_row: 1 };
    assert_eq!(run(&mut world, &mut drivers, schedule, outputs, &AtomicBool::new(false), |_| ()).unwrap(), ticks);
    world
}

/// Keeps all frames in memory.
#[derive(Default)]
struct Kept(Arc<Mutex<Vec<Frame>>>);

impl Sink for Kept {
    fn write(&mut self, frame: &Frame) -> Result<(), OutputError> {
        self.0.lock().unwrap().push(frame.clone());
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<(), OutputError> {
        Ok(())
    }
}

/// Values of a variable in a world, each found by itself, in the order of the files: Z and X, in the air first Y.
fn values(world: &World, loaded: &LoadedScene, variable: &str) -> Vec<f32> {
    let [nx, ny, nz] = loaded.scene.wind.cells.map(|n| n as usize);
    let (velocities, field) = (world.weather().velocities(), world.weather().field());
    let air = |axis: usize| {
        let cells = (0..ny).flat_map(|j| (0..nz).flat_map(move |k| (0..nx).map(move |i| i + nx * (j + ny * k))));
        cells.map(|cell| velocities[cell][axis]).collect()
    };
    let [across, along] = [0, 1].map(|axis| (loaded.scene.patches.count[axis] * loaded.scene.patches.cells) as usize);
    let cell_m = loaded.scene.patches.cell_m;
    let height_m = loaded.scene.plants.height_m;
    let ground = |axis: usize| {
        let center_m = |tile: usize| (tile as f32 + 0.5) * 8.0 * cell_m;
        let tiles = (0..along / 8).flat_map(|j| (0..across / 8).map(move |i| [i, j]));
        tiles.map(|[i, j]| field.wind_at([center_m(i), height_m, center_m(j)])[axis]).collect()
    };
    let grass =
        |part: &dyn Fn([usize; 2]) -> f32| (0..along).flat_map(|j| (0..across).map(move |i| [i, j])).map(part).collect::<Vec<f32>>();
    let lean = |[i, j]: [usize; 2]| world.bend().lean_rad([i, j].map(|n| (n as f32 + 0.5) * cell_m), field);
    match variable {
        "u" => air(0),
        "v" => air(1),
        "w" => air(2),
        "ground_u" => ground(0),
        "ground_w" => ground(2),
        "theta" => grass(&|cell| bend(world, cell).theta),
        "omega_x" => grass(&|cell| bend(world, cell).omega[0]),
        "omega_z" => grass(&|cell| bend(world, cell).omega[1]),
        "lean_x" => grass(&|cell| lean(cell)[0]),
        "lean_z" => grass(&|cell| lean(cell)[1]),
        other => panic!("{other}"),
    }
}

/// Bend field and flattened grass of a cell.
fn bend(world: &World, cell: [usize; 2]) -> Bend {
    let cell = cell.map(|n| n as i64);
    let (patch, [column, row]) = world.bend().field().locate(cell).unwrap();
    let in_field = world.bend().field().cell(cell);
    let flattened_rad = world.bend().flattened().lean_rad(patch, column, row);
    if flattened_rad == [0.0; 2] { in_field } else { published(in_field, flattened_rad) }
}

/// Values as bytes, which tell −0 from 0.
fn bytes(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// Output of the program.
fn prairie(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_prairie")).args(arguments).current_dir(folder).env_remove("RUST_LOG").output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn the_sampler_has_the_values_of_the_world() {
    use prairie::output::Field;
    let loaded = scene();
    let fields: Vec<_> = Field::ALL.into_iter().filter(|field| *field != Field::Dust).collect();
    let sampler = Sampler::new(&loaded, &fields).unwrap();
    let world = ran(DRIVE, 120, 120, Outputs::default());
    let frame = sampler.sample(&world);
    assert_eq!((frame.tick, frame.time_secs.to_bits()), (120, (120.0 * f64::from(loaded.scene.dt_secs())).to_bits()));
    for (variable, found) in sampler.variables().zip(&frame.values) {
        assert!(bytes(found) == bytes(&values(&world, &loaded, variable.name)), "{}", variable.name);
        assert!(found.iter().any(|value| *value != 0.0), "{} is not zero everywhere", variable.name);
    }
    let rest = Bend::default();
    let bent = frame.values[sampler.variables().position(|variable| variable.name == "theta").unwrap()]
        .iter()
        .filter(|theta| **theta != rest.theta);
    assert!(bent.count() > 1000, "the car has left a track");
    assert!(world.bend().flattened().tiles() > 0, "some of it stays");
}

#[test]
fn dust_is_that_of_the_solver() {
    use prairie::output::Field;
    let loaded = scenes::load("devil").unwrap();
    let world = World::new(&loaded.scene, loaded.maps()).unwrap();
    let frame = Sampler::new(&loaded, &[Field::Dust]).unwrap().sample(&world);
    let dust = world.weather().dust().unwrap();
    let [nx, ny, nz] = loaded.scene.wind.cells.map(|n| n as usize);
    let at = |[i, j, k]: [usize; 3]| (frame.values[0][i + nx * (k + nz * j)], dust[i + nx * (j + ny * k)]);
    for cell in [[0, 0, 0], [3, 1, 2], [nx - 1, ny - 1, nz - 1], [nx / 2, 0, nz / 2]] {
        let (found, expected) = at(cell);
        assert_eq!(found.to_bits(), expected.to_bits(), "{cell:?}");
    }
    assert!(dust.iter().any(|density| *density > 0.0));
    assert!(matches!(Sampler::new(&scene(), &[Field::Dust]), Err(OutputError::NoDust)));
    let large = scenes::load("continuum").unwrap();
    let refused = Sampler::new(&large, &[Field::Bend]).err().unwrap().to_string();
    assert!(refused.contains("`bend` has 111513600 values") && refused.contains("allowed: at most 67108864"), "{refused}");
}
