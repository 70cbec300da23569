//! Zarr v3, written by `zarrs`: a store that `xarray.open_zarr` opens, with coordinates, units and attributes after the CF conventions.
//!
//! Values are chunked along time and over the land, and compressed by zstd. Chunks of grass at rest are left out: they are zeros. Every [`FRAMES_PER_COMMIT`]
//! frames, and at the end, the arrays get their new lengths, also in the consolidated metadata of the root, which is written last: a store can be read up to
//! there while it is written.

use super::error::OutputError;
use super::grids::{Axis, Grid};
use super::replace::new_folder;
use super::rounding::{rounded, step};
use super::run_folder::{METADATA, RunFolder};
use super::sampler::{Frame, Sampler, VALUES_LIMIT};
use super::sink::Sink;
use super::variables::{Field, VARIABLES, Variable};
use crate::scenes::LoadedScene;
use prairie_core::scene::{Scene, WindTiling};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use zarrs::array::codec::ZstdCodec;
use zarrs::array::{Array, ArrayBuilder, ArrayMetadataOptions, ArraySubset, Element, data_type};
use zarrs::group::GroupBuilder;
use zarrs::metadata::v3::AdditionalFieldV3;

/// Frames after which the arrays get their new lengths; a multiple of the frames of every chunk.
pub const FRAMES_PER_COMMIT: usize = 16;

/// File by which the store of an earlier run is known: other stores have variables of the same names.
const MARK: &str = ".prairie-zarr";

/// Values of a variable that are held in memory until they are a chunk, at most (bytes).
const HELD_BYTES: usize = 1 << 20;

/// Side of a chunk along Z and X, about (cells).
const CHUNK_CELLS: usize = 256;

/// Times in a chunk of the time coordinate.
const TIMES_PER_CHUNK: u64 = 1024;

/// Level of zstd: higher ones take several times as long for a few percent.
const ZSTD_LEVEL: i32 = 1;

/// The errors to which fields may be rounded, in their units; the others are stored to the bit.
pub type Errors = BTreeMap<Field, f32>;

/// A store that grows along time.
pub struct ZarrStore {
    path: PathBuf,
    root: Root,
    columns: Vec<Column>,
    times: Array<RunFolder>,
    /// Times that are not yet in the store.
    new_times: Vec<f64>,
    /// Number of frames that are in the store.
    committed: usize,
    /// Whether a write has failed.
    has_failed: bool,
}

/// The group that holds all arrays.
struct Root {
    store: Arc<RunFolder>,
    attributes: Map<String, Value>,
    /// Metadata of the arrays, by their names.
    arrays: Map<String, Value>,
}

/// A variable of the store.
struct Column {
    array: Array<RunFolder>,
    frames_per_chunk: usize,
    /// Distance between rounded values; `None` if all bits are kept.
    step: Option<f32>,
    /// Values that are not yet in the store, and the number of frames that are.
    held: Vec<f32>,
    written: usize,
}

impl ZarrStore {
    /// A store without frames: coordinates, the height of the ground, and the attributes of the run.
    ///
    /// # Errors
    /// When there is something at `path`, unless it is a store and `overwrite`; when it cannot be written.
    pub fn create(path: &Path, loaded: &LoadedScene, sampler: &Sampler, errors: &Errors, overwrite: bool) -> Result<Self, OutputError> {
        let names: Vec<_> = VARIABLES.iter().map(|variable| variable.name).collect();
        let coordinates: Vec<_> = Grid::ALL.iter().flat_map(|grid| grid.axes(&loaded.scene)).map(|axis| axis.name).collect();
        let is_ours = |name: &str| {
            [MARK, METADATA, "zarr.json.new", "time", "ground_height"].contains(&name)
                || names.contains(&name)
                || coordinates.contains(&name)
        };
        new_folder(path, overwrite, "Zarr store", MARK, is_ours)?;
        let mark = path.join(MARK);
        let about = format!("Zarr store of the scene {} by Prairie {}\n", loaded.name, env!("CARGO_PKG_VERSION"));
        std::fs::write(&mark, about).map_err(OutputError::file(&mark))?;
        let failed = |reason: &dyn Display| OutputError::Zarr { path: path.to_owned(), reason: reason.to_string() };
        let store = Arc::new(RunFolder::new(path).map_err(|error| failed(&error))?);
        let mut root = Root { store: Arc::clone(&store), attributes: attributes_of_run(loaded, errors), arrays: Map::new() };
        root.write().map_err(|error| failed(&error))?;
        let writer = Writer { path, store, scene: &loaded.scene };
        let ground_height = writer.ground_height(loaded)?;
        writer.coordinates(sampler)?.iter().chain(&ground_height).for_each(|array| root.note(array));
        let times = writer.times()?;
        let columns = sampler.variables().map(|variable| writer.column(variable, errors)).collect::<Result<_, _>>()?;
        let mut store = Self { path: path.to_owned(), root, columns, times, new_times: Vec::new(), committed: 0, has_failed: false };
        store.write_lengths()?;
        Ok(store)
    }

