//! Demands on the wind that contradict each other or cannot be met, with what they would take.

use super::wind::{Demand, WindPlan};

/// Demands that the plan of the wind does not meet.
pub(super) fn of_wind(plan: &WindPlan, demand: Demand) -> Vec<String> {
    let cut = plan.is_cut.then(|| {
        format!("the search for the wind's settings ended after {} pilot runs: cheaper or more accurate ones may exist", plan.runs[1])
    });
    [cut, of_accuracy(plan, demand), of_time(plan, demand), of_data(plan, demand)].into_iter().flatten().collect()
}

fn percent(error: f64) -> String {
    format!("{:.3} %", 100.0 * error)
}

fn of_accuracy(plan: &WindPlan, Demand { tolerance, limit_ms, limit_kbit_per_s }: Demand) -> Option<String> {
    let (chosen, tolerance) = (plan.chosen.error, tolerance?);
    if chosen <= tolerance {
        return None;
    }
    let demanded = percent(tolerance);
    if plan.error_of_finer_codes.is_some_and(|error| error <= tolerance) {
        return Some(format!(
            "`accuracy.wind` = {demanded} needs finer codes than `budget.kbit_per_s` = {} allows, {} m/s: the accuracy gives way, with an expected error of {}",
            limit_kbit_per_s.unwrap_or_default() as f32,
            plan.wind_error_m_per_s,
            percent(chosen)
        ));
    }
    Some(match &plan.within_tolerance {
        Some(found) => format!(
            "`accuracy.wind` = {demanded} needs `budget.server_ms` = {:.4}, and the budget, half a tick if none is stated, is {}: the accuracy gives way, with an expected error of {}",
            found.ms_per_tick,
            limit_ms.unwrap_or_default() as f32,
            percent(chosen)
        ),
        None => format!(
            "`accuracy.wind` = {demanded} is held by none of the settings that the scene leaves open: the chosen ones have an expected error of {}",
            percent(chosen)
        ),
    })
}

fn of_time(WindPlan { chosen, .. }: &WindPlan, Demand { limit_ms, .. }: Demand) -> Option<String> {
    let limit_ms = limit_ms.filter(|limit_ms| chosen.ms_per_tick > *limit_ms)?;
    Some(format!(
        "`budget.server_ms` = {} is less than the cheapest of the settings that the scene leaves open costs, {:.4}: the budget gives way",
        limit_ms as f32, chosen.ms_per_tick
    ))
}

fn of_data(plan: &WindPlan, Demand { limit_kbit_per_s, .. }: Demand) -> Option<String> {
    let (kbit_per_s, limit) = (plan.kbit_per_s?, limit_kbit_per_s?);
    (kbit_per_s > limit).then(|| {
        format!(
            "`budget.kbit_per_s` = {} is less than the frames of the wind take with codes of {} m/s, {kbit_per_s:.1}: clients without a replica of the grass get fewer of them, which \
             is not in the expected error, others all of them. Fewer `wind.cells` or a longer `wind.step_secs` would need less",
            limit as f32, plan.wind_error_m_per_s
        )
    })
}
