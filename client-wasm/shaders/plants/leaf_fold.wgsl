// Shade of the fold of a leaf of the underbrush.

// A leaf is folded along its middle: one half lighter than the other, the rib darker. `across` is -1 at the left border and 1 at the right one.
fn fold(across: f32) -> f32 {
    return 1.0 + 0.10 * across - 0.18 * (1.0 - smoothstep(0.0, 0.25, abs(across)));
}

// Mean of `fold` over the width of a leaf.
const FOLD_MEAN: f32 = 0.9775;
