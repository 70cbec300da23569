//! The test browsers support WebGPU, and their screenshots show the pixels of the GPU.

use anyhow::Result;
use serde_json::json;
use tests::browser::{Browser, VIEW};
use tests::pages::{Page, Pages};

const PAGE: &str = r#"<!doctype html><title>WebGPU</title>
<style>body { margin: 0 } #view { display: block; width: 100vw; height: 100vh }</style>
<canvas id="view"></canvas>
<script>
  window.keys = [];
  for (const kind of ["keydown", "keyup"]) addEventListener(kind, (event) => keys.push(`${kind} ${event.code}`));

  async function paint(r, g, b) {
    const adapter = await navigator.gpu.requestAdapter();
    const device = await adapter.requestDevice();
    const canvas = document.getElementById("view");
    canvas.width = innerWidth;
    canvas.height = innerHeight;
    const context = canvas.getContext("webgpu");
    context.configure({ device, format: "rgba8unorm" });
    const encoder = device.createCommandEncoder();
    const view = context.getCurrentTexture().createView();
    encoder.beginRenderPass({ colorAttachments: [{ view, clearValue: [r / 255, g / 255, b / 255, 1], loadOp: "clear", storeOp: "store" }] }).end();
    device.queue.submit([encoder.finish()]);
    await device.queue.onSubmittedWorkDone();
    await new Promise(requestAnimationFrame);
    console.info("painted");
    return device.limits.maxStorageBuffersPerShaderStage;
  }
</script>"#;

fn page(path: &str) -> Option<Page> {
    (path == "/").then_some(("text/html", PAGE.as_bytes()))
}

#[tokio::test]
async fn two_browsers_show_the_pixels_of_their_gpu() -> Result<()> {
    let pages = Pages::serve(page).await?;
    let url = format!("http://{}/", pages.addr);
    let (left, right) = tokio::try_join!(Browser::open(&url), Browser::open(&url))?;
    for (browser, [r, g, b]) in [(&left, [10, 200, 30]), (&right, [250, 120, 60])] {
        let storage_buffers = browser.evaluate(&format!("paint({r}, {g}, {b})")).await?;
        assert!(storage_buffers.as_u64() >= Some(8), "storage buffers of a stage: {storage_buffers}");
        let picture = browser.canvas().await?;
        assert_eq!((picture.width, picture.height), VIEW);
        assert_eq!(picture.rgba, [r, g, b, 255].repeat(VIEW.0 as usize * VIEW.1 as usize));
        assert!(browser.console().contains("painted"), "the console said {:?}", browser.console());
    }
    Ok(())
}

#[tokio::test]
async fn a_held_key_stays_down_until_it_is_released() -> Result<()> {
    let pages = Pages::serve(page).await?;
    let browser = Browser::open(&format!("http://{}/", pages.addr)).await?;
    browser.press('w').await?;
    browser.press('d').await?;
    browser.release('w').await?;
    assert_eq!(browser.evaluate("keys").await?, json!(["keydown KeyW", "keydown KeyD", "keyup KeyW"]));
    Ok(())
}

#[tokio::test]
async fn an_exception_of_a_script_is_reported() -> Result<()> {
    let pages = Pages::serve(page).await?;
    let browser = Browser::open(&format!("http://{}/", pages.addr)).await?;
    let error = browser.evaluate("(() => { throw new Error('no such meadow') })()").await.expect_err("it throws");
    assert!(format!("{error:#}").contains("no such meadow"), "{error:#}");
    Ok(())
}
