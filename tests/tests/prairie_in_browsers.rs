//! The whole prairie: two real browsers join one server, one drives, and both see the same track open and rise again.
//!
//! What is asserted comes from the clients' own mirrors (what the stream brought) and from the pixels (what was drawn).

use anyhow::{Context as _, Result, ensure};
use serde_json::Value;
use server::{Config, scenes};
use std::net::SocketAddr;
use std::time::Duration;
use tests::browser::Browser;
use tests::picture::Picture;
use tokio::net::TcpListener;
use tokio::sync::oneshot;
use tokio::time::sleep;

/// A server in this process, on a free port; it stops when dropped.
struct Prairie {
    addr: SocketAddr,
    _stop: oneshot::Sender<()>,
}

impl Prairie {
    async fn serve(scene: &str) -> Result<Self> {
        let listener = TcpListener::bind("127.0.0.1:0").await?;
        let addr = listener.local_addr()?;
        let config = Config::new(scenes::load(scene)?);
        let (stop, stopped) = oneshot::channel::<()>();
        tokio::spawn(server::run(config, listener, async {
            let _ = stopped.await;
        }));
        Ok(Self { addr, _stop: stop })
    }

    /// A browser that has the scene, the first frames and its first picture. It draws only when asked: software rendering would
    /// take all of a small machine.
    async fn visitor(&self, name: &str) -> Result<Browser> {
        let url = format!("http://{}/?quality=low&panel=0&paused=1&name={name}", self.addr);
        let browser = Browser::open(&url).await?;
        browser.until("(s => s && s.connected && s.time_secs > 0 && s.patches_known > 0)(window.prairie.state())").await?;
        picture(&browser, 0.0).await?;
        Ok(browser)
    }
}

async fn numbers(browser: &Browser, expression: &str) -> Result<Vec<f64>> {
    let value = browser.evaluate(expression).await?;
    let list = value.as_array().with_context(|| format!("{expression} is no list but {value}"))?;
    Ok(list.iter().filter_map(Value::as_f64).collect())
}

/// Bend angles (rad) of a client's mirror along a line around `(x, z)`, 0.25 m apart.
async fn bends(browser: &Browser, x: f64, z: f64) -> Result<Vec<f64>> {
    numbers(browser, &format!("Array.from({{length: 17}}, (_, i) => window.prairie.theta({x} + 0.25 * (i - 8), {z}))")).await
}

fn strongest(bends: &[f64]) -> f64 {
    bends.iter().fold(0.0, |most, bend| f64::max(most, bend.abs()))
}

/// Draws the client's newest state twice, so that the blades have moved, and takes the picture. `time_secs` is the clock of
/// the drawing and must grow from picture to picture.
async fn picture(browser: &Browser, time_secs: f64) -> Result<Picture> {
    for step in [0.0, 0.2] {
        browser.evaluate(&format!("window.prairie.draw({})", time_secs + step)).await?;
    }
    browser.canvas().await
}

/// A car driven by the first visitor has made a track; this is a place on it (m).
struct Track {
    x: f64,
    z: f64,
}

impl Track {
    async fn drive(driver: &Browser) -> Result<Self> {
        driver.press('c').await?;
        driver.release('c').await?;
        driver.until("window.prairie.state().vehicle === 'car' && window.prairie.state().position").await?;
        let start = numbers(driver, "window.prairie.state().position").await?;
        driver.press('w').await?;
        let far = format!("(p => Math.hypot(p[0] - ({}), p[2] - ({})) > 12)(window.prairie.state().position)", start[0], start[2]);
        driver.until(&far).await?;
        driver.release('w').await?;
        let end = numbers(driver, "window.prairie.state().position").await?;
        let along = |axis: usize| start[axis] + 0.7 * (end[axis] - start[axis]);
        Ok(Self { x: along(0), z: along(2) })
    }

    /// Bend angles (rad) of a client's mirror across the track.
    async fn bends(&self, browser: &Browser) -> Result<Vec<f64>> {
        bends(browser, self.x, self.z).await
    }

    /// Waits until the grass has risen in a client's mirror.
    async fn risen(&self, browser: &Browser) -> Result<()> {
        let Self { x, z } = self;
        let angles = format!("Array.from({{length: 17}}, (_, i) => Math.abs(window.prairie.theta({x} + 0.25 * (i - 8), {z})))");
        browser.until(&format!("Math.max(...{angles}) < 0.35")).await?;
        Ok(())
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn the_wind_moves_the_grass_in_the_mirror_and_in_the_pixels() -> Result<()> {
    let prairie = Prairie::serve("meadow").await?;
    let visitor = prairie.visitor("Ada").await?;
    let eye = numbers(&visitor, "window.prairie.state().eye").await?;
    let (x, z) = (eye[0], eye[2]);

    let probe = format!("[0,1,2,3,4,5].map(i => Array.from(window.prairie.wind({x} + 6 * i, {} , {z} - 5 * i))).flat()", eye[1]);
    let (wind, bend, before) = (numbers(&visitor, &probe).await?, bends(&visitor, x, z - 4.0).await?, picture(&visitor, 1.0).await?);
    sleep(Duration::from_secs(6)).await;
    let (later_wind, later_bend, after) =
        (numbers(&visitor, &probe).await?, bends(&visitor, x, z - 4.0).await?, picture(&visitor, 7.0).await?);

    let change = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    ensure!(change(&wind, &later_wind) > 0.25, "the wind stood still: {wind:?} then {later_wind:?}");
    ensure!(change(&bend, &later_bend) > 0.01, "the bend field stood still: {bend:?} then {later_bend:?}");
    let difference = before.difference(&after)?;
    ensure!(difference.changed > 0.01, "the picture stood still: {difference:?}");
    Ok(())
}

#[tokio::test(flavor = "multi_thread")]
async fn two_visitors_know_one_track_that_opens_and_rises() -> Result<()> {
    let prairie = Prairie::serve("meadow").await?;
    let (driver, watcher) = (prairie.visitor("Ada").await?, prairie.visitor("Bert").await?);
    let track = Track::drive(&driver).await?;
    let (seen_by_driver, seen_by_watcher) = tokio::try_join!(track.bends(&driver), track.bends(&watcher))?;
    let fresh = [&seen_by_driver, &seen_by_watcher];
    ensure!(fresh.iter().all(|bends| strongest(bends) > 0.6), "no track in both mirrors: {fresh:?}");
    let apart = seen_by_driver.iter().zip(&seen_by_watcher).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    ensure!(apart < 0.35, "the mirrors know different tracks: {fresh:?}");
    tokio::try_join!(track.risen(&driver), track.risen(&watcher))?;
    Ok(())
}
