//! End to end: two real browsers join one server, one drives, and both see the same track open and recover.
//!
//! Assertions use the clients' mirrors (the received state) and the pixels (the drawn state).

use anyhow::{Context as _, Result, bail, ensure};
use prairie::charts::image::Picture;
use prairie::runner::Simulation;
use prairie::scenes::{self, LoadedScene};
use prairie::snapshot::{PatchQuantiser, Snapshot};
use prairie::world::{Command, World};
use prairie_core::plant::growth::NutrientMap;
use prairie_core::terrain::grey_png;
use prairie_core::wire::ObjectId;
use serde_json::Value;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use tests::browser::Browser;
use tokio::time::sleep;

/// Bending angles (rad): above the first a position counts as track, below the second as recovered.
const OPEN_RAD: f64 = 0.6;
const RISEN_RAD: f64 = 0.05;

/// The world, which can be paused: software rendering takes seconds per picture, and a track would recover meanwhile.
struct Held {
    world: World,
    held: Arc<AtomicBool>,
    waiting: Vec<Command>,
}

impl Simulation for Held {
    fn step(&mut self, commands: &[Command]) {
        self.waiting.extend_from_slice(commands);
        if !self.held.load(Ordering::Relaxed) {
            self.world.step(&std::mem::take(&mut self.waiting));
        }
    }

    fn publish(&self, quantiser: &mut PatchQuantiser) -> Snapshot {
        self.world.publish(quantiser)
    }

    fn object_of(&self, client: u32) -> Option<ObjectId> {
        self.world.object_of(client)
    }
}

/// A server whose world can be paused.
struct Prairie {
    server: tests::prairie::Prairie,
    held: Arc<AtomicBool>,
    /// Checksum of the plants in its world, in the format of the page.
    plants: String,
}

impl Prairie {
    async fn serve(scene: LoadedScene) -> Result<Self> {
        let held = Arc::new(AtomicBool::new(false));
        let world = World::new(&scene.scene, scene.maps())?;
        let plants = world.flora().map_or_else(String::new, |flora| format!("{:016x}", flora.checksum()));
        let world = Held { world, held: Arc::clone(&held), waiting: vec![] };
        Ok(Self { server: tests::prairie::Prairie::serve(scene, world).await?, held, plants })
    }

    /// Pauses or resumes the world.
    fn hold(&self, held: bool) {
        self.held.store(held, Ordering::Relaxed);
    }

    /// A client that has drawn its first picture.
    async fn visitor(&self, name: &str) -> Result<Browser> {
        let browser = self.server.visitor(name).await?;
        picture(&browser, 0.0).await?;
        Ok(browser)
    }
}

async fn numbers(browser: &Browser, expression: &str) -> Result<Vec<f64>> {
    let value = browser.evaluate(expression).await?;
    let list = value.as_array().with_context(|| format!("{expression} is not a list but {value}"))?;
    Ok(list.iter().filter_map(Value::as_f64).collect())
}

/// Bend angles (rad) of wind and bend field together, in a client's mirror, at 8 × 8 positions around `(x, z)`, 8 m apart.
async fn bends_around(browser: &Browser, x: f64, z: f64) -> Result<Vec<f64>> {
    let at = |middle: f64, step: &str| format!("{middle} + 8 * ({step} - 3.5)");
    let theta = format!("window.prairie.theta({}, {})", at(x, "i % 8"), at(z, "Math.floor(i / 8)"));
    numbers(browser, &format!("Array.from({{length: 64}}, (_, i) => {theta})")).await
}

fn strongest(bends: &[f64]) -> f64 {
    bends.iter().fold(0.0, |most, bend| f64::max(most, bend.abs()))
}

