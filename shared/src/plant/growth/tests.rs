//! Tests of growth: competition for room, nutrients and light.

use super::*;
use crate::scene::{Growth, Underbrush};
use crate::terrain::{Cover, CoverMap, grey_png};
use proptest::prelude::*;

/// A species that needs half of the mean generated soil, with a room of 0.6 m.
fn species(name: &str) -> Underbrush {
    Underbrush { room_m: 0.6, reach_m: 1.5, needs: [0.25; 3], uptake: [0.1; 3], light_need: 0.0, ..Underbrush::new(name, vec![]) }
}

/// Species of different rooms, needs and heights, and their heights (m).
fn mixed() -> (Vec<Underbrush>, Vec<f32>) {
    let of = |name: &str, room_m: f32, need: f32, light_need: f32| Underbrush {
        room_m,
        reach_m: 2.5 * room_m,
        needs: [need, 0.8 * need, 0.5 * need],
        light_need,
        ..species(name)
    };
    let all = vec![of("clover", 0.3, 0.1, 0.5), of("grass", 0.5, 0.2, 0.6), of("fern", 0.9, 0.3, 0.2), of("shrub", 2.4, 0.3, 0.4)];
    (all, vec![0.15, 0.6, 0.9, 1.8])
}

/// Plants on generated soil over a square of `side_m`, on sites half a metre apart.
fn grown(side_m: f32, seed: u64, species: &[Underbrush], heights_m: &[f32], ground: impl Fn([f32; 2]) -> Permission) -> Grown {
    grown_on(&Growth::default(), side_m, seed, species, heights_m, ground)
}

fn grown_on(
    growth: &Growth,
    side_m: f32,
    seed: u64,
    species: &[Underbrush],
    heights_m: &[f32],
    ground: impl Fn([f32; 2]) -> Permission,
) -> Grown {
    let sites = Sites::new([side_m; 2], growth.spacing_m, seed);
    let soil = Soil::generated(growth, &sites);
    let before = soil.total();
    let grown = grow(sites, soil, species, heights_m, growth.shade, ground);
    let after = grown.soil.total();
    assert_eq!(before, std::array::from_fn(|nutrient| after[nutrient] + grown.taken[nutrient]), "nothing is lost or made");
    grown
}

fn count_of(grown: &Grown, species: u8) -> usize {
    grown.plants().iter().filter(|plant| plant.species == species).count()
}

/// Largest violation of the distance between two plants (m); checks all pairs that may be near.
fn worst_crowding_m(grown: &Grown, species: &[Underbrush]) -> f64 {
    let widest_m = species.iter().fold(0.0, |widest: f32, species| widest.max(species.room_m));
    let mut places: Vec<_> = grown.plants().iter().map(|plant| (grown.sites.place_m(plant.site), plant.species)).collect();
    places.sort_by(|one, other| one.0[1].total_cmp(&other.0[1]));
    let mut worst_m = f64::NEG_INFINITY;
    for (i, &([x, z], kind)) in places.iter().enumerate() {
        for &([other_x, other_z], other_kind) in places[i + 1..].iter().take_while(|(at_m, _)| at_m[1] - z <= widest_m) {
            let rooms_m = [kind, other_kind].map(|kind| f64::from(species[usize::from(kind)].room_m));
            let [dx, dz] = [f64::from(other_x - x), f64::from(other_z - z)];
            worst_m = worst_m.max(0.5 * (rooms_m[0] + rooms_m[1]) - (dx * dx + dz * dz).sqrt());
        }
    }
    worst_m
}

