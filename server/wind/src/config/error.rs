//! Errors of the settings, and checks of ranges.

/// A setting out of range, or inconsistent with another.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("wind: {field} is {value}; allowed: {allowed}")]
pub struct ConfigError {
    /// Path of the setting from [`Config`](super::Config).
    pub field: String,
    /// Its value.
    pub value: String,
    /// The allowed values.
    pub allowed: &'static str,
}

pub(crate) fn check(ok: bool, field: impl Into<String>, value: impl std::fmt::Display, allowed: &'static str) -> Result<(), ConfigError> {
    if ok { Ok(()) } else { Err(ConfigError { field: field.into(), value: value.to_string(), allowed }) }
}

pub(crate) fn at_least_zero(field: &str, value: f32) -> Result<(), ConfigError> {
    check((0.0..=1.0e6).contains(&value), field, value, "0 to 1e6")
}

pub(crate) fn above_zero(field: &str, value: f32) -> Result<(), ConfigError> {
    check(value > 0.0 && value <= 1.0e6, field, value, "above 0, at most 1e6")
}
