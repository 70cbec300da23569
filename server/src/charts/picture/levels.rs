//! Error of each quality against full detail, in all views. The plan of a scene's picture uses its data.

use std::fmt::Write as _;

use anyhow::Result;
use prairie_client::render::{Gpu, Quality};

use crate::charts::similarity::Similarity;
use crate::charts::still::Still;
use crate::charts::views::{VIEWS, View};
use prairie_charts::figure::{Axis, Curve, Drawn, Words, curves_svg};

/// Size of the pictures (px), and of quick ones.
const SIZE_PX: [u32; 2] = [640, 360];
const QUICK_SIZE_PX: [u32; 2] = [160, 90];

/// Mean FLIP of each quality in a view.
fn flips(gpu: &Gpu, view: &View, size_px: [u32; 2]) -> Result<Vec<(Quality, f64)>> {
    let mut still = Still::of(view, size_px)?;
    let reference = still.reference(gpu);
    let flip = |quality: Quality| {
        let mut canvas = still.canvas(gpu, quality);
        let (picture, _) = still.draw(&mut canvas);
        Ok((quality, Similarity::of(&reference, &picture)?.flip_mean))
    };
    Quality::ALL.into_iter().map(flip).collect()
}

pub(super) fn draw(quick: bool, caption: &str) -> Result<Drawn> {
    let gpu = Gpu::headless()?;
    let (views, size_px) = if quick { (&VIEWS[3..4], QUICK_SIZE_PX) } else { (&VIEWS[..], SIZE_PX) };
    let (mut csv, mut curves) = (String::from("view,quality,level,flip\n"), Vec::new());
    for view in views {
        let flips = flips(&gpu, view, size_px)?;
        for (quality, flip) in &flips {
            writeln!(csv, "{},{},{},{flip:.5}", view.name, quality.name(), quality.level())?;
        }
        let points = flips.iter().map(|(quality, flip)| [f64::from(quality.level()), *flip]).collect();
        curves.push(Curve { name: view.name.to_owned(), points, marked: true, joined: true });
    }
    let mut summary = String::new();
    for (at, quality) in Quality::ALL.into_iter().enumerate() {
        let flips = curves.iter().map(|curve| curve.points[at][1]);
        let (mean, worst) = (flips.clone().sum::<f64>() / curves.len() as f64, flips.fold(0.0, f64::max));
        writeln!(csv, "worst,{},{},{worst:.5}", quality.name(), quality.level())?;
        writeln!(summary, "{}: FLIP {mean:.4}, {worst:.4} in the worst view", quality.name())?;
    }
    let most = curves.iter().flat_map(|curve| &curve.points).map(|point| point[1]).fold(0.0, f64::max);
    let axes = [
        Axis { name: "level of detail, from low to ultra", range: [0.0, Quality::FINEST.level().into()], logarithmic: false },
        Axis { name: "mean FLIP to full detail", range: [0.0, 1.1 * most], logarithmic: false },
    ];
    let [width, height] = size_px;
    let subtitle = format!("{width} × {height} px; {}", gpu.adapter_name);
    let svg = curves_svg(&curves, axes, Words { title: "Error of the picture at each level of detail", subtitle: &subtitle, caption })?;
    Ok(Drawn::new(svg, csv, summary.trim_end().to_owned()))
}
