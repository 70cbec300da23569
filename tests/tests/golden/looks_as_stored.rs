//! The stored pictures, one test each by the name of its file: every pass and every method in a view that shows it.

use crate::{Golden, Unlike};
use anyhow::Result;
use client_wasm::render::{Far, Look, Order, Quality, Split, Sun, Way};
use shared::scene::Scene;
use tests::stage::Act;
use tests::views::{Eye, over};

macro_rules! golden {
    ($name:ident, $golden:expr) => {
        #[test]
        fn $name() -> Result<()> {
            $golden.check(stringify!($name))
        }
    };
}

/// A look by its names.
fn look(order: Order, far: Far) -> Look {
    Look { order, far, ..Look::default() }
}

/// The light of a sun at a heading and an elevation (degrees).
fn sunlit(heading_deg: f32, elevation_deg: f32) -> Look {
    let sun = Sun { heading_rad: heading_deg.to_radians(), elevation_rad: elevation_deg.to_radians() };
    Look { sun: Some(sun), ..Look::default() }
}

/// Seen as pictures were before there were so many.
fn large() -> Golden {
    Golden { size_px: [480, 270], frames: 12, ..Golden::default() }
}

golden!(meadow, large());
golden!(track, Golden { shows: "a car's track", act: Act::Track, unlike: Unlike::Stored("meadow"), ..large() });
golden!(species, Golden { scene: "scenes/species/species.toml", ..large() });
golden!(underbrush, Golden { scene: "underbrush", ..large() });
golden!(blades, Golden { scene: "blades", ..large() });
golden!(
    shells,
    Golden {
        shows: "layers above the ground",
        scene: "shells",
        unlike: Unlike::Look(Look { shell_layers: Some(1), ..Look::default() }),
        ..large()
    }
);

// What stands for far plants.

/// Above: clumps of one segment; below: of several.
fn down_the_valley() -> Golden {
    Golden { eye: over([128.0, 158.0], 5.0, 20.0, -10.0), parts: &[[0, 58, 256, 11], [0, 70, 256, 14]], ..Golden::default() }
}

golden!(far_land, Golden { shows: "blades as far as they are told apart", unlike: Unlike::Stored("far_clumps"), ..down_the_valley() });
golden!(
    far_clumps,
    Golden {
        shows: "clumps: near ones of several segments, far ones of one",
        look: look(Order::Cut, Far::Clumps),
        unlike: Unlike::Stored("far_land"),
        ..down_the_valley()
    }
);
// In grass so high that single clumps are seen.
golden!(
    far_clumps_sorted,
    Golden {
        shows: "clumps blended far to near",
        change: |scene| scene.plants.height_m = 2.0,
        eye: over([128.0, 158.0], 6.0, 20.0, -10.0),
        look: look(Order::Sorted, Far::Clumps),
        parts: &[[0, 80, 256, 24]],
        unlike: Unlike::Look(look(Order::Cut, Far::Clumps)),
        ..Golden::default()
    }
);
golden!(
    far_shells,
    Golden { shows: "shells", look: look(Order::Cut, Far::Shells), unlike: Unlike::Stored("far_clumps"), ..down_the_valley() }
);
golden!(
    split,
    Golden {
        shows: "shells to the left and clumps to the right",
        split: Some(Split { ways: [Far::Shells, Far::Clumps].map(|far| Way { look: look(Order::Cut, far), level: 0.0 }), at: 0.5 }),
        parts: &[[0, 60, 128, 26], [128, 60, 128, 26]],
        unlike: Unlike::Stored("far_land"),
        ..down_the_valley()
    }
);

// How plants are laid over each other.

fn among_textured_blades() -> Golden {
    Golden { scene: "blades", eye: over([32.0, 43.0], 0.9, 10.0, -14.0), ..Golden::default() }
}

