//! Units of metrics, in short for people and spelled out for Prometheus.

use prometheus_client::registry;

/// Unit of a metric.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// No unit: a count, or an index of mixed units.
    Count,
    /// No unit: a fraction.
    Ratio,
    /// Seconds.
    Seconds,
    /// Bytes.
    Bytes,
    /// Bytes per second.
    BytesPerSecond,
    /// Joules per kilogram of air.
    JoulesPerKilogram,
    /// Metres per second.
    MetresPerSecond,
    /// Degrees.
    Degrees,
}

impl Unit {
    /// Symbol in documents; empty for a number without unit.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Count | Self::Ratio => "",
            Self::Seconds => "s",
            Self::Bytes => "bytes",
            Self::BytesPerSecond => "bytes/s",
            Self::JoulesPerKilogram => "J/kg",
            Self::MetresPerSecond => "m/s",
            Self::Degrees => "°",
        }
    }

    /// End of the names of metrics in this unit.
    pub(super) fn name_suffix(self) -> &'static str {
        match self {
            Self::Count | Self::Ratio | Self::JoulesPerKilogram => "",
            Self::Seconds => "_secs",
            Self::Bytes => "_bytes",
            Self::BytesPerSecond => "_bytes_per_s",
            Self::MetresPerSecond => "_m_per_s",
            Self::Degrees => "_deg",
        }
    }

    /// Word in the names of `/metrics`.
    pub(super) fn prometheus(self) -> Option<&'static str> {
        match self {
            Self::Count => None,
            Self::Ratio => Some("ratio"),
            Self::Seconds => Some("seconds"),
            Self::Bytes => Some("bytes"),
            Self::BytesPerSecond => Some("bytes_per_second"),
            Self::JoulesPerKilogram => Some("joules_per_kilogram"),
            Self::MetresPerSecond => Some("meters_per_second"),
            Self::Degrees => Some("degrees"),
        }
    }

    /// The unit as the encoder of `/metrics` takes it.
    pub(super) fn registered(self) -> Option<registry::Unit> {
        self.prometheus().map(|word| registry::Unit::Other(word.to_owned()))
    }
}
