//! A log–log chart as SVG.

use anyhow::{Context as _, Result};
use plotters::coord::Shift;
use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::line::{Line, family, front};
use super::memory_limit::MEMORY_LIMIT;
use super::ticks::ticks;

/// Texts around the lines.
#[derive(Clone, Copy, Debug)]
pub struct Labels<'a> {
    /// Title.
    pub title: &'a str,
    /// Quantity of the error, with its unit.
    pub error: &'a str,
    /// Quantity of the time, with its unit.
    pub time: &'a str,
    /// Machine and versions.
    pub caption: &'a str,
    /// The method that scenes use by default.
    pub default_method: Option<&'a str>,
    /// A limit of the machine: error and time (s). Empty without one.
    pub limit: &'a [[f64; 2]],
}

pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Plane<'a> = DrawingArea<SVGBackend<'a>, Cartesian2d<LogCoord<f64>, LogCoord<f64>>>;

const PLOT_PX: u32 = 790;
const HEIGHT_PX: u32 = 680;
/// Average width of a letter of the legend (px).
const LETTER_PX: usize = 8;
const FONT: &str = "Helvetica, Arial, sans-serif";
pub(super) const INK: RGBColor = RGBColor(32, 36, 42);
pub(super) const FAINT_INK: RGBColor = RGBColor(96, 102, 110);
pub(super) const GRID: RGBColor = RGBColor(208, 212, 217);
const FAINT_GRID: RGBColor = RGBColor(236, 238, 241);
const FRONT: RGBColor = RGBColor(255, 229, 153);
/// Distinguishable with any colour vision, together with the markers: the palette of Okabe & Ito without yellow, then darker colours of Tol's.
pub(super) const COLOURS: [RGBColor; 11] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(86, 180, 233),
    RGBColor(230, 159, 0),
    RGBColor(51, 34, 136),
    RGBColor(136, 34, 85),
    RGBColor(153, 153, 51),
    RGBColor(40, 40, 40),
    RGBColor(68, 170, 153),
];
/// Corners of the markers (px).
const MARKERS: [&[(i32, i32)]; 6] = [
    &[(-2, -5), (2, -5), (5, -2), (5, 2), (2, 5), (-2, 5), (-5, 2), (-5, -2)],
    &[(-5, -5), (5, -5), (5, 5), (-5, 5)],
    &[(0, -7), (7, 5), (-7, 5)],
    &[(0, -7), (7, 0), (0, 7), (-7, 0)],
    &[(0, 7), (7, -5), (-7, -5)],
    &[(-2, -6), (2, -6), (2, -2), (6, -2), (6, 2), (2, 2), (2, 6), (-2, 6), (-2, 2), (-6, 2), (-6, -2), (-2, -2)],
];

