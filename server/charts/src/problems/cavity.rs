//! The lid-driven cavity.

use crate::norms::Norms;

/// Velocity at seventeen positions along a centreline, both ends included.
pub type Centreline = [(f64, f64); 17];

/// Published velocities of the steady flow in a square whose lid slides, with side and lid speed 1: the lid is y = 1 and moves towards positive x.
///
/// Positions are as printed, to four digits. Ghia, Ghia & Shin's are nodes of their grid of 129 × 129, multiples of 1/128.
#[derive(Clone, Copy, Debug)]
pub struct Cavity {
    /// Lid speed · side / viscosity.
    pub reynolds: f64,
    /// (y, u) on x = 1/2: the velocity along the lid, up the vertical centreline.
    pub vertical: Centreline,
    /// (x, v) on y = 1/2: the velocity towards the lid, along the horizontal centreline.
    pub horizontal: Centreline,
}

impl Cavity {
    /// Norms of the differences from the table of u(y) on x = 1/2 and v(x) on y = 1/2, relative to the lid speed.
    pub fn compare(&self, u_at: impl Fn(f64) -> f64, v_at: impl Fn(f64) -> f64) -> [Norms; 2] {
        let vertical = self.vertical.iter().map(|&(y, u)| (u_at(y), u));
        let horizontal = self.horizontal.iter().map(|&(x, v)| (v_at(x), v));
        [Norms::of(vertical), Norms::of(horizontal)]
    }
}

/// Ghia et al. 1982, tables I and II, Re = 100.
///
/// The table's own error: a second-order stream-function solution, extrapolated from 129 × 129 and 257 × 257 nodes, is 0.24 % (u) and 0.48 % (v) of the
/// lid speed away in root mean square. u(0.0703) = −0.04775 looks like a misprint: that solution has −0.0466, and agrees with the neighbouring values to 1e-4.
#[rustfmt::skip]
pub const GHIA_RE_100: Cavity = Cavity {
    reynolds: 100.0,
    vertical: [
        (0.0000, 0.00000), (0.0547, -0.03717), (0.0625, -0.04192), (0.0703, -0.04775), (0.1016, -0.06434), (0.1719, -0.10150),
        (0.2813, -0.15662), (0.4531, -0.21090), (0.5000, -0.20581), (0.6172, -0.13641), (0.7344, 0.00332), (0.8516, 0.23151),
        (0.9531, 0.68717), (0.9609, 0.73722), (0.9688, 0.78871), (0.9766, 0.84123), (1.0000, 1.00000),
    ],
    horizontal: [
        (0.0000, 0.00000), (0.0625, 0.09233), (0.0703, 0.10091), (0.0781, 0.10890), (0.0938, 0.12317), (0.1563, 0.16077),
        (0.2266, 0.17507), (0.2344, 0.17527), (0.5000, 0.05454), (0.8047, -0.24533), (0.8594, -0.22445), (0.9063, -0.16914),
        (0.9453, -0.10313), (0.9531, -0.08864), (0.9609, -0.07391), (0.9688, -0.05906), (1.0000, 0.00000),
    ],
};

/// Ghia et al. 1982, tables I and II, Re = 1000.
///
/// Some copies have −0.31996 for v(0.8047); most have −0.31966, as here, close to the −0.32021 of [`BOTELLA_PEYRET_RE_1000`]. The table's own error is
/// up to 1.85 % of the lid speed near the right wall: 0.35 % (u) and 0.94 % (v) in root mean square against the spectral solution. A perfect solver
/// differs from the table by as much.
#[rustfmt::skip]
pub const GHIA_RE_1000: Cavity = Cavity {
    reynolds: 1000.0,
    vertical: [
        (0.0000, 0.00000), (0.0547, -0.18109), (0.0625, -0.20196), (0.0703, -0.22220), (0.1016, -0.29730), (0.1719, -0.38289),
        (0.2813, -0.27805), (0.4531, -0.10648), (0.5000, -0.06080), (0.6172, 0.05702), (0.7344, 0.18719), (0.8516, 0.33304),
        (0.9531, 0.46604), (0.9609, 0.51117), (0.9688, 0.57492), (0.9766, 0.65928), (1.0000, 1.00000),
    ],
    horizontal: [
        (0.0000, 0.00000), (0.0625, 0.27485), (0.0703, 0.29012), (0.0781, 0.30353), (0.0938, 0.32627), (0.1563, 0.37095),
        (0.2266, 0.33075), (0.2344, 0.32235), (0.5000, 0.02526), (0.8047, -0.31966), (0.8594, -0.42665), (0.9063, -0.51550),
        (0.9453, -0.39188), (0.9531, -0.33714), (0.9609, -0.27669), (0.9688, -0.21388), (1.0000, 0.00000),
    ],
};

