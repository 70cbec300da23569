//! The files of a world's scene, kept beside it: a recording can be played after the scene has changed, and on other machines.

use super::error::JournalError;
use super::folder::name_of;
use crate::escaped::escaped;
use crate::file::{sync_folder, unique_part};
use crate::scenes::{self, LoadedScene};
use std::fs;
use std::io;
use std::path::{Component, Path, PathBuf};

/// Folder of the files, in that of the world.
const FOLDER: &str = "source";

/// Where the scene of a world is found.
pub(super) struct SceneSource {
    /// Name of a built-in scene, or path of the scene file, as given to `prairie serve`.
    pub(super) original: PathBuf,
    /// [`name_of`] the scene.
    pub(super) name: String,
    /// Path of the kept scene file in the folder of the world; `None` for a built-in scene, or where files could not be kept.
    pub(super) kept: Option<PathBuf>,
}

impl SceneSource {
    /// The source of a scene whose world is in `folder`, where its files are kept if they are not yet. A failure goes to the log.
    pub(super) fn of(scene: &LoadedScene, folder: &Path) -> Self {
        let original = scene.files.first().map(|file| fs::canonicalize(file).unwrap_or_else(|_| file.clone()));
        let is_whole = |kept: &PathBuf| scenes::load(folder.join(kept)).is_ok_and(|copy| name_of(&copy) == name_of(scene));
        let known = Self::read(folder).ok().and_then(|source| source.kept).filter(is_whole);
        let kept = known.or_else(|| {
            let kept = keep(folder, scene).inspect_err(|error| {
                tracing::warn!(folder = escaped(folder), "the files of the scene are not kept: {error}; a replay needs them unchanged");
            });
            kept.unwrap_or_default()
        });
        Self { original: original.unwrap_or_else(|| PathBuf::from(&scene.name)), name: name_of(scene), kept }
    }

    /// The source in the folder of a world.
    ///
    /// # Errors
    /// When its file cannot be read.
    pub(super) fn read(folder: &Path) -> Result<Self, JournalError> {
        let file = folder.join("scene");
        let text = fs::read_to_string(&file).map_err(|error| JournalError::file(&file, error))?;
        let mut lines = text.lines();
        let mut line = || lines.next().unwrap_or_default().to_owned();
        let (original, name, kept) = (line().into(), line(), line());
        Ok(Self { original, name, kept: Some(kept).filter(|kept| !kept.is_empty()).map(PathBuf::from) })
    }

    /// The text from which [`read`](Self::read) gets it.
    pub(super) fn text(&self) -> String {
        let kept = self.kept.as_deref().unwrap_or(Path::new(""));
        format!("{}\n{}\n{}\n", self.original.to_string_lossy(), self.name, kept.to_string_lossy())
    }

    /// The scene of the world in `folder`: as kept, or the original if it is still the same.
    ///
    /// # Errors
    /// The reason why neither can be loaded.
    pub(super) fn load(&self, folder: &Path) -> Result<LoadedScene, String> {
        let kept = self.kept.iter().map(|kept| folder.join(kept));
        let mut reasons = vec![];
        for source in kept.chain([self.original.clone()]) {
            match scenes::load(&source) {
                Ok(scene) if name_of(&scene) == self.name => return Ok(scene),
                Ok(_) => reasons.push(format!("its scene, {}, or this program has changed since", escaped(&source))),
                Err(error) => reasons.push(format!("its scene cannot be loaded: {error}")),
            }
        }
        Err(reasons.join("; "))
    }
}

