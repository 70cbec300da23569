//! The menu of scenes, in a real browser.

use anyhow::{Context as _, Result, ensure};
use prairie::scenes;
use serde_json::json;
use tests::browser::Browser;
use tests::prairie::Prairie;

/// Text of the menu's note.
async fn note(browser: &Browser) -> Result<String> {
    let note = browser.evaluate("document.getElementById('scenes-note').textContent").await?;
    Ok(note.as_str().context("a text")?.to_owned())
}

#[tokio::test(flavor = "multi_thread")]
async fn the_menu_changes_the_scene_for_everyone() -> Result<()> {
    let prairie = Prairie::serve_with_menu(scenes::load("shells")?).await?;
    let browser = prairie.visitor_at("?quality=low&panel=1").await?;
    browser.until("new URLSearchParams(location.search).get('scene') === 'shells'").await?;
    let other = prairie.visitor_at("?quality=low&panel=0&scene=shells#64,9,64,20,-6").await?;
    browser.press('o').await?;
    browser.release('o').await?;
    browser.until(&format!("document.querySelectorAll('#scene-list .card').length === {}", scenes::list().count())).await?;
    let current = "document.querySelector('#scene-list [aria-current] b').textContent";
    ensure!(browser.evaluate(current).await? == json!("shells (running)"), "another scene is marked");
    let card = "document.querySelector('#scene-list [data-scene=\"prairie-2000\"]')";
    browser.until(&format!("(image => image.complete && image.naturalWidth === 256)({card}.querySelector('img'))")).await?;
    let text = browser.evaluate(&format!("{card}.innerText")).await?;
    ensure!(text.as_str().is_some_and(|text| text.contains("stable fluids (Stam 1999; Zhang §2.3)")), "the card says {text}");

    browser.click("#scene-list [data-scene=\"history\"]").await?;
    for page in [&browser, &other] {
        page.until("(s => s && s.connected && s.scene_name === 'history')(window.prairie.state())").await?;
        page.until("document.getElementById('message').hidden").await?;
        page.until("new URLSearchParams(location.search).get('scene') === 'history'").await?;
    }
    browser.until("!document.getElementById('scenes').open").await?;
    // Both are at the new scene's start, not where they were.
    let height_m = "window.prairie.state().view.split(',')[2]";
    let starts = [browser.evaluate(height_m).await?, other.evaluate(height_m).await?];
    ensure!(starts[0] == starts[1], "the pages look from {starts:?}");
    prairie.stop().await
}

#[tokio::test(flavor = "multi_thread")]
async fn a_server_that_keeps_its_scene_shows_commands_instead() -> Result<()> {
    let shells = scenes::load("shells")?;
    let world = prairie::world::World::new(&shells.scene, shells.maps())?;
    let prairie = Prairie::serve(shells, world).await?;
    let browser = prairie.visitor_at("?quality=low&panel=1").await?;
    browser.click("#show-scenes").await?;
    browser.until("document.querySelectorAll('#scene-list .card code').length > 0").await?;
    ensure!(browser.evaluate("document.querySelectorAll('#scene-list button').length").await? == json!(0), "there are buttons");
    ensure!(note(&browser).await?.starts_with("This server keeps its scene."), "{}", note(&browser).await?);
    browser.press('\u{e00c}').await?;
    browser.until("!document.getElementById('scenes').open").await?;
    prairie.stop().await
}
