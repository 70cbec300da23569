//! Qualities that the GPU device has been found to support.

use crate::render::{GpuError, Quality};

/// Result of the attempts to create renderers on the current device.
#[derive(Debug, Default)]
pub(super) struct DeviceSupport {
    /// Whether a renderer is being created.
    pub(super) is_pending: bool,
    /// Number of devices requested so far. Results for an earlier device are ignored.
    pub(super) device: u32,
    /// Highest quality that may be supported, and the error of the next higher one; `None` before an attempt has failed.
    limit: Option<(Quality, String)>,
}

impl DeviceSupport {
    /// State for the next device.
    pub(super) fn next_device(&self) -> Self {
        Self { device: self.device + 1, ..Self::default() }
    }

    /// The quality `wanted`, or the highest that may be supported.
    pub(super) fn best(&self, wanted: Quality) -> Quality {
        self.limit_below(wanted).map_or(wanted, |(quality, _)| quality)
    }

    /// The highest quality that may be supported and why, if it is below `wanted`.
    pub(super) fn limit_below(&self, wanted: Quality) -> Option<(Quality, &str)> {
        let limit = self.limit.as_ref().filter(|(quality, _)| quality.level() < wanted.level());
        limit.map(|(quality, reason)| (*quality, reason.as_str()))
    }

    /// Records that `quality` is not supported. Returns false if there is no lower one.
    pub(super) fn record_failure(&mut self, quality: Quality, error: &GpuError) -> bool {
        let Some(lower) = quality.lower() else { return false };
        self.limit = Some((lower, error.to_string()));
        true
    }
}