    fn failed(&self, reason: impl Display) -> OutputError {
        OutputError::Zarr { path: self.path.clone(), reason: reason.to_string() }
    }

    /// Takes a frame.
    fn add(&mut self, frame: &Frame) -> Result<(), OutputError> {
        for (number, values) in frame.values.iter().enumerate() {
            self.columns[number].add(values).map_err(|reason| self.failed(reason))?;
        }
        self.new_times.push(frame.time_secs);
        if self.new_times.len() == FRAMES_PER_COMMIT { self.commit() } else { Ok(()) }
    }

    /// Writes what is held, and then the new lengths.
    fn commit(&mut self) -> Result<(), OutputError> {
        let frames = self.committed + self.new_times.len();
        for number in 0..self.columns.len() {
            self.columns[number].flush().map_err(|reason| self.failed(reason))?;
        }
        self.append_times(frames).map_err(|reason| self.failed(reason))?;
        self.committed = frames;
        self.write_lengths()
    }

    /// Writes the lengths of the arrays, those of the root last.
    fn write_lengths(&mut self) -> Result<(), OutputError> {
        for array in self.columns.iter().map(|column| &column.array).chain([&self.times]) {
            array.store_metadata_opt(&plain()).map_err(|error| self.failed(error))?;
            self.root.note(array);
        }
        self.root.write().map_err(|reason| self.failed(reason))
    }

    fn append_times(&mut self, frames: usize) -> Result<(), String> {
        self.times.set_shape(vec![frames as u64]).map_err(text)?;
        let place = self.committed as u64..frames as u64;
        let times = std::mem::take(&mut self.new_times);
        self.times.store_array_subset(&ArraySubset::new_with_ranges(std::slice::from_ref(&place)), &times).map_err(text)
    }
}

impl Sink for ZarrStore {
    fn write(&mut self, frame: &Frame) -> Result<(), OutputError> {
        let added = self.add(frame);
        self.has_failed |= added.is_err();
        added
    }

    /// After a failure the store keeps the lengths that it had: further frames may be incomplete.
    fn finish(mut self: Box<Self>) -> Result<(), OutputError> {
        if self.has_failed || self.new_times.is_empty() { Ok(()) } else { self.commit() }
    }
}

impl Root {
    /// Takes the metadata of an array.
    fn note(&mut self, array: &Array<RunFolder>) {
        let name = array.path().as_str().trim_start_matches('/').to_owned();
        self.arrays.insert(name, json!(array.metadata()));
    }

    /// Writes the attributes, and the metadata of all arrays in one, so that readers open one file and find equal lengths in it.
    fn write(&self) -> Result<(), String> {
        let consolidated = AdditionalFieldV3::new(json!({ "kind": "inline", "metadata": self.arrays }), false);
        let mut group = GroupBuilder::new();
        group.attributes(self.attributes.clone());
        group.additional_fields([("consolidated_metadata".to_owned(), consolidated)].into_iter().collect());
        group.build(Arc::clone(&self.store), "/").map_err(text)?.store_metadata().map_err(text)
    }
}

impl Column {
    /// Takes the values of a frame, and writes them once they are a chunk.
    fn add(&mut self, values: &[f32]) -> Result<(), String> {
        match self.step {
            Some(step) => self.held.extend(values.iter().map(|value| rounded(*value, step))),
            None if self.frames_per_chunk == 1 => return self.store(values),
            None => self.held.extend_from_slice(values),
        }
        if self.held.len() == values.len() * self.frames_per_chunk { self.flush() } else { Ok(()) }
    }

    /// Writes the values that are held.
    fn flush(&mut self) -> Result<(), String> {
        let mut held = std::mem::take(&mut self.held);
        if !held.is_empty() {
            self.store(&held)?;
        }
        held.clear();
        self.held = held;
        Ok(())
    }

