//! Checkpoints: the state of a world, compressed, with a checksum.

use super::error::Fault;
use crate::world::WorldState;
use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use std::io::{Read as _, Write as _};

/// First bytes of a checkpoint, with the version of the format.
const MAGIC: [u8; 8] = *b"prairC\x01\n";
/// Magic, length of the state, CRC-32 of everything else.
const HEADER_BYTES: usize = 20;
/// Largest state (bytes).
const STATE_LIMIT: u64 = 1 << 32;

/// A world's state as the bytes of a checkpoint.
pub fn seal_checkpoint(state: &WorldState) -> Vec<u8> {
    let state = state.encode();
    let mut encoder = ZlibEncoder::new(vec![0; HEADER_BYTES], Compression::fast());
    let mut bytes = encoder.write_all(&state).and_then(|()| encoder.finish()).expect("memory takes all bytes");
    bytes[..8].copy_from_slice(&MAGIC);
    bytes[8..16].copy_from_slice(&(state.len() as u64).to_le_bytes());
    let sum = sum(&bytes);
    bytes[16..20].copy_from_slice(&sum.to_le_bytes());
    bytes
}

/// The state of a checkpoint.
///
/// # Errors
/// [`Fault`] when any byte is missing or has changed.
pub fn open_checkpoint(bytes: &[u8]) -> Result<WorldState, Fault> {
    let header: &[u8; HEADER_BYTES] = bytes.first_chunk().ok_or(Fault::Truncated)?;
    if header[..8] != MAGIC {
        return Err(Fault::Kind);
    }
    if header[16..] != sum(bytes).to_le_bytes() {
        return Err(Fault::Checksum);
    }
    let length = u64::from_le_bytes(header[8..16].try_into().expect("eight bytes"));
    if length > STATE_LIMIT {
        return Err(Fault::Content);
    }
    let mut state = Vec::new();
    ZlibDecoder::new(&bytes[HEADER_BYTES..]).take(length + 1).read_to_end(&mut state).map_err(|_| Fault::Content)?;
    if state.len() as u64 != length {
        return Err(Fault::Content);
    }
    Ok(WorldState::decode(&state)?)
}

/// CRC-32 of all bytes but its own.
fn sum(bytes: &[u8]) -> u32 {
    let mut sum = crc32fast::Hasher::new();
    sum.update(&bytes[..16]);
    sum.update(&bytes[HEADER_BYTES..]);
    sum.finalize()
}
