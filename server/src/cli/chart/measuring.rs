//! Measuring of models, with a progress bar.

use super::super::print::print;
use super::folder::Folder;
use anyhow::Result;
use indicatif::{ProgressBar, ProgressStyle};
use prairie_charts::figure::Figure;
use prairie_charts::files::write_all;
use prairie_charts::page::Failed;
use prairie_charts::row::cells_text;
use prairie_charts::run::{Repeats, measure};
use prairie_charts::summary::summary;
use prairie_charts::{Model, Problem};

/// Measurements into a folder. Files are written after each problem and figure, so that an interrupted run keeps its results.
pub(super) struct Measuring<'a> {
    pub(super) folder: Folder,
    is_quick: bool,
    only: Option<&'a str>,
    bar: ProgressBar,
    failures: Vec<String>,
}

impl<'a> Measuring<'a> {
    pub(super) fn new(folder: Folder, is_quick: bool, only: Option<&'a str>) -> Self {
        let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed} {wide_msg}").expect("the template is well formed");
        Self { folder, is_quick, only, bar: ProgressBar::new(0).with_style(style), failures: Vec::new() }
    }

    /// Number of runs and figures so far.
    pub(super) fn count(&self) -> u64 {
        self.bar.position()
    }

    fn is_asked(&self, name: &str) -> bool {
        self.only.is_none_or(|word| name.to_lowercase().contains(&word.to_lowercase()))
    }

    /// Measures error against time of a model, and draws its figures.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub(super) fn measure(&mut self, model: &'static Model) -> Result<()> {
        let mut problems = (model.problems)(self.is_quick);
        for problem in problems.iter_mut().filter(|problem| !self.is_asked(problem.name)) {
            problem.runs.retain(|run| self.is_asked(&run.method));
        }
        problems.retain(|problem| !problem.runs.is_empty());
        let figures: Vec<&Figure> = model.figures.iter().filter(|figure| self.is_asked(figure.name)).collect();
        self.bar.inc_length(problems.iter().map(|problem| problem.runs.len()).sum::<usize>() as u64);
        self.solve(model.name, &problems)?;
        self.draw(model.name, figures)
    }

    fn solve(&mut self, model: &str, problems: &[Problem]) -> Result<()> {
        let repeats = if self.is_quick { Repeats::QUICK } else { Repeats::THOROUGH };
        let mut rows = Vec::new();
        for problem in problems {
            let mut failed: Vec<Failed> = Vec::new();
            for run in &problem.runs {
                let name = format!("{}, {}, {}", problem.name, run.method, cells_text(run.cells));
                self.bar.set_message(name.clone());
                match measure(model, problem.name, run, repeats) {
                    Ok(measured) => rows.extend(measured),
                    Err(error) => {
                        self.failures.push(format!("{name}: {error:#}"));
                        failed.push((run.method.clone(), run.cells, run.dt_secs));
                    }
                }
                self.bar.inc(1);
            }
            self.folder.page.set_problem(model, problem, &rows, &failed);
            write_all(model, problems, &rows, &self.folder.page.about, self.folder.path())?;
            self.folder.write_page()?;
        }
        if rows.is_empty() {
            return Ok(());
        }
        let text = summary(problems, &rows, "l2");
        self.bar.suspend(|| print(format_args!("{model}: the fastest method for an error\n\n{text}")))
    }

    /// Draws figures of a model.
    ///
    /// # Errors
    /// When a file cannot be written.
    pub(super) fn draw(&mut self, model: &str, figures: Vec<&'static Figure>) -> Result<()> {
        self.bar.inc_length(figures.len() as u64);
        for figure in figures {
            self.bar.set_message(figure.title);
            match (figure.draw)(self.is_quick, &self.folder.page.about) {
                Ok(drawn) => {
                    self.bar.suspend(|| print(format_args!("{model}: {}\n{}\n", figure.title, drawn.summary.trim_end())))?;
                    self.folder.page.set_figure(model, figure, &drawn);
                    for (ending, text) in [("svg", Some(&drawn.svg)), ("csv", Some(&drawn.csv)), ("md", drawn.tables.as_ref())] {
                        if let Some(text) = text {
                            self.folder.write(&format!("{model}-{}.{ending}", figure.name), text)?;
                        }
                    }
                }
                Err(error) => self.failures.push(format!("{}: {error:#}", figure.title)),
            }
            self.bar.inc(1);
            self.folder.write_page()?;
        }
        Ok(())
    }

    /// Ends the progress bar, and prints what failed and where the results are.
    ///
    /// # Errors
    /// When a file or stdout cannot be written.
    pub(super) fn finish(self) -> Result<()> {
        self.bar.finish_and_clear();
        self.folder.write_page()?;
        for failure in &self.failures {
            print(format_args!("failed: {failure}"))?;
        }
        let page = self.folder.path().join("charts.html");
        print(format_args!(
            "{}\nWall time is per simulated second or operation, as the charts say.\n{}",
            self.folder.page.about,
            page.display()
        ))
    }
}