golden!(cut, Golden { shows: "edges that are cut", unlike: Unlike::Stored("sorted"), ..among_textured_blades() });
golden!(
    sorted,
    Golden {
        shows: "blades blended far to near",
        look: look(Order::Sorted, Far::Land),
        unlike: Unlike::Stored("cut"),
        ..among_textured_blades()
    }
);
golden!(
    precomputed,
    Golden {
        shows: "blades blended in an order made beforehand",
        look: look(Order::Precomputed, Far::Land),
        unlike: Unlike::Stored("cut"),
        ..among_textured_blades()
    }
);
golden!(
    weighted,
    Golden {
        shows: "blades blended by weight",
        look: look(Order::Weighted, Far::Land),
        unlike: Unlike::Stored("sorted"),
        ..among_textured_blades()
    }
);
golden!(
    high,
    Golden {
        shows: "four samples a pixel",
        quality: Quality::High,
        size_px: [128, 72],
        frames: 2,
        unlike: Unlike::Look(look(Order::Coverage, Far::Land)),
        ..among_textured_blades()
    }
);
golden!(
    coverage,
    Golden {
        shows: "opacity as a share of samples",
        quality: Quality::High,
        size_px: [128, 72],
        frames: 2,
        look: look(Order::Coverage, Far::Land),
        unlike: Unlike::Stored("high"),
        ..among_textured_blades()
    }
);
golden!(
    ultra,
    Golden {
        shows: "four pixels drawn for each, tone mapped to one",
        quality: Quality::Ultra,
        size_px: [128, 72],
        frames: 2,
        unlike: Unlike::Stored("high"),
        ..among_textured_blades()
    }
);

// What is in the air.

/// The sky is overcast from 10 mm/h on; what rains more differs in its streaks alone.
fn rainy(change: fn(&mut Scene)) -> Golden {
    Golden { scene: "storm", change, quality: Quality::Medium, parts: &[[0, 44, 256, 60]], ..Golden::default() }
}

golden!(
    rain,
    Golden { shows: "streaks of heavy rain", unlike: Unlike::Stored("light_rain"), ..rainy(|scene| scene.rain.rate_mm_per_h = 30.0) }
);
golden!(
    light_rain,
    Golden { shows: "few streaks of rain", unlike: Unlike::Stored("rain"), ..rainy(|scene| scene.rain.rate_mm_per_h = 10.0) }
);
golden!(
    dust,
    Golden { shows: "a dust devil", scene: "devil", parts: &[[16, 32, 128, 48]], unlike: Unlike::Stored("clear_air"), ..Golden::default() }
);
golden!(
    clear_air,
    Golden {
        shows: "air without dust",
        scene: "devil",
        change: |scene| scene.wind.dust.release_per_s = 0.0,
        unlike: Unlike::Stored("dust"),
        ..Golden::default()
    }
);

// Light and shadow.

const LAMPS: &str = "scenes/lamps.toml";

golden!(
    lamps,
    Golden {
        shows: "the light of lamps",
        scene: LAMPS,
        parts: &[[0, 64, 176, 48]],
        unlike: Unlike::Stored("lamps_out"),
        ..Golden::default()
    }
);
golden!(
    lamps_out,
    Golden {
        shows: "dusk without lamps",
        scene: LAMPS,
        change: |scene| scene.lights.clear(),
        unlike: Unlike::Stored("lamps"),
        ..Golden::default()
    }
);
golden!(
    headlights,
    Golden {
        shows: "a car's headlights",
        act: Act::Track,
        eye: Eye::Chase([9.0, 3.0, 3.0]),
        look: sunlit(330.0, -5.0),
        parts: &[[122, 34, 64, 28]],
        unlike: Unlike::Bare,
        ..Golden::default()
    }
);
golden!(
    dusk,
    Golden {
        shows: "dusk",
        eye: over([128.0, 158.7], 0.9, -20.0, -3.0),
        look: sunlit(330.0, -2.0),
        unlike: Unlike::Look(Look::default()),
        ..Golden::default()
    }
);
golden!(
    backlight,
    Golden {
        shows: "blades lit from behind",
        eye: over([128.0, 158.7], 0.9, 20.0, -3.0),
        look: sunlit(20.0, 12.0),
        unlike: Unlike::Look(Look::default()),
        ..Golden::default()
    }
);
golden!(
    stars,
    Golden {
        shows: "stars and clouds",
        eye: over([128.0, 158.7], 2.0, 20.0, 30.0),
        look: sunlit(330.0, -12.0),
        unlike: Unlike::Look(sunlit(330.0, 5.0)),
        ..Golden::default()
    }
);

fn above_trees() -> Golden {
    Golden { eye: over([150.0, 130.0], 14.0, 350.0, -14.0), look: sunlit(250.0, 14.0), quality: Quality::Medium, ..Golden::default() }
}

golden!(
    trees,
    Golden {
        shows: "shadows, those near by and those of the coarse layer",
        parts: &[[210, 62, 36, 20], [16, 47, 56, 9]],
        unlike: Unlike::Stored("saplings"),
        ..above_trees()
    }
);
golden!(
    saplings,
    Golden {
        shows: "trees that are too small to be seen",
        change: |scene| scene.plants.tree_m = 0.5,
        unlike: Unlike::Stored("trees"),
        ..above_trees()
    }
);

