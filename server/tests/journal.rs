//! A world in its folder: what a crash leaves behind is resumed bit for bit, and damaged files are noticed.
//!
//! A copy of the folder of a running world is what a killed process would leave.

use prairie::journal::{Difference, JournalError, JournaledWorld, Player, Segment, WorldFolder, compare, find, open, recorded};
use prairie::runner::Simulation as _;
use prairie::scenes::{self, LoadedScene};
use prairie::world::{Camera, Command};
use prairie_core::scene::VehicleKind;
use prairie_core::wire::Drive;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A small scene, so that its world is built quickly.
fn scene() -> LoadedScene {
    let mut scene = scenes::load("blades").unwrap();
    scene.scene.objects.limit = 32;
    scene
}

/// Commands of the step after `tick`: two drivers, whose cameras follow.
fn commands(tick: u64) -> Vec<Command> {
    let mut commands = vec![];
    if tick == 0 {
        commands.extend((1..=2).flat_map(|client| [Command::Join { client }, Command::Spawn { client, kind: VehicleKind::Car }]));
    }
    if tick.is_multiple_of(2) {
        let steer = (tick as f32 * 0.013).sin();
        commands.extend((1..=2).map(|client| Command::Drive {
            client,
            number: 0,
            drive: Drive { throttle: 0.8, steer, ..Drive::default() },
        }));
    }
    if tick.is_multiple_of(3) {
        commands.push(Command::Cameras(vec![Camera { client: 1, eye_m: [12.0 + 0.01 * tick as f32, 2.0, 12.0] }]));
    }
    commands
}

/// A running world in a folder, with its checksums after each step.
struct Running {
    folder: TempDir,
    world: JournaledWorld,
    sums: Vec<u64>,
}

impl Running {
    fn start() -> Self {
        let folder = tempfile::tempdir().unwrap();
        let world = open(Some(&WorldFolder::new(folder.path().to_owned())), &scene()).unwrap();
        let sums = vec![world.world().checksum()];
        Self { folder, world, sums }
    }

    fn step(&mut self, ticks: u64) {
        for _ in 0..ticks {
            self.world.step(&commands(self.world.tick()));
            self.sums.push(self.world.world().checksum());
        }
    }

    /// A copy of the folder as it is when the newest step has been written.
    fn crash(&self) -> TempDir {
        let until = Instant::now() + Duration::from_secs(20);
        let newest = |path: &Path| files(path, "journal").last().and_then(|path| Segment::read(path).ok());
        let own = find(self.folder.path()).unwrap();
        while newest(&own).is_none_or(|segment| segment.reached < self.world.tick()) {
            assert!(Instant::now() < until, "the newest step is written");
            std::thread::sleep(Duration::from_millis(5));
        }
        while files(&own, "checkpoint").is_empty() {
            assert!(Instant::now() < until, "the first checkpoint is written");
            std::thread::sleep(Duration::from_millis(5));
        }
        copied(self.folder.path())
    }
}

/// The files of a kind, ascending.
fn files(folder: &Path, kind: &str) -> Vec<PathBuf> {
    let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == kind));
    files.sort();
    files
}

fn copied(folder: &Path) -> TempDir {
    let copy = tempfile::tempdir().unwrap();
    let own = find(folder).unwrap();
    let to = copy.path().join(own.file_name().unwrap());
    fs::create_dir(&to).unwrap();
    for entry in fs::read_dir(&own).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "new") {
            fs::copy(&path, to.join(path.file_name().unwrap())).unwrap();
        }
    }
    copy
}

fn resumed(folder: &TempDir) -> JournaledWorld {
    open(Some(&WorldFolder::new(folder.path().to_owned())), &scene()).unwrap()
}

#[test]
fn a_crash_loses_nothing_that_was_written() {
    let mut running = Running::start();
    for ticks in [1, 40, 200, 3] {
        running.step(ticks);
        let crashed = running.crash();
        let copy = copied(crashed.path());
        let mut again = resumed(&crashed);
        let tick = running.world.tick();
        assert_eq!((again.tick(), again.world().checksum()), (tick, running.sums[tick as usize]));
        assert!(again.world().save().encode() == running.world.world().save().encode(), "the whole state after step {tick}");
        let mut player = Player::open_oldest(&find(copy.path()).unwrap(), &scene()).unwrap().unwrap();
        player.advance(u64::MAX);
        assert_eq!((player.world.tick(), player.world.checksum()), (tick, running.sums[tick as usize]), "an undisturbed replay");
        assert_eq!(again.departed(), [1, 2], "the vehicles wait for their drivers");
        again.step(&[]);
        assert!(again.first_client() > 2);
    }
}

