//! A world that remembers: every step goes into the journal, and now and then a checkpoint begins a new generation of it.

use super::error::JournalError;
use super::folder::Folder;
use super::health::Health;
use super::unchanged::Unchanged;
use super::writer::{Entry, Writer};
use crate::detail::DetailRange;
use crate::runner::Simulation;
use crate::snapshot::{PatchQuantiser, Snapshot};
use crate::world::{Command, World};
use prairie_core::grass::BendState;
use prairie_core::wire::ObjectId;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::time::{Duration, Instant};

/// Time of computing that a resumption may have to repeat: a checkpoint is due when the steps since the last one took this long.
const REPEATED: Duration = Duration::from_secs(2);
/// A checkpoint is also due after this time.
const LONGEST: Duration = Duration::from_secs(300);
/// Shortest time between two checkpoints, and between two attempts.
const SHORTEST: Duration = Duration::from_secs(2);
/// Client numbers that are left out at a start: the last clients of a process that was killed may be missing in its journal.
const CLIENT_GAP: u32 = 4096;

/// A world, with its journal unless it is one without memory.
pub struct JournaledWorld {
    world: World,
    journal: Option<Journal>,
    key: Option<[u8; 32]>,
    first_client: u32,
    /// Commands before those of the next step.
    pending: Vec<Command>,
}

/// The journal of a running world.
struct Journal {
    writer: Writer,
    health: Arc<Health>,
    /// The next generation.
    generation: u64,
    unchanged: Unchanged,
    /// Whether a step is missing, so that only a new generation makes sense.
    has_gap: bool,
    computed: Duration,
    begun: Instant,
}

impl From<World> for JournaledWorld {
    /// A world without memory.
    fn from(world: World) -> Self {
        let first_client = world.newest_client() + 1;
        Self { world, journal: None, key: None, first_client, pending: vec![] }
    }
}

impl JournaledWorld {
    /// A world whose journal continues with a generation. The vehicles of its clients wait for their return.
    pub(super) fn new(world: World, folder: Folder, limit_bytes: u64, generation: u64) -> Result<Self, JournalError> {
        let (key, health) = (folder.key(), Arc::<Health>::default());
        let first_client = if world.tick() == 0 { 1 } else { world.newest_client().saturating_add(CLIENT_GAP) };
        let pending = world.drivers().chain(world.racers_on_foot()).map(|client| Command::Leave { client }).collect();
        let writer = Writer::start(folder, limit_bytes, health.clone())?;
        let mut journal = Journal {
            writer,
            health,
            generation,
            unchanged: Unchanged::default(),
            has_gap: false,
            computed: Duration::ZERO,
            begun: Instant::now(),
        };
        journal.begin(&world);
        Ok(Self { world, journal: Some(journal), key: Some(key), first_client, pending })
    }

    /// The world.
    pub fn world(&self) -> &World {
        &self.world
    }

    /// Counters of the journal; `None` without memory.
    pub fn health(&self) -> Option<Arc<Health>> {
        self.journal.as_ref().map(|journal| journal.health.clone())
    }
}

impl Journal {
    /// Begins a generation with a checkpoint. While the one before is still being written, the next attempt follows later.
    fn begin(&mut self, world: &World) {
        let copying = Instant::now();
        if let Some(mut state) = self.writer.spare_state() {
            world.save_into(&mut state);
            self.health.copy_max_us.fetch_max(copying.elapsed().as_micros() as u64, Relaxed);
            self.writer.keep(self.generation, state);
            self.has_gap = !self.writer.enter(Entry::Begin { generation: self.generation, tick: world.tick() });
            self.generation += 1;
            self.unchanged = Unchanged::default();
        }
        (self.begun, self.computed) = (Instant::now(), Duration::ZERO);
    }

    fn note(&mut self, world: &World, commands: &[Command], took: Duration) {
        self.computed += took;
        // A failure of an earlier generation is over: its successor begins with a checkpoint.
        let is_missing = self.has_gap || self.health.broken_generation.load(Relaxed) + 1 == self.generation;
        if is_missing {
            self.health.lost_steps.fetch_add(1, Relaxed);
        } else {
            let commands = self.unchanged.filter(commands);
            self.has_gap = !self.writer.enter(Entry::Step { tick: world.tick(), commands });
        }
        let age = self.begun.elapsed();
        if age >= SHORTEST && (is_missing || self.health.is_failing() || self.computed >= REPEATED || age >= LONGEST) {
            self.begin(world);
        }
    }
}

impl Drop for JournaledWorld {
    /// A last checkpoint, so that the next start repeats nothing.
    fn drop(&mut self) {
        if let Some(journal) = &mut self.journal {
            let (generation, tick) = (journal.generation, self.world.tick());
            if journal.writer.enter(Entry::Begin { generation, tick }) {
                journal.writer.keep(generation, self.world.save());
            }
        }
    }
}

impl Simulation for JournaledWorld {
    fn step(&mut self, commands: &[Command]) {
        let mut all = std::mem::take(&mut self.pending);
        all.extend_from_slice(commands);
        let begun = Instant::now();
        self.world.step(&all);
        if let Some(journal) = &mut self.journal {
            journal.note(&self.world, &all, begun.elapsed());
        }
    }

