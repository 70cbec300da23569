//! Line charts with linear or logarithmic axes, and coloured fields, as SVG.

use anyhow::{Result, ensure};
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::plot::{Area, FAINT_INK, GRID, INK, Marker, look, text_style, write};
use super::ticks::ticks;

/// A figure that is not error against time.
pub struct Figure {
    /// Name within the file name.
    pub name: &'static str,
    /// Title.
    pub title: &'static str,
    /// Measures and draws the figure, quickly or thoroughly, with a caption.
    pub draw: fn(quick: bool, caption: &str) -> Result<Drawn>,
}

/// A drawn figure.
pub struct Drawn {
    /// The chart.
    pub svg: String,
    /// Its data as CSV (RFC 4180).
    pub csv: String,
    /// Summary of a few lines.
    pub summary: String,
    /// Markdown tables of the data, for some figures.
    pub tables: Option<String>,
    /// The data of a map of classes, for some figures.
    pub map: Option<Map>,
}

impl Drawn {
    /// A figure without tables and map.
    pub fn new(svg: String, csv: String, summary: String) -> Self {
        Self { svg, csv, summary, tables: None, map: None }
    }
}

/// One axis.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    /// Quantity with its unit.
    pub name: &'static str,
    /// Smallest and largest value.
    pub range: [f64; 2],
    /// Whether distances are ratios.
    pub logarithmic: bool,
}

impl Axis {
    /// Position of a value as a fraction of the axis.
    fn fraction(&self, value: f64) -> f64 {
        let [least, most] = self.range;
        if self.logarithmic { (value / least).ln() / (most / least).ln() } else { (value - least) / (most - least) }
    }

    /// Values of the grid lines with their labels.
    fn ticks(&self) -> Vec<(f64, String)> {
        let [least, most] = self.range;
        if self.logarithmic {
            return ticks((least, most)).into_iter().filter_map(|tick| Some((tick.value, tick.label?))).collect();
        }
        // About six round steps.
        let rough = (most - least) / 6.0;
        let power = 10.0f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power).into_iter().find(|step| *step >= rough).unwrap_or(10.0 * power);
        let first = (least / step).ceil() as i64;
        (first..).map(|n| n as f64 * step).take_while(|value| *value <= most * (1.0 + 1e-9)).map(|value| (value, trimmed(value))).collect()
    }
}

fn trimmed(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// A line, markers, or both. A curve without a name continues the previous one and shares its colour and legend entry.
#[derive(Clone, Debug)]
pub struct Curve {
    /// Name in the legend, or none.
    pub name: String,
    /// Values along both axes.
    pub points: Vec<[f64; 2]>,
    /// Whether each point has a marker.
    pub marked: bool,
    /// Whether a line joins the points.
    pub joined: bool,
}

/// Texts around a chart.
#[derive(Clone, Copy, Debug)]
pub struct Words<'a> {
    /// Title.
    pub title: &'a str,
    /// Line below it.
    pub subtitle: &'a str,
    /// Line at the bottom: machine and versions.
    pub caption: &'a str,
}

fn headed(root: &Area, words: Words, height_px: u32) -> Result<()> {
    root.fill(&WHITE)?;
    write(root, words.title, (24, 32), 28, INK, HPos::Left)?;
    write(root, words.subtitle, (24, 60), 17, FAINT_INK, HPos::Left)?;
    write(root, words.caption, (24, height_px as i32 - 18), 15, FAINT_INK, HPos::Left)
}

/// A rectangle of pixels with axes around it.
struct PlotArea {
    left: i32,
    top: i32,
    width: i32,
    height: i32,
}

impl PlotArea {
    fn place(&self, axes: [&Axis; 2], at: [f64; 2]) -> (i32, i32) {
        let x = f64::from(self.left) + axes[0].fraction(at[0]) * f64::from(self.width);
        let y = f64::from(self.top + self.height) - axes[1].fraction(at[1]) * f64::from(self.height);
        (x.round() as i32, y.round() as i32)
    }

