//! Levels of detail of grass grids (Zhang §§4.1 and 5.2), their drawing order (Zhang §5.4), delay of a plant's segments (Chen & Johan §4.5), and tilt
//! of shells (Bakay §3.2).

mod lag;
mod order;
pub mod shells;

pub use lag::{Lag, PASTS, history_weights, joints_m};
pub use order::{GridSection, far_to_near};

/// Plants along one side of a billboard, l' of Zhang Eq. (8), for a grid `g` grids away from the camera's (Chebyshev distance, at least 1):
/// `l·2^⌊log₂ g⌋ + 1` with l = 2.
///
/// ```
/// use prairie_core::lod::billboard_plants;
/// assert_eq!(billboard_plants(3), 5);
/// assert_eq!(billboard_plants(5), 9);
/// ```
pub fn billboard_plants(grids_away: u32) -> u32 {
    (2 << grids_away.max(1).ilog2()) + 1
}

/// Billboards along one side of a grid with `plants` plants a side, n' of Zhang Eq. (9): `⌈(n − 1)/(l' − 1)⌉`.
///
/// ```
/// use prairie_core::lod::billboards_per_side;
/// assert_eq!(billboards_per_side(32, 3), 8);
/// assert_eq!(billboards_per_side(32, 5), 4);
/// ```
pub fn billboards_per_side(plants: u32, grids_away: u32) -> u32 {
    (plants.max(2) - 1).div_ceil(billboard_plants(grids_away) - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_of_zhang_section_5_2() {
        let table = [(1, 3, 16), (2, 5, 8), (3, 5, 8), (4, 9, 4), (7, 9, 4), (8, 17, 2), (15, 17, 2), (16, 33, 1)];
        for (grids_away, plants, per_side) in table {
            assert_eq!((billboard_plants(grids_away), billboards_per_side(32, grids_away)), (plants, per_side));
        }
    }
}
