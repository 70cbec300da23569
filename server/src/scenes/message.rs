//! The message with everything that is constant in a run of a scene.

use super::LoadedScene;
use prairie_core::wire::{Drawing, ServerMessage, Shapes};

impl LoadedScene {
    /// The scene as a message to clients.
    pub fn message(&self) -> ServerMessage {
        let drawings = self.drawings.iter().map(|(name, drawing)| Drawing { name: name.clone(), png: drawing.png().to_vec() });
        ServerMessage::Scene {
            scene: Box::new(self.scene.clone()),
            height_png: self.height_png.clone(),
            covering_png: self.covering_png.clone(),
            nutrient_png: self.nutrient_png.clone(),
            models: self.models.clone(),
            shapes: Shapes { bodies: prairie_vehicles::bodies(&self.scene.objects), drawings: drawings.collect() },
        }
    }
}
