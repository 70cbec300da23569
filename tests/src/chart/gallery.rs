//! A page of pictures: each view with what it costs, how near it comes to the reference, and which figures of the source texts it answers.

use std::fmt::Write as _;
use std::path::Path;

use anyhow::{Context as _, Result};
use client_wasm::render::{Gpu, Look, Quality};

use crate::likeness::Likeness;
use crate::still::Still;
use crate::views::View;

/// A picture of the page.
#[derive(Clone, Debug, PartialEq)]
pub struct Plate {
    view: View,
    shots: Vec<Shot>,
}

/// The view as a visitor with some quality sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shot {
    quality: Quality,
    ms: f64,
    likeness: Likeness,
}

/// Measures a view in all qualities and draws it into `folder` in one of them. References are kept in `cache`.
///
/// # Errors
/// When the view cannot be played or a file cannot be written.
pub fn plate(gpu: &Gpu, view: &View, size_px: [u32; 2], quality: Quality, folder: &Path, cache: &Path) -> Result<Plate> {
    let mut still = Still::of(view, size_px)?;
    let reference = still.kept_reference(gpu, &reference_path(cache, view, size_px))?;
    let mut shots = Vec::new();
    for of in Quality::ALL {
        let mut canvas = still.canvas(gpu, of);
        canvas.set_look(Look::default());
        let (picture, _) = still.draw(&mut canvas);
        shots.push(Shot { quality: of, ms: 1e3 * still.frame_secs(&mut canvas, 3), likeness: Likeness::of(&reference, &picture)? });
        if of == quality {
            picture.save(&folder.join(format!("{}.png", view.name)))?;
        }
    }
    Ok(Plate { view: *view, shots })
}

/// Where the reference of a view is kept.
pub fn reference_path(cache: &Path, view: &View, [width, height]: [u32; 2]) -> std::path::PathBuf {
    cache.join(format!("{}-{width}x{height}.png", view.name))
}

/// Writes `README.md` beside the pictures.
///
/// # Errors
/// When it cannot be written.
pub fn write(plates: &[Plate], [width, height]: [u32; 2], quality: Quality, machine: &str, folder: &Path) -> Result<()> {
    let path = folder.join("README.md");
    let (size, quality) = (format!("{width}x{height}"), quality.name());
    let mut text = format!(
        "# Gallery\n\nTen views, from an ant's to an aircraft's, in calm air and in a storm, at {size} px and {quality} quality. Beside each, for every quality: the median time of a\n\
         frame in software rendering, mean FLIP and SSIM against a reference that draws every plant at full detail ([how they are measured](../../README.md#the-picture)), and the figures of the source\n\
         texts that it answers: 000 Zhang Xia's prairie, 001 the continuum grass of Chen & Johan, 003 Bakay's shells, 004 the underbrush of Endo, Morimoto & Fabris.\n\n\
         {machine}\n\n```sh\ncargo run --release -p tests --bin chart -- gallery --size {size} --quality {quality}\n```\n"
    );
    for Plate { view, shots } in plates {
        let View { name, scene, shows, answers, .. } = view;
        let rows: String = shots
            .iter()
            .map(|Shot { quality, ms, likeness: Likeness { flip_mean, ssim, .. } }| {
                format!("| {} | {ms:.0} ms | {flip_mean:.4} | {ssim:.4} |\n", quality.name())
            })
            .collect();
        writeln!(
            text,
            "\n## {name}\n\n![{shows}]({name}.png)\n\nScene `{scene}`: {shows}. Answers {answers}.\n\n| quality | time of a frame | mean FLIP | SSIM |\n|---|---:|---:|---:|\n\
             {rows}\n```sh\ncargo run --release -p tests --bin chart -- gallery --size {size} --quality {quality} --views {name}\n```"
        )
        .expect("a string takes all");
    }
    std::fs::write(&path, text).with_context(|| format!("{} cannot be written", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::views::VIEWS;

    #[test]
    fn the_page_shows_every_plate_with_its_figures() -> Result<()> {
        let folder = tempfile::tempdir()?;
        let likeness = Likeness { flip_mean: 0.0412, flip_worst: 0.3, ssim: 0.871 };
        let shots = Quality::ALL.map(|quality| Shot { quality, ms: 123.4, likeness }).to_vec();
        let plates = VIEWS.map(|view| Plate { view, shots: shots.clone() });
        write(&plates, [640, 360], Quality::High, "made-up machine", folder.path())?;
        let page = std::fs::read_to_string(folder.path().join("README.md"))?;
        for view in VIEWS {
            let section = page.split("\n## ").find(|section| section.starts_with(&format!("{}\n", view.name)));
            let section = section.with_context(|| format!("{} is missing", view.name))?;
            assert!(section.contains(&format!("({}.png)", view.name)) && section.contains(view.answers), "{section}");
            assert!(section.contains("| medium | 123 ms | 0.0412 | 0.8710 |\n| high | 123 ms |"), "{section}");
        }
        assert!(page.contains("made-up machine"));
        Ok(())
    }
}
