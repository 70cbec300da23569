//! A minimal simulation instead of the world.

use prairie::runner::Simulation;
use prairie::scenes::LoadedScene;
use prairie::snapshot::{PatchCodes, PatchQuantiser, Snapshot, WindFrame};
use prairie::world::Command;
use prairie_core::scene::{Patches, Scene, TerrainMaps, VehicleKind, Wind};
use prairie_core::terrain::{CoverMap, HeightMap, grey_png};
use prairie_core::wire::{ObjectId, ObjectPose};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::thread::sleep;
use std::time::Duration;

const CELLS: usize = 8;
const PATCHES: usize = 9;
const WIND_CELLS: [u32; 3] = [4, 2, 4];
pub(crate) const OBJECT_LIMIT: usize = 3;

/// A minimal world that never rests: one patch after another changes, and objects move at the throttle of their driver.
#[derive(Default)]
pub(crate) struct StandInWorld {
    tick: u64,
    objects: BTreeMap<u32, ObjectPose>,
    throttle: BTreeMap<u32, f32>,
    fails_at: Option<u64>,
    misshapen_at: Option<u64>,
    halted: Arc<AtomicBool>,
    /// Requests for vehicles so far.
    pub(crate) requests: Arc<AtomicU64>,
}

impl StandInWorld {
    /// A world that panics at step `tick`.
    pub(crate) fn failing_at(tick: u64) -> Self {
        Self { fails_at: Some(tick), ..Self::default() }
    }

    /// A world whose patches have an invalid shape from step `tick` on.
    pub(crate) fn misshapen_at(tick: u64) -> Self {
        Self { misshapen_at: Some(tick), ..Self::default() }
    }

    /// A world that blocks while `halted` is set.
    pub(crate) fn halting(halted: Arc<AtomicBool>) -> Self {
        Self { halted, ..Self::default() }
    }
}

impl Simulation for StandInWorld {
    fn step(&mut self, commands: &[Command]) {
        while self.halted.load(Relaxed) {
            sleep(Duration::from_millis(1));
        }
        self.tick += 1;
        assert_ne!(Some(self.tick), self.fails_at, "the test makes this step fail");
        let requests = commands.iter().filter(|command| matches!(command, Command::Spawn { .. })).count();
        self.requests.fetch_add(requests as u64, Relaxed);
        for command in commands {
            match *command {
                Command::Spawn { client, kind } if self.objects.len() < OBJECT_LIMIT => {
                    self.objects.insert(client, pose(client, kind));
                }
                Command::Remove { client } | Command::Leave { client } => {
                    self.objects.remove(&client);
                }
                Command::Drive { client, drive, .. } => {
                    self.throttle.insert(client, drive.throttle);
                }
                Command::Spawn { .. } | Command::Cameras(_) | Command::Join { .. } | Command::Return { .. } | Command::Adapt(_) => {}
            }
        }
        for (client, object) in &mut self.objects {
            object.position_m[2] -= self.throttle.get(client).copied().unwrap_or(0.0);
        }
    }

    fn publish(&self, _: &mut PatchQuantiser) -> Snapshot {
        let len = 3 * CELLS * CELLS - usize::from(self.misshapen_at.is_some_and(|tick| self.tick >= tick));
        let patch = |index: usize| {
            let tick = self.tick / PATCHES as u64 * PATCHES as u64 + index as u64;
            let codes = (0..len).map(|i| ((tick as usize + i * index) % 200) as i16 / 2).collect();
            (index as u32, Arc::new(PatchCodes { tick, codes }))
        };
        let wind = WindFrame { tick: self.tick, cells: WIND_CELLS, codes: vec![(self.tick % 100) as i16; 96], ..WindFrame::default() };
        Snapshot {
            tick: self.tick,
            time_secs: self.tick as f64 / 60.0,
            objects: self.objects.values().copied().collect(),
            wind: Arc::new(wind),
            object_limit: OBJECT_LIMIT as u32,
            patches: Arc::new((0..PATCHES).map(patch).collect()),
            ..Snapshot::default()
        }
    }

    fn object_of(&self, client: u32) -> Option<ObjectId> {
        self.objects.get(&client).map(|pose| pose.id)
    }
}

fn pose(client: u32, kind: VehicleKind) -> ObjectPose {
    ObjectPose { id: 100 + client, kind, position_m: [0.0; 3], rotation: [0.0, 0.0, 0.0, 1.0], velocity_m_per_s: [0.0; 3], part_rad: 0.0 }
}

pub(crate) fn scene() -> LoadedScene {
    let terrain = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [1.0, 1.0], level_m: 0.1, base_m: 0.0 };
    let patches = Patches { count: [3, 3], cells: CELLS as u32, cell_m: 1.0, ..Patches::default() };
    let wind = Wind { cells: WIND_CELLS, ..Wind::default() };
    let scene = Scene { summary: "a test".to_owned(), tick_hz: 120.0, patches, wind, ..Scene::new(terrain) };
    let png_bytes = grey_png([2; 2], &[255; 4]);
    LoadedScene {
        name: "small".to_owned(),
        height: HeightMap::from_png(&png_bytes, &scene.terrain).unwrap(),
        cover: CoverMap::from_png(&png_bytes).unwrap(),
        height_png: png_bytes.clone(),
        covering_png: png_bytes,
        nutrient_png: Vec::new(),
        nutrients: None,
        scene,
        drawings: Default::default(),
        models: Vec::new(),
        files: Vec::new(),
        explanation: Default::default(),
    }
}
