//! Which grass grid is drawn how (000 §4.1 and §5.2).

/// Plants along one side of a billboard, l' of 000 Eq. (8), for a grid `g` grids away from the camera's
/// (Chebyshev distance, at least 1): `l·2^⌊log₂ g⌋ + 1` with l = 2.
///
/// ```
/// use shared::lod::billboard_plants;
/// assert_eq!(billboard_plants(3), 5);
/// assert_eq!(billboard_plants(5), 9);
/// ```
pub fn billboard_plants(grids_away: u32) -> u32 {
    (2 << grids_away.max(1).ilog2()) + 1
}

/// Billboards along one side of a grid with `plants` plants a side, n' of 000 Eq. (9): `⌈(n − 1)/(l' − 1)⌉`.
///
/// ```
/// use shared::lod::billboards_per_side;
/// assert_eq!(billboards_per_side(32, 3), 8);
/// assert_eq!(billboards_per_side(32, 5), 4);
/// ```
pub fn billboards_per_side(plants: u32, grids_away: u32) -> u32 {
    (plants.max(2) - 1).div_ceil(billboard_plants(grids_away) - 1)
}

/// Share of a grid that is drawn as single plants, the rest as billboards, while the camera's transition sphere touches
/// the grid's border (000 §6.1): 0 when the border is `radius_m` away or more, 1 when it is reached.
pub fn fade(border_distance_m: f32, radius_m: f32) -> f32 {
    (1.0 - border_distance_m / radius_m).clamp(0.0, 1.0)
}
