//! Errors in a scene's settings.

use thiserror::Error;

/// Settings of a scene that are each in range but incompatible with each other.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{field}` {message}")]
pub struct SettingsError {
    /// Path of the field to correct first, such as `grass.mu_m_per_rad`.
    pub field: String,
    /// Problem, values and allowed values. Continues the sentence after the path.
    pub message: String,
}
