//! The icons of the page: pictures of `icon.svg`.

use anyhow::{Context as _, Result, ensure};
use prairie::charts::image::Picture;
use std::fs;
use std::path::Path;
use tests::browser::{Browser, Options};
use tests::pages::Pages;

/// File, side (px), and size of the drawing as a fraction of that. With less than 1 the background fills the square, as home screens expect that cut
/// their own shape; 0.8 of a maskable icon is visible under every shape.
const ICONS: [(&str, u32, f64); 4] =
    [("icon-192.png", 192, 1.0), ("icon-512.png", 512, 1.0), ("icon-maskable-512.png", 512, 0.8), ("icon-apple-180.png", 180, 0.9)];

/// Draws `icon.svg`; returns the bytes of a PNG.
const DRAW: &str = "async (side, fraction) => {
    const icon = new Image();
    icon.src = '/icon.svg';
    await icon.decode();
    const canvas = Object.assign(document.createElement('canvas'), { width: side, height: side });
    const context = canvas.getContext('2d');
    if (fraction < 1) {
        context.fillStyle = '#20281b';
        context.fillRect(0, 0, side, side);
    }
    const margin = side * (1 - fraction) / 2;
    context.drawImage(icon, margin, margin, side - 2 * margin, side - 2 * margin);
    return Array.from(atob(canvas.toDataURL('image/png').split(',')[1]), (char) => char.charCodeAt(0));
}";

#[tokio::test]
async fn the_icons_are_drawn_from_the_svg() -> Result<()> {
    let pages = Pages::serve(|path| match path {
        "/icon.svg" => Some(("image/svg+xml", include_bytes!("../../../client-wasm/web/icon.svg"))),
        _ => Some(("text/html", b"<!doctype html><title>Icons</title>")),
    })
    .await?;
    let browser = Browser::start(&Options { webgpu: false, ..Options::default() }).await?;
    browser.go(&format!("http://{}/", pages.addr)).await?;
    for (name, side, fraction) in ICONS {
        let drawn: Vec<u8> = serde_json::from_value(browser.evaluate(&format!("({DRAW})({side}, {fraction})")).await?)?;
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../client-wasm/web").join(name);
        if std::env::var_os("PRAIRIE_UPDATE").is_some() {
            fs::write(&file, &drawn)?;
        }
        let stored = Picture::from_png(&fs::read(&file).with_context(|| format!("{name}; PRAIRIE_UPDATE=1 draws it"))?)?;
        ensure!((stored.width, stored.height) == (side, side), "{name} has {} × {} px", stored.width, stored.height);
        let difference = stored.difference(&Picture::from_png(&drawn)?)?;
        ensure!(difference.changed < 0.02, "{name} shows another icon: {difference:?}; PRAIRIE_UPDATE=1 draws it again");
    }
    Ok(())
}
