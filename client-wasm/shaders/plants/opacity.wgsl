// Opacity of plants.

// Opacity below which a fragment is discarded.
const LEAST_OPACITY: f32 = 0.08;
