//! Time of the main pass per million vertices, over the views and the qualities.

use std::fmt::Write as _;
use std::time::Instant;

use anyhow::{Context as _, Result};
use prairie_client::render::{Gpu, OffscreenRenderer as Canvas, PipelineStatistics, Quality};

use super::regression::{Shares, Timed};
use crate::charts::still::Still;
use crate::charts::views::VIEWS;
use prairie_charts::figure::{Axis, Curve, Drawn, Words, curves_svg};
use prairie_charts::table::markdown;

/// Measurements to take.
struct Wanted {
    /// Sizes of the pictures (px). The smaller ones, with fewer fragments to a vertex, separate the two; the chart shows whole passes at the first.
    sizes_px: [[u32; 2]; 3],
    qualities: &'static [Quality],
    /// Every n-th view is measured.
    view_step: usize,
    /// Rounds of frames; the shortest time counts, since disturbances only lengthen it.
    rounds: u32,
    /// Time for the frames of a picture in a round (s); at least one frame is drawn.
    round_secs: f64,
}

const THOROUGH: Wanted =
    Wanted { sizes_px: [[960, 540], [480, 270], [240, 135]], qualities: &Quality::ALL, view_step: 1, rounds: 4, round_secs: 0.3 };
const QUICK: Wanted = Wanted {
    sizes_px: [[160, 90], [80, 44], [40, 22]],
    qualities: &[Quality::Low, Quality::Medium],
    view_step: 5,
    rounds: 1,
    round_secs: 0.0,
};
/// Points of a line on the chart.
const LINE_POINTS: u32 = 60;
const TITLE: &str = "Time of the main pass per million vertices";

/// The main pass of one view at one quality and size.
#[derive(Clone, Debug)]
struct Shot {
    view: &'static str,
    quality: Quality,
    size_px: [u32; 2],
    /// Drawn pixels, including supersamples.
    pixels: u64,
    work: PipelineStatistics,
    ms: f64,
}

impl Shot {
    /// Total time of the pass per million vertices, and per million fragments (ms).
    fn per_million(&self) -> [f64; 2] {
        [self.work.vertices, self.work.fragments].map(|count| self.ms / millions(count))
    }
}

fn millions(count: u64) -> f64 {
    1e-6 * count as f64
}

/// Draws the same moment on every canvas in turn, repeatedly, so that a disturbance does not affect one canvas in all rounds.
fn shots(gpu: &Gpu, wanted: &Wanted) -> Result<Vec<Shot>> {
    let mut shots = Vec::new();
    for view in VIEWS.iter().step_by(wanted.view_step) {
        let mut still = Still::of(view, wanted.sizes_px[0])?;
        let sized = wanted.sizes_px.iter().flat_map(|size_px| wanted.qualities.iter().map(|quality| (*size_px, *quality)));
        let mut canvases: Vec<_> = sized
            .map(|(size_px, quality)| {
                let supersampling = quality.supersampling(size_px, gpu.side_limit_px());
                let pixels = size_px.iter().map(|side| u64::from(side * supersampling)).product();
                let shot = Shot { view: view.name, quality, size_px, pixels, work: PipelineStatistics::default(), ms: f64::INFINITY };
                (shot, Canvas::new(gpu, size_px, quality))
            })
            .collect();
        // The first round fills buffers.
        for round in 0..=wanted.rounds {
            for (shot, canvas) in &mut canvases {
                still.size_px = shot.size_px;
                let begun = Instant::now();
                loop {
                    still.draw(canvas);
                    let secs = canvas.pass_secs().context("the device has no clock")?.picture;
                    if round == 0 {
                        break;
                    }
                    shot.ms = shot.ms.min(1e3 * secs);
                    if begun.elapsed().as_secs_f64() >= wanted.round_secs {
                        break;
                    }
                }
                shot.work = canvas.pass_statistics().context("the device does not count vertices")?.picture;
            }
        }
        shots.extend(canvases.into_iter().map(|(shot, _)| shot));
    }
    Ok(shots)
}

/// The shots of one quality.
fn of(shots: &[Shot], quality: Quality) -> impl Iterator<Item = &Shot> {
    shots.iter().filter(move |shot| shot.quality == quality)
}

/// Times per million vertices and per million of the other quantity.
fn fractions<'a>(shots: impl IntoIterator<Item = &'a Shot>, other: fn(&Shot) -> u64) -> Result<Shares> {
    let timed = |shot: &Shot| Timed { work: [shot.work.vertices, other(shot)].map(millions), ms: shot.ms };
    Shares::of(&shots.into_iter().map(timed).collect::<Vec<_>>()).context("the sizes do not tell vertices from the rest")
}

