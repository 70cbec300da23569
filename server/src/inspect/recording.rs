//! An open recording. Its entities are those of the [table](super::entities::ENTITIES).

use super::bend_fields::{BendFields, new_steps};
use super::bend_map::BendMap;
use super::blueprint;
use super::connect::{VIEWER_TIMEOUT, open_stream, sdk};
use super::error::InspectError;
use super::log::Log;
use super::rates::EntityRate;
use super::sink::{Frame, Sink};
use super::target::Target;
use super::write_grass::GrassWriter;
use super::write_health::HealthWriter;
use super::write_land::write_land;
use super::write_objects::ObjectWriter;
use super::write_wind::WindWriter;
use prairie_core::grid::PatchLayout;
use prairie_core::scene::Scene;
use prairie_core::terrain::{CoverMap, HeightMap, KindMap};
use prairie_core::wind::WindField;
use rerun::external::re_log_encoding::{Decodable as _, StreamFooter};
use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::path::Path;
use std::sync::Arc;

/// An open recording.
pub(super) struct Recording {
    log: Log,
    address: String,
    to_file: bool,
    wind: WindWriter,
    grass: GrassWriter,
    objects: ObjectWriter,
    health: HealthWriter,
    /// Newest step of the grass that was written; `None` before the first frame.
    step_tick: Option<u64>,
}

impl Recording {
    /// Opens the target and logs the static data.
    pub(super) fn open(
        target: &Target,
        rates: &[EntityRate],
        scene: &Scene,
        heights: &HeightMap,
        cover: &CoverMap,
    ) -> Result<Self, InspectError> {
        let (stream, address) = open_stream(target)?;
        blueprint::initial_layout(scene, heights).map_err(sdk)?.send(&stream);
        let log = Log::new(stream, rates);
        let wind = WindField::still(scene, Arc::new(KindMap::new(scene, cover)));
        let map = BendMap::new(PatchLayout::from(&scene.patches), wind, scene.tick_hz as u64);
        write_land(&log, scene, heights, cover, &map)?;
        HealthWriter::write_static(&log)?;
        let (pixel_m, grass) = (map.pixel_m(), GrassWriter::new(map, BendFields::new(scene)));
        grass.write_static(&log)?;
        let heights = Arc::new(heights.clone());
        Ok(Self {
            log,
            address,
            to_file: matches!(target, Target::Save(_)),
            wind: WindWriter::new(scene, Arc::clone(&heights)),
            grass,
            objects: ObjectWriter::new(scene, heights, pixel_m),
            health: HealthWriter::default(),
            step_tick: None,
        })
    }

    /// Path of the file, or URL for viewers.
    pub(super) fn address(&self) -> String {
        self.address.clone()
    }
}

impl Sink for Recording {
    fn write(&mut self, frame: &Frame) -> Result<(), InspectError> {
        let snapshot = &frame.snapshot;
        self.log.begin(frame);
        let steps = new_steps(&snapshot.steps, self.step_tick);
        self.grass.write(&mut self.log, snapshot, steps)?;
        self.wind.write(&mut self.log, &snapshot.wind)?;
        self.objects.write(&mut self.log, snapshot)?;
        self.health.write(&mut self.log, frame, steps)?;
        self.step_tick = Some(snapshot.tick);
        Ok(())
    }

    /// Completes a file with its footer, without which it fails verification; gives a viewer a moment to receive the last frames.
    fn finish(self) -> Result<(), InspectError> {
        let stream = self.log.stream();
        if self.to_file {
            stream.flush_blocking().map_err(sdk)?;
            stream.disconnect();
            return check_footer(Path::new(&self.address));
        }
        stream.flush_with_timeout(VIEWER_TIMEOUT).map_err(sdk)
    }
}

/// Checks that a file has its footer. If the SDK cannot write it, it only logs that. A pipe cannot be read again.
fn check_footer(path: &Path) -> Result<(), InspectError> {
    let unreadable = |reason| InspectError::File { path: path.to_owned(), reason };
    if !std::fs::metadata(path).map_err(unreadable)?.is_file() {
        return Ok(());
    }
    let mut file = File::open(path).map_err(unreadable)?;
    let length = StreamFooter::ENCODED_SIZE_BYTES as u64;
    let bytes = file.metadata().map_err(unreadable)?.len();
    let mut footer = [0; StreamFooter::ENCODED_SIZE_BYTES];
    file.seek(SeekFrom::Start(bytes.saturating_sub(length))).and_then(|_| file.read_exact(&mut footer)).map_err(unreadable)?;
    StreamFooter::from_rrd_bytes(&footer).map(drop).map_err(|_| InspectError::NoFooter { path: path.to_owned() })
}

#[cfg(test)]
mod tests;
