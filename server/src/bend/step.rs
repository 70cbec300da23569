//! The propagation of the bend field on all threads (001 §4.4).

use super::regions::Trace;
use rayon::prelude::*;
use shared::bend::{Coefficients, Field, WaveParams, verlet};

/// What the propagation took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// Number of sub-steps.
    pub substeps: u32,
    /// Largest Courant number of a sub-step.
    pub courant: f32,
}

/// Advances the field by `dt_secs` in as many equal sub-steps as its stability bound asks for when no bending speed exceeds
/// `omega_max_rad_per_s`. The patches are shared out among threads; each sub-step writes nothing that another patch reads, so the bits
/// are the same on any number of threads.
pub fn propagate(field: &mut Field, params: &WaveParams, dt_secs: f32, omega_max_rad_per_s: f32) -> (Report, Vec<Trace>) {
    let cell_m = field.layout().cell_m;
    let substeps = verlet::substeps(params, cell_m, dt_secs, omega_max_rad_per_s);
    let dt_secs = dt_secs / substeps as f32;
    let k = Coefficients::new(params, cell_m, dt_secs);
    let mut traces = vec![];
    for _ in 0..substeps {
        let mut lanes = field.lanes();
        traces = lanes
            .par_iter_mut()
            .map(|lane| {
                let extremes = lane.step(&k);
                Trace { patch: lane.index, extremes, rims: lane.rims() }
            })
            .collect();
        drop(lanes);
        field.turn();
    }
    let courant = (k.r0 + k.r_mu * omega_max_rad_per_s).max(k.r2_omega.sqrt());
    (Report { substeps, courant }, traces)
}
