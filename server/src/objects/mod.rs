//! Cars, monsters, helicopters, sleds and balls: bodies, driving, and where they may be.
//!
//! Bodies are rapier's, on one thread and in the order of their numbers, so that the same commands give the same bits.

mod ball;
mod car;
mod circling;
mod ground;
mod helicopter;
pub mod model;
mod monster;
mod motion;
mod place;
mod sled;
mod spawn;

pub use motion::{Motion, MotionError, Stand};
pub use place::Place;

use ball::Ball;
use car::Car;
use circling::Circling;
use ground::Ground;
use helicopter::Helicopter;
use monster::Monster;
use rapier3d::prelude::*;
use shared::scene::{self, Scene, VehicleKind};
use shared::wire::{Drive, ObjectId, ObjectPose};
use sled::Sled;
use spawn::Disc;

/// Fastest that any object moves (m/s); a body thrown faster is slowed to it.
pub const SPEED_LIMIT_M_PER_S: f32 = 90.0;
/// Gap between the boxes of a new object and the ground (m).
const DROP_M: f32 = 0.05;
/// Height above the land at which a helicopter that drives itself flies (m), and how hard it seeks it (1/m).
const CRUISE_M: f32 = 6.0;
const CRUISE_PER_M: f32 = 0.3;
/// Distance from one of the scene's balls to the next, about (m).
const BALLS_APART_M: f32 = 6.0;

/// Everything that moves by itself.
pub struct Objects {
    place: Place,
    ground: Ground,
    physics: PhysicsWorld,
    vehicles: Vec<Vehicle>,
    settings: scene::Objects,
    next_id: ObjectId,
}

struct Vehicle {
    id: ObjectId,
    kind: VehicleKind,
    half_extents_m: [f32; 3],
    driver: Driver,
    body: RigidBodyHandle,
    controls: Controls,
    stood: Stand,
}

enum Driver {
    Client { client: u32, drive: Drive },
    Circling(Circling),
    Nobody,
}

enum Controls {
    Car(Car),
    Monster(Monster),
    Helicopter(Helicopter),
    Sled(Sled),
    Ball(Ball),
}

impl Objects {
    /// The scene's own vehicles and balls in their places; nothing else yet.
    pub fn new(scene: &Scene, place: Place) -> Self {
        let ground = Ground::new(&place, &scene.plants);
        let mut physics = PhysicsWorld::new();
        physics.integration_parameters.dt = scene.dt_secs();
        let mut objects = Self { place, ground, physics, vehicles: vec![], settings: scene.objects.clone(), next_id: 1 };
        let middle = objects.place.extent_m.map(|extent| 0.5 * extent);
        let shared::scene::Objects { self_driving, self_driving_m_per_s, self_driving_apart_m, self_driving_kind, balls, .. } =
            scene.objects;
        for n in 0..self_driving {
            objects.add(self_driving_kind, Driver::Circling(Circling::new(n, self_driving_m_per_s)), middle, self_driving_apart_m);
        }
        let [east, south] = scene.camera.at;
        let start = [objects.place.extent_m[0] * east, objects.place.extent_m[1] * south];
        for _ in 0..balls {
            objects.add(VehicleKind::Ball, Driver::Nobody, start, BALLS_APART_M);
        }
        objects
    }

    /// Gives `client` a vehicle near `middle_m`; the one driven before goes. None when the limit is reached or nowhere is free.
    pub fn spawn(&mut self, client: u32, kind: VehicleKind, middle_m: [f32; 2]) -> Option<ObjectId> {
        self.remove(client);
        self.add(kind, Driver::Client { client, drive: Drive::default() }, middle_m, spawn::NEAR_M)
    }

    /// Takes the vehicle of `client` out of the world.
    pub fn remove(&mut self, client: u32) {
        if let Some(slot) = self.slot_of(client) {
            let vehicle = self.vehicles.remove(slot);
            self.physics.remove_body(vehicle.body);
        }
    }

    /// Puts hands on the controls of the vehicle of `client`; held until the next call. What is no valid [`Drive`] is ignored.
    pub fn drive(&mut self, client: u32, hands: Drive) {
        if let Some(slot) = self.slot_of(client)
            && let Driver::Client { drive, .. } = &mut self.vehicles[slot].driver
            && hands.is_valid()
        {
            *drive = hands;
        }
    }

    /// Most vehicles at once.
    pub fn limit(&self) -> u32 {
        self.settings.limit
    }

