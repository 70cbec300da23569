//! Sound in a real browser: off until someone asks, then it follows wind and engines, and stops while the page is hidden.

use anyhow::{Context as _, Result, ensure};
use fantoccini::key::Key;
use prairie::scenes;
use prairie::world::World;
use serde_json::Value;
use tests::browser::Browser;
use tests::prairie::Prairie;

/// Largest difference (m/s) between the wind that is played and that of the client: gusts pass between two updates of the sound.
const GUST_M_PER_S: f64 = 1.0;

/// A visitor of the meadow in a steady wind, with the panel.
async fn visitor() -> Result<(Prairie, Browser)> {
    let mut meadow = scenes::load("meadow")?;
    meadow.scene.wind.mean_m_per_s = [8.0, 0.0];
    let world = World::new(&meadow.scene, meadow.maps())?;
    let prairie = Prairie::serve(meadow, world).await?;
    let browser = prairie.visitor_at("?quality=low&panel=1&name=Ada").await?;
    Ok((prairie, browser))
}

async fn sound(browser: &Browser) -> Result<Value> {
    browser.evaluate("window.prairie.sound()").await
}

async fn is_pressed(browser: &Browser) -> Result<Value> {
    browser.evaluate("document.getElementById('sound').getAttribute('aria-pressed')").await
}

async fn tap(browser: &Browser, key: impl Into<char> + Copy) -> Result<()> {
    browser.press(key).await?;
    browser.release(key).await
}

/// Moves the camera to a height above the ground and waits until its wind is played; returns the gain.
async fn wind_gain_at(browser: &Browser, height_m: f64) -> Result<f64> {
    let look = format!("(s => window.prairie.look([s.eye[0], s.eye[1] - s.height + {height_m}, s.eye[2]], 0, 0))(window.prairie.state())");
    browser.evaluate(&look).await?;
    let gain = format!(
        "((played, s) => s.height.toFixed(1) === ({height_m}).toFixed(1) && played.gain > 0 \
         && Math.abs(played.m_per_s - Math.hypot(...window.prairie.wind(...s.eye))) < {GUST_M_PER_S} && played.gain)\
         (window.prairie.sound().wind, window.prairie.state())"
    );
    browser.until(&gain).await?.as_f64().context("a gain")
}

#[tokio::test(flavor = "multi_thread")]
async fn sound_starts_when_asked_and_follows_wind_and_speed() -> Result<()> {
    let (_prairie, browser) = visitor().await?;
    let silent = sound(&browser).await?;
    ensure!(silent["on"] == false && silent["context"] == "none", "there is sound before anyone has asked: {silent}");

    browser.click("#sound").await?;
    browser.until("(s => s.on && s.context === 'running' && s.level > 0.001)(window.prairie.sound())").await?;
    ensure!(is_pressed(&browser).await? == "true", "the button does not show that it is on");
    let (low, high) = (wind_gain_at(&browser, 0.3).await?, wind_gain_at(&browser, 30.0).await?);
    ensure!(high > 1.2 * low, "the wind is as loud among the blades ({low}) as high above them ({high})");

    browser.evaluate("window.prairie.choose('car')").await?;
    let pitch = "window.prairie.sound().engines[0]?.pitch_hz";
    let idle_hz = browser.until(pitch).await?.as_f64().context("a pitch")?;
    browser.press('w').await?;
    browser.until(&format!("{pitch} > {idle_hz} + 15")).await?;
    browser.release('w').await?;
    browser.evaluate("window.prairie.choose('')").await?;
    browser.until("window.prairie.sound().engines.length === 0").await?;
    Ok(())
}

#[tokio::test(flavor = "multi_thread")]
async fn sound_stops_while_hidden_and_works_by_keyboard() -> Result<()> {
    let (_prairie, browser) = visitor().await?;
    tap(&browser, 'n').await?;
    let runs = "window.prairie.sound().context === 'running'";
    browser.until(runs).await?;

    let hide = "(Object.defineProperty(document, 'hidden', { value: true, configurable: true }), document.dispatchEvent(new Event('visibilitychange')))";
    browser.evaluate(hide).await?;
    browser.until("window.prairie.sound().context === 'suspended'").await?;
    browser.evaluate("(delete document.hidden, document.dispatchEvent(new Event('visibilitychange')))").await?;
    browser.until(runs).await?;

    let volume = "document.getElementById('volume')";
    browser.evaluate(&format!("({volume}.value = 0, {volume}.dispatchEvent(new Event('input', {{ bubbles: true }})))")).await?;
    browser.until("(s => s.context === 'running' && s.volume === 0 && s.level < 1e-4)(window.prairie.sound())").await?;
    ensure!(browser.evaluate(&format!("{volume}.getAttribute('aria-valuetext')")).await? == "0 %", "the volume is not said");
    ensure!(browser.evaluate("localStorage.getItem('prairie.volume')").await? == "0", "the volume is not remembered");

    browser.evaluate("document.getElementById('sound').focus()").await?;
    tap(&browser, Key::Enter).await?;
    browser.until("window.prairie.sound().context === 'suspended'").await?;
    ensure!(is_pressed(&browser).await? == "false" && sound(&browser).await?["on"] == false, "the button does not show that it is off");
    Ok(())
}
