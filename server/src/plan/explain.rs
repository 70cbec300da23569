//! Explains a scene and its plan.

use super::client_rows::{blades_row, picture_row, stream_row};
use super::fronts::{Fronts, FrontsInUse};
use super::{Plan, Progress, is_demanded};
use crate::detail::{Demands, WindDemand};
use crate::scenes::{Explanation, ExplanationRow as Row, OpenScene, millis};
use prairie_core::scene::{PlantCover, Scene, VehicleKind, WindMethod, WindTiling};

/// Explains a scene, which is planned or measured for it.
pub fn explain(scene: &OpenScene, used: &FrontsInUse, progress: &mut dyn Progress) -> Explanation {
    explain_plan(scene, &scene.plan(used, progress), used)
}

/// Explains a scene without pilot runs: its methods, and what it leaves out.
pub(super) fn explain_unmeasured(scene: &OpenScene) -> Explanation {
    let plan = Plan::unmeasured(scene);
    let sources = vec![format!("errors and costs: `prairie explain {}` measures them", scene.loaded.name)];
    Explanation { sources, ..explain_plan(scene, &plan, &FrontsInUse { fronts: Fronts::built_in(), origin: String::new() }) }
}

pub(super) fn explain_plan(scene: &OpenScene, plan: &Plan, used: &FrontsInUse) -> Explanation {
    let own = &scene.loaded.scene;
    Explanation {
        scene: scene.loaded.name.clone(),
        is_planned: is_demanded(own),
        rows: rows(scene, plan),
        left_out: left_out(own),
        not_planned: not_planned(own, plan),
        sources: sources(plan, used),
        conflicts: plan.conflicts.clone(),
        demands: is_demanded(own).then(|| demands(own, plan)),
    }
}

fn rows(scene: &OpenScene, plan: &Plan) -> Vec<Row> {
    let parts = [
        Some(wind_row(scene, plan)),
        Some(bend_row(scene, plan)),
        Some(stream_row(scene, plan.wind.as_ref().ok(), plan.bend.theta_error_deg)),
        Some(blades_row(scene, plan.blades.as_ref())),
        plan.picture.as_ref().map(|picture| picture_row(scene, picture)),
        Some(objects_row(scene)),
    ];
    parts.into_iter().flatten().collect()
}

/// What a run of the planned scene has to keep: its tolerances, and its budget or half a tick.
fn demands(own: &Scene, plan: &Plan) -> Demands {
    let (tolerances, [server_ms, _, kbit_per_s]) = (own.accuracy.tolerances(), own.budget.limits());
    let wind = plan.wind.as_ref().ok().zip(tolerances.wind).map(|(wind, tolerance)| WindDemand {
        tolerance: tolerance as f32,
        planned: wind.chosen.error as f32,
        rms_m_per_s: wind.reference.1 as f32,
    });
    Demands {
        wind,
        bend_deg: tolerances.bend_deg.map(|deg| deg as f32),
        planned_bend_deg: plan.bend.measured_deg.map_or(0.0, |_| plan.bend.error_deg() as f32),
        server_ms: server_ms.map_or(500.0 / own.tick_hz, |ms| ms as f32),
        kbit_per_s: kbit_per_s.map(|kbit_per_s| kbit_per_s as f32),
    }
}

fn wind_row(scene: &OpenScene, plan: &Plan) -> Row {
    let (own, stated) = (&scene.loaded.scene, scene.stated_in(&["wind"]));
    let part = "wind that the grass feels".to_owned();
    let Ok(wind) = &plan.wind else {
        let method = super::WindSettings::of(own).words(own.wind.method);
        let error = plan.wind.as_ref().err().map_or_else(String::new, |reason| format!("not measured: {reason}"));
        return Row { part, method, error, server_ms_per_tick: None, stated, planned: Vec::new() };
    };
    let (before, chosen) = (wind.own.settings, wind.chosen.settings);
    let changes = [
        ("wind.cells", before.cells != chosen.cells),
        ("wind.advection", before.advection != chosen.advection),
        ("wind.time", before.time != chosen.time),
        ("wind.diffusion", before.diffusion != chosen.diffusion),
        ("wind.pressure", before.pressure != chosen.pressure),
        ("wind.pressure_tolerance", before.tolerance != chosen.tolerance),
        ("wind.step_secs", before.ticks != chosen.ticks),
        ("stream.wind_error_m_per_s", own.stream.wind_error_m_per_s != wind.wind_error_m_per_s),
    ];
    let mut planned: Vec<_> = changes.into_iter().filter(|(_, is_changed)| *is_changed).map(|(field, _)| field.to_owned()).collect();
    if before != chosen {
        let (own_ms, own_percent) = (millis(wind.own.ms_per_tick), 100.0 * wind.own.error);
        planned.push(format!("instead of {}, with {own_percent:.3} % and {own_ms} ms", before.words(own.wind.method)));
    }
    Row {
        part,
        method: chosen.words(own.wind.method),
        error: format!("{:.3} % of {:.2} m/s rms", 100.0 * wind.chosen.error, wind.reference.1),
        server_ms_per_tick: Some(wind.chosen.ms_per_tick)
            .filter(|_| own.wind.method == WindMethod::StableFluids || Fronts::knows(chosen.pressure)),
        stated,
        planned,
    }
}

