//! Charts of a whole world: bits on the wire, the picture, shells, and the wind around a tree. Those of single methods are in [`prairie_charts`].
//!
//! | module | what it does |
//! |---|---|
//! | [`stream`] | bits on the wire against the error of the grass |
//! | [`picture`] | render options: frame time against similarity, and figures of other kinds |
//! | [`shells`] | cost of shell layers and of lamps on them |
//! | [`scene`] | a whole scene: error of its grass against the time of the steps |
//! | `lee` | wind and grass around a tree in the wind of a scene |
//! | [`still`], [`views`] | frozen moments of scenes, and the ten views |
//! | [`similarity`], [`texture`] | differences of pictures as a viewer sees them |
//! | [`image`] | 8-bit RGBA pictures |
//! | [`worlds`] | worlds made without files |

pub mod image;
mod lee;
pub mod picture;
pub mod scene;
pub mod shells;
pub mod similarity;
pub mod still;
pub mod stream;
pub mod texture;
pub mod views;
pub mod worlds;

use prairie_charts::figure::Figure;
use prairie_charts::{MODELS, Model, Problem};

/// The models of whole worlds.
static WORLD_MODELS: [Model; 4] = [
    Model {
        name: "stream",
        about: "bits of the grass on the wire against its error",
        problems: no_problems,
        figures: &stream::FIGURES,
        failures: &[],
    },
    Model {
        name: "picture",
        about: "render options: frame time against visible error; needs a Vulkan driver",
        problems: picture::problems,
        figures: &picture::FIGURES,
        failures: &[],
    },
    Model {
        name: "shells",
        about: "cost of shell layers and of lamps on them; needs a Vulkan driver",
        problems: no_problems,
        figures: &shells::FIGURES,
        failures: &[],
    },
    Model {
        name: "scene",
        about: "a whole scene: error of its grass after a drive against the time of its steps",
        problems: scene::problems,
        figures: &[Figure { name: "lee", title: "The lee of a tree", draw: lee::draw_lee }],
        failures: &[],
    },
];

fn no_problems(_quick: bool) -> Vec<Problem> {
    Vec::new()
}

/// All models, those of single methods first.
pub fn models() -> impl Iterator<Item = &'static Model> {
    MODELS.iter().chain(&WORLD_MODELS)
}
