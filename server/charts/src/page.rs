//! All charts as data, and the page that shows them: one HTML file with everything in it.

use anyhow::{Context as _, Result};
use plotters::style::RGBColor;
use serde::{Deserialize, Serialize};

use super::figure::{Axis, Drawn, Figure, Map};
use super::inline::Sources;
use super::limits::Limit as StabilityLimit;
use super::machine::machine;
use super::memory_limit::{MEMORY_LIMIT, memory_limit};
use super::{Problem, Row};

/// Charts with their origin. Its JSON is the data of the page.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Page {
    /// Date of the measurement, as `2026-11-30`.
    pub date: String,
    /// Machine and versions.
    pub about: String,
    /// Whether grids were coarse and repetitions few.
    pub is_quick: bool,
    /// Command that measures again.
    pub command: String,
    charts: Vec<Chart>,
    maps: Vec<PageMap>,
    figures: Vec<PageFigure>,
    limits: Vec<Limit>,
}

/// Error against time of the methods on one problem.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Chart {
    field: String,
    problem: String,
    error: String,
    per: String,
    default: Option<String>,
    limit: Option<LimitLine>,
    rows: Vec<ChartRow>,
}

/// A line below which the machine cannot get.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct LimitLine {
    label: String,
    /// Error and time (s).
    points: Vec<[f64; 2]>,
}

