//! Cost of checkpoints: `cargo run --release -p prairie --example checkpoints [SCENE…]`
//!
//! For each scene, during ten seconds of driving five vehicles, then 64: the copy of the state into the memory of the one before, which is the only part
//! within a step (mean, 99 % and longest); its sizes as bytes and as a compressed checkpoint; the time to make one beside the simulation,
//! and to restore the world from it.

use prairie::journal::{open_checkpoint, seal_checkpoint};
use prairie::scenes;
use prairie::world::{Camera, Command, World};
use prairie_core::scene::VehicleKind;
use prairie_core::wire::Drive;
use std::time::Instant;

const VEHICLES: [u32; 2] = [5, 64];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut names: Vec<String> = std::env::args().skip(1).collect();
    if names.is_empty() {
        names = ["meadow", "storm", "continuum", "devil", "underbrush"].map(str::to_owned).to_vec();
    }
    println!("scene       cars  step ms  copy ms     99 %  longest  state MB  file MB  seal s  restore s  awake patches");
    for name in names {
        for vehicles in VEHICLES {
            measure(&name, vehicles)?;
        }
    }
    Ok(())
}

fn measure(name: &str, vehicles: u32) -> Result<(), Box<dyn std::error::Error>> {
    let scene = scenes::load(name)?;
    let mut world = World::new(&scene.scene, scene.maps())?;
    let [x, z] = scene.scene.extent_m().map(|m| 0.5 * m);
    let spawn = |client: u32| Command::Spawn { client, kind: VehicleKind::ALL[client as usize % VehicleKind::ALL.len()] };
    let mut commands = vec![Command::Cameras(vec![Camera { client: 1, eye_m: [x, 2.0, z] }])];
    commands.extend((1..=vehicles).map(spawn));
    let (mut step_secs, mut copies_secs, mut state, steps) = (0.0, vec![], world.save(), 600_u32);
    for tick in 0..steps {
        let begun = Instant::now();
        world.step(&commands);
        step_secs += begun.elapsed().as_secs_f64();
        let begun = Instant::now();
        world.save_into(&mut state);
        copies_secs.push(begun.elapsed().as_secs_f64());
        let steer = (tick as f32 * 0.01).sin();
        commands = (1..=vehicles)
            .map(|client| Command::Drive { client, number: 0, drive: Drive { throttle: 1.0, steer, ..Drive::default() } })
            .collect();
    }
    copies_secs.sort_by(f64::total_cmp);
    let copy_ms = |share: f64| 1e3 * copies_secs[(share * f64::from(steps - 1)) as usize];
    let bytes = state.encode().len();
    let begun = Instant::now();
    let sealed = seal_checkpoint(&state);
    let seal_secs = begun.elapsed().as_secs_f64();
    let begun = Instant::now();
    let restored = World::restore(&scene.scene, scene.maps(), open_checkpoint(&sealed)?)?;
    let restore_secs = begun.elapsed().as_secs_f64();
    assert_eq!(restored.checksum(), world.checksum());
    let (mean_ms, mb) = (|secs: f64| secs * 1e3 / f64::from(steps), |bytes: usize| bytes as f64 / 1e6);
    println!(
        "{name:<10} {vehicles:5} {:8.2} {:8.3} {:8.3} {:8.3} {:9.2} {:8.2} {seal_secs:7.3} {restore_secs:10.3} {:14}",
        mean_ms(step_secs),
        mean_ms(copies_secs.iter().sum()),
        copy_ms(0.99),
        copy_ms(1.0),
        mb(bytes),
        mb(sealed.len()),
        world.bend().field().awake_count()
    );
    Ok(())
}
