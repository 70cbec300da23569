//! Plots of the recording, with the metrics and the unit of each.
//!
//! The entities, the layout of the viewer and the table in `server/README.md` follow from [`PLOTS`].

use super::sink::Frame;
use crate::metrics::{self, Source};

/// One plot over time.
pub(super) struct Plot {
    /// Folder of its entities, below `metrics/`.
    pub(super) folder: &'static str,
    /// Title with the unit of the axis.
    pub(super) title: &'static str,
    /// Factor from the metrics' own unit to that of the axis.
    pub(super) scale: f64,
    pub(super) curves: &'static [Curve],
}

/// One curve of a plot.
pub(super) struct Curve {
    /// Name of the metric.
    pub(super) metric: &'static str,
    /// Label in the legend.
    pub(super) label: &'static str,
    pub(super) rgba: u32,
}

const fn curve(metric: &'static str, label: &'static str, rgba: u32) -> Curve {
    Curve { metric, label, rgba }
}

const GREEN: u32 = 0x4CAF_50FF;
const ORANGE: u32 = 0xFF70_43FF;
const BLUE: u32 = 0x29B6_F6FF;
const YELLOW: u32 = 0xFFCA_28FF;
const BROWN: u32 = 0x8D6E_63FF;
const RED: u32 = 0xEF53_50FF;
const PURPLE: u32 = 0xAB47_BCFF;
const PINK: u32 = 0xEC40_7AFF;
const TEAL: u32 = 0x26A6_9AFF;
const GREY: u32 = 0xBDBD_BDFF;

/// Every plot, in the order of the layout.
pub(super) const PLOTS: &[Plot] = &[
    Plot {
        folder: "step",
        title: "Step duration (ms)",
        scale: 1e3,
        curves: &[curve("step_secs", "mean", GREEN), curve("step_max_secs", "longest", ORANGE)],
    },
    Plot { folder: "divergence", title: "Relative divergence of the wind", scale: 1.0, curves: &[curve("divergence_rms", "RMS", BLUE)] },
    Plot { folder: "wind_energy", title: "Kinetic energy of the wind (J/kg)", scale: 1.0, curves: &[curve("wind_energy", "wind", BLUE)] },
    Plot { folder: "bend_activity", title: "Activity of the bend field", scale: 1.0, curves: &[curve("bend_activity", "bend", YELLOW)] },
    Plot {
        folder: "awake",
        title: "Awake patches",
        scale: 1.0,
        curves: &[curve("awake_patches", "awake patches", YELLOW), curve("awake_limit", "limit", GREY)],
    },
    Plot {
        folder: "damage",
        title: "Flattened tiles, broken plants",
        scale: 1.0,
        curves: &[curve("laid_tiles", "flattened tiles", BROWN), curve("broken_plants", "broken plants", RED)],
    },
    Plot {
        folder: "stability",
        title: "Sub-steps, Courant number",
        scale: 1.0,
        curves: &[curve("substeps", "sub-steps", PURPLE), curve("courant", "Courant number", PINK)],
    },
    Plot {
        folder: "population",
        title: "Clients, objects",
        scale: 1.0,
        curves: &[curve("connected_clients", "clients", TEAL), curve("objects", "objects", ORANGE)],
    },
    Plot {
        folder: "losses",
        title: "Losses",
        scale: 1.0,
        curves: &[
            curve("dropped_log_frames", "log frames dropped", GREY),
            curve("evicted_patches", "patches evicted", YELLOW),
            curve("reset_patches", "patches reset", PURPLE),
            curve("dropped_tracks", "tracks discarded", BROWN),
            curve("rejected_motions", "motions rejected", RED),
            curve("wind_resets", "winds restarted", BLUE),
        ],
    },
    Plot {
        folder: "step_errors",
        title: "Errors of the time steps (m/s, °)",
        scale: 1.0,
        curves: &[
            curve("wind_step_error_m_per_s", "wind", BLUE),
            curve("wind_doubled_error_m_per_s", "wind, steps twice as long", GREY),
            curve("bend_step_error_deg", "bend", YELLOW),
        ],
    },
    Plot { folder: "wind_step", title: "Step of the wind (ms)", scale: 1e3, curves: &[curve("wind_step_secs", "wind", BLUE)] },
    Plot {
        folder: "detail",
        title: "Detail",
        scale: 1.0,
        curves: &[
            curve("load_level", "load level", RED),
            curve("decisions", "decisions", ORANGE),
            curve("wind_step_samples", "estimates of the wind's error", GREY),
            curve("wind_doubled_samples", "estimates for steps twice as long", BLUE),
        ],
    },
    Plot { folder: "sent", title: "Sent to clients (kB/s)", scale: 1e-3, curves: &[curve("sent_bytes_per_s", "sent", TEAL)] },
];

impl Plot {
    /// Entity of one of its curves.
    pub(super) fn entity(&self, curve: &Curve) -> String {
        format!("metrics/{}/{}", self.folder, curve.metric)
    }
}

impl Curve {
    /// Value in a frame, in the metric's own unit; NaN for a metric that recordings do not have, which a test rules out.
    pub(super) fn value(&self, frame: &Frame) -> f64 {
        match metrics::find(self.metric).map(|metric| metric.source) {
            Some(Source::World(read)) => read(&frame.snapshot).as_f64(),
            Some(Source::Clients(read)) => read(frame.stats.clients).as_f64(),
            Some(Source::Recording(read)) => read(&frame.stats).as_f64(),
            Some(Source::Server(_) | Source::Distribution(_)) | None => f64::NAN,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_curve_names_a_metric_of_recordings() {
        for curve in PLOTS.iter().flat_map(|plot| plot.curves) {
            let metric = metrics::find(curve.metric).unwrap_or_else(|| panic!("there is no metric `{}`", curve.metric));
            assert!(metric.is_recorded(), "{} is not in recordings", metric.name);
        }
    }

    #[test]
    fn every_metric_of_recordings_has_a_curve() {
        let without = ["tick", "time_secs"];
        for metric in metrics::METRICS.iter().filter(|metric| metric.is_recorded()) {
            let is_shown = PLOTS.iter().flat_map(|plot| plot.curves).any(|curve| curve.metric == metric.name);
            assert_ne!(is_shown, without.contains(&metric.name), "{}", metric.name);
        }
    }

    #[test]
    fn the_readme_lists_every_plot() {
        let row = |plot: &Plot| {
            let names: Vec<_> = plot.curves.iter().map(|curve| format!("`{}`", curve.metric)).collect();
            format!("| {} | {} |\n", plot.title, names.join(", "))
        };
        let rows: String = PLOTS.iter().map(row).collect();
        assert!(include_str!("../../README.md").contains(&rows), "server/README.md must hold these rows:\n{rows}");
    }
}