fn bend_row(scene: &OpenScene, plan: &Plan) -> Row {
    let bend = &plan.bend;
    let (codes_deg, rest_deg) = (bend.theta_error_deg, f64::from(bend.rest_theta_rad).to_degrees());
    Row {
        part: "bending of the grass".to_owned(),
        method: format!("{} waves; codes to {codes_deg} deg, at rest below {rest_deg:.3} deg", bend.scheme.word()),
        error: match bend.measured_deg {
            Some(measured_deg) => {
                format!("{:.3} deg rms behind a car, of which {measured_deg:.3} by scheme and rest", bend.error_deg())
            }
            None => {
                format!("at most {codes_deg} deg by codes; not measured behind a car")
            }
        },
        server_ms_per_tick: bend.ms_per_tick,
        stated: scene.stated_in(&["bend", "grass", "stream"]),
        planned: bend.planned.clone(),
    }
}

fn objects_row(scene: &OpenScene) -> Row {
    let objects = &scene.loaded.scene.objects;
    let kinds = VehicleKind::ALL.map(|kind| kind.name()).join(", ");
    let method = format!("rigid bodies, at most {} of {kinds}; {} drive themselves", objects.limit, objects.self_driving);
    Row {
        part: "objects".to_owned(),
        method,
        error: "not measured for a scene".to_owned(),
        server_ms_per_tick: None,
        stated: scene.stated_in(&["objects"]),
        planned: Vec::new(),
    }
}

/// Parts that the scene leaves out, with the field that says so.
fn left_out(scene: &Scene) -> Vec<String> {
    let Scene { wind, objects, .. } = scene;
    let parts = [
        (wind.dust.release_per_s == 0.0, "dust: `wind.dust.release_per_s` is 0, so no density is carried"),
        (wind.sources == 0, "gusts: `wind.sources` is 0"),
        (wind.turbulence == 0.0, "gusts below the cells: `wind.turbulence` is 0"),
        (wind.primitives.is_empty(), "whirls and jets: there is no `[[wind.primitives]]`"),
        (wind.canopy_drag_per_m == 0.0, "drag of the grass: `wind.canopy_drag_per_m` is 0"),
        (wind.canopy_frequency_hz == 0.0, "grass that acts back on the wind: `wind.canopy_frequency_hz` is 0"),
        (wind.crown_drag_per_m == 0.0, "drag of crowns: `wind.crown_drag_per_m` is 0"),
        (!crate::weather::pilot::has_walls(scene), "land as an obstacle: `wind.terrain` is \"follow\""),
        (scene.natural_wind.strength_rad_per_s2 == 0.0, "gusts of noise: `natural_wind.strength_rad_per_s2` is 0"),
        (scene.drawn_winds.is_empty(), "drawn winds: there is no `[[drawn_winds]]`"),
        (objects.limit == 0, "vehicles: `objects.limit` is 0, so no physics of bodies"),
        (objects.balls == 0, "balls: `objects.balls` is 0"),
        (scene.underbrush.is_empty(), "underbrush: there is no `[[underbrush]]`"),
        (scene.models.is_empty(), "models on the land: there is no `[[models]]`"),
        (!scene.snow.lies(), "snow: `snow.depth_m` is 0"),
        (scene.rain.rate_mm_per_h == 0.0, "rain: `rain.rate_mm_per_h` is 0"),
        (scene.race.gates.is_empty(), "a race: there is no `[[race.gates]]`"),
        (scene.lights.is_empty(), "lamps: there is no `[[lights]]`"),
    ];
    parts.into_iter().filter(|(is_out, _)| *is_out).map(|(_, why)| why.to_owned()).collect()
}

/// Settings that no plan chooses, and demands that no plan looks at.
fn not_planned(scene: &Scene, plan: &Plan) -> Vec<String> {
    let demands = [
        (
            !scene.accuracy.blades.is_empty() && scene.plants.cover != PlantCover::Blades,
            "`accuracy.blades`: with `plants.cover = \"shells\"` there are no single blades",
        ),
        (
            !scene.accuracy.blades.is_empty() && plan.blades.as_ref().is_some_and(|blades| blades.segments.contains(&0)),
            "`accuracy.blades` for strips whose stated `plants.blade_segments` is 0: the quality of the picture decides",
        ),
        (scene.accuracy.picture > 0.0, "`accuracy.picture` on other cards and sizes: its errors are those of ten views of built-in scenes"),
    ];
    let always = [
        "vertical cells of the wind: the grass feels the lowest cells, so that their height is a part of the model",
        "`grass.segments`: it is another model, not another error",
        "`wind.cells` for `budget.kbit_per_s`: only codes become coarser",
        "`bend.seams`, `bend.object_contact` and their like: they are other models, not other errors",
        "`wind.dust.advection`: the error is that of the wind alone",
    ];
    let patch = (scene.wind.tiling == WindTiling::Patch)
        .then_some("`wind.cells`: with `tiling = \"patch\"` the offset of a patch is a number of cells");
    demands.into_iter().filter(|(is_made, _)| *is_made).map(|(_, why)| why).chain(always).chain(patch).map(str::to_owned).collect()
}

fn sources(plan: &Plan, used: &FrontsInUse) -> Vec<String> {
    let mut sources = Vec::new();
    if let Ok(wind) = &plan.wind {
        let ([x, y, z], [candidates, runs]) = (wind.reference.0, wind.runs);
        sources.push(format!(
            "errors: {runs} pilot runs of {candidates} candidates over {} s from the wind after its warm-up, against a run in double precision on {x} × {y} × {z} \
             cells with two steps a tick",
            crate::weather::pilot::HORIZON_SECS
        ));
    }
    sources.push(format!("costs: {}", used.origin));
    sources
}
