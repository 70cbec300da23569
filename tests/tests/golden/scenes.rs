//! Whole scenes and their plants.

use crate::{Golden, Unlike, golden};
use anyhow::Result;
use prairie::charts::views::over;
use prairie::studio::Act;
use prairie_client::render::RenderOptions;

/// A larger picture, for whole scenes.
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
        unlike: Unlike::RenderOptions(RenderOptions { shell_layers: Some(1), ..RenderOptions::default() }),
        ..large()
    }
);

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

fn above_blades() -> Golden {
    Golden { eye: over([128.0, 158.7], 0.8, 20.0, -50.0), parts: &[[90, 48, 88, 56]], ..Golden::default() }
}

golden!(
    petals,
    Golden { shows: "petals", change: |scene| scene.plants.flowers_per_m2 = 30.0, unlike: Unlike::Stored("no_petals"), ..above_blades() }
);
golden!(
    no_petals,
    Golden {
        shows: "blades without petals",
        change: |scene| scene.plants.flowers_per_m2 = 0.0,
        unlike: Unlike::Stored("petals"),
        ..above_blades()
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
        change: |scene| {
            // Soft grass in hard gusts: from 60 m above, a lean changes little of the colour.
            (scene.rain.rate_mm_per_h, scene.wind.turbulence, scene.grass.wind_bend_rad) = (0.0, 3.0, 1.5);
        },
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
