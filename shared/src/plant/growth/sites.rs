//! Plant sites: one in each square of a lattice, at a random position within it.

use super::Lot;
use super::disc::Disc;
use crate::hash::hash3;

/// Largest number of sites that [`Sites`] accepts; four times the limit of a scene.
pub const SITES_LIMIT: usize = 1 << 24;

/// Steps along the side of a square: positions of sites are multiples, so that distances are exact.
pub(super) const STEPS: i64 = 256;

/// Lattice of squares over the world, each with one site. Sites are numbered row by row from the north-west; 2 bytes each.
#[derive(Clone, Debug, PartialEq)]
pub struct Sites {
    count: [u32; 2],
    spacing_m: f32,
    seed: u64,
    /// Position within the square (steps).
    offsets: Vec<[u8; 2]>,
}

impl Sites {
    /// The sites of a world of `extent_m` (m, X and Z), `spacing_m` apart. If the last squares are partly outside the world, their sites may be, too.
    ///
    /// # Panics
    /// When an extent or the spacing is not positive, or there are more than [`SITES_LIMIT`] sites.
    pub fn new(extent_m: [f32; 2], spacing_m: f32, seed: u64) -> Self {
        let count = extent_m.map(|m| (f64::from(m) / f64::from(spacing_m)).ceil());
        let total = count[0] * count[1];
        assert!(spacing_m > 0.0 && (1.0..=SITES_LIMIT as f64).contains(&total), "{} × {} sites", count[0], count[1]);
        let [columns, rows] = count.map(|n| n as u32);
        let seed_of_place = Lot::Place.seed(seed);
        let offset = |site: u32| {
            let [x, z, _] = hash3([site % columns, site / columns, seed_of_place]);
            [(x >> 24) as u8, (z >> 24) as u8]
        };
        Self { count: [columns, rows], spacing_m, seed, offsets: (0..columns * rows).map(offset).collect() }
    }

    /// Number of sites along X and Z.
    pub fn count(&self) -> [u32; 2] {
        self.count
    }

    /// Number of sites.
    pub fn total(&self) -> usize {
        self.offsets.len()
    }

    /// Side of a square (m).
    pub fn spacing_m(&self) -> f32 {
        self.spacing_m
    }

    /// Seed of the scene.
    pub(super) fn seed(&self) -> u64 {
        self.seed
    }

    /// Position of a site (m, X and Z).
    ///
    /// # Panics
    /// When there is no such site.
    pub fn place_m(&self, site: u32) -> [f32; 2] {
        self.point(site as usize).map(|steps| (self.metres(steps as f64)) as f32)
    }

    /// Column and row of the square at a position (m, X and Z); outside the lattice the count continues.
    pub(super) fn square_at(&self, at_m: [f32; 2]) -> [i64; 2] {
        at_m.map(|m| (f64::from(m) / f64::from(self.spacing_m)).floor() as i64)
    }

    /// A length in steps.
    pub(super) fn steps(&self, length_m: f64) -> f64 {
        length_m / f64::from(self.spacing_m) * STEPS as f64
    }

    /// A length in metres.
    pub(super) fn metres(&self, steps: f64) -> f64 {
        steps / STEPS as f64 * f64::from(self.spacing_m)
    }

    /// Column and row of a site.
    pub(super) fn square(&self, site: usize) -> [i64; 2] {
        let (site, columns) = (site as u32, self.count[0]);
        [i64::from(site % columns), i64::from(site / columns)]
    }

    /// The site in a square, if it is in the lattice.
    pub(super) fn site(&self, [column, row]: [i64; 2]) -> Option<usize> {
        let [columns, rows] = self.count.map(i64::from);
        let is_inside = (0..columns).contains(&column) && (0..rows).contains(&row);
        is_inside.then_some((column + row * columns) as usize)
    }

    /// Position of a site (steps).
    pub(super) fn point(&self, site: usize) -> [i64; 2] {
        let ([column, row], [x, z]) = (self.square(site), self.offsets[site]);
        [column * STEPS + i64::from(x), row * STEPS + i64::from(z)]
    }

    /// Squared distance between two sites (steps²).
    pub(super) fn distance2(&self, one: usize, other: usize) -> i64 {
        let ([x, z], [other_x, other_z]) = (self.point(one), self.point(other));
        (x - other_x) * (x - other_x) + (z - other_z) * (z - other_z)
    }

    /// Sites in a disc about a site, including itself, row by row, with their squared distance (steps²).
    pub(super) fn within<'a>(&'a self, disc: &'a Disc, center: usize) -> impl Iterator<Item = (usize, i64)> + 'a {
        let ([column, row], [x, z]) = (self.square(center), self.point(center));
        let [columns, rows] = self.count.map(i64::from);
        let reach = disc.rows();
        ((row - reach).max(0)..=(row + reach).min(rows - 1)).flat_map(move |other_row| {
            let half = disc.half_width(other_row - row);
            let (first, last) = ((column - half).max(0), (column + half).min(columns - 1));
            (first..=last).filter_map(move |other_column| {
                let site = (other_column + other_row * columns) as usize;
                let [dx, dz] = self.offsets[site].map(i64::from);
                let (dx, dz) = (other_column * STEPS + dx - x, other_row * STEPS + dz - z);
                let distance2 = dx * dx + dz * dz;
                (distance2 < disc.radius2()).then_some((site, distance2))
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn each_site_lies_in_its_square_and_all_parts_of_it_are_taken() {
        let sites = Sites::new([40.0, 25.0], 0.5, 9);
        assert_eq!((sites.count(), sites.total()), ([80, 50], 4000));
        let mut mean = [0.0; 2];
        for site in 0..4000_u32 {
            let at_m = sites.place_m(site);
            assert_eq!(sites.site(sites.square_at(at_m)), Some(site as usize));
            let within = [0, 1].map(|axis| at_m[axis] / 0.5 - (at_m[axis] / 0.5).floor());
            mean = [0, 1].map(|axis| mean[axis] + within[axis] / 4000.0);
        }
        assert!(mean.iter().all(|mean| (mean - 0.5).abs() < 0.02), "{mean:?}");
        assert_eq!(sites.site([80, 0]).or(sites.site([0, -1])), None);
    }

    #[test]
    fn a_disc_ends_at_the_next_whole_square() {
        assert_eq!([0.0, 2.5, 3.0].map(super::super::disc::square_steps), [1, 7, 9]);
    }

    #[test]
    fn a_spacing_that_does_not_divide_the_world_covers_it() {
        assert_eq!(Sites::new([10.0, 0.2], 0.3, 1).count(), [34, 1]);
    }

    proptest! {
        #[test]
        fn a_disc_holds_the_sites_within_its_radius(center in 0_usize..24 * 16, radius in 1.0_f64..2500.0) {
            let sites = Sites::new([12.0, 8.0], 0.5, 4);
            let disc = Disc::new(radius);
            let mut found: Vec<_> = sites.within(&disc, center).collect();
            found.sort_unstable();
            let all = (0..sites.total()).map(|site| (site, sites.distance2(center, site)));
            let expected: Vec<_> = all.filter(|&(_, distance2)| (distance2 as f64) < radius * radius).collect();
            prop_assert_eq!(found, expected);
        }
    }
}
