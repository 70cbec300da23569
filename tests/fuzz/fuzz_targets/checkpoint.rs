//! A checkpoint: the state of a world, plain, and compressed in its file.

#![no_main]

use libfuzzer_sys::fuzz_target;
use prairie::journal::open_checkpoint;
use prairie::world::WorldState;

/// Position of the checksum in a checkpoint, over all other bytes, and its end (bytes).
const SUM: std::ops::Range<usize> = 16..20;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(state) = WorldState::decode(bytes) {
        let encoded = state.encode();
        let again = WorldState::decode(&encoded).expect("an encoded state can be decoded");
        assert!(again.encode() == encoded);
    }
    if bytes.len() >= SUM.end {
        let mut mended = bytes.to_owned();
        let mut sum = crc32fast::Hasher::new();
        sum.update(&bytes[..SUM.start]);
        sum.update(&bytes[SUM.end..]);
        mended[SUM].copy_from_slice(&sum.finalize().to_le_bytes());
        let _ = open_checkpoint(&mended);
    }
});