/// Draws time (y) against error (x): a line with markers for each method, the Pareto front, and a legend. Methods of one [`family`] share
/// colour and marker; the first of a family has solid markers, the others hollow ones. The default method is named as such.
///
/// # Errors
/// When no line has a point.
pub fn svg(lines: &[Line], labels: Labels) -> Result<String> {
    let points = || lines.iter().flat_map(|line| &line.rows);
    let errors = range(points().map(|row| row.error)).context("no point to draw")?;
    let times = range(points().map(|row| row.wall_secs).chain(labels.limit.iter().map(|[_, secs]| *secs))).context("no point to draw")?;

    let longest = lines.iter().map(|line| line.method.chars().count()).fold(34, usize::max);
    let size_px = (PLOT_PX + 80 + (LETTER_PX * longest) as u32, HEIGHT_PX);
    let mut text = String::new();
    let root = SVGBackend::with_string(&mut text, size_px).into_drawing_area();
    root.fill(&WHITE)?;
    write(&root, labels.title, (24, 32), 28, INK, HPos::Left)?;
    write(&root, "left: more accurate · down: faster", (24, 60), 17, FAINT_INK, HPos::Left)?;
    write(&root, labels.caption, (24, HEIGHT_PX as i32 - 18), 15, FAINT_INK, HPos::Left)?;

    let (left, legend) = root.margin(80, 36, 0, 0).split_horizontally(PLOT_PX);
    let chart = ChartBuilder::on(&left)
        .x_label_area_size(64)
        .y_label_area_size(96)
        .build_cartesian_2d((errors.0..errors.1).log_scale(), (times.0..times.1).log_scale())?;
    let plane: &Plane = chart.plotting_area();
    draw_axes(&root, plane, errors, times, labels)?;

    let pixels = |rows: &[&super::Row]| rows.iter().map(|row| plane.map_coordinate(&(row.error, row.wall_secs))).collect::<Vec<_>>();
    let best = pixels(&front(lines));
    best.iter().try_for_each(|&at| root.draw(&Circle::new(at, 11, FRONT.filled())))?;
    root.draw(&PathElement::new(best, FRONT.stroke_width(14)))?;
    let mut families: Vec<&str> = Vec::new();
    let step = (560 / (lines.len() as i32 + 2)).min(26);
    for (line, n) in lines.iter().zip(0..) {
        let (y, family) = (14 + step * n, family(line.method));
        let known = families.iter().position(|other| *other == family);
        let place = known.unwrap_or(families.len());
        if known.is_none() {
            families.push(family);
        }
        let (colour, corners) = look(place);
        let marker = Marker { corners, colour, hollow: known.is_some() };
        let points = pixels(&line.rows);
        root.draw(&PathElement::new(points.clone(), colour.stroke_width(2)))?;
        points.into_iter().try_for_each(|at| marker.draw(&root, at))?;
        let is_default = labels.default_method == Some(line.method) || labels.default_method == Some(family);
        draw_key(&legend, y, &format!("{}{}", line.method, if is_default { " (default)" } else { "" }), colour.stroke_width(2))?;
        marker.draw(&legend, (34, y))?;
    }
    draw_key(&legend, 14 + step * lines.len() as i32, "Pareto front", FRONT.stroke_width(14))?;
    if !labels.limit.is_empty() {
        let limit: Vec<_> = labels.limit.iter().map(|[error, secs]| plane.map_coordinate(&(*error, *secs))).collect();
        root.draw(&DashedPathElement::new(limit, 6, 5, FAINT_INK.stroke_width(2)))?;
        draw_key(&legend, 14 + step * (lines.len() as i32 + 1), MEMORY_LIMIT, FAINT_INK.stroke_width(2))?;
    }
    root.present()?;
    drop((chart, legend, left, root));
    Ok(text)
}

/// Grid lines, numbers and titles of both axes.
fn draw_axes(root: &Area, plane: &Plane, errors: (f64, f64), times: (f64, f64), labels: Labels) -> Result<()> {
    let (x, y) = plane.get_pixel_range();
    // Faint lines first, so that the others run over them.
    for labelled in [false, true] {
        let colour = if labelled { GRID } else { FAINT_GRID };
        for tick in ticks(errors).into_iter().filter(|tick| tick.label.is_some() == labelled) {
            let at = plane.map_coordinate(&(tick.value, times.0)).0;
            root.draw(&PathElement::new([(at, y.start), (at, y.end)], colour))?;
            write(root, &tick.label.unwrap_or_default(), (at, y.end + 16), 17, INK, HPos::Center)?;
        }
        for tick in ticks(times).into_iter().filter(|tick| tick.label.is_some() == labelled) {
            let at = plane.map_coordinate(&(errors.0, tick.value)).1;
            root.draw(&PathElement::new([(x.start, at), (x.end, at)], colour))?;
            write(root, &tick.label.unwrap_or_default(), (x.start - 8, at), 17, INK, HPos::Right)?;
        }
    }
    root.draw(&Rectangle::new([(x.start, y.start), (x.end, y.end)], FAINT_INK))?;
    write(root, labels.error, ((x.start + x.end) / 2, y.end + 46), 18, INK, HPos::Center)?;
    let upwards = text_style(18, INK, HPos::Center).transform(FontTransform::Rotate270);
    root.draw(&Text::new(labels.time.to_owned(), (30, (y.start + y.end) / 2), upwards))?;
    Ok(())
}

/// A legend entry without its marker.
fn draw_key(legend: &Area, y: i32, name: &str, stroke: ShapeStyle) -> Result<()> {
    legend.draw(&PathElement::new([(16, y), (52, y)], stroke))?;
    write(legend, name, (64, y), 17, INK, HPos::Left)
}

pub(super) struct Marker {
    pub(super) corners: &'static [(i32, i32)],
    pub(super) colour: RGBColor,
    pub(super) hollow: bool,
}

impl Marker {
    pub(super) fn draw(&self, area: &Area, at: (i32, i32)) -> Result<()> {
        let placed: Vec<(i32, i32)> = self.corners.iter().map(|corner| (at.0 + corner.0, at.1 + corner.1)).collect();
        area.draw(&Polygon::new(placed.clone(), if self.hollow { WHITE } else { self.colour }.filled()))?;
        area.draw(&PathElement::new([placed.clone(), vec![placed[0]]].concat(), self.colour.stroke_width(2)))?;
        Ok(())
    }
}

