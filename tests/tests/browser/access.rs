//! The page for everyone: by keyboard and with fingers, on small and large screens, with readable text.

use anyhow::{Result, ensure};
use fantoccini::key::Key;
use prairie::scenes;
use prairie::world::World;
use serde_json::{Value, json};
use tests::browser::{Browser, Options};
use tests::prairie::Prairie;

/// Page sizes (CSS pixels).
const SIZES: [[u32; 2]; 3] = [[700, 390], [960, 540], [1920, 1080]];

/// The meadow at a quarter past seven in the evening.
async fn evening() -> Result<Prairie> {
    let mut meadow = scenes::load("meadow")?;
    meadow.scene.underbrush.clear();
    meadow.scene.light.hour = 19.25;
    let world = World::new(&meadow.scene, meadow.maps())?;
    Prairie::serve(meadow, world).await
}

async fn press(browser: &Browser, key: impl Into<char>) -> Result<()> {
    let key = key.into();
    browser.press(key).await?;
    browser.release(key).await
}

/// Visible controls of the page with their sizes (px).
const CONTROLS: &str = "[...document.querySelectorAll('button, select, input, summary')].filter((control) => control.checkVisibility())
    .map((control) => [control.id || control.innerText, control.getBoundingClientRect()])";

/// Shows the longest notices, and lists what they cover or what does not fit.
const CROWDED: &str = "(() => {
    const byId = (id) => document.getElementById(id);
    const [hint, notice, panel] = ['hint', 'notice', 'panel'].map(byId);
    for (const toast of [hint, notice]) Object.assign(toast, { hidden: false, textContent: 'This is the link: ' + location.origin + '/?scene=' + 'x'.repeat(120) });
    window.prairie.message('server-gone', '');
    const name = byId('peers').querySelector('b');
    name.textContent = 'Überlandwindmühlenbesitzerverein';
    const shown = [notice, document.querySelector('#message section'), hint].filter((node) => node.checkVisibility());
    const boxes = shown.map((node) => node.getBoundingClientRect());
    const covers = (a, b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
    const faults = [];
    if (boxes.some((box) => covers(box, panel.getBoundingClientRect()))) faults.push('a notice covers the panel');
    if (boxes.some((a, index) => boxes.slice(index + 1).some((b) => covers(a, b)))) faults.push('notices cover each other');
    if (boxes.length < 2) faults.push('no notice is shown');
    if (boxes.some(({ left, right, top, bottom }) => left < 0 || top < 0 || right > innerWidth || bottom > innerHeight)) faults.push('a notice leaves the screen');
    if (panel.scrollWidth > panel.clientWidth) faults.push('the panel is too wide');
    if (document.documentElement.scrollWidth > innerWidth) faults.push('the page is too wide');
    const { height } = name.getBoundingClientRect(), activity = name.nextSibling;
    if (height > 1.8 * parseFloat(getComputedStyle(name).fontSize)) faults.push('a name is broken into lines');
    if (activity.getBoundingClientRect().right > panel.getBoundingClientRect().right) faults.push('a long name pushes the vehicle out of the panel');
    window.prairie.clear();
    hint.hidden = true;
    return faults;
})()";

/// Texts of an element whose contrast is below 4.5:1 when what lies below the page is white or black.
const PALE: &str = "(root) => {
    const parsed = (color) => { const [r, g, b, a = 1] = color.match(/[\\d.]+/g).map(Number); return [r, g, b, a] };
    const over = ([r, g, b, a], below) => [r, g, b].map((part, index) => part * a + below[index] * (1 - a));
    const luminance = (color) => color.map((part) => part / 255).map((part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4))
        .reduce((sum, part, index) => sum + part * [0.2126, 0.7152, 0.0722][index], 0);
    const behind = (node, below) => (node ? over(parsed(getComputedStyle(node).backgroundColor), behind(node.parentElement, below)) : below);
    const contrast = (node, below) => {
        const back = behind(node, below);
        const [dark, light] = [luminance(back), luminance(over(parsed(getComputedStyle(node).color), back))].sort((a, b) => a - b);
        return (light + 0.05) / (dark + 0.05);
    };
    // The page's own background is covered by the picture.
    document.documentElement.style.background = 'none';
    const texts = [...root.querySelectorAll('*')].filter((node) => node.checkVisibility() && !node.closest(':disabled'))
        .filter((node) => [...node.childNodes].some((child) => child.nodeType === Node.TEXT_NODE && child.data.trim()));
    const pale = texts.map((node) => [node.textContent.trim().slice(0, 30), Math.min(contrast(node, [255, 255, 255]), contrast(node, [0, 0, 0]))]);
    document.documentElement.style.background = '';
    return [texts.length, pale.filter(([, ratio]) => ratio < 4.5)];
}";

