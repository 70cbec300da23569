//! Lossless codec of the streamed fields: adaptive binary arithmetic coding of small grids of 16-bit codes.
//!
//! A grid has a few planes of rows of codes ([`Shape`]). It is coded as differences from a base of the same shape (delta frame) or from
//! zero (key frame), so one code path serves both. Per plane and tile of 8 × 8 cells:
//!
//! 1. One bit says whether the tile differs from the base; a tile at rest costs a small fraction of a bit.
//! 2. One bit chooses the prediction of the differences: none (noise of one code), or the median edge detector on three neighbours
//!    already coded (smooth motion, key frames), as in JPEG-LS (Weinberger et al. 2000).
//! 3. The residual is coded as zero flag, sign and exp-Golomb magnitude. Each binary decision has its own adaptive probability, chosen by the
//!    size of the neighbours' residuals.
//!
//! All arithmetic is on integers, so results are the same on every machine. Decoding takes bounded time for any bytes.

mod arithmetic;
mod model;
pub mod moves;
mod tile;

use super::quantise::CODE_LIMIT;
use crate::scene::Scene;
use arithmetic::Coder;
use model::Model;
use thiserror::Error;
use tile::{median_edge, predicts_better, tiles};

/// Memory layout of a grid: `planes` planes, one after the other, each of rows of `width` codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Codes in one row.
    pub width: usize,
    /// Number of planes; their meaning is up to the message. The first and the fourth have separate statistics, all others share theirs.
    pub planes: usize,
}

impl Shape {
    /// Planes θ, ωx, ωz of a patch of `cells × cells`.
    pub const fn patch(cells: usize) -> Self {
        Self { width: cells, planes: 3 }
    }

    /// Those of a patch in snow, with a fourth plane: differences in the depth of the snow.
    pub const fn snowy_patch(cells: usize) -> Self {
        Self { width: cells, planes: 4 }
    }

    /// Shape of a patch of a scene.
    pub fn patch_of(scene: &Scene) -> Self {
        let cells = scene.patches.cells as usize;
        if scene.snow.lies() { Self::snowy_patch(cells) } else { Self::patch(cells) }
    }

    /// Shape of a patch with this number of codes. The number tells the planes: three equal squares are never four.
    pub fn of_patch(codes: usize) -> Self {
        let side = (codes / 4).isqrt();
        if 4 * side * side == codes { Self::snowy_patch(side) } else { Self::patch((codes / 3).isqrt()) }
    }

    /// Planes u, v, w and, with `has_dust`, dust, of a wind of `width` cells along X.
    pub const fn wind(width: usize, has_dust: bool) -> Self {
        Self { width, planes: if has_dust { 4 } else { 3 } }
    }

    fn assert_fits(self, codes: &[i16]) {
        let Self { width, planes } = self;
        assert!(width > 0 && planes > 0 && codes.len().is_multiple_of(planes * width), "{planes} planes of rows of {width}");
    }
}

/// Reasons why a payload cannot be decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum CodecError {
    /// The payload ends before the grid is complete, or is longer than the grid.
    #[error("the payload's length does not match its grid")]
    Length,
    /// A value is outside ±[`CODE_LIMIT`].
    #[error("the payload holds a value outside -{CODE_LIMIT}..={CODE_LIMIT}")]
    Range,
}

/// Encodes `codes` as differences from `base` of the same shape, or from zero.
///
/// # Panics
/// When `codes.len()` is not a multiple of `planes · width`, or differs from the base's length.
pub fn encode(shape: Shape, codes: &[i16], base: Option<&[i16]>) -> Vec<u8> {
    shape.assert_fits(codes);
    let Shape { width, planes } = shape;
    assert!(base.is_none_or(|base| base.len() == codes.len()), "the base has the grid's shape");
    let differences: Vec<i32> = match base {
        Some(base) => codes.iter().zip(base).map(|(&code, &base)| i32::from(code) - i32::from(base)).collect(),
        None => codes.iter().map(|&code| i32::from(code)).collect(),
    };
    let mut encoder = arithmetic::Encoder::default();
    let mut model = Model::default();
    for (plane, differences) in differences.chunks_exact(codes.len() / planes).enumerate() {
        let mut residuals = vec![0; differences.len()];
        for tile in tiles(width, differences.len() / width) {
            let changed = tile.cells(width).any(|at| differences[at] != 0);
            let context = model.tile_context(plane, &tile, width, &residuals);
            encoder.code(model.changed(context), Some(changed));
            if !changed {
                continue;
            }
            let predicted = predicts_better(&tile, width, differences);
            encoder.code(model.predicted(plane), Some(predicted));
            for at in tile.cells(width) {
                let prediction = if predicted { median_edge(differences, width, at) } else { 0 };
                let residual = differences[at] - prediction;
                model.code_residual(&mut encoder, plane, predicted, width, at, &mut residuals, Some(residual));
            }
        }
    }
    encoder.finish()
}

