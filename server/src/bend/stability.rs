//! Stability check: sub-steps of the bend field when the grass is struck at the greatest possible speed.

use crate::settings_error::SettingsError;
use prairie_core::bend::{Damping, Scheme, WaveParams, limits};
use prairie_core::scene::{DrawnWind, Grass, Patches, Scene, VehicleKind};
use prairie_vehicles::SPEED_LIMIT_M_PER_S;

/// Largest number of sub-steps per step that a scene's grass may need.
const SUBSTEP_LIMIT: u32 = 64;

/// Changes one setting back to its default.
type Reset = Box<dyn Fn(&mut Scene)>;

/// Checks that the scheme can follow the grass of `scene` when it is struck at the greatest possible speed.
///
/// # Errors
/// [`SettingsError`] names the field whose default value would reduce the number of sub-steps most.
pub fn check(scene: &Scene) -> Result<(), SettingsError> {
    let allowed = match scene.bend.scheme {
        Scheme::Verlet => 1,
        Scheme::Substepped => SUBSTEP_LIMIT,
        Scheme::Implicit | Scheme::Modal => return Ok(()),
    };
    let needed = substeps_when_struck(scene);
    if needed <= allowed {
        return Ok(());
    }
    let needed_with = |reset: &Reset| {
        let mut changed = scene.clone();
        reset(&mut changed);
        substeps_when_struck(&changed)
    };
    let (field, _) = resets().into_iter().min_by_key(|(_, reset)| needed_with(reset)).expect("the list is not empty");
    Err(SettingsError { field, message: message(scene, needed, allowed) })
}

/// The fields that can make the grass too stiff, by path.
fn resets() -> Vec<(String, Reset)> {
    fn of(field: &str, reset: impl Fn(&mut Scene) + 'static) -> (String, Reset) {
        (field.to_owned(), Box::new(reset))
    }
    let treads = VehicleKind::ALL.map(|kind| {
        let field = format!("objects.{}.strike_height_m", kind.name());
        of(&field, move |scene| scene.objects.reset_tread(kind))
    });
    let others = [
        of("grass.mu_m_per_rad", |scene| scene.grass.waves.mu_m_per_rad = Grass::default().waves.mu_m_per_rad),
        of("grass.c0_m_per_s", |scene| scene.grass.waves.c0_m_per_s = Grass::default().waves.c0_m_per_s),
        of("grass.c_omega_m_per_s", |scene| scene.grass.waves.c_omega_m_per_s = Grass::default().waves.c_omega_m_per_s),
        of("grass.stiffness_per_s2", |scene| scene.grass.waves.stiffness_per_s2 = Grass::default().waves.stiffness_per_s2),
        of("species", |scene| scene.species.clear()),
        of("patches.cell_m", |scene| scene.patches.cell_m = Patches::default().cell_m),
        of("tick_hz", |scene| scene.tick_hz = 60.0),
    ];
    others.into_iter().chain(treads).chain([of("drawn_winds", |scene| scene.drawn_winds.clear())]).collect()
}

fn message(scene: &Scene, needed: u32, allowed: u32) -> String {
    let stiffest = scene.kinds().into_iter().max_by_key(|grass| substeps_of(scene, &[grass.waves])).unwrap_or(scene.grass);
    let WaveParams { c0_m_per_s, mu_m_per_rad, c_omega_m_per_s, stiffness_per_s2, .. } = stiffest.waves;
    let (_, by) = hardest_strike(scene);
    format!(
        "makes the grass too stiff: with `bend.scheme` = \"{}\" it needs {needed} sub-steps in a step when {by}; \
         allowed: {allowed}. It has mu_m_per_rad = {mu_m_per_rad}, c0_m_per_s = {c0_m_per_s}, \
         c_omega_m_per_s = {c_omega_m_per_s}, stiffness_per_s2 = {stiffness_per_s2} on cells of {} m at {} Hz; smaller ones, a larger cell_m or a \
         higher tick_hz need fewer",
        scene.bend.scheme.word(),
        scene.patches.cell_m,
        scene.tick_hz
    )
}

fn substeps_when_struck(scene: &Scene) -> u32 {
    let waves: Vec<_> = scene.kinds().iter().map(|grass| grass.waves).collect();
    substeps_of(scene, &waves)
}

fn substeps_of(scene: &Scene, waves: &[WaveParams]) -> u32 {
    let (omega_rad_per_s, _) = hardest_strike(scene);
    let damping = if scene.bend.scheme == Scheme::Verlet { Damping::Plain } else { Damping::Exact };
    let needed = limits::substeps(waves, scene.patches.cell_m, scene.dt_secs(), omega_rad_per_s, damping);
    needed.unwrap_or(limits::SUBSTEPS_LIMIT)
}

/// Greatest bending speed (rad/s) that an object or wind causes, and its cause in words.
fn hardest_strike(scene: &Scene) -> (f32, String) {
    let object = |kind| {
        (SPEED_LIMIT_M_PER_S / scene.objects.tread(kind).strike_height_m, format!("an object strikes it at {SPEED_LIMIT_M_PER_S} m/s"))
    };
    let wind =
        |wind: &DrawnWind| (wind.speed_m_per_s / wind.strike_height_m, format!("a drawn wind of {} m/s strikes it", wind.speed_m_per_s));
    let strikes = VehicleKind::ALL.map(object).into_iter().chain(scene.drawn_winds.iter().map(wind));
    strikes.max_by(|a, b| a.0.total_cmp(&b.0)).expect("there are kinds of objects")
}
