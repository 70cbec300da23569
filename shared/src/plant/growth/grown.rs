//! The grown plants, and queries for them.

use super::{Sites, Soil};

/// A plant of the underbrush, at the position of its [site](Sites::place_m).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plant {
    /// Number of its site.
    pub site: u32,
    /// Index of its species.
    pub species: u8,
    /// Nutrition: 255 if it got all that it takes up, 0 if it got nothing of its scarcest nutrient.
    pub vigour: u8,
}

/// Plants of a world, and the soil that they left. 8 bytes a plant in addition to the sites and the soil (8 bytes a site).
#[derive(Clone, Debug, PartialEq)]
pub struct Grown {
    /// The sites of plants.
    pub sites: Sites,
    /// The soil after all plants have taken up nutrients.
    pub soil: Soil,
    /// Total uptake of each nutrient by all plants, in the unit of [`Soil`].
    pub taken: [u64; 3],
    plants: Vec<Plant>,
    /// Index of the first plant in each row of sites, then the number of plants.
    row_starts: Vec<u32>,
}

impl Grown {
    pub(super) fn new(sites: Sites, soil: Soil, taken: [u64; 3], mut plants: Vec<Plant>) -> Self {
        plants.sort_unstable_by_key(|plant| plant.site);
        let [columns, rows] = sites.count();
        let row_start = |row: u32| plants.partition_point(|plant| plant.site < row * columns) as u32;
        let row_starts = (0..=rows).map(row_start).collect();
        Self { sites, soil, taken, plants, row_starts }
    }

    /// All plants, ascending by site.
    pub fn plants(&self) -> &[Plant] {
        &self.plants
    }

    /// The plant at a site, if any.
    pub fn plant_at(&self, site: u32) -> Option<&Plant> {
        let found = self.plants.binary_search_by_key(&site, |plant| plant.site);
        found.ok().map(|index| &self.plants[index])
    }

    /// Plants in the rectangle from `low_m` to before `high_m` (m, X and Z), ascending by site.
    pub fn in_rectangle(&self, low_m: [f32; 2], high_m: [f32; 2]) -> impl Iterator<Item = &Plant> {
        let (low, high) = (self.sites.square_at(low_m), self.sites.square_at(high_m));
        let [columns, rows] = self.sites.count().map(i64::from);
        let (first, last) = (low[0].clamp(0, columns), high[0].clamp(-1, columns - 1));
        let rows = low[1].max(0)..(high[1].saturating_add(1)).min(rows);
        let in_row = move |row: i64| {
            let row_of_plants = &self.plants[self.row_starts[row as usize] as usize..self.row_starts[row as usize + 1] as usize];
            let before = |column: i64| row_of_plants.partition_point(|plant| i64::from(plant.site) < row * columns + column);
            let from = before(first);
            &row_of_plants[from..before(last + 1).max(from)]
        };
        rows.flat_map(in_row).filter(move |plant| {
            let at_m = self.sites.place_m(plant.site);
            (0..2).all(|axis| low_m[axis] <= at_m[axis] && at_m[axis] < high_m[axis])
        })
    }

    /// Plants nearer than `radius_m` to a point (m, X and Z), ascending by site.
    pub fn near(&self, at_m: [f32; 2], radius_m: f32) -> impl Iterator<Item = &Plant> {
        let [low_m, high_m] = [-radius_m, radius_m].map(|reach_m| at_m.map(|m| m + reach_m));
        self.in_rectangle(low_m, high_m).filter(move |plant| {
            let [x_m, z_m] = self.sites.place_m(plant.site);
            let [dx, dz] = [x_m - at_m[0], z_m - at_m[1]];
            dx * dx + dz * dz < radius_m * radius_m
        })
    }
}