/// A run; errors and time are `None` if it failed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct ChartRow {
    method: String,
    cells: [usize; 3],
    dt_secs: f64,
    l2: Option<f64>,
    max: Option<f64>,
    /// Unit of the wall time: 1, since that is given per simulated second or operation.
    simulated_secs: f64,
    wall_secs: Option<f64>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct PageMap {
    field: String,
    title: String,
    x: MapAxis,
    y: MapAxis,
    classes: Vec<Class>,
    panels: Vec<MapPanel>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct MapAxis {
    name: String,
    /// Middles of the columns or rows.
    values: Vec<f64>,
    logarithmic: bool,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Class {
    name: String,
    colour: String,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct MapPanel {
    name: String,
    /// Class of each row, column by column.
    cells: Vec<Vec<usize>>,
    /// Limit in theory.
    theory: Vec<[f64; 2]>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct PageFigure {
    field: String,
    name: String,
    title: String,
    svg: String,
    csv: String,
    summary: String,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Limit {
    field: String,
    scheme: String,
    number: String,
    theory: f64,
    measured: f64,
}

/// A run that failed: method, cells and time step.
pub type Failed = (String, [usize; 3], f64);

impl Page {
    /// A page without charts, with the date of the measurement and the command that measures again.
    pub fn new(date: String, is_quick: bool, command: String) -> Self {
        Self { date, about: machine(), is_quick, command, ..Self::default() }
    }

    /// Reads a page's data.
    ///
    /// # Errors
    /// When the text is no such JSON.
    pub fn from_json(text: &str) -> Result<Self> {
        serde_json::from_str(text).context("no data of charts")
    }

    /// Its data.
    pub fn json(&self) -> String {
        serde_json::to_string(self).expect("texts and numbers only")
    }

    /// The page, complete in one file.
    pub fn html(&self) -> String {
        SOURCES.with_data(&self.json())
    }

    /// Whether both were measured with the same program on the same machine, in the same depth.
    pub fn has_origin_of(&self, other: &Self) -> bool {
        self.about == other.about && self.is_quick == other.is_quick
    }

    /// Takes over the rows of a problem, in place of older ones of the same methods.
    pub fn set_problem(&mut self, field: &str, problem: &Problem, rows: &[Row], failed: &[Failed]) {
        let mut chart = Chart {
            field: field.to_owned(),
            problem: problem.name.to_owned(),
            error: problem.error.to_owned(),
            per: problem.per.to_owned(),
            default: problem.default_method.map(str::to_owned),
            limit: Some(memory_limit(problem, rows))
                .filter(|points| !points.is_empty())
                .map(|points| LimitLine { label: MEMORY_LIMIT.to_owned(), points }),
            rows: chart_rows(rows, problem.name).chain(failed.iter().map(failed_row)).collect(),
        };
        match self.charts.iter_mut().find(|other| (&other.field, &other.problem) == (&chart.field, &chart.problem)) {
            None => self.charts.push(chart),
            Some(older) => {
                let is_measured = |row: &ChartRow| chart.rows.iter().any(|new| new.method == row.method);
                let kept: Vec<_> = older.rows.iter().filter(|row| !is_measured(row)).cloned().collect();
                chart.limit = chart.limit.or_else(|| older.limit.clone());
                chart.rows.splice(0..0, kept);
                *older = chart;
            }
        }
    }

    /// Takes over a figure, in place of an older one. A map is drawn by the page itself, other figures are shown as they are.
    pub fn set_figure(&mut self, field: &str, figure: &Figure, drawn: &Drawn) {
        if let Some(map) = &drawn.map {
            self.maps.retain(|other| (other.field.as_str(), other.title.as_str()) != (field, figure.title));
            self.maps.push(page_map(field, figure.title, map));
            return;
        }
        self.figures.retain(|other| (other.field.as_str(), other.name.as_str()) != (field, figure.name));
        let [name, title, svg, csv, summary] = [figure.name, figure.title, &drawn.svg, &drawn.csv, &drawn.summary].map(str::to_owned);
        self.figures.push(PageFigure { field: field.to_owned(), name, title, svg, csv, summary });
    }

    /// Takes over stability limits, in place of all older ones of the field.
    pub fn set_limits(&mut self, field: &str, limits: &[StabilityLimit]) {
        self.limits.retain(|other| other.field != field);
        self.limits.extend(limits.iter().map(|StabilityLimit { scheme, number, theory, measured }| Limit {
            field: field.to_owned(),
            scheme: scheme.clone(),
            number: (*number).to_owned(),
            theory: *theory,
            measured: *measured,
        }));
    }
}

const SOURCES: Sources = Sources {
    page: include_str!("../page/charts.html"),
    style: include_str!("../page/charts.css"),
    scripts: &[
        include_str!("../page/charts-data.js"),
        include_str!("../page/charts-draw.js"),
        include_str!("../page/charts-cards.js"),
        include_str!("../page/charts-precision.js"),
        include_str!("../page/charts-maps.js"),
        include_str!("../page/charts.js"),
    ],
};

/// A row of the page for each run: those of three norms are one.
fn chart_rows<'a>(rows: &'a [Row], problem: &'a str) -> impl Iterator<Item = ChartRow> + 'a {
    let of = |norm: &'static str| rows.iter().filter(move |row| row.problem == problem && row.norm == norm);
    of("l2").zip(of("linf")).map(|(row, largest)| ChartRow {
        method: row.method.clone(),
        cells: row.cells,
        dt_secs: row.dt_secs,
        l2: Some(row.error),
        max: Some(largest.error),
        simulated_secs: 1.0,
        wall_secs: Some(row.wall_secs),
    })
}

fn failed_row((method, cells, dt_secs): &Failed) -> ChartRow {
    ChartRow { method: method.clone(), cells: *cells, dt_secs: *dt_secs, l2: None, max: None, simulated_secs: 1.0, wall_secs: None }
}

fn page_map(field: &str, title: &str, Map { panels, classes, axes: [x, y] }: &Map) -> PageMap {
    let count = panels.first().map_or([0; 2], |panel| [panel.columns.len(), panel.columns.first().map_or(0, Vec::len)]);
    PageMap {
        field: field.to_owned(),
        title: title.to_owned(),
        x: map_axis(x, count[0]),
        y: map_axis(y, count[1]),
        classes: classes.iter().map(|(name, colour)| Class { name: (*name).to_owned(), colour: hex(*colour) }).collect(),
        panels: panels
            .iter()
            .map(|panel| MapPanel { name: panel.name.clone(), cells: panel.columns.clone(), theory: panel.outlines.concat() })
            .collect(),
    }
}

fn map_axis(axis: &Axis, count: usize) -> MapAxis {
    let [low, high] = axis.range;
    let middle = |n: usize| {
        let fraction = (n as f64 + 0.5) / count as f64;
        if axis.logarithmic { low * (high / low).powf(fraction) } else { low + (high - low) * fraction }
    };
    MapAxis { name: axis.name.to_owned(), values: (0..count).map(middle).collect(), logarithmic: axis.logarithmic }
}

fn hex(RGBColor(red, green, blue): RGBColor) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

#[cfg(test)]
mod tests {
    use super::super::row::made_up::row;
    use super::*;

    fn problem() -> Problem {
        Problem { name: "p", error: "error", per: "second", default_method: Some("a"), cell_bytes: 24, runs: Vec::new() }
    }

    fn page() -> Page {
        let rows = [row("p", "a", 8, 0.1, 1.0), Row { norm: "linf".into(), ..row("p", "a", 8, 0.3, 1.0) }];
        let mut page = Page { date: "2026-11-30".into(), about: "machine".into(), ..Page::default() };
        page.set_problem("wind", &problem(), &rows, &[("b </script>".into(), [8; 3], 0.1)]);
        page
    }

    #[test]
    fn runs_of_all_norms_are_one_row_and_failed_ones_have_no_error() {
        let page = page();
        let [found, failed] = &page.charts[0].rows[..] else { panic!("{:?}", page.charts) };
        assert_eq!((found.l2, found.max, found.wall_secs), (Some(0.1), Some(0.3), Some(1.0)));
        assert_eq!((failed.l2, failed.wall_secs), (None, None));
        let limit = page.charts[0].limit.as_ref().expect("a limit of the default method");
        assert!(limit.points[0][0] == 0.1 && limit.points[0][1] > 0.0 && limit.points[0][1] < 0.1, "{limit:?}");
    }

    #[test]
    fn methods_measured_again_take_the_place_of_the_first() {
        let mut page = page();
        let again = [row("p", "a", 8, 0.2, 1.0), Row { norm: "linf".into(), ..row("p", "a", 8, 0.4, 1.0) }];
        page.set_problem("wind", &problem(), &again, &[]);
        let rows: Vec<_> = page.charts[0].rows.iter().map(|row| (row.method.as_str(), row.l2)).collect();
        assert_eq!(rows, [("b </script>", None), ("a", Some(0.2))]);
        page.set_problem("bend", &problem(), &[], &[]);
        assert_eq!(page.charts.len(), 2);
    }

    #[test]
    fn the_page_holds_its_data_and_no_text_of_it_ends_the_script() {
        let page = page();
        let html = page.html();
        assert_eq!(html.matches("</script>").count(), SOURCES.page.matches("</script>").count(), "a method's name closes a script");
        assert!(["STYLE", "SCRIPT", "DATA"].iter().all(|mark| !html.contains(&format!(">/*{mark}*/"))) && html.contains("2026-11-30"));
        assert_eq!(Page::from_json(&page.json()).unwrap(), page);
    }
}
