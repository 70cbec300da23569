//! Real browsers for the tests: headless Chromium, one process tree each, with WebGPU in software.

use std::time::Duration;

use anyhow::{Context as _, Result, bail, ensure};
use fantoccini::actions::{InputSource as _, KeyAction, KeyActions};
use fantoccini::wd::TimeoutConfiguration;
use fantoccini::{Client, ClientBuilder, Locator};
use hyper_util::client::legacy::connect::HttpConnector;
use serde_json::{Value, json};
use tokio::time::{Instant, sleep};

use crate::chromedriver::{Chromedriver, chromium};
use crate::devtools::devtools;
use prairie::charts::image::Picture;

/// Page size of a [`Browser`], width and height (CSS pixels, equal to the picture's pixels).
pub const VIEW: (u32, u32) = (960, 540);

/// Page size of a phone (CSS pixels).
pub const PHONE: [u32; 2] = [390, 844];

/// Timeout of a script, a page load and [`Browser::until`].
pub const PATIENCE: Duration = Duration::from_secs(120);

const HEADLESS: [&str; 13] = [
    "--headless=new",
    "--no-sandbox",
    "--no-first-run",
    "--disable-quic",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
    "--disable-background-timer-throttling",
    "--disable-backgrounding-occluded-windows",
    "--disable-renderer-backgrounding",
    "--force-device-scale-factor=1",
    "--hide-scrollbars",
];

/// WebGPU on SwiftShader. Without `Vulkan` the canvas stays blank and the GPU never completes its work.
const SOFTWARE_WEBGPU: [&str; 4] =
    ["--enable-unsafe-webgpu", "--enable-features=Vulkan", "--use-vulkan=swiftshader", "--use-angle=swiftshader"];

/// Options of a browser.
#[derive(Clone, Debug)]
pub struct Options {
    /// Whether WebGPU offers an adapter; default true.
    pub webgpu: bool,
    /// Whether the page is that of a phone, 390 × 844, used with fingers; default false.
    pub phone: bool,
    /// Additional command-line arguments of Chromium; default empty.
    pub arguments: Vec<String>,
}

impl Default for Options {
    fn default() -> Self {
        Self { webgpu: true, phone: false, arguments: Vec::new() }
    }
}

/// One browser with one page of [`VIEW`]'s size. Dropping it ends all its processes.
#[derive(Debug)]
pub struct Browser {
    client: Client,
    driver: Chromedriver,
}

impl Browser {
    /// Starts a browser with WebGPU and shows the page at `url`.
    ///
    /// # Errors
    /// When Chromium or chromedriver is not installed (the message says what to install), or the page does not load.
    pub async fn open(url: &str) -> Result<Self> {
        let browser = Self::start(&Options::default()).await?;
        browser.go(url).await?;
        Ok(browser)
    }

    /// Starts a browser with an empty page. Self-signed certificates are accepted.
    ///
    /// # Errors
    /// When Chromium or chromedriver is not installed (the message says what to install), or will not start.
    pub async fn start(options: &Options) -> Result<Self> {
        let binary = chromium()?;
        let driver = Chromedriver::start().await?;
        let mut arguments: Vec<String> = HEADLESS.map(String::from).to_vec();
        if options.webgpu {
            arguments.extend(SOFTWARE_WEBGPU.map(String::from));
        }
        arguments.push(format!("--window-size={},{}", VIEW.0, VIEW.1));
        arguments.push(format!("--user-data-dir={}", driver.profile().display()));
        arguments.extend(options.arguments.iter().cloned());
        let mut chromium = json!({ "binary": binary, "args": arguments });
        if options.phone {
            let [width, height] = PHONE;
            chromium["mobileEmulation"] =
                json!({ "deviceMetrics": { "width": width, "height": height, "pixelRatio": 1.0, "touch": true } });
        }
        let capabilities = json!({ "acceptInsecureCerts": true, "goog:chromeOptions": chromium });
        let Value::Object(capabilities) = capabilities else { bail!("capabilities are an object") };
        let connected = ClientBuilder::new(HttpConnector::new()).capabilities(capabilities).connect(&driver.url).await;
        let client = connected.with_context(|| format!("Chromium did not start:\n{}", driver.log()))?;
        let browser = Self { client, driver };
        browser.client.update_timeouts(TimeoutConfiguration::new(Some(PATIENCE), Some(PATIENCE), None)).await?;
        if !options.phone {
            browser.resize(VIEW.into()).await?;
        }
        Ok(browser)
    }

    /// Shows the page at `url`.
    ///
    /// # Errors
    /// When the page does not load.
    pub async fn go(&self, url: &str) -> Result<()> {
        self.client.goto(url).await.with_context(|| format!("opening {url}"))
    }

    /// Runs a script in each page that is opened from now on, before the page's own scripts.
    ///
    /// # Errors
    /// When the browser is gone.
    pub async fn run_first(&self, script: &str) -> Result<()> {
        let session = self.client.session_id().await?.context("the browser has no session")?;
        devtools(&self.driver.url, &session, "Page.addScriptToEvaluateOnNewDocument", &json!({ "source": script })).await
    }

