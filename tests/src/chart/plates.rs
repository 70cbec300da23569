//! Plates: figures of the literature drawn again, each as a picture of several tiles that differ in a setting or in time.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context as _, Result};
use prairie::studio::{Act, Stage};
use prairie_client::render::{Gpu, Quality};
use prairie_core::scene::Scene;

use prairie::charts::image::Picture;
use prairie::charts::still::Still;
use prairie::charts::views::{Eye, over};

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
    tiles: Tiles,
    /// Caption.
    pub shows: &'static str,
    /// The figure in the literature.
    pub answers: &'static str,
}

/// Change of a scene before its start.
type Change = fn(&mut Scene);

/// The tiles of a plate.
#[derive(Clone, Copy)]
enum Tiles {
    /// One for each change of the scene, when the wind has built up.
    Changes(&'static [Change]),
    /// Moments of one run of the changed scene: times after the wind has built up (s), ascending.
    Moments(Change, &'static [f32]),
}

/// All plates.
pub const PLATES: [Plate; 4] = [
    Plate {
        name: "self-shadow",
        scene: "shells",
        eye: over([66.0, 60.0], 1.1, 340.0, -22.0),
        tile_px: [320, 180],
        columns: 2,
        tiles: Tiles::Changes(&[|scene| scene.shells.root_light = 1.0, |scene| scene.shells.root_light = 0.12]),
        shows: "shells without self-shadow, and with the linear ramp from 0.12 of the light at the roots to all of it at the tips",
        answers: "Bakay 2003, Figure 4.2",
    },
    Plate {
        name: "point-lights",
        scene: "tests/scenes/shell-lamps.toml",
        eye: Eye::Start,
        tile_px: [400, 225],
        columns: 1,
        tiles: Tiles::Changes(&[|_| {}]),
        shows: "three point lights on shells: two that fall off with the inverse square, and one, in front, with a linear term",
        answers: "Bakay 2003, Figure 4.3",
    },
    Plate {
        name: "gust",
        scene: "tests/scenes/gust.toml",
        eye: Eye::Start,
        tile_px: [240, 135],
        columns: 2,
        tiles: Tiles::Moments(|_| {}, &[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]),
        shows: "a gust that crosses shells from left to right, a second from frame to frame, row by row",
        answers: "Bakay 2003, Figure A.1",
    },
    Plate {
        name: "many-cars",
        scene: "continuum",
        eye: over([2414.0, 2480.0], 26.0, 0.0, -28.0),
        tile_px: [128, 72],
        columns: 3,
        tiles: Tiles::Moments(many_cars, &[0.0, 2.0, 4.0, 6.0, 8.0, 10.0]),
        shows: "32 cars that draw their tracks through one field, two seconds from frame to frame, row by row",
        answers: "Chen & Johan 2010, Figure 13",
    },
];

/// Cars in the middle of the land, near each other.
fn many_cars(scene: &mut Scene) {
    (scene.objects.self_driving, scene.objects.self_driving_apart_m, scene.objects.self_driving_m_per_s) = (32, 10.0, 8.0);
}

impl Plate {
    /// The plate of that name.
    ///
    /// # Errors
    /// When no plate has this name.
    pub fn find(name: &str) -> Result<&'static Self> {
        let known = || PLATES.map(|plate| plate.name).join(", ");
        PLATES.iter().find(|plate| plate.name == name).with_context(|| format!("no plate is called `{name}`; allowed: {}", known()))
    }

    /// The changed scene at its start, with a camera that draws at a size (px).
    fn still(&self, change: Change, size_px: [u32; 2]) -> Result<Still> {
        let scene =
            if self.scene.ends_with(".toml") { format!("{}/../{}", env!("CARGO_MANIFEST_DIR"), self.scene) } else { self.scene.to_owned() };
        let mut stage = Stage::changed(&scene, change)?;
        let camera = self.eye.watch(&mut stage, Act::Wind)?;
        Ok(Still { stage, camera, size_px })
    }

    /// Draws the tiles at a size (px).
    fn draw_tiles(&self, gpu: &Gpu, size_px: [u32; 2], quality: Quality) -> Result<Vec<Picture>> {
        let drawn = |still: &mut Still, secs: f32| -> Result<Picture> {
            still.stage.run(secs);
            still.stage.show()?;
            let mut canvas = still.canvas(gpu, quality);
            Ok(still.draw(&mut canvas).0)
        };
        let tiles: Result<Vec<_>> = match self.tiles {
            Tiles::Changes(changes) => changes.iter().map(|change| drawn(&mut self.still(*change, size_px)?, 0.0)).collect(),
            Tiles::Moments(change, moments_secs) => {
                let (mut still, mut before_secs) = (self.still(change, size_px)?, 0.0);
                let mut draw = |at_secs: &f32| drawn(&mut still, at_secs - std::mem::replace(&mut before_secs, *at_secs));
                moments_secs.iter().map(&mut draw).collect()
            }
        };
        tiles.context(self.name)
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
        assert_eq!(error, "no plate is called `moon`; allowed: self-shadow, point-lights, gust, many-cars");
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
        let once = Plate { tiles: Tiles::Moments(|_| {}, &[0.0]), ..PLATES[2] };
        let [once, again] = [(); 2].map(|()| once.draw_tiles(&gpu, SIZE_PX, Quality::Low).unwrap());
        assert_eq!(once, again);
    }
}
