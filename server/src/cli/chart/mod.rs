//! `prairie chart` and `prairie stability`: methods measured on problems with known solutions.

mod folder;
mod measuring;

use super::print::print;
use anyhow::{Result, ensure};
use clap::{Args, ValueHint};
use folder::Folder;
use measuring::Measuring;
use prairie::charts::models;
use prairie_charts::Model;
use prairie_charts::tables::{all_limits, limits_table};
use std::path::PathBuf;

pub(super) const CHART_EXAMPLES: &str = "\
Examples:
  prairie chart --quick                      all models in less than two minutes, for a look
  prairie chart wind                         the wind, in a quarter of an hour
  prairie chart wind --only cavity           problems, figures and methods with this word in their name
  prairie chart bend scene --out results     two models, into another folder

Models:
  wind         advection, diffusion and pressure of the wind on flows with exact solutions
  bend         schemes of the bend field, cost of cars and of the interactions
  blades       integrators of a blade in a recorded gust
  underbrush   sections and posture tables of underbrush, cost of drawing it and trees
  force-field  remainder of impulses on a mesh of volumes
  stream       bits of the grass on the wire against its error
  picture      render options: frame time against visible error; needs a Vulkan driver
  shells       cost of shell layers and of lamps on them; needs a Vulkan driver
  scene        a whole scene: error of its grass after a drive against the time of its steps

Files in DIR, updated after each problem and figure:
  charts.html               all charts, to look at in a browser: hover, filters, CSV and SVG
  charts.json               their data; models that are measured later are added to it
  MODEL.csv, MODEL.json     every run: problem, method, cells, time step, norm, error, wall time
  MODEL-PROBLEM.svg         error across, time up, both logarithmic; a line for each method
  MODEL-FIGURE.svg, .csv    figures of other kinds

Each run is repeated and its shortest time kept. Times mean something on an idle machine only.";

pub(super) const STABILITY_EXAMPLES: &str = "\
Examples:
  prairie stability --quick                  a look, in seconds
  prairie stability                          maps of wind, bend and blades, and all limits
  prairie stability bend --out results

Files in DIR, beside those of `prairie chart`:
  charts.html, charts.json  with maps of where each method fails, and limits beside theory
  MODEL-FIGURE.svg, .csv    the maps
  limits.md                 limits by bisection beside theory";

/// Arguments of `prairie chart`.
#[derive(Debug, Args)]
pub(super) struct Chart {
    /// What to measure [default: all]
    #[arg(value_name = "MODEL", value_parser = model)]
    models: Vec<ModelName>,
    #[command(flatten)]
    options: Options,
    /// Only problems, figures and methods with this word in their name
    #[arg(long, value_name = "WORD")]
    only: Option<String>,
}

/// Arguments of `prairie stability`.
#[derive(Debug, Args)]
pub(super) struct Stability {
    /// What to measure: wind, bend, blades [default: all]
    #[arg(value_name = "MODEL", value_parser = failing_model)]
    models: Vec<ModelName>,
    #[command(flatten)]
    options: Options,
}

#[derive(Debug, Args)]
struct Options {
    /// Folder of the results, made if needed
    #[arg(long, value_name = "DIR", default_value = "charts", value_hint = ValueHint::DirPath)]
    out: PathBuf,
    /// Coarse grids and few repetitions
    #[arg(long)]
    quick: bool,
}

#[derive(Clone, Copy)]
struct ModelName(&'static Model);

impl std::fmt::Debug for ModelName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.0.name)
    }
}

fn model(name: &str) -> Result<ModelName, String> {
    named(name, |_| true)
}

/// A model whose methods are known to fail somewhere.
fn failing_model(name: &str) -> Result<ModelName, String> {
    named(name, can_fail)
}

fn can_fail(model: &Model) -> bool {
    !model.failures.is_empty()
}

fn named(name: &str, is_allowed: fn(&Model) -> bool) -> Result<ModelName, String> {
    let allowed = || models().filter(|model| is_allowed(model));
    let found = allowed().find(|model| model.name == name).map(ModelName);
    found.ok_or_else(|| format!("allowed: {}", allowed().map(|model| model.name).collect::<Vec<_>>().join(", ")))
}

impl Chart {
    pub(super) fn run(&self) -> Result<()> {
        let Options { out, quick } = &self.options;
        let mut measuring = Measuring::new(Folder::open(out, *quick, "prairie chart")?, *quick, self.only.as_deref());
        for model in models().filter(|model| self.models.is_empty() || self.models.iter().any(|ModelName(asked)| asked.name == model.name))
        {
            measuring.measure(model)?;
        }
        ensure!(
            measuring.count() > 0,
            "--only {}: no problem, figure or method has this in its name",
            self.only.as_deref().unwrap_or_default()
        );
        measuring.finish()
    }
}

impl Stability {
    pub(super) fn run(&self) -> Result<()> {
        let Options { out, quick } = &self.options;
        let is_asked = |name: &str| self.models.is_empty() || self.models.iter().any(|ModelName(model)| model.name == name);
        let mut measuring = Measuring::new(Folder::open(out, *quick, "prairie stability")?, *quick, None);
        for model in models().filter(|model| can_fail(model) && is_asked(model.name)) {
            measuring.draw(model.name, model.failures.iter().collect())?;
        }
        if is_asked("wind") {
            let limits = all_limits();
            print(limits_table(&limits))?;
            measuring.folder.page.set_limits("wind", &limits);
            measuring.folder.write("limits.md", &limits_table(&limits))?;
        }
        measuring.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_help_names_every_model() {
        for model in models() {
            assert!(CHART_EXAMPLES.lines().any(|line| *line == format!("  {:<11}  {}", model.name, model.about)), "{}", model.name);
        }
    }
}
