//! Range checks of a scene's underbrush.

use super::error::{MirrorError, range, within};
use prairie_core::plant::underbrush::plan::SECTIONS_LIMIT;
use prairie_core::scene::{COMPONENTS_LIMIT, Component, Growth, PARTS_LIMIT, SITES_LIMIT, SPECIES_LIMIT, Scene, Underbrush};

/// Checks the underbrush species of a scene and the growth settings.
pub(super) fn check_underbrush(scene: &Scene) -> Result<(), MirrorError> {
    let Growth { richness, patch_m, spacing_m, shade, .. } = scene.growth;
    for fraction in richness.into_iter().chain([shade]) {
        within("growth.*", fraction, 0.0, 1.0)?;
    }
    within("growth.patch_m", patch_m, 1.0, 1000.0)?;
    within("growth.spacing_m", spacing_m, 0.05, 20.0)?;
    if scene.underbrush.len() > SPECIES_LIMIT {
        return Err(range("number of underbrush species", scene.underbrush.len(), format!("at most {SPECIES_LIMIT}")));
    }
    let sites: u64 = scene.growth.sites(scene.extent_m()).into_iter().map(u64::from).product();
    if sites > SITES_LIMIT && !scene.underbrush.is_empty() {
        return Err(range("number of plant sites", sites, format!("at most {SITES_LIMIT}")));
    }
    scene.underbrush.iter().try_for_each(check_species)
}

fn check_species(species: &Underbrush) -> Result<(), MirrorError> {
    within("underbrush.settle_secs", species.settle_secs, 0.0, 10.0)?;
    within("underbrush.posture_angles", species.posture_angles as f32, 2.0, 65.0)?;
    within("underbrush.posture_loads", species.posture_loads as f32, 2.0, 65.0)?;
    within("underbrush.size_variation", species.size_variation, 0.0, 0.9)?;
    within("underbrush.room_m", species.room_m, 0.05, 20.0)?;
    within("underbrush.reach_m", species.reach_m, 0.0, 50.0)?;
    within("underbrush.propagation_points", species.propagation_points as f32, 0.0, 10_000.0)?;
    for fraction in species.needs.into_iter().chain(species.uptake).chain([species.light_need]) {
        within("needs of underbrush", fraction, 0.0, 1.0)?;
    }
    within("number of components", species.components.len() as f32, 1.0, COMPONENTS_LIMIT as f32)?;
    for (index, component) in species.components.iter().enumerate() {
        check_component(component)?;
        if !component.on.is_empty() && species.branch_below(index).is_none() {
            return Err(range("parent of a component", &component.on, "an earlier branch, or empty"));
        }
    }
    let parts = species.parts().into_iter().fold(0, u64::saturating_add);
    if parts > PARTS_LIMIT {
        return Err(range("number of parts of a plant", parts, format!("at most {PARTS_LIMIT}")));
    }
    Ok(())
}

fn check_component(component: &Component) -> Result<(), MirrorError> {
    let sections = ("sections", component.sections, 1, SECTIONS_LIMIT as u32);
    let whole = [("count", component.count, 1, 32), ("petals", component.petals, 3, 16), sections];
    for (what, value, low, high) in whole {
        within(what, value as f32, low as f32, high as f32)?;
    }
    let numbers = [
        ("from_share", component.from_share, 0.0, 1.0),
        ("to_share", component.to_share, component.from_share, 1.0),
        ("length_m", component.length_m, 0.005, 5.0),
        ("length_variation", component.length_variation, 0.0, 0.9),
        ("width_m", component.width_m, 0.0005, 1.0),
        ("mass_kg", component.mass_kg, 1e-6, 10.0),
        ("stiffness_n_m2", component.stiffness_n_m2, 1e-9, 1000.0),
        ("tip_stiffness_share", component.tip_stiffness_share, 0.01, 1.0),
        ("strength_n_m", component.strength_n_m, 0.0, 10_000.0),
        ("angle_rad", component.angle_rad, 0.0, 3.1),
        ("angle_variation_rad", component.angle_variation_rad, 0.0, 1.5),
        ("turn_rad", component.turn_rad, -6.3, 6.3),
    ];
    for (what, value, low, high) in numbers {
        within(what, value, low, high)?;
    }
    for channel in component.root_rgb.into_iter().chain(component.tip_rgb) {
        within("*_rgb", channel, 0.0, 1.0)?;
    }
    Ok(())
}
