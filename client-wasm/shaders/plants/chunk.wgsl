// Chunks of far plants.

// Up to 64 plants of a grid.
struct Chunk {
    // Position in the plane of grids (x, z).
    grid: vec2<i32>,
    // Index of the first plant in the grid.
    first: u32,
    // Number of plants in the grid.
    grid_plants: u32,
}
