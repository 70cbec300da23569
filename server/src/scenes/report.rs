//! Summary of a valid scene for `prairie check`.

use super::error::SceneError;
use super::load::load_open;
use super::loaded::LoadedScene;
use crate::escaped::escaped;
use prairie_core::scene::VehicleKind;
use prairie_core::terrain::{Cover, model_boxes};
use prairie_core::wire::ModelUse;
use std::ffi::OsStr;
use std::fmt;

/// Summary of a valid scene; displayed on a few lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    name: String,
    loaded: LoadedScene,
}

/// Loads and summarises a scene.
///
/// # Errors
/// As [`load`](super::load).
pub fn check(name_or_path: impl AsRef<OsStr>) -> Result<Report, SceneError> {
    Ok(Report { name: escaped(&name_or_path), loaded: load_open(name_or_path)?.loaded })
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let LoadedScene { scene, nutrient_png, height, cover, models, .. } = &self.loaded;
        let [width_m, depth_m] = scene.extent_m();
        let [nx, nz] = scene.patches.count;
        let [low, high] = height.range_m();
        let [height_x, height_z] = height.size_px();
        let [cover_x, cover_z] = cover.size_px();
        let count = |cover_id| cover.ids().iter().filter(|&&id| Cover::from(id) == cover_id).count();
        let percent = |count: usize| 100.0 * count as f64 / cover.ids().len() as f64;
        let grass = percent(cover.ids().iter().filter(|&&id| scene.is_grass(Cover::from(id))).count());

        writeln!(f, "{}: valid", self.name)?;
        writeln!(f, "  {}", scene.summary)?;
        writeln!(f, "  world     {width_m} m × {depth_m} m, {nx} × {nz} patches of {0} × {0} cells", scene.patches.cells)?;
        writeln!(f, "  heights   {low:.1} m to {high:.1} m, {height_x} × {height_z} pixels")?;
        write!(f, "  covering  {cover_x} × {cover_z} pixels, {grass:.0} % grass")?;
        writeln!(f, ", {} trees, {} stones", count(Cover::Tree), count(Cover::Stone))?;
        if !scene.species.is_empty() {
            let species =
                scene.species.iter().map(|species| format!("{} ({:.0} %)", species.name, percent(count(Cover::from(species.cover)))));
            writeln!(f, "  species   {}", species.collect::<Vec<_>>().join(", "))?;
        }
        if !scene.underbrush.is_empty() {
            let species: Vec<_> = scene.underbrush.iter().map(|species| species.name.as_str()).collect();
            let [columns, rows] = scene.growth.sites(scene.extent_m());
            let soil = if nutrient_png.is_empty() { "generated" } else { "drawn" };
            writeln!(f, "  underbrush {}, on {columns} × {rows} sites of {soil} soil", species.join(", "))?;
        }
        let triangles = |count: usize| if count == 1 { "1 triangle".to_owned() } else { format!("{count} triangles") };
        if !scene.models.is_empty() {
            let boxes = model_boxes(scene, cover);
            let count = |index: usize| boxes.iter().filter(|own| own.model == index).count();
            let placed: Vec<_> = scene.models.iter().enumerate().map(|(i, model)| format!("{} {}", count(i), model.name)).collect();
            writeln!(f, "  placed    {}", placed.join(", "))?;
        }
        let of_vehicles = models.iter().filter_map(|(used, mesh)| match used {
            ModelUse::Vehicle(kind) => Some((kind, mesh)),
            ModelUse::Cover(_) => None,
        });
        let models: Vec<_> = of_vehicles.map(|(kind, mesh)| format!("{} ({})", kind.name(), triangles(mesh.indices.len() / 3))).collect();
        let built_in: Vec<_> = VehicleKind::ALL.iter().map(|kind| kind.name()).collect();
        let models = if models.is_empty() { format!("built-in {}", built_in.join(", ")) } else { models.join(", ") };
        write!(f, "  models    {models}")
    }
}
