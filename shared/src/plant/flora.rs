//! Underbrush of a world: its plants, and how each is built.

use super::growth::{Grown, NutrientMap, Permission, Plant, Sites, Soil, grow};
use super::underbrush::plan::Plan;
use crate::hash::{folded, hash3};
use crate::scene::{Component, Scene, Underbrush};
use crate::terrain::CoverMap;
use std::f32::consts::TAU;

/// Underbrush of a world, the same for everyone who has its scene and maps.
#[derive(Clone, Debug, PartialEq)]
pub struct Flora {
    grown: Grown,
    species: Vec<Underbrush>,
    plans: Vec<Plan>,
    seed: u32,
}

/// Position, size and orientation of one plant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantInstance {
    /// Position on the ground, X and Z (m).
    pub at_m: [f32; 2],
    /// Index of its species.
    pub species: usize,
    /// Size relative to its species: random within `size_variation`, reduced to as little as 0.6 of that where it is badly fed.
    pub size: f32,
    /// Heading of its first turn (rad).
    pub heading_rad: f32,
    /// Number that seeds the random draws of its components.
    pub number: u32,
}

impl Flora {
    /// Grows the underbrush of a scene, with `nutrients` if the soil is a map; `None` if the scene has no underbrush.
    pub fn new(scene: &Scene, cover: &CoverMap, nutrients: Option<&NutrientMap>) -> Option<Self> {
        if scene.underbrush.is_empty() {
            return None;
        }
        let extent_m = scene.extent_m();
        let sites = Sites::new(extent_m, scene.growth.spacing_m, scene.seed);
        let soil = nutrients.map_or_else(|| Soil::generated(&scene.growth, &sites), |map| Soil::of_map(map, &sites, extent_m));
        let species = scene.underbrush.clone();
        let heights_m: Vec<f32> = species.iter().map(height_m).collect();
        let ground = |[x_m, z_m]: [f32; 2]| {
            let cover = cover.at(x_m, z_m, extent_m);
            Permission::new(cover, scene.is_grass(cover), &species)
        };
        let grown = grow(sites, soil, &species, &heights_m, scene.growth.shade, ground);
        let plans = species.iter().map(|species| Plan::new(species, species.posture_nodes())).collect();
        Some(Self { grown, species, plans, seed: folded(scene.seed) })
    }

    /// The plants that grew.
    pub fn grown(&self) -> &Grown {
        &self.grown
    }

    /// The species, in the scene's order.
    pub fn species(&self) -> &[Underbrush] {
        &self.species
    }

    /// Plan of each species, in that order.
    pub fn plans(&self) -> &[Plan] {
        &self.plans
    }

    /// Checksum (FNV-1a) of the site, species, vigour and every bit of the instance of all plants, for server and client to compare.
    pub fn checksum(&self) -> u64 {
        let words = self.grown.plants().iter().flat_map(|plant| {
            let PlantInstance { at_m: [x, z], size, heading_rad, number, .. } = self.instance(plant);
            let kind = u32::from(plant.species) << 8 | u32::from(plant.vigour);
            [plant.site, kind, number].into_iter().chain([x, z, size, heading_rad].map(f32::to_bits))
        });
        words.fold(0xcbf2_9ce4_8422_2325, |sum, word| (sum ^ u64::from(word)).wrapping_mul(0x0100_0000_01b3))
    }

    /// Position, size and orientation of a plant.
    pub fn instance(&self, plant: &Plant) -> PlantInstance {
        let [size, heading, number] = hash3([plant.site, 0x5a, self.seed]);
        let fraction = |random: u32| (random >> 8) as f32 / (1_u32 << 24) as f32;
        let species = usize::from(plant.species);
        let by_lot = 1.0 + self.species[species].size_variation * (2.0 * fraction(size) - 1.0);
        PlantInstance {
            at_m: self.grown.sites.place_m(plant.site),
            species,
            size: by_lot * (0.6 + 0.4 * f32::from(plant.vigour) / 255.0),
            heading_rad: TAU * fraction(heading),
            number,
        }
    }
}

/// Height of a species' unbent plants (m): that of the highest tip if all components have their mean angles and lengths; used for shading. Only `+ −
/// × ÷` and roots, since server and client must agree.
pub fn height_m(species: &Underbrush) -> f32 {
    let mut tips_m: Vec<f32> = Vec::new();
    for (index, component) in species.components.iter().enumerate() {
        let along_m = |below: usize| tips_m[below] - rise_m(&species.components[below]) * (1.0 - component.to_share);
        let foot_m = species.branch_below(index).map_or(0.0, along_m);
        tips_m.push(foot_m + rise_m(component));
    }
    tips_m.into_iter().fold(0.01, f32::max)
}