    /// The vehicle of `client`.
    pub fn object_of(&self, client: u32) -> Option<ObjectId> {
        self.slot_of(client).map(|slot| self.vehicles[slot].id)
    }

    /// Moves everything by `dt_secs` in a wind (m/s) that is told by the place (m).
    pub fn step(&mut self, dt_secs: f32, wind_m_per_s: impl Fn([f32; 3]) -> [f32; 3]) {
        if self.is_empty() && self.ground.is_empty() {
            return;
        }
        let at: Vec<_> = self.vehicles.iter().map(|vehicle| stand(&self.physics.bodies[vehicle.body]).xz()).collect();
        self.ground.follow(&at, &mut self.physics);
        for vehicle in &mut self.vehicles {
            vehicle.stood = stand(&self.physics.bodies[vehicle.body]);
            let drive = vehicle.hands(dt_secs, &self.physics, &self.ground);
            match &mut vehicle.controls {
                Controls::Car(car) => car.control(drive, dt_secs, &mut self.physics),
                Controls::Monster(monster) => monster.control(drive, dt_secs, &mut self.physics, &self.ground),
                Controls::Helicopter(helicopter) => helicopter.control(drive, dt_secs, &mut self.physics, &self.ground),
                Controls::Sled(sled) => sled.control(drive, dt_secs, &mut self.physics, &self.ground),
                Controls::Ball(ball) => {
                    let wind_m_per_s = wind_m_per_s(vehicle.stood.position_m);
                    ball.control(drive, wind_m_per_s, dt_secs, &mut self.physics, &self.ground);
                }
            }
        }
        self.physics.step();
        for vehicle in &self.vehicles {
            confine(vehicle, &mut self.physics.bodies[vehicle.body], &self.place, &self.ground);
        }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.vehicles.is_empty()
    }

    /// Where everything is, ascending by number.
    pub fn poses(&self) -> Vec<ObjectPose> {
        let pose = |vehicle: &Vehicle| {
            let body = &self.physics.bodies[vehicle.body];
            let Stand { position_m, rotation } = stand(body);
            let velocity_m_per_s = body.linvel().to_array();
            let part_rad = match &vehicle.controls {
                Controls::Car(car) => car.steering_rad(),
                Controls::Monster(monster) => monster.phase_rad(),
                Controls::Helicopter(helicopter) => helicopter.rotor_rad(),
                Controls::Sled(_) => 0.0,
                Controls::Ball(ball) => ball.heading_rad(),
            };
            ObjectPose { id: vehicle.id, kind: vehicle.kind, position_m, rotation, velocity_m_per_s, part_rad }
        };
        self.vehicles.iter().map(pose).collect()
    }

    /// What everything did in the newest step.
    pub fn motions(&self) -> Vec<Motion> {
        let motion = |vehicle: &Vehicle| {
            let body = &self.physics.bodies[vehicle.body];
            Motion {
                kind: vehicle.kind,
                from: vehicle.stood,
                to: stand(body),
                velocity_m_per_s: body.linvel().to_array(),
                rests: body.is_sleeping(),
            }
        };
        self.vehicles.iter().map(motion).collect()
    }

    fn slot_of(&self, client: u32) -> Option<usize> {
        self.vehicles.iter().position(|vehicle| matches!(vehicle.driver, Driver::Client { client: other, .. } if other == client))
    }

