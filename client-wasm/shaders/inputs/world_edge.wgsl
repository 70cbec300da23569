// Edge of the world.

import package::inputs::frame::frame;

// Whether positions beyond the edge of the world occur. Fixed at pipeline creation, like all overrides, since software drivers execute both
// sides of a branch.
override reaches_beyond: bool = true;

// Distance of a position beyond the edge of the world, 0 inside it.
fn metres_outside(p: vec2<f32>) -> f32 {
    if !reaches_beyond {
        return 0.0;
    }
    return length(max(max(-p, p - frame.world_extent_m), vec2<f32>(0.0)));
}