    fn draw_axes(&self, root: &Area, axes: [&Axis; 2], named: [bool; 2]) -> Result<()> {
        let (right, bottom) = (self.left + self.width, self.top + self.height);
        for (value, label) in axes[0].ticks() {
            let x = self.place(axes, [value, axes[1].range[0]]).0;
            root.draw(&PathElement::new([(x, self.top), (x, bottom)], GRID))?;
            write(root, &label, (x, bottom + 16), 17, INK, HPos::Center)?;
        }
        for (value, label) in axes[1].ticks() {
            let y = self.place(axes, [axes[0].range[0], value]).1;
            root.draw(&PathElement::new([(self.left, y), (right, y)], GRID))?;
            if named[1] {
                write(root, &label, (self.left - 8, y), 17, INK, HPos::Right)?;
            }
        }
        root.draw(&Rectangle::new([(self.left, self.top), (right, bottom)], FAINT_INK))?;
        if named[0] {
            write(root, axes[0].name, ((self.left + right) / 2, bottom + 44), 18, INK, HPos::Center)?;
        }
        if named[1] {
            let upwards = text_style(18, INK, HPos::Center).transform(FontTransform::Rotate270);
            root.draw(&Text::new(axes[1].name.to_owned(), (self.left - 64, (self.top + bottom) / 2), upwards))?;
        }
        Ok(())
    }
}

/// Draws curves with a legend.
pub fn curves_svg(curves: &[Curve], axes: [Axis; 2], words: Words) -> Result<String> {
    ensure!(curves.iter().any(|curve| !curve.points.is_empty()), "no point to draw");
    const HEIGHT_PX: u32 = 640;
    let longest = curves.iter().map(|curve| curve.name.chars().count()).fold(20, usize::max);
    let mut text = String::new();
    let root = SVGBackend::with_string(&mut text, (840 + 8 * longest as u32, HEIGHT_PX)).into_drawing_area();
    headed(&root, words, HEIGHT_PX)?;
    let (frame, [x, y]) = (PlotArea { left: 100, top: 84, width: 640, height: 450 }, &axes);
    frame.draw_axes(&root, [x, y], [true; 2])?;
    let mut keys = 0;
    for curve in curves {
        keys += usize::from(!curve.name.is_empty());
        let n = keys.saturating_sub(1);
        let (colour, corners) = look(n);
        let marker = Marker { corners, colour, hollow: false };
        let points: Vec<_> = curve.points.iter().map(|at| frame.place([x, y], *at)).collect();
        let key = (800, 100 + 26 * n as i32);
        if curve.joined {
            root.draw(&PathElement::new(points.clone(), colour.stroke_width(2)))?;
            root.draw(&PathElement::new([(key.0 - 18, key.1), (key.0 + 18, key.1)], colour.stroke_width(2)))?;
        }
        write(&root, &curve.name, (key.0 + 30, key.1), 17, INK, HPos::Left)?;
        if curve.marked {
            points.into_iter().chain([key]).try_for_each(|at| marker.draw(&root, at))?;
        }
    }
    root.present()?;
    drop(root);
    Ok(text)
}

/// A coloured field: columns from left to right, in each the classes from bottom to top; and lines over it, in the units of the axes.
#[derive(Clone, Debug, Default)]
pub struct Panel {
    /// Title of the panel.
    pub name: String,
    /// Class of each row, column by column.
    pub columns: Vec<Vec<usize>>,
    /// Lines over the classes.
    pub outlines: Vec<Vec<[f64; 2]>>,
}

/// Panels over the same axes; each class has a name and a colour.
#[derive(Clone, Debug)]
pub struct Map {
    /// The panels, from left to right.
    pub panels: Vec<Panel>,
    /// Names and colours of the classes.
    pub classes: &'static [(&'static str, RGBColor)],
    /// Axes of all panels, across and up.
    pub axes: [Axis; 2],
}

/// Draws the panels of a map side by side.
///
/// # Errors
/// When the drawing fails, which it does not in memory.
pub fn map_svg(Map { panels, classes, axes }: &Map, words: Words) -> Result<String> {
    const HEIGHT_PX: u32 = 560;
    const WIDE_PX: i32 = 330;
    let mut text = String::new();
    let root =
        SVGBackend::with_string(&mut text, ((130 + (WIDE_PX as u32 + 30) * panels.len() as u32).max(680), HEIGHT_PX)).into_drawing_area();
    headed(&root, words, HEIGHT_PX)?;
    for (n, panel) in panels.iter().enumerate() {
        let frame = PlotArea { left: 100 + n as i32 * (WIDE_PX + 30), top: 120, width: WIDE_PX, height: 330 };
        frame.draw_axes(&root, [&axes[0], &axes[1]], [true, n == 0])?;
        write(&root, &panel.name, (frame.left, frame.top - 16), 19, INK, HPos::Left)?;
        draw_columns(&root, &frame, &panel.columns, classes)?;
        for outline in &panel.outlines {
            let points: Vec<_> = outline.iter().map(|at| frame.place([&axes[0], &axes[1]], *at)).collect();
            root.draw(&PathElement::new(points, INK.stroke_width(2)))?;
        }
    }
    let mut x = 100;
    for (name, colour) in *classes {
        let y = HEIGHT_PX as i32 - 44;
        root.draw(&Rectangle::new([(x, y - 8), (x + 16, y + 8)], colour.filled()))?;
        write(&root, name, (x + 24, y), 17, INK, HPos::Left)?;
        x += 48 + 8 * name.chars().count() as i32;
    }
    root.present()?;
    drop(root);
    Ok(text)
}

