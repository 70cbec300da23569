//! The metrics as text for Prometheus and other scrapers, in the OpenMetrics format.

use super::{Kind, METRICS, Metric, PREFIX, ServerStats, Value};
use crate::histogram::Histogram;
use crate::snapshot::Snapshot;
use prometheus_client::collector::Collector;
use prometheus_client::encoding::{DescriptorEncoder, NoLabelSet, text};
use prometheus_client::metrics::MetricType;
use prometheus_client::metrics::exemplar::Exemplar;
use prometheus_client::registry::Registry;
use std::fmt;

/// Formats of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// OpenMetrics 1.0, which Prometheus asks for.
    OpenMetrics,
    /// The older text format, for programs that ask for nothing.
    Text,
}

impl Format {
    /// The format for an `Accept` header.
    pub fn accepted_by(accept: &str) -> Self {
        if accept.contains("application/openmetrics-text") { Self::OpenMetrics } else { Self::Text }
    }

    /// Media type.
    pub fn content_type(self) -> &'static str {
        match self {
            Self::OpenMetrics => "application/openmetrics-text; version=1.0.0; charset=utf-8",
            Self::Text => "text/plain; version=0.0.4; charset=utf-8",
        }
    }
}

/// The metrics of a server that runs the scene called `scene`, and its version and scene as `prairie_build_info`. No series is per client, so their number
/// is fixed.
///
/// # Errors
/// Never in practice: text in memory takes every byte.
pub fn exposition(format: Format, scene: &str, snapshot: &Snapshot, stats: &ServerStats) -> Result<String, fmt::Error> {
    let samples = METRICS.iter().filter_map(|metric| Some((metric, Sample::of(metric, snapshot, stats)?))).collect();
    let mut registry = Registry::default();
    registry.register_collector(Box::new(Scrape { scene: scene.to_owned(), samples }));
    let mut text = String::new();
    text::encode(&mut text, &registry)?;
    Ok(match format {
        Format::OpenMetrics => text,
        Format::Text => older_text(&text),
    })
}

/// OpenMetrics as the older text format, which has no units and no mark of the end, and describes a counter under its full name.
fn older_text(open_metrics: &str) -> String {
    let counters: Vec<String> = METRICS.iter().filter(|metric| metric.kind == Kind::Counter).map(Metric::prometheus_name).collect();
    let mut text = String::new();
    for line in open_metrics.lines().filter(|line| !line.starts_with("# UNIT ") && *line != "# EOF") {
        let mut words = line.splitn(4, ' ');
        let name = if line.starts_with("# ") { words.nth(2) } else { None };
        let full_name = name.and_then(|name| counters.iter().find(|full_name| full_name.strip_suffix("_total") == Some(name)));
        match (name, full_name) {
            (Some(name), Some(full_name)) => text.push_str(&line.replacen(name, full_name, 1)),
            _ => text.push_str(line),
        }
        text.push('\n');
    }
    text
}

/// One scrape: copies of all values.
#[derive(Debug)]
struct Scrape {
    scene: String,
    samples: Vec<(&'static Metric, Sample)>,
}

/// Value of a metric in a scrape.
#[derive(Debug)]
enum Sample {
    Counter(Value),
    Gauge(Value),
    Histogram(Histogram),
}

impl Sample {
    fn of(metric: &Metric, snapshot: &Snapshot, stats: &ServerStats) -> Option<Self> {
        let value = || metric.value(snapshot, stats);
        match metric.kind {
            Kind::Counter => value().map(Self::Counter),
            Kind::Gauge => value().map(Self::Gauge),
            Kind::Histogram => metric.distribution(stats).cloned().map(Self::Histogram),
        }
    }