pub(super) fn text_style<'a>(size_px: u32, colour: RGBColor, horizontal: HPos) -> TextStyle<'a> {
    (FONT, size_px).into_font().color(&colour).pos(Pos::new(horizontal, VPos::Center))
}

/// Writes text, vertically centred at `at`, aligned by its start, middle or end.
pub(super) fn write(area: &Area, text: &str, at: (i32, i32), size_px: u32, colour: RGBColor, horizontal: HPos) -> Result<()> {
    if !text.is_empty() {
        area.draw(&Text::new(text.to_owned(), at, text_style(size_px, colour, horizontal)))?;
    }
    Ok(())
}

/// Colour and marker of the n-th family; the first 66 pairs differ.
pub(super) fn look(style: usize) -> (RGBColor, &'static [(i32, i32)]) {
    let (round, place) = (style / COLOURS.len(), style % COLOURS.len());
    (COLOURS[place], MARKERS[(place + round) % MARKERS.len()])
}

/// Smallest and largest value with a margin; `None` without values.
fn range(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let (least, most) = values.fold((f64::INFINITY, 0.0f64), |(least, most), value| (least.min(value), most.max(value)));
    (least <= most).then(|| (least / 1.5, most * 1.5))
}

#[cfg(test)]
mod tests {
    use super::super::line::lines;
    use super::super::row::made_up::row;
    use super::*;

    const LABELS: Labels = Labels {
        title: "Made-up",
        error: "error (m/s)",
        time: "time (s/s)",
        caption: "made-up machine",
        default_method: Some("method 3"),
        limit: &[[0.1, 1e-4], [0.01, 1e-3]],
    };

    #[test]
    fn every_method_has_a_line_a_legend_and_its_own_look() {
        let methods: Vec<String> = (0..20).map(|n| format!("method {n}")).collect();
        let names: Vec<&str> = methods.iter().map(String::as_str).collect();
        let rows: Vec<_> = names.iter().flat_map(|name| [row("p", name, 8, 0.1, 1e-3), row("p", name, 16, 0.01, 1e-2)]).collect();
        let text = svg(&lines(&rows, "p", "l2"), LABELS).unwrap();
        assert!(text.starts_with("<svg") && text.trim_end().ends_with("</svg>"));
        for label in names.iter().chain(&[
            "Made-up",
            "error (m/s)",
            "time (s/s)",
            "made-up machine",
            "Pareto front",
            "method 3 (default)",
            MEMORY_LIMIT,
        ]) {
            assert!(text.contains(label), "{label} is missing");
        }
        let looks = (0..66).map(look).map(|(colour, corners)| ((colour.0, colour.1, colour.2), corners));
        assert_eq!(looks.collect::<std::collections::HashSet<_>>().len(), 66);
    }

    #[test]
    fn finer_is_left_and_slower_is_up() {
        let rows = [row("p", "a", 8, 0.1, 1e-3), row("p", "a", 16, 0.01, 1e-2)];
        let text = svg(&lines(&rows, "p", "l2"), LABELS).unwrap();
        let path = text.lines().find(|line| line.contains("<polyline") && line.contains("stroke-width=\"2\"")).unwrap();
        let numbers: Vec<i32> =
            path.split("points=\"").nth(1).unwrap().split(['"', ' ', ',']).map_while(|word| word.parse().ok()).collect();
        let [coarse_x, coarse_y, fine_x, fine_y] = numbers[..] else { panic!("{path}") };
        assert!(fine_x < coarse_x && fine_y < coarse_y, "{path}");
    }

    #[test]
    fn a_family_has_one_colour_and_its_later_members_hollow_markers() {
        let rows = ["a, Courant 1", "a, Courant 2", "b"].map(|method| row("p", method, 8, 0.1, 1e-3));
        let text = svg(&lines(&rows, "p", "l2"), LABELS).unwrap();
        let fills: Vec<&str> = text
            .lines()
            .filter(|line| line.contains("<polygon"))
            .filter_map(|line| line.split("fill=\"").nth(1)?.split('"').next())
            .collect();
        // On the plane and in the legend.
        assert_eq!(fills, ["#0072B2", "#0072B2", "#FFFFFF", "#FFFFFF", "#D55E00", "#D55E00"]);
    }

    #[test]
    fn without_a_point_there_is_no_chart() {
        assert!(svg(&[], LABELS).is_err());
    }
}