/// Decodes a payload in place: `codes` holds the base (all zero for a key frame) and is overwritten by the grid.
///
/// # Errors
/// [`CodecError`] when the payload is damaged; `codes` is then unspecified.
///
/// # Panics
/// When `codes.len()` is not a multiple of `planes · width`.
pub fn decode(shape: Shape, payload: &[u8], codes: &mut [i16]) -> Result<(), CodecError> {
    shape.assert_fits(codes);
    let Shape { width, planes } = shape;
    let plane_len = codes.len() / planes;
    let mut decoder = arithmetic::Decoder::new(payload);
    let mut model = Model::default();
    let mut differences = vec![0_i32; plane_len];
    let mut residuals = vec![0_i32; plane_len];
    for (plane, codes) in codes.chunks_exact_mut(plane_len).enumerate() {
        differences.fill(0);
        residuals.fill(0);
        for tile in tiles(width, plane_len / width) {
            let context = model.tile_context(plane, &tile, width, &residuals);
            if !decoder.code(model.changed(context), None) {
                continue;
            }
            let predicted = decoder.code(model.predicted(plane), None);
            for at in tile.cells(width) {
                let prediction = if predicted { median_edge(&differences, width, at) } else { 0 };
                let residual = model.code_residual(&mut decoder, plane, predicted, width, at, &mut residuals, None);
                let difference = prediction + residual;
                let code = i32::from(codes[at]) + difference;
                if code.abs() > i32::from(CODE_LIMIT) {
                    return Err(CodecError::Range);
                }
                differences[at] = difference;
                codes[at] = code as i16;
            }
        }
    }
    if decoder.is_exhausted_exactly() { Ok(()) } else { Err(CodecError::Length) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const PATCH: Shape = Shape::patch(64);
    const PATCH_LEN: usize = 3 * 64 * 64;

    fn grid(shape: Shape, rows: usize) -> impl Strategy<Value = Vec<i16>> {
        let codes = prop_oneof![8 => Just(0_i16), 4 => -3_i16..=3, 2 => -127_i16..=127, 1 => -CODE_LIMIT..=CODE_LIMIT];
        proptest::collection::vec(codes, shape.planes * shape.width * rows)
    }

    fn shapes() -> impl Strategy<Value = Shape> {
        (1_usize..20, any::<bool>()).prop_map(|(width, has_dust)| Shape::wind(width, has_dust))
    }

    proptest! {
        #[test]
        fn key_and_delta_frames_round_trip(
            (shape, base, codes) in (shapes(), 1_usize..20).prop_flat_map(|(shape, rows)| (Just(shape), grid(shape, rows), grid(shape, rows)))
        ) {
            let mut decoded = vec![0; codes.len()];
            decode(shape, &encode(shape, &codes, None), &mut decoded).unwrap();
            prop_assert_eq!(&decoded, &codes);
            let mut decoded = base.clone();
            decode(shape, &encode(shape, &codes, Some(&base)), &mut decoded).unwrap();
            prop_assert_eq!(&decoded, &codes);
        }

        #[test]
        fn arbitrary_bytes_decode_or_give_an_error(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
            for shape in [Shape::patch(16), Shape::wind(16, true)] {
                let mut codes = vec![0; shape.planes * 16 * 16];
                if decode(shape, &bytes, &mut codes).is_ok() {
                    prop_assert!(codes.iter().all(|&code| code != i16::MIN));
                }
            }
        }
    }

    #[test]
    fn payloads_of_the_wrong_length_are_rejected() {
        let codes: Vec<i16> = (0..PATCH_LEN).map(|i| ((i * 7919) % 255) as i16 - 127).collect();
        let whole = encode(PATCH, &codes, None);
        for length in [0, whole.len() / 2, whole.len() + 1, whole.len() + 3] {
            let mut payload = whole.clone();
            payload.resize(length, 0);
            assert!(decode(PATCH, &payload, &mut vec![0; codes.len()]).is_err(), "{length} of {} bytes", whole.len());
        }
    }

    #[test]
    fn the_number_of_codes_tells_the_shape_of_a_patch() {
        for cells in (8..=256).step_by(8) {
            for shape in [Shape::patch(cells), Shape::snowy_patch(cells)] {
                assert_eq!(Shape::of_patch(shape.planes * cells * cells), shape);
            }
        }
    }

    #[test]
    fn an_unchanged_patch_costs_a_few_bytes() {
        let codes = vec![17; PATCH_LEN];
        let payload = encode(PATCH, &codes, Some(&codes));
        assert!(payload.len() <= 16, "{} bytes", payload.len());
    }

    #[test]
    fn smooth_motion_costs_under_a_bit_and_a_half_per_value() {
        let wave = |phase: f32| -> Vec<i16> {
            (0..PATCH_LEN)
                .map(|i| {
                    let (x, y) = ((i % 64) as f32, (i / 64 % 64) as f32);
                    (40.0 * ((x * 0.11 + phase).sin() * (y * 0.07).cos())) as i16
                })
                .collect()
        };
        let payload = encode(PATCH, &wave(0.1), Some(&wave(0.0)));
        let bits_per_value = payload.len() as f32 * 8.0 / (PATCH_LEN) as f32;
        assert!(bits_per_value < 1.5, "{bits_per_value} bits");
    }

    #[test]
    fn an_extra_plane_does_not_raise_the_cost_of_the_others() {
        let three: Vec<i16> = (0..PATCH_LEN).map(|i| ((i % 64) as i16 - 32) / 5).collect();
        let four = [three.as_slice(), &[0; 64 * 64]].concat();
        let [without, with] = [encode(PATCH, &three, None).len(), encode(Shape::wind(64, true), &four, None).len()];
        assert!(with <= without + 4, "clear air costs {} bytes", with - without);
    }
}
