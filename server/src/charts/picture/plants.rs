//! Frame time against the plants of the scene, which grow in number with the world: plants out of view should cost nothing.

use anyhow::Result;
use prairie_client::render::Gpu;

use super::sweep::{Sweep, qualities, sweep};
use crate::charts::worlds::{flat_meadow, on_foot};
use prairie_charts::figure::Drawn;

/// Sides of the worlds (m), with 16 plant sites per square metre: 1 k to 10 M sites.
const SIDES_M: [u32; 5] = [8, 24, 80, 256, 800];
const QUICK_SIDES_M: [u32; 3] = [8, 40, 160];

pub(super) fn draw(quick: bool, caption: &str) -> Result<Drawn> {
    let gpu = Gpu::headless()?;
    let sides_m: &[u32] = if quick { &QUICK_SIDES_M } else { &SIDES_M };
    let mut found = Sweep::default();
    for &side_m in sides_m {
        let (mut mirror, plants) = flat_meadow(side_m)?;
        for quality in qualities(quick) {
            found.time(&gpu, quick, *quality, plants, &mut mirror, &on_foot(side_m));
        }
    }
    sweep(&found, "Frame time against the plants of the scene", "plant sites in the scene", quick, caption, &gpu)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn worlds_hold_from_a_thousand_to_ten_million_plants() {
        let counts = SIDES_M.map(|side_m| flat_meadow(side_m).unwrap().1);
        assert!(counts[0] < 1.1e3 && counts[4] > 1e7, "{counts:?}");
    }
}