fn fragments(shot: &Shot) -> u64 {
    shot.work.fragments
}

fn pixels(shot: &Shot) -> u64 {
    shot.pixels
}

fn cells(Shares { ms: [vertices, other], errors, residual }: Shares) -> Vec<String> {
    let fractions = [(vertices, errors[0]), (other, errors[1])].map(|(ms, error)| format!("{ms:.0} ± {error:.0}"));
    fractions.into_iter().chain([format!("{:.0} %", 100.0 * residual)]).collect()
}

/// Both fits: over all views and sizes of each quality, then over all of a view.
fn shares_table(shots: &[Shot], qualities: &[Quality]) -> Result<String> {
    let by_quality = qualities.iter().map(|quality| (quality.name(), of(shots, *quality).collect::<Vec<_>>()));
    let by_view = shots.chunk_by(|a, b| a.view == b.view).map(|part| (part[0].view, part.iter().collect()));
    let mut rows = Vec::new();
    for (name, part) in by_quality.chain(by_view).chain([("all", shots.iter().collect())]) {
        let [of_fragments, of_pixels] = [fragments, pixels].map(|other| fractions(part.iter().copied(), other));
        rows.push([vec![name.to_owned()], cells(of_fragments?), cells(of_pixels?)].concat());
    }
    Ok(markdown(&["quality or view", "vertices", "fragments", "residual", "or: vertices", "pixels", "residual"], &rows))
}

/// Every view at every quality, at the first size.
fn shots_table(shots: &[Shot]) -> String {
    let row = |shot: &Shot| {
        let PipelineStatistics { vertices, triangles, fragments, .. } = shot.work;
        let counts = [vertices, triangles, fragments].map(|count| format!("{:.2}", millions(count)));
        let [by_vertices, by_fragments] = shot.per_million();
        let times = [shot.ms, by_vertices, by_fragments].map(|ms| format!("{ms:.1}"));
        [[shot.view, shot.quality.name()].map(str::to_owned).as_slice(), &counts, &times].concat()
    };
    let largest = shots.iter().filter(|shot| shot.size_px == shots[0].size_px);
    let header = [
        "view",
        "quality",
        "vertices (M)",
        "triangles (M)",
        "fragments (M)",
        "picture's pass (ms)",
        "ms per million vertices",
        "ms per million fragments",
    ];
    markdown(&header, &largest.map(row).collect::<Vec<_>>())
}

/// Figures as CSV (RFC 4180).
fn csv(shots: &[Shot]) -> String {
    let mut text = String::from(
        "view,quality,width_px,height_px,pixels,vertices,triangles,fragments,ms,ms_per_million_vertices,ms_per_million_fragments\n",
    );
    for shot in shots {
        let Shot { view, quality, size_px: [width, height], pixels, work: PipelineStatistics { vertices, triangles, fragments, .. }, ms } =
            shot;
        let ([by_vertices, by_fragments], quality) = (shot.per_million(), quality.name());
        write!(text, "{view},{quality},{width},{height},{pixels},{vertices},{triangles},{fragments},").expect("a string takes all");
        writeln!(text, "{ms:.3},{by_vertices:.3},{by_fragments:.3}").expect("a string takes all");
    }
    text
}

/// Time per million vertices against pixels per vertex: the passes, and the line of each quality, which is bent as both axes are logarithmic.
fn chart(shots: &[Shot], qualities: &[Quality], words: Words) -> Result<String> {
    let at = |shot: &Shot| [shot.pixels as f64 / shot.work.vertices as f64, shot.per_million()[0]];
    let range = |axis: usize| {
        let values = shots.iter().map(|shot| at(shot)[axis]);
        [values.clone().fold(f64::INFINITY, f64::min) / 1.3, values.fold(0.0, f64::max) * 1.3]
    };
    let [across, up] = [0, 1].map(range);
    let mut curves = Vec::new();
    for quality in qualities {
        let Shares { ms: [vertices_ms, pixels_ms], .. } = fractions(of(shots, *quality), pixels)?;
        let name = format!("{}: {vertices_ms:.0} ms + {pixels_ms:.0} ms · x", quality.name());
        curves.push(Curve { name, points: of(shots, *quality).map(at).collect(), marked: true, joined: false });
        let places = (0..=LINE_POINTS).map(|n| across[0] * (across[1] / across[0]).powf(f64::from(n) / f64::from(LINE_POINTS)));
        let line = places.map(|x| [x, vertices_ms + pixels_ms * x]).filter(|[_, y]| (up[0]..=up[1]).contains(y)).collect();
        curves.push(Curve { name: String::new(), points: line, marked: false, joined: true });
    }
    let axes = [
        Axis { name: "pixels of the picture per vertex: x", range: across, logarithmic: true },
        Axis { name: "time of the pass per million vertices (ms)", range: up, logarithmic: true },
    ];
    curves_svg(&curves, axes, words)
}

