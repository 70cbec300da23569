//! Metrics: one table of every scalar that the server reports about itself.
//!
//! `/healthz`, the plots in rerun and the table in `server/README.md` all follow from [`METRICS`].

use crate::snapshot::Snapshot;
use serde::Serialize;

/// One scalar.
#[derive(Clone, Copy, Debug)]
pub struct Metric {
    /// Key in `/healthz`, and last part of the entity in rerun.
    pub name: &'static str,
    /// Unit; empty for a count or a ratio.
    pub unit: &'static str,
    /// Meaning, one line of Markdown.
    pub meaning: &'static str,
    /// Source of the value.
    pub source: Source,
}

/// Source of a metric's value.
#[derive(Clone, Copy, Debug)]
pub enum Source {
    /// The world after a step: in `/healthz` and in recordings.
    World(fn(&Snapshot) -> Value),
    /// The server: in `/healthz` only.
    Server(fn(&ServerStats) -> Value),
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

/// State of the server, for `/healthz`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ServerStats {
    /// Time since the start (s).
    pub uptime_secs: f64,
    /// Simulated time that was skipped because the machine was too slow (s).
    pub dropped_secs: f64,
    /// Bytes sent to all clients.
    pub sent_bytes: u64,
    /// Grids encoded.
    pub encodings: u64,
    /// Patches whose encoded frames are cached.
    pub cached_patches: u64,
    /// Patches that clients hold, summed over the clients.
    pub held_patches: u64,
    /// Frames handed to sessions.
    pub frames: u64,
    /// Frames skipped because the client had too many unacknowledged.
    pub skipped_frames: u64,
}

/// State of a recording and of the connections while it runs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RecordingStats {
    /// Connected clients.
    pub clients: u32,
    /// Rate of the bytes sent to all clients together (bytes/s).
    pub sent_bytes_per_s: f64,
    /// Frames of the recording dropped because the logger was behind.
    pub dropped_log_frames: u64,
}

const fn world(name: &'static str, unit: &'static str, meaning: &'static str, read: fn(&Snapshot) -> Value) -> Metric {
    Metric { name, unit, meaning, source: Source::World(read) }
}

const fn server(name: &'static str, unit: &'static str, meaning: &'static str, read: fn(&ServerStats) -> Value) -> Metric {
    Metric { name, unit, meaning, source: Source::Server(read) }
}

const fn recording(name: &'static str, unit: &'static str, meaning: &'static str, read: fn(&RecordingStats) -> Value) -> Metric {
    Metric { name, unit, meaning, source: Source::Recording(read) }
}

/// Every metric.
pub const METRICS: &[Metric] = &[
    world("tick", "", "steps since the start", |s| s.tick.into()),
    world("time_secs", "s", "simulated time", |s| s.time_secs.into()),
    world("step_secs", "s", "mean duration of a step since the last publication", |s| s.diagnostics.step_secs.into()),
    world("step_max_secs", "s", "longest of these steps", |s| s.diagnostics.step_max_secs.into()),
    world("objects", "", "vehicles and balls", |s| s.objects.len().into()),
    world("divergence_rms", "", "RMS divergence of the wind, relative to the RMS speed over the smallest cell spacing", |s| {
        s.diagnostics.divergence_rms.into()
    }),
    world("wind_energy", "J/kg", "mean kinetic energy of the wind", |s| s.diagnostics.wind_energy.into()),
    world("wind_resets", "", "restarts of the wind from its mean after a failed step", |s| s.diagnostics.wind_resets.into()),
    world("bend_activity", "", "sum of θ² + ω² over the bend field (mixed units)", |s| s.diagnostics.bend_activity.into()),
    world("awake_patches", "", "patches whose grass is simulated", |s| s.diagnostics.awake_patches.into()),
    world("evicted_patches", "", "patches put to sleep because too many were awake", |s| s.diagnostics.evicted_patches.into()),
    world("reset_patches", "", "patches reset because their grass was unstable, NaN or infinite", |s| s.diagnostics.reset_patches.into()),
    world("substeps", "", "sub-steps of the bend field in the newest step", |s| s.diagnostics.substeps.into()),
    world("courant", "", "largest Courant number of a sub-step of the bend field, as a fraction of its limit", |s| {
        s.diagnostics.courant.into()
    }),
    world("laid_tiles", "", "tiles of 8 × 8 cells with flattened grass", |s| s.diagnostics.laid_tiles.into()),
    world("dropped_tracks", "", "patches whose flattened grass was discarded because there was too much", |s| {
        s.diagnostics.dropped_tracks.into()
    }),
    world("rejected_motions", "", "object motions rejected as invalid (NaN, infinite or out of range)", |s| {
        s.diagnostics.rejected_motions.into()
    }),
    world("broken_plants", "", "plants of the underbrush that are broken", |s| s.broken.len().into()),
    server("uptime_secs", "s", "time since the start of the server", |s| s.uptime_secs.into()),
    server("dropped_secs", "s", "simulated time skipped because the machine was too slow", |s| s.dropped_secs.into()),
    server("sent_bytes", "bytes", "bytes sent to all clients", |s| s.sent_bytes.into()),
    server("encodings", "", "grids encoded, each once for all clients", |s| s.encodings.into()),
    server("cached_patches", "", "patches whose encoded frames are cached", |s| s.cached_patches.into()),
    server("held_patches", "", "patches that clients hold, summed over the clients", |s| s.held_patches.into()),
    server("frames", "", "frames handed to sessions", |s| s.frames.into()),
    server("skipped_frames", "", "frames skipped because the client had too many unacknowledged", |s| s.skipped_frames.into()),
    recording("connected_clients", "", "connected clients", |s| s.clients.into()),
    recording("sent_bytes_per_s", "bytes/s", "rate of the bytes sent to all clients", |s| s.sent_bytes_per_s.into()),
    recording("dropped_log_frames", "", "frames of the recording dropped because the viewer was slow", |s| s.dropped_log_frames.into()),
];

/// The metric called `name`.
pub fn find(name: &str) -> Option<&'static Metric> {
    METRICS.iter().find(|metric| metric.name == name)
}

/// Names and values of the metrics of the world and of the server.
pub fn report(snapshot: &Snapshot, stats: &ServerStats) -> impl Iterator<Item = (&'static str, Value)> {
    METRICS.iter().filter_map(|metric| match metric.source {
        Source::World(read) => Some((metric.name, read(snapshot))),
        Source::Server(read) => Some((metric.name, read(stats))),
        Source::Recording(_) => None,
    })
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
    fn the_readme_lists_every_metric() {
        let place = |source| match source {
            Source::World(_) => "`/healthz`, rerun",
            Source::Server(_) => "`/healthz`",
            Source::Recording(_) => "rerun",
        };
        let row = |metric: &Metric| format!("| `{}` | {} | {} | {} |\n", metric.name, metric.unit, metric.meaning, place(metric.source));
        let rows: String = METRICS.iter().map(row).collect();
        assert!(include_str!("../README.md").contains(&rows), "server/README.md must hold these rows:\n{rows}");
    }
}
