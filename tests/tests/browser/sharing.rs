//! Saved pictures, links and quality, in a real browser.

use anyhow::{Context as _, Result, ensure};
use prairie::charts::image::Picture;
use prairie::charts::worlds;
use prairie::scenes;
use prairie::world::World;
use serde_json::{Value, json};
use tests::browser::{Browser, VIEW};
use tests::prairie::Prairie;

/// The meadow without underbrush, which takes half the time to draw.
async fn meadow() -> Result<Prairie> {
    let mut meadow = scenes::load("meadow")?;
    meadow.scene.underbrush.clear();
    let world = World::new(&meadow.scene, meadow.maps())?;
    Prairie::serve(meadow, world).await
}

/// File saved by the picture button, with its name.
async fn taken(browser: &Browser) -> Result<(String, Picture)> {
    let bytes = "window.prairie.picture().then(async ({ name, blob }) => [name, Array.from(new Uint8Array(await blob.arrayBuffer()))])";
    let taken = browser.evaluate(bytes).await?;
    let png: Vec<u8> = serde_json::from_value(taken[1].clone())?;
    Ok((taken[0].as_str().context("the picture has a name")?.to_owned(), Picture::from_png(&png)?))
}

#[tokio::test(flavor = "multi_thread")]
async fn a_saved_picture_equals_the_canvas_and_is_named_after_scene_and_view() -> Result<()> {
    let prairie = meadow().await?;
    let browser = prairie.visitor_at("?quality=low&panel=0#128,9,140,20,-6").await?;
    browser.evaluate("window.prairie.draw(1)").await?;
    let (name, picture) = taken(&browser).await?;
    ensure!(name == "prairie-meadow-128.00_9.00_140.00_20.00_-6.00.png", "the picture is called {name}");
    ensure!((picture.width, picture.height) == VIEW, "the picture has {} × {} px", picture.width, picture.height);
    let difference = picture.difference(&browser.canvas().await?)?;
    ensure!(difference.changed < 0.01, "the picture is not what is seen: {difference:?}");
    let [red, _, blue, alpha] = picture.pixel(VIEW.0 / 2, 4);
    ensure!(alpha == 255 && blue > red, "no sky at the top of the picture");
    Ok(())
}

#[tokio::test(flavor = "multi_thread")]
async fn a_link_restores_the_view_or_reports_why_not() -> Result<()> {
    let prairie = meadow().await?;
    let browser = prairie.visitor_at("?quality=low&panel=0&far=clumps&compare=cut,land&at=0.25#120,7.5,130,250,-10").await?;
    browser.until("new URLSearchParams(location.search).get('scene') === 'meadow'").await?;
    let seen = "(({ scene_name, view, far, compared, at, quality }) => ({ scene_name, view, far, compared, at, quality }))(window.prairie.state())";
    let before = browser.evaluate(seen).await?;
    let ways = (&before["far"], &before["compared"], &before["at"]);
    ensure!(ways == (&json!("clumps"), &json!(["cut", "land"]), &json!(0.25)), "the page draws {before}");
    let link = browser.evaluate("window.prairie.link()").await?;
    let link = link.as_str().context("a link")?;
    let [query, hash] = [link.find('?'), link.find('#')].map(Option::unwrap_or_default);
    ensure!(link[query..].starts_with("?scene=meadow&") && !link.contains("panel"), "the link is {link}");

    browser.go(&prairie.url(&link[query..])).await?;
    browser.until("(s => s && s.view)(window.prairie.state())").await?;
    let after = browser.evaluate(seen).await?;
    ensure!(after == before, "the link shows {after} instead of {before}");

    browser.go(&prairie.url(&format!("?scene=jacksboro&panel=0{}", &link[hash..]))).await?;
    browser.until("document.getElementById('message').dataset.kind === 'other-scene'").await?;
    let said = browser.evaluate("document.getElementById('message').innerText").await?;
    let said = said.as_str().unwrap_or_default();
    for words in ["jacksboro", "meadow", "prairie serve --scene jacksboro"] {
        ensure!(said.contains(words), "the page says {said}");
    }
    ensure!(browser.state().await?["view"] == Value::Null, "the link's view is shown in another scene");
    browser.click("#message button").await?;
    browser.until("(s => s && s.view)(window.prairie.state())").await?;
    browser.until("document.getElementById('message').hidden").await?;
    Ok(())
}

