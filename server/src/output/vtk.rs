//! VTK ImageData for ParaView: a file for each grid and time, and a collection with the times.
//!
//! Values belong to the cells, not to their corners. The axes are those of the world: X east, Y up, Z south. `air.pvd` has the wind's box, whose heights are
//! above the ground; `ground.pvd` the wind at the ground, `grass.pvd` the cells of grass, both as flat pictures. Values are not rounded.

use super::error::OutputError;
use super::grids::Grid;
use super::replace::new_folder;
use super::sampler::{Frame, Sampler};
use super::sink::Sink;
use super::variables::{Field, Variable};
use crate::scenes::LoadedScene;
use data_encoding::BASE64;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use prairie_core::scene::Scene;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};

/// The file by which a folder of an earlier run is known.
const MARK: &str = "prairie-vtk.txt";
/// Start and end of a collection.
const COLLECTION: [&str; 2] =
    ["<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n<Collection>\n", "</Collection>\n</VTKFile>\n"];

/// A folder of VTK files.
pub struct VtkFolder {
    series: Vec<Series>,
    count: usize,
}

/// The files of one grid.
struct Series {
    grid: Grid,
    folder: PathBuf,
    extent: Extent,
    arrays: Vec<Array>,
    collection: File,
    /// Length of the collection before its end (bytes).
    length: u64,
}

/// Cells along X, Y and Z, 0 where the picture is flat, and their sizes (m).
#[derive(Clone, Copy)]
struct Extent {
    cells: [usize; 3],
    spacing_m: [f32; 3],
}

/// An array of a file, a scalar or a vector.
struct Array {
    field: Field,
    /// Numbers of its variables in the frame, with their axes.
    parts: Vec<(usize, Option<usize>)>,
}

impl VtkFolder {
    /// A new or empty folder, with collections that have no times yet.
    ///
    /// # Errors
    /// When the folder has files, unless they are those of an earlier run and `overwrite`; when it cannot be written.
    pub fn create(path: &Path, loaded: &LoadedScene, sampler: &Sampler, overwrite: bool) -> Result<Self, OutputError> {
        let is_series = |name: &str, grid: Grid| {
            name.strip_prefix(grid.name()).is_some_and(|rest| {
                let number = rest.strip_prefix('_').and_then(|rest| rest.strip_suffix(".vti"));
                rest == ".pvd" || number.is_some_and(|number| !number.is_empty() && number.bytes().all(|byte| byte.is_ascii_digit()))
            })
        };
        let is_ours = |name: &str| name == MARK || Grid::ALL.into_iter().any(|grid| is_series(name, grid));
        new_folder(path, overwrite, "folder of VTK files", MARK, is_ours)?;
        let mark = path.join(MARK);
        let about = format!("VTK files of the scene {} by Prairie {}\n", loaded.name, env!("CARGO_PKG_VERSION"));
        fs::write(&mark, about).map_err(OutputError::file(&mark))?;
        let variables: Vec<_> = sampler.variables().collect();
        let grids = Grid::ALL.into_iter().filter(|grid| variables.iter().any(|variable| variable.field.grid() == *grid));
        let series = grids.map(|grid| Series::create(grid, path, &loaded.scene, &variables)).collect::<Result<_, _>>()?;
        Ok(Self { series, count: 0 })
    }
}

impl Sink for VtkFolder {
    fn write(&mut self, frame: &Frame) -> Result<(), OutputError> {
        self.series.iter_mut().try_for_each(|series| series.write(self.count, frame))?;
        self.count += 1;
        Ok(())
    }

    fn finish(self: Box<Self>) -> Result<(), OutputError> {
        // Every file is complete after each frame.
        Ok(())
    }
}

impl Series {
    fn create(grid: Grid, folder: &Path, scene: &Scene, variables: &[&Variable]) -> Result<Self, OutputError> {
        let path = folder.join(format!("{}.pvd", grid.name()));
        let mut collection = File::create(&path).map_err(OutputError::file(&path))?;
        collection.write_all(COLLECTION.concat().as_bytes()).map_err(OutputError::file(&path))?;
        let fields = Field::ALL.into_iter().filter(|field| field.grid() == grid);
        let parts = |field| {
            let numbered = variables.iter().enumerate().filter(move |(_, variable)| variable.field == field);
            numbered.map(|(number, variable)| (number, variable.axis)).collect::<Vec<_>>()
        };
        let arrays = fields.map(|field| Array { field, parts: parts(field) }).filter(|array| !array.parts.is_empty()).collect();
        let length = COLLECTION[0].len() as u64;
        Ok(Self { grid, folder: folder.to_owned(), extent: Extent::of(grid, scene), arrays, collection, length })
    }

