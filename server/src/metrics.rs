//! Metrics: one table of all numbers that the server reports about itself.
//!
//! `/healthz`, `/metrics`, the plots in rerun and the table in `server/README.md` all follow from [`METRICS`].

mod exposition;
mod stats;
mod unit;

pub use exposition::{Format, exposition};
pub use stats::{JournalStats, RecordingStats, ServerStats};
pub use unit::Unit;

use crate::histogram::Histogram;
use crate::snapshot::Snapshot;
use serde::Serialize;

/// First part of every name in `/metrics`.
const PREFIX: &str = "prairie";

/// One metric.
#[derive(Clone, Copy, Debug)]
pub struct Metric {
    /// Key in `/healthz`, and last part of the entity in rerun.
    pub name: &'static str,
    /// Type in `/metrics`.
    pub kind: Kind,
    /// Unit.
    pub unit: Unit,
    /// Meaning, one line of Markdown, and the help text in `/metrics`.
    pub meaning: &'static str,
    /// Source of the value.
    pub source: Source,
}

/// Type of a metric, as Prometheus knows them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A sum that only grows, and starts from 0 with the world.
    Counter,
    /// A value that may rise and fall.
    Gauge,
    /// Counts of observed values by size.
    Histogram,
}

impl Kind {
    /// The type as a word.
    pub fn label(self) -> &'static str {
        match self {
            Self::Counter => "counter",
            Self::Gauge => "gauge",
            Self::Histogram => "histogram",
        }
    }
}

use Kind::{Counter, Gauge};

/// Source of a metric's value.
#[derive(Clone, Copy, Debug)]
pub enum Source {
    /// The world after a step: in `/healthz`, `/metrics` and recordings.
    World(fn(&Snapshot) -> Value),
    /// The number of connected clients: in `/healthz`, `/metrics` and recordings.
    Clients(fn(u32) -> Value),
    /// The server: in `/healthz` and `/metrics`.
    Server(fn(&ServerStats) -> Value),
    /// A distribution: in `/metrics` only.
    Distribution(fn(&ServerStats) -> &Histogram),
    /// The recording: in recordings only.
    Recording(fn(&RecordingStats) -> Value),
}

/// Value of a metric.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value {
    /// A count.
    Count(u64),
    /// A measured quantity, in the unit of its metric.
    Real(f64),
}

impl From<u64> for Value {
    fn from(count: u64) -> Self {
        Self::Count(count)
    }
}

impl From<u32> for Value {
    fn from(count: u32) -> Self {
        Self::Count(count.into())
    }
}

impl From<usize> for Value {
    fn from(count: usize) -> Self {
        Self::Count(count as u64)
    }
}

impl From<f64> for Value {
    fn from(real: f64) -> Self {
        Self::Real(real)
    }
}

impl From<f32> for Value {
    fn from(real: f32) -> Self {
        Self::Real(real.into())
    }
}

impl Value {
    /// The value as a number to plot.
    pub fn as_f64(self) -> f64 {
        match self {
            Self::Count(count) => count as f64,
            Self::Real(real) => real,
        }
    }
}

const fn world(name: &'static str, kind: Kind, unit: Unit, meaning: &'static str, read: fn(&Snapshot) -> Value) -> Metric {
    Metric { name, kind, unit, meaning, source: Source::World(read) }
}

const fn server(name: &'static str, kind: Kind, unit: Unit, meaning: &'static str, read: fn(&ServerStats) -> Value) -> Metric {
    Metric { name, kind, unit, meaning, source: Source::Server(read) }
}

const fn recording(name: &'static str, kind: Kind, unit: Unit, meaning: &'static str, read: fn(&RecordingStats) -> Value) -> Metric {
    Metric { name, kind, unit, meaning, source: Source::Recording(read) }
}

const fn distribution(name: &'static str, unit: Unit, meaning: &'static str, read: fn(&ServerStats) -> &Histogram) -> Metric {
    Metric { name, kind: Kind::Histogram, unit, meaning, source: Source::Distribution(read) }
}

