//! Writing of a new scene, with its maps and schema, into a folder of its own.

use super::builtin::BuiltIn;
use super::load::most_similar;
use super::maps;
use crate::escaped::escaped;
use crate::file::unique_part;
use prairie_core::scene::SCHEMA;
use std::borrow::Cow;
use std::ffi::{OsStr, OsString};
use std::fs;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Scene of [`create`] by default.
const STARTER: &str = include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/starter/scene.toml"));

/// Name of the scene file in a new folder.
const SCENE_FILE: &str = "scene.toml";

/// Name of the schema in a new folder, and the line of a scene by which editors with Taplo find it.
const SCHEMA_FILE: &str = "scene.schema.json";
const SCHEMA_LINE: &str = "#:schema ./scene.schema.json\n";

/// Reasons why a new scene is not written.
#[derive(Debug, Error)]
pub enum CreateError {
    /// There is no such built-in scene.
    #[error("there is no built-in scene `{}`{}; allowed: {}", escaped(.name), .nearest.map_or_else(String::new, |name| format!(" (did you mean `{name}`?)")), .known.join(", "))]
    Unknown {
        /// The requested name.
        name: String,
        /// The built-in scene with the most similar name, if any is similar.
        nearest: Option<&'static str>,
        /// Names of all built-in scenes.
        known: Vec<&'static str>,
    },
    /// The folder contains something.
    #[error("the folder `{}` is not empty, it contains `{}`; allowed: a new folder or an empty one", escaped(.folder), escaped(.entry))]
    NotEmpty {
        /// The folder.
        folder: PathBuf,
        /// Something in it.
        entry: OsString,
    },
    /// The path exists and is not a folder.
    #[error("`{}` exists and is not a folder; allowed: a new folder or an empty one", escaped(.0))]
    NotFolder(PathBuf),
    /// The folder around the new one does not exist.
    #[error("the folder `{}` cannot be created, since `{}` does not exist; allowed: a new folder in an existing one, or an empty one", escaped(.folder), escaped(.parent))]
    NoParent {
        /// The new folder.
        folder: PathBuf,
        /// The folder around it.
        parent: PathBuf,
    },
    /// Reading or writing failed.
    #[error("the scene cannot be written to `{}`: {reason}", escaped(.folder))]
    Failed {
        /// The folder.
        folder: PathBuf,
        /// The reason.
        reason: io::Error,
    },
}

/// Writes a scene to start from, with its maps and the schema, into a new or empty `folder`: the built-in scene `from`, or by default a commented scene
/// that is made for changes. Returns the files, the scene file first.
///
/// All files are written beside their places and then moved there, so that a failure leaves nothing behind.
///
/// # Errors
/// [`CreateError`]: there is no such built-in scene, the folder is not empty, or it cannot be written.
pub fn create(folder: &Path, from: Option<&str>) -> Result<Vec<PathBuf>, CreateError> {
    let files = files(from)?;
    let failed = |reason| CreateError::Failed { folder: folder.to_owned(), reason };
    let is_new = match fs::metadata(folder) {
        Ok(found) if !found.is_dir() => return Err(CreateError::NotFolder(folder.to_owned())),
        Ok(_) => {
            if let Some(entry) = fs::read_dir(folder).map_err(failed)?.next() {
                let entry = entry.map_err(failed)?.file_name();
                return Err(CreateError::NotEmpty { folder: folder.to_owned(), entry });
            }
            false
        }
        Err(error) if error.kind() == ErrorKind::NotFound => true,
        Err(error) => return Err(failed(error)),
    };
    let parent = folder.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if is_new && !parent.is_dir() {
        return Err(CreateError::NoParent { folder: folder.to_owned(), parent: parent.to_owned() });
    }
    // An empty folder stays itself: it may be the current one, a link or a mount.
    let staging = Staging::new(if is_new { parent } else { folder }).map_err(failed)?;
    for (name, bytes) in &files {
        fs::write(staging.0.join(name), bytes).map_err(failed)?;
    }
    if is_new {
        fs::rename(&staging.0, folder).map_err(failed)?;
    } else {
        staging.move_files(&files, folder).map_err(failed)?;
    }
    Ok(files.iter().map(|(name, _)| folder.join(name)).collect())
}

/// A name and contents.
type NewFile = (&'static str, Cow<'static, [u8]>);

