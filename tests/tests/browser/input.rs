//! Touch and gamepad controls in a real browser.

use anyhow::{Context as _, Result, ensure};
use fantoccini::actions::{InputSource as _, PointerAction, TouchActions};
use prairie::scenes;
use prairie::world::World;
use std::time::Duration;
use tests::browser::{Browser, VIEW};
use tests::prairie::Prairie;

/// Distance (m) exceeded by a driven vehicle, but not by one settling on its springs.
const FAR_M: f64 = 4.0;

async fn meadow() -> Result<Prairie> {
    let meadow = scenes::load("meadow")?;
    let world = World::new(&meadow.scene, meadow.maps())?;
    Prairie::serve(meadow, world).await
}

async fn number(browser: &Browser, field: &str) -> Result<f64> {
    let value = browser.state().await?[field].as_f64();
    value.with_context(|| format!("`{field}` of the client's state is not a number"))
}

/// Waits until the client's vehicle is [`FAR_M`] away from its current position.
async fn goes_far(browser: &Browser) -> Result<()> {
    browser.evaluate("window.start = window.prairie.state().position").await?;
    let way_m = "(p => Math.hypot(p[0] - window.start[0], p[2] - window.start[2]))(window.prairie.state().position)";
    browser.until(&format!("{way_m} > {FAR_M}")).await?;
    Ok(())
}

/// Puts a thumb down at a fraction of the page's width, halfway up, moves it by an offset (px) and holds it there.
async fn put_thumb(browser: &Browser, fraction: f64, by_px: [f64; 2]) -> Result<()> {
    let [x, y] = [fraction * f64::from(VIEW.0), 0.5 * f64::from(VIEW.1)];
    let duration = Some(Duration::from_millis(100));
    let actions = TouchActions::new("thumb".into())
        .then(PointerAction::MoveTo { duration: None, x, y })
        .then(PointerAction::Down { button: 0 })
        .then(PointerAction::MoveBy { duration, x: by_px[0], y: by_px[1] });
    Ok(browser.client().perform_actions(actions).await?)
}

async fn lift_thumb(browser: &Browser) -> Result<()> {
    Ok(browser.client().release_actions().await?)
}

#[tokio::test(flavor = "multi_thread")]
async fn the_left_thumb_drives_and_the_right_thumb_looks_around() -> Result<()> {
    let prairie = meadow().await?;
    let browser = prairie.visitor("Ada").await?;

    let heading_rad = number(&browser, "heading").await?;
    put_thumb(&browser, 0.8, [-80.0, 0.0]).await?;
    // The browser reports moves together with its next picture.
    browser
        .until(&format!("(window.prairie.draw(performance.now() / 1000), Math.abs(window.prairie.state().heading - {heading_rad}) > 0.2)"))
        .await?;
    lift_thumb(&browser).await?;

    browser.evaluate("window.prairie.choose('car')").await?;
    browser.until("window.prairie.state().vehicle === 'car' && window.prairie.state().position").await?;
    put_thumb(&browser, 0.2, [0.0, -64.0]).await?;
    goes_far(&browser).await?;
    ensure!(browser.evaluate("document.getElementById('stick').hidden").await? == false, "no stick below the thumb");
    lift_thumb(&browser).await?;
    browser.until("document.getElementById('stick').hidden").await?;
    browser.until("Math.hypot(...window.prairie.state().velocity) < 0.5").await?;
    Ok(())
}

/// Emulates a gamepad with the standard layout; `window.pad` holds its buttons and axes.
const GAMEPAD: &str = "(() => {
    const value = (value) => ({ value });
    window.pad = {
        axes: [0, 0, 0, 0],
        buttons: Array.from({ length: 17 }, () => Object.create(GamepadButton.prototype, { value: { value: 0, writable: true } })),
    };
    const pad = Object.create(Gamepad.prototype, {
        connected: value(true), mapping: value('standard'), axes: value(window.pad.axes), buttons: value(window.pad.buttons),
    });
    navigator.getGamepads = () => [null, pad];
})()";

#[tokio::test(flavor = "multi_thread")]
async fn a_gamepad_enters_drives_and_leaves_a_car() -> Result<()> {
    let prairie = meadow().await?;
    let browser = prairie.visitor("Bert").await?;
    browser.evaluate(GAMEPAD).await?;

    browser.evaluate("window.pad.buttons[14].value = 1").await?;
    browser.until("window.prairie.state().vehicle === 'car' && window.prairie.state().position").await?;
    browser.evaluate("window.pad.buttons[14].value = 0").await?;
    browser.evaluate("window.pad.buttons[7].value = 1").await?;
    goes_far(&browser).await?;
    browser.evaluate("window.pad.buttons[7].value = 0").await?;
    // The upper shoulder buttons go through all vehicles.
    for (button, vehicle) in [(5, "monster"), (4, "car"), (4, "walker"), (4, "ball")] {
        browser.evaluate(&format!("window.pad.buttons[{button}].value = 1")).await?;
        browser.until(&format!("window.prairie.state().vehicle === '{vehicle}'")).await?;
        browser.evaluate(&format!("window.pad.buttons[{button}].value = 0")).await?;
        browser.until("(window.polled = (window.polled ?? 0) + 1) % 4 === 0").await?;
    }
    browser.evaluate("window.pad.buttons[13].value = 1").await?;
    browser.until("window.prairie.state().objects === 0").await?;
    Ok(())
}
