//! Explanation of what the clients of a scene get and draw: data, blades, picture.

use super::blades::BladePlan;
use super::picture::PicturePlan;
use super::wind::WindPlan;
use crate::scenes::{ExplanationRow as Row, OpenScene};
use prairie_core::scene::PlantCover;

const UNMEASURED: &str = "not measured for a scene";

/// The row of the stream, with the plan of the wind and the error of the codes of θ (degrees).
pub(super) fn stream_row(scene: &OpenScene, wind: Option<&WindPlan>, theta_error_deg: f32) -> Row {
    let own = &scene.loaded.scene;
    let wind_m_per_s = wind.map_or(own.stream.wind_error_m_per_s, |wind| wind.wind_error_m_per_s);
    let limit = match own.budget.limits()[2] {
        Some(kbit_per_s) => format!("; at most {kbit_per_s} kbit/s to each client"),
        None => String::new(),
    };
    let data = wind.and_then(|wind| wind.kbit_per_s);
    Row {
        part: "data to each client".to_owned(),
        method: format!("codes of the wind to {wind_m_per_s} m/s, of the bend to {theta_error_deg} deg{limit}"),
        error: data.map_or_else(
            || UNMEASURED.to_owned(),
            |kbit_per_s| format!("that of the codes is in the errors above; frames of the wind take {kbit_per_s:.1} kbit/s"),
        ),
        server_ms_per_tick: None,
        stated: scene.stated_in(&["stream"]),
        planned: Vec::new(),
    }
}

pub(super) fn blades_row(scene: &OpenScene, plan: Option<&BladePlan>) -> Row {
    let own = &scene.loaded.scene;
    let segments = plan.map_or(own.plants.blade_segments, |plan| plan.segments);
    let [near, farther] =
        segments.map(|segments| if segments == 0 { "as many as the quality has".to_owned() } else { segments.to_string() });
    let integrator = plan.map_or(own.plants.integrator, |plan| plan.integrator).word();
    let method = match own.plants.cover {
        PlantCover::Shells => format!("{} shells", own.shells.layers),
        PlantCover::Blades => format!("swing by `{integrator}`; segments of a strip: {near}, farther away: {farther}"),
    };
    let error = plan.map_or_else(
        || UNMEASURED.to_owned(),
        |plan| {
            let swing = format!("{:.3} % of the length rms at the tip, 60 pictures a second", 100.0 * plan.swing_error);
            plan.strip_error
                .map_or(swing.clone(), |strip| format!("{swing}; strips depart from their curve by at most {:.3} %", 100.0 * strip))
        },
    );
    let planned = plan.map_or_else(Vec::new, |plan| plan.planned.clone());
    Row { part: "blades".to_owned(), method, error, server_ms_per_tick: None, stated: scene.stated_in(&["plants", "shells"]), planned }
}

pub(super) fn picture_row(scene: &OpenScene, plan: &PicturePlan) -> Row {
    let frame = match scene.loaded.scene.budget.limits()[1] {
        Some(client_ms) => format!("frames in {client_ms} ms"),
        None => "frames in 16.7 ms on a graphics card, 100 ms without one".to_owned(),
    };
    Row {
        part: "picture".to_owned(),
        method: format!("level of detail up to {}, {frame}; lower levels where a client is slower", plan.highest_detail),
        error: format!("mean FLIP {:.4} to full detail in the worst of ten views of built-in scenes", plan.flip),
        server_ms_per_tick: None,
        stated: scene
            .stated
            .iter()
            .filter(|path| ["plants.highest_detail", "budget.client_ms"].contains(&path.as_str()))
            .cloned()
            .collect(),
        planned: plan.planned.clone(),
    }
}