    fn metric_type(&self) -> MetricType {
        match self {
            Self::Counter(_) => MetricType::Counter,
            Self::Gauge(_) => MetricType::Gauge,
            Self::Histogram(_) => MetricType::Histogram,
        }
    }
}

impl Collector for Scrape {
    fn encode(&self, mut encoder: DescriptorEncoder<'_>) -> fmt::Result {
        let name = format!("{PREFIX}_build_info");
        let labels = [("version", env!("CARGO_PKG_VERSION")), ("scene", &self.scene)];
        let mut info =
            encoder.encode_descriptor(&name, "always 1; version of the server and name of the scene", None, MetricType::Gauge)?;
        info.encode_family(&labels)?.encode_gauge(&1_u64)?;
        for (metric, sample) in &self.samples {
            let (name, unit) = (format!("{PREFIX}_{}", metric.prometheus_stem()), metric.unit.registered());
            let mut encoder = encoder.encode_descriptor(&name, metric.meaning, unit.as_ref(), sample.metric_type())?;
            let no_exemplar = None::<&Exemplar<NoLabelSet, f64>>;
            match sample {
                Sample::Counter(Value::Count(count)) => encoder.encode_counter(count, no_exemplar)?,
                Sample::Counter(Value::Real(real)) => encoder.encode_counter(real, no_exemplar)?,
                Sample::Gauge(Value::Count(count)) => encoder.encode_gauge(count)?,
                Sample::Gauge(Value::Real(real)) => encoder.encode_gauge(real)?,
                Sample::Histogram(histogram) => {
                    let buckets: Vec<_> = histogram.buckets().collect();
                    encoder.encode_histogram::<NoLabelSet>(histogram.sum(), histogram.count(), &buckets, None)?;
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::stats::stats_for_tests;
    use super::*;

    /// The lines of `text` that start with `start`.
    fn lines<'t>(text: &'t str, start: &str) -> Vec<&'t str> {
        text.lines().filter(|line| line.starts_with(start)).collect()
    }

    #[test]
    fn each_type_is_written_as_the_format_requires() {
        let mut stats = ServerStats { dropped_secs: 1.5, clients: 3, ..stats_for_tests() };
        for secs in [0.003, 0.003, 7.0] {
            stats.step_secs.observe(secs);
        }
        let text = exposition(Format::OpenMetrics, "meadow", &Snapshot { tick: 12, ..Snapshot::default() }, &stats).unwrap();
        assert_eq!(
            lines(&text, "# HELP prairie_dropped_seconds "),
            ["# HELP prairie_dropped_seconds simulated time skipped because the machine was too slow"]
        );
        assert_eq!(lines(&text, "# TYPE prairie_dropped_seconds "), ["# TYPE prairie_dropped_seconds counter"]);
        assert_eq!(lines(&text, "# UNIT prairie_dropped_seconds "), ["# UNIT prairie_dropped_seconds seconds"]);
        assert_eq!(lines(&text, "prairie_dropped_seconds"), ["prairie_dropped_seconds_total 1.5"]);
        assert_eq!(lines(&text, "prairie_tick"), ["prairie_tick_total 12"]);
        assert_eq!(lines(&text, "prairie_connected_clients"), ["prairie_connected_clients 3"]);
        let steps = lines(&text, "prairie_step_duration_seconds_");
        for line in ["sum 7.006", "count 3", "bucket{le=\"0.002\"} 0", "bucket{le=\"0.004\"} 2", "bucket{le=\"+Inf\"} 3"] {
            assert!(steps.contains(&format!("prairie_step_duration_seconds_{line}").as_str()), "{line}: {steps:?}");
        }
        assert!(text.ends_with("\n# EOF\n"), "{text}");
    }

    #[test]
    fn names_in_the_text_are_those_of_the_table() {
        let text = exposition(Format::OpenMetrics, "meadow", &Snapshot::default(), &stats_for_tests()).unwrap();
        for metric in METRICS {
            let suffix = if metric.kind == Kind::Histogram { "_count " } else { " " };
            let found = lines(&text, &format!("{}{suffix}", metric.prometheus_name())).len();
            assert_eq!(found, usize::from(metric.is_scraped()), "{}", metric.name);
        }
    }

    #[test]
    fn a_scene_name_is_escaped() {
        let text = exposition(Format::OpenMetrics, "a \"b\"\\\n", &Snapshot::default(), &stats_for_tests()).unwrap();
        let version = env!("CARGO_PKG_VERSION");
        assert_eq!(lines(&text, "prairie_build"), [format!("prairie_build_info{{version=\"{version}\",scene=\"a \\\"b\\\"\\\\\\n\"}} 1")]);
    }
    #[test]
    fn the_older_text_describes_counters_under_their_full_names() {
        let text = exposition(Format::Text, "meadow", &Snapshot::default(), &stats_for_tests()).unwrap();
        assert_eq!(
            lines(&text, "# HELP prairie_dropped_seconds"),
            ["# HELP prairie_dropped_seconds_total simulated time skipped because the machine was too slow"]
        );
        assert_eq!(lines(&text, "# TYPE prairie_dropped_seconds"), ["# TYPE prairie_dropped_seconds_total counter"]);
        assert_eq!(lines(&text, "# TYPE prairie_objects"), ["# TYPE prairie_objects gauge"]);
        assert_eq!(lines(&text, "prairie_objects"), ["prairie_objects 0"]);
        assert!(lines(&text, "# UNIT").is_empty() && lines(&text, "# EOF").is_empty(), "{text}");
    }

    #[test]
    fn the_format_follows_the_accept_header() {
        let prometheus = "application/openmetrics-text; version=1.0.0,application/openmetrics-text; version=0.0.1;q=0.75,text/plain;version=0.0.4;q=0.5,*/*;q=0.1";
        assert_eq!(Format::accepted_by(prometheus), Format::OpenMetrics);
        assert_eq!(Format::accepted_by("text/html,*/*;q=0.8"), Format::Text);
        assert_eq!(Format::accepted_by(""), Format::Text);
    }
}
