//! The gallery: a page of views with frame times, similarity to a reference, and the corresponding figures in the literature.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context as _, Result};
use prairie_client::render::{Gpu, Quality, RenderOptions};

use prairie::charts::similarity::Similarity;
use prairie::charts::still::Still;
use prairie::charts::texture::Texture;
use prairie::charts::views::View;

/// A picture of the page.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate {
    view: View,
    shots: Vec<Shot>,
}

/// A view at one quality.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shot {
    quality: Quality,
    ms: f64,
    similarity: Similarity,
}

/// Measures a view in all qualities and draws it into `folder` in one of them. References are cached in `cache`.
///
/// # Errors
/// When the view cannot be drawn or a file cannot be written.
pub fn plate(gpu: &Gpu, view: &View, size_px: [u32; 2], quality: Quality, folder: &Path, cache: &Path) -> Result<Plate> {
    let mut still = Still::of(view, size_px)?;
    let reference = still.kept_reference(gpu, &reference_path(cache, view, size_px))?;
    let mut shots = Vec::new();
    for of in Quality::ALL {
        let mut canvas = still.canvas(gpu, of);
        canvas.set_options(RenderOptions::default());
        let (picture, _) = still.draw(&mut canvas);
        shots.push(Shot { quality: of, ms: 1e3 * still.frame_secs(&mut canvas, 3), similarity: Similarity::of(&reference, &picture)? });
        if of == quality {
            picture.save(&folder.join(format!("{}.jpg", view.name)))?;
        }
    }
    Ok(Plate { view: *view, shots })
}

/// Cache file of the reference of a view.
pub fn reference_path(cache: &Path, view: &View, [width, height]: [u32; 2]) -> std::path::PathBuf {
    cache.join(format!("{}-{width}x{height}.png", view.name))
}

/// Writes `README.md` beside the pictures.
///
/// # Errors
/// When the file cannot be written.
pub fn write(plates: &[Plate], [width, height]: [u32; 2], quality: Quality, machine: &str, folder: &Path) -> Result<()> {
    let path = folder.join("README.md");
    let (size, quality) = (format!("{width}x{height}"), quality.name());
    let mut text = format!(
        "# Gallery\n\nTen views, from an ant's to an aircraft's height, in calm air and in a storm, at {size} px and {quality} quality. Each states, for every quality, the median\n\
         frame time in software rendering, and the mean FLIP, SSIM and texture against a reference that draws every plant at full detail ([method](../../README.md#the-picture)).\n\
         It also names the corresponding figures in the literature ([bibliography](../../../shared/README.md#bibliography)). [More pictures](../README.md)\n\n\
         {machine}\n\n```sh\ncargo run --release -p tests --bin chart -- gallery --size {size} --quality {quality}\n```\n"
    );
    for Plate { view, shots } in plates {
        let View { name, scene, shows, answers, .. } = view;
        let rows: String = shots
            .iter()
            .map(|Shot { quality, ms, similarity: Similarity { flip_mean, ssim, texture, .. } }| {
                let Texture { brightness, contrast, gradients } = texture;
                format!(
                    "| {} | {ms:.0} ms | {flip_mean:.4} | {ssim:.4} | {brightness:.4} | {contrast:.4} | {gradients:.3} |\n",
                    quality.name()
                )
            })
            .collect();
        writeln!(
            text,
            "\n## {name}\n\n![{shows}]({name}.jpg)\n\nScene `{scene}`: {shows}. Compare {answers}.\n\n| quality | frame time | mean FLIP | SSIM | brightness | contrast | gradients |\n|---|---:|---:|---:|---:|---:|---:|\n\
             {rows}\n```sh\ncargo run --release -p tests --bin chart -- gallery --size {size} --quality {quality} --views {name}\n```"
        )
        .expect("writing to a string cannot fail");
    }
    std::fs::write(&path, text).with_context(|| format!("{} cannot be written", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie::charts::views::VIEWS;

    #[test]
    fn the_page_shows_every_plate_with_its_figures() -> Result<()> {
        let folder = tempfile::tempdir()?;
        let texture = Texture { brightness: 0.0123, contrast: 0.0034, gradients: 0.256 };
        let similarity = Similarity { flip_mean: 0.0412, flip_worst: 0.3, ssim: 0.871, texture };
        let shots = Quality::ALL.map(|quality| Shot { quality, ms: 123.4, similarity }).to_vec();
        let plates = VIEWS.map(|view| Plate { view, shots: shots.clone() });
        write(&plates, [640, 360], Quality::High, "made-up machine", folder.path())?;
        let page = std::fs::read_to_string(folder.path().join("README.md"))?;
        for view in VIEWS {
            let section = page.split("\n## ").find(|section| section.starts_with(&format!("{}\n", view.name)));
            let section = section.with_context(|| format!("{} is missing", view.name))?;
            assert!(section.contains(&format!("({}.jpg)", view.name)) && section.contains(view.answers), "{section}");
            assert!(section.contains("| medium | 123 ms | 0.0412 | 0.8710 | 0.0123 | 0.0034 | 0.256 |\n| high | 123 ms |"), "{section}");
        }
        assert!(page.contains("made-up machine"));
        Ok(())
    }
}
