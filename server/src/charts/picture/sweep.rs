//! Frame times against one quantity, a line for each quality.

use std::fmt::Write as _;

use anyhow::Result;
use prairie_client::camera::Camera;
use prairie_client::render::{Gpu, OffscreenRenderer as Canvas, Quality};
use prairie_client::state::Mirror;

use crate::charts::still::frame_secs;
use prairie_charts::figure::{Axis, Curve, Drawn, Words, curves_svg};

/// Size of the pictures (px), and of quick ones.
const SIZE_PX: [u32; 2] = [960, 540];
const QUICK_SIZE_PX: [u32; 2] = [160, 90];

pub(super) fn qualities(quick: bool) -> &'static [Quality] {
    if quick { &[Quality::Low, Quality::Medium] } else { &[Quality::Low, Quality::Medium, Quality::High] }
}

/// A measured row: quality, quantity, frame time (ms), simulated plants, drawn clumps.
#[derive(Default)]
pub(super) struct Sweep {
    timed: Vec<(Quality, f64, f64, u32, u32)>,
}

impl Sweep {
    pub(super) fn time(&mut self, gpu: &Gpu, quick: bool, quality: Quality, at: f64, mirror: &mut Mirror, camera: &Camera) {
        let mut canvas = Canvas::new(gpu, if quick { QUICK_SIZE_PX } else { SIZE_PX }, quality);
        let stats = canvas.draw(mirror, camera, 0.0, 0.0);
        let secs = frame_secs(&mut canvas, mirror, camera, if quick { 1 } else { 5 });
        self.timed.push((quality, at, 1e3 * secs, stats.blades, stats.clumps));
    }
}

pub(super) fn sweep(found: &Sweep, title: &str, over: &'static str, quick: bool, caption: &str, gpu: &Gpu) -> Result<Drawn> {
    let mut csv = format!("quality,\"{over}\",ms,blades,clumps\n");
    for (quality, at, ms, blades, clumps) in &found.timed {
        writeln!(csv, "{},{at},{ms:.3},{blades},{clumps}", quality.name())?;
    }
    let curve = |quality: Quality| Curve {
        name: quality.name().to_owned(),
        points: found.timed.iter().filter(|timed| timed.0 == quality).map(|timed| [timed.1, timed.2]).collect(),
        marked: true,
        joined: true,
    };
    let curves: Vec<Curve> = qualities(quick).iter().map(|quality| curve(*quality)).collect();
    let mut summary = String::new();
    for curve in &curves {
        let (Some([from, first]), Some([to, last])) = (curve.points.first(), curve.points.last()) else { continue };
        writeln!(summary, "{}: {first:.0} ms at {from:.0}, {last:.0} ms at {to:.0}", curve.name)?;
    }
    let range = |axis: usize| {
        let values = curves.iter().flat_map(|curve| &curve.points).map(move |point| point[axis]);
        [values.clone().fold(f64::INFINITY, f64::min) / 1.3, values.fold(0.0, f64::max) * 1.3]
    };
    let axes =
        [Axis { name: over, range: range(0), logarithmic: true }, Axis { name: "frame time (ms)", range: range(1), logarithmic: true }];
    let [width, height] = if quick { QUICK_SIZE_PX } else { SIZE_PX };
    let subtitle = format!("{width} × {height} px; {}", gpu.adapter_name);
    let svg = curves_svg(&curves, axes, Words { title, subtitle: &subtitle, caption })?;
    Ok(Drawn { svg, csv, summary: summary.trim_end().to_owned(), tables: None, map: None })
}