/// Waits until two clients of a paused world have the newest state.
async fn both_up_to_date(a: &Browser, b: &Browser) -> Result<()> {
    let ticks = async || tokio::try_join!(a.evaluate("window.prairie.state().tick"), b.evaluate("window.prairie.state().tick"));
    let mut before = ticks().await?;
    for _ in 0..60 {
        sleep(Duration::from_secs(1)).await;
        let now = ticks().await?;
        if now == before && now.0 == now.1 {
            return Ok(());
        }
        before = now;
    }
    bail!("after a minute of a held world the visitors are at steps {before:?}")
}

/// Draws the client's newest state twice, so that the blades have moved, and takes the picture. `time_secs` is the clock of
/// the drawing and must grow from picture to picture.
async fn picture(browser: &Browser, time_secs: f64) -> Result<Picture> {
    for step in [0.0, 0.2] {
        browser.evaluate(&format!("window.prairie.draw({})", time_secs + step)).await?;
    }
    browser.canvas().await
}

/// The meadow without wind: only the track moves, and flattened grass recovers within the timeout of a test.
fn still_meadow() -> Result<LoadedScene> {
    let mut meadow = scenes::load("meadow")?;
    meadow.scene.wind.mean_m_per_s = [0.0; 2];
    meadow.scene.wind.sources = 0;
    meadow.scene.grass.laid_recovery_secs = 1.0;
    Ok(meadow)
}

/// The meadow with a nutrient map.
fn meadow_on_drawn_soil() -> Result<LoadedScene> {
    let mut meadow = scenes::load("meadow")?;
    let levels: Vec<u8> = (0..=255).collect();
    meadow.nutrient_png = grey_png([16; 2], &levels);
    meadow.nutrients = Some(NutrientMap::from_png(&meadow.nutrient_png)?.into());
    Ok(meadow)
}

/// The track of a car driven by the first client: its middle (m) and the direction of the car (unit vector).
struct Track {
    middle: [f64; 3],
    along: [f64; 2],
}

impl Track {
    /// Drives, and leaves the car at the end of the track; returns when the car is gone in both clients.
    async fn drive(driver: &Browser, watcher: &Browser) -> Result<Self> {
        driver.press('c').await?;
        driver.release('c').await?;
        driver.until("window.prairie.state().vehicle === 'car' && window.prairie.state().position").await?;
        let start = numbers(driver, "window.prairie.state().position").await?;
        driver.press('w').await?;
        let far = format!("(p => Math.hypot(p[0] - ({}), p[2] - ({})) > 12)(window.prairie.state().position)", start[0], start[2]);
        driver.until(&far).await?;
        driver.release('w').await?;
        let end = numbers(driver, "window.prairie.state().position").await?;
        driver.press('f').await?;
        driver.release('f').await?;
        let gone = "window.prairie.state().objects === 0";
        tokio::try_join!(driver.until(gone), watcher.until(gone))?;
        let [dx, dz] = [end[0] - start[0], end[2] - start[2]];
        let length = dx.hypot(dz);
        Ok(Self { middle: [0, 1, 2].map(|axis| 0.5 * (start[axis] + end[axis])), along: [dx / length, dz / length] })
    }

    /// Bend angles (rad) of a client's mirror across the track.
    async fn bends(&self, browser: &Browser) -> Result<Vec<f64>> {
        numbers(browser, &self.across()).await
    }

    /// Waits until the grass has recovered in a client's mirror.
    async fn risen(&self, browser: &Browser) -> Result<()> {
        browser.until(&format!("Math.max(...{}.map(Math.abs)) < {RISEN_RAD}", self.across())).await?;
        Ok(())
    }

    /// Screenshot of the track from its side, looking down. Looking elsewhere in between restarts the blades from the mirror's state, so
    /// that none is in motion.
    async fn picture(&self, browser: &Browser, time_secs: f64) -> Result<Picture> {
        let ([x, y, z], [dx, dz]) = (self.middle, self.along);
        let heading_rad = dz.atan2(dx);
        for (aside_m, time_secs) in [(80.0, time_secs), (6.0, time_secs + 0.2)] {
            let eye = [x - aside_m * dz, y + 4.0, z + aside_m * dx];
            browser.evaluate(&format!("window.prairie.look({eye:?}, {heading_rad}, -0.55)")).await?;
            browser.evaluate(&format!("window.prairie.draw({time_secs})")).await?;
        }
        browser.canvas().await
    }