/// Copies the files of a scene, with their places relative to each other, into the folder of its world. Returns the path of the scene file in there; `None` for a
/// built-in scene.
fn keep(folder: &Path, scene: &LoadedScene) -> io::Result<Option<PathBuf>> {
    let files = scene.files.iter().map(|file| plain(file)).collect::<io::Result<Vec<_>>>()?;
    let Some(scene_file) = files.first() else { return Ok(None) };
    let around = files.iter().fold(scene_file.parent().unwrap_or(scene_file), |around, file| common(around, file));
    let within = |file: &Path| file.strip_prefix(around).expect("a folder around all files").to_owned();
    let (kept, new) = (folder.join(FOLDER), folder.join(format!("{FOLDER}.{}.new", unique_part())));
    let copied = || {
        for file in &files {
            let to = new.join(within(file));
            fs::create_dir_all(to.parent().expect("in a folder"))?;
            fs::copy(file, &to)?;
            fs::File::open(&to)?.sync_all()?;
            sync_folder(&to)?;
        }
        let scene_copy = new.join(within(scene_file));
        scenes::load_open(scene_file).map_err(io::Error::other)?.keep_plan(&scene_copy)?;
        let copy = scenes::load(scene_copy).map_err(io::Error::other)?;
        if name_of(&copy) != name_of(scene) {
            return Err(io::Error::other("they have changed since they were loaded, or name others by absolute paths"));
        }
        if kept.exists() {
            fs::remove_dir_all(&kept)?;
        }
        fs::rename(&new, &kept)?;
        sync_folder(&kept)
    };
    copied().inspect_err(|_| drop(fs::remove_dir_all(&new)))?;
    Ok(Some(Path::new(FOLDER).join(within(scene_file))))
}

/// An absolute path without `.` and `..`.
fn plain(path: &Path) -> io::Result<PathBuf> {
    let mut plain = PathBuf::new();
    for part in std::path::absolute(path)?.components() {
        match part {
            Component::ParentDir => _ = plain.pop(),
            part => plain.push(part),
        }
    }
    Ok(plain)
}

/// The innermost folder around a folder and a file.
fn common<'a>(folder: &'a Path, file: &Path) -> &'a Path {
    folder.ancestors().find(|ancestor| file.starts_with(ancestor)).unwrap_or(Path::new(""))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scene in a folder in `work`.
    fn written(work: &Path) -> PathBuf {
        let folder = work.join("scenes");
        scenes::create(&folder, None).unwrap();
        folder
    }

    #[test]
    fn files_keep_their_places_relative_to_each_other() {
        let (world, work) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let folder = written(work.path());
        // The height map is outside the folder of the scene.
        fs::create_dir(work.path().join("maps")).unwrap();
        fs::rename(folder.join("height.png"), work.path().join("maps/height.png")).unwrap();
        let text = fs::read_to_string(folder.join("scene.toml")).unwrap();
        assert!(text.contains("\"height.png\""), "{text}");
        fs::write(folder.join("scene.toml"), text.replace("\"height.png\"", "\"../maps/height.png\"")).unwrap();
        let scene = scenes::load(folder.join("scene.toml")).unwrap();
        let source = SceneSource::of(&scene, world.path());
        assert_eq!(source.kept.as_deref(), Some(Path::new("source/scenes/scene.toml")));
        fs::write(world.path().join("scene"), source.text()).unwrap();
        drop(work);
        let loaded = SceneSource::read(world.path()).unwrap().load(world.path()).unwrap();
        assert_eq!((name_of(&loaded), &loaded.height_png), (name_of(&scene), &scene.height_png));
        assert_eq!(fs::read_dir(world.path()).unwrap().count(), 2, "nothing else is left");
    }

    #[test]
    fn files_that_have_changed_since_are_not_kept() {
        let (world, work) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let folder = written(work.path());
        let file = folder.join("scene.toml");
        let scene = scenes::load(&file).unwrap();
        let text = fs::read_to_string(&file).unwrap();
        fs::write(&file, text.replacen("seed = ", "seed = 1", 1)).unwrap();
        assert_ne!(fs::read_to_string(&file).unwrap(), text);
        assert_eq!(SceneSource::of(&scene, world.path()).kept, None);
        assert_eq!(fs::read_dir(world.path()).unwrap().count(), 0, "nothing is left");
    }
}
