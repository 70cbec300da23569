//! All render options against the reference, at medium quality.

use anyhow::{Result, ensure};
use prairie::charts::image::Picture;
use prairie::charts::picture::METHODS;
use prairie::charts::similarity::{Flip, Similarity};
use prairie::charts::texture::Texture;
use prairie_client::render::Quality;

use crate::{SIZE_PX, gpu, view};

/// Bounds of mean FLIP and SSIM from the hill.
const HILL_BOUNDS: [f64; 2] = [0.14, 0.49];

/// Bounds of the difference of texture on every view.
const TEXTURE_BOUNDS: Texture = Texture { brightness: 0.05, contrast: 0.05, gradients: 0.35 };

/// Checks that all render options keep to an upper bound of mean FLIP and a lower bound of SSIM, and to [`TEXTURE_BOUNDS`].
fn compare(name: &str, [most_flip, least_ssim]: [f64; 2]) -> Result<()> {
    let gpu = gpu()?;
    let (mut still, reference) = view(&gpu, name, SIZE_PX)?;
    let mut canvas = still.canvas(&gpu, Quality::Medium);
    let mut failures = Vec::new();
    for method in METHODS {
        canvas.set_options(method.look());
        let (picture, _) = still.draw(&mut canvas);
        let similarity = Similarity::of(&reference, &picture)?;
        println!("{name}, {}: {similarity:?}", method.name());
        if similarity.flip_mean > most_flip || similarity.ssim < least_ssim || !similarity.texture.is_within(&TEXTURE_BOUNDS) {
            let seen = std::env::temp_dir().join(format!("prairie-{name}-{}-{}.png", method.far.name(), method.order.name()));
            picture.save(&seen)?;
            Flip::of(&reference, &picture)?.heat_map().save(&seen.with_extension("flip.png"))?;
            failures.push(format!(
                "{}: {similarity:?}, FLIP up to {most_flip}, SSIM from {least_ssim} and {TEXTURE_BOUNDS:?} are allowed; see {}",
                method.name(),
                seen.display()
            ));
        }
    }
    ensure!(failures.is_empty(), "{name}\n{}", failures.join("\n"));
    Ok(())
}

#[test]
fn on_foot_all_render_options_are_similar_to_the_reference() -> Result<()> {
    compare("walking-calm", [0.25, 0.37])
}

#[test]
fn in_a_storm_all_render_options_are_similar_to_the_reference() -> Result<()> {
    compare("walking-storm", [0.22, 0.55])
}

#[test]
fn from_a_hill_all_render_options_are_similar_to_the_reference() -> Result<()> {
    compare("hill-calm", HILL_BOUNDS)
}

/// Negative control of the bounds above.
#[test]
fn another_view_differs_from_the_reference() -> Result<()> {
    let gpu = gpu()?;
    let (mut still, reference) = view(&gpu, "hill-calm", SIZE_PX)?;
    still.camera.turn(0.3, 0.0);
    let mut canvas = still.canvas(&gpu, Quality::Medium);
    let similarity = Similarity::of(&reference, &still.draw(&mut canvas).0)?;
    let [most_flip, least_ssim] = HILL_BOUNDS;
    ensure!(similarity.flip_mean > most_flip && similarity.ssim < least_ssim, "{similarity:?}");
    Ok(())
}

/// Negative control of the bounds of texture: grass drawn as blocks of its mean colours, and a picture a quarter darker.
#[test]
fn blocks_and_darker_grass_differ_in_texture() -> Result<()> {
    let (_, reference) = view(&gpu()?, "walking-calm", SIZE_PX)?;
    let block_px = 8;
    let means = reference.averaged(block_px);
    let changed = |change: &dyn Fn(u32, u32) -> [u8; 4]| {
        let pixels = (0..reference.height).flat_map(|y| (0..reference.width).map(move |x| (x, y)));
        Picture { rgba: pixels.flat_map(|(x, y)| change(x, y)).collect(), ..reference.clone() }
    };
    let last = [means.width - 1, means.height - 1];
    let blocks = Texture::of(&reference, &changed(&|x, y| means.pixel((x / block_px).min(last[0]), (y / block_px).min(last[1]))))?;
    ensure!(blocks.gradients > TEXTURE_BOUNDS.gradients, "{blocks:?}");
    let darker = Texture::of(&reference, &changed(&|x, y| reference.pixel(x, y).map(|level| level - level / 4)))?;
    ensure!(darker.brightness > TEXTURE_BOUNDS.brightness, "{darker:?}");
    Ok(())
}
