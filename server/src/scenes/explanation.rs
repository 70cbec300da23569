//! Explanation of a scene's settings: what is modelled, by which method, with which error, at which cost, and why.

use crate::detail::Demands;
use serde::Serialize;
use std::fmt;

/// Explanation of a scene's settings.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Explanation {
    /// Name of the scene.
    pub scene: String,
    /// Whether the scene demands a plan.
    pub is_planned: bool,
    /// What is modelled.
    pub rows: Vec<ExplanationRow>,
    /// What is left out, and why.
    pub left_out: Vec<String>,
    /// Settings that no plan chooses, and why.
    pub not_planned: Vec<String>,
    /// Demands that cannot be met, each with what gives way and what it would take.
    pub conflicts: Vec<String>,
    /// How errors and costs were found.
    pub sources: Vec<String>,
    /// What the run has to keep; `None` where the scene demands nothing that is planned.
    #[serde(skip)]
    pub demands: Option<Demands>,
}

/// A part of the scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ExplanationRow {
    /// What is modelled.
    pub part: String,
    /// The method.
    pub method: String,
    /// Expected error, or why none is known.
    pub error: String,
    /// Cost on the server (ms per tick), if it is known.
    pub server_ms_per_tick: Option<f64>,
    /// Settings that the scene file states.
    pub stated: Vec<String>,
    /// Settings that the plan has chosen.
    pub planned: Vec<String>,
}

/// A time in milliseconds, with three digits.
pub(crate) fn millis(ms: f64) -> String {
    let digits = (2 - ms.max(1e-6).log10().floor() as i32).clamp(0, 6) as usize;
    format!("{ms:.digits$}")
}

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = if self.is_planned { "planned" } else { "no tolerances and budgets of the server: nothing is planned" };
        writeln!(f, "{}: {what}", self.scene)?;
        for row in &self.rows {
            writeln!(f, "\n  {}", row.part)?;
            writeln!(f, "    method   {}", row.method)?;
            writeln!(f, "    error    {}", row.error)?;
            let cost =
                row.server_ms_per_tick.map_or_else(|| "not measured".to_owned(), |ms| format!("{} ms per tick on the server", millis(ms)));
            writeln!(f, "    cost     {cost}")?;
            for (what, fields) in [("stated", &row.stated), ("planned", &row.planned)] {
                if !fields.is_empty() {
                    writeln!(f, "    {what:8} {}", fields.join(", "))?;
                }
            }
        }
        for (what, lines) in
            [("left out", &self.left_out), ("not planned", &self.not_planned), ("gives way", &self.conflicts), ("sources", &self.sources)]
        {
            if !lines.is_empty() {
                writeln!(f, "\n  {what}")?;
                lines.iter().try_for_each(|line| writeln!(f, "    - {line}"))?;
            }
        }
        Ok(())
    }
}
