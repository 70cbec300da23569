//! The six kinds of flowers, for the shader that draws their petals and for the textures of flowers.

/// Number of kinds.
pub(crate) const FLOWER_KINDS: usize = 6;
/// Number of petals of each kind.
pub(crate) const FLOWER_PETALS: [f32; FLOWER_KINDS] = [12.0, 5.0, 9.0, 5.0, 12.0, 6.0];
/// Their length (m).
pub(crate) const FLOWER_PETAL_M: [f32; FLOWER_KINDS] = [0.026, 0.030, 0.024, 0.018, 0.022, 0.026];
/// Their width relative to the length.
pub(crate) const FLOWER_PETAL_WIDTH: [f32; FLOWER_KINDS] = [0.34, 1.05, 0.50, 0.95, 0.30, 0.55];
/// Angle by which they rise (rad).
pub(crate) const FLOWER_RISE_RAD: [f32; FLOWER_KINDS] = [0.18, 0.75, 0.45, 0.55, 1.05, 0.30];
/// Radius of the disc (m).
pub(crate) const FLOWER_DISC_M: [f32; FLOWER_KINDS] = [0.010, 0.008, 0.009, 0.007, 0.012, 0.006];
/// Linear colour of the petals at the base.
pub(crate) const FLOWER_BASE_RGB: [[f32; 3]; FLOWER_KINDS] =
    [[0.80, 0.80, 0.76], [0.28, 0.015, 0.01], [0.09, 0.08, 0.42], [0.90, 0.58, 0.02], [0.62, 0.20, 0.46], [0.46, 0.28, 0.72]];
/// Linear colour of the petals at the tip.
pub(crate) const FLOWER_TIP_RGB: [[f32; 3]; FLOWER_KINDS] =
    [[0.95, 0.95, 0.93], [0.86, 0.075, 0.02], [0.16, 0.25, 0.88], [0.98, 0.80, 0.06], [0.84, 0.46, 0.72], [0.70, 0.56, 0.92]];
/// Linear colour of the disc.
pub(crate) const FLOWER_DISC_RGB: [[f32; 3]; FLOWER_KINDS] =
    [[0.85, 0.52, 0.03], [0.03, 0.02, 0.02], [0.18, 0.05, 0.30], [0.75, 0.55, 0.05], [0.66, 0.30, 0.50], [0.85, 0.70, 0.20]];

/// Position along a petal of each of its vertices.
pub(crate) const PETAL_ALONG: [f32; 5] = [0.0, 0.55, 0.55, 1.0, 1.0];
/// Position across it, relative to its width.
pub(crate) const PETAL_ACROSS: [f32; 5] = [0.0, -0.5, 0.5, -0.28, 0.28];
/// Fraction of its rise that a petal loses to its tip.
pub(crate) const PETAL_FLATTENS: f32 = 0.45;

/// Side of the square of a textured flower, relative to the length of its petals.
pub(crate) const FLOWER_SQUARE: f32 = 2.2;
