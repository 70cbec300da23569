//! Error of the time step of the bend field, estimated by step halving (Hairer et al. 1993, section II.4) on the patch that moves fastest and, in turn, on each awake patch: copies of
//! it and its neighbours take some sub-steps, and twice as many of half the length.

use prairie_core::bend::{Bend, Field, Patch, Scheme, Serial};
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
        let (awake, turn) = (bend.field().awake_count().max(1), self.turn);
        self.turn = self.turn.wrapping_add(1);
        let patch = if turn.is_multiple_of(2) {
            bend.field().awake().max_by(|one, other| one.omega_max_rad_per_s().total_cmp(&other.omega_max_rad_per_s()))
        } else {
            bend.field().awake().nth(turn / 2 % awake)
        };
        let patch = patch.map(Patch::index);
        let growth_rad_per_s = patch.and_then(|patch| error_rad_per_s(bend.field(), bend.scheme(), patch, dt_secs)).unwrap_or_default();
        self.error_rad = f64::max(REMAINS * self.error_rad, growth_rad_per_s * decay_secs(bend.field()));
    }
}

/// Time in which the slowest waves decay to 1/e (s), at most [`LONGEST_SECS`].
fn decay_secs(field: &Field) -> f64 {
    let slowest_per_s = field.kinds().waves().iter().map(|waves| f64::from(waves.theta_damping_per_s)).fold(f64::INFINITY, f64::min);
    (2.0 / slowest_per_s).min(LONGEST_SECS)
}

/// Estimated growth of the error in a patch (rad/s, root mean square over its bent cells); `None` where none is bent, or a step fails.
fn error_rad_per_s(field: &Field, scheme: Scheme, patch: PatchIndex, dt_secs: f32) -> Option<f64> {
    // The published damping makes Verlet a method of first order; the other schemes are of second order.
    let richardson = if scheme == Scheme::Verlet { 2.0 } else { 4.0 / 3.0 };
    Some(richardson * Comparison::new(field, scheme, patch, dt_secs)?.difference_rad_per_s(2)?)
}

/// Sub-steps that are compared.
const COMPARED: u32 = 3;

/// A patch with its neighbours, and their states over some sub-steps.
///
/// A field holds two states, one sub-step apart. For shorter sub-steps the earlier one must lie nearer: it is interpolated along the states of the longer ones, by
/// polynomials of fourth degree, so that its error is of a higher order than that of the schemes.
struct Comparison {
    scheme: Scheme,
    patch: PatchIndex,
    start: Field,
    substep_secs: f32,
    /// States before the start, at the start, and after each of the sub-steps, of each patch.
    states: Vec<Vec<Vec<Bend>>>,
}

impl Comparison {
    fn new(field: &Field, scheme: Scheme, patch: PatchIndex, dt_secs: f32) -> Option<Self> {
        let mut start = field.around(patch);
        let substeps = start.clone().step(scheme, dt_secs, &Serial).ok()?.substeps.max(1);
        let substep_secs = dt_secs / substeps as f32;
        // After it the two states are as far apart as in the steps to compare.
        start.step(scheme, substep_secs, &Serial).ok()?;
        let mut states = vec![bends(&start, &start, Patch::bend_before)?, bends(&start, &start, Patch::bend)?];
        let mut whole = start.clone();
        for _ in 0..COMPARED {
            whole.step(scheme, substep_secs, &Serial).ok()?;
            states.push(bends(&start, &whole, Patch::bend)?);
        }
        Some(Self { scheme, patch, start, substep_secs, states })
    }

