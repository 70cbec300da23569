//! Latency of inputs in a real browser, with and without a prediction.

use std::time::Duration;

use anyhow::{Context as _, Result, ensure};
use prairie::charts::worlds;
use prairie::world::World;
use tests::browser::Browser;
use tests::prairie::Prairie;
use tests::slow_line::slow_line;

/// Size of the page (CSS pixels): small, since drawing in software must not take longer than what is measured.
const SMALL: [u32; 2] = [160, 100];
/// Delay of the line in each direction: longer than a picture takes to draw on a busy machine.
const ONE_WAY: Duration = Duration::from_millis(150);

/// Presses and releases `W` every 0.4 s for 8 s, draws all the while, and returns the state.
const DRIVE: &str = "(async () => {
    const began = performance.now();
    let frames = 0;
    for (let presses = 0; presses < 20;) {
        if (performance.now() > began + 400 * presses) {
            const event = presses++ % 2 ? 'keyup' : 'keydown';
            window.dispatchEvent(new KeyboardEvent(event, { code: 'KeyW', key: 'w' }));
        }
        await window.prairie.draw(performance.now() / 1000);
        frames++;
    }
    return { ...window.prairie.state(), pictures: frames };
})()";

/// Times to the picture and to the server (ms), and whether the vehicle was predicted.
async fn latencies(browser: &Browser) -> Result<(f64, f64, bool)> {
    let state = browser.evaluate(DRIVE).await?;
    println!("{} pictures", state["pictures"]);
    let number = |field: &str| state[field].as_f64().with_context(|| format!("{field} of {state}"));
    Ok((number("input_to_picture_ms")?, number("input_to_server_ms")?, state["predicting"] == true))
}

#[tokio::test(flavor = "multi_thread")]
async fn a_prediction_shows_an_input_before_the_server_does() -> Result<()> {
    // Bare land in still air, which is quickly simulated, and drawn quickly in software.
    let mut hills = worlds::loaded_hills(|_| 0)?;
    (hills.scene.wind.mean_m_per_s, hills.scene.wind.sources) = ([0.0; 2], 0);
    let world = World::new(&hills.scene, hills.maps())?;
    let mut prairie = Prairie::serve(hills, world).await?;
    prairie.addr = slow_line(prairie.addr, ONE_WAY).await?;
    let browser = prairie.visitor("Ada").await?;
    browser.resize(SMALL).await?;
    browser.evaluate("window.prairie.choose('car')").await?;
    browser.until("window.prairie.state().vehicle === 'car' && window.prairie.state().position").await?;

    // The first pictures take longer, since pipelines are compiled for them.
    browser.evaluate("(async () => { for (let n = 0; n < 10; n++) await window.prairie.draw(performance.now() / 1000) })()").await?;
    let predicted = latencies(&browser).await?;
    browser.evaluate("window.prairie.predict(false)").await?;
    let interpolated = latencies(&browser).await?;
    println!("input to picture, input to server (ms), predicted: {predicted:.1?}, then {interpolated:.1?}");
    ensure!(predicted.2 && !interpolated.2, "{predicted:?}, then {interpolated:?}");
    ensure!(predicted.0 > 0.0 && predicted.0 < interpolated.0, "the picture is not earlier: {predicted:?}, then {interpolated:?}");
    ensure!(predicted.0 < predicted.1, "the server was faster: {predicted:?}");
    let round_trip_ms = 2e3 * ONE_WAY.as_secs_f64();
    ensure!(predicted.1 > round_trip_ms && interpolated.1 > round_trip_ms, "there and back in less time than it takes");
    ensure!(interpolated.0 > interpolated.1, "interpolated before the server's pose: {interpolated:?}");
    Ok(())
}
