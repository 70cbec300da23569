//! Drivers that send the inputs of a file, as the commands of clients.

use super::drive_file::Driver;
use crate::objects::center_for;
use crate::world::{Camera, Command, World};
use prairie_core::scene::VehicleKind;
use prairie_core::wire::Drive;
use thiserror::Error;

/// Distance from its place at which the appearance of a vehicle is reported (m).
const ASIDE_M: f32 = 0.5;

/// All drivers of a run. Their commands depend on the steps alone, so that the same drivers always give the same world.
#[derive(Clone, Debug)]
pub struct Drivers {
    drivers: Vec<Scripted>,
    ticks_per_camera: u64,
}

/// A driver with the steps of what it does.
#[derive(Clone, Debug)]
struct Scripted {
    client: u32,
    vehicle: VehicleKind,
    at_m: [f32; 2],
    from_tick: u64,
    /// Inputs with their steps, the next one last.
    inputs: Vec<(u64, Drive)>,
    /// Number of the newest input.
    number: u32,
}

/// A vehicle that the world has refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("the {} of driver {number} finds no free place near {at_m:?} m, or the scene's `objects.limit` is reached", .vehicle.name())]
pub struct Refused {
    /// Number of the driver in its file, from 1.
    number: u32,
    vehicle: VehicleKind,
    at_m: [f32; 2],
}

impl Drivers {
    /// The drivers in a world with `tick_hz` steps a second. What they do at a time belongs to the first step that does not begin before.
    pub fn new(drivers: &[Driver], tick_hz: f32) -> Self {
        let tick = |secs: f64| (secs * f64::from(tick_hz) - 1e-6).ceil().max(0.0) as u64;
        let scripted = |(number, driver): (usize, &Driver)| Scripted {
            client: number as u32 + 1,
            vehicle: driver.vehicle,
            at_m: driver.at_m,
            from_tick: tick(driver.from_secs),
            inputs: driver.inputs.iter().rev().map(|(secs, drive)| (tick(*secs), *drive)).collect(),
            number: 0,
        };
        Self { drivers: drivers.iter().enumerate().map(scripted).collect(), ticks_per_camera: (tick_hz.round() as u64).max(1) }
    }

    /// Commands for the next step of a world. Cameras follow the vehicles once a second, and stand where vehicles appear.
    pub fn commands(&mut self, world: &World) -> Vec<Command> {
        let tick = world.tick();
        let arriving = self.drivers.iter().filter(|driver| driver.from_tick == tick);
        let mut commands: Vec<_> = arriving.map(|driver| Command::Join { client: driver.client }).collect();
        let is_camera_due = tick.is_multiple_of(self.ticks_per_camera) || !commands.is_empty();
        if is_camera_due && !self.drivers.is_empty() {
            commands.push(Command::Cameras(self.cameras(world)));
        }
        for driver in &mut self.drivers {
            if driver.from_tick == tick {
                commands.push(Command::Spawn { client: driver.client, kind: driver.vehicle });
            }
            while let Some((_, drive)) = driver.inputs.pop_if(|(from_tick, _)| *from_tick <= tick) {
                driver.number += 1;
                commands.push(Command::Drive { client: driver.client, number: driver.number, drive });
            }
        }
        commands
    }

    /// Cameras at the vehicles, or where these appear in the next step.
    fn cameras(&self, world: &World) -> Vec<Camera> {
        let poses = world.poses();
        let camera = |driver: &Scripted| {
            let [x, z] = center_for(driver.at_m);
            let object = world.object_of(driver.client);
            let pose = object.and_then(|object| poses.iter().find(|pose| pose.id == object));
            let eye_m = pose.map_or([x, 0.0, z], |pose| pose.position_m);
            (driver.from_tick <= world.tick()).then_some(Camera { client: driver.client, eye_m })
        };
        self.drivers.iter().filter_map(camera).collect()
    }

    /// Checks that the vehicles of the newest step have appeared, and reports those that are not at their place.
    ///
    /// # Errors
    /// When the world has refused one.
    pub fn check_arrivals(&self, world: &World) -> Result<(), Refused> {
        for driver in self.drivers.iter().filter(|driver| driver.from_tick + 1 == world.tick()) {
            let (number, vehicle, at_m) = (driver.client, driver.vehicle, driver.at_m);
            let object = world.object_of(driver.client).ok_or(Refused { number, vehicle, at_m })?;
            let Some(pose) = world.poses().into_iter().find(|pose| pose.id == object) else { continue };
            let [x, _, z] = pose.position_m;
            if (x - at_m[0]).hypot(z - at_m[1]) > ASIDE_M {
                tracing::warn!(driver = number, x_m = x, z_m = z, "the place of a vehicle is taken; it appears at another");
            }
        }
        Ok(())
    }
}
