//! Start of a page: the stages of the first pictures, and a server that waits for a page that is slow to start.

use std::time::Duration;

use anyhow::{Context as _, Result, ensure};
use prairie::Limits;
use prairie::scenes;
use prairie::world::World;
use serde_json::Value;
use tests::browser::{Browser, Options};
use tests::prairie::Prairie;

/// Lists, as `window.events`, labels of pipelines as they are created, "picture" whenever a frame has been finished, and status messages, such as
/// "adding Grass…"; and sockets as `window.sockets`.
const RECORD_START: &str = "(() => {
    window.events = [];
    for (const create of ['createRenderPipeline', 'createComputePipeline']) {
        const real = GPUDevice.prototype[create];
        GPUDevice.prototype[create] = function (descriptor) {
            window.events.push(descriptor.label);
            window.delay?.(descriptor.label);
            return real.call(this, descriptor);
        };
    }
    let drawsToCanvas = false;
    const [texture, submit] = [GPUCanvasContext.prototype.getCurrentTexture, GPUQueue.prototype.submit];
    GPUCanvasContext.prototype.getCurrentTexture = function () {
        drawsToCanvas = true;
        return texture.call(this);
    };
    GPUQueue.prototype.submit = function (buffers) {
        submit.call(this, buffers);
        if (drawsToCanvas) this.onSubmittedWorkDone().then(() => window.events.push('picture'));
        drawsToCanvas = false;
    };
    const Real = window.WebSocket;
    window.sockets = 0;
    window.WebSocket = class extends Real {
        constructor(...rest) {
            super(...rest);
            window.sockets++;
        }
    };
    document.addEventListener('DOMContentLoaded', () => {
        const message = document.getElementById('message');
        const note = () => {
            const shown = message.hidden ? 'no message' : `${message.dataset.kind} ${message.querySelector('.detail').textContent}`;
            if (window.events.findLast((event) => / /.test(event)) !== shown) window.events.push(shown);
        };
        new MutationObserver(note).observe(message, { attributes: true, childList: true, characterData: true, subtree: true });
    });
})()";

/// Opens a page that draws by itself, after `script`, and waits until its picture is complete.
async fn started(prairie: &Prairie, script: &str) -> Result<Browser> {
    let browser = Browser::start(&Options::default()).await?;
    browser.run_first(RECORD_START).await?;
    browser.run_first(script).await?;
    browser.go(&format!("http://{}/?quality=low&panel=0&name=Ada", prairie.addr)).await?;
    browser.until("window.prairie.state()?.complete_picture_secs").await?;
    browser.until("window.events.includes('no message')").await?;
    Ok(browser)
}

async fn events(browser: &Browser) -> Result<Vec<String>> {
    let events = browser.evaluate("window.events").await?;
    Ok(events.as_array().context("a list")?.iter().filter_map(Value::as_str).map(str::to_owned).collect())
}

#[tokio::test(flavor = "multi_thread")]
async fn land_and_sky_are_shown_before_the_pipelines_of_the_rest_exist() -> Result<()> {
    let meadow = scenes::load("meadow")?;
    let world = World::new(&meadow.scene, meadow.maps())?;
    let prairie = Prairie::serve(meadow, world).await?;
    let browser = started(&prairie, "").await?;

    let events = events(&browser).await?;
    let first = |event: &str| events.iter().position(|found| found == event).with_context(|| format!("no {event} in {events:?}"));
    let before_picture: Vec<&String> = events[..first("picture")?].iter().filter(|event| !event.contains(' ')).collect();
    ensure!(before_picture.iter().all(|label| ["tone", "sky", "terrain"].contains(&label.as_str())), "{before_picture:?} came first");
    // A pipeline of each later stage, in order, each after a picture of the stage before.
    let stages = ["picture", "bend_near", "objects", "ribbons"].map(first);
    let stages = stages.into_iter().collect::<Result<Vec<_>>>()?;
    ensure!(stages.is_sorted(), "the order of the stages is that of {events:?}");
    for stage in stages.windows(2) {
        ensure!(events[stage[0]..stage[1]].iter().any(|event| event == "picture"), "no picture between two stages of {events:?}");
    }
    let told = ["adding Grass…", "adding Trees, stones and vehicles…", "adding Underbrush…", "no message"].map(first);
    ensure!(told.into_iter().collect::<Result<Vec<_>>>()?.is_sorted(), "the messages are those of {events:?}");

    let state = browser.state().await?;
    println!(
        "first picture after {} s, complete after {} s: {}",
        state["first_picture_secs"], state["complete_picture_secs"], state["stage_secs"]
    );
    let secs = ["land", "grass", "solids", "underbrush"].map(|stage| state["stage_secs"][stage].as_f64().unwrap_or_default());
    ensure!(secs.is_sorted() && secs[0] > 0.0, "the stages were drawn at {secs:?} s");
    let first_secs = state["first_picture_secs"].as_f64().unwrap_or_default();
    ensure!((secs[0]..secs[1]).contains(&first_secs) && state["complete_picture_secs"] == secs[3], "{state}");
    Ok(())
}

#[tokio::test(flavor = "multi_thread")]
async fn a_page_that_is_slow_to_start_is_not_closed() -> Result<()> {
    const STALL_SECS: u32 = 1;
    let mut meadow = scenes::load("meadow")?;
    meadow.scene.underbrush.clear();
    let world = World::new(&meadow.scene, meadow.maps())?;
    let limits = Limits { stall_timeout: Duration::from_secs(STALL_SECS.into()), ..Limits::default() };
    let prairie = Prairie::serve_within(meadow, world, limits).await?;
    // After the first acknowledgements, the page's thread stands still for longer than the server would wait later.
    let stand_still = format!(
        "window.delay = (label) => {{
            if (label !== 'bend_near') return;
            const until = performance.now() + {};
            while (performance.now() < until);
        }}",
        4000 * STALL_SECS
    );
    let browser = started(&prairie, &stand_still).await?;
    let sockets = browser.evaluate("window.sockets").await?;
    ensure!(sockets == 1, "the page connected {sockets} times");
    Ok(())
}
