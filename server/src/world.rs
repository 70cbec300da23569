//! Stand-in.
#![allow(missing_docs)]
use crate::runner::Simulation;
use crate::snapshot::Snapshot;
use shared::scene::{Scene, VehicleKind};
use shared::wire::{Drive, ObjectId};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    pub client: u32,
    pub eye_m: [f32; 3],
    pub radius_m: f32,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    Spawn { client: u32, kind: VehicleKind },
    Remove { client: u32 },
    Drive { client: u32, drive: Drive },
    Views(Vec<View>),
}

#[derive(Debug)]
pub struct World;
impl World {
    pub fn new(_: &Scene) -> Self {
        Self
    }
}
impl Simulation for World {
    fn step(&mut self, _: &[Command]) {}
    fn snapshot(&mut self) -> Snapshot {
        Snapshot::default()
    }
    fn object_of(&self, _: u32) -> Option<ObjectId> {
        None
    }
}