    /// Writes the values of whole frames behind those in the store.
    fn store(&mut self, values: &[f32]) -> Result<(), String> {
        let mut shape = self.array.shape().to_vec();
        let frames = values.len() / shape[1..].iter().product::<u64>() as usize;
        shape[0] = (self.written + frames) as u64;
        let ranges: Vec<_> = std::iter::once(self.written as u64..shape[0]).chain(shape[1..].iter().map(|count| 0..*count)).collect();
        self.array.set_shape(shape).map_err(text)?;
        self.array.store_array_subset(&ArraySubset::new_with_ranges(&ranges), values).map_err(text)?;
        self.written += frames;
        Ok(())
    }
}

/// Makes the arrays of a store.
struct Writer<'a> {
    path: &'a Path,
    store: Arc<RunFolder>,
    scene: &'a Scene,
}

impl Writer<'_> {
    fn failed(&self, reason: impl Display) -> OutputError {
        OutputError::Zarr { path: self.path.to_owned(), reason: reason.to_string() }
    }

    fn built(&self, builder: &mut ArrayBuilder, name: &str) -> Result<Array<RunFolder>, OutputError> {
        builder.bytes_to_bytes_codecs(vec![Arc::new(ZstdCodec::new(ZSTD_LEVEL, false))]);
        let array = builder.build(Arc::clone(&self.store), &format!("/{name}")).map_err(|error| self.failed(error))?;
        array.store_metadata_opt(&plain()).map_err(|error| self.failed(error))?;
        Ok(array)
    }

    fn filled<T: Element>(&self, builder: &mut ArrayBuilder, name: &str, values: &[T]) -> Result<Array<RunFolder>, OutputError> {
        let array = self.built(builder, name)?;
        array.store_array_subset(&array.subset_all(), values).map_err(|error| self.failed(error))?;
        Ok(array)
    }

    /// Coordinates of the grids that the sampler's variables and the ground use.
    fn coordinates(&self, sampler: &Sampler) -> Result<Vec<Array<RunFolder>>, OutputError> {
        let is_used = |grid: &Grid| *grid == Grid::Grass || sampler.variables().any(|variable| variable.field.grid() == *grid);
        let axes = Grid::ALL.into_iter().filter(is_used).flat_map(|grid| grid.axes(self.scene));
        let coordinate = |axis: Axis| {
            let count = axis.count as u64;
            let mut builder = ArrayBuilder::new(vec![count], vec![count], data_type::float64(), f64::NAN);
            builder.dimension_names(Some([axis.name])).attributes(attributes_of_axis(&axis));
            self.filled(&mut builder, axis.name, &axis.centers_m())
        };
        axes.map(coordinate).collect()
    }

    /// The elevation of the ground; `None` where the land has more cells than a variable may have.
    fn ground_height(&self, loaded: &LoadedScene) -> Result<Option<Array<RunFolder>>, OutputError> {
        let [south, east] = Grid::Grass.axes(self.scene)[..] else { unreachable!("grass has two axes") };
        if south.count.saturating_mul(east.count) > VALUES_LIMIT {
            tracing::warn!(
                "the land has {} × {} cells; its height is left out, since a variable has at most {VALUES_LIMIT}",
                south.count,
                east.count
            );
            return Ok(None);
        }
        let meters = |cell: usize, axis: &Axis| (cell as f32 + 0.5) * axis.spacing_m;
        let places = (0..south.count).flat_map(|j| (0..east.count).map(move |i| (i, j)));
        let heights_m: Vec<f32> = places.map(|(i, j)| loaded.height.height_m(meters(i, &east), meters(j, &south))).collect();
        let attributes = json!({ "units": "m", "standard_name": "surface_altitude", "long_name": "elevation of the ground" });
        let (shape, chunks) = (shape(&[south, east]), self.chunk(&[south, east]));
        let mut builder = ArrayBuilder::new(shape, chunks, data_type::float32(), f32::NAN);
        builder.dimension_names(Some([south.name, east.name])).attributes(map(attributes));
        self.filled(&mut builder, "ground_height", &heights_m).map(Some)
    }

    fn times(&self) -> Result<Array<RunFolder>, OutputError> {
        let attributes = json!({ "units": "s", "standard_name": "time", "long_name": "simulated time since the start", "axis": "T" });
        let mut builder = ArrayBuilder::new(vec![0], vec![TIMES_PER_CHUNK], data_type::float64(), f64::NAN);
        builder.dimension_names(Some(["time"])).attributes(map(attributes));
        self.built(&mut builder, "time")
    }

    fn column(&self, variable: &Variable, errors: &Errors) -> Result<Column, OutputError> {
        let axes = variable.field.grid().axes(self.scene);
        let frame_bytes = size_of::<f32>() * axes.iter().map(|axis| axis.count).product::<usize>();
        let fitting = (HELD_BYTES / frame_bytes).clamp(1, FRAMES_PER_COMMIT);
        // The largest power of two that fits.
        let frames_per_chunk = 1 << fitting.ilog2();
        let error = errors.get(&variable.field).copied();
        let with_time = |first: u64, others: Vec<u64>| std::iter::once(first).chain(others).collect::<Vec<_>>();
        let (shape, chunks) = (with_time(0, shape(&axes)), with_time(frames_per_chunk, self.chunk(&axes)));
        let mut builder = ArrayBuilder::new(shape, chunks, data_type::float32(), 0.0_f32);
        builder.dimension_names(Some(std::iter::once("time").chain(axes.iter().map(|axis| axis.name))));
        builder.attributes(attributes_of_variable(variable, error));
        let array = self.built(&mut builder, variable.name)?;
        Ok(Column { array, frames_per_chunk: frames_per_chunk as usize, step: error.map(step), held: Vec::new(), written: 0 })
    }

    /// Shape of a chunk: whole patches of grass, and all of smaller grids.
    fn chunk(&self, axes: &[Axis]) -> Vec<u64> {
        let patch = self.scene.patches.cells as usize;
        let side = patch * (CHUNK_CELLS / patch).max(1);
        axes.iter().map(|axis| axis.count.min(side) as u64).collect()
    }
}

