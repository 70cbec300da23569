//! Plates: figures of the literature drawn again, each as a picture of several tiles that differ in a setting or in time.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context as _, Result};
use prairie::studio::{Act, Stage};
use prairie_client::render::{Gpu, Quality};
use prairie_core::scene::Scene;

use crate::picture::Picture;
use crate::still::Still;
use crate::views::{Eye, over};

/// A plate.
#[derive(Clone, Copy)]
pub struct Plate {
    /// Its name, that of the file.
    pub name: &'static str,
    /// Built-in scene, or the path of a scene file relative to the root of the repository.
    pub scene: &'static str,
    /// Camera.
    eye: Eye,
    /// Size of a tile (px).
    tile_px: [u32; 2],
    /// Tiles in a row.
    columns: usize,
    tiles: &'static [Tile],
    /// Caption.
    pub shows: &'static str,
    /// The figure in the literature.
    pub answers: &'static str,
}

/// A tile of a plate.
#[derive(Clone, Copy)]
struct Tile {
    /// Change of the scene before its start.
    change: fn(&mut Scene),
    /// Time after the wind has built up (s).
    after_secs: f32,
}

/// A tile of the scene as it is, after a time (s).
const fn after(after_secs: f32) -> Tile {
    Tile { change: |_| {}, after_secs }
}

/// A tile of a changed scene.
const fn with(change: fn(&mut Scene)) -> Tile {
    Tile { change, after_secs: 0.0 }
}

/// All plates.
pub const PLATES: [Plate; 3] = [
    Plate {
        name: "self-shadow",
        scene: "shells",
        eye: over([66.0, 60.0], 1.1, 340.0, -22.0),
        tile_px: [320, 180],
        columns: 2,
        tiles: &[with(|scene| scene.shells.root_light = 1.0), with(|scene| scene.shells.root_light = 0.12)],
        shows: "shells without self-shadow, and with the linear ramp from 0.12 of the light at the roots to all of it at the tips",
        answers: "Bakay 2003, Figure 4.2",
    },
    Plate {
        name: "point-lights",
        scene: "tests/scenes/shell-lamps.toml",
        eye: Eye::Start,
        tile_px: [400, 225],
        columns: 1,
        tiles: &[after(0.0)],
        shows: "three point lights on shells: two that fall off with the inverse square, and one, in front, with a linear term",
        answers: "Bakay 2003, Figure 4.3",
    },
    Plate {
        name: "gust",
        scene: "tests/scenes/gust.toml",
        eye: Eye::Start,
        tile_px: [240, 135],
        columns: 2,
        tiles: &[after(0.0), after(1.0), after(2.0), after(3.0), after(4.0), after(5.0)],
        shows: "a gust that crosses shells from left to right, a second from frame to frame, row by row",
        answers: "Bakay 2003, Figure A.1",
    },
];

impl Plate {
    /// The plate of that name.
    ///
    /// # Errors
    /// When no plate has this name.
    pub fn find(name: &str) -> Result<&'static Self> {
        let known = || PLATES.map(|plate| plate.name).join(", ");
        PLATES.iter().find(|plate| plate.name == name).with_context(|| format!("no plate is called `{name}`; allowed: {}", known()))
    }

    /// Draws a tile at a size (px).
    fn draw_tile(&self, gpu: &Gpu, tile: &Tile, size_px: [u32; 2], quality: Quality) -> Result<Picture> {
        let scene =
            if self.scene.ends_with(".toml") { format!("{}/../{}", env!("CARGO_MANIFEST_DIR"), self.scene) } else { self.scene.to_owned() };
        let mut stage = Stage::changed(&scene, tile.change)?;
        let camera = self.eye.watch(&mut stage, Act::Wind)?;
        stage.run(tile.after_secs);
        stage.show()?;
        let mut still = Still { stage, camera, size_px };
        let mut canvas = still.canvas(gpu, quality);
        Ok(still.draw(&mut canvas).0)
    }

    fn draw_tiles(&self, gpu: &Gpu, size_px: [u32; 2], quality: Quality) -> Result<Vec<Picture>> {
        self.tiles.iter().map(|tile| self.draw_tile(gpu, tile, size_px, quality)).collect::<Result<_>>().context(self.name)
    }

    /// Draws the plate into a file of `folder`.
    ///
    /// # Errors
    /// When the scene is invalid or the file cannot be written.
    pub fn draw(&self, gpu: &Gpu, folder: &Path) -> Result<()> {
        let tiles = self.draw_tiles(gpu, self.tile_px, Quality::High)?;
        Picture::tiled(&tiles, self.columns)?.save(&folder.join(format!("{}.jpg", self.name)))
    }
}

/// Writes `README.md`, a page of all plates, beside the pictures.
///
/// # Errors
/// When the file cannot be written.
pub fn write_page(folder: &Path) -> Result<()> {
    let path = folder.join("README.md");
    std::fs::write(&path, page()).with_context(|| format!("{} cannot be written", path.display()))
}

/// Markdown with all plates.
fn page() -> String {
    let mut page = String::from(
        "# Plates\n\nFigures of the literature ([bibliography](../../../shared/README.md#bibliography)), drawn again at high quality. [The gallery](../gallery/README.md) compares ten more views. [More pictures](../README.md)\n\n\
         ```sh\ncargo run --release -p tests --bin chart -- plates\n```\n",
    );
    for Plate { name, scene, shows, answers, .. } in PLATES {
        write!(page, "\n## {answers}\n\n![{shows}]({name}.jpg)\n\nScene `{scene}`: {shows}.\n").expect("a string takes all text");
    }
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE_PX: [u32; 2] = [96, 54];

    #[test]
    fn plates_have_names_of_their_own_and_stand_on_the_page() {
        for plate in &PLATES {
            assert_eq!(Plate::find(plate.name).unwrap().name, plate.name);
            let picture = format!("![{}]({}.jpg)", plate.shows, plate.name);
            assert!(page().contains(&picture) && page().contains(plate.answers), "{}", plate.name);
        }
        let error = Plate::find("moon").err().unwrap().to_string();
        assert_eq!(error, "no plate is called `moon`; allowed: self-shadow, point-lights, gust");
        assert_eq!(page(), include_str!("../../results/plates/README.md"), "chart -- plates writes the page again");
    }

    #[test]
    fn each_tile_differs_from_the_one_before_it() {
        let gpu = Gpu::headless().unwrap();
        for plate in &PLATES {
            let tiles = plate.draw_tiles(&gpu, SIZE_PX, Quality::Low).unwrap();
            for pair in tiles.windows(2) {
                let differs = pair[0].difference(&pair[1]).unwrap();
                assert!(differs.changed > 0.05, "{}: {differs:?}", plate.name);
            }
        }
        // Control: the same moment drawn again.
        let [once, again] = [(); 2].map(|()| PLATES[2].draw_tile(&gpu, &PLATES[2].tiles[0], SIZE_PX, Quality::Low).unwrap());
        assert_eq!(once, again);
    }
}