    fn add(&mut self, kind: VehicleKind, driver: Driver, middle_m: [f32; 2], apart_m: f32) -> Option<ObjectId> {
        if self.vehicles.len() >= self.settings.limit as usize {
            return None;
        }
        let taken: Vec<_> = self
            .vehicles
            .iter()
            .map(|other| Disc { at_m: stand(&self.physics.bodies[other.body]).xz(), radius_m: radius_m(other.half_extents_m) })
            .collect();
        let half_extents_m = self.settings.half_extents_m(kind);
        let at_m = spawn::find(middle_m, apart_m, radius_m(half_extents_m), &taken, &self.ground, &self.place)?;
        let heading_rad = (at_m[0] - middle_m[0]).atan2(middle_m[1] - at_m[1]);
        let (body, collider) = match kind {
            VehicleKind::Car => car::body(),
            VehicleKind::Monster => monster::body(),
            VehicleKind::Helicopter => helicopter::body(),
            VehicleKind::Sled => sled::body(&self.settings),
            VehicleKind::Ball => ball::body(half_extents_m[0]),
        };
        let center = Vector::new(at_m[0], self.highest_under(at_m, kind, half_extents_m) + half_extents_m[1] + DROP_M, at_m[1]);
        let body = body.pose(Pose::from_parts(center, Rotation::from_rotation_y(-heading_rad)));
        let (body, _) = self.physics.insert(body, collider);
        if kind == VehicleKind::Car {
            self.physics.insert_collider(car::skirt(), Some(body));
        }
        let controls = match kind {
            VehicleKind::Car => Controls::Car(Car::new(body)),
            VehicleKind::Monster => Controls::Monster(Monster::new(body, heading_rad)),
            VehicleKind::Helicopter => Controls::Helicopter(Helicopter::new(body)),
            VehicleKind::Sled => Controls::Sled(Sled::new(body, half_extents_m[1], heading_rad)),
            VehicleKind::Ball => Controls::Ball(Ball::new(body, half_extents_m[0], heading_rad)),
        };
        let id = self.next_id;
        self.next_id += 1;
        let stood = stand(&self.physics.bodies[body]);
        self.vehicles.push(Vehicle { id, kind, half_extents_m, driver, body, controls, stood });
        Some(id)
    }

    /// Height of the land under the box of an object (m), wherever it is highest.
    fn highest_under(&self, [x, z]: [f32; 2], kind: VehicleKind, half_extents_m: [f32; 3]) -> f32 {
        let reach = match kind {
            // Their floors follow the land below their middle.
            VehicleKind::Monster | VehicleKind::Sled => 0.0,
            _ => 0.7 * radius_m(half_extents_m),
        };
        let around = [[x, z], [x - reach, z - reach], [x + reach, z - reach], [x - reach, z + reach], [x + reach, z + reach]];
        around.into_iter().map(|at| self.ground.height_m(at)).fold(f32::NEG_INFINITY, f32::max)
    }
}

impl Vehicle {
    fn hands(&mut self, dt_secs: f32, physics: &PhysicsWorld, ground: &Ground) -> Drive {
        let body = &physics.bodies[self.body];
        match &mut self.driver {
            Driver::Client { drive, .. } => *drive,
            Driver::Nobody => Drive::default(),
            Driver::Circling(circling) => {
                let at = body.translation();
                let below_cruise_m = CRUISE_M - (at.y - ground.height_m([at.x, at.z]));
                let lift = (CRUISE_PER_M * below_cruise_m).clamp(-1.0, 1.0);
                Drive { lift, ..circling.hands(body.linvel().length(), dt_secs) }
            }
        }
    }
}

/// Radius of the circle around a box, seen from above (m).
fn radius_m([x, _, z]: [f32; 3]) -> f32 {
    x.hypot(z)
}

fn stand(body: &RigidBody) -> Stand {
    Stand { position_m: body.translation().to_array(), rotation: body.rotation().to_array() }
}

/// Keeps a body within the world's edge and above its land, no faster than [`SPEED_LIMIT_M_PER_S`]. What is no longer a number
/// goes back to where it stood.
fn confine(vehicle: &Vehicle, body: &mut RigidBody, place: &Place, ground: &Ground) {
    let (at, velocity) = (body.translation(), body.linvel());
    if !(at.is_finite() && velocity.is_finite() && body.rotation().is_finite() && body.angvel().is_finite()) {
        body.set_enabled(true);
        body.set_translation(Vector::from_array(vehicle.stood.position_m), true);
        body.set_rotation(Rotation::from_array(vehicle.stood.rotation), true);
        body.set_linvel(Vector::ZERO, true);
        body.set_angvel(Vector::ZERO, true);
        return;
    }
    let (mut inside, mut slowed) = (at, velocity.clamp_length_max(SPEED_LIMIT_M_PER_S));
    for (axis, [low, high]) in [0, 2].into_iter().zip(place.bounds_m()) {
        inside[axis] = at[axis].clamp(low, high);
        if inside[axis] != at[axis] {
            slowed[axis] = 0.0;
        }
    }
    let land_m = ground.height_m([inside.x, inside.z]);
    if inside.y < land_m {
        inside.y = land_m + vehicle.half_extents_m[1];
        slowed.y = slowed.y.max(0.0);
    }
    if inside != at {
        body.set_translation(inside, true);
    }
    if slowed != velocity {
        body.set_linvel(slowed, true);
    }
}
