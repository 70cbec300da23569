//! A world and a client's mirror of it in one process: what a browser would be shown, without sockets or clocks.

use anyhow::{Context as _, Result};
use client_wasm::state::Mirror;
use server::scenes;
use server::snapshot::PatchCodes;
use server::world::{Command, View, World};
use shared::scene::{Scene, VehicleKind};
use shared::terrain::HeightMap;
use shared::wire::{self, Drive, ObjectPose, SERVER_MESSAGE_LIMIT, ServerMessage, Shape, codec};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// A world, stepped by hand, and the mirror that its snapshots are brought to as the bytes of messages.
pub struct Stage {
    /// The world.
    pub world: World,
    /// What a client knows of it.
    pub mirror: Mirror,
    scene: Scene,
    height: HeightMap,
    sent: BTreeMap<u32, (u32, Arc<PatchCodes>)>,
    told_broken: usize,
    frame: u32,
    time_secs: f64,
}

impl Stage {
    /// The scene with this name, or in this file, at its start.
    ///
    /// # Errors
    /// When the scene is faulty.
    pub fn load(name_or_path: &str) -> Result<Self> {
        Self::changed(name_or_path, |_| {})
    }

    /// The same after a change of it.
    ///
    /// # Errors
    /// When the scene is faulty.
    pub fn changed(name_or_path: &str, change: impl FnOnce(&mut Scene)) -> Result<Self> {
        let mut loaded = scenes::load(name_or_path)?;
        change(&mut loaded.scene);
        let mut stage = Self {
            world: World::new(&loaded.scene, loaded.maps())?,
            mirror: Mirror::default(),
            scene: loaded.scene.clone(),
            height: loaded.height,
            sent: BTreeMap::new(),
            told_broken: 0,
            frame: 0,
            time_secs: 0.0,
        };
        stage.bring(&ServerMessage::Scene {
            scene: Box::new(loaded.scene),
            height_png: loaded.height_png,
            covering_png: loaded.covering_png,
            nutrient_png: loaded.nutrient_png,
            models: loaded.models,
        })?;
        Ok(stage)
    }

    /// Brings a message to the mirror as the wire would.
    fn bring(&mut self, message: &ServerMessage) -> Result<()> {
        self.mirror.apply(wire::decode(&wire::encode(message), SERVER_MESSAGE_LIMIT)?)?;
        Ok(())
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Height of the land (m).
    pub fn ground_m(&self, x_m: f32, z_m: f32) -> f32 {
        self.height.height_m(x_m, z_m)
    }

    /// Says where client 1 looks from: its vehicle appears there.
    pub fn look_from(&mut self, eye_m: [f32; 3]) {
        self.tell(&[Command::Views(vec![View { client: 1, eye_m }])]);
    }

    /// Gives `client` a vehicle, near its camera.
    pub fn spawn(&mut self, client: u32, kind: VehicleKind) {
        self.tell(&[Command::Spawn { client, kind }]);
    }

    /// Puts hands on the controls of `client`'s vehicle.
    pub fn drive(&mut self, client: u32, drive: Drive) {
        self.tell(&[Command::Drive { client, drive }]);
    }

    /// Takes all objects from the mirror, which else stays as it is, until the world is shown again.
    ///
    /// # Errors
    /// When the mirror refuses it.
    pub fn show_bare(&mut self) -> Result<()> {
        // What is told of an earlier time than before takes the place of all that was told.
        self.bring(&ServerMessage::Poses { tick: 0, objects: Vec::new() })
    }

    fn tell(&mut self, commands: &[Command]) {
        self.world.step(commands);
    }

    /// Runs the world for `secs` of simulated time.
    pub fn run(&mut self, secs: f32) {
        for _ in 0..(secs * self.scene.tick_hz).round() as u32 {
            self.world.step(&[]);
        }
    }

    /// Brings the newest state to the mirror; returns the objects' poses.
    ///
    /// # Errors
    /// When the mirror refuses what the world shows.
    pub fn show(&mut self) -> Result<Vec<ObjectPose>> {
        let snapshot = self.world.snapshot();
        self.bring(&ServerMessage::Poses { tick: snapshot.tick, objects: snapshot.objects.clone() })?;
        self.frame += 1;
        let wind = &snapshot.wind;
        let payload = codec::encode(Shape::wind(wind.cells[0] as usize, wind.has_dust()), &wind.codes, None);
        self.bring(&ServerMessage::Wind { tick: snapshot.tick, seq: self.frame, key: true, payload })?;
        let shown: BTreeSet<u32> = self.sent.keys().chain(snapshot.patches.keys()).copied().collect();
        for patch in shown {
            self.show_patch(patch, snapshot.patches.get(&patch))?;
        }
        while self.told_broken < snapshot.broken.len() {
            let plants = snapshot.broken.after(self.told_broken).to_vec();
            self.told_broken += plants.len();
            self.bring(&ServerMessage::Broken { plants })?;
        }
        let secs = snapshot.time_secs - self.time_secs;
        self.time_secs = snapshot.time_secs;
        self.bring(&ServerMessage::FrameEnd { frame: self.frame, tick: snapshot.tick, time_secs: snapshot.time_secs })?;
        self.mirror.advance(secs);
        Ok(snapshot.objects)
    }

    fn show_patch(&mut self, patch: u32, codes: Option<&Arc<PatchCodes>>) -> Result<()> {
        let seq = match self.sent.get(&patch) {
            Some((_, sent)) if codes.is_some_and(|codes| Arc::ptr_eq(codes, sent)) => return Ok(()),
            Some((seq, _)) => seq + 1,
            None if codes.is_none() => return Ok(()),
            None => 1,
        };
        let payload =
            codes.map_or_else(Vec::new, |codes| codec::encode(Shape::patch(self.scene.patches.cells as usize), &codes.codes, None));
        self.bring(&ServerMessage::Patch { patch, seq, key: true, payload })?;
        match codes {
            Some(codes) => self.sent.insert(patch, (seq, Arc::clone(codes))),
            None => self.sent.remove(&patch),
        };
        Ok(())
    }
}

/// What happens on a stage before its picture is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Act {
    /// Wind alone.
    Wind,
    /// A car has driven across the view in a long bend.
    Track,
    /// A helicopter hovers low over the grass.
    Wash,
    /// A monster walks through the grass.
    Walk,
    /// A sled has been dragged across the view.
    Drag,
    /// A ball rolls away through the grass.
    Roll,
}