    /// Root mean square difference, over the bent cells of the patch and per second, from sub-steps that are divided into `parts`.
    fn difference_rad_per_s(&self, parts: u32) -> Option<f64> {
        let mut divided = self.start.clone();
        let weights = lagrange(-1.0 / f64::from(parts));
        for (place, index) in self.start.awake().map(Patch::index).enumerate() {
            let patch = divided.patch_mut(index)?;
            let side = patch.side();
            for cell in 0..side * side {
                let (i, j) = (cell % side, cell / side);
                let nodes = || self.states.iter().map(|state| state[place][cell]).zip(weights);
                let theta = nodes().map(|(bend, weight)| weight * f64::from(bend.theta)).sum::<f64>() as f32;
                let omega = [0, 1].map(|axis| nodes().map(|(bend, weight)| weight * f64::from(bend.omega[axis])).sum::<f64>() as f32);
                patch.set(i, j, patch.bend(i, j), Bend { theta, omega });
            }
        }
        let part_secs = self.substep_secs / parts as f32;
        divided.set_between_states(part_secs);
        (0..COMPARED * parts).try_for_each(|_| divided.step(self.scheme, part_secs, &Serial).map(drop)).ok()?;
        let place = self.start.awake().position(|patch| patch.index() == self.patch)?;
        let (one, other) = (&self.states.last()?[place], &bends(&self.start, &divided, Patch::bend)?[place]);
        let (mut sum, mut count) = (0.0, 0.0);
        for (one, other) in one.iter().zip(other).filter(|(one, other)| one.theta.abs().max(other.theta.abs()) > BENT_RAD) {
            sum += (f64::from(one.theta) - f64::from(other.theta)).powi(2);
            count += 1.0;
        }
        (count > 0.0).then(|| f64::sqrt(sum / count) / (f64::from(COMPARED) * f64::from(self.substep_secs)))
    }
}

/// States of the cells of each patch that is awake in `of`, row by row; `None` if one is not awake in `field`.
fn bends(of: &Field, field: &Field, state: impl Fn(&Patch, usize, usize) -> Bend) -> Option<Vec<Vec<Bend>>> {
    of.awake()
        .map(|patch| {
            let (patch, side) = (field.patch(patch.index())?, patch.side());
            Some((0..side * side).map(|cell| state(patch, cell % side, cell / side)).collect())
        })
        .collect()
}

/// Weights of the values at −1, 0, 1, 2 and 3 in the polynomial through them at `x`.
fn lagrange(x: f64) -> [f64; COMPARED as usize + 2] {
    std::array::from_fn(|of| {
        let node = of as f64 - 1.0;
        (0..COMPARED + 2)
            .map(|other| f64::from(other) - 1.0)
            .filter(|other| *other != node)
            .map(|other| (x - other) / (node - other))
            .product()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::bend::{Kinds, WaveParams};
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
    fn the_estimate_is_within_a_factor_of_three_in_950_of_1000_random_states() {
        let mut random = SplitMix64::new(7);
        for scheme in [Scheme::Verlet, Scheme::Substepped, Scheme::Implicit] {
            let mut ratios = Vec::new();
            while ratios.len() < 1000 {
                let field = random_field(&mut random);
                let estimate = error_rad_per_s(&field, scheme, 0, DT_SECS);
                let error = Comparison::new(&field, scheme, 0, DT_SECS).and_then(|compared| compared.difference_rad_per_s(16));
                // Smaller ones are rounding errors of angles in f32.
                if let (Some(estimate), Some(error)) = (estimate, error)
                    && error > 1e-4
                {
                    ratios.push(estimate / error);
                }
            }
            let within = |factor: f64| ratios.iter().filter(|ratio| (1.0 / factor..=factor).contains(*ratio)).count();
            println!("{scheme:?}: {} within a factor 3, {} within 1.05", within(3.0), within(1.05));
            assert!(within(3.0) >= 950, "{scheme:?}: {}", within(3.0));
            // Control: estimates of a tenth of the difference.
            let tenths = ratios.iter().filter(|ratio| (1.0 / 3.0..=3.0).contains(&(0.1 * *ratio))).count();
            assert!(tenths < 950, "{scheme:?}: {tenths} tenths of the estimates are as good");
        }
    }
}