/// Largest distance of a species' components from their root (m), at any lean: the longest chain of components that carry each other.
pub fn reach_m(species: &Underbrush) -> f32 {
    let mut ways_m: Vec<f32> = Vec::new();
    for (index, component) in species.components.iter().enumerate() {
        let foot_m = species.branch_below(index).map_or(0.0, |below| ways_m[below]);
        ways_m.push(foot_m + component.length_m * (1.0 + component.length_variation) + 0.5 * component.width_m);
    }
    ways_m.into_iter().fold(0.01, f32::max)
}

/// Height of a component's tip above its base (m): its length times the cosine of its angle.
fn rise_m(component: &Component) -> f32 {
    component.length_m * super::blade::lean::direction([component.angle_rad, 0.0])[1]
}

#[cfg(test)]
mod tests {
    use super::super::underbrush::posture::Nodes;
    use super::*;
    use crate::scene::{ComponentKind, parse};
    use crate::terrain::grey_png;

    fn meadow() -> (Scene, CoverMap) {
        let text = "summary = 's'\npatches = { count = [2, 2] }\n[terrain]\nheight_map = 'h.png'\ncovering_map = 'c.png'\npixel_m = [2, 2]\nlevel_m = 0.1\n\
            [[underbrush]]\nname = 'a'\n[[underbrush.components]]\nname = 'leaf'\nkind = 'leaf'\ncount = 3\n";
        (parse(text).unwrap(), CoverMap::from_png(&grey_png([4; 2], &[255; 16])).unwrap())
    }

    #[test]
    fn everyone_finds_the_same_plants() {
        let (scene, cover) = meadow();
        let [one, other] = [(); 2].map(|()| Flora::new(&scene, &cover, None).expect("a scene with underbrush"));
        assert_eq!(one, other);
        let all: Vec<PlantInstance> = one.grown().plants().iter().map(|plant| one.instance(plant)).collect();
        assert!(all.len() > 500, "{} plants", all.len());
        let extent_m = scene.extent_m();
        assert!(all.iter().all(|one| (0..2).all(|axis| (0.0..extent_m[axis]).contains(&one.at_m[axis]))));
        let (low, high) = (0.6 * (1.0 - scene.underbrush[0].size_variation), 1.0 + scene.underbrush[0].size_variation);
        assert!(all.iter().all(|one| (low..=high).contains(&one.size)));
        assert!(Flora::new(&Scene { underbrush: Vec::new(), ..scene }, &cover, None).is_none());
    }

    #[test]
    fn the_checksum_tells_plants_apart() {
        let (scene, cover) = meadow();
        let checksum = |scene: &Scene| Flora::new(scene, &cover, None).expect("a scene with underbrush").checksum();
        let changes: [fn(&mut Scene); 4] = [
            |scene| scene.seed += 1,
            |scene| scene.growth.richness = [0.45; 3],
            |scene| scene.growth.spacing_m *= 1.01,
            |scene| scene.underbrush[0].size_variation += 0.01,
        ];
        for change in changes {
            let mut other = scene.clone();
            change(&mut other);
            assert_ne!(checksum(&other), checksum(&scene));
        }
    }

    #[test]
    fn the_height_is_that_of_the_highest_tip() {
        let mut stalk = Component::new("stalk", ComponentKind::Branch);
        (stalk.length_m, stalk.angle_rad) = (1.0, 0.0);
        let mut leaf = Component::new("leaf", ComponentKind::Leaf);
        (leaf.on, leaf.to_share, leaf.length_m, leaf.angle_rad) = ("stalk".into(), 0.5, 0.3, std::f32::consts::FRAC_PI_3);
        assert!((height_m(&Underbrush::new("a", vec![stalk.clone(), leaf.clone()])) - 1.0).abs() < 1e-6);
        leaf.to_share = 1.0;
        let species = Underbrush::new("a", vec![stalk, leaf]);
        assert!((height_m(&species) - 1.15).abs() < 1e-5);
        assert!((reach_m(&species) - 1.2 * 1.3 - 2.0 * 0.005).abs() < 1e-5, "{}", reach_m(&species));
    }

    #[test]
    fn components_without_an_earlier_branch_stand_on_the_ground() {
        let component = |name: &str, kind, on: &str| Component { on: on.into(), angle_rad: 0.0, ..Component::new(name, kind) };
        let on = |on: &str| {
            let components = vec![
                component("stalk", ComponentKind::Branch, ""),
                component("leaf", ComponentKind::Leaf, ""),
                component("bud", ComponentKind::Leaf, on),
                component("twig", ComponentKind::Branch, ""),
            ];
            let species = Underbrush::new("a", components);
            let plan = Plan::new(&species, Nodes { angles: 2, loads: 2 });
            (species.branch_below(2), plan.components[2].on, (height_m(&species) / 0.4).round(), (reach_m(&species) / 0.485).round())
        };
        assert_eq!(on("stalk"), (Some(0), Some(0), 2.0, 2.0));
        for none in ["leaf", "bud", "twig", "root", ""] {
            assert_eq!(on(none), (None, None, 1.0, 1.0), "on \"{none}\"");
        }
    }
}
