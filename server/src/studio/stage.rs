//! A world and a client's mirror of it in one process, without sockets or clocks.

use crate::journal::Player;
use crate::scenes::{self, LoadedScene};
use crate::snapshot::{PatchCodes, PatchQuantiser};
use crate::world::{Camera, Command, World};
use anyhow::Result;
use prairie_client::state::Mirror;
use prairie_core::scene::{Scene, VehicleKind};
use prairie_core::terrain::HeightMap;
use prairie_core::wire::{self, Drive, ObjectPose, SERVER_MESSAGE_LIMIT, ServerMessage, Shape, codec};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// A world stepped by the caller, and a client mirror that receives its snapshots as encoded messages.
pub struct Stage {
    /// The world.
    pub world: World,
    /// A client's copy of the state.
    pub mirror: Mirror,
    scene: Scene,
    height: HeightMap,
    quantiser: PatchQuantiser,
    sent: BTreeMap<u32, (u32, Arc<PatchCodes>)>,
    sent_broken: usize,
    frame: u32,
    /// Commands by step, of a recording that is played.
    recorded: BTreeMap<u64, Vec<Command>>,
}

impl Stage {
    /// Loads a built-in scene by name, or a scene file, at its start.
    ///
    /// # Errors
    /// When the scene is invalid.
    pub fn load(name_or_path: &str) -> Result<Self> {
        Self::changed(name_or_path, |_| {})
    }

    /// Loads a scene and changes it before the world is made.
    ///
    /// # Errors
    /// When the scene is invalid.
    pub fn changed(name_or_path: &str, change: impl FnOnce(&mut Scene)) -> Result<Self> {
        let mut loaded = scenes::load(name_or_path)?;
        change(&mut loaded.scene);
        Self::new(&loaded)
    }

    /// The world of a loaded scene at its start.
    ///
    /// # Errors
    /// When the scene is invalid.
    pub fn new(loaded: &LoadedScene) -> Result<Self> {
        Self::of(loaded, World::new(&loaded.scene, loaded.maps())?, BTreeMap::new())
    }

    /// Plays a recording of a world of this scene, step by step; after its end nobody drives.
    ///
    /// # Errors
    /// When the mirror rejects the scene.
    pub fn replaying(loaded: &LoadedScene, player: Player) -> Result<Self> {
        Self::of(loaded, player.world, player.recording.commands)
    }

    fn of(loaded: &LoadedScene, world: World, recorded: BTreeMap<u64, Vec<Command>>) -> Result<Self> {
        let mut stage = Self {
            world,
            recorded,
            mirror: Mirror::default(),
            scene: loaded.scene.clone(),
            height: loaded.height.clone(),
            quantiser: PatchQuantiser::default(),
            sent: BTreeMap::new(),
            sent_broken: 0,
            frame: 0,
        };
        stage.send(&loaded.message())?;
        Ok(stage)
    }

    /// Sends a message to the mirror, encoded and decoded as on the wire.
    fn send(&mut self, message: &ServerMessage) -> Result<()> {
        self.mirror.apply(wire::decode(&wire::encode(message), SERVER_MESSAGE_LIMIT)?)?;
        Ok(())
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Height of the terrain (m).
    pub fn ground_m(&self, x_m: f32, z_m: f32) -> f32 {
        self.height.height_m(x_m, z_m)
    }

    /// Sets the camera of client 1; its vehicle will appear there.
    pub fn look_from(&mut self, eye_m: [f32; 3]) {
        self.command(&[Command::Cameras(vec![Camera { client: 1, eye_m }])]);
    }

    /// Spawns a vehicle for `client` near its camera.
    pub fn spawn(&mut self, client: u32, kind: VehicleKind) {
        self.command(&[Command::Spawn { client, kind }]);
    }

    /// Sets the controls of `client`'s vehicle.
    pub fn drive(&mut self, client: u32, drive: Drive) {
        self.command(&[Command::Drive { client, number: 0, drive }]);
    }

    /// Removes all objects from the mirror until the next [`show`](Self::show).
    ///
    /// # Errors
    /// When the mirror rejects the message.
    pub fn show_bare(&mut self) -> Result<()> {
        // Poses of an earlier tick replace all that were sent before.
        self.send(&ServerMessage::Poses { tick: 0, objects: Vec::new() })
    }

    fn command(&mut self, commands: &[Command]) {
        self.world.step(commands);
    }

    /// Runs the world for `secs` of simulated time.
    pub fn run(&mut self, secs: f32) {
        self.run_ticks((secs * self.scene.tick_hz).round() as u32);
    }

    /// Runs the world for a number of ticks.
    pub fn run_ticks(&mut self, ticks: u32) {
        for _ in 0..ticks {
            let next = self.world.tick() + 1;
            self.world.step(self.recorded.get(&next).map_or(&[], Vec::as_slice));
        }
    }

    /// Sends the newest state to the mirror; returns the poses of the objects.
    ///
    /// # Errors
    /// When the mirror rejects a message.
    pub fn show(&mut self) -> Result<Vec<ObjectPose>> {
        let snapshot = self.world.publish(&mut self.quantiser);
        self.send(&ServerMessage::Poses { tick: snapshot.tick, objects: snapshot.objects.clone() })?;
        self.frame += 1;
        let wind = &snapshot.wind;
        let payload = codec::encode(Shape::wind(wind.cells[0] as usize, wind.has_dust()), &wind.codes, None);
        let (tick, turbulence) = (wind.tick, wind.turbulence);
        self.send(&ServerMessage::Wind { tick, seq: self.frame, key: true, turbulence, payload })?;
        let shown: BTreeSet<u32> = self.sent.keys().chain(snapshot.patches.keys()).copied().collect();
        for patch in shown {
            self.show_patch(patch, snapshot.patches.get(&patch))?;
        }
        while self.sent_broken < snapshot.broken.len() {
            let plants = snapshot.broken.after(self.sent_broken).to_vec();
            self.sent_broken += plants.len();
            self.send(&ServerMessage::Broken { plants })?;
        }
        self.send(&ServerMessage::FrameEnd { frame: self.frame, tick: snapshot.tick, time_secs: snapshot.time_secs })?;
        self.mirror.show_newest();
        Ok(snapshot.objects)
    }

    fn show_patch(&mut self, patch: u32, codes: Option<&Arc<PatchCodes>>) -> Result<()> {
        let seq = match self.sent.get(&patch) {
            Some((_, sent)) if codes.is_some_and(|codes| Arc::ptr_eq(codes, sent)) => return Ok(()),
            Some((seq, _)) => seq + 1,
            None if codes.is_none() => return Ok(()),
            None => 1,
        };
        let payload = codes.map_or_else(Vec::new, |codes| codec::encode(Shape::patch_of(&self.scene), &codes.codes, None));
        self.send(&ServerMessage::Patch { patch, seq, key: true, payload })?;
        match codes {
            Some(codes) => self.sent.insert(patch, (seq, Arc::clone(codes))),
            None => self.sent.remove(&patch),
        };
        Ok(())
    }
}
