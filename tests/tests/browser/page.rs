//! The embedded page in a real browser: it starts the client, or reports why it cannot.

use anyhow::Result;
use prairie::net::assets::asset;
use tests::browser::{Browser, Options};
use tests::pages::{Page, Pages};

fn embedded(path: &str) -> Option<Page> {
    asset(path).map(|asset| (asset.content_type, asset.bytes))
}

/// Opens the embedded page under a host name, waits for a message, and returns its title.
async fn title_of_message(host: &str, kind: &str, options: &Options) -> Result<String> {
    let pages = Pages::serve(embedded).await?;
    let mut options = options.clone();
    options.arguments.push(format!("--host-resolver-rules=MAP {host} 127.0.0.1"));
    let browser = Browser::start(&options).await?;
    browser.go(&format!("http://{host}:{}/", pages.addr.port())).await?;
    browser.until(&format!("document.getElementById('message').dataset.kind === '{kind}'")).await?;
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
