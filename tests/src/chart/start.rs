//! Start of a page in a fresh browser: times of its first and of its complete picture, and of a frame in the page afterwards.

use std::time::Duration;

use anyhow::{Context as _, Result, ensure};
use prairie::scenes;
use prairie::world::World;
use tokio::time::sleep;

use crate::browser::{Browser, Options};
use crate::prairie::Prairie;
use prairie_charts::table::markdown;

/// Size of every page (CSS pixels).
const SIZE_PX: [u32; 2] = [1280, 720];
/// Time for frames after the complete picture, which are timed.
const SETTLE: Duration = Duration::from_secs(10);
/// Qualities; without one it is automatic, as for a visitor.
const QUALITIES: [Option<&str>; 3] = [None, Some("low"), Some("medium")];

/// Number of frames that the page has drawn.
const FRAMES: &str = "window.prairie.state().frames";

/// Aims for the first picture in software (s), and for a frame in the page at medium (ms).
const FIRST_PICTURE_SECS: f64 = 3.0;
const FRAME_CPU_MS: f64 = 2.0;

/// A page that started: first and complete picture (s since it was opened), and the processor time of its own thread for each frame (ms).
type Times = [f64; 3];

/// Opens the scene `meadow` in `pages` fresh browsers at each quality; returns a table as Markdown.
///
/// # Errors
/// When a page does not start.
pub async fn measure(pages: u32, machine: &str, mut say: impl FnMut(&str)) -> Result<String> {
    let mut rows = Vec::new();
    for quality in QUALITIES {
        let name = quality.unwrap_or("automatic");
        let mut found = Vec::new();
        for page in 1..=pages {
            say(&format!("{name}, page {page} of {pages}"));
            found.push(start(quality).await.with_context(|| format!("{name}, page {page}"))?);
        }
        rows.push(row(name, &found));
    }
    Ok(format!(
        "# Start of a page\n\n{machine}\n\nHeadless Chromium with WebGPU in software (SwiftShader), {} × {}, scene `meadow`; every page in a browser of its own that knows nothing of an earlier one, with the server on the same cores. \
         Least, median and largest of {pages} pages. The first picture is that of land and sky on the screen; the time of a frame is the processor time of the page's own thread in {} s over the frames drawn in them, with all else that the thread does: messages, panel, the browser's own painting. \
         The aims are a first picture in {FIRST_PICTURE_SECS} s and a frame in {FRAME_CPU_MS} ms at medium.\n\n{}",
        SIZE_PX[0],
        SIZE_PX[1],
        SETTLE.as_secs(),
        markdown(&["quality", "first picture (s)", "complete picture (s)", "frame in the page's thread (ms)"], &rows)
    ))
}

async fn start(quality: Option<&str>) -> Result<Times> {
    let scene = scenes::load("meadow")?;
    let world = World::new(&scene.scene, scene.maps())?;
    let prairie = Prairie::serve(scene, world).await?;
    let browser = Browser::start(&Options::default()).await?;
    browser.resize(SIZE_PX).await?;
    let quality = quality.map_or(String::new(), |quality| format!("quality={quality}&"));
    browser.go(&format!("http://{}/?{quality}panel=0", prairie.addr)).await?;
    browser.until("window.prairie.state()?.complete_picture_secs").await?;
    let (frames_before, cpu_before_secs) = (browser.evaluate(FRAMES).await?, browser.page_cpu_secs());
    sleep(SETTLE).await;
    let (frames_after, cpu_after_secs) = (browser.evaluate(FRAMES).await?, browser.page_cpu_secs());
    let [before, after] = [frames_before, frames_after].map(|frames| frames.as_f64().unwrap_or_default());
    ensure!(after > before, "the page drew no frame for {SETTLE:?}");
    let times = browser.evaluate(
        "(({ first_picture_secs, complete_picture_secs }) => [first_picture_secs, complete_picture_secs])(window.prairie.state())",
    );
    let [first, complete] = serde_json::from_value(times.await?).context("the page's times")?;
    prairie.stop().await?;
    Ok([first, complete, 1e3 * (cpu_after_secs - cpu_before_secs) / (after - before)])
}

/// Name, and least, median and largest of each time.
fn row(name: &str, pages: &[Times]) -> Vec<String> {
    let range = |part: usize| {
        let mut times: Vec<f64> = pages.iter().map(|page| page[part]).collect();
        times.sort_by(f64::total_cmp);
        let [least, median, largest] = [0, times.len() / 2, times.len() - 1].map(|at| times[at]);
        format!("{least:.1}, {median:.1}, {largest:.1}")
    };
    vec![name.to_owned(), range(0), range(1), range(2)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_has_least_median_and_largest_times() {
        let pages = [[3.0, 9.0, 1.5], [2.0, 8.0, 2.5], [7.0, 10.0, 2.0]];
        assert_eq!(row("low", &pages), ["low", "2.0, 3.0, 7.0", "8.0, 9.0, 10.0", "1.5, 2.0, 2.5"]);
    }
}
