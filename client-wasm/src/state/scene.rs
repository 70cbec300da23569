//! The scene as the client holds it: settings, decoded maps, underbrush and models. Constant until the next scene.

use super::check::{check, check_bodies, check_mesh};
use super::error::{MirrorError, range};
use prairie_core::body::Body;
use prairie_core::grass::wind_drawing::{WindDrawing, WindDrawings};
use prairie_core::grass::{BendSimulation, Replica, ReplicaError, ReplicaState};
use prairie_core::grid::PatchLayout;
use prairie_core::plant::flora::Flora;
use prairie_core::plant::growth::NutrientMap;
use prairie_core::scene::{Scene, VehicleKind};
use prairie_core::terrain::{CoverMap, HeightMap, KindMap, clear_under_models};
use prairie_core::wind::{WindField, WindTiles};
use prairie_core::wire::quantise::CodeSteps;
use prairie_core::wire::{Drawing, Mesh, ModelUse, Shapes};
use prairie_vehicles::{Environment, LoneVehicle};
use std::sync::Arc;

/// Largest number of wind drawings.
const DRAWINGS_LIMIT: usize = 32;

/// A scene with its decoded maps.
#[derive(Clone, Debug)]
pub struct DecodedScene {
    scene: Scene,
    layout: PatchLayout,
    heights: Arc<HeightMap>,
    cover: Arc<CoverMap>,
    kinds: Arc<KindMap>,
    flora: Option<Flora>,
    models: Vec<(ModelUse, Mesh)>,
    bodies: Vec<Body>,
    drawings: WindDrawings,
    tiles: WindTiles,
    steps: CodeSteps,
}

impl DecodedScene {
    /// Validates the scene, decodes its maps and grows its underbrush.
    ///
    /// # Errors
    /// [`MirrorError`] if a map cannot be decoded or a value is out of range.
    pub fn new(
        scene: Scene,
        height_png: &[u8],
        covering_png: &[u8],
        nutrient_png: &[u8],
        models: Vec<(ModelUse, Mesh)>,
        shapes: Shapes,
    ) -> Result<Self, MirrorError> {
        check(&scene)?;
        check_bodies(&shapes.bodies)?;
        let heights = HeightMap::from_png(height_png, &scene.terrain);
        let heights = Arc::new(heights.map_err(|error| MirrorError::Map { map: "height map", error })?);
        let mut cover = CoverMap::from_png(covering_png).map_err(|error| MirrorError::Map { map: "covering map", error })?;
        clear_under_models(&scene, &mut cover);
        let cover = Arc::new(cover);
        let nutrients = (!nutrient_png.is_empty()).then(|| NutrientMap::from_png(nutrient_png));
        let nutrients = nutrients.transpose().map_err(|error| MirrorError::Map { map: "nutrient map", error })?;
        for (_, mesh) in &models {
            check_mesh(mesh)?;
        }
        let drawings = drawings(&shapes)?;
        let layout = PatchLayout::from(&scene.patches);
        let (tiles, kinds) = (WindTiles::new(&scene), Arc::new(KindMap::new(&scene, &cover)));
        let flora = Flora::new(&scene, &cover, nutrients.as_ref());
        let steps = CodeSteps::from(&scene.stream);
        Ok(Self { scene, layout, heights, cover, kinds, flora, models, bodies: shapes.bodies, drawings, tiles, steps })
    }

    /// Settings of the scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Layout of the patch grid.
    pub fn layout(&self) -> &PatchLayout {
        &self.layout
    }

    /// Tiling of the world by the wind domain.
    pub fn tiles(&self) -> &WindTiles {
        &self.tiles
    }

    /// Steps of the codes of wind and patches.
    pub fn code_steps(&self) -> &CodeSteps {
        &self.steps
    }

    /// The height map.
    pub fn heights(&self) -> &HeightMap {
        &self.heights
    }

    /// The covering map, cleared under the models.
    pub fn cover(&self) -> &CoverMap {
        &self.cover
    }

    /// A vehicle of this kind, alone on the terrain of the scene.
    pub fn lone_vehicle(&self, kind: VehicleKind) -> LoneVehicle {
        let (height, cover) = (Arc::clone(&self.heights), Arc::clone(&self.cover));
        LoneVehicle::new(&self.scene, Environment { height, cover, extent_m: self.scene.extent_m() }, kind)
    }

    /// Still air over the scene.
    pub(super) fn still_air(&self) -> WindField {
        WindField::still(&self.scene, Arc::clone(&self.kinds))
    }

    /// A replica of the server's grass, from its state.
    ///
    /// # Errors
    /// [`ReplicaError`] when the state is that of another scene.
    pub fn replica(&self, state: ReplicaState) -> Result<Replica, ReplicaError> {
        let at_rest = BendSimulation::new(&self.scene, Arc::clone(&self.heights), &self.cover, &self.bodies, &self.drawings);
        Replica::new(at_rest, self.still_air(), self.scene.dt_secs(), state)
    }

    /// Map of grass kinds.
    pub fn kinds(&self) -> &KindMap {
        &self.kinds
    }

    /// The underbrush; `None` if the scene has none.
    pub fn flora(&self) -> Option<&Flora> {
        self.flora.as_ref()
    }

    /// Models of vehicles that replace the built-in ones, and those of the covering map.
    pub fn models(&self) -> &[(ModelUse, Mesh)] {
        &self.models
    }
}

/// The wind drawings, decoded.
fn drawings(shapes: &Shapes) -> Result<WindDrawings, MirrorError> {
    if shapes.drawings.len() > DRAWINGS_LIMIT {
        return Err(range("number of wind drawings", shapes.drawings.len(), format!("at most {DRAWINGS_LIMIT}")));
    }
    let decode = |drawing: &Drawing| {
        let decoded =
            WindDrawing::from_png(&drawing.png).map_err(|error| range("wind drawing", format!("a file that {error}"), "a wind drawing"))?;
        Ok((drawing.name.clone(), Arc::new(decoded)))
    };
    shapes.drawings.iter().map(decode).collect()
}
