//! Vehicles in the grass.

use crate::{Golden, Unlike, golden};
use anyhow::Result;
use prairie::charts::views::Eye;
use prairie::studio::Act;

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