    fn across(&self) -> String {
        let ([x, _, z], [dx, dz]) = (self.middle, self.along);
        format!("Array.from({{length: 17}}, (_, i) => window.prairie.theta({x} - {dz} * 0.25 * (i - 8), {z} + {dx} * 0.25 * (i - 8)))")
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn the_page_grows_the_servers_plants_and_draws_grass_that_moves_in_the_wind() -> Result<()> {
    let prairie = Prairie::serve(meadow_on_drawn_soil()?).await?;
    let visitor = prairie.visitor("Ada").await?;
    let plants = visitor.evaluate("window.prairie.plants()").await?;
    ensure!(!prairie.plants.is_empty() && plants == prairie.plants.as_str(), "the page grew {plants}, the server {}", prairie.plants);
    let eye = numbers(&visitor, "window.prairie.state().eye").await?;
    let (x, z) = (eye[0], eye[2]);

    let probe = format!("[0,1,2,3,4,5].map(i => Array.from(window.prairie.wind({x} + 6 * i, {} , {z} - 5 * i))).flat()", eye[1]);
    let (wind, bend, before) = (numbers(&visitor, &probe).await?, bends_around(&visitor, x, z).await?, picture(&visitor, 1.0).await?);
    sleep(Duration::from_secs(6)).await;
    let (later_wind, later_bend, after) =
        (numbers(&visitor, &probe).await?, bends_around(&visitor, x, z).await?, picture(&visitor, 7.0).await?);

    let change = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    ensure!(change(&wind, &later_wind) > 0.25, "the wind stood still: {wind:?} then {later_wind:?}");
    ensure!(change(&bend, &later_bend) > 0.01, "the grass stood still: {bend:?} then {later_bend:?}");
    let difference = before.difference(&after)?;
    ensure!(difference.changed > 0.01, "the picture stood still: {difference:?}");
    Ok(())
}

#[tokio::test(flavor = "multi_thread")]
async fn two_clients_see_the_same_track_open_and_recover() -> Result<()> {
    let prairie = Prairie::serve(still_meadow()?).await?;
    let (driver, watcher) = (prairie.visitor("Ada").await?, prairie.visitor("Bert").await?);
    let track = Track::drive(&driver, &watcher).await?;
    prairie.hold(true);
    both_up_to_date(&driver, &watcher).await?;

    let (by_driver, by_watcher) = tokio::try_join!(track.bends(&driver), track.bends(&watcher))?;
    ensure!(strongest(&by_driver) > OPEN_RAD, "no track in the driver's mirror: {by_driver:?}");
    ensure!(by_driver == by_watcher, "the mirrors know different tracks: {by_driver:?} and {by_watcher:?}");

    let pictures = async |time_secs| tokio::try_join!(track.picture(&driver, time_secs), track.picture(&watcher, time_secs));
    let open = pictures(1.0).await?;
    prairie.hold(false);
    tokio::try_join!(track.risen(&driver), track.risen(&watcher))?;
    prairie.hold(true);
    both_up_to_date(&driver, &watcher).await?;
    let (risen, later) = (pictures(2.0).await?, pictures(3.0).await?);

    let apart = open.0.difference(&open.1)?;
    ensure!(apart.changed < 0.01, "the visitors see different tracks: {apart:?}");
    for (who, [open, risen, later]) in [("driver", [&open.0, &risen.0, &later.0]), ("watcher", [&open.1, &risen.1, &later.1])] {
        let (track, rest) = (open.difference(risen)?, risen.difference(later)?);
        ensure!(track.changed > 0.1 && track.changed > 4.0 * rest.changed, "the {who} saw no track: {track:?}, then {rest:?}");
    }
    Ok(())
}