/// Every metric.
pub const METRICS: &[Metric] = &[
    world("tick", Counter, Unit::Count, "steps since the start", |s| s.tick.into()),
    world("time_secs", Counter, Unit::Seconds, "simulated time", |s| s.time_secs.into()),
    world("step_secs", Gauge, Unit::Seconds, "mean duration of a step since the last publication", |s| s.diagnostics.step_secs.into()),
    world("step_max_secs", Gauge, Unit::Seconds, "longest of these steps", |s| s.diagnostics.step_max_secs.into()),
    world("objects", Gauge, Unit::Count, "vehicles and balls", |s| s.objects.len().into()),
    world(
        "divergence_rms",
        Gauge,
        Unit::Ratio,
        "RMS divergence of the wind, relative to the RMS speed over the smallest cell spacing",
        |s| s.diagnostics.divergence_rms.into(),
    ),
    world("wind_energy", Gauge, Unit::JoulesPerKilogram, "mean kinetic energy of the wind", |s| s.diagnostics.wind_energy.into()),
    world("wind_resets", Counter, Unit::Count, "restarts of the wind from its mean after a failed step", |s| {
        s.diagnostics.wind_resets.into()
    }),
    world("bend_activity", Gauge, Unit::Count, "sum of θ² + ω² over the bend field (mixed units)", |s| {
        s.diagnostics.bend_activity.into()
    }),
    world("awake_patches", Gauge, Unit::Count, "patches whose grass is simulated", |s| s.diagnostics.awake_patches.into()),
    world("evicted_patches", Counter, Unit::Count, "patches put to sleep because too many were awake", |s| {
        s.diagnostics.evicted_patches.into()
    }),
    world("reset_patches", Counter, Unit::Count, "patches reset because their grass was unstable, NaN or infinite", |s| {
        s.diagnostics.reset_patches.into()
    }),
    world("substeps", Gauge, Unit::Count, "sub-steps of the bend field in the newest step", |s| s.diagnostics.substeps.into()),
    world("courant", Gauge, Unit::Ratio, "largest Courant number of a sub-step of the bend field, as a fraction of its limit", |s| {
        s.diagnostics.courant.into()
    }),
    world("wind_step_secs", Gauge, Unit::Seconds, "step of the wind's solver", |s| s.diagnostics.wind_step_secs.into()),
    world(
        "wind_step_error_m_per_s",
        Gauge,
        Unit::MetresPerSecond,
        "estimated error of the wind at the ground that its step adds in two seconds; 0 in a scene without `[accuracy]` and `[budget]`",
        |s| s.diagnostics.wind_step_error_m_per_s.into(),
    ),
    world("wind_doubled_error_m_per_s", Gauge, Unit::MetresPerSecond, "the same of steps twice as long", |s| {
        s.diagnostics.wind_doubled_error_m_per_s.into()
    }),
    world("wind_step_samples", Counter, Unit::Count, "estimates of the error of the wind's step", |s| {
        s.diagnostics.wind_step_samples.into()
    }),
    world("wind_doubled_samples", Counter, Unit::Count, "estimates of the error of steps twice as long", |s| {
        s.diagnostics.wind_doubled_samples.into()
    }),
    world(
        "bend_step_error_deg",
        Gauge,
        Unit::Degrees,
        "estimated error of the bending angle that the step adds while waves decay; 0 in a scene without `[accuracy]` and `[budget]`",
        |s| s.diagnostics.bend_step_error_deg.into(),
    ),
    world("awake_limit", Gauge, Unit::Count, "most awake patches at present", |s| s.diagnostics.awake_limit.into()),
    world("load_level", Gauge, Unit::Count, "how much gives way to the load at present, from 0 (nothing) to 5", |s| {
        s.diagnostics.load_level.into()
    }),
    world("decisions", Counter, Unit::Count, "decisions about the detail of the simulation", |s| s.diagnostics.decisions.into()),
    world("laid_tiles", Gauge, Unit::Count, "tiles of 8 × 8 cells with flattened grass or pressed snow", |s| {
        s.diagnostics.laid_tiles.into()
    }),
    world(
        "dropped_tracks",
        Counter,
        Unit::Count,
        "patches whose flattened grass or snow tracks were discarded because there was too much",
        |s| s.diagnostics.dropped_tracks.into(),
    ),
    world("rejected_motions", Counter, Unit::Count, "object motions rejected as invalid (NaN, infinite or out of range)", |s| {
        s.diagnostics.rejected_motions.into()
    }),
    world("broken_plants", Gauge, Unit::Count, "plants of the underbrush that are broken", |s| s.broken.len().into()),
    Metric {
        name: "connected_clients",
        kind: Gauge,
        unit: Unit::Count,
        meaning: "connected clients",
        source: Source::Clients(|clients| clients.into()),
    },
    server("uptime_secs", Gauge, Unit::Seconds, "time since the start of the server", |s| s.uptime_secs.into()),
    server("dropped_secs", Counter, Unit::Seconds, "simulated time skipped because the machine was too slow", |s| s.dropped_secs.into()),
    server("sent_bytes", Counter, Unit::Bytes, "bytes sent to all clients", |s| s.sent_bytes.into()),
    server("encodings", Counter, Unit::Count, "grids encoded, each once for all clients", |s| s.encodings.into()),
    server("cached_patches", Gauge, Unit::Count, "patches whose encoded frames are cached", |s| s.cached_patches.into()),
    server("held_patches", Gauge, Unit::Count, "patches that clients hold, summed over the clients", |s| s.held_patches.into()),
    server("frames", Counter, Unit::Count, "frames handed to sessions", |s| s.frames.into()),
    server("replicas", Gauge, Unit::Count, "clients that simulate the grass themselves", |s| s.replicas.into()),
    server(
        "replica_differences",
        Counter,
        Unit::Count,
        "replicas that differed from the grass of the server, and got its state again",
        |s| s.differences.into(),
    ),
    server("skipped_frames", Counter, Unit::Count, "frames skipped because the client had too many unacknowledged", |s| {
        s.skipped_frames.into()
    }),
    server("rejected_connections", Counter, Unit::Count, "connections rejected because of too many from the same address", |s| {
        s.rejected_connections.into()
    }),
    server("rate_limited_connections", Counter, Unit::Count, "connections closed because they sent too much", |s| {
        s.rate_limited_connections.into()
    }),
    server("journal_bytes", Counter, Unit::Bytes, "bytes of records written to the journal", |s| s.journal.bytes.into()),
    server("journal_checkpoints", Counter, Unit::Count, "checkpoints written", |s| s.journal.checkpoints.into()),
    server("journal_failures", Counter, Unit::Count, "failed writes of the journal and of checkpoints", |s| s.journal.failures.into()),
    server("journal_lost_steps", Counter, Unit::Count, "steps missing in the journal because of a full queue or a failed write", |s| {
        s.journal.lost_steps.into()
    }),
    server("journal_copy_max_secs", Gauge, Unit::Seconds, "longest copy of the state for a checkpoint, for which a step waits", |s| {
        s.journal.copy_max_secs.into()
    }),
    distribution("step_duration_secs", Unit::Seconds, "duration of a step", |s| &s.step_secs),
    distribution("frame_bytes", Unit::Bytes, "bytes of a frame handed to a session", |s| &s.frame_bytes),
    recording("sent_bytes_per_s", Gauge, Unit::BytesPerSecond, "rate of the bytes sent to all clients", |s| s.sent_bytes_per_s.into()),
    recording("dropped_log_frames", Counter, Unit::Count, "frames of the recording dropped because the viewer was slow", |s| {
        s.dropped_log_frames.into()
    }),
];

