//! Errors of the mirror, and the range checks that raise them.

use prairie_core::grass::ReplicaError;
use prairie_core::terrain::MapError;
use prairie_core::wire::CodecError;
use thiserror::Error;

/// Reason why a message was rejected. A rejected message leaves the mirror unchanged.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MirrorError {
    /// A map of the scene could not be decoded.
    #[error("the {map} {error}")]
    Map {
        /// Name of the map.
        map: &'static str,
        /// Decoding error.
        error: MapError,
    },
    /// A field arrived before the scene that defines its shape.
    #[error("a {0} came before the scene")]
    BeforeScene(&'static str),
    /// A field's payload could not be decoded.
    #[error("the {field} frame is damaged: {error}")]
    Field {
        /// `patch` or `wind`.
        field: &'static str,
        /// Decoding error.
        error: CodecError,
    },
    /// The replica of the grass cannot be started or continued.
    #[error("the grass cannot be replicated: {0}")]
    Replica(ReplicaError),
    /// A value is out of range.
    #[error("{what} is {found}; allowed: {allowed}")]
    Range {
        /// Name of the value.
        what: &'static str,
        /// The value received.
        found: String,
        /// The allowed range.
        allowed: String,
    },
}

pub(super) fn range(what: &'static str, found: impl ToString, allowed: impl ToString) -> MirrorError {
    MirrorError::Range { what, found: found.to_string(), allowed: allowed.to_string() }
}

/// Checks that `low <= value <= high`; NaN is rejected.
pub(super) fn within(what: &'static str, value: f32, low: f32, high: f32) -> Result<(), MirrorError> {
    if (low..=high).contains(&value) { Ok(()) } else { Err(range(what, value, format!("{low}..={high}"))) }
}
