//! The page simulates the grass itself, in wasm, and the server's checksums find no difference.

use anyhow::{Context as _, Result, ensure};
use prairie::scenes;
use prairie::world::World;
use std::time::Duration;
use tests::prairie::Prairie;
use tokio::time::sleep;

/// Simulated time for which the page is watched (s): every patch is checked once in each second. `PRAIRIE_REPLICA_SECS=167` watches 10 000 steps, and stays below
/// the time limit of a test.
fn watched_secs() -> Result<f64> {
    std::env::var("PRAIRIE_REPLICA_SECS").map_or(Ok(12.0), |secs| secs.parse().context("PRAIRIE_REPLICA_SECS is a number of seconds"))
}

#[tokio::test(flavor = "multi_thread")]
async fn the_page_has_a_replica_without_a_difference() -> Result<()> {
    let mut meadow = scenes::load("meadow")?;
    meadow.scene.underbrush.clear();
    (meadow.scene.objects.self_driving, meadow.scene.objects.balls) = (3, 3);
    let world = World::new(&meadow.scene, meadow.maps())?;
    let prairie = Prairie::serve(meadow, world).await?;
    let browser = prairie.visitor_at("?quality=low&panel=1#128,6,140,20,-8").await?;
    let watched_secs = watched_secs()?;
    let (mut began_secs, mut steps) = (None, [0.0; 2]);
    for _ in 0..(2.0 * watched_secs) as usize + 96 {
        sleep(Duration::from_millis(500)).await;
        let state = browser.state().await?;
        let time_secs = state["time_secs"].as_f64().context("a time")?;
        match (state["replica"].as_bool(), began_secs) {
            (Some(true), None) => (began_secs, steps[0]) = (Some(time_secs), state["tick"].as_f64().context("a step")?),
            (Some(true), Some(began)) if time_secs - began > watched_secs => break,
            // A machine that draws in software may fall behind and take patches for a while; it must not differ.
            _ => {}
        }
    }
    let state = browser.state().await?;
    let metrics = browser.evaluate("(async () => (await fetch('/metrics')).text())()").await?;
    let metrics = metrics.as_str().context("the metrics are text")?;
    let metric = |name: &str| metrics.lines().find(|line| line.starts_with(name)).map(str::to_owned).with_context(|| name.to_owned());
    steps[1] = state["tick"].as_f64().context("a step")?;
    println!(
        "{} steps, replica: {} %, {}",
        steps[1] - steps[0],
        100.0 * state["replica_share"].as_f64().unwrap_or_default(),
        metric("prairie_replicas ")?
    );
    ensure!(began_secs.is_some(), "the page had no replica within a minute: {state}");
    ensure!(metric("prairie_replica_differences_total ")? == "prairie_replica_differences_total 0", "the replica differed");
    let shown = browser.evaluate("document.getElementById('grass').textContent").await?;
    ensure!(shown.as_str().is_some_and(|text| text.starts_with("simulated here") || text == "from the server"), "the panel shows {shown}");
    Ok(())
}
