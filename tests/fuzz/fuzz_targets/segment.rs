//! A segment of the journal, as the server reads it after a crash.
//!
//! Checksums would stop almost every input, so they are mended first; the unmended bytes are read, too.

#![no_main]

use libfuzzer_sys::fuzz_target;
use prairie::journal::{Segment, open_record, seal_record};

/// Position of the sealed step at which the segment begins, its length, and the same of its progress (bytes).
const NUMBERS: [(usize, usize); 2] = [(8, 8), (20, 16)];
/// Position of the first record (bytes).
const RECORDS_AT: usize = 40;

/// Puts the right checksum behind `bytes[at..at + len]`, if there is room.
fn mend(bytes: &mut [u8], at: usize, len: usize) -> Option<usize> {
    let end = at.checked_add(len)?;
    let sum = crc32fast::hash(bytes.get(at..end)?).to_le_bytes();
    bytes.get_mut(end..end + 4)?.copy_from_slice(&sum);
    Some(end + 4)
}

/// Length of the record at the start of `bytes`, without its checksum.
fn record_len(bytes: &[u8]) -> Option<usize> {
    let head = bytes.iter().take(4).position(|byte| *byte < 0x80)? + 1;
    let payload = bytes[..head].iter().rev().fold(0, |length, byte| length << 7 | usize::from(byte & 0x7f));
    Some(head + payload)
}

fn mend_all(bytes: &mut [u8]) {
    for (at, len) in NUMBERS {
        mend(bytes, at, len);
    }
    let mut at = RECORDS_AT;
    while let Some(len) = bytes.get(at..).and_then(record_len) {
        match mend(bytes, at, len) {
            Some(end) => at = end,
            None => break,
        }
    }
}

fuzz_target!(|bytes: &[u8]| {
    let _ = Segment::parse(bytes);
    let mut mended = bytes.to_owned();
    mend_all(&mut mended);
    let Ok(segment) = Segment::parse(&mended) else { return };
    assert!(segment.reached >= segment.start);
    assert!(segment.steps.windows(2).all(|pair| pair[0].after < pair[1].after));
    for step in &segment.steps {
        let (mut sealed, mut again) = (vec![], vec![]);
        seal_record(step, &mut sealed);
        let (opened, length) = open_record(&sealed).expect("a sealed record can be opened");
        assert_eq!(length, sealed.len());
        seal_record(&opened, &mut again);
        assert_eq!(again, sealed);
    }
});