/// Plays an act in front of the eye and leaves the mirror at its end. Returns the pose of the act's own object.
///
/// # Errors
/// When the act's vehicle finds no room, or the mirror refuses the world.
pub fn play(stage: &mut Stage, act: Act, eye_m: [f32; 3]) -> Result<Option<ObjectPose>> {
    stage.look_from(eye_m);
    stage.run(4.0);
    let moves: &[(f32, Drive)] = match act {
        Act::Wind => &[],
        Act::Track => &[
            (2.2, Drive { throttle: 1.0, steer: 0.0, lift: 0.0, brake: 0.0 }),
            (2.6, Drive { throttle: 0.6, steer: 0.45, lift: 0.0, brake: 0.0 }),
            (1.2, Drive { throttle: 0.6, steer: -0.3, lift: 0.0, brake: 0.0 }),
        ],
        Act::Wash => &[
            (0.8, Drive { throttle: 0.0, steer: 0.0, lift: 0.5, brake: 0.0 }),
            (3.5, Drive { throttle: 0.0, steer: 0.0, lift: 0.0, brake: 0.0 }),
        ],
        Act::Walk => &[(4.0, Drive { throttle: 0.7, steer: 0.1, lift: 0.0, brake: 0.0 })],
        Act::Roll => &[(2.6, Drive { throttle: 1.0, steer: 0.15, lift: 0.0, brake: 0.0 })],
        Act::Drag => &[
            (1.8, Drive { throttle: 0.8, steer: 0.0, lift: 0.0, brake: 0.0 }),
            (2.4, Drive { throttle: 0.6, steer: 0.7, lift: 0.0, brake: 0.0 }),
        ],
    };
    let kind = match act {
        Act::Wind => None,
        Act::Track => Some(VehicleKind::Car),
        Act::Wash => Some(VehicleKind::Helicopter),
        Act::Walk => Some(VehicleKind::Monster),
        Act::Drag => Some(VehicleKind::Sled),
        Act::Roll => Some(VehicleKind::Ball),
    };
    if let Some(kind) = kind {
        stage.spawn(1, kind);
        stage.run(0.5);
    }
    for &(secs, drive) in moves {
        stage.drive(1, drive);
        stage.run(secs);
    }
    let poses = stage.show()?;
    let object = stage.world.object_of(1);
    match kind {
        Some(kind) => {
            let pose = object.and_then(|id| poses.into_iter().find(|pose| pose.id == id));
            pose.map(Some).with_context(|| format!("the {} found no room", kind.name()))
        }
        None => Ok(None),
    }
}
