//! The embedded page in a real browser: it starts the client, or reports why it cannot.

use anyhow::Result;
use prairie::net::assets::asset;
use tests::browser::{Browser, Options};
use tests::pages::{Page, Pages};

fn embedded(path: &str) -> Option<Page> {
    asset(path).map(|asset| (asset.content_type, asset.bytes))
}

/// Opens the embedded page under a host name, waits for a message and its report to the server, and returns its title.
async fn title_of_message(host: &str, kind: &str, options: &Options) -> Result<String> {
    let pages = Pages::serve(embedded).await?;
    let mut options = options.clone();
    options.arguments.push(format!("--host-resolver-rules=MAP {host} 127.0.0.1"));
    let browser = Browser::start(&options).await?;
    browser.go(&format!("http://{host}:{}/", pages.addr.port())).await?;
    browser.until(&format!("document.getElementById('message').dataset.kind === '{kind}'")).await?;
    browser.until("performance.getEntriesByType('resource').some(({ name }) => name.endsWith('/report'))").await?;
    let title = browser.evaluate("document.querySelector('#message h1').innerText").await?;
    Ok(title.as_str().unwrap_or_default().to_owned())
}

#[tokio::test]
async fn the_page_reports_an_insecure_address() -> Result<()> {
    let title = title_of_message("prairie.test", "insecure", &Options::default()).await?;
    assert_eq!(title, "This address is not a secure one");
    Ok(())
}

#[tokio::test]
async fn without_webgpu_the_page_explains_how_to_get_it() -> Result<()> {
    let options = Options { webgpu: false, ..Options::default() };
    let title = title_of_message("localhost", "no-adapter", &options).await?;
    assert_eq!(title, "WebGPU found no graphics adapter");
    Ok(())
}

/// The embedded page in a browser without `navigator.gpu`.
fn without_gpu(path: &str) -> Option<Page> {
    let (content_type, bytes) = embedded(path)?;
    if path != "/" {
        return Some((content_type, bytes));
    }
    let script = "<head><script>Object.defineProperty(Navigator.prototype, 'gpu', { value: undefined })</script>";
    let page = String::from_utf8_lossy(bytes).replacen("<head>", script, 1);
    Some((content_type, page.leak().as_bytes()))
}

#[tokio::test]
async fn without_webgpu_no_client_is_fetched() -> Result<()> {
    let browser = Browser::start(&Options { webgpu: false, ..Options::default() }).await?;
    for (find, kind) in [(embedded as fn(&str) -> Option<Page>, "no-adapter"), (without_gpu, "unsupported")] {
        let pages = Pages::serve(find).await?;
        browser.go(&format!("http://{}/", pages.addr)).await?;
        browser.until(&format!("document.getElementById('message').dataset.kind === '{kind}'")).await?;
        let fetched = browser.evaluate("performance.getEntriesByType('resource').map(({ name }) => name).join(' ')").await?;
        let fetched = fetched.as_str().unwrap_or_default();
        assert!(fetched.contains("start.") && !fetched.contains("prairie_client"), "{kind}: the page fetched {fetched}");
        let text = browser.evaluate("document.getElementById('message').innerText").await?;
        let text = text.as_str().unwrap_or_default();
        let platforms = ["Linux, as here: ", "Windows: ", "iPhone, iPad: ", "Checked in "];
        assert_eq!(platforms.iter().all(|part| text.contains(part)), kind == "unsupported", "{text}");
    }
    Ok(())
}

#[tokio::test]
async fn a_script_that_does_not_load_is_reported() -> Result<()> {
    let pages = Pages::serve(|path| embedded(path).filter(|_| !path.starts_with("/start."))).await?;
    let browser = Browser::start(&Options { webgpu: false, ..Options::default() }).await?;
    browser.go(&format!("http://{}/", pages.addr)).await?;
    browser.until("document.getElementById('message').dataset.kind === 'error'").await?;
    let text = browser.evaluate("document.getElementById('message').innerText").await?;
    assert!(text.as_str().is_some_and(|text| text.contains("/start.") && text.contains("Reload")), "{text}");
    Ok(())
}