    fn bend_state(&self) -> Option<BendState> {
        self.world.bend_state()
    }

    fn publish(&self, quantiser: &mut PatchQuantiser) -> Snapshot {
        self.world.publish(quantiser)
    }

    fn object_of(&self, client: u32) -> Option<ObjectId> {
        self.world.object_of(client)
    }

    fn is_idle(&self) -> bool {
        self.world.is_idle()
    }

    fn is_at_rest(&self) -> bool {
        self.world.is_at_rest()
    }

    fn tick(&self) -> u64 {
        self.world.tick()
    }

    fn key(&self) -> Option<[u8; 32]> {
        self.key
    }

    fn watch_errors(&mut self) {
        self.world.watch_errors();
    }

    fn detail_range(&self) -> Option<DetailRange> {
        Some(self.world.detail_range())
    }

    fn departed(&self) -> Vec<u32> {
        // Before the first step, all drivers of the process before.
        if self.pending.is_empty() { self.world.departed() } else { self.world.drivers().collect() }
    }

    fn first_client(&self) -> u32 {
        self.first_client
    }

    fn journal_health(&self) -> Option<Arc<Health>> {
        self.health()
    }
}

#[cfg(test)]
mod tests {
    use super::super::folder::checkpoint_in;
    use super::super::{WorldFolder, find, open, open_checkpoint};
    use super::*;
    use crate::scenes;
    use prairie_core::scene::VehicleKind;
    use prairie_core::wire::Drive;
    use std::{fs, thread};

    #[test]
    fn checkpoints_in_the_middle_of_a_run_are_whole_and_resumed_from() {
        let mut scene = scenes::load("blades").unwrap();
        scene.scene.objects.limit = 32;
        let folder = tempfile::tempdir().unwrap();
        let place = WorldFolder::new(folder.path().to_owned());
        let mut kept = open(Some(&place), &scene).unwrap();
        let mut undisturbed = World::new(&scene.scene, scene.maps()).unwrap();
        let mut drive = |kept: &mut JournaledWorld, ticks: u64| {
            for _ in 0..ticks {
                let spawn = Command::Spawn { client: 1, kind: VehicleKind::Car };
                let drive = Drive { throttle: 1.0, steer: (undisturbed.tick() as f32 * 0.02).sin(), ..Drive::default() };
                let commands = [if undisturbed.tick() == 0 { spawn } else { Command::Drive { client: 1, number: 0, drive } }];
                kept.step(&commands);
                undisturbed.step(&commands);
            }
            undisturbed.save().encode()
        };
        let mut expected = vec![];
        // The first begins with the world; the memory of each serves for the next.
        for generation in 2..6 {
            expected.push((generation, drive(&mut kept, 40)));
            let JournaledWorld { world, journal: Some(journal), .. } = &mut kept else { panic!("a world with memory") };
            let until = Instant::now() + Duration::from_secs(20);
            while journal.generation == generation {
                assert!(Instant::now() < until, "the checkpoint before is written");
                journal.begin(world);
                thread::sleep(Duration::from_millis(1));
            }
        }
        let last = drive(&mut kept, 40);
        drop(kept);
        let own = find(folder.path()).unwrap();
        for (generation, state) in &expected {
            let sealed = fs::read(checkpoint_in(&own, *generation)).unwrap();
            assert!(open_checkpoint(&sealed).unwrap().encode() == *state, "generation {generation}");
        }
        // As after a crash, the state at the end is missing.
        fs::remove_file(checkpoint_in(&own, 6)).unwrap();
        assert!(open(Some(&place), &scene).unwrap().world().save().encode() == last);
    }
    #[test]
    fn a_generation_has_all_its_steps_although_the_one_before_failed() {
        let scene = scenes::load("blades").unwrap();
        let folder = tempfile::tempdir().unwrap();
        let mut kept = open(Some(&WorldFolder::new(folder.path().to_owned())), &scene).unwrap();
        let JournaledWorld { world, journal: Some(journal), .. } = &mut kept else { panic!("a world with memory") };
        let until = Instant::now() + Duration::from_secs(20);
        let failed = journal.generation - 1;
        while journal.generation == failed + 1 {
            assert!(Instant::now() < until, "the first checkpoint is written");
            journal.begin(world);
            thread::sleep(Duration::from_millis(1));
        }
        // As while the new segment is still being created.
        journal.health.broken_generation.store(failed, Relaxed);
        world.step(&[]);
        journal.note(world, &[Command::Spawn { client: 1, kind: VehicleKind::Car }], Duration::ZERO);
        assert_eq!(journal.health.lost_steps.load(Relaxed), 0, "the step belongs to the new generation");
        while journal.health.journal_bytes.load(Relaxed) == 0 {
            assert!(Instant::now() < until, "the step is written");
            thread::sleep(Duration::from_millis(1));
        }
        journal.health.broken_generation.store(failed + 1, Relaxed);
        world.step(&[]);
        journal.note(world, &[], Duration::ZERO);
        assert_eq!(journal.health.lost_steps.load(Relaxed), 1, "the generation has failed itself");
    }
}
