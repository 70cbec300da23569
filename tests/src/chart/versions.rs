//! Two versions of Prairie in a real browser: the same views of each, side by side.

use std::fmt::Write as _;
use std::net::TcpListener;
use std::path::Path;
use std::process::Stdio;
use std::time::Duration;

use anyhow::{Context as _, Result, ensure};
use tokio::process::Command;
use tokio::time::sleep;

use crate::browser::{Browser, Options};
use prairie::charts::image::Picture;

/// Size of every page (CSS pixels).
const SIZE_PX: [u32; 2] = [640, 360];
/// Time for a page to settle after its first frames.
const SETTLE: Duration = Duration::from_secs(12);
/// Frames before a screenshot.
const FRAMES: u32 = 6;
/// Width of a stored pair (px).
const STORED_PX: u32 = 800;

/// What is looked at in two versions.
#[derive(Clone, Copy, Debug)]
pub struct PageView {
    /// Its name, that of the file.
    pub name: &'static str,
    scene: &'static str,
    /// Quality and other parameters of the address.
    query: &'static str,
    /// Position (m), heading and pitch (degrees) of the camera as in a link, or empty for the scene's own.
    camera: &'static str,
    /// Key pressed before the screenshot.
    key: Option<char>,
    shows: &'static str,
}

const fn view(name: &'static str, scene: &'static str, query: &'static str, camera: &'static str, shows: &'static str) -> PageView {
    PageView { name, scene, query, camera, key: None, shows }
}

/// All views, in the order of the page.
pub const PAGE_VIEWS: [PageView; 11] = [
    view("hill", "meadow", "quality=low", "128,22,158,20,-13", "grass from ten metres at low"),
    view("aircraft", "meadow", "quality=high", "128,60,200,10,-25", "grass from fifty metres at high"),
    view("ruts", "meadow", "quality=medium", "118,34,196,10,-30", "ruts and bare ground from above"),
    view("beyond", "meadow", "quality=medium", "128,12,30,20,-6", "land beyond the map"),
    view("jacksboro", "jacksboro", "quality=medium", "", "a real landscape"),
    PageView { key: Some('1'), ..view("near", "continuum", "quality=medium", "", "the lowest camera of the continuum") },
    view("trees", "meadow", "quality=high", "104,3,146,345,5", "trees near the eye"),
    view("storm", "storm", "quality=medium", "", "a storm"),
    view("devil", "devil", "quality=medium", "", "a dust devil"),
    view("night", "meadow", "quality=medium&hour=23", "", "night"),
    view("dusk", "meadow", "quality=medium&hour=20.3", "", "dusk"),
];

impl PageView {
    /// The view with a name.
    ///
    /// # Errors
    /// When there is none; the message lists all names.
    pub fn find(name: &str) -> Result<&'static Self> {
        let all = || PAGE_VIEWS.map(|view| view.name).join(", ");
        PAGE_VIEWS.iter().find(|view| view.name == name).with_context(|| format!("no view is named `{name}`; allowed are {}", all()))
    }

    /// Draws the view in a browser with a program of either version.
    ///
    /// # Errors
    /// When the program does not serve the scene, or the page draws nothing.
    pub async fn draw(&self, program: &Path) -> Result<Picture> {
        let addr = TcpListener::bind("127.0.0.1:0")?.local_addr()?.to_string();
        let mut server = Command::new(program);
        server.args(["serve", "--scene", self.scene, "--world", "none", "--addr", &addr]).kill_on_drop(true);
        let server = server.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).spawn();
        let _server = server.with_context(|| format!("{} does not start", program.display()))?;
        let browser = Browser::start(&Options::default()).await?;
        browser.resize(SIZE_PX).await?;
        let url = format!("http://{addr}/?{}&panel=0#{}", self.query, self.camera);
        let mut tries = 0;
        while let Err(error) = browser.go(&url).await {
            tries += 1;
            ensure!(tries < 100, "{} does not serve `{}`: {error:#}", program.display(), self.scene);
            sleep(Duration::from_millis(200)).await;
        }
        browser.until("window.prairie?.state()?.frames > 2").await?;
        if let Some(key) = self.key {
            browser.press(key).await?;
            browser.release(key).await?;
        }
        sleep(SETTLE).await;
        browser.until(&format!("window.prairie.state().frames > {FRAMES}")).await?;
        browser.canvas().await
    }
}

/// Draws the views with the program of an earlier version and with that of a later one, each pair into a file of `folder`, with a page of all.
///
/// # Errors
/// As [`PageView::draw`], or when a file cannot be written.
pub async fn compare(before: &Path, after: &Path, views: &[&PageView], folder: &Path, mut say: impl FnMut(&str)) -> Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("{} cannot be made", folder.display()))?;
    for view in views {
        let mut pair = Vec::new();
        for program in [before, after] {
            say(&format!("{}, {}", view.name, program.display()));
            pair.push(view.draw(program).await.with_context(|| view.name)?);
        }
        Picture::tiled(&pair, 2)?.shrunk_to_width(STORED_PX).save(&folder.join(format!("{}.jpg", view.name)))?;
    }
    let path = folder.join("README.md");
    std::fs::write(&path, page(views)).with_context(|| format!("{} cannot be written", path.display()))
}

/// Markdown with all pairs.
fn page(views: &[&PageView]) -> String {
    let mut page = format!(
        "# Two versions\n\nThe same views in Chromium with WebGPU in software (SwiftShader), {} × {}: on the left with an earlier version of server and page, on the right with this one.\n",
        SIZE_PX[0], SIZE_PX[1]
    );
    for PageView { name, scene, query, camera, key, shows } in views {
        let key = key.map_or(String::new(), |key| format!(", key `{key}`"));
        let camera = if camera.is_empty() { String::new() } else { format!("#{camera}") };
        write!(page, "\n## {shows}\n\n![{shows}, before and after]({name}.jpg)\n\nScene `{scene}`, `?{query}{camera}`{key}.\n")
            .expect("a string takes all text");
    }
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique_and_scenes_exist() {
        for (at, view) in PAGE_VIEWS.iter().enumerate() {
            assert!(prairie::scenes::load(view.scene).is_ok(), "{}", view.scene);
            assert!(PAGE_VIEWS[..at].iter().all(|other| other.name != view.name), "{}", view.name);
        }
        assert!(PageView::find("moon").unwrap_err().to_string().contains("allowed are hill, aircraft"));
    }

    #[test]
    fn a_page_has_every_pair_with_its_address() {
        let page = page(&[&PAGE_VIEWS[0], &PAGE_VIEWS[5]]);
        assert!(page.contains("![grass from ten metres at low, before and after](hill.jpg)"));
        assert!(page.contains("Scene `meadow`, `?quality=low#128,22,158,20,-13`.\n") && page.contains("`?quality=medium`, key `1`.\n"));
    }
}
