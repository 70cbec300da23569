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

    /// A browser that has the scene and the first frames.
    async fn visitor(&self, name: &str) -> Result<Browser> {
        let url = format!("http://{}/?quality=low&panel=0&name={name}", self.addr);
        let browser = Browser::open(&url).await?;
        browser.until("(s => s && s.connected && s.frames > 2 && s.time_secs > 0 && s.patches_known > 0)(window.prairie.state())").await?;
        Ok(browser)
    }
}

async fn number(browser: &Browser, expression: &str) -> Result<f64> {
    browser.evaluate(expression).await?.as_f64().with_context(|| format!("{expression} is no number"))
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

/// Looks straight down on `(x, z)` from 9 m above the ground and waits for a frame of it.
async fn look_down(browser: &Browser, x: f64, ground_m: f64, z: f64) -> Result<Picture> {
    let frames = number(browser, "window.prairie.state().frames").await?;
    browser.evaluate(&format!("window.prairie.look([{x}, {}, {z}], 0, -1.5), 0", ground_m + 9.0)).await?;
    browser.until(&format!("window.prairie.state().frames > {}", frames + 3.0)).await?;
    browser.canvas().await
}

#[tokio::test(flavor = "multi_thread")]
async fn the_wind_moves_the_grass_in_the_mirror_and_in_the_pixels() -> Result<()> {
    let prairie = Prairie::serve("meadow").await?;
    let visitor = prairie.visitor("Ada").await?;
    let eye = numbers(&visitor, "window.prairie.state().eye").await?;
    let (x, z) = (eye[0], eye[2]);

    let probe = format!("[0,1,2,3,4,5].map(i => window.prairie.wind({x} + 6 * i, {} , {z} - 5 * i)).flat()", eye[1]);
    let (wind, bend, picture) = (numbers(&visitor, &probe).await?, bends(&visitor, x, z - 4.0).await?, visitor.canvas().await?);
    sleep(Duration::from_secs(6)).await;
    let (later_wind, later_bend, later_picture) =
        (numbers(&visitor, &probe).await?, bends(&visitor, x, z - 4.0).await?, visitor.canvas().await?);

    let change = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    ensure!(change(&wind, &later_wind) > 0.25, "the wind stood still: {wind:?} then {later_wind:?}");
    ensure!(change(&bend, &later_bend) > 0.01, "the bend field stood still: {bend:?} then {later_bend:?}");
    let difference = picture.difference(&later_picture)?;
    ensure!(difference.changed > 0.01, "the picture stood still: {difference:?}");
    Ok(())
}

#[tokio::test(flavor = "multi_thread")]
async fn two_visitors_see_one_track_open_and_rise() -> Result<()> {
    let prairie = Prairie::serve("meadow").await?;
    let (driver, watcher) = tokio::try_join!(prairie.visitor("Ada"), prairie.visitor("Bert"))?;

    driver.press('c').await?;
    driver.release('c').await?;
    driver.until("window.prairie.state().vehicle === 'car' && window.prairie.state().position").await?;
    let start = numbers(&driver, "window.prairie.state().position").await?;
    driver.press('w').await?;
    let far = format!("(p => Math.hypot(p[0] - ({}), p[2] - ({})) > 12)(window.prairie.state().position)", start[0], start[2]);
    driver.until(&far).await?;
    driver.release('w').await?;
    let end = numbers(&driver, "window.prairie.state().position").await?;
    let along = |share: f64, axis: usize| start[axis] + share * (end[axis] - start[axis]);
    let (x, ground_m, z) = (along(0.7, 0), along(0.7, 1), along(0.7, 2));

    let fresh = [bends(&driver, x, z).await?, bends(&watcher, x, z).await?];
    ensure!(strongest(&fresh[0]) > 0.6 && strongest(&fresh[1]) > 0.6, "no track in both mirrors: {fresh:?}");
    let agree = fresh[0].iter().zip(&fresh[1]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    ensure!(agree < 0.35, "the mirrors show different tracks: {fresh:?}");

    driver.press('f').await?;
    driver.release('f').await?;
    let open = tokio::try_join!(look_down(&driver, x, ground_m, z), look_down(&watcher, x, ground_m, z))?;

    let risen =
        format!("Math.max(...Array.from({{length: 17}}, (_, i) => Math.abs(window.prairie.theta({x} + 0.25 * (i - 8), {z})))) < 0.35");
    tokio::try_join!(driver.until(&risen), watcher.until(&risen))?;
    sleep(Duration::from_secs(1)).await;
    let closed = (driver.canvas().await?, watcher.canvas().await?);

    // The wind alone changes pixels too: two looks at the risen grass say how much, and the track must change far more.
    sleep(Duration::from_secs(1)).await;
    let calm = (driver.canvas().await?, watcher.canvas().await?);
    for (name, open, closed, calm) in [("driver", open.0, closed.0, calm.0), ("watcher", open.1, closed.1, calm.1)] {
        let (track, wind) = (open.difference(&closed)?, closed.difference(&calm)?);
        ensure!(track.mean > 1.5 * wind.mean, "the {name}'s pixels show no track: {track:?} against the wind's {wind:?}");
    }
    Ok(())
}
