//! Light that snow reflects.

/// Albedo of fresh snow in red, green and blue: high, and slightly higher at short wavelengths (Wiscombe and Warren 1980).
pub const SNOW_ALBEDO: [f32; 3] = [0.86, 0.88, 0.90];
/// Albedo of packed snow, whose grains are larger.
pub const PACKED_SNOW_ALBEDO: [f32; 3] = [0.70, 0.74, 0.79];
