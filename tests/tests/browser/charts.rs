//! The page of charts, as a server shows it: under its own security policy, with hover, filters and links that keep them.

use anyhow::{Result, ensure};
use prairie::charts::worlds;
use prairie::detail::Demands;
use prairie::scenes::{self, Explanation, LoadedScene};
use prairie::world::World;
use serde_json::json;
use std::sync::Arc;
use tests::browser::Browser;
use tests::prairie::Prairie;

/// Text of the tooltip while the pointer is on the second run of the first chart.
const HOVER: &str = "(() => {
    const run = document.querySelectorAll('article .line polygon')[1], { x, y, width, height } = run.getBoundingClientRect();
    const at = { clientX: x + width / 2, clientY: y + height / 2, bubbles: true, pointerType: 'mouse' };
    for (const kind of ['pointerover', 'pointerenter', 'pointermove']) run.dispatchEvent(new PointerEvent(kind, at));
    const tip = document.getElementById('tip');
    return tip.hidden ? '' : tip.innerText;
})()";

/// Number of charts, maps and figures in view.
const SHOWN: &str = "[...document.querySelectorAll('article')].filter((chart) => chart.checkVisibility()).length";

#[tokio::test(flavor = "multi_thread")]
async fn the_panel_shows_methods_and_what_is_left_out() -> Result<()> {
    let hills = worlds::loaded_hills(|_| 0)?;
    let world = World::new(&hills.scene, hills.maps())?;
    let loaded = scenes::load("meadow")?;
    let hills = LoadedScene { explanation: loaded.explanation, ..hills };
    let prairie = Prairie::serve(hills, world).await?;
    let browser = prairie.visitor_at("?quality=low").await?;
    browser.evaluate("(document.getElementById('plan').open = true)").await?;
    let text = browser.until("document.getElementById('plan-parts').innerText").await?;
    for word in [
        "wind that the grass feels",
        "conservative + runge-kutta-3",
        "bending of the grass",
        "LEFT OUT",
        "`prairie explain".trim_matches('`'),
    ] {
        ensure!(text.as_str().is_some_and(|text| text.to_lowercase().contains(&word.to_lowercase())), "no {word} in {text}");
    }
    Ok(())
}

#[tokio::test(flavor = "multi_thread")]
async fn the_panel_sets_the_budget_and_shows_what_gives_way() -> Result<()> {
    let hills = worlds::loaded_hills(|_| 0)?;
    let demands = Demands { server_ms: 1000.0, ..Demands::default() };
    let hills = LoadedScene { explanation: Arc::new(Explanation { demands: Some(demands), ..Explanation::default() }), ..hills };
    let prairie = Prairie::serve_with_menu(hills).await?;
    let browser = prairie.visitor_at("?quality=low").await?;
    browser.evaluate("(document.getElementById('plan').open = true)").await?;
    let now = browser.until("document.getElementById('plan-now').innerText").await?;
    ensure!(now.as_str().is_some_and(|now| now.contains("ms of 1000 ms") && now.contains("Wind stepped every")), "{now}");
    browser.until("document.querySelector('#plan-now input')").await?;
    browser
        .evaluate("(document.querySelector('#plan-now input').value = '0.001', document.querySelector('#plan-now form').requestSubmit())")
        .await?;
    browser.until("document.getElementById('plan-now').innerText.includes('the wind is stepped every 12 ticks instead of 3')").await?;
    let decisions = browser.evaluate("document.getElementById('plan-now').innerText").await?;
    ensure!(
        decisions.as_str().is_some_and(|text| text.contains("overload: ") && text.contains("budget 0.001 ms → wind stepped every")),
        "{decisions}"
    );
    Ok(())
}

#[tokio::test(flavor = "multi_thread")]
async fn the_charts_of_the_program_are_hovered_filtered_and_linked() -> Result<()> {
    let hills = worlds::loaded_hills(|_| 0)?;
    let world = World::new(&hills.scene, hills.maps())?;
    let prairie = Prairie::serve(hills, world).await?;
    let url = format!("http://{}/charts", prairie.addr);
    let browser = Browser::open(&url).await?;
    let all = browser.evaluate(SHOWN).await?.as_u64().unwrap_or_default();
    ensure!(all > 20, "{all} charts");
    let about = browser.evaluate("document.getElementById('about').innerText").await?;
    ensure!(about.as_str().is_some_and(|about| about.contains("prairie") && about.contains(" core")), "no machine in {about}");

    let tip = browser.evaluate(HOVER).await?;
    ensure!(
        ["cells", "Time step", "L2", "max"]
            .iter()
            .all(|word| tip.as_str().is_some_and(|tip| tip.to_lowercase().contains(&word.to_lowercase()))),
        "{tip}"
    );

    browser.evaluate("(document.getElementById('text').value = 'cavity', document.getElementById('text').dispatchEvent(new Event('input', { bubbles: true })))").await?;
    browser.until("location.hash.includes('cavity')").await?;
    let cavities = browser.evaluate(SHOWN).await?;
    ensure!(cavities.as_u64().is_some_and(|shown| (1..5).contains(&shown)), "{cavities} charts of the cavity");
    let link = browser.evaluate("location.href").await?;
    browser.go("about:blank").await?;
    browser.go(link.as_str().unwrap_or_default()).await?;
    ensure!(browser.evaluate(SHOWN).await? == cavities, "the link shows other charts");

    // The policy allows no other script, and no connection.
    let inline = "(() => { const script = document.createElement('script'); script.textContent = 'window.ran = true'; document.body.append(script); return window.ran ?? false; })()";
    ensure!(browser.evaluate(inline).await? == json!(false), "an added script ran");
    let fetched = browser.evaluate("fetch('/healthz').then(() => true, () => false)").await?;
    ensure!(fetched == json!(false), "the page made a connection");
    Ok(())
}
