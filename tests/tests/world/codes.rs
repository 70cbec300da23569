//! Codes of wind and grass: a client without a replica has every cell of what it watches within the errors that the scene sets.

use super::replica::{Server, Viewer, commands};
use anyhow::{Context as _, Result, ensure};
use prairie::scenes;
use prairie::stream::patches_near;
use prairie::world::World;
use prairie_core::bend::Bend;
use prairie_core::grid::PatchLayout;
use prairie_core::random::SplitMix64;
use prairie_core::scene::Stream;
use prairie_core::wire::quantise::CodeSteps;

const VIEW_RADIUS_M: f32 = 60.0;
/// Rounding of single precision, relative.
const ROUNDING: f32 = 1.0 + 1e-4;

/// Largest errors found, each as a fraction of its bound, and the number of bent cells compared.
#[derive(Debug, Default)]
struct Errors {
    theta: f32,
    omega: f32,
    flattened: f32,
    cells: u64,
}

impl Errors {
    /// Notes the errors of a cell.
    fn note(&mut self, found: Bend, field: Bend, flattened_rad: [f32; 2], steps: &CodeSteps) {
        let half_step = 0.5 * steps.theta_rad;
        self.cells += u64::from(found != Bend::default());
        if flattened_rad == [0.0; 2] {
            self.theta = self.theta.max((found.theta - field.theta).abs() / half_step);
            for (found, omega) in found.omega.into_iter().zip(field.omega) {
                let bound = steps.omega_root * omega.abs().sqrt() + 0.25 * steps.omega_root * steps.omega_root;
                self.omega = self.omega.max((found - omega).abs() / bound);
            }
        } else {
            let lean = field.lean_rad();
            let theta = (lean[0] + flattened_rad[0]).hypot(lean[1] + flattened_rad[1]);
            // Flattened grass recovers by up to another half step before its codes are renewed.
            self.flattened = self.flattened.max((found.theta - theta).abs() / (2.0 * half_step));
        }
    }

    /// Compares all patches near the camera.
    fn compare(&mut self, viewer: &Viewer, world: &World, layout: &PatchLayout, eye_m: [f32; 3], steps: &CodeSteps) {
        let side = layout.cells as usize;
        for index in patches_near(layout, [eye_m[0], eye_m[2]], VIEW_RADIUS_M) {
            let codes = viewer.mirror.patch(index);
            let patch = world.bend().field().patch(index);
            let mut flattened = vec![[0.0; 2]; side * side];
            world.bend().flattened().cells(index).for_each(|([i, j], lean_rad)| flattened[j * side + i] = lean_rad);
            for (cell, flattened_rad) in flattened.into_iter().enumerate() {
                let found = codes.map(|codes| Bend::of_codes(codes.planes().map(|plane| plane[cell]), steps)).unwrap_or_default();
                let field = patch.map(|patch| patch.bend(cell % side, cell / side)).unwrap_or_default();
                self.note(found, field, flattened_rad, steps);
            }
        }
    }
}

/// Drives four vehicles at random for `secs` before a viewer who gets patches, in a scene with these errors.
fn drive(scene: &str, stream: Stream, secs: f32) -> Result<Errors> {
    let mut loaded = scenes::load(scene)?;
    loaded.scene.stream = stream;
    let (tick_hz, [extent_x, extent_z]) = (loaded.scene.tick_hz, loaded.scene.extent_m());
    let (layout, steps) = (PatchLayout::from(&loaded.scene.patches), CodeSteps::from(&stream));
    let eye_m = [0.5 * extent_x, 30.0, 0.5 * extent_z];
    let mut server = Server::new(World::new(&loaded.scene, loaded.maps())?, &loaded);
    let mut viewer = server.join(&loaded, eye_m)?;
    viewer.client.request_replica(false);
    let (mut random, mut queue, mut errors) = (SplitMix64::new(11), vec![], Errors::default());
    for publication in 0..(secs * tick_hz / 3.0) as u64 {
        commands(&mut random, publication, &mut queue);
        server.publish(&mut queue, tick_hz);
        viewer.receive()?;
        ensure!(viewer.mirror.replica().is_none(), "patches, not a replica");
        // The first frames bring what lay flattened before, as far as the budget allows.
        if publication > 20 && viewer.mirror.tick() == server.world.tick() {
            errors.compare(&viewer, &server.world, &layout, eye_m, &steps);
        }
    }
    println!("{scene}, {stream:?}: {errors:?}");
    Ok(errors)
}

/// `PRAIRIE_CODES_SECS=3600` drives for an hour of simulated time.
#[test]
fn codes_are_within_the_errors_that_the_scene_sets() -> Result<()> {
    let secs = std::env::var("PRAIRIE_CODES_SECS").map_or(Ok(60.0), |secs| secs.parse()).context("PRAIRIE_CODES_SECS")?;
    let fine = Stream { theta_error_deg: 0.1, omega_error_rad_per_s: 0.02, ..Stream::default() };
    for (scene, stream, secs) in
        [("meadow", Stream::default(), secs), ("storm", Stream::default(), 0.5 * secs), ("meadow", fine, 0.25 * secs)]
    {
        let Errors { theta, omega, flattened, cells } = drive(scene, stream, secs)?;
        ensure!(cells > 100_000, "{scene}: only {cells} bent cells");
        let largest = theta.max(omega).max(flattened);
        ensure!(largest <= ROUNDING, "{scene}: θ, ω and flattened grass are off by {theta}, {omega} and {flattened} times what is allowed");
        ensure!(theta > 0.95 && omega > 0.95, "{scene}: the bounds are reached, so that half of each would not hold: {theta}, {omega}");
    }
    Ok(())
}
