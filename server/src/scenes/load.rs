//! Loading of a scene with its maps and models.

use super::builtin::BuiltIn;
use super::error::{FaultyScene, SceneError};
use super::loaded::{LoadedScene, OpenScene};
use crate::escaped::escaped;
use crate::file;
use crate::objects::built_in_models;
use crate::objects::gltf::{self, Model};
use crate::settings_error::SettingsError;
use crate::world;
use prairie_core::grass::wind_drawing::{WindDrawing, WindDrawings};
use prairie_core::plant::growth::NutrientMap;
use prairie_core::scene::{Positions, Scene, SceneFault, VehicleKind, WindShape, parse, parse_underbrush, parse_with, stated_fields};
use prairie_core::terrain::{
    Cover, CoverMap, HeightMap, MODEL_BOXES_LIMIT, MODEL_PIXELS_LIMIT, MapError, clear_under_models, has_too_many_models,
};
use prairie_core::wire::{Mesh, ModelUse};
use std::cell::{LazyCell, RefCell};
use std::collections::HashSet;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Largest scene file and largest underbrush file (bytes).
const SCENE_LIMIT: u64 = 1 << 20;

/// Largest map file (bytes); three maps and two models fit into a message.
pub(crate) const MAP_LIMIT: u64 = 24 << 20;

/// Largest file of a drawn wind (bytes), more than the largest allowed picture needs.
const DRAWING_LIMIT: u64 = 4 << 20;

/// Lowest and highest allowed elevation (m).
const ELEVATION_RANGE_M: [f32; 2] = [-20_000.0, 20_000.0];

/// Loads a built-in scene by name, or a scene file by path, with its maps and models. Settings that its tolerances and budgets leave open are
/// [planned](crate::plan), which may take a minute the first time.
///
/// # Errors
/// [`SceneError`]: the name is unknown, the file cannot be read, or it contains faults. All faults of the scene file are reported at once; if there
/// are none, those of its underbrush file; if there are none, those of its maps and models.
pub fn load(name_or_path: impl AsRef<OsStr>) -> Result<LoadedScene, SceneError> {
    Ok(load_open(name_or_path)?.planned())
}

/// Loads a scene as its file has it, without a plan.
///
/// # Errors
/// As [`load`].
pub fn load_open(name_or_path: impl AsRef<OsStr>) -> Result<OpenScene, SceneError> {
    let name = name_or_path.as_ref();
    if let Some(built_in) = name.to_str().and_then(BuiltIn::find) {
        return load_text(built_in.name, built_in.text, Source::BuiltIn(built_in));
    }
    let path = Path::new(name);
    let looks_like_a_file = path.extension().is_some() || path.components().count() > 1 || path.exists();
    if !looks_like_a_file {
        return Err(unknown(name));
    }
    let unreadable = |reason: String| SceneError::Unreadable { path: path.to_owned(), reason };
    let text = file::read(path, SCENE_LIMIT).and_then(utf8).map_err(unreadable)?;
    let folder = path.parent().unwrap_or(Path::new("")).to_owned();
    let source = Source::Folder { folder, read: RefCell::new(vec![path.to_owned()]) };
    let mut open = load_text(&escaped(name), &text, source)?;
    open.loaded.name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(open)
}

fn utf8(bytes: Vec<u8>) -> Result<String, String> {
    String::from_utf8(bytes).map_err(|error| format!("it is not UTF-8 text: {error}"))
}

fn unknown(name: &OsStr) -> SceneError {
    let known = BuiltIn::names();
    SceneError::Unknown { name: name.to_owned(), nearest: most_similar(name, known.iter().copied()), known }
}

/// The word among those `known` that was probably meant by `word`; `None` if none is similar.
pub fn most_similar<'k>(word: &OsStr, known: impl Iterator<Item = &'k str>) -> Option<&'k str> {
    let word = word.to_string_lossy();
    let similar = known.map(|known| (strsim::jaro_winkler(known, &word), known)).filter(|(likeness, _)| *likeness > 0.7);
    similar.max_by(|one, other| one.0.total_cmp(&other.0)).map(|(_, known)| known)
}

