//! Failures beneath a running page, in a real browser: it reports them and recovers where possible.

use anyhow::{Result, ensure};
use prairie::charts::image::Picture;
use prairie::charts::texture::Texture;
use prairie::scenes;
use prairie::world::World;
use tests::browser::Browser;
use tests::prairie::Prairie;

async fn visited_meadow() -> Result<(Prairie, Browser)> {
    let mut meadow = scenes::load("meadow")?;
    // The test draws many frames, and without underbrush each takes half the time.
    meadow.scene.underbrush.clear();
    let world = World::new(&meadow.scene, meadow.maps())?;
    let prairie = Prairie::serve(meadow, world).await?;
    let browser = prairie.visitor("Ada").await?;
    Ok((prairie, browser))
}

fn message_is(kind: &str) -> String {
    format!("document.getElementById('message').dataset.kind === '{kind}'")
}

/// Stores the GPU device as `window.device`.
const KEEP_DEVICE: &str = "(() => {
    const begin = GPUDevice.prototype.createCommandEncoder;
    GPUDevice.prototype.createCommandEncoder = function (...rest) {
        window.device = this;
        return begin.apply(this, rest);
    };
})()";

/// Draws until a new picture appears.
async fn draws(browser: &Browser, time_secs: f64) -> Result<()> {
    browser.evaluate("window.drawn = window.prairie.state().frames").await?;
    browser.until(&format!("(window.prairie.draw({time_secs}), window.prairie.state().frames > window.drawn)")).await?;
    Ok(())
}

/// Whether a picture shows the same land, plants and light, though gusts have moved the grass.
fn is_alike(texture: Texture) -> bool {
    texture.brightness < 0.03 && texture.contrast < 0.03 && texture.gradients < 0.35
}

/// Left and right exchanged.
fn mirrored(picture: &Picture) -> Picture {
    let rows = picture.rgba.chunks_exact(4 * picture.width as usize);
    Picture { rgba: rows.flat_map(|row| row.rchunks_exact(4).flatten()).copied().collect(), ..*picture }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_lost_device_is_replaced_until_it_is_lost_too_often() -> Result<()> {
    let (_prairie, browser) = visited_meadow().await?;
    browser.evaluate(KEEP_DEVICE).await?;
    draws(&browser, 1.0).await?;
    let before = browser.canvas().await?;
    for loss in 1..=3 {
        browser.evaluate("(window.lost = window.device, window.device.destroy())").await?;
        browser.until("window.prairie.state().picture_px[0] === 0 || (window.prairie.draw(1), window.device !== window.lost)").await?;
        draws(&browser, 1.0 + f64::from(loss)).await?;
        browser.until("document.getElementById('message').hidden").await?;
    }
    draws(&browser, 1.0).await?;
    let after = Texture::of(&before, &browser.canvas().await?)?;
    ensure!(is_alike(after), "after three losses the canvas shows something else: {after:?}");
    let turned = Texture::of(&before, &mirrored(&before))?;
    ensure!(!is_alike(turned), "a control that shows something else passes: {turned:?}");

    browser.evaluate("window.device.destroy()").await?;
    browser.until(&message_is("device-lost")).await?;
    Ok(())
}

/// Makes the page use another protocol version and reconnect.
const SPEAK_ANOTHER_VERSION: &str = "(() => {
    const send = WebSocket.prototype.send;
    let first;
    WebSocket.prototype.send = function (bytes) {
        first ??= this;
        if (this === first) return this.close();
        const changed = Uint8Array.from(bytes);
        changed[0] += 1;
        send.call(this, changed);
    };
})()";

#[tokio::test(flavor = "multi_thread")]
async fn a_page_with_another_protocol_version_asks_for_a_reload() -> Result<()> {
    let (_prairie, browser) = visited_meadow().await?;
    browser.evaluate(SPEAK_ANOTHER_VERSION).await?;
    browser.until(&message_is("version")).await?;
    let title = browser.evaluate("document.querySelector('#message h1').innerText").await?;
    ensure!(title == "This page is outdated", "the page says {title}");
    Ok(())
}

/// Counts the client's requests for animation frames as `window.frames_requested`.
const COUNT_FRAMES: &str = "(() => {
    const request = window.requestAnimationFrame;
    window.frames_requested = 0;
    window.requestAnimationFrame = (callback) => (window.frames_requested++, request(callback));
    window.real_frame = () => new Promise((done) => request(done));
})()";

/// Ends the page, waits for a message that contains `text`, and reloads by its button.
async fn ends(browser: &Browser, how: &str, kind: &str, text: &str) -> Result<()> {
    browser.evaluate(&format!("({how}, 0)")).await?;
    browser.until(&message_is(kind)).await?;
    let said = browser.evaluate("document.getElementById('message').innerText").await?;
    ensure!(said.as_str().is_some_and(|said| said.contains(text)), "the page says {said}");
    let reported = "performance.getEntriesByType('resource').find(({ name }) => name.endsWith('/report'))?.responseStatus";
    ensure!(browser.until(reported).await? == 204, "the server did not take the report");
    let reachable = browser.evaluate("[document.getElementById('prairie').inert, document.activeElement.innerText]").await?;
    ensure!(reachable == serde_json::json!([true, "Reload"]), "reachable: {reachable}");
    browser.client().active_element().await?.click().await?;
    browser.until("window.prairie && window.prairie.state() && window.prairie.state().connected").await?;
    browser.until("document.getElementById('message').hidden").await?;
    Ok(())
}

#[tokio::test(flavor = "multi_thread")]
async fn a_panic_or_an_error_ends_the_page_with_a_message_until_it_is_reloaded() -> Result<()> {
    let (_prairie, browser) = visited_meadow().await?;
    browser.evaluate(COUNT_FRAMES).await?;
    browser.until("window.frames_requested > 0").await?;
    browser.evaluate("window.prairie.panic('no grass left')").await?;
    browser.until(&message_is("panicked")).await?;
    // Nothing goes on: no frame is requested, no status replaces the message, and the functions return nothing.
    let later = "(async () => {
        const before = window.frames_requested;
        for (let frame = 0; frame < 5; frame++) await window.real_frame();
        window.prairie.message('connecting', '');
        return [window.frames_requested - before, window.prairie.state(), document.getElementById('message').dataset.kind];
    })()";
    let after = browser.evaluate(later).await?;
    ensure!(after == serde_json::json!([0, null, "panicked"]), "after the panic: {after}");

    ends(&browser, "0", "panicked", "no grass left").await?;
    // Browsers hide the errors of a test's own scripts: one of the page's has to fail.
    ends(&browser, "JSON.parse = () => ({ peers: null })", "error", "null").await?;
    ends(&browser, "void window.prairie.draw(Symbol())", "error", "Symbol").await?;
    Ok(())
}
