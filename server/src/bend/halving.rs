//! Error of the time step of the bend field, estimated by step halving (Hairer et al. 1993, section II.4) on one awake patch after another: copies of
//! it and its neighbours take one whole step, and two halves of it.

use prairie_core::bend::{Field, Patch, Scheme, Serial};
use prairie_core::grass::BendSimulation;
use prairie_core::grid::PatchIndex;

/// Time between two samples (s).
const SAMPLE_SECS: f32 = 0.5;
/// Longest time over which errors are summed up (s).
const LONGEST_SECS: f64 = 2.0;
/// Part of the estimate that remains at the next sample, if that is smaller.
const REMAINS: f64 = 0.7;
/// Bend from which a cell counts (rad).
const BENT_RAD: f32 = 0.017_453_3;

/// Estimator of the error of the time step.
#[derive(Clone, Debug, Default)]
pub(crate) struct BendHalving {
    error_rad: f64,
    turn: usize,
}

impl BendHalving {
    /// Error of the bending angle (rad, root mean square) that the time step adds while waves decay: the largest of the newest samples.
    pub(crate) fn error_rad(&self) -> f32 {
        self.error_rad as f32
    }

    /// Takes a sample where one is due after step `tick`.
    pub(crate) fn sample(&mut self, tick: u64, dt_secs: f32, bend: &BendSimulation) {
        if !tick.is_multiple_of((SAMPLE_SECS / dt_secs).round().max(1.0) as u64) {
            return;
        }
        let awake = bend.field().awake_count();
        let patch = bend.field().awake().map(Patch::index).nth(self.turn % awake.max(1));
        self.turn = self.turn.wrapping_add(1);
        let error_rad = patch.and_then(|patch| step_error_rad(bend.field(), bend.scheme(), patch, dt_secs));
        let decayed_rad = REMAINS * self.error_rad;
        self.error_rad = error_rad.map_or(decayed_rad, |error_rad| decayed_rad.max(error_rad * steps_until_decay(bend.field(), dt_secs)));
    }
}

/// Steps in which the slowest waves decay to 1/e.
fn steps_until_decay(field: &Field, dt_secs: f32) -> f64 {
    let slowest_per_s = field.kinds().waves().iter().map(|waves| f64::from(waves.theta_damping_per_s)).fold(f64::INFINITY, f64::min);
    (2.0 / slowest_per_s).min(LONGEST_SECS) / f64::from(dt_secs)
}

/// Estimated error of a step in a patch (rad, root mean square over its bent cells); `None` where none is bent, or a step fails.
fn step_error_rad(field: &Field, scheme: Scheme, patch: PatchIndex, dt_secs: f32) -> Option<f64> {
    let difference_rad = difference_rad(field, scheme, patch, dt_secs, 2)?;
    // The published damping makes Verlet a method of first order; the other schemes are of second order.
    let richardson = if scheme == Scheme::Verlet { 2.0 } else { 4.0 / 3.0 };
    Some(richardson * difference_rad)
}

/// Root mean square difference (rad), over the bent cells of a patch, between a step and `parts` parts of it.
fn difference_rad(field: &Field, scheme: Scheme, patch: PatchIndex, dt_secs: f32, parts: u32) -> Option<f64> {
    let mut whole = field.around(patch);
    let mut divided = whole.clone();
    whole.step(scheme, dt_secs, &Serial).ok()?;
    (0..parts).try_for_each(|_| divided.step(scheme, dt_secs / parts as f32, &Serial).map(drop)).ok()?;
    let thetas = |field: &Field| field.patch(patch).map(|patch| patch.rows().flat_map(|[theta, ..]| theta.to_vec()).collect::<Vec<_>>());
    let (one, other) = (thetas(&whole)?, thetas(&divided)?);
    let (mut sum, mut count) = (0.0, 0.0);
    for (one, other) in one.iter().zip(&other).filter(|(one, other)| one.abs().max(other.abs()) > BENT_RAD) {
        sum += (f64::from(*one) - f64::from(*other)).powi(2);
        count += 1.0;
    }
    (count > 0.0).then(|| f64::sqrt(sum / count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::bend::{Bend, Kinds, WaveParams};
    use prairie_core::grid::PatchLayout;
    use prairie_core::random::SplitMix64;

    const DT_SECS: f32 = 1.0 / 60.0;

    /// Grass in which random waves run, of wavelengths from eight cells on.
    fn random_field(random: &mut SplitMix64) -> Field {
        let layout = PatchLayout { count: [1, 1], cells: 32, cell_m: (0.1 + 0.4 * random.unit()) as f32 };
        let mut between = |low: f32, high: f32| low + (high - low) * random.unit() as f32;
        let waves = WaveParams {
            c0_m_per_s: between(0.2, 6.0),
            mu_m_per_rad: between(0.0, 0.5),
            c_omega_m_per_s: between(0.2, 6.0),
            theta_damping_per_s: between(0.0, 12.0),
            omega_damping_per_s: between(0.0, 12.0),
            stiffness_per_s2: between(0.0, 20.0),
        };
        let modes: Vec<[f32; 6]> = (0..4)
            .map(|_| {
                let length_m = between(8.0, 32.0) * layout.cell_m;
                let (turn, phase) = (between(0.0, std::f32::consts::TAU), between(0.0, std::f32::consts::TAU));
                let k_per_m = std::f32::consts::TAU / length_m;
                [
                    k_per_m * turn.cos(),
                    k_per_m * turn.sin(),
                    phase,
                    between(0.05, 0.3),
                    between(-1.0, 1.0) * waves.c0_m_per_s * k_per_m,
                    between(0.0, 2.0),
                ]
            })
            .collect();
        let at = |[x, z]: [f32; 2], secs: f32| {
            let wave = |weight: usize| modes.iter().map(|m| m[weight] * (m[0] * x + m[1] * z + m[2] + m[4] * secs).sin()).sum::<f32>();
            Bend { theta: wave(3), omega: [wave(5), 0.5 * wave(5)] }
        };
        let mut field = Field::new(layout, Kinds::one(waves));
        field.start(DT_SECS, |at_m| [at(at_m, 0.0), at(at_m, -DT_SECS)]);
        field
    }

    #[test]
    fn the_estimate_is_within_a_factor_of_three_in_95_of_100_random_states() {
        let mut random = SplitMix64::new(7);
        for scheme in [Scheme::Verlet, Scheme::Substepped, Scheme::Implicit] {
            let mut ratios = Vec::new();
            while ratios.len() < 1000 {
                let field = random_field(&mut random);
                let estimate = step_error_rad(&field, scheme, 0, DT_SECS);
                let error = difference_rad(&field, scheme, 0, DT_SECS, 16);
                if let (Some(estimate), Some(error)) = (estimate, error)
                    && error > 1e-6
                {
                    ratios.push(estimate / error);
                }
            }
            let within = |factor: f64| ratios.iter().filter(|ratio| (1.0 / factor..=factor).contains(*ratio)).count();
            println!("{scheme:?}: {} within a factor 3, {} within 1.05", within(3.0), within(1.05));
            assert!(within(3.0) >= 950, "{scheme:?}: {}", within(3.0));
            assert!(within(1.0001) < 950, "the estimate is the error itself: the test cannot fail");
        }
    }
}
