//! Static deflection of a blade under drag: the leans of its links in equilibrium, after the elastica.
//!
//! # Small loads
//! The joints at 0, 1/3 and 2/3 of the length have the rotational stiffnesses 8, 8/3 and 8/3·EI/L: Simpson's 3/8 rule, by which the tip of a
//! cantilever under even loads and forces on the control points is exact.
//!
//! # Large loads
//! An even wind of u m/s holds the mean lean κu² of the bend field at any speed, with κ the lean per squared wind. So drag counts as the force that
//! this lean takes: `A·d·f·EI/L²` at a control point with a drag of d rad, where A is its silhouette. f is the load at which the elastica with the
//! blade's silhouette has the mean lean m that linear theory gives the drag, over the load of linear theory: 1.15, 1.97 and 3.13 for an m of 0.5, 1
//! and 1.2 rad.
//!
//! Two terms follow the elastica's shape. As a blade lies down, its upper links find no more load across them and its bend moves to the root; and
//! of an excess of drag on the upper links, less arrives. With both, the tip is within 1 % of the length of the elastica's up to a mean lean of
//! 1.2 rad, under a force at the tip, even drag, drag as the blade's silhouette and drag that grows with height; the control points
//! are within 3.7 %. Without them the tip is off by up to 2 % in even wind and 14 % under a force at the tip. Small deflections are exact.

use super::{LINKS, Leans};

/// Forces on the control points (EI/L²) that hold a mean lean of 1 rad in linear theory: as their silhouettes, 1 : 0.8 : 0.3, since a blade tapers.
pub const SILHOUETTES: [f32; LINKS] = [3.636_363_6, 2.909_091, 1.090_909_1];

/// Lean of each link (row) per unit of drag on each control point, for small loads. A drag of 1 at all three gives a mean lean of 1.
pub const DRAG_LEANS: [[f32; LINKS]; LINKS] =
    [[0.151_515_15, 0.242_424_24, 0.136_363_64], [0.151_515_15, 0.606_060_6, 0.409_090_9], [0.151_515_15, 0.606_060_6, 0.545_454_56]];

/// Relative lean of each link in a steady light wind, with a mean of 1: the row sums of [`DRAG_LEANS`].
pub const WIND_SHAPE: [f32; LINKS] = [0.530_303, 1.166_666_7, 1.303_030_3];

/// Mean lean of the links per unit of drag on each control point: the means of the columns of [`DRAG_LEANS`].
pub const MEAN_LEAN: [f32; LINKS] = [0.151_515_15, 0.484_848_48, 0.363_636_37];

/// Lean of the topmost link beyond that in an even wind of the same mean lean, per unit of drag on each control point.
pub const EXCESS_LEAN: [f32; LINKS] = [-0.045_913_68, -0.025_711_663, 0.071_625_344];

/// Leans that the links of a blade gain as it lies down, per mean lean; their mean is 0. Fitted to the elastica, as are the next three.
pub const LAID_LEANS: [f32; LINKS] = [0.18, 0.18, -0.36];

/// Fourth power of the mean lean (rad⁴) at which half of these leans are gained.
pub const LAID_RAD4: f32 = 4.0;

/// Leans that the links lose as a blade lies down, per excess of the topmost link and square of the mean lean (1/rad²).
pub const LOST_LEANS: [f32; LINKS] = [-1.0, 4.0, 3.0];

/// Inverse square of the mean lean (1/rad²) at which they are half of their proportion.
pub const LOST_PER_RAD2: f32 = 4.0;

/// Leans of the links (rad) in equilibrium with drag. `drag_rad` is the drag on each control point as the mean lean that it would hold on all three.
#[inline(always)]
pub fn deflection(drag_rad: &Leans) -> Leans {
    let mean_rad = [weighted(&MEAN_LEAN, drag_rad, 0), weighted(&MEAN_LEAN, drag_rad, 1)];
    let rad2 = mean_rad[0] * mean_rad[0] + mean_rad[1] * mean_rad[1];
    let laid = rad2 * rad2 / (LAID_RAD4 + rad2 * rad2);
    let lost = rad2 / (1.0 + LOST_PER_RAD2 * rad2);
    let gained_rad = [laid * mean_rad[0], laid * mean_rad[1]];
    let lost_rad = [lost * weighted(&EXCESS_LEAN, drag_rad, 0), lost * weighted(&EXCESS_LEAN, drag_rad, 1)];
    let lean = |link: usize, axis: usize| {
        weighted(&DRAG_LEANS[link], drag_rad, axis) + LAID_LEANS[link] * gained_rad[axis] - LOST_LEANS[link] * lost_rad[axis]
    };
    // Written out, as in `advance`.
    [[lean(0, 0), lean(0, 1)], [lean(1, 0), lean(1, 1)], [lean(2, 0), lean(2, 1)]]
}

