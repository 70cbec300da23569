//! The stream of a recording, with the timelines of its frames and the rates of its entities.

use super::connect::sdk;
use super::entities::Entity;
use super::error::InspectError;
use super::rates::{EntityRate, Schedule};
use super::sink::Frame;
use rerun::components::ImageFormat;
use rerun::datatypes::{ChannelDatatype, TensorBuffer, TensorData};
use rerun::{AsComponents, DepthImage, RecordingStream, Tensor};

/// Timelines of every entity that is recorded in frames.
pub(super) const TIMELINES: [&str; 3] = ["tick", "sim_time", "wall_time"];

/// The stream of a recording.
pub(super) struct Log {
    stream: RecordingStream,
    schedule: Schedule,
}

impl Log {
    /// The stream with the default rates and those that are `stated`.
    pub(super) fn new(stream: RecordingStream, stated: &[EntityRate]) -> Self {
        Self { stream, schedule: Schedule::new(stated) }
    }

    pub(super) fn stream(&self) -> &RecordingStream {
        &self.stream
    }

    /// Sets the times of a frame on all timelines.
    pub(super) fn begin(&mut self, frame: &Frame) {
        let [tick, sim_time, wall_time] = TIMELINES;
        let readable_secs = (frame.snapshot.time_secs * 1e4).round() / 1e4;
        self.stream.set_time_sequence(tick, i64::try_from(frame.snapshot.tick).unwrap_or(i64::MAX));
        self.stream.set_duration_secs(sim_time, readable_secs);
        self.stream.set_timestamp_secs_since_epoch(wall_time, frame.wall_secs);
        self.schedule.begin(frame.snapshot.time_secs);
    }

    /// Whether an entity is due in this frame; it then counts as written.
    pub(super) fn takes(&mut self, entity: Entity) -> bool {
        self.schedule.take(entity)
    }

    /// Whether an entity is recorded at all.
    pub(super) fn is_on(&self, entity: Entity) -> bool {
        self.schedule.is_on(entity)
    }

    /// Writes an entity at the times of the frame.
    pub(super) fn write(&self, entity: Entity, what: &dyn AsComponents) -> Result<(), InspectError> {
        self.write_at(entity.path(), what)
    }

    /// Writes an entity below one of the table.
    pub(super) fn write_at(&self, path: &str, what: &dyn AsComponents) -> Result<(), InspectError> {
        self.stream.log(path, what).map_err(sdk)
    }

    /// Writes what does not change, on no timeline.
    pub(super) fn keep(&self, entity: Entity, what: &dyn AsComponents) -> Result<(), InspectError> {
        self.keep_at(entity, entity.path(), what)
    }

    /// Writes what does not change, below an entity of the table.
    pub(super) fn keep_at(&self, entity: Entity, path: &str, what: &dyn AsComponents) -> Result<(), InspectError> {
        if self.is_on(entity) { self.stream.log_static(path, what).map_err(sdk) } else { Ok(()) }
    }
}

/// An image of exact values, row by row from the north or from the top.
pub(super) fn image(values: &[f32], size_px: [u32; 2]) -> DepthImage {
    let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_ne_bytes()).collect();
    DepthImage::new(bytes, ImageFormat::depth(size_px, ChannelDatatype::F32))
}

/// A tensor of exact values, whose last dimension varies fastest.
pub(super) fn tensor<const N: usize>(values: Vec<f32>, shape: [usize; N], names: [&str; N]) -> Tensor {
    let shape: Vec<u64> = shape.iter().map(|&n| n as u64).collect();
    Tensor::new(TensorData::new(shape, TensorBuffer::F32(values.into())).with_dim_names(names))
}