/// Source of a scene's files.
enum Source {
    BuiltIn(&'static BuiltIn),
    /// A folder, and the files read so far.
    Folder {
        folder: PathBuf,
        read: RefCell<Vec<PathBuf>>,
    },
}

impl Source {
    fn read(&self, name: &str, limit: u64) -> Result<Vec<u8>, String> {
        match self {
            Self::BuiltIn(scene) => scene.file(name).map(<[u8]>::to_vec).ok_or_else(|| "it is not embedded in the program".to_owned()),
            Self::Folder { .. } => file::read(&self.path(name), limit),
        }
    }

    /// Returns and records the path of a file that is about to be read.
    fn path(&self, name: &str) -> PathBuf {
        match self {
            Self::BuiltIn(_) => PathBuf::from(name),
            Self::Folder { folder, read } => {
                let path = folder.join(name);
                read.borrow_mut().push(path.clone());
                path
            }
        }
    }

    /// The mesh of a vehicle's model.
    fn model(&self, name: &str, half_extents_m: [f32; 3]) -> Result<Mesh, String> {
        let model = gltf::read(&self.path(name), half_extents_m).map_err(|error| error.reason.to_string())?;
        Ok(self.recorded(model))
    }

    /// The mesh and the size (m) of a model of the covering map, built in or from a file.
    fn cover_model(&self, name: &str, size_m: [f32; 3]) -> Result<(Mesh, [f32; 3]), String> {
        if let Some(mesh) = built_in_models::find(name) {
            return gltf::stretched(mesh, size_m).map_err(|fault| fault.to_string());
        }
        if Path::new(name).extension().is_none() {
            let built_in = built_in_models::NAMES.map(|known| format!("`{known}`")).join(", ");
            return Err(format!("is not a built-in model; allowed: {built_in}, or a glTF file (.glb or .gltf)"));
        }
        let (model, size_m) = gltf::read_stretched(&self.path(name), size_m).map_err(|error| error.reason.to_string())?;
        Ok((self.recorded(model), size_m))
    }

    /// The mesh of a model; the files of its buffers count as read.
    fn recorded(&self, Model { mesh, buffer_files }: Model) -> Mesh {
        if let Self::Folder { read, .. } = self {
            read.borrow_mut().extend(buffer_files);
        }
        mesh
    }