impl Metric {
    /// Name in `/metrics`, with its prefix, unit and suffix: `prairie_dropped_seconds_total`.
    pub fn prometheus_name(&self) -> String {
        let unit = self.unit.prometheus().map_or_else(String::new, |unit| format!("_{unit}"));
        let suffix = if self.kind == Counter { "_total" } else { "" };
        format!("{PREFIX}_{}{unit}{suffix}", self.prometheus_stem())
    }

    /// The name without the short form of its unit, which `/metrics` spells out.
    fn prometheus_stem(&self) -> &'static str {
        self.name.strip_suffix(self.unit.name_suffix()).unwrap_or(self.name)
    }

    /// Whether recordings contain the metric.
    pub fn is_recorded(&self) -> bool {
        matches!(self.source, Source::World(_) | Source::Clients(_) | Source::Recording(_))
    }

    /// Whether `/metrics` contains the metric.
    pub fn is_scraped(&self) -> bool {
        !matches!(self.source, Source::Recording(_))
    }

    /// The value; `None` for a distribution and for metrics of recordings.
    fn value(&self, snapshot: &Snapshot, stats: &ServerStats) -> Option<Value> {
        match self.source {
            Source::World(read) => Some(read(snapshot)),
            Source::Clients(read) => Some(read(stats.clients)),
            Source::Server(read) => Some(read(stats)),
            Source::Distribution(_) | Source::Recording(_) => None,
        }
    }

    /// The distribution; `None` for all other metrics.
    fn distribution<'s>(&self, stats: &'s ServerStats) -> Option<&'s Histogram> {
        match self.source {
            Source::Distribution(read) => Some(read(stats)),
            _ => None,
        }
    }
}