/// Botella & Peyret 1998, tables 9 and 10, Re = 1000: a spectral solution, with the corner singularities subtracted, to seven
/// digits. Their lid moves towards negative x; mirrored here.
#[rustfmt::skip]
pub const BOTELLA_PEYRET_RE_1000: Cavity = Cavity {
    reynolds: 1000.0,
    vertical: [
        (0.0000, 0.0000000), (0.0547, -0.1812881), (0.0625, -0.2023300), (0.0703, -0.2228955), (0.1016, -0.3004561),
        (0.1719, -0.3885691), (0.2813, -0.2803696), (0.4531, -0.1081999), (0.5000, -0.0620561), (0.6172, 0.0570178),
        (0.7344, 0.1886747), (0.8516, 0.3372212), (0.9531, 0.4723329), (0.9609, 0.5169277), (0.9688, 0.5808359),
        (0.9766, 0.6644227), (1.0000, 1.0000000),
    ],
    horizontal: [
        (0.0000, 0.0000000), (0.0625, 0.2807056), (0.0703, 0.2962703), (0.0781, 0.3099097), (0.0938, 0.3330442),
        (0.1563, 0.3769189), (0.2266, 0.3339924), (0.2344, 0.3253592), (0.5000, 0.0257995), (0.8047, -0.3202137),
        (0.8594, -0.4264545), (0.9063, -0.5264392), (0.9453, -0.4103754), (0.9531, -0.3553213), (0.9609, -0.2936869),
        (0.9688, -0.2279225), (1.0000, 0.0000000),
    ],
};

#[cfg(test)]
mod tests {
    use super::*;

    const TABLES: [Cavity; 3] = [GHIA_RE_100, GHIA_RE_1000, BOTELLA_PEYRET_RE_1000];

    #[test]
    fn the_tables_begin_and_end_on_the_walls_and_rise_between() {
        for cavity in TABLES {
            assert_eq!([cavity.vertical[0], cavity.vertical[16]], [(0.0, 0.0), (1.0, 1.0)]);
            assert_eq!([cavity.horizontal[0], cavity.horizontal[16]], [(0.0, 0.0), (1.0, 0.0)]);
            for line in [cavity.vertical, cavity.horizontal] {
                assert!(line.windows(2).all(|pair| pair[0].0 < pair[1].0), "{line:?}");
                assert!(line.contains(&(0.5, line[8].1)), "the middle is missing: {line:?}");
            }
        }
    }

    #[test]
    fn positions_are_nodes_of_a_grid_of_129() {
        for cavity in TABLES {
            for (place, _) in cavity.vertical.into_iter().chain(cavity.horizontal) {
                let node = (place * 128.0).round() / 128.0;
                assert!((place - node).abs() <= 0.51e-4, "{place} is not a multiple of 1/128");
            }
        }
    }

    /// The net flow across a centreline is zero; a misprint in one of the few positions would change the integral.
    #[test]
    fn the_net_flow_across_each_centreline_is_zero() {
        for cavity in TABLES {
            for line in [cavity.vertical, cavity.horizontal] {
                let through: f64 = line.windows(2).map(|w| 0.5 * (w[0].1 + w[1].1) * (w[1].0 - w[0].0)).sum();
                let moved: f64 = line.windows(2).map(|w| 0.5 * (w[0].1 + w[1].1).abs() * (w[1].0 - w[0].0)).sum();
                assert!(through.abs() < 0.1 * moved, "Re {}: {through} of {moved}", cavity.reynolds);
            }
        }
    }

    #[test]
    fn the_tables_differ_by_their_documented_errors() {
        let (a, b) = (GHIA_RE_1000, BOTELLA_PEYRET_RE_1000);
        let at = |line: Centreline| move |place: f64| line.iter().find(|point| point.0 == place).expect("the same places").1;
        let [u, v] = a.compare(at(b.vertical), at(b.horizontal));
        assert!((u.l2 - 0.0035).abs() < 5e-5 && (v.l2 - 0.0094).abs() < 5e-5, "{u:?} {v:?}");
        assert!((v.linf - 0.0185).abs() < 5e-5, "{v:?}");
        assert_eq!(a.compare(at(a.vertical), at(a.horizontal)).map(|norms| norms.linf), [0.0; 2]);
    }
}