    /// Files that have been read, without duplicates.
    fn into_files(self) -> Vec<PathBuf> {
        match self {
            Self::BuiltIn(_) => Vec::new(),
            Self::Folder { read, .. } => {
                let mut known = HashSet::new();
                read.into_inner().into_iter().filter(|path| known.insert(path.clone())).collect()
            }
        }
    }
}

/// The error for a file with `faults`, sorted by line.
fn faulty(file: &str, text: &str, mut faults: Vec<SceneFault>) -> SceneError {
    faults.sort_by_key(|fault| (fault.line, fault.column));
    SceneError::Faulty(FaultyScene { file: file.to_owned(), text: text.to_owned(), faults })
}

/// Parses the scene with the species of its underbrush file.
fn parse_scene(file: &str, text: &str, source: &Source) -> Result<Scene, SceneError> {
    let scene = parse(text).map_err(|faults| faulty(file, text, faults))?;
    let name = &scene.underbrush_file;
    if name.is_empty() {
        return Ok(scene);
    }
    let unreadable = |reason| {
        let message = format!("names `{name}`, which cannot be read: {reason}");
        faulty(file, text, vec![SceneFault::at(text, "underbrush_file", message)])
    };
    let species_text = source.read(name, SCENE_LIMIT).and_then(utf8).map_err(unreadable)?;
    let species_file = escaped(source.path(name));
    let species = parse_underbrush(&species_text).map_err(|faults| faulty(&species_file, &species_text, faults))?;
    parse_with(text, species).map_err(|faults| faulty(file, text, faults))
}

fn load_text(file: &str, text: &str, source: Source) -> Result<OpenScene, SceneError> {
    let mut scene = parse_scene(file, text, &source)?;
    let mut faults = Vec::new();
    let positions = LazyCell::new(|| Positions::new(text));
    let mut note = |path: &str, message: String| faults.push(positions.at(path, message));

    for SettingsError { field, message } in world::check(&scene) {
        note(&field, message);
    }
    let height = height_map(&scene, &source).map_err(|message| note("terrain.height_map", message)).ok();
    let cover = covering_map(&scene, &source).map_err(|message| note("terrain.covering_map", message)).ok();
    let nutrients = nutrient_map(&scene, &source).map_err(|message| note("growth.nutrient_map", message)).ok();
    let mut loaded_models = Vec::new();
    for (path, model) in vehicle_models(&mut scene, &source).into_iter().chain(cover_models(&mut scene, &source)) {
        match model {
            Ok(model) => loaded_models.push(model),
            Err(reason) => note(&path, reason),
        }
    }
    let mut drawings = WindDrawings::new();
    for (path, shape) in wind_shapes(&mut scene) {
        let WindShape::Drawn(name) = shape else { continue };
        match drawing(name, &source) {
            Ok(drawing) => {
                let number = format!("{}.png", drawings.len() + 1);
                *name = number.clone();
                drawings.insert(number, Arc::new(drawing));
            }
            Err(reason) => note(&path, format!("names `{name}`, which {reason}")),
        }
    }
    let (Some((height_png, height)), Some((covering_png, cover)), Some((nutrient_png, nutrients)), []) =
        (height, cover, nutrients, faults.as_slice())
    else {
        return Err(faulty(file, text, faults));
    };
    let mut cover = cover;
    clear_under_models(&scene, &mut cover);
    let Scene { terrain, growth, underbrush_file, .. } = &mut scene;
    for path in [&mut terrain.height_map, &mut terrain.covering_map, &mut growth.nutrient_map, underbrush_file] {
        path.clear();
    }
    let loaded = LoadedScene {
        name: file.to_owned(),
        scene,
        height_png,
        covering_png,
        nutrient_png,
        height,
        cover,
        nutrients: nutrients.map(Arc::new),
        drawings,
        models: loaded_models,
        files: source.into_files(),
        explanation: Arc::default(),
    };
    Ok(OpenScene { loaded, stated: stated_fields(text) })
}

/// Fields that name a model, each with what it names. Clients get the models as meshes, without the file names.
type NamedModels = Vec<(String, Result<(ModelUse, Mesh), String>)>;

/// The models of vehicles.
fn vehicle_models(scene: &mut Scene, source: &Source) -> NamedModels {
    let mut models = Vec::new();
    for kind in VehicleKind::ALL {
        let name = scene.objects.model_file_mut(kind).map(std::mem::take).unwrap_or_default();
        if !name.is_empty() {
            let mesh = source.model(&name, scene.objects.half_extents_m(kind));
            let model = mesh.map(|mesh| (ModelUse::Vehicle(kind), mesh)).map_err(|reason| format!("names `{name}`, which {reason}"));
            models.push((format!("objects.{}_model", kind.name()), model));
        }
    }
    models
}

/// The models of the covering map, whose sizes are set.
fn cover_models(scene: &mut Scene, source: &Source) -> NamedModels {
    let models = scene.models.iter_mut().enumerate().map(|(i, model)| {
        let name = std::mem::take(&mut model.model);
        let loaded = source.cover_model(&name, model.size_m).map(|(mesh, size_m)| {
            model.size_m = size_m;
            (ModelUse::Cover(i as u8), mesh)
        });
        (format!("models[{i}].model"), loaded.map_err(|reason| format!("names `{name}`, which {reason}")))
    });
    models.collect()
}

/// Every field of a scene that may name a picture of a wind, with its path.
fn wind_shapes(scene: &mut Scene) -> Vec<(String, &mut WindShape)> {
    let winds = scene.drawn_winds.iter_mut().enumerate().map(|(i, wind)| (format!("drawn_winds[{i}].shape"), &mut wind.shape));
    let wash = ("objects.helicopter.wash_shape".to_owned(), &mut scene.objects.helicopter.wash_shape);
    winds.chain([wash]).collect()
}

fn drawing(name: &str, source: &Source) -> Result<WindDrawing, String> {
    let png = source.read(name, DRAWING_LIMIT).map_err(|reason| format!("cannot be read: {reason}"))?;
    WindDrawing::from_png(&png).map_err(|error| error.to_string())
}

/// Reads and decodes a map file.
fn map<M>(name: &str, source: &Source, decode: impl FnOnce(&[u8]) -> Result<M, MapError>) -> Result<(Vec<u8>, M), String> {
    let png = source.read(name, MAP_LIMIT).map_err(|reason| format!("names `{name}`, which cannot be read: {reason}"))?;
    let map = decode(&png).map_err(|error| format!("names `{name}`, which {error}"))?;
    Ok((png, map))
}

fn height_map(scene: &Scene, source: &Source) -> Result<(Vec<u8>, HeightMap), String> {
    let name = &scene.terrain.height_map;
    let (png, map) = map(name, source, |png| HeightMap::from_png(png, &scene.terrain))?;

    let [columns, rows] = map.size_px();
    let map_m = [columns as f32 * scene.terrain.pixel_m[0], rows as f32 * scene.terrain.pixel_m[1]];
    let world_m = scene.extent_m();
    if map_m[0] < world_m[0] || map_m[1] < world_m[1] {
        return Err(format!(
            "names `{name}`, which covers {} m × {} m ({columns} × {rows} pixels × pixel_m); allowed: at least the size of the world, {} m × {} m \
             (patches: count × cells × cell_m). Use more pixels, a larger pixel_m or a smaller world",
            map_m[0], map_m[1], world_m[0], world_m[1]
        ));
    }
    let [low, high] = map.range_m();
    if low < ELEVATION_RANGE_M[0] || high > ELEVATION_RANGE_M[1] {
        let [lowest, highest] = ELEVATION_RANGE_M;
        return Err(format!("names `{name}`, which has elevations from {low} m to {high} m; allowed: {lowest} to {highest} m"));
    }
    Ok((png, map))
}

fn covering_map(scene: &Scene, source: &Source) -> Result<(Vec<u8>, CoverMap), String> {
    let name = &scene.terrain.covering_map;
    let (png, map) = map(name, source, CoverMap::from_png)?;
    let has_meanings = !(scene.species.is_empty() && scene.models.is_empty());
    if let Some(([column, row], id)) = map.find(|id| has_meanings && is_unknown(scene, id)) {
        let grass = scene.species.iter().map(|species| (species.cover, &species.name));
        let underbrush = scene.underbrush.iter().filter(|species| species.cover > 0).map(|species| (species.cover, &species.name));
        let species: Vec<_> = grass.chain(underbrush).map(|(cover, name)| format!("{cover} ({name})")).collect();
        if !scene.models.is_empty() {
            let models = scene.models.iter().map(|model| format!("{} ({})", model.cover, model.name));
            return Err(format!(
                "names `{name}`, which has the ID {id} at column {column} of row {row}, and no species or model has this ID; allowed: 0 (gap), 253 (tree), \
                 254 (stone), 255 (grass) or the ID of a species or model: {}",
                species.into_iter().chain(models).collect::<Vec<_>>().join(", ")
            ));
        }
        return Err(format!(
            "names `{name}`, which has the ID {id} at column {column} of row {row}, and no species has this ID; allowed: 0 (gap), 253 (tree), 254 (stone), \
             255 (grass) or the ID of a species: {}",
            species.join(", ")
        ));
    }
    if has_too_many_models(scene, &map) {
        return Err(format!(
            "names `{name}`, which places too many models; allowed: at most {MODEL_BOXES_LIMIT}, with {MODEL_PIXELS_LIMIT} pixels in the rectangles around \
             them. Paint fewer pixels, or raise their `apart_m`"
        ));
    }
    Ok((png, map))
}

/// Reads the nutrient map; empty and `None` if the nutrients are generated.
fn nutrient_map(scene: &Scene, source: &Source) -> Result<(Vec<u8>, Option<NutrientMap>), String> {
    let name = &scene.growth.nutrient_map;
    if name.is_empty() { Ok((Vec::new(), None)) } else { map(name, source, |png| NutrientMap::from_png(png).map(Some)) }
}

/// Whether an ID in the covering map has no meaning in the scene.
fn is_unknown(scene: &Scene, id: u8) -> bool {
    let cover = Cover::from(id);
    matches!(cover, Cover::Free(_)) && !scene.is_grass(cover) && scene.models.iter().all(|model| model.cover != id)
}