/// The files of a new scene, the scene file first.
fn files(from: Option<&str>) -> Result<Vec<NewFile>, CreateError> {
    let schema = (SCHEMA_FILE, SCHEMA.as_bytes().into());
    let Some(name) = from else {
        let maps = maps::starter().map(|map| (map.name, map.to_png().into()));
        return Ok([(SCENE_FILE, STARTER.as_bytes().into())].into_iter().chain(maps).chain([schema]).collect());
    };
    let unknown = || CreateError::Unknown {
        name: name.to_owned(),
        nearest: most_similar(OsStr::new(name), BuiltIn::names().into_iter()),
        known: BuiltIn::names(),
    };
    let built_in = BuiltIn::find(name).ok_or_else(unknown)?;
    let text = format!("{SCHEMA_LINE}{}", built_in.text).into_bytes();
    let named = built_in.files.iter().map(|&(name, bytes)| (name, bytes.into()));
    Ok([(SCENE_FILE, text.into())].into_iter().chain(named).chain([schema]).collect())
}

/// A hidden folder for files before they are complete; removed with whatever is left in it.
struct Staging(PathBuf);

impl Staging {
    fn new(around: &Path) -> io::Result<Self> {
        let folder = around.join(format!(".prairie-new-{}", unique_part()));
        fs::create_dir(&folder)?;
        Ok(Self(folder))
    }

