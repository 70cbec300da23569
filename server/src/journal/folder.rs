//! The folder of one world: names, lock, key, atomic writes, and deletion of the oldest generations.

use super::error::JournalError;
use super::source::SceneSource;
use crate::escaped::escaped;
use crate::file::{unique_part, write_atomically};
use crate::scenes::LoadedScene;
use data_encoding::HEXLOWER;
use prairie_core::scene::{Budget, Scene};
use ring::digest::{Context, SHA256};
use ring::rand::{SecureRandom as _, SystemRandom};
use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

/// Version of the state and of everything that computes it. Another version begins new worlds.
const VERSION: u32 = 10;
/// Length of the key for the proofs of clients (bytes).
const KEY_BYTES: usize = 32;
/// Generations that are never deleted to stay within the limit.
const KEPT: usize = 3;

/// An open folder of a world.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    key: [u8; KEY_BYTES],
    /// Locked as long as it is open.
    _lock: File,
}

/// Name of the sub-folder of a scene: its own name, and a hash of the scene, its maps, and the version of the state.
pub(super) fn name_of(scene: &LoadedScene) -> String {
    let mut hash = Context::new(&SHA256);
    // Budgets that are left in a scene are those of its clients.
    let simulated = Scene { budget: Budget::default(), ..scene.scene.clone() };
    let parts = [
        postcard::to_allocvec(&simulated).expect("a scene is plain data"),
        scene.height_png.clone(),
        scene.covering_png.clone(),
        scene.nutrient_png.clone(),
        format!("{:?}", scene.drawings).into_bytes(),
    ];
    hash.update(&VERSION.to_le_bytes());
    for part in parts {
        hash.update(&(part.len() as u64).to_le_bytes());
        hash.update(&part);
    }
    let plain = |c: char| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' };
    let name: String = scene.name.chars().map(plain).take(40).collect();
    format!("{name}-{}", &HEXLOWER.encode(hash.finish().as_ref())[..16])
}

/// The folder of a world in `path`: itself, or its only sub-folder with a world.
///
/// # Errors
/// When there is none, or several.
pub fn find(path: &Path) -> Result<PathBuf, JournalError> {
    let is_world = |path: &Path| path.join("scene").is_file();
    if is_world(path) {
        return Ok(path.to_owned());
    }
    let entries = fs::read_dir(path).map_err(|error| JournalError::file(path, error))?;
    let mut worlds: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).filter(|path| is_world(path)).collect();
    worlds.sort();
    match worlds.as_slice() {
        [world] => Ok(world.clone()),
        [] => Err(JournalError::NoWorld { path: path.to_owned(), reason: "there is no world here".to_owned() }),
        several => {
            let names: Vec<_> = several.iter().map(|path| format!("  {}", escaped(path))).collect();
            let reason = format!("there are several worlds here; name one of them:\n{}", names.join("\n"));
            Err(JournalError::NoWorld { path: path.to_owned(), reason })
        }
    }
}

/// Numbers of the generations in `path`, ascending.
///
/// # Errors
/// When the folder cannot be read.
pub(super) fn generations(path: &Path) -> Result<BTreeSet<u64>, JournalError> {
    let entries = fs::read_dir(path).map_err(|error| JournalError::file(path, error))?;
    let number = |entry: io::Result<fs::DirEntry>| {
        let name = entry.ok()?.file_name();
        let (number, kind) = name.to_str()?.split_once('.')?;
        ["checkpoint", "journal"].contains(&kind).then(|| number.parse().ok())?
    };
    Ok(entries.filter_map(number).collect())
}

/// The file of a generation's checkpoint.
pub(super) fn checkpoint_in(path: &Path, generation: u64) -> PathBuf {
    path.join(format!("{generation:08}.checkpoint"))
}

/// The file of a generation's segment.
pub(super) fn segment_in(path: &Path, generation: u64) -> PathBuf {
    path.join(format!("{generation:08}.journal"))
}

