//! The interface between the logger thread and the recording it writes.

use super::error::InspectError;
use crate::metrics::RecordingStats;
use crate::snapshot::Snapshot;

/// One frame of a recording.
pub(super) struct Frame {
    pub(super) snapshot: Snapshot,
    pub(super) stats: RecordingStats,
    /// Time of the snapshot on the machine's clock (s since 1970).
    pub(super) wall_secs: f64,
}

/// Destination of a logger thread. Calls may block.
pub(super) trait Sink: Send + 'static {
    fn write(&mut self, frame: &Frame) -> Result<(), InspectError>;
    fn finish(self) -> Result<(), InspectError>;
}
