//! The renderer against stored pictures: the same world, camera and frames, drawn without a window.
//!
//! The pictures were drawn by Mesa's lavapipe. Other drivers round differently, so the bounds are loose: a mean difference of
//! 3/255, and 6 % of the pixels visibly changed. A picture that lacks its subject exceeds one of them. `PRAIRIE_BLESS=1 cargo nextest
//! run --release -p tests --test golden` rewrites those that have visibly changed.

mod light;
mod objects;
mod options;
mod scenes;

use anyhow::{Context as _, Result, ensure};
use prairie::charts::image::{Difference, Picture};
use prairie::charts::views::Eye;
use prairie::studio::{Act, Stage};
use prairie_client::render::{Gpu, OffscreenRenderer as Canvas, Quality, RenderOptions, Split};
use prairie_core::scene::Scene;
use std::path::PathBuf;

/// A test with the name of its stored picture.
macro_rules! golden {
    ($name:ident, $golden:expr) => {
        #[test]
        fn $name() -> Result<()> {
            $golden.check(stringify!($name))
        }
    };
}
use golden;

const DT_SECS: f32 = 1.0 / 30.0;
const BOUNDS: Difference = Difference { mean: 3.0, changed: 0.06 };

/// A stored picture: its subject, and how to draw it.
#[derive(Clone, Debug)]
struct Golden {
    /// Subject, which is missing from the picture it must differ from.
    shows: &'static str,
    /// Built-in scene, or scene file.
    scene: &'static str,
    /// Change of that scene.
    change: fn(&mut Scene),
    act: Act,
    eye: Eye,
    quality: Quality,
    look: RenderOptions,
    /// Two render options side by side instead.
    split: Option<Split>,
    size_px: [u32; 2],
    frames: u32,
    /// Rectangles for a pass that covers only little of the picture: left, top, width and height (px). The bounds apply in each of them, too.
    parts: &'static [[u32; 4]],
    unlike: Unlike,
}

/// A picture that must exceed the bounds in each part, like one with a pass that draws nothing.
#[derive(Clone, Copy, Debug)]
enum Unlike {
    /// No such picture.
    Nothing,
    /// Another stored picture.
    Stored(&'static str),
    /// The same moment with other render options.
    RenderOptions(RenderOptions),
    /// The same moment without objects.
    Bare,
}

impl Default for Golden {
    fn default() -> Self {
        Self {
            shows: "the scene",
            scene: "meadow",
            change: |_| {},
            act: Act::Wind,
            eye: Eye::Start,
            quality: Quality::Low,
            look: RenderOptions::default(),
            split: None,
            size_px: [256, 144],
            frames: 3,
            parts: &[],
            unlike: Unlike::Nothing,
        }
    }
}

impl Golden {
    /// Compares the picture with the stored one of this name, or rewrites the stored one.
    fn check(&self, name: &str) -> Result<()> {
        let blesses = std::env::var_os("PRAIRIE_BLESS").is_some();
        let (drawn, unlike) = self.draw()?;
        let path = stored(name);
        if blesses && drawn.save_if_visibly_changed(&path, self.parts)? {
            println!("{name}: rewritten");
        }
        let differences = self.differences(&drawn, &Picture::load(&path)?)?;
        println!("{name}, from the stored picture: {differences:?}");
        for (place, difference) in differences {
            if !difference.is_within(BOUNDS) {
                let seen = std::env::temp_dir().join(format!("prairie-{name}.png"));
                drawn.save(&seen)?;
                ensure!(false, "{} differs from {}, {place}: {difference:?}", seen.display(), path.display());
            }
        }
        let unlike = match self.unlike {
            // That picture may not have been drawn yet.
            Unlike::Stored(_) if blesses => None,
            Unlike::Stored(other) => Some(Picture::load(&stored(other))?),
            _ => unlike,
        };
        if let Some(unlike) = unlike {
            let differences = self.differences(&drawn, &unlike)?;
            println!("{name}, from the picture it must differ from: {differences:?}");
            for (place, difference) in differences.iter().skip(self.parts.len().min(1)) {
                ensure!(!difference.is_within(BOUNDS), "{name}: {} is hardly visible, {place}: {difference:?}", self.shows);
            }
        }
        Ok(())
    }

    /// Draws the picture, and the one it must differ from unless that is stored.
    fn draw(&self) -> Result<(Picture, Option<Picture>)> {
        let mut stage = Stage::changed(self.scene, self.change)?;
        let camera = self.eye.watch(&mut stage, self.act)?;
        let gpu = Gpu::headless().context("no Vulkan driver: install mesa-vulkan-drivers")?;
        let mut canvas = Canvas::new(&gpu, self.size_px, self.quality);
        canvas.set_options(self.look);
        let [width, height] = self.size_px;
        let seen = |canvas: &Canvas| Picture { width, height, rgba: canvas.rgba() };
        for _ in 0..self.frames {
            stage.run(DT_SECS);
            stage.show()?;
            let time_secs = stage.mirror.time_secs();
            match &self.split {
                Some(split) => canvas.draw_split(&mut stage.mirror, &camera, time_secs, DT_SECS, split),
                None => canvas.draw(&mut stage.mirror, &camera, time_secs, DT_SECS),
            };
        }
        let drawn = seen(&canvas);
        match self.unlike {
            Unlike::Nothing | Unlike::Stored(_) => return Ok((drawn, None)),
            Unlike::RenderOptions(look) => canvas.set_options(look),
            Unlike::Bare => stage.show_bare()?,
        }
        let time_secs = stage.mirror.time_secs();
        canvas.draw(&mut stage.mirror, &camera, time_secs, 0.0);
        Ok((drawn, Some(seen(&canvas))))
    }

    /// Differences of two pictures as a whole and in each part.
    fn differences(&self, a: &Picture, b: &Picture) -> Result<Vec<(String, Difference)>> {
        let whole = [("as a whole".to_owned(), a.difference(b)?)];
        let parts = self.parts.iter().map(|&part| Ok((format!("in {part:?}"), a.cropped(part).difference(&b.cropped(part))?)));
        whole.into_iter().map(Ok).chain(parts).collect()
    }
}

fn stored(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("golden").join(format!("{name}.png"))
}