    fn write(&mut self, number: usize, frame: &Frame) -> Result<(), OutputError> {
        let name = format!("{}_{number:06}.vti", self.grid.name());
        let path = self.folder.join(&name);
        fs::write(&path, self.image(frame)).map_err(OutputError::file(&path))?;
        let entry = format!("<DataSet timestep=\"{}\" file=\"{name}\"/>\n", frame.time_secs);
        self.enter(&entry).map_err(OutputError::file(&self.folder.join(format!("{}.pvd", self.grid.name()))))?;
        self.length += entry.len() as u64;
        Ok(())
    }

    /// Writes an entry over the end of the collection, and a new end behind it; the old end again if that fails.
    fn enter(&mut self, entry: &str) -> std::io::Result<()> {
        let length = self.length;
        let mut write = |text: &str| {
            self.collection.seek(SeekFrom::Start(length))?;
            self.collection.write_all(text.as_bytes())
        };
        let entered = write(&format!("{entry}{}", COLLECTION[1]));
        if entered.is_err() {
            write(COLLECTION[1])?;
            self.collection.set_len(length + COLLECTION[1].len() as u64)?;
        }
        entered
    }

    /// The text of a file with the values of a time.
    fn image(&self, frame: &Frame) -> String {
        let Extent { cells, spacing_m } = self.extent;
        let extent = format!("0 {} 0 {} 0 {}", cells[0], cells[1], cells[2]);
        let spacing = spacing_m.map(|m| m.to_string()).join(" ");
        let (mut declared, mut appended) = (String::new(), String::new());
        for array in &self.arrays {
            let components = if array.is_vector() { 3 } else { 1 };
            let _ = writeln!(
                declared,
                "<DataArray type=\"Float32\" Name=\"{}\" NumberOfComponents=\"{components}\" format=\"appended\" offset=\"{}\"/>",
                array.field,
                appended.len()
            );
            append(&mut appended, &array.bytes(frame, cells));
        }
        format!(
            "<?xml version=\"1.0\"?>\n\
             <VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n\
             <ImageData WholeExtent=\"{extent}\" Origin=\"0 0 0\" Spacing=\"{spacing}\">\n\
             <FieldData>\n<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">{}</DataArray>\n</FieldData>\n\
             <Piece Extent=\"{extent}\">\n<PointData/>\n<CellData>\n{declared}</CellData>\n</Piece>\n</ImageData>\n\
             <AppendedData encoding=\"base64\">\n_{appended}\n</AppendedData>\n</VTKFile>\n",
            frame.time_secs
        )
    }
}

impl Extent {
    fn of(grid: Grid, scene: &Scene) -> Self {
        let axes = grid.axes(scene);
        let (east, south) = (axes[axes.len() - 1], axes[axes.len() - 2]);
        let (layers, layer_m) = if grid == Grid::Air { (axes[0].count, axes[0].spacing_m) } else { (0, east.spacing_m) };
        Self { cells: [east.count, layers, south.count], spacing_m: [east.spacing_m, layer_m, south.spacing_m] }
    }
}

impl Array {
    fn is_vector(&self) -> bool {
        self.parts.iter().any(|(_, axis)| axis.is_some())
    }

    /// The values in the order of VTK: X fastest, then Y, then Z; the components of a vector together, 0 where the field has none.
    fn bytes(&self, frame: &Frame, [nx, layers, nz]: [usize; 3]) -> Vec<u8> {
        let ny = layers.max(1);
        let components = if self.is_vector() { 3 } else { 1 };
        let mut bytes = Vec::with_capacity(4 * components * nx * ny * nz);
        let rows = (0..nz).flat_map(|k| (0..ny).map(move |j| nx * (k + nz * j)));
        for at in rows.flat_map(|row| row..row + nx) {
            let mut value = [0.0_f32; 3];
            self.parts.iter().for_each(|&(number, axis)| value[axis.unwrap_or(0)] = frame.values[number][at]);
            value[..components].iter().for_each(|component| bytes.extend(component.to_le_bytes()));
        }
        bytes
    }
}

/// Appends values as one compressed block, behind a header with the number of blocks, their size, the size of a smaller last one, and the compressed size.
fn append(appended: &mut String, bytes: &[u8]) {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::fast());
    let compressed = encoder.write_all(bytes).and_then(|()| encoder.finish()).expect("memory can be written");
    let header: Vec<u8> = [1, bytes.len() as u64, 0, compressed.len() as u64].into_iter().flat_map(u64::to_le_bytes).collect();
    BASE64.encode_append(&header, appended);
    BASE64.encode_append(&compressed, appended);
}
