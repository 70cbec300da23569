//! Generators of the maps of the built-in scenes, with fixed seeds.
//!
//! They use only `+ − × ÷`, square roots and lattice noise, so that every machine produces the same pixels.

mod blades;
mod continuum;
mod grey_map;
mod homestead;
mod jacksboro;
mod knolls;
mod landforms;
mod meadow;
mod starter;

pub use grey_map::{GreyMap, Levels};

use std::io;
use std::path::{Path, PathBuf};

/// Generates every map of the built-in scenes.
pub fn generate() -> Vec<GreyMap> {
    let mut maps = vec![jacksboro::covering()];
    maps.extend(meadow::maps());
    maps.extend(continuum::maps());
    maps.extend(blades::maps());
    maps.extend(knolls::maps());
    maps.push(homestead::covering());
    maps
}

/// Height map and covering map of the scene that `prairie new` writes; they are not among those of [`generate`].
pub fn starter() -> [GreyMap; 2] {
    starter::maps()
}

/// Generates every map and writes it into `folder`; returns the files.
///
/// # Errors
/// When a file cannot be written.
pub fn write(folder: &Path) -> io::Result<Vec<PathBuf>> {
    std::fs::create_dir_all(folder)?;
    let file = |map: GreyMap| {
        let path = folder.join(map.name);
        std::fs::write(&path, map.to_png())?;
        Ok(path)
    };
    generate().into_iter().map(file).collect()
}
