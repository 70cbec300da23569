//! All files of a run. Fields are written by a thread of their own, while the world goes on.

use super::error::OutputError;
use super::sampler::{Frame, Sampler};
use super::sink::Sink;
use super::stations::StationFile;
use crate::world::World;
use std::panic::resume_unwind;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{Builder, JoinHandle};

/// Frames that wait to be written, besides the one that is; the world waits while there are more.
const WAITING: usize = 1;

/// The files of a run; none by default.
#[derive(Default)]
pub struct Outputs {
    fields: Option<(Sampler, FrameWriter)>,
    stations: Option<StationFile>,
}

impl Outputs {
    /// Writes the fields of a sampler into all `sinks`.
    ///
    /// # Errors
    /// When the thread that writes cannot be started.
    pub fn with_fields(self, sampler: Sampler, sinks: Vec<Box<dyn Sink>>) -> Result<Self, OutputError> {
        Ok(Self { fields: Some((sampler, FrameWriter::start(sinks)?)), ..self })
    }

    /// Writes the stations of a file.
    pub fn with_stations(self, file: StationFile) -> Self {
        Self { stations: Some(file), ..self }
    }

    /// Takes the present fields. They are written later.
    ///
    /// # Errors
    /// When a file of an earlier time could not be written.
    pub fn write_fields(&mut self, world: &World) -> Result<(), OutputError> {
        self.fields.as_mut().map_or(Ok(()), |(sampler, writer)| writer.write(sampler.sample(world)))
    }

    /// Writes the present values at the stations.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write_stations(&mut self, world: &World) -> Result<(), OutputError> {
        self.stations.as_mut().map_or(Ok(()), |stations| stations.write(world))
    }

    /// Completes all files, also after one that fails.
    ///
    /// # Errors
    /// The first error that was not returned before.
    pub fn finish(self) -> Result<(), OutputError> {
        let stations = self.stations.map_or(Ok(()), StationFile::finish);
        self.fields.map_or(Ok(()), |(_, writer)| writer.finish()).and(stations)
    }
}

/// The thread that writes frames.
struct FrameWriter {
    frames: SyncSender<Frame>,
    thread: Option<JoinHandle<Result<(), OutputError>>>,
}

impl FrameWriter {
    fn start(sinks: Vec<Box<dyn Sink>>) -> Result<Self, OutputError> {
        let (frames, taken) = sync_channel(WAITING);
        let thread = Builder::new().name("files".to_owned()).spawn(move || write_all(&taken, sinks)).map_err(OutputError::Thread)?;
        Ok(Self { frames, thread: Some(thread) })
    }

    fn write(&mut self, frame: Frame) -> Result<(), OutputError> {
        // The thread ends before its time only with an error.
        if self.frames.send(frame).is_ok() { Ok(()) } else { joined(self.thread.take()) }
    }

    fn finish(self) -> Result<(), OutputError> {
        drop(self.frames);
        joined(self.thread)
    }
}

/// The outcome of the thread; a success once it was taken.
fn joined(thread: Option<JoinHandle<Result<(), OutputError>>>) -> Result<(), OutputError> {
    thread.map_or(Ok(()), |thread| thread.join().unwrap_or_else(|panic| resume_unwind(panic)))
}

/// Writes frames until there are no more or one fails, and completes the files in any case.
fn write_all(frames: &Receiver<Frame>, mut sinks: Vec<Box<dyn Sink>>) -> Result<(), OutputError> {
    let written = frames.iter().try_for_each(|frame| sinks.iter_mut().try_for_each(|sink| sink.write(&frame)));
    let finished: Vec<_> = sinks.into_iter().map(Sink::finish).collect();
    written.and(finished.into_iter().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io;
    use std::sync::{Arc, Mutex};

    /// Fails at the second frame.
    struct Failing(Arc<Mutex<Vec<u64>>>);

    impl Sink for Failing {
        fn write(&mut self, frame: &Frame) -> Result<(), OutputError> {
            let mut ticks = self.0.lock().unwrap();
            ticks.push(frame.tick);
            let full = || OutputError::File { path: "a".into(), reason: io::Error::other("full") };
            if ticks.len() == 2 { Err(full()) } else { Ok(()) }
        }

        fn finish(self: Box<Self>) -> Result<(), OutputError> {
            self.0.lock().unwrap().push(u64::MAX);
            Ok(())
        }
    }

    #[test]
    fn a_failure_ends_the_writing_is_returned_once_and_files_are_completed() {
        let ticks = Arc::<Mutex<Vec<u64>>>::default();
        let mut writer = FrameWriter::start(vec![Box::new(Failing(ticks.clone()))]).unwrap();
        let frame = |tick| Frame { tick, ..Frame::default() };
        let outcomes: Vec<_> = (0..100).map(|tick| writer.write(frame(tick))).collect();
        let errors: Vec<_> = outcomes.into_iter().filter_map(Result::err).map(|error| error.to_string()).collect();
        assert_eq!(errors, ["`a` cannot be written: full"]);
        writer.finish().unwrap();
        assert_eq!(*ticks.lock().unwrap(), [0, 1, u64::MAX]);
    }

    #[test]
    fn all_frames_are_written_in_order() {
        struct Kept(Arc<Mutex<Vec<u64>>>);
        impl Sink for Kept {
            fn write(&mut self, frame: &Frame) -> Result<(), OutputError> {
                self.0.lock().unwrap().push(frame.tick);
                Ok(())
            }
            fn finish(self: Box<Self>) -> Result<(), OutputError> {
                Ok(())
            }
        }
        let ticks = Arc::<Mutex<Vec<u64>>>::default();
        let mut writer = FrameWriter::start(vec![Box::new(Kept(ticks.clone()))]).unwrap();
        (0..50).for_each(|tick| writer.write(Frame { tick, ..Frame::default() }).unwrap());
        writer.finish().unwrap();
        assert_eq!(*ticks.lock().unwrap(), (0..50).collect::<Vec<_>>());
    }
}