#[test]
fn an_orderly_end_and_many_starts_lose_nothing_either() {
    let mut running = Running::start();
    running.step(30);
    let Running { folder, world, sums } = running;
    drop(world);
    let mut expected = sums[30];
    for start in 0..4 {
        let mut world = resumed(&folder);
        assert_eq!(world.world().checksum(), expected, "start {start}");
        (0..7).for_each(|_| world.step(&[]));
        assert_eq!(world.tick(), 30 + 7 * (start + 1));
        expected = world.world().checksum();
    }
    let mut player = Player::open_oldest(&find(folder.path()).unwrap(), &scene()).unwrap().unwrap();
    player.advance(u64::MAX);
    assert_eq!((player.world.tick(), player.world.checksum()), (58, expected), "over all starts");
}

/// A world of three generations: two starts after the first.
fn generations() -> (TempDir, Vec<u64>) {
    let mut running = Running::start();
    running.step(50);
    let Running { folder, world, mut sums } = running;
    drop(world);
    for _ in 0..2 {
        let mut world = resumed(&folder);
        for _ in 0..50 {
            world.step(&commands(world.tick() + 1));
            sums.push(world.world().checksum());
        }
    }
    (folder, sums)
}

#[test]
fn a_damaged_checkpoint_is_left_out() {
    let (folder, sums) = generations();
    let newest = files(&find(folder.path()).unwrap(), "checkpoint").len();
    for damage in ["truncated", "flipped", "emptied"] {
        for damaged in 1..newest {
            let copy = copied(folder.path());
            for path in files(&find(copy.path()).unwrap(), "checkpoint").iter().rev().take(damaged) {
                let mut bytes = fs::read(path).unwrap();
                match damage {
                    "truncated" => bytes.truncate(bytes.len() / 2),
                    "flipped" => bytes[777] ^= 4,
                    _ => bytes.clear(),
                }
                fs::write(path, bytes).unwrap();
            }
            let player = Player::open(&find(copy.path()).unwrap(), &scene(), u64::MAX).unwrap().unwrap();
            assert_eq!(player.recording.faults.len(), damaged, "{:?}", player.recording.faults);
            assert!(player.recording.faults.iter().all(|fault| fault.contains(".checkpoint: ")), "{:?}", player.recording.faults);
            let world = resumed(&copy);
            assert_eq!(
                (world.tick(), world.world().checksum()),
                (150, sums[150]),
                "{damaged} {damage}: the journal leads to the same step"
            );
        }
    }
}

#[test]
fn without_a_valid_checkpoint_a_new_world_begins_and_the_files_are_kept() {
    let (folder, sums) = generations();
    let own = find(folder.path()).unwrap();
    let all = files(&own, "checkpoint");
    all.iter().for_each(|path| fs::write(path, b"nonsense").unwrap());
    let world = resumed(&folder);
    assert_eq!((world.tick(), world.world().checksum()), (0, sums[0]));
    assert!(files(&own, "unused").len() >= all.len());
}

#[test]
fn a_damaged_journal_is_cut_at_the_fault() {
    let mut running = Running::start();
    running.step(120);
    let crashed = running.crash();
    let length = fs::metadata(&files(&find(crashed.path()).unwrap(), "journal")[0]).unwrap().len() as usize;
    for (cut, at) in [(true, length / 2), (true, length - 3), (false, length / 3), (false, length / 2 + 5), (false, 44)] {
        let copy = copied(crashed.path());
        let path = files(&find(copy.path()).unwrap(), "journal")[0].clone();
        let mut bytes = fs::read(&path).unwrap();
        if cut {
            bytes.truncate(at);
        } else {
            bytes[at] ^= 0x10;
        }
        fs::write(&path, bytes).unwrap();
        let segment = Segment::read(&path).unwrap();
        assert!(segment.fault.is_some() && segment.reached < 120);
        let mut world = resumed(&copy);
        let tick = world.tick();
        assert_eq!((tick, world.world().checksum()), (segment.reached, running.sums[segment.reached as usize]));
        world.step(&[]);
        drop(world);
        assert_eq!(resumed(&copy).tick(), tick + 1, "it goes on from there");
    }
}

#[test]
fn one_folder_is_for_one_server() {
    let running = Running::start();
    let second = open(Some(&WorldFolder::new(running.folder.path().to_owned())), &scene());
    let Err(error @ JournalError::Busy(_)) = second else { panic!("two servers in one folder") };
    assert!(error.to_string().contains("another server keeps the world of this scene here"), "{error}");
}

#[test]
fn a_folder_that_cannot_be_written_is_an_error() {
    let file = tempfile::NamedTempFile::new().unwrap();
    let error = open(Some(&WorldFolder::new(file.path().join("worlds"))), &scene()).err().expect("a file is no folder");
    assert!(matches!(&error, JournalError::File { path, .. } if path.starts_with(file.path())), "{error}");
}

#[test]
fn a_changed_scene_begins_anew_and_the_old_world_is_kept() {
    let mut running = Running::start();
    running.step(10);
    let Running { folder, world, sums } = running;
    drop(world);
    let mut changed = scene();
    changed.scene.seed += 1;
    let config = WorldFolder::new(folder.path().to_owned());
    assert_eq!(open(Some(&config), &changed).unwrap().tick(), 0);
    let world = open(Some(&config), &scene()).unwrap();
    assert_eq!((world.tick(), world.world().checksum()), (10, sums[10]), "the old scene finds its world again");
}

