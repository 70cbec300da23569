//! Lossless codec of small 8-bit grids.

use thiserror::Error;

/// Why a payload is no grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum CodecError {
    /// The payload ends before the grid is whole, or holds more than the grid.
    #[error("the payload's length does not fit its grid")]
    Length,
    /// A value leaves −127..=127.
    #[error("the payload holds a value outside -127..=127")]
    Range,
}

/// Codes `codes` (planes of rows of `width`) against `base` of the same shape, or against zero.
pub fn encode(width: usize, codes: &[i8], base: Option<&[i8]>) -> Vec<u8> {
    let _ = width;
    let base_at = |i: usize| base.map_or(0, |base| i16::from(base[i]));
    codes.iter().enumerate().flat_map(|(i, &code)| (i16::from(code) - base_at(i)).to_le_bytes()).collect()
}

/// Decodes a payload in place: `codes` holds the base (all zero for a key) and becomes the grid.
///
/// # Errors
/// [`CodecError`] when the payload is damaged; `codes` is then unspecified.
pub fn decode(width: usize, payload: &[u8], codes: &mut [i8]) -> Result<(), CodecError> {
    let _ = width;
    if payload.len() != codes.len() * 2 {
        return Err(CodecError::Length);
    }
    for (code, pair) in codes.iter_mut().zip(payload.chunks_exact(2)) {
        let value = i32::from(*code) + i32::from(i16::from_le_bytes([pair[0], pair[1]]));
        *code = i8::try_from(value).ok().filter(|v| *v != i8::MIN).ok_or(CodecError::Range)?;
    }
    Ok(())
}
