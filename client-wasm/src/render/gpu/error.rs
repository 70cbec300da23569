//! Reasons why the graphics device cannot be used.

use thiserror::Error;

/// Reason why the graphics device cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum GpuError {
    /// There is no suitable adapter.
    #[error("no graphics adapter: {0}")]
    NoAdapter(String),
    /// A limit of the adapter is below the minimum.
    #[error("the graphics adapter allows {name} up to {found}; Prairie needs {needed}")]
    Limit {
        /// Name of the limit in WebGPU.
        name: &'static str,
        /// The adapter's value.
        found: u64,
        /// The minimum.
        needed: u64,
    },
    /// The scene does not fit into the device at this quality.
    #[error("the GPU cannot hold the scene in {quality} quality: {reason}")]
    DoesNotFit {
        /// Name of the quality.
        quality: &'static str,
        /// The device's error message.
        reason: String,
    },
    /// The adapter refused to create a device.
    #[error("the graphics adapter gives no device: {0}")]
    NoDevice(String),
}

impl GpuError {
    /// The device reported that it cannot hold a scene.
    pub(crate) fn does_not_fit(quality: &'static str, error: &wgpu::Error) -> Self {
        let mut source: &dyn std::error::Error = error;
        while let Some(cause) = source.source() {
            source = cause;
        }
        let reason = source.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
        Self::DoesNotFit { quality, reason }
    }
}
