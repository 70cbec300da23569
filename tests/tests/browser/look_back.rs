//! Looking back in a real browser: by the time bar, by keys and by the console.

use anyhow::{Context as _, Result, ensure};
use prairie::scenes;
use prairie::world::World;
use serde_json::{Value, json};
use tests::prairie::Prairie;

/// A meadow without wind and underbrush.
async fn still_meadow() -> Result<Prairie> {
    let mut meadow = scenes::load("meadow")?;
    meadow.scene.underbrush.clear();
    meadow.scene.wind.mean_m_per_s = [0.0; 2];
    let world = World::new(&meadow.scene, meadow.maps())?;
    Prairie::serve(meadow, world).await
}

#[tokio::test(flavor = "multi_thread")]
async fn a_visitor_looks_back_at_the_grass_before_a_car_and_returns() -> Result<()> {
    let prairie = still_meadow().await?;
    let browser = prairie.visitor_at("?quality=low&panel=1").await?;
    browser.until("window.prairie.state().recorded_secs > 3").await?;
    let before_tick = browser.state().await?["tick"].as_u64().context("a tick")?;
    browser.evaluate("window.prairie.choose('car')").await?;
    browser.until("window.prairie.state().position").await?;
    let at = browser.state().await?["position"].clone();
    let bend = format!("Math.hypot(...window.prairie.bend({}, {}))", at[0], at[2]);
    browser.until(&format!("{bend} > 0.3")).await?;
    browser.until("!document.getElementById('time-bar').hidden && window.prairie.state().recorded_secs > 6").await?;

    // A moment before the car, chosen on the slider.
    let choose = format!(
        "(slider => {{ const {{ tick, recorded_secs }} = window.prairie.state(); slider.min = -recorded_secs; slider.value = -(tick - {before_tick}) / 60;
            for (const kind of ['input', 'change']) slider.dispatchEvent(new Event(kind)) }})(document.getElementById('moment'))"
    );
    browser.evaluate(&choose).await?;
    browser.until(&format!("!window.prairie.state().is_live && {bend} === 0")).await?;
    browser.until("/^\\d+ s ago$/.test(document.getElementById('moment').getAttribute('aria-valuetext'))").await?;
    let state = browser.state().await?;
    let shown_tick = state["shown_tick"].as_u64().context("a tick")?;
    ensure!(shown_tick.abs_diff(before_tick) < 60 && state["is_playing"] == json!(false), "before step {before_tick}: {state}");
    browser.evaluate("window.prairie.draw(window.prairie.state().time_secs)").await?;

    // Time goes on while frames are drawn; the others drive on meanwhile.
    browser.click("#run").await?;
    browser.until("window.prairie.state().is_playing && document.activeElement.id === 'view'").await?;
    browser.evaluate("window.prairie.draw(window.prairie.state().time_secs)").await?;
    browser.until(&format!("window.prairie.draw(0) && window.prairie.state().shown_tick > {shown_tick}")).await?;
    ensure!(browser.state().await?["tick"].as_u64() > Some(shown_tick + 60), "the live mirror stands still");
    browser.click("#live").await?;
    browser.until(&format!("window.prairie.state().is_live && {bend} > 0.3")).await?;

    // Keys.
    for (key, wanted) in [
        (',', "!state.is_live && state.behind_secs > 0.5 && state.behind_secs < 3"),
        ('.', "state.behind_secs < 2.5"),
        ('r', "state.is_live"),
        ('t', "!state.is_live && !state.is_playing"),
        ('c', "state.is_live && state.is_playing"),
    ] {
        browser.press(key).await?;
        browser.release(key).await?;
        browser.until(&format!("(state => {wanted})(window.prairie.state())")).await.with_context(|| format!("after the key {key}"))?;
    }
    let console = browser.console();
    ensure!(!console.to_lowercase().contains("content security policy"), "the page breaks its own policy:\n{console}");
    Ok(())
}

#[tokio::test(flavor = "multi_thread")]
async fn without_controls_there_is_no_time_bar() -> Result<()> {
    let prairie = still_meadow().await?;
    let browser = prairie.visitor_at("?quality=low&panel=0").await?;
    browser.until("window.prairie.state().recorded_secs > 5.5").await?;
    ensure!(browser.evaluate("document.getElementById('time-bar').hidden").await? == Value::Bool(true), "the bar is shown");
    browser.evaluate("window.prairie.look_back(2)").await?;
    browser.until("(s => s.shown_tick < s.tick - 60)(window.prairie.state())").await?;
    browser.evaluate("window.prairie.live()").await?;
    browser.until("window.prairie.state().is_live").await?;
    Ok(())
}