#[inline(always)]
fn weighted(weights: &[f32; LINKS], drag_rad: &Leans, axis: usize) -> f32 {
    weights[0] * drag_rad[0][axis] + weights[1] * drag_rad[1][axis] + weights[2] * drag_rad[2][axis]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Inverse stiffness of the joints over L/EI: the weights of Simpson's 3/8 rule.
    const YIELDS: [f64; LINKS] = [1.0 / 8.0, 3.0 / 8.0, 3.0 / 8.0];

    /// Lean of a link per force on a control point, in units of EI and L.
    fn flexibility(link: usize, point: usize) -> f64 {
        (0..=link.min(point)).map(|joint| YIELDS[joint] * (point + 1 - joint) as f64 / LINKS as f64).sum()
    }

    #[test]
    fn small_leans_are_those_of_a_cantilever_by_simpsons_rule() {
        // Deflection of a cantilever's tip: force at the tip, even load.
        for (forces, exact) in [([0.0, 0.0, 1.0], 1.0 / 3.0), ([1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0], 1.0 / 8.0)] {
            let tip = (0..LINKS).flat_map(|link| (0..LINKS).map(move |point| (link, point)));
            let found: f64 = tip.map(|(link, point)| flexibility(link, point) * forces[point] / LINKS as f64).sum();
            assert!((found - exact).abs() < 1e-12, "{found} for {exact}");
        }
        assert!((SILHOUETTES[1] / SILHOUETTES[0] - 0.8).abs() < 1e-6 && (SILHOUETTES[2] / SILHOUETTES[0] - 0.3).abs() < 1e-6);
        for (link, row) in DRAG_LEANS.iter().enumerate() {
            for (point, (&lean, force)) in row.iter().zip(SILHOUETTES).enumerate() {
                assert!((f64::from(lean) - flexibility(link, point) * f64::from(force)).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn weights_follow_from_the_leans() {
        for (lean, row) in WIND_SHAPE.iter().zip(DRAG_LEANS) {
            assert!((lean - row.iter().sum::<f32>()).abs() < 1e-6);
        }
        for point in 0..LINKS {
            let mean = DRAG_LEANS.iter().map(|row| row[point]).sum::<f32>() / LINKS as f32;
            assert!((MEAN_LEAN[point] - mean).abs() < 1e-6);
            assert!((EXCESS_LEAN[point] - (DRAG_LEANS[2][point] - WIND_SHAPE[2] * mean)).abs() < 1e-6);
        }
        assert!((MEAN_LEAN.iter().sum::<f32>() - 1.0).abs() < 1e-6 && EXCESS_LEAN.iter().sum::<f32>().abs() < 1e-6);
    }

    proptest! {
        #[test]
        fn an_even_wind_holds_its_mean_lean_at_any_speed(x in -3.0_f32..3.0, z in -3.0_f32..3.0) {
            let leans = deflection(&[[x, z]; LINKS]);
            for (axis, wanted) in [x, z].into_iter().enumerate() {
                let mean = leans.iter().map(|lean| lean[axis]).sum::<f32>() / LINKS as f32;
                prop_assert!((mean - wanted).abs() < 2e-6, "{mean} for {wanted}");
            }
        }

        #[test]
        fn a_turned_wind_turns_the_deflection(drag in [[-2.0_f32..2.0, -2.0_f32..2.0], [-2.0_f32..2.0, -2.0_f32..2.0], [-2.0_f32..2.0, -2.0_f32..2.0]]) {
            let turned = |leans: Leans| leans.map(|[x, z]| [0.6 * x - 0.8 * z, 0.8 * x + 0.6 * z]);
            let (found, wanted) = (deflection(&turned(drag)), turned(deflection(&drag)));
            for (found, wanted) in found.as_flattened().iter().zip(wanted.as_flattened()) {
                prop_assert!((found - wanted).abs() < 1e-5, "{found} for {wanted}");
            }
        }
    }
}
