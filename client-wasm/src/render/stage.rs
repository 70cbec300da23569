//! Stages of loading a scene. A viewer needs land and sky first; a picture can be drawn after each stage.

use crate::render::gpu::pipeline::PassFactory;
use crate::render::land_and_sky::dust::Dust;
use crate::render::land_and_sky::rain::Rain;
use crate::render::options::quality::Quality;
use crate::render::plants::blades::Blades;
use crate::render::plants::force_field::CameraForceField;
use crate::render::plants::underbrush::Underbrush;
use crate::render::solids::objects::ObjectPasses;
use crate::render::solids::trees_and_stones::placed_models;
use crate::state::DecodedScene;
use prairie_core::scene::PlantCover;

/// A stage of loading a scene, in the order in which a viewer needs them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Land, drawn as if all grass were far away, and sky.
    Land,
    /// Grass and flowers near the camera.
    Grass,
    /// Vehicles, trees and stones, and their shadows.
    Solids,
    /// Underbrush, and the forces on it.
    Underbrush,
    /// Rain and dust.
    Weather,
}

impl Stage {
    /// All stages in order.
    pub const ALL: [Self; 5] = [Self::Land, Self::Grass, Self::Solids, Self::Underbrush, Self::Weather];

    /// Name, as the client reports it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Land => "land",
            Self::Grass => "grass",
            Self::Solids => "solids",
            Self::Underbrush => "underbrush",
            Self::Weather => "weather",
        }
    }

    /// The next stage that adds something to a scene; `None` after the last one.
    pub fn next(self, decoded: &DecodedScene) -> Option<Self> {
        Self::ALL.into_iter().find(|&stage| stage > self && stage.adds_to(decoded))
    }

    fn adds_to(self, decoded: &DecodedScene) -> bool {
        let scene = decoded.scene();
        match self {
            Self::Land | Self::Solids => true,
            Self::Grass => scene.plants.cover == PlantCover::Blades,
            Self::Underbrush => decoded.flora().is_some(),
            Self::Weather => scene.rain.rate_mm_per_h > 0.0 || scene.wind.has_dust(),
        }
    }
}

/// Resources of a stage after [`Stage::Land`].
pub(super) enum StageResources {
    Grass(Box<Blades>),
    Solids(Box<ObjectPasses>),
    Underbrush(Option<Box<Underbrush>>),
    Weather(Option<Rain>, Option<Dust>),
}

impl StageResources {
    /// Creates the resources of `stage`; `None` for land, which a scene begins with.
    pub(super) fn new(
        stage: Stage,
        factory: &PassFactory,
        quality: Quality,
        decoded: &DecodedScene,
        forces: &CameraForceField,
    ) -> Option<Self> {
        Some(match stage {
            Stage::Land => return None,
            Stage::Grass => Self::Grass(Box::new(Blades::new(factory, quality, decoded, forces))),
            Stage::Solids => Self::Solids(Box::new(ObjectPasses::new(factory, quality, decoded, placed_models(decoded)))),
            Stage::Underbrush => Self::Underbrush(Underbrush::new(factory, quality, decoded, forces).map(Box::new)),
            Stage::Weather => Self::Weather(Rain::new(factory, quality, decoded), Dust::new(factory, quality, decoded)),
        })
    }
}