#[test]
fn old_generations_are_deleted_within_the_limit() {
    let (folder, _) = generations();
    let config = WorldFolder { limit_bytes: 1, ..WorldFolder::new(folder.path().to_owned()) };
    for _ in 0..3 {
        drop(open(Some(&config), &scene()).unwrap());
    }
    assert!((3..=4).contains(&files(&find(folder.path()).unwrap(), "checkpoint").len()));
    assert_eq!(resumed(&folder).tick(), 150);
}

#[test]
fn an_hour_of_driving_takes_at_most_5_mb() {
    let folder = tempfile::tempdir().unwrap();
    let config = WorldFolder::new(folder.path().to_owned());
    let mut world = open(Some(&config), &scene()).unwrap();
    world.step(&[Command::Join { client: 1 }, Command::Spawn { client: 1, kind: VehicleKind::Car }]);
    let minute = 3600_u64;
    for tick in 0..minute {
        let mut commands = vec![];
        let phase = tick as f32;
        if tick.is_multiple_of(2) {
            let drive = Drive { throttle: (phase * 0.01).cos(), steer: (phase * 0.03).sin(), ..Drive::default() };
            commands.push(Command::Drive { client: 1, number: 0, drive });
        }
        if tick.is_multiple_of(3) {
            commands.push(Command::Cameras(vec![Camera { client: 1, eye_m: [phase.sin(), 2.0 + phase.cos(), phase] }]));
        }
        world.step(&commands);
    }
    let health = world.health().unwrap();
    let copy_max_us = health.copy_max_us.load(std::sync::atomic::Ordering::Relaxed);
    drop(world);
    let bytes = health.journal_bytes.load(std::sync::atomic::Ordering::Relaxed);
    println!("{:.2} MB per hour and driver; longest copy of the state {copy_max_us} µs", bytes as f64 * 60.0 / 1e6);
    assert!(bytes > 0 && bytes * 60 <= 5_000_000, "{bytes} bytes in a minute");
}

#[test]
fn the_first_difference_of_two_journals_is_found() {
    // A recording is found by its scene's name, so this one is not changed.
    let folder = tempfile::tempdir().unwrap();
    let config = WorldFolder::new(folder.path().to_owned());
    let plain = scenes::load("blades").unwrap();
    let mut world = open(Some(&config), &plain).unwrap();
    (0..40).for_each(|tick| world.step(&commands(tick)));
    drop(world);
    let copy = copied(folder.path());
    let both = |from: &TempDir, to: &TempDir| compare(recorded(from.path(), None).unwrap().1, recorded(to.path(), None).unwrap().1);
    assert_eq!(both(&folder, &copy), None);
    let mut world = open(Some(&config), &plain).unwrap();
    world.step(&[]);
    world.step(&commands(41));
    drop(world);
    assert_eq!(both(&folder, &copy), Some(Difference::Length { ends: [42, 40] }));
    let mut world = open(Some(&WorldFolder::new(copy.path().to_owned())), &plain).unwrap();
    world.step(&[]);
    world.step(&[Command::Remove { client: 1 }]);
    drop(world);
    assert!(matches!(both(&folder, &copy), Some(Difference::Commands { tick: 42, .. })));
    let (_, from) = recorded(folder.path(), Some(20.0 / 60.0)).unwrap();
    assert_eq!(from.world.tick(), 20, "from a moment on");
}

#[test]
fn a_recording_is_played_after_its_scene_has_changed() {
    let work = tempfile::tempdir().unwrap();
    let files = scenes::create(&work.path().join("mine"), None).unwrap();
    let scene = scenes::load(&files[0]).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut world = open(Some(&WorldFolder::new(folder.path().to_owned())), &scene).unwrap();
    (0..30).for_each(|tick| world.step(&commands(tick)));
    let sum = world.world().checksum();
    drop(world);
    let text = fs::read_to_string(&files[0]).unwrap();
    fs::write(&files[0], text.replacen("seed = ", "seed = 1", 1)).unwrap();
    let (found, mut player) = recorded(folder.path(), Some(0.0)).unwrap();
    player.advance(u64::MAX);
    assert!(found.scene == scene.scene && found.height_png == scene.height_png);
    assert_eq!((player.world.tick(), player.world.checksum()), (30, sum));
    // Without the files that are kept, it needs the scene as it was.
    fs::remove_dir_all(find(folder.path()).unwrap().join("source")).unwrap();
    let error = recorded(folder.path(), None).err().expect("the scene has changed").to_string();
    assert!(error.contains("has changed since"), "{error}");
    fs::write(&files[0], text).unwrap();
    assert!(recorded(folder.path(), None).is_ok(), "the scene is back");
}