    /// Moves the files into an existing folder, the scene file last; takes back all if one cannot be moved.
    fn move_files(&self, files: &[NewFile], folder: &Path) -> io::Result<()> {
        for (n, (name, _)) in files.iter().rev().enumerate() {
            if let Err(error) = fs::rename(self.0.join(name), folder.join(name)) {
                for (moved, _) in files.iter().rev().take(n) {
                    // Nothing more can be done about a file that cannot be removed either.
                    let _ = fs::remove_file(folder.join(moved));
                }
                return Err(error);
            }
        }
        Ok(())
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        // After a success it is empty or has another name.
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::{LoadedScene, check, list, load};
    use crate::world::{Camera, Command, World};
    use prairie_core::scene::VehicleKind;
    use prairie_core::wire::Drive;

    fn names_in(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    fn told(folder: &Path, from: Option<&str>) -> String {
        create(folder, from).unwrap_err().to_string()
    }

    #[test]
    fn every_built_in_scene_written_out_is_equal_to_itself() {
        let parent = tempfile::tempdir().unwrap();
        for (name, _) in list() {
            let folder = parent.path().join(name);
            let files = create(&folder, Some(name)).unwrap();
            let written = load(files[0].to_str().unwrap()).unwrap_or_else(|error| panic!("{error}"));
            let built_in = load(name).unwrap();
            let [own, others] = [&built_in, &written].map(|loaded| (loaded.explanation.rows.len(), loaded.explanation.left_out.clone()));
            assert!(own == others && own.0 > 2, "{name}: {own:?} and {others:?}");
            let (read, explanation) = (written.files.clone(), written.explanation.clone());
            assert!(LoadedScene { name: written.name.clone(), files: read, explanation, ..built_in } == written, "{name}");
            assert!(written.files.iter().all(|file| files.contains(file)), "{name}: {:?}", written.files);
            assert_eq!(names_in(&folder).len(), files.len(), "{name}");
        }
        assert_eq!(names_in(parent.path()).len(), list().count(), "nothing is left beside the folders");
    }

    #[test]
    fn the_starter_is_valid_and_always_the_same() {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path().join("hill");
        let files = create(&folder, None).unwrap();
        assert_eq!(names_in(&folder), ["covering.png", "height.png", "scene.schema.json", "scene.toml"]);
        let report = check(files[0].to_str().unwrap()).unwrap_or_else(|error| panic!("{error}")).to_string();
        assert!(report.contains("sedge") && report.contains(" trees, "), "{report}");
        assert!(STARTER.starts_with(SCHEMA_LINE));
        assert_eq!(fs::read_to_string(folder.join(SCHEMA_FILE)).unwrap(), SCHEMA);
        let checksum = |map: &maps::GreyMap| match &map.levels {
            maps::Levels::Eight(levels) => levels.iter().fold(0_u32, |sum, &level| sum.wrapping_mul(31).wrapping_add(u32::from(level))),
            maps::Levels::Sixteen(_) => panic!("{} has 16 bits", map.name),
        };
        assert_eq!(maps::starter().each_ref().map(checksum), [147_551_958, 1_217_785_817]);
    }

    #[test]
    fn a_car_follows_the_lane_to_the_top_of_the_hill() {
        let folder = tempfile::tempdir().unwrap();
        let loaded = load(&create(folder.path(), None).unwrap()[0]).unwrap();
        let mut world = World::new(&loaded.scene, loaded.maps()).unwrap();
        let start = Camera { client: 1, eye_m: [64.0, 8.0, 102.0] };
        world.step(&[Command::Cameras(vec![start]), Command::Spawn { client: 1, kind: VehicleKind::Car }]);
        let mut lane = [[82.0, 90.0], [98.0, 78.0], [104.0, 52.0], [86.0, 30.0], [64.0, 34.0], [73.0, 51.0]].into_iter().peekable();
        for _ in 0..3600 {
            let pose = world.snapshot().objects.into_iter().find(|pose| Some(pose.id) == world.object_of(1)).unwrap();
            let ([x, y, z], [vx, _, vz]) = (pose.position_m, pose.velocity_m_per_s);
            while lane.next_if(|to: &[f32; 2]| (to[0] - x).hypot(to[1] - z) < 6.0).is_some() {}
            let Some(to) = lane.peek() else {
                assert!(y > 10.0, "the lane ends at a height of {y} m");
                return;
            };
            let [_, turn_y, _, turn_w] = pose.rotation;
            let aside = (to[0] - x).atan2(z - to[1]) + 2.0 * turn_y.atan2(turn_w);
            let steer = aside.sin().atan2(aside.cos()).clamp(-1.0, 1.0);
            let throttle = if vx.hypot(vz) < 7.0 { 0.7 } else { 0.0 };
            world.step(&[Command::Drive { client: 1, number: 0, drive: Drive { throttle, steer, ..Drive::default() } }]);
        }
        panic!("after a minute the car is at {:?}, on its way to {:?}", world.snapshot().objects, lane.peek());
    }

    #[test]
    fn a_folder_with_anything_in_it_is_left_alone() {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path().join("full");
        fs::create_dir(&folder).unwrap();
        fs::write(folder.join("notes.txt"), "mine").unwrap();
        let full =
            format!("the folder `{}` is not empty, it contains `notes.txt`; allowed: a new folder or an empty one", folder.display());
        assert_eq!(told(&folder, None), full);
        let file = folder.join("notes.txt");
        assert_eq!(told(&file, None), format!("`{}` exists and is not a folder; allowed: a new folder or an empty one", file.display()));
        let inside = parent.path().join("no/such");
        assert!(told(&inside, None).contains("/no` does not exist; allowed: a new folder in an existing one, or an empty one"));
        assert!(told(&file.join("below"), None).contains("cannot be"), "{}", told(&file.join("below"), None));
        assert_eq!((names_in(parent.path()), names_in(&folder)), (vec!["full".to_owned()], vec!["notes.txt".to_owned()]));
    }

    #[test]
    fn an_unknown_scene_creates_nothing() {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path().join("new");
        let known = format!("allowed: {}", BuiltIn::names().join(", "));
        assert!(known.starts_with("allowed: meadow, jacksboro, "));
        assert_eq!(told(&folder, Some("medow")), format!("there is no built-in scene `medow` (did you mean `meadow`?); {known}"));
        assert_eq!(told(&folder, Some("../x")), format!("there is no built-in scene `../x`; {known}"));
        assert!(names_in(parent.path()).is_empty());
    }

    #[test]
    fn an_empty_folder_stays_itself() {
        let folder = tempfile::tempdir().unwrap();
        let created = fs::metadata(folder.path()).unwrap().permissions();
        create(folder.path(), Some("blades")).unwrap();
        assert_eq!(fs::metadata(folder.path()).unwrap().permissions(), created);
        assert_eq!(names_in(folder.path()), ["blades-covering.png", "blades-height.png", "scene.schema.json", "scene.toml"]);
    }

    #[test]
    fn a_failure_leaves_nothing_behind() {
        let parent = tempfile::tempdir().unwrap();
        let files: Vec<NewFile> = vec![("a", Cow::Borrowed(b"1")), ("b", Cow::Borrowed(b"2")), ("c", Cow::Borrowed(b"3"))];
        let folder = parent.path().join("folder");
        // The second of the moves fails, since a folder with contents has the name.
        fs::create_dir_all(folder.join("b/x")).unwrap();
        let staging = Staging::new(parent.path()).unwrap();
        files.iter().for_each(|(name, bytes)| fs::write(staging.0.join(name), bytes).unwrap());
        staging.move_files(&files, &folder).unwrap_err();
        drop(staging);
        assert_eq!((names_in(&folder), names_in(parent.path())), (vec!["b".to_owned()], vec!["folder".to_owned()]));
    }
}