pub(super) fn draw(quick: bool, caption: &str) -> Result<Drawn> {
    let gpu = Gpu::headless()?;
    let wanted = if quick { QUICK } else { THOROUGH };
    let shots = shots(&gpu, &wanted)?;
    let sizes: Vec<String> = wanted.sizes_px.iter().map(|[width, height]| format!("{width} × {height}")).collect();
    let views = VIEWS.iter().step_by(wanted.view_step).count();
    let subtitle = format!("{views} views at {} px, least of {} or more frames; {}", sizes.join(", "), wanted.rounds, gpu.adapter_name);
    let svg = chart(&shots, wanted.qualities, Words { title: TITLE, subtitle: &subtitle, caption })?;
    let fractions = shares_table(&shots, wanted.qualities)?;
    let tables = format!(
        "# {TITLE}\n\n{subtitle}; {caption}\n\n```sh\ncargo run --release --features charts -- chart picture --only vertices --out tests/results\n```\n\n\
         [The tests' README](../README.md#the-picture) says how to read this page.\n\n## Cost per million (ms)\n\n\
         Least squares over all views and sizes, or all qualities and sizes, with standard errors; the residual is the root of the mean square of the difference, as a fraction of the time. First of\n\
         vertices and fragments; then of vertices and the pixels of the picture.\n\n{fractions}\n\
         ## Whole passes\n\nAt {} px, as the device counts and times them: all of a pass's time over its vertices, and all of it over its fragments.\n\n{}",
        sizes[0],
        shots_table(&shots)
    );
    Ok(Drawn {
        svg,
        csv: csv(&shots),
        summary: format!("ms that a million takes\n{}", fractions.trim_end()),
        tables: Some(tables),
        map: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made_up() -> Vec<Shot> {
        let passes = [
            ([960, 540], 2_000_000, 8_000_000),
            ([480, 270], 1_900_000, 2_000_000),
            ([240, 135], 1_800_000, 600_000),
            ([120, 68], 1_500_000, 500_000),
        ];
        let shot = |(size_px, vertices, fragments): ([u32; 2], u64, u64)| Shot {
            view: "ant-calm",
            quality: Quality::Low,
            size_px,
            pixels: size_px.map(u64::from).iter().product(),
            work: PipelineStatistics { vertices, triangles: 1_000_000, fragments, compute_invocations: 0 },
            ms: 50.0 * millions(vertices) + 20.0 * millions(fragments),
        };
        passes.map(shot).into()
    }

    /// Rows of a Markdown table, cells trimmed.
    fn rows(table: &str) -> Vec<Vec<&str>> {
        table.lines().skip(2).map(|line| line.trim_matches('|').split('|').map(str::trim).collect()).collect()
    }

    #[test]
    fn tables_say_what_was_measured() {
        let shots = made_up();
        let fractions = shares_table(&shots, &[Quality::Low]).unwrap();
        assert_eq!(
            rows(&fractions).iter().map(|row| &row[..4]).collect::<Vec<_>>(),
            ["low", "ant-calm", "all"].map(|name| [name, "50 ± 0", "20 ± 0", "0 %"])
        );
        assert_eq!(rows(&shots_table(&shots)), [["ant-calm", "low", "2.00", "1.00", "8.00", "260.0", "130.0", "32.5"]]);
        assert_eq!(csv(&shots).lines().nth(1), Some("ant-calm,low,960,540,518400,2000000,1000000,8000000,260.000,130.000,32.500"));
    }

    #[test]
    fn the_chart_has_a_key_for_each_quality_alone() {
        let text = chart(&made_up(), &[Quality::Low], Words { title: "title", subtitle: "subtitle", caption: "caption" }).unwrap();
        assert!(text.contains("low: ") && text.contains(" ms · x") && text.matches("<polyline").count() > 1, "{text}");
    }
}