/// The metric called `name`.
pub fn find(name: &str) -> Option<&'static Metric> {
    METRICS.iter().find(|metric| metric.name == name)
}

/// Names and values of the metrics in `/healthz`.
pub fn report(snapshot: &Snapshot, stats: &ServerStats) -> impl Iterator<Item = (&'static str, Value)> {
    METRICS.iter().filter_map(|metric| Some((metric.name, metric.value(snapshot, stats)?)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::snapshot::Diagnostics;

    #[test]
    fn metric_names_are_unique() {
        for metric in METRICS {
            assert_eq!(METRICS.iter().filter(|other| other.name == metric.name).count(), 1, "{}", metric.name);
        }
    }

    #[test]
    fn every_diagnostic_of_the_world_is_a_metric() {
        let debug = format!("{:?}", Diagnostics::default());
        let (_, fields) = debug.trim_end_matches(" }").split_once("{ ").expect("a struct with named fields");
        for field in fields.split(", ") {
            let (name, _) = field.split_once(": ").expect("`name: value`");
            let metric = find(name).unwrap_or_else(|| panic!("`{name}` of the snapshot is missing in METRICS"));
            assert!(matches!(metric.source, Source::World(_)), "{name}");
        }
    }

    #[test]
    fn prometheus_names_spell_out_the_unit_once() {
        for (name, prometheus) in [
            ("tick", "prairie_tick_total"),
            ("step_secs", "prairie_step_seconds"),
            ("dropped_secs", "prairie_dropped_seconds_total"),
            ("sent_bytes", "prairie_sent_bytes_total"),
            ("courant", "prairie_courant_ratio"),
            ("wind_energy", "prairie_wind_energy_joules_per_kilogram"),
            ("step_duration_secs", "prairie_step_duration_seconds"),
        ] {
            assert_eq!(find(name).unwrap().prometheus_name(), prometheus);
        }
    }

    #[test]
    fn names_end_in_their_unit() {
        for metric in METRICS {
            assert!(metric.name.ends_with(metric.unit.name_suffix()), "{}: {:?}", metric.name, metric.unit);
        }
    }

    #[test]
    fn the_readme_lists_every_metric() {
        let place = |source| match source {
            Source::World(_) | Source::Clients(_) => "`/healthz`, `/metrics`, rerun",
            Source::Server(_) => "`/healthz`, `/metrics`",
            Source::Distribution(_) => "`/metrics`",
            Source::Recording(_) => "rerun",
        };
        let row = |metric: &Metric| {
            let prometheus = if metric.is_scraped() { format!("`{}`", metric.prometheus_name()) } else { String::new() };
            let Metric { name, unit, meaning, source, .. } = metric;
            format!("| `{name}` | {} | {} | {meaning} | {prometheus} | {} |\n", metric.kind.label(), unit.symbol(), place(*source))
        };
        let rows: String = METRICS.iter().map(row).collect();
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/README.md");
        let readme = std::fs::read_to_string(path).unwrap();
        let (before, table) =
            readme.split_once("| name in `/metrics` | shown in |\n|---|---|---|---|---|---|\n").expect("the table's head");
        let (old, after) = table.split_at(table.find("\n\n").expect("the table's end") + 1);
        if std::env::var_os("PRAIRIE_UPDATE").is_some() {
            let head = &readme[before.len()..readme.len() - table.len()];
            std::fs::write(path, format!("{before}{head}{rows}{after}")).unwrap();
        } else {
            assert!(old == rows, "the table of metrics in server/README.md is old; run again with PRAIRIE_UPDATE=1. Its rows:\n{rows}");
        }
    }
}