impl Folder {
    /// Opens or creates the folder of `scene` in `parent`, and locks it.
    ///
    /// # Errors
    /// [`JournalError`] when another process has locked it, or something cannot be written.
    pub fn open(parent: &Path, scene: &LoadedScene) -> Result<Self, JournalError> {
        let path = parent.join(name_of(scene));
        fs::create_dir_all(&path).map_err(|error| JournalError::file(&path, error))?;
        let lock_path = path.join("lock");
        let lock = OpenOptions::new().create(true).truncate(false).write(true).open(&lock_path);
        let lock = lock.map_err(|error| JournalError::file(&lock_path, error))?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(JournalError::Busy(path)),
            Err(TryLockError::Error(error)) => return Err(JournalError::file(&lock_path, error)),
        }
        let scene_path = path.join("scene");
        write_atomically(&scene_path, SceneSource::of(scene, &path).text().as_bytes())
            .map_err(|error| JournalError::file(&scene_path, error))?;
        let key = key(&path.join("key"))?;
        Ok(Self { path, key, _lock: lock })
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Key for the proofs of clients.
    pub(super) fn key(&self) -> [u8; KEY_BYTES] {
        self.key
    }

    /// Writes the checkpoint of a generation.
    pub(super) fn write_checkpoint(&self, generation: u64, bytes: &[u8]) -> io::Result<()> {
        write_atomically(&checkpoint_in(&self.path, generation), bytes)
    }

    /// Deletes the oldest generations until the rest is within `limit_bytes`; at least three with checkpoints stay.
    pub(super) fn prune(&self, limit_bytes: u64) -> io::Result<()> {
        let Ok(generations) = generations(&self.path) else { return Ok(()) };
        let files = |generation: u64| [checkpoint_in(&self.path, generation), segment_in(&self.path, generation)];
        let size = |path: &PathBuf| fs::metadata(path).map_or(0, |metadata| metadata.len());
        let mut total: u64 = generations.iter().flat_map(|&generation| files(generation)).map(|path| size(&path)).sum();
        let bases: Vec<u64> = generations.iter().copied().filter(|&generation| files(generation)[0].is_file()).collect();
        let newest_deletable = bases.len().checked_sub(KEPT).map_or(0, |at| bases[at]);
        for generation in generations.into_iter().take_while(|&generation| generation < newest_deletable) {
            if total <= limit_bytes {
                break;
            }
            for path in files(generation).iter().filter(|path| path.is_file()) {
                total -= size(path);
                fs::remove_file(path)?;
            }
        }
        Ok(())
    }

    /// Renames the files of generations that cannot follow the present one, so that they are kept but never used.
    pub(super) fn set_aside(&self, generations: impl Iterator<Item = u64>) -> Result<(), JournalError> {
        for path in generations.flat_map(|generation| [checkpoint_in(&self.path, generation), segment_in(&self.path, generation)]) {
            if path.is_file() {
                let mut aside = path.clone().into_os_string();
                aside.push(format!(".{}.unused", unique_part()));
                fs::rename(&path, aside).map_err(|error| JournalError::file(&path, error))?;
            }
        }
        Ok(())
    }
}

/// The key in a file, which is created if it is missing or damaged.
fn key(path: &Path) -> Result<[u8; KEY_BYTES], JournalError> {
    if let Ok(bytes) = fs::read(path)
        && let Ok(key) = bytes.try_into()
    {
        return Ok(key);
    }
    let mut key = [0; KEY_BYTES];
    let drawn = SystemRandom::new().fill(&mut key).map_err(|_| io::Error::other("the system has no random numbers"));
    drawn.and_then(|()| write_atomically(path, &key)).map_err(|error| JournalError::file(path, error))?;
    Ok(key)
}

/// Other folders of worlds of a scene of the same name.
pub(super) fn others(parent: &Path, own: &Path) -> Vec<PathBuf> {
    let name = |path: &Path| Some(path.file_name()?.to_str()?.rsplit_once('-')?.0.to_owned());
    let entries = fs::read_dir(parent).into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path()));
    let mut others: Vec<_> = entries.filter(|path| path != own && name(path) == name(own) && path.join("scene").is_file()).collect();
    others.sort();
    others
}
