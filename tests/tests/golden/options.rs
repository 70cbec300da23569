//! Every representation of distant plants and every transparency order.

use crate::{Golden, Unlike, golden};
use anyhow::Result;
use prairie::charts::views::over;
use prairie_client::render::{BlendOrder, FarPlants, Quality, RenderOptions, SideOptions, Split};

/// Render options with a transparency order and a representation of distant plants.
fn look(order: BlendOrder, far: FarPlants) -> RenderOptions {
    RenderOptions { blend_order: order, far_plants: far, ..RenderOptions::default() }
}

/// A view in which clumps have one segment in the upper part, several in the lower part.
fn down_the_valley() -> Golden {
    Golden { eye: over([128.0, 158.0], 5.0, 20.0, -10.0), parts: &[[0, 58, 256, 11], [0, 70, 256, 14]], ..Golden::default() }
}

golden!(
    far_land,
    Golden { shows: "single blades up to where they are indistinguishable", unlike: Unlike::Stored("far_clumps"), ..down_the_valley() }
);
golden!(
    far_clumps,
    Golden {
        shows: "clumps: near ones of several segments, far ones of one",
        look: look(BlendOrder::Cut, FarPlants::Clumps),
        unlike: Unlike::Stored("far_land"),
        ..down_the_valley()
    }
);
// In grass so high that single clumps are visible.
golden!(
    far_clumps_sorted,
    Golden {
        shows: "clumps blended far to near",
        change: |scene| scene.plants.height_m = 2.0,
        eye: over([128.0, 158.0], 6.0, 20.0, -10.0),
        look: look(BlendOrder::Sorted, FarPlants::Clumps),
        parts: &[[0, 80, 256, 24]],
        unlike: Unlike::RenderOptions(look(BlendOrder::Cut, FarPlants::Clumps)),
        ..Golden::default()
    }
);
golden!(
    far_shells,
    Golden { shows: "shells", look: look(BlendOrder::Cut, FarPlants::Shells), unlike: Unlike::Stored("far_clumps"), ..down_the_valley() }
);
golden!(
    split,
    Golden {
        shows: "shells to the left and clumps to the right",
        split: Some(Split {
            sides: [FarPlants::Shells, FarPlants::Clumps].map(|far| SideOptions { options: look(BlendOrder::Cut, far), level: 0.0 }),
            border: 0.5
        }),
        parts: &[[0, 60, 128, 26], [128, 60, 128, 26]],
        unlike: Unlike::Stored("far_land"),
        ..down_the_valley()
    }
);

fn among_textured_blades() -> Golden {
    Golden { scene: "blades", eye: over([32.0, 43.0], 0.9, 10.0, -14.0), ..Golden::default() }
}

golden!(cut, Golden { shows: "edges that are cut", unlike: Unlike::Stored("sorted"), ..among_textured_blades() });
golden!(
    sorted,
    Golden {
        shows: "blades blended far to near",
        look: look(BlendOrder::Sorted, FarPlants::Land),
        unlike: Unlike::Stored("cut"),
        ..among_textured_blades()
    }
);
golden!(
    precomputed,
    Golden {
        shows: "blades blended in an order made beforehand",
        look: look(BlendOrder::Precomputed, FarPlants::Land),
        unlike: Unlike::Stored("cut"),
        ..among_textured_blades()
    }
);
golden!(
    weighted,
    Golden {
        shows: "blades blended by weight",
        look: look(BlendOrder::Weighted, FarPlants::Land),
        unlike: Unlike::Stored("sorted"),
        ..among_textured_blades()
    }
);

fn finely() -> Golden {
    Golden { quality: Quality::High, size_px: [128, 72], frames: 1, ..among_textured_blades() }
}

golden!(
    high,
    Golden {
        shows: "edges that are cut, with four samples a pixel",
        unlike: Unlike::RenderOptions(look(BlendOrder::Coverage, FarPlants::Land)),
        ..finely()
    }
);
golden!(
    coverage,
    Golden {
        shows: "opacity as a fraction of samples",
        look: look(BlendOrder::Coverage, FarPlants::Land),
        unlike: Unlike::Stored("high"),
        ..finely()
    }
);
golden!(
    ultra,
    Golden { shows: "four pixels drawn for each, tone mapped to one", quality: Quality::Ultra, unlike: Unlike::Stored("high"), ..finely() }
);
