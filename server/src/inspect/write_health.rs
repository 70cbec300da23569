//! Writes the numbers and the texts: metrics, decisions about the detail, and events.

use super::entities::Entity;
use super::error::InspectError;
use super::events::Events;
use super::log::Log;
use super::plots::PLOTS;
use super::sink::Frame;
use crate::snapshot::Snapshot;
use prairie_core::grass::StepRecord;
use rerun::{Scalars, SeriesLines, TextLog, TextLogLevel};
use std::sync::Arc;

/// Writer of metrics, decisions and events.
#[derive(Default)]
pub(super) struct HealthWriter {
    /// Number of decisions about the detail so far; `None` before the first frame.
    decisions: Option<u64>,
    events: Events,
}

impl HealthWriter {
    /// Writes the names and colours of the curves.
    pub(super) fn write_static(log: &Log) -> Result<(), InspectError> {
        let series = PLOTS.iter().flat_map(|plot| plot.curves.iter().map(|curve| (plot.entity(curve), curve)));
        series.into_iter().try_for_each(|(path, curve)| {
            let lines = SeriesLines::new().with_names([curve.label]).with_colors([curve.rgba]).with_widths([1.5]);
            log.keep_at(Entity::Metrics, &path, &lines)
        })
    }

    /// Writes the entities that are due.
    pub(super) fn write(&mut self, log: &mut Log, frame: &Frame, new_steps: &[Arc<StepRecord>]) -> Result<(), InspectError> {
        self.write_decisions(log, &frame.snapshot)?;
        for line in self.events.update(&frame.snapshot.objects, new_steps) {
            Self::write_text(log, Entity::Events, line)?;
        }
        if !log.takes(Entity::Metrics) {
            return Ok(());
        }
        let series = PLOTS.iter().flat_map(|plot| plot.curves.iter().map(move |curve| (plot, curve)));
        series
            .into_iter()
            .try_for_each(|(plot, curve)| log.write_at(&plot.entity(curve), &Scalars::single(plot.scale * curve.value(frame))))
    }

    /// The decisions since the last frame; those from before the recording are left out.
    fn write_decisions(&mut self, log: &Log, snapshot: &Snapshot) -> Result<(), InspectError> {
        let count = snapshot.diagnostics.decisions;
        let before = self.decisions.replace(count).unwrap_or(count);
        let new = count.saturating_sub(before).min(snapshot.decisions.len() as u64) as usize;
        for decision in &snapshot.decisions[snapshot.decisions.len() - new..] {
            Self::write_text(log, Entity::Decisions, format!("{}: {}", decision.reason, decision.detail))?;
        }
        Ok(())
    }

    fn write_text(log: &Log, entity: Entity, text: String) -> Result<(), InspectError> {
        if log.is_on(entity) { log.write(entity, &TextLog::new(text).with_level(TextLogLevel::INFO)) } else { Ok(()) }
    }
}