fn shape(axes: &[Axis]) -> Vec<u64> {
    axes.iter().map(|axis| axis.count as u64).collect()
}

fn text(error: impl Display) -> String {
    error.to_string()
}

fn map(value: Value) -> Map<String, Value> {
    match value {
        Value::Object(map) => map,
        _ => Map::new(),
    }
}

/// Metadata without attributes about the library that writes them.
fn plain() -> ArrayMetadataOptions {
    ArrayMetadataOptions::default().with_include_zarrs_metadata(false)
}

fn attributes_of_run(loaded: &LoadedScene, errors: &Errors) -> Map<String, Value> {
    let scene = &loaded.scene;
    let errors: Vec<_> = errors.iter().map(|(field, error)| format!("{field}: at most {error}")).collect();
    let box_is = match scene.wind.tiling {
        WindTiling::Patch => "The box of the wind is repeated in every patch, each time shifted by another number of cells.",
        WindTiling::Box | WindTiling::Follow => "The box of the wind repeats where it is periodic and smaller than the land.",
    };
    map(json!({
        "Conventions": "CF-1.11",
        "title": format!("Prairie: {}", scene.summary),
        "source": concat!("Prairie ", env!("CARGO_PKG_VERSION")),
        "references": env!("CARGO_PKG_REPOSITORY"),
        "scene": loaded.name,
        "seed": scene.seed,
        "tick_hz": scene.tick_hz,
        "error": if errors.is_empty() { "none: all bits are those of the simulation".to_owned() } else { errors.join("; ") },
        "comment": format!("X points east, Z south, Y up from the ground. Values belong to the centres of cells. {box_is}"),
    }))
}

fn attributes_of_axis(axis: &Axis) -> Map<String, Value> {
    let mut attributes = map(json!({ "units": "m", "long_name": axis.long_name, "axis": axis.cf_axis }));
    if axis.cf_axis == "Z" {
        attributes.extend(map(json!({ "standard_name": "height", "positive": "up" })));
    }
    attributes
}

fn attributes_of_variable(variable: &Variable, error: Option<f32>) -> Map<String, Value> {
    let mut attributes = map(json!({ "units": variable.units, "long_name": variable.long_name }));
    attributes.extend(variable.standard_name.map(|name| ("standard_name".to_owned(), json!(name))));
    attributes.insert("absolute_error".to_owned(), json!(error.unwrap_or(0.0)));
    if let Some(error) = error {
        attributes.insert("comment".to_owned(), json!(format!("rounded to multiples of {}", step(error))));
    }
    attributes
}
