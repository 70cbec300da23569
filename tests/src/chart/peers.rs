//! Frame rates of other programs that draw grass, and ours, in the same browser with software WebGPU.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, ensure};
use prairie::scenes;
use prairie::world::World;
use tokio::time::sleep;

use crate::browser::{Browser, Options};
use crate::pages::Pages;
use crate::prairie::Prairie;
use prairie::charts::image::Picture;
use prairie_charts::table::markdown;

/// Size of every page (CSS pixels).
const SIZE_PX: [u32; 2] = [1280, 720];
/// Time for a page to settle after its first picture.
const SETTLE: Duration = Duration::from_secs(30);
/// Qualities of ours.
const QUALITIES: [&str; 2] = ["low", "medium"];

/// Counts pictures: with WebGPU the frames in which a canvas gave its texture, otherwise those in which the page asked to be called.
const COUNT: &str = "(() => {
    const counts = window.pictures = { webgpu: 0, called: 0 };
    const request = window.requestAnimationFrame.bind(window);
    let now = 0, drawn = -1, called = -1;
    window.requestAnimationFrame = (draw) => request((at) => {
        now = at;
        if (called !== at) { called = at; counts.called += 1; }
        draw(at);
    });
    if (window.GPUCanvasContext) {
        const texture = GPUCanvasContext.prototype.getCurrentTexture;
        GPUCanvasContext.prototype.getCurrentTexture = function () {
            if (drawn !== now) { drawn = now; counts.webgpu += 1; }
            return texture.call(this);
        };
    }
})()";

/// Another program: its name and the folder of its built page.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Peer {
    name: String,
    folder: PathBuf,
}

impl Peer {
    /// Reads `NAME=FOLDER`.
    ///
    /// # Errors
    /// When it has another form, or the folder has no page.
    pub fn parse(text: &str) -> Result<Self> {
        let is_plain = |name: &str| !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c));
        let parts = text.split_once('=').filter(|(name, folder)| is_plain(name) && !folder.is_empty());
        let (name, folder) = parts
            .context("NAME=FOLDER is allowed, with letters, digits, - and _ in the name, such as `webgpu-grass=../webgpu-grass/dist`")?;
        let peer = Self { name: name.to_owned(), folder: folder.into() };
        ensure!(peer.folder.join("index.html").is_file(), "{folder} has no index.html; it must be the folder of a built page");
        Ok(peer)
    }
}

/// What a page did while it was measured.
#[derive(Clone, Debug, PartialEq)]
struct Run {
    name: String,
    /// Measured time (s).
    secs: f64,
    pictures: f64,
    cpu_secs: f64,
}

/// Measures ours at two qualities and each peer for `measured`, one after the other; returns a table as Markdown, and which peers
/// could not be measured. Screenshots go into a folder.
///
/// # Errors
/// When our own page cannot be measured.
pub async fn compare(
    peers: &[Peer],
    measured: Duration,
    machine: &str,
    screenshots: &std::path::Path,
    mut say: impl FnMut(&str),
) -> Result<String> {
    let (mut runs, mut failures) = (Vec::new(), String::new());
    let mut add = async |name: String, url: String| -> Result<()> {
        say(&name);
        let (run, picture) = run(&name, &url, measured).await.with_context(|| name.clone())?;
        runs.push(run);
        // A page that is busy for longer than the browser waits has no screenshot.
        picture.and_then(|picture| picture.save(&screenshots.join(format!("{name}.jpg")))).or_else(|error| {
            say(&format!("{name} has no screenshot: {error:#}"));
            Ok(())
        })
    };
    for quality in QUALITIES {
        let scene = scenes::load("meadow")?;
        let world = World::new(&scene.scene, scene.maps())?;
        let prairie = Prairie::serve(scene, world).await?;
        add(format!("prairie-{quality}"), format!("http://{}/?quality={quality}&panel=0", prairie.addr)).await?;
        prairie.stop().await?;
    }
    for Peer { name, folder } in peers {
        let pages = Pages::serve_folder(folder.clone()).await?;
        if let Err(error) = add(name.clone(), format!("http://{}/", pages.addr)).await {
            failures += &format!("\nNot measured: {error:#}\n");
        }
    }
    Ok(format!(
        "# Frame rates in a browser\n\n{machine}\n\nHeadless Chromium with WebGPU in software (SwiftShader), {} × {}, each page as it starts, for {} s from {} s after its first picture on; processor time of the browser alone; \
         our server simulates on the same cores. Ours is the scene `meadow` with land, sky, wind and underbrush.\n\n{}{failures}",
        SIZE_PX[0],
        SIZE_PX[1],
        measured.as_secs(),
        SETTLE.as_secs(),
        table(&runs)
    ))
}

