//! Segments of a journal: a header, the step reached, and records.

use super::error::Fault;
use super::record::{Step, open_record, seal_record};
use crate::file::sync_folder;
use std::fs::{File, OpenOptions};
use std::io::{self, Seek as _, SeekFrom, Write as _};
use std::path::Path;

/// First bytes of a segment, with the version of the format.
const MAGIC: [u8; 8] = *b"prairJ\x01\n";
/// Position of the progress: step reached and length of the file, overwritten in place.
const PROGRESS_AT: usize = 20;
/// Position of the first record.
const RECORDS_AT: usize = 40;

/// A segment as read.
#[derive(Debug)]
pub struct Segment {
    /// Number of the step after which the segment begins.
    pub start: u64,
    /// Number of the newest step.
    pub reached: u64,
    /// Steps with commands, ascending.
    pub steps: Vec<Step>,
    /// The fault at which reading ended, if it did not end at the end of the file.
    pub fault: Option<Fault>,
}

/// Numbers with their checksum.
fn sealed(numbers: &[u64]) -> Vec<u8> {
    let mut bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    bytes
}

/// The numbers of [`sealed`] at the start of `bytes`.
fn unsealed<const N: usize>(bytes: &[u8]) -> Result<[u64; N], Fault> {
    let number = |n: usize| Some(u64::from_le_bytes(*bytes.get(8 * n..)?.first_chunk()?));
    let mut numbers = [0; N];
    for (n, value) in numbers.iter_mut().enumerate() {
        *value = number(n).ok_or(Fault::Truncated)?;
    }
    let found = bytes.get(..8 * N + 4).ok_or(Fault::Truncated)?;
    if sealed(&numbers) == found { Ok(numbers) } else { Err(Fault::Checksum) }
}

impl Segment {
    /// Reads a segment up to its first fault.
    ///
    /// # Errors
    /// [`Fault`] when not even the header is valid.
    pub fn read(path: &Path) -> Result<Self, Fault> {
        Self::parse(&std::fs::read(path)?)
    }

    /// [`read`](Self::read) from bytes.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn parse(bytes: &[u8]) -> Result<Self, Fault> {
        if bytes.get(..MAGIC.len()).ok_or(Fault::Truncated)? != MAGIC {
            return Err(Fault::Kind);
        }
        let [start] = unsealed(&bytes[MAGIC.len()..])?;
        let progress = unsealed(bytes.get(PROGRESS_AT..).ok_or(Fault::Truncated)?);
        let mut segment = Self { start, reached: start, steps: Vec::new(), fault: None };
        let mut at = RECORDS_AT;
        while at < bytes.len() && segment.fault.is_none() {
            match open_record(&bytes[at..]) {
                Ok((step, length)) if step.after > segment.steps.last().map_or(0, |step| step.after) => {
                    segment.steps.push(step);
                    at += length;
                }
                Ok(_) => segment.fault = Some(Fault::Content),
                Err(fault) => segment.fault = Some(fault),
            }
        }
        let newest = segment.steps.last().map_or(start, |step| start.saturating_add(step.after));
        segment.reached = newest;
        match progress {
            // Steps after a fault may have had commands.
            _ if segment.fault.is_some() => {}
            Ok([_, length]) if length > bytes.len() as u64 => segment.fault = Some(Fault::Truncated),
            Ok([reached, _]) => segment.reached = newest.max(reached),
            Err(fault) => segment.fault = Some(fault),
        }
        Ok(segment)
    }
}

/// A segment that is being written.
#[derive(Debug)]
pub(super) struct SegmentWriter {
    file: File,
    start: u64,
    bytes: u64,
}

impl SegmentWriter {
    /// Creates a segment that begins after the step `start`.
    pub(super) fn create(path: &Path, start: u64) -> io::Result<Self> {
        let mut file = OpenOptions::new().write(true).create_new(true).open(path)?;
        let header = [&MAGIC[..], &sealed(&[start]), &sealed(&[start, RECORDS_AT as u64])].concat();
        file.write_all(&header)?;
        file.sync_all()?;
        sync_folder(path)?;
        Ok(Self { file, start, bytes: header.len() as u64 })
    }

    /// Writes the commands of some steps, then the number of the newest step. Steps without commands need no record.
    pub(super) fn append(&mut self, steps: impl Iterator<Item = (u64, Vec<crate::world::Command>)>) -> io::Result<u64> {
        let (mut records, mut newest) = (Vec::new(), self.start);
        for (tick, commands) in steps {
            newest = tick;
            if !commands.is_empty() {
                seal_record(&Step { after: tick - self.start, commands }, &mut records);
            }
        }
        self.file.write_all(&records)?;
        self.bytes += records.len() as u64;
        self.file.seek(SeekFrom::Start(PROGRESS_AT as u64))?;
        self.file.write_all(&sealed(&[newest, self.bytes]))?;
        self.file.seek(SeekFrom::Start(self.bytes))?;
        Ok(records.len() as u64)
    }

    /// Waits until everything is on the disk.
    pub(super) fn sync(&self) -> io::Result<()> {
        self.file.sync_data()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::Command;
    use proptest::prelude::*;

    fn written(ticks: &[(u64, usize)]) -> Vec<u8> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("1.journal");
        let mut writer = SegmentWriter::create(&path, 100).unwrap();
        for &(tick, commands) in ticks {
            writer.append([(tick, vec![Command::Remove { client: 7 }; commands])].into_iter()).unwrap();
        }
        std::fs::read(path).unwrap()
    }

    #[test]
    fn a_segment_is_read_to_the_step_that_it_had_reached() {
        let segment = Segment::parse(&written(&[(101, 0), (102, 2), (103, 0), (150, 1), (170, 0)])).unwrap();
        assert!((segment.start, segment.reached) == (100, 170) && segment.fault.is_none());
        assert_eq!(segment.steps.iter().map(|step| (step.after, step.commands.len())).collect::<Vec<_>>(), [(2, 2), (50, 1)]);
    }

    #[test]
    fn a_torn_tail_is_cut() {
        let bytes = written(&[(102, 1), (150, 1), (170, 0)]);
        let whole = Segment::parse(&bytes).unwrap();
        for end in 0..bytes.len() {
            match Segment::parse(&bytes[..end]) {
                Ok(segment) => {
                    assert!(end >= PROGRESS_AT && whole.steps.starts_with(&segment.steps));
                    assert!(segment.fault.is_some() == (segment.reached < 170), "{segment:?}");
                }
                Err(_) => assert!(end < PROGRESS_AT, "{end}"),
            }
        }
    }

    proptest! {
        #[test]
        fn any_bytes_are_a_segment_or_a_fault(tail in proptest::collection::vec(any::<u8>(), 0..100), flip in any::<prop::sample::Index>()) {
            let mut bytes = written(&[(102, 1), (150, 1)]);
            bytes.extend(tail);
            let bit = flip.index(8 * bytes.len());
            bytes[bit / 8] ^= 1 << (bit % 8);
            let _ = Segment::parse(&bytes);
        }
    }
}
