//! Light, shadows, rain and dust.

use crate::{Golden, Unlike, golden};
use anyhow::Result;
use prairie::charts::views::{Eye, over};
use prairie::studio::Act;
use prairie_client::render::{Quality, RenderOptions, Sun};
use prairie_core::scene::Scene;

/// Render options with the sun at a heading and an elevation (degrees).
fn sunlit(heading_deg: f32, elevation_deg: f32) -> RenderOptions {
    let sun = Sun { heading_rad: heading_deg.to_radians(), elevation_rad: elevation_deg.to_radians() };
    RenderOptions { sun: Some(sun), ..RenderOptions::default() }
}

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
        unlike: Unlike::RenderOptions(RenderOptions::default()),
        ..Golden::default()
    }
);
golden!(
    backlight,
    Golden {
        shows: "blades lit from behind",
        eye: over([128.0, 158.7], 0.9, 20.0, -3.0),
        look: sunlit(20.0, 12.0),
        unlike: Unlike::RenderOptions(RenderOptions::default()),
        ..Golden::default()
    }
);
golden!(
    stars,
    Golden {
        shows: "stars and clouds",
        eye: over([128.0, 158.7], 2.0, 20.0, 30.0),
        look: sunlit(330.0, -12.0),
        unlike: Unlike::RenderOptions(sunlit(330.0, 5.0)),
        ..Golden::default()
    }
);
golden!(
    moon,
    Golden {
        shows: "the full moon, opposite the sun",
        eye: over([128.0, 158.7], 2.0, 150.0, 10.0),
        look: sunlit(330.0, -9.0),
        parts: &[[124, 70, 8, 8]],
        unlike: Unlike::RenderOptions(sunlit(345.0, -9.0)),
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

/// The sky is overcast from 10 mm/h on; heavier rain differs only in its streaks.
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

fn in_a_dust_devil() -> Golden {
    Golden { scene: "devil", eye: over([114.0, 112.0], 1.7, 330.0, 2.0), ..Golden::default() }
}

golden!(dust, Golden { shows: "puffs and motes of dust", unlike: Unlike::Stored("clear_air"), ..in_a_dust_devil() });
golden!(
    clear_air,
    Golden {
        shows: "air without dust",
        change: |scene| scene.wind.dust.release_per_s = 0.0,
        unlike: Unlike::Stored("dust"),
        ..in_a_dust_devil()
    }
);
