//! The renderer against stored pictures: the same world, camera and frames, drawn without a window.
//!
//! The pictures were drawn by Mesa's lavapipe. Other drivers round differently, so the bounds are loose: a mean difference of
//! 3/255 and 6 % of the pixels visibly off. Each picture without what it is there to show would miss one of them. `PRAIRIE_BLESS=1 cargo nextest
//! run --release -p tests --test golden` draws them anew.

mod light;
mod objects;
mod scenes;
mod ways;

use anyhow::{Context as _, Result, ensure};
use client_wasm::render::{Gpu, Look, Picture as Canvas, Quality, Split};
use shared::scene::Scene;
use std::path::PathBuf;
use tests::picture::{Difference, Picture};
use tests::stage::{Act, Stage};
use tests::views::Eye;

/// A test of its name, which is that of the file too.
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

/// A stored picture: what it shows, and how it is drawn.
#[derive(Clone, Debug)]
struct Golden {
    /// What is missing in the picture that it is unlike.
    shows: &'static str,
    /// Built-in scene, or file of one.
    scene: &'static str,
    /// How the scene differs from that.
    change: fn(&mut Scene),
    act: Act,
    eye: Eye,
    quality: Quality,
    look: Look,
    /// Two ways side by side instead of that look.
    split: Option<Split>,
    size_px: [u32; 2],
    frames: u32,
    /// Parts in which a pass shows that covers little of the picture: left, top, width and height (px). The bounds hold in each of them, too.
    parts: &'static [[u32; 4]],
    unlike: Unlike,
}

/// A picture beyond the bounds, in each of the parts: what would be drawn if a pass did nothing.
#[derive(Clone, Copy, Debug)]
enum Unlike {
    /// None.
    Nothing,
    /// Another stored picture.
    Stored(&'static str),
    /// The same moment in another look.
    Look(Look),
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
            look: Look::default(),
            split: None,
            size_px: [256, 144],
            frames: 3,
            parts: &[],
            unlike: Unlike::Nothing,
        }
    }
}

impl Golden {
    /// Holds the picture of that name to what is stored, or stores it anew.
    fn check(&self, name: &str) -> Result<()> {
        let blesses = std::env::var_os("PRAIRIE_BLESS").is_some();
        let (drawn, unlike) = self.draw()?;
        let path = stored(name);
        if blesses {
            drawn.save(&path)?;
        }
        let differences = self.differences(&drawn, &Picture::load(&path)?)?;
        println!("{name}, from what is stored: {differences:?}");
        for (place, difference) in differences {
            if !is_within(difference) {
                let seen = std::env::temp_dir().join(format!("prairie-{name}.png"));
                drawn.save(&seen)?;
                ensure!(false, "{} differs from {}, {place}: {difference:?}", seen.display(), path.display());
            }
        }
        let unlike = match self.unlike {
            // It may not have been drawn yet.
            Unlike::Stored(_) if blesses => None,
            Unlike::Stored(other) => Some(Picture::load(&stored(other))?),
            _ => unlike,
        };
        if let Some(unlike) = unlike {
            let differences = self.differences(&drawn, &unlike)?;
            println!("{name}, from what it is unlike: {differences:?}");
            for (place, difference) in differences.iter().skip(self.parts.len().min(1)) {
                ensure!(!is_within(*difference), "{name}: too little is seen of {}, {place}: {difference:?}", self.shows);
            }
        }
        Ok(())
    }

    /// The picture, and the one that it must be unlike if it is not stored.
    fn draw(&self) -> Result<(Picture, Option<Picture>)> {
        let mut stage = Stage::changed(self.scene, self.change)?;
        let camera = self.eye.watch(&mut stage, self.act)?;
        let gpu = Gpu::headless().context("no Vulkan driver: install mesa-vulkan-drivers")?;
        let mut canvas = Canvas::new(&gpu, self.size_px, self.quality);
        canvas.set_look(self.look);
        let [width, height] = self.size_px;
        let seen = |canvas: &Canvas| Picture { width, height, rgba: canvas.rgba() };
        let time_secs = |frame: u32| f64::from(frame) * f64::from(DT_SECS);
        for frame in 0..self.frames {
            stage.run(DT_SECS);
            stage.show()?;
            match &self.split {
                Some(split) => canvas.draw_split(&mut stage.mirror, &camera, time_secs(frame), DT_SECS, split),
                None => canvas.draw(&mut stage.mirror, &camera, time_secs(frame), DT_SECS),
            };
        }
        let drawn = seen(&canvas);
        match self.unlike {
            Unlike::Nothing | Unlike::Stored(_) => return Ok((drawn, None)),
            Unlike::Look(look) => canvas.set_look(look),
            Unlike::Bare => stage.show_bare()?,
        }
        canvas.draw(&mut stage.mirror, &camera, time_secs(self.frames - 1), 0.0);
        Ok((drawn, Some(seen(&canvas))))
    }

    /// How far two pictures are apart as a whole, and in each part.
    fn differences(&self, a: &Picture, b: &Picture) -> Result<Vec<(String, Difference)>> {
        let whole = [("as a whole".to_owned(), a.difference(b)?)];
        let parts = self.parts.iter().map(|&part| Ok((format!("in {part:?}"), a.part(part).difference(&b.part(part))?)));
        whole.into_iter().map(Ok).chain(parts).collect()
    }
}

fn is_within(difference: Difference) -> bool {
    difference.mean <= BOUNDS.mean && difference.changed <= BOUNDS.changed
}

fn stored(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("golden").join(format!("{name}.png"))
}
