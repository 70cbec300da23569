//! VTK files, read by their format.

use crate::{DRIVE, Kept, bytes, ran, scene};
use data_encoding::BASE64;
use flate2::read::ZlibDecoder;
use prairie::output::vtk::VtkFolder;
use prairie::output::{Field, OutputError, Outputs, Sampler};
use std::io::Read as _;
use std::path::Path;

/// The value of an attribute in a tag.
fn attribute<'a>(tag: &'a str, name: &str) -> &'a str {
    let (_, rest) = tag.split_once(&format!(" {name}=\"")).unwrap_or_else(|| panic!("{name} in {tag}"));
    rest.split_once('"').unwrap().0
}

/// The values of an appended array.
fn array(file: &str, name: &str) -> (usize, Vec<f32>) {
    let tag = file.lines().find(|line| line.starts_with("<DataArray") && attribute(line, "Name") == name).unwrap();
    let (_, appended) = file.split_once("<AppendedData encoding=\"base64\">\n_").unwrap();
    let data = &appended[attribute(tag, "offset").parse().unwrap()..];
    let header = BASE64.decode(&data.as_bytes()[..44]).unwrap();
    let [blocks, size, partial, compressed]: [usize; 4] =
        std::array::from_fn(|n| u64::from_le_bytes(header[8 * n..8 * n + 8].try_into().unwrap()) as usize);
    assert_eq!((blocks, partial), (1, 0));
    let encoded = compressed.div_ceil(3) * 4;
    let block = BASE64.decode(&data.as_bytes()[44..44 + encoded]).unwrap();
    let mut found = Vec::new();
    ZlibDecoder::new(block.as_slice()).read_to_end(&mut found).unwrap();
    assert_eq!((found.len(), block.len()), (size, compressed));
    let values = found.chunks(4).map(|bytes| f32::from_le_bytes(bytes.try_into().unwrap())).collect();
    (attribute(tag, "NumberOfComponents").parse().unwrap(), values)
}

/// Writes a run as VTK, and returns its frames.
pub(crate) fn write(folder: &Path) -> Vec<prairie::output::Frame> {
    let loaded = scene();
    let sampler = Sampler::new(&loaded, &[Field::Wind, Field::GroundWind, Field::Bend, Field::BendVelocity]).unwrap();
    let (kept, vtk) = (Kept::default(), VtkFolder::create(folder, &loaded, &sampler, false).unwrap());
    let frames = kept.0.clone();
    ran(DRIVE, 60, 30, Outputs::default().with_fields(sampler, vec![Box::new(kept), Box::new(vtk)]).unwrap());
    std::mem::take(&mut *frames.lock().unwrap())
}

#[test]
fn files_have_the_values_of_every_time() {
    let folder = tempfile::tempdir().unwrap();
    let frames = write(folder.path());
    assert_eq!(frames.len(), 3);
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    for (grid, extent, spacing) in
        [("air", "0 16 0 8 0 16", "4 2 4"), ("ground", "0 32 0 0 0 32", "2 2 2"), ("grass", "0 256 0 0 0 256", "0.25 0.25 0.25")]
    {
        let collection = read(&format!("{grid}.pvd"));
        let entries: Vec<_> = collection.lines().filter(|line| line.starts_with("<DataSet")).collect();
        assert!(collection.starts_with("<?xml") && collection.ends_with("</Collection>\n</VTKFile>\n"), "{collection}");
        assert_eq!(entries.len(), 3);
        for (entry, frame) in entries.iter().zip(&frames) {
            assert_eq!(attribute(entry, "timestep").parse::<f64>().unwrap().to_bits(), frame.time_secs.to_bits());
            let image = read(attribute(entry, "file"));
            let line = image.lines().find(|line| line.starts_with("<ImageData")).unwrap();
            assert_eq!((attribute(line, "WholeExtent"), attribute(line, "Spacing"), attribute(line, "Origin")), (extent, spacing, "0 0 0"));
        }
    }
    let ([u, v, w, ground_u, ground_w, theta, omega_x, omega_z], last) = ([0, 1, 2, 3, 4, 5, 6, 7], &frames[2].values);
    let (components, wind) = array(&read("air_000002.vti"), "wind");
    // X fastest, then Y, then Z; in the frame X, then Z, then Y.
    let cells = (0..16).flat_map(|k| (0..8).flat_map(move |j| (0..16).map(move |i| i + 16 * (k + 16 * j))));
    let expected: Vec<f32> = cells.flat_map(|cell| [u, v, w].map(|number: usize| last[number][cell])).collect();
    assert!(components == 3 && bytes(&wind) == bytes(&expected), "wind");
    let flat = |[x, z]: [usize; 2]| (0..last[x].len()).flat_map(|cell| [last[x][cell], 0.0, last[z][cell]]).collect::<Vec<f32>>();
    assert!(bytes(&array(&read("ground_000002.vti"), "ground-wind").1) == bytes(&flat([ground_u, ground_w])), "wind at the ground");
    let grass = read("grass_000002.vti");
    assert!(bytes(&array(&grass, "bend-velocity").1) == bytes(&flat([omega_x, omega_z])), "bending velocity");
    let (components, found) = array(&grass, "bend");
    assert!(components == 1 && bytes(&found) == bytes(&last[theta]), "bend");
    assert!(bytes(&found) != bytes(&frames[0].values[theta]), "the grass has moved since the first time");
}

#[test]
fn only_folders_of_earlier_runs_are_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let (path, loaded) = (folder.path().join("vtk"), scene());
    write(&path);
    let sampler = Sampler::new(&loaded, &[Field::Wind]).unwrap();
    let create = |overwrite| VtkFolder::create(&path, &loaded, &sampler, overwrite).err();
    assert!(matches!(create(false), Some(OutputError::Exists { .. })));
    assert!(create(true).is_none() && !path.join("grass_000000.vti").exists() && path.join("air.pvd").exists());
    std::fs::write(path.join("notes.txt"), "mine").unwrap();
    assert!(matches!(create(true), Some(OutputError::NotOurs { .. })) && path.join("notes.txt").exists());
}
