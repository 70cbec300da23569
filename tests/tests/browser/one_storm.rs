//! Two browsers in one storm: both show the same gusts at the same simulated time.

use anyhow::{Context as _, Result, ensure};
use prairie::charts::image::Picture;
use prairie::scenes;
use prairie::world::World;
use std::time::Duration;
use tests::browser::Browser;
use tests::prairie::Prairie;

const VIEW: &str = "?quality=low&panel=0#128,6,140,20,-8";

/// Channel difference (of 255) that counts as visible.
const VISIBLE: u8 = 16;
/// Largest fraction of the pixels that may differ visibly.
const BOUND: f64 = 0.001;

/// Draws the moment `time_secs` and takes the picture.
async fn drawn(browser: &Browser, time_secs: f64) -> Result<Picture> {
    browser.evaluate(&format!("window.prairie.draw({time_secs})")).await?;
    browser.canvas().await
}

/// Fraction of the pixels that differ visibly.
fn differing(a: &Picture, b: &Picture) -> f64 {
    let pixels = a.rgba.chunks_exact(4).zip(b.rgba.chunks_exact(4));
    let differing = pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > VISIBLE)).count();
    differing as f64 / f64::from(a.width * a.height)
}

/// A moment (s) whose wind both browsers have: a second before the newest frame of the one that is behind. Pages keep the wind for 15 s.
async fn known_to_both(first: &Browser, second: &Browser) -> Result<f64> {
    let (first, second) = tokio::try_join!(first.state(), second.state())?;
    let times = [first, second].map(|state| state["time_secs"].as_f64());
    Ok(times[0].zip(times[1]).map(|(first, second)| first.min(second)).context("a time of both")? - 1.0)
}

/// Seconds between the arrivals of the two browsers: 30, or as many as `PRAIRIE_APART_SECS` says.
fn apart_secs() -> Result<u64> {
    std::env::var("PRAIRIE_APART_SECS").map_or(Ok(30), |secs| secs.parse().context("PRAIRIE_APART_SECS is a number of seconds"))
}

#[tokio::test(flavor = "multi_thread")]
async fn two_browsers_show_the_same_storm() -> Result<()> {
    let mut storm = scenes::load("storm")?;
    storm.scene.underbrush.clear();
    let world = World::new(&storm.scene, storm.maps())?;
    let prairie = Prairie::serve(storm, world).await?;
    let first = prairie.visitor_at(VIEW).await?;
    tokio::time::sleep(Duration::from_secs(apart_secs()?)).await;
    let second = prairie.visitor_at(VIEW).await?;
    // The first frame of a page compiles its pipelines.
    for browser in [&first, &second] {
        drawn(browser, 1.0).await?;
    }
    let time_secs = known_to_both(&first, &second).await?;
    let draw = format!("window.prairie.draw({time_secs})");
    let (one, other) = tokio::join!(first.evaluate(&draw), second.evaluate(&draw));
    one.and(other)?;
    let [a, b] = [first.canvas().await?, second.canvas().await?];
    let apart = differing(&a, &b);
    // As a check of the check: the storm a moment before is another one.
    let before = drawn(&second, time_secs - 0.2).await?;
    let moved = differing(&b, &before);
    println!("{:.4} % of the pixels differ between the browsers, {:.2} % from the storm 0.2 s before", 100.0 * apart, 100.0 * moved);
    ensure!(apart < BOUND, "{:.3} % of the pixels differ", 100.0 * apart);
    ensure!(moved > 20.0 * BOUND, "only {:.3} % of the pixels change in 0.2 s", 100.0 * moved);
    Ok(())
}

#[tokio::test(flavor = "multi_thread")]
async fn the_console_and_the_http_api_have_the_same_wind_to_the_bit() -> Result<()> {
    let mut meadow = scenes::load("meadow")?;
    meadow.scene.underbrush.clear();
    let world = World::new(&meadow.scene, meadow.maps())?;
    let prairie = Prairie::serve(meadow, world).await?;
    let browser = prairie.visitor("reader").await?;
    // Asks the server until it answers for the step that the page has.
    let same = "(async () => {
        for (let attempt = 0; attempt < 200; attempt++) {
            const places = [[100, 40, 90], [33.3, 12.5, 201.7], [128, 3, 128]];
            const answer = await (await fetch('/api/wind', { method: 'POST', body: JSON.stringify({ at_m: places }) })).json();
            const found = places.map((place) => window.prairie.wind(...place));
            if (window.prairie.wind_tick() === answer.wind_tick) return [found, answer.wind_m_per_s.map((wind) => wind.map(Math.fround))];
        }
        return null;
    })()";
    let winds = browser.evaluate(same).await?;
    let [page, server] = [&winds[0], &winds[1]];
    ensure!(page == server && page[0][0].as_f64().is_some_and(|speed| speed != 0.0), "the page has {page}, the server {server}");
    Ok(())
}