async fn run(name: &str, url: &str, measured: Duration) -> Result<(Run, Result<Picture>)> {
    let browser = Browser::start(&Options::default()).await?;
    browser.resize(SIZE_PX).await?;
    browser.run_first(COUNT).await?;
    browser.go(url).await?;
    browser.until("window.pictures.webgpu + window.pictures.called > 1").await?;
    sleep(SETTLE).await;
    let state = async || -> Result<([f64; 2], f64, Instant)> {
        let counts = browser.evaluate("[window.pictures.webgpu, window.pictures.called]").await?;
        Ok((serde_json::from_value(counts)?, browser.cpu_secs(), Instant::now()))
    };
    let (before, cpu_secs, begun) = state().await?;
    sleep(measured).await;
    let (after, cpu_secs_then, ended) = state().await?;
    let counter = usize::from(after[0] == 0.0);
    let [first, last] = [before[counter], after[counter]];
    ensure!(last > first, "no picture was drawn for {} s\nthe page's console:\n{}", measured.as_secs(), browser.console());
    let run = Run {
        name: name.to_owned(),
        secs: ended.duration_since(begun).as_secs_f64(),
        pictures: last - first,
        cpu_secs: cpu_secs_then - cpu_secs,
    };
    Ok((run, browser.picture("canvas").await))
}

/// Frames per second and processor time a frame, with the ratio of each frame rate of ours to it.
fn table(runs: &[Run]) -> String {
    let per_sec = |run: &Run| run.pictures / run.secs;
    let ours = || runs.iter().take(QUALITIES.len());
    let row = |run: &Run| {
        let figures = [run.pictures / run.secs, run.cpu_secs / run.pictures].map(|value| format!("{value:.2}"));
        let ratios = ours().map(|own| format!("{:.2}", per_sec(own) / per_sec(run)));
        [vec![run.name.clone()], figures.to_vec(), ratios.collect()].concat()
    };
    let ratios: Vec<String> = ours().map(|own| format!("{}, times as fast", own.name)).collect();
    let header = [["page", "frames/s", "CPU s a frame"].as_slice(), &ratios.iter().map(String::as_str).collect::<Vec<_>>()].concat();
    markdown(&header, &runs.iter().map(row).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peer_is_a_name_and_the_folder_of_a_page() -> Result<()> {
        let folder = tempfile::tempdir()?;
        let text = format!("a={}", folder.path().display());
        assert!(Peer::parse(&text).is_err_and(|error| error.to_string().contains("has no index.html")));
        std::fs::write(folder.path().join("index.html"), "<canvas></canvas>")?;
        assert_eq!(Peer::parse(&text)?, Peer { name: "a".to_owned(), folder: folder.path().into() });
        for text in ["", "a", "=b", "a=", "../a=b"] {
            assert!(Peer::parse(text).is_err_and(|error| error.to_string().starts_with("NAME=FOLDER is allowed")), "{text}");
        }
        Ok(())
    }

    #[test]
    fn the_table_compares_frame_rates() {
        let run = |name: &str, pictures: f64| Run { name: name.to_owned(), secs: 10.0, pictures, cpu_secs: 20.0 };
        let table = table(&[run("prairie-low", 40.0), run("prairie-medium", 20.0), run("other", 10.0)]);
        let cells: Vec<&str> = table.lines().last().unwrap_or_default().split('|').map(str::trim).collect();
        assert_eq!(cells, ["", "other", "1.00", "2.00", "4.00", "2.00", ""], "{table}");
    }
}
