//! General compressors on the frames of θ: zstd, zfp and SZ3.

use anyhow::{Context as _, Result};
use prairie_core::wire::quantise::CodeSteps;
use zfp_rs::{ZfpBitStream, ZfpConfig, ZfpField, ZfpFieldMut, ZfpScalarType};

use super::Sent;
use super::drive::{Frame, Recording, WINDOW_CELLS};

/// Level of zstd: the best below those that need much more memory.
const ZSTD_LEVEL: i32 = 19;

/// θ of the whole window, row by row.
fn window(recording: &Recording, frame: &Frame) -> Vec<f32> {
    let side = recording.layout.cells as usize;
    let mut window = vec![0.0; WINDOW_CELLS * WINDOW_CELLS];
    for (n, patch) in frame.patches.iter().enumerate() {
        let Some([thetas, ..]) = patch else { continue };
        let across = WINDOW_CELLS / side;
        let (x, z) = (n % across * side, n / across * side);
        for (j, row) in thetas.chunks_exact(side).enumerate() {
            window[(z + j) * WINDOW_CELLS + x..][..side].copy_from_slice(row);
        }
    }
    window
}

fn largest_error(found: impl IntoIterator<Item = f32>, wanted: &[f32]) -> f32 {
    found.into_iter().zip(wanted).map(|(found, wanted)| (found - wanted).abs()).fold(0.0, f32::max)
}

/// Differences of the codes from the frame before, frame by frame.
pub(super) fn zstd(recording: &Recording, steps: &CodeSteps) -> Result<Sent> {
    let mut held = vec![0_i16; WINDOW_CELLS * WINDOW_CELLS];
    let mut sent = Sent { bytes: 0, error_rad: 0.0 };
    for frame in &recording.frames {
        let thetas = window(recording, frame);
        let mut codes = vec![0; thetas.len()];
        steps.theta_codes(&thetas, &mut codes);
        // The low bytes, then the high ones.
        let differences = || codes.iter().zip(&held).map(|(code, held)| code.wrapping_sub(*held).to_le_bytes());
        let bytes: Vec<u8> = differences().map(|[low, _]| low).chain(differences().map(|[_, high]| high)).collect();
        sent.bytes += zstd::bulk::compress(&bytes, ZSTD_LEVEL)?.len();
        sent.error_rad = sent.error_rad.max(largest_error(codes.iter().map(|code| steps.theta_rad(*code)), &thetas));
        held = codes;
    }
    Ok(sent)
}

/// Each frame by itself, with a fixed accuracy.
pub(super) fn zfp(recording: &Recording, steps: &CodeSteps) -> Result<Sent> {
    let config = ZfpConfig::fixed_accuracy(f64::from(0.5 * steps.theta_rad));
    let dims = [WINDOW_CELLS; 2];
    let mut sent = Sent { bytes: 0, error_rad: 0.0 };
    for frame in &recording.frames {
        let thetas = window(recording, frame);
        let field = ZfpField::new(&thetas, dims)?;
        let mut stream = ZfpBitStream::new(config.maximum_size(ZfpScalarType::F32, field.dims()).context("the frame is too large")?)?;
        sent.bytes += stream.compress(&config, &field)?;
        stream.rewind();
        let mut found = vec![0.0_f32; thetas.len()];
        stream.decompress(&config, &mut ZfpFieldMut::new(&mut found, dims)?)?;
        sent.error_rad = sent.error_rad.max(largest_error(found, &thetas));
    }
    Ok(sent)
}

/// The whole recording at once, which a stream cannot do: it shows what is left to gain by a better code of the same values.
pub(super) fn sz3(recording: &Recording, steps: &CodeSteps) -> Result<Sent> {
    let thetas: Vec<f32> = recording.frames.iter().flat_map(|frame| window(recording, frame)).collect();
    let data = sz3::DimensionedData::build(&thetas).dim(WINDOW_CELLS)?.dim(WINDOW_CELLS)?.remainder_dim()?;
    let config = sz3::Config::new(sz3::ErrorBound::Absolute(f64::from(0.5 * steps.theta_rad)));
    let compressed = sz3::compress_with_config(&data, &config)?;
    let bytes = compressed.len();
    let (_, found) = sz3::decompress::<f32, _>(compressed)?;
    Ok(Sent { bytes, error_rad: largest_error(found.data().iter().copied(), &thetas) })
}