/// A run of one class in a column: its first place, its length and the class.
type Run = (usize, usize, usize);

fn runs(column: &[usize]) -> Vec<Run> {
    let starts = column.chunk_by(|a, b| a == b).scan(0, |next, run| {
        let start = std::mem::replace(next, *next + run.len());
        Some((start, run.len(), run[0]))
    });
    starts.collect()
}

/// Draws each run as a rectangle, as wide as the columns beside it have the same run.
fn draw_columns(root: &Area, frame: &PlotArea, columns: &[Vec<usize>], classes: &[(&str, RGBColor)]) -> Result<()> {
    let runs: Vec<_> = columns.iter().map(|column| runs(column)).collect();
    for (i, column) in columns.iter().enumerate() {
        let x = |n: usize| frame.left + (n as i32 * frame.width) / columns.len() as i32;
        let y = |n: usize| frame.top + frame.height - (n as i32 * frame.height) / column.len() as i32;
        for run in runs[i].iter().filter(|run| i == 0 || !runs[i - 1].contains(run)) {
            let (j, length, class) = *run;
            let width = runs[i..].iter().take_while(|runs| runs.contains(run)).count();
            root.draw(&Rectangle::new([(x(i), y(j + length)), (x(i + width), y(j))], classes[class].1.filled()))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_have_round_ticks_within_their_range() {
        let labels = |range, logarithmic| {
            let axis = Axis { name: "x", range, logarithmic };
            axis.ticks().into_iter().map(|(_, label)| label).collect::<Vec<_>>()
        };
        assert_eq!(labels([0.0, 60.0], false), ["0", "10", "20", "30", "40", "50", "60"]);
        assert_eq!(labels([0.0, 2.6], false), ["0", "0.5", "1", "1.5", "2", "2.5"]);
        assert_eq!(labels([0.4, 12.0], true), ["0.5", "1", "2", "5", "10"]);
    }

    #[test]
    fn equal_runs_of_columns_are_one_rectangle() {
        let axis = |name| Axis { name, range: [0.0, 10.0], logarithmic: false };
        let words = Words { title: "title", subtitle: "subtitle", caption: "caption" };
        const CLASSES: [(&str, RGBColor); 2] = [("a", RGBColor(1, 2, 3)), ("b", RGBColor(4, 5, 6))];
        let columns = vec![vec![0, 0, 1], vec![0, 0, 1], vec![0, 1, 1]];
        let panel = Panel { name: "made up".into(), columns, outlines: vec![] };
        let text = map_svg(&Map { panels: vec![panel], classes: &CLASSES, axes: [axis("across"), axis("up")] }, words).unwrap();
        let drawn = |colour: &str| text.lines().filter(|line| line.starts_with("<rect") && line.contains(colour)).count();
        // Two widths of each class, and its key.
        assert_eq!([drawn("#010203"), drawn("#040506")], [3, 3], "{text}");
        assert!(text.contains("<rect x=\"100\" y=\"230\" width=\"220\" height=\"220\""), "{text}");
    }

    #[test]
    fn a_curve_and_its_name_are_drawn_where_its_values_are() {
        let axis = |name| Axis { name, range: [0.0, 10.0], logarithmic: false };
        let curve = Curve { name: "made up".into(), points: vec![[0.0, 0.0], [10.0, 10.0]], marked: false, joined: true };
        let words = Words { title: "title", subtitle: "subtitle", caption: "caption" };
        let text = curves_svg(&[curve], [axis("across"), axis("up")], words).unwrap();
        for word in ["made up", "title", "subtitle", "caption", "across", "up", "100,534 740,84"] {
            assert!(text.contains(word), "{word} is missing");
        }
        assert!(curves_svg(&[], [axis("x"), axis("y")], words).is_err());
    }
}