    /// The value of a JavaScript expression in the page; a promise is awaited.
    ///
    /// # Errors
    /// When the expression throws, or takes longer than [`PATIENCE`].
    pub async fn evaluate(&self, expression: &str) -> Result<Value> {
        let script = format!("return (async () => ({expression}))();");
        let value = self.client.execute(&script, Vec::new()).await;
        value.with_context(|| format!("evaluating {expression}\nthe page's console:\n{}", self.console()))
    }

    /// State that the client reports (`window.prairie.state()`); null before it has started.
    ///
    /// # Errors
    /// When the page is not Prairie's.
    pub async fn state(&self) -> Result<Value> {
        self.evaluate("window.prairie.state()").await
    }

    /// Waits until a JavaScript expression is truthy and returns its value.
    ///
    /// # Errors
    /// When the expression throws, or is not true within [`PATIENCE`].
    pub async fn until(&self, expression: &str) -> Result<Value> {
        let deadline = Instant::now() + PATIENCE;
        loop {
            let pair = self.evaluate(&format!("[({expression})].map((value) => [Boolean(value), value])[0]")).await?;
            if pair[0] == json!(true) {
                return Ok(pair[1].clone());
            }
            ensure!(Instant::now() < deadline, "{expression} was {} for {PATIENCE:?}\nthe page's console:\n{}", pair[1], self.console());
            sleep(Duration::from_millis(100)).await;
        }
    }

    /// Screenshot of the first element that matches a CSS selector, with anything that overlaps it.
    ///
    /// # Errors
    /// When there is no such element.
    pub async fn picture(&self, selector: &str) -> Result<Picture> {
        let element = self.client.find(Locator::Css(selector)).await.with_context(|| format!("no element {selector}"))?;
        Picture::from_png(&element.screenshot().await?)
    }

    /// Screenshot of the canvas alone; the panel and the message are hidden meanwhile.
    ///
    /// # Errors
    /// When the page has no canvas `#view`.
    pub async fn canvas(&self) -> Result<Picture> {
        // The page's policy forbids style elements, but not style sheets made by scripts.
        let hide = "(sheet => (sheet.replaceSync('#panel, #message { visibility: hidden }'), document.adoptedStyleSheets = [sheet], 0))(new CSSStyleSheet())";
        self.evaluate(hide).await?;
        let picture = self.picture("#view").await;
        self.evaluate("(document.adoptedStyleSheets = [], 0)").await?;
        picture
    }

    /// Presses a key and holds it. Special keys are the characters of [`fantoccini::key::Key`].
    ///
    /// # Errors
    /// When the browser is gone.
    pub async fn press(&self, key: impl Into<char>) -> Result<()> {
        self.key(KeyAction::Down { value: key.into() }).await
    }

    /// Releases a key.
    ///
    /// # Errors
    /// When the browser is gone.
    pub async fn release(&self, key: impl Into<char>) -> Result<()> {
        self.key(KeyAction::Up { value: key.into() }).await
    }

    /// Clicks the first element that matches a CSS selector.
    ///
    /// # Errors
    /// When there is no such element, or another covers it.
    pub async fn click(&self, selector: &str) -> Result<()> {
        let element = self.client.find(Locator::Css(selector)).await.with_context(|| format!("no element {selector}"))?;
        element.click().await.with_context(|| format!("clicking {selector}"))
    }

    /// Sets the size of the page (CSS pixels) instead of [`VIEW`].
    ///
    /// # Errors
    /// When the window does not take that size.
    pub async fn resize(&self, [width, height]: [u32; 2]) -> Result<()> {
        let frame = self.evaluate("[outerWidth - innerWidth, outerHeight - innerHeight]").await?;
        let [Some(wide), Some(high)] = [0, 1].map(|side| frame[side].as_u64().and_then(|pixels| u32::try_from(pixels).ok())) else {
            bail!("the window's frame measures {frame}");
        };
        self.client.set_window_size(width + wide, height + high).await?;
        self.until(&format!("innerWidth === {width} && innerHeight === {height}")).await?;
        Ok(())
    }

    /// Console output of the page so far.
    #[must_use]
    pub fn console(&self) -> String {
        let log = self.driver.log();
        let lines = log.lines().filter_map(|line| line.split_once(":CONSOLE").map(|(_, said)| said));
        lines.collect::<Vec<_>>().join("\n")
    }

    /// Processor time that the browser has used so far (s). Linux only: 0 elsewhere.
    #[must_use]
    pub fn cpu_secs(&self) -> f64 {
        self.driver.cpu_secs()
    }

    /// Processor time that the page's own thread has used so far (s). Linux only: 0 elsewhere.
    #[must_use]
    pub fn page_cpu_secs(&self) -> f64 {
        self.driver.page_cpu_secs()
    }

    /// The WebDriver client, for commands that have no method here.
    #[must_use]
    pub fn client(&self) -> &Client {
        &self.client
    }

    async fn key(&self, action: KeyAction) -> Result<()> {
        let keyboard = KeyActions::new("keyboard".into()).then(action);
        Ok(self.client.perform_actions(keyboard).await?)
    }
}