async fn assert_readable(browser: &Browser, id: &str) -> Result<()> {
    let found = browser.evaluate(&format!("({PALE})(document.getElementById('{id}'))")).await?;
    ensure!(found[0].as_u64() > Some(2) && found[1] == json!([]), "texts of #{id} and pale ones: {found}");
    Ok(())
}

#[tokio::test(flavor = "multi_thread")]
async fn the_page_is_readable_and_works_by_keyboard() -> Result<()> {
    let prairie = evening().await?;
    let browser = prairie.visitor_at("?quality=low&panel=1&name=Ada").await?;
    browser.until("document.querySelector('#peers b')").await?;
    // The Tab key reaches the canvas first, and marks it.
    press(&browser, Key::Tab).await?;
    let marked = "[document.activeElement.id, getComputedStyle(document.activeElement).outlineStyle]";
    browser.until(&format!("JSON.stringify({marked}) === '[\"view\",\"solid\"]'")).await?;

    // The dialog keeps the focus, and gives it back.
    press(&browser, '?').await?;
    browser.until("document.getElementById('help').open").await?;
    assert_readable(&browser, "help").await?;
    for _ in 0..4 {
        press(&browser, Key::Tab).await?;
        let outside = browser.evaluate("document.getElementById('prairie').contains(document.activeElement)").await?;
        ensure!(outside == false, "the Tab key leaves the dialog");
    }
    press(&browser, Key::Escape).await?;
    browser.until("!document.getElementById('help').open && document.activeElement.id === 'view'").await?;

    for size in SIZES {
        browser.resize(size).await?;
        let faults = browser.evaluate(CROWDED).await?;
        ensure!(faults == json!([]), "at {size:?}: {faults}");
    }
    assert_readable(&browser, "panel").await?;

    // The hour is the scene's until another is chosen.
    let hour = "(({ value }, text) => [value, text.getAttribute('aria-valuetext')])(document.getElementById('hour'), document.getElementById('hour'))";
    browser.until("document.getElementById('hour').value === '19.25'").await?;
    ensure!(browser.evaluate(hour).await? == json!(["19.25", "19:15, as in the scene"]), "{}", browser.evaluate(hour).await?);
    browser.evaluate("document.getElementById('hour').focus()").await?;
    press(&browser, Key::Right).await?;
    browser.until("window.prairie.state().hour === 19.5").await?;
    ensure!(browser.evaluate(hour).await? == json!(["19.5", "19:30"]), "{}", browser.evaluate(hour).await?);

    browser.evaluate("document.getElementById('view').focus()").await?;
    press(&browser, 'x').await?;
    browser.until("document.fullscreenElement && document.getElementById('full-screen').getAttribute('aria-pressed') === 'true'").await?;
    press(&browser, 'x').await?;
    browser.until("!document.fullscreenElement").await?;

    // Hiding the panel does not lose the focus.
    browser.evaluate("document.getElementById('close').focus()").await?;
    press(&browser, Key::Enter).await?;
    browser.until("document.activeElement.id === 'open'").await?;
    press(&browser, Key::Enter).await?;
    browser.until("document.activeElement.id === 'close'").await?;
    let console = browser.console();
    ensure!(!console.to_lowercase().contains("content security policy"), "the page breaks its own policy:\n{console}");
    Ok(())
}

#[tokio::test(flavor = "multi_thread")]
async fn every_control_of_a_phone_is_large_enough_for_a_finger() -> Result<()> {
    let prairie = evening().await?;
    let browser = Browser::start(&Options { phone: true, ..Options::default() }).await?;
    browser.go(&prairie.url("?quality=low&panel=1&name=Ada")).await?;
    browser.until("document.querySelector('#peers b') && document.getElementById('message').hidden").await?;
    browser.evaluate("document.getElementById('options').open = true").await?;
    let small =
        format!("{CONTROLS}.filter(([, box]) => box.width < 44 || box.height < 44).map(([name, box]) => [name, box.width, box.height])");
    let count = browser.evaluate(&format!("{CONTROLS}.length")).await?;
    let small = browser.evaluate(&small).await?;
    ensure!(count.as_u64() > Some(20) && small == Value::Array(vec![]), "{count} controls, too small: {small}");
    let faults = browser.evaluate(CROWDED).await?;
    ensure!(faults == json!([]), "{faults}");
    Ok(())
}