// What moves through the grass.

golden!(
    car,
    Golden {
        shows: "a car",
        act: Act::Track,
        eye: Eye::Chase([7.0, 2.2, 2.0]),
        parts: &[[92, 52, 64, 56]],
        unlike: Unlike::Bare,
        ..Golden::default()
    }
);
golden!(
    monster,
    Golden {
        shows: "a monster",
        act: Act::Walk,
        eye: Eye::Chase([4.0, 1.2, 1.5]),
        parts: &[[108, 32, 52, 66]],
        unlike: Unlike::Bare,
        ..Golden::default()
    }
);
golden!(
    helicopter,
    Golden {
        shows: "a helicopter",
        act: Act::Wash,
        eye: Eye::Chase([8.0, 2.0, 5.0]),
        parts: &[[72, 46, 84, 50]],
        unlike: Unlike::Bare,
        ..Golden::default()
    }
);
golden!(
    sled,
    Golden {
        shows: "a sled",
        act: Act::Drag,
        eye: Eye::Chase([6.0, 3.0, 2.0]),
        parts: &[[64, 44, 110, 72]],
        unlike: Unlike::Bare,
        ..Golden::default()
    }
);
golden!(
    ball,
    Golden {
        shows: "a ball",
        scene: "underbrush",
        act: Act::Roll,
        eye: Eye::Chase([2.8, 1.0, 0.8]),
        parts: &[[104, 44, 56, 56]],
        unlike: Unlike::Bare,
        ..Golden::default()
    }
);

// What grows.

fn between_blades() -> Golden {
    Golden { eye: over([128.0, 158.7], 1.5, 20.0, -35.0), ..Golden::default() }
}

golden!(
    flowers,
    Golden {
        shows: "flowers",
        change: |scene| scene.plants.flowers_per_m2 = 30.0,
        unlike: Unlike::Stored("near_blades"),
        ..between_blades()
    }
);
golden!(
    near_blades,
    Golden {
        shows: "blades without flowers",
        change: |scene| scene.plants.flowers_per_m2 = 0.0,
        unlike: Unlike::Stored("flowers"),
        ..between_blades()
    }
);

fn at_an_ants_height() -> Golden {
    Golden { scene: "underbrush", eye: over([145.1, 140.12], 0.09, 60.0, 6.0), ..Golden::default() }
}

golden!(ant, Golden { shows: "underbrush from below", unlike: Unlike::Stored("ant_in_grass"), ..at_an_ants_height() });
golden!(
    ant_in_grass,
    Golden {
        shows: "grass alone from below",
        change: |scene| scene.underbrush.clear(),
        unlike: Unlike::Stored("ant"),
        ..at_an_ants_height()
    }
);

fn where_reeds_were_run_over() -> Golden {
    Golden {
        scene: "underbrush",
        act: Act::Track,
        eye: over([121.5, 150.0], 2.175, 90.0, -10.0),
        parts: &[[112, 48, 32, 36]],
        ..Golden::default()
    }
}

golden!(broken_reeds, Golden { shows: "reeds that a car broke", unlike: Unlike::Stored("tough_reeds"), ..where_reeds_were_run_over() });
golden!(
    tough_reeds,
    Golden {
        shows: "reeds that rise behind a car",
        change: |scene| scene.underbrush.iter_mut().flat_map(|species| &mut species.components).for_each(|part| part.strength_n_m = 0.0),
        unlike: Unlike::Stored("broken_reeds"),
        ..where_reeds_were_run_over()
    }
);

fn over_the_valley() -> Golden {
    Golden { scene: "storm", eye: over([216.0, 60.0], 60.0, 225.0, -24.0), ..Golden::default() }
}

golden!(
    waves,
    Golden {
        shows: "waves of wind over the valley",
        change: |scene| scene.rain.rate_mm_per_h = 0.0,
        unlike: Unlike::Stored("still_valley"),
        ..over_the_valley()
    }
);
golden!(
    still_valley,
    Golden {
        shows: "grass that no wind bends",
        change: |scene| (scene.rain.rate_mm_per_h, scene.grass.wind_bend_rad) = (0.0, 0.0),
        unlike: Unlike::Stored("waves"),
        ..over_the_valley()
    }
);
