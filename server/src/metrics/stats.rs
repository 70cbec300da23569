//! Numbers from which the metrics of the server and of a recording are read.

use crate::histogram::Histogram;

/// State of the server, for `/healthz` and `/metrics`.
#[derive(Clone, Debug, PartialEq)]
pub struct ServerStats {
    /// Connected clients.
    pub clients: u32,
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
    /// Clients that have a replica of the grass.
    pub replicas: u64,
    /// Replicas so far that differed from the grass.
    pub differences: u64,
    /// Connections rejected because of too many from the same address.
    pub rejected_connections: u64,
    /// Connections closed because they sent too much.
    pub rate_limited_connections: u64,
    /// Counters of the journal; all 0 without memory.
    pub journal: JournalStats,
    /// Durations of the steps (s), wall-clock time.
    pub step_secs: Histogram,
    /// Bytes of each frame handed to a session.
    pub frame_bytes: Histogram,
}

/// Counters of a journal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JournalStats {
    /// Bytes of records written.
    pub bytes: u64,
    /// Checkpoints written.
    pub checkpoints: u64,
    /// Failed writes of segments and checkpoints.
    pub failures: u64,
    /// Steps that are missing in the journal because of a full queue or a failed write; a checkpoint follows.
    pub lost_steps: u64,
    /// Duration of the longest copy of the state within a step (s).
    pub copy_max_secs: f64,
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

/// A server that has done nothing yet.
#[cfg(test)]
pub(super) fn stats_for_tests() -> ServerStats {
    ServerStats {
        clients: 0,
        uptime_secs: 0.0,
        dropped_secs: 0.0,
        sent_bytes: 0,
        encodings: 0,
        cached_patches: 0,
        held_patches: 0,
        frames: 0,
        skipped_frames: 0,
        replicas: 0,
        differences: 0,
        rejected_connections: 0,
        rate_limited_connections: 0,
        journal: JournalStats::default(),
        step_secs: Histogram::new(&[0.002, 0.004]),
        frame_bytes: Histogram::new(&[1e3]),
    }
}