#[tokio::test(flavor = "multi_thread")]
async fn two_render_options_are_compared_across_a_movable_border() -> Result<()> {
    let prairie = meadow().await?;
    let browser = prairie.visitor_at("?quality=low&panel=0&compare=clumps,land").await?;
    ensure!(browser.evaluate("document.getElementById('border').hidden").await? == json!(false), "no border");
    browser.evaluate("window.prairie.draw(1)").await?;
    browser.evaluate("document.getElementById('border').focus()").await?;
    // Arrow right, then End.
    for (key, at) in [('\u{e014}', 0.52), ('\u{e010}', 1.0)] {
        browser.press(key).await?;
        browser.release(key).await?;
        browser.until(&format!("Math.abs(window.prairie.state().at - {at}) < 1e-3")).await?;
        browser.until(&format!("Math.abs(new URLSearchParams(location.search).get('at') - {at}) < 1e-3")).await?;
    }
    browser.evaluate("window.prairie.draw(2)").await?;
    let (_, picture) = taken(&browser).await?;
    let apart = picture.difference(&browser.canvas().await?)?.changed;
    // The line itself is on the canvas, but not in the saved picture.
    ensure!(apart < 0.02, "{apart} of the picture is not what is seen");

    browser.go(&prairie.url("?quality=low&panel=1&compare=clumps,nonsense")).await?;
    browser.until("(s => s && s.view)(window.prairie.state())").await?;
    ensure!(browser.state().await?["compared"] == Value::Null, "a way that does not exist is compared");
    browser.until("document.getElementById('message').hidden").await?;
    browser.click("#comparing").await?;
    browser.until("(s => s.compared && s.compared.join() === 'clumps,shells')(window.prairie.state())").await?;
    browser.click("#comparing").await?;
    browser.until("window.prairie.state().compared === null && document.getElementById('border').hidden").await?;
    Ok(())
}

#[tokio::test(flavor = "multi_thread")]
async fn quality_is_automatic_until_it_is_set() -> Result<()> {
    let prairie = meadow().await?;
    let browser = prairie.visitor_at("?panel=1&budget=250").await?;
    let state = browser.state().await?;
    let level = state["level"].as_f64().context("a level")?;
    let budget_ms = state["budget_ms"].as_f64();
    ensure!(state["automatic"] == json!(true) && budget_ms == Some(250.0) && (0.0..=3.0).contains(&level), "{state}");
    browser.evaluate("window.prairie.draw(1)").await?;
    ensure!(browser.state().await?["cpu_ms"].as_f64() > Some(0.0), "a frame took the processor no time");

    let choose = "(select => (select.value = 'low', select.dispatchEvent(new Event('change'))))(document.getElementById('quality'))";
    browser.evaluate(choose).await?;
    browser.until("(s => !s.automatic && s.quality === 'low' && s.level === 0)(window.prairie.state())").await?;
    browser.until("new URLSearchParams(location.search).get('quality') === 'low'").await?;
    browser.evaluate("window.prairie.draw(2)").await?;
    Ok(())
}

#[tokio::test(flavor = "multi_thread")]
async fn automatic_quality_keeps_the_frame_time_and_the_detail_of_the_scene() -> Result<()> {
    let mut hills = worlds::loaded_hills(|_| 0)?;
    (hills.scene.budget.client_ms, hills.scene.plants.highest_detail) = (60.0, 0.5);
    let world = World::new(&hills.scene, hills.maps())?;
    let prairie = Prairie::serve(hills, world).await?;
    let browser = prairie.visitor_at("?panel=1").await?;
    browser.until("(s => s.automatic && Math.abs(s.budget_ms - 60) < 0.01 && s.highest_level === 0.5)(window.prairie.state())").await?;
    browser.until("document.getElementById('detail').innerText.includes('of 0.5 · target 60 ms')").await?;
    browser.evaluate("window.prairie.draw(40)").await?;
    let level = browser.state().await?["level"].as_f64().context("a level")?;
    ensure!(level <= 0.5, "level {level}");
    // The address wins over the scene's frame time.
    browser.go(&prairie.url("?panel=1&budget=250")).await?;
    browser.until("(s => s && s.highest_level === 0.5 && Math.abs(s.budget_ms - 250) < 0.01)(window.prairie.state())").await?;
    Ok(())
}