/// FNV-1a of the plants and the soil that they leave.
fn checksum(grown: &Grown) -> u64 {
    let plants = grown.plants().iter().flat_map(|plant| [plant.site, plant.species.into(), plant.vigour.into()]);
    let soil = grown.soil.levels().iter().flatten().map(|&level| u32::from(level));
    plants.chain(soil).fold(0xcbf2_9ce4_8422_2325, |sum, word| (sum ^ u64::from(word)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn plants_keep_their_rooms() {
    let (species, heights_m) = mixed();
    for seed in 0..8 {
        let grown = grown(64.0, seed, &species, &heights_m, |_| Permission::Open);
        for kind in 0..4 {
            assert!(count_of(&grown, kind) > 20, "{} of species {kind}", count_of(&grown, kind));
        }
        let worst_m = worst_crowding_m(&grown, &species);
        assert!(worst_m <= 1e-5, "{worst_m} m too near with seed {seed}");
        assert!(worst_m > -0.02, "the nearest are {worst_m} m apart from their rooms: rooms are not what keeps them apart");
    }
}

#[test]
fn a_whole_world_grows_and_keeps_its_rooms() {
    let (species, heights_m) = mixed();
    let grown = grown(256.0, 5, &species, &heights_m, |_| Permission::Open);
    assert_eq!(grown.sites.total(), 512 * 512);
    assert!(grown.plants().len() > 20_000, "{} plants", grown.plants().len());
    assert!(worst_crowding_m(&grown, &species) <= 2e-5);
}

#[test]
fn plants_come_up_only_where_the_soil_has_what_they_need() {
    let (species, heights_m) = mixed();
    let sites = Sites::new([64.0; 2], 0.5, 3);
    let soil = Soil::generated(&Growth::default(), &sites);
    let grown = grow(sites, soil.clone(), &species, &heights_m, 0.5, |_| Permission::Open);
    for plant in grown.plants() {
        let needs = species[usize::from(plant.species)].needs;
        for (level, need) in soil.levels()[plant.site as usize].into_iter().zip(needs) {
            assert!(f64::from(level) >= f64::from(need) * 65535.0 - 0.51, "{level} of {need}");
        }
    }
    let starved = grow(
        grown.sites,
        Soil::generated(&Growth { richness: [0.5, 0.5, 0.02], ..Growth::default() }, &Sites::new([64.0; 2], 0.5, 3)),
        &species,
        &heights_m,
        0.5,
        |_| Permission::Open,
    );
    assert_eq!(starved.plants().len(), 0, "of one nutrient there is too little everywhere");
}

#[test]
fn richer_soil_gets_more_plants() {
    let counts: Vec<_> = (0..5_u16)
        .map(|step| {
            let richness = 0.2 + 0.05 * f32::from(step);
            let growth = Growth { richness: [richness; 3], patch_m: 8.0, ..Growth::default() };
            let grown = grown_on(&growth, 96.0, 2, &[species("grass")], &[0.5], |_| Permission::Open);
            (f64::from(richness), grown.plants().len() as f64)
        })
        .collect();
    let mean = |of: fn(&(f64, f64)) -> f64| counts.iter().map(of).sum::<f64>() / counts.len() as f64;
    let (mean_x, mean_y) = (mean(|pair| pair.0), mean(|pair| pair.1));
    let sum = |of: &dyn Fn(f64, f64) -> f64| counts.iter().map(|&(x, y)| of(x - mean_x, y - mean_y)).sum::<f64>();
    let slope = sum(&|x, y| x * y) / sum(&|x, _| x * x);
    let explained = sum(&|x, y| x * y).powi(2) / (sum(&|x, _| x * x) * sum(&|_, y| y * y));
    assert!(slope > 2.0 * mean_y, "{slope} plants more for each unit of concentration: {counts:?}");
    assert!(explained > 0.9, "the line explains {explained} of {counts:?}");
}

#[test]
fn a_gap_wider_than_the_reach_is_not_crossed() {
    // A single propagation point, so that only one side has any plants; which one depends on the seed.
    let sides = |gap_m: f32| {
        let grass = Underbrush { propagation_points: 1, reach_m: 1.5, needs: [0.0; 3], uptake: [0.0; 3], ..species("grass") };
        (0..6).map(move |seed| {
            let grown = grown(40.0, seed, std::slice::from_ref(&grass), &[0.5], |[x_m, _]| {
                if (x_m - 20.0).abs() < 0.5 * gap_m { Permission::Closed } else { Permission::Open }
            });
            let west = grown.plants().iter().filter(|plant| grown.sites.place_m(plant.site)[0] < 20.0).count();
            [west, grown.plants().len() - west]
        })
    };
    for [west, east] in sides(1.6) {
        assert!(west.min(east) == 0 && west.max(east) > 1000, "{west} west and {east} east of the gap");
    }
    assert!(sides(1.6).any(|[west, _]| west > 0) && sides(1.6).any(|[_, east]| east > 0));
    for [west, east] in sides(0.6) {
        assert!(west.min(east) > 1000, "{west} west and {east} east of a narrow gap");
    }
}

#[test]
fn without_propagation_points_nothing_grows_but_where_it_is_painted() {
    let grass = Underbrush { propagation_points: 0, reach_m: 0.0, ..species("grass") };
    assert_eq!(grown(40.0, 1, std::slice::from_ref(&grass), &[0.5], |_| Permission::Open).plants(), []);
    let painted = grown(40.0, 1, &[grass], &[0.5], |[x_m, _]| if x_m < 10.0 { Permission::Painted(0) } else { Permission::Open });
    assert!(painted.plants().len() > 500);
    assert!(painted.plants().iter().all(|plant| painted.sites.place_m(plant.site)[0] < 10.0));
}

#[test]
fn taller_plants_keep_out_those_that_need_light() {
    // A tall plant every 8 m, in its own painted square; low ones grow outside its shade.
    let tall = Underbrush { propagation_points: 0, room_m: 2.0, reach_m: 0.0, ..species("tall") };
    let ground = |at_m: [f32; 2]| if at_m.iter().all(|m| m % 8.0 < 0.5) { Permission::Painted(0) } else { Permission::Open };
    let low = |light_need: f32, heights_m: [f32; 2]| {
        let low = Underbrush { needs: [0.0; 3], uptake: [0.0; 3], light_need, ..species("low") };
        let grown = grown(48.0, 4, &[tall.clone(), low], &heights_m, ground);
        let places =
            |species| grown.plants().iter().filter(move |plant| plant.species == species).map(|plant| grown.sites.place_m(plant.site));
        let from_tall =
            |[x, z]: [f32; 2]| places(0).map(|[tall_x, tall_z]| ((x - tall_x).powi(2) + (z - tall_z).powi(2)).sqrt()).fold(99.0, f32::min);
        (places(0).count(), places(1).count(), places(1).map(from_tall).fold(99.0, f32::min))
    };
    let (tall_count, hungry, nearest_m) = low(0.7, [3.0, 0.3]);
    assert_eq!(tall_count, 36);
    // 0.5 · 2 · (1 − 0.3/3) · (2 − d/2) = 1 − 0.7.
    assert!((3.333..3.5).contains(&nearest_m), "{nearest_m} m");
    let (_, shy, nearest_m) = low(0.1, [3.0, 0.3]);
    assert!((2.0..2.2).contains(&nearest_m), "{nearest_m} m");
    assert!(hungry * 4 < shy * 3, "{hungry} that need much light under tall plants, {shy} that need little");
    let (_, level, nearest_m) = low(0.7, [0.3, 0.3]);
    assert!(level > shy && (1.3..1.4).contains(&nearest_m), "{level} among plants of their own height, {nearest_m} m from them");
    assert_eq!(low(0.0, [3.0, 0.3]), (36, level, nearest_m), "what needs no light does not care");
}

#[test]
fn a_greedy_species_starves_another() {
    let modest = Underbrush { uptake: [0.0; 3], ..species("modest") };
    let beside = |uptake: f32| {
        let other =
            Underbrush { uptake: [uptake; 3], needs: [0.1; 3], propagation_points: 150, room_m: 3.0, reach_m: 0.0, ..species("other") };
        count_of(&grown(64.0, 6, &[modest.clone(), other], &[0.5, 0.5], |_| Permission::Open), 0)
    };
    let [fed, starved] = [beside(0.0), beside(0.6)];
    assert!(starved * 3 < fed * 2, "{starved} beside a greedy species, {fed} beside a modest one");
}

#[test]
fn vigour_follows_what_a_plant_got() {
    let vigour = |richness: f32| {
        let growth = Growth { richness: [richness, 1.0, 1.0], patch_m: 8.0, ..Growth::default() };
        let painted = grown_on(&growth, 40.0, 2, &[species("grass")], &[0.5], |_| Permission::Painted(0));
        painted.plants().iter().map(|plant| f64::from(plant.vigour)).sum::<f64>() / painted.plants().len() as f64
    };
    let [none, poor, rich] = [0.0, 0.1, 1.0].map(vigour);
    assert!(none == 0.0 && rich == 255.0 && (50.0..250.0).contains(&poor), "{none}, {poor}, {rich}");
}

#[test]
fn painted_places_are_for_one_species_alone_whatever_the_soil() {
    let mut all = vec![species("reed"), species("grass")];
    all[0].cover = 9;
    all[0].needs = [1.0; 3];
    all[0].light_need = 1.0;
    // Pixels of 10 m: one painted in the middle of grass, a gap, a tree, a stone.
    let cover =
        CoverMap::from_png(&grey_png([4, 4], &[255, 255, 255, 255, 255, 9, 255, 255, 0, 255, 253, 254, 255, 255, 255, 77])).unwrap();
    let ground = |[x_m, z_m]: [f32; 2]| {
        let cover = cover.at(x_m, z_m, [40.0; 2]);
        Permission::new(cover, cover == Cover::Grass, &all)
    };
    let grown = grown_on(&Growth { richness: [0.9; 3], ..Growth::default() }, 40.0, 8, &all, &[0.5, 2.0], ground);
    let mut painted = 0;
    for plant in grown.plants() {
        let [x_m, z_m] = grown.sites.place_m(plant.site);
        match cover.at(x_m, z_m, [40.0; 2]) {
            Cover::Free(9) => {
                assert_eq!(plant.species, 0);
                painted += 1;
            }
            cover => assert_eq!(cover, Cover::Grass),
        }
    }
    // The density of plants with a room of 0.6 m on random sites.
    assert!((120..280).contains(&painted), "{painted} plants on 100 m²");
    assert_eq!(count_of(&grown, 0), painted, "it needs more than there is where it is not painted");
    assert!(count_of(&grown, 1) > 800, "{} of the other", count_of(&grown, 1));
}

#[test]
fn painted_places_keep_others_out_where_there_is_room_for_them() {
    let reed = Underbrush { room_m: 3.0, reach_m: 0.0, propagation_points: 0, ..species("reed") };
    let moss = Underbrush { room_m: 0.2, needs: [0.0; 3], uptake: [0.0; 3], ..species("moss") };
    let ground = |[x_m, _]: [f32; 2]| if x_m < 20.0 { Permission::Painted(0) } else { Permission::Open };
    let grown = grown(40.0, 3, &[reed, moss], &[0.5; 2], ground);
    assert!(count_of(&grown, 0) > 10 && count_of(&grown, 1) > 1000);
    assert!(grown.plants().iter().all(|plant| (grown.sites.place_m(plant.site)[0] < 20.0) == (plant.species == 0)));
}

#[test]
fn plants_are_found_by_site_and_by_place() {
    let (species, heights_m) = mixed();
    let grown = grown(32.0, 3, &species, &heights_m, |_| Permission::Open);
    assert!(grown.plants().is_sorted_by_key(|plant| plant.site));
    assert!(grown.plants().iter().all(|plant| grown.plant_at(plant.site) == Some(plant)));
    let free = (0..grown.sites.total() as u32).find(|site| grown.plants().iter().all(|plant| plant.site != *site)).unwrap();
    assert_eq!(grown.plant_at(free), None);
    for (at_m, radius_m) in
        [([16.0, 16.0], 5.0), ([0.0, 31.9], 3.0), ([-4.0, 10.0], 4.5), ([500.0, 500.0], 9.0), ([-30.0, -30.0], 5.0), ([16.0, 16.0], 99.0)]
    {
        let near = |plant: &&Plant| {
            let [dx, dz] = [0, 1].map(|axis| grown.sites.place_m(plant.site)[axis] - at_m[axis]);
            dx * dx + dz * dz < radius_m * radius_m
        };
        let expected: Vec<_> = grown.plants().iter().filter(near).collect();
        assert_eq!(grown.near(at_m, radius_m).collect::<Vec<_>>(), expected, "about {at_m:?}");
    }
    let halves = [grown.in_rectangle([0.0; 2], [32.0, 13.3]), grown.in_rectangle([0.0, 13.3], [32.0; 2])];
    assert_eq!(halves.into_iter().map(Iterator::count).sum::<usize>(), grown.plants().len(), "rectangles that meet share no plant");
}

#[test]
fn the_same_seed_grows_the_same_bits_and_another_others() {
    let (species, heights_m) = mixed();
    let painted = |[x_m, z_m]: [f32; 2]| match () {
        () if (x_m - 20.0) * (x_m - 20.0) + (z_m - 30.0) * (z_m - 30.0) < 60.0 => Permission::Painted(2),
        () if x_m > 40.0 && z_m < 12.0 => Permission::Closed,
        () => Permission::Open,
    };
    let of = |seed| grown(64.0, seed, &species, &heights_m, painted);
    assert!(of(11) == of(11));
    assert!(of(11).plants() != of(12).plants());
    assert!(of(11).plants() != of(11 | 1 << 32).plants(), "all bits of the seed count");
    // The same on every machine and in wasm.
    assert_eq!(checksum(&of(11)), 9_060_511_374_708_729_008);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn whatever_a_scene_allows_grows(
        seed in any::<u64>(),
        spacing_m in 0.2_f32..20.0,
        extent_m in prop::array::uniform2(0.4_f32..30.0),
        kinds in prop::collection::vec((0.05_f32..20.0, 0.0_f32..50.0, 0_u32..60, 0.0_f32..1.0, 0.0_f32..1.0, 0.02_f32..5.0), 0..16),
        shade in 0.0_f32..1.0,
    ) {
        let heights_m: Vec<_> = kinds.iter().map(|kind| kind.5).collect();
        let of = |(room_m, reach_m, propagation_points, need, light_need, _): (f32, f32, u32, f32, f32, f32)| Underbrush {
            room_m, reach_m, propagation_points, needs: [need * need; 3], uptake: [need, 1.0 - need, 0.0], light_need, ..species("any")
        };
        let all: Vec<_> = kinds.iter().map(|kind| of(*kind)).collect();
        let sites = Sites::new(extent_m, spacing_m, seed);
        let soil = Soil::generated(&Growth::default(), &sites);
        let before = soil.total();
        let ground = |[x_m, z_m]: [f32; 2]| match all.len() {
            _ if x_m >= extent_m[0] || z_m >= extent_m[1] => Permission::Closed,
            count if count > 0 && x_m < 3.0 => Permission::Painted((count - 1) as u8),
            _ => Permission::Open,
        };
        let grown = grow(sites, soil, &all, &heights_m, shade, ground);
        let after = grown.soil.total();
        prop_assert_eq!(before, std::array::from_fn(|nutrient| after[nutrient] + grown.taken[nutrient]));
        prop_assert!(worst_crowding_m(&grown, &all) <= 1e-5);
    }
}
