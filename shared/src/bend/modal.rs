//! Exact propagation in time of the whole grid, mode by mode (needs one constant speed).
//!
//! In space the equation is that of the other schemes, `θ'' + kθ' + κθ = c²·Lθ` with the five-point Laplacian L. Its modes are those of a Fourier
//! transform over the grid, extended to a periodic one by its mirror images: odd beyond edges at rest, even beyond free ones. A mode of wave number K
//! oscillates at Ω² = c²K² + κ − k²/4, and three states dt apart obey exactly `θ⁺ = 2·exp(−k·dt/2)·cos(Ω·dt)·θ − exp(−k·dt)·θ⁻`.

use super::ground;
use super::halo::Edges;
use super::patch::CHANNELS;
use super::{Field, Patch, Report, Seams, StepError, WaveParams};
use rustfft::num_complex::Complex;
use rustfft::{FftDirection, FftPlannerScalar};
use std::f64::consts::PI;

/// Damping rate (1/s), speed (m/s) and stiffness (1/s²) of a channel.
struct Oscillation {
    damping_per_s: f64,
    speed_m_per_s: f64,
    stiffness_per_s2: f64,
}

impl Oscillation {
    /// `2·exp(−k·dt/2)·cos(Ω·dt)` for the square of a wave number (1/m²).
    fn factor(&self, wave_number2_per_m2: f64, dt_secs: f64) -> f64 {
        let k = self.damping_per_s;
        let omega2 = self.speed_m_per_s.powi(2) * wave_number2_per_m2 + self.stiffness_per_s2 - 0.25 * k * k;
        if omega2 >= 0.0 {
            return 2.0 * (-0.5 * k * dt_secs).exp() * (omega2.sqrt() * dt_secs).cos();
        }
        // Overdamped: exp(−k·dt/2) is multiplied into the hyperbolic cosine, which alone would overflow.
        let rate = (-omega2).sqrt();
        ((rate - 0.5 * k) * dt_secs).exp() + ((-rate - 0.5 * k) * dt_secs).exp()
    }
}

/// Advances the whole field by `dt_secs`.
pub(super) fn step(field: &mut Field, dt_secs: f32) -> Result<Report, StepError> {
    let waves = field.kinds.waves();
    let mu_m_per_rad = waves.iter().map(|waves| waves.mu_m_per_rad).fold(0.0, f32::max);
    if waves.len() > 1 || mu_m_per_rad > 0.0 {
        return Err(StepError::SpeedVaries { kinds: waves.len(), mu_m_per_rad });
    }
    let (awake, patches) = (field.awake_count(), field.layout.patches());
    if awake < patches || field.seams == Seams::Overlap {
        return Err(StepError::NotWhole { awake, patches, seams: field.seams.word() });
    }
    let ratio = field.dt_secs.replace(dt_secs).map_or(1.0, |last| dt_secs / last);
    let WaveParams { c0_m_per_s, c_omega_m_per_s, theta_damping_per_s, omega_damping_per_s, stiffness_per_s2, .. } = waves[0];
    let oscillation = |speed: f32, damping: f32| Oscillation {
        damping_per_s: damping.into(),
        speed_m_per_s: speed.into(),
        stiffness_per_s2: stiffness_per_s2.into(),
    };
    let theta = oscillation(c0_m_per_s, theta_damping_per_s);
    let omega = oscillation(c_omega_m_per_s, omega_damping_per_s);
    // Both components of ω obey one equation, so they are transformed as one complex number.
    propagate(field, [Some(0), None], &theta, dt_secs, ratio);
    propagate(field, [Some(1), Some(2)], &omega, dt_secs, ratio);
    let limit_rad = field.ground_contact.limit_rad();
    for patch in &mut field.patches {
        std::mem::swap(&mut patch.now, &mut patch.before);
        ground::stop(patch, limit_rad);
        patch.measure();
    }
    let cells = field.layout.count.map(|n| u64::from(n) * u64::from(field.layout.cells));
    Ok(Report { substeps: 1, cell_steps: cells[0] * cells[1], ..Report::default() })
}

/// Replaces the earlier state of up to two channels by the next.
fn propagate(field: &mut Field, channels: [Option<usize>; 2], oscillation: &Oscillation, dt_secs: f32, ratio: f32) {
    let cells = field.layout.count.map(|n| n as usize * field.layout.cells as usize);
    let edges = field.edges;
    let period = cells.map(|n| match edges {
        Edges::Rest => 2 * (n + 1),
        Edges::Free => 2 * n,
        Edges::Wrapped => n,
    });
    let mut grid = vec![Complex::default(); period[0] * period[1]];
    for_each_row(field, |patch, at, [x, z]| {
        let value = |channel: Option<usize>, i: usize| channel.map_or(0.0, |channel| f64::from(patch.now[channel][at + i]));
        for i in 0..patch.side() {
            let state = Complex::new(value(channels[0], i), value(channels[1], i));
            for (column, sign_x) in images(edges, x + i, period[0]) {
                for (row, sign_z) in images(edges, z, period[1]) {
                    grid[row * period[0] + column] = state * (sign_x * sign_z);
                }
            }
        }
    });
    let spacing2_m2 = f64::from(field.layout.cell_m).powi(2);
    let wave_number2 = |n: usize, axis: usize| 4.0 / spacing2_m2 * (PI * n as f64 / period[axis] as f64).sin().powi(2);
    transform(&mut grid, period, FftDirection::Forward);
    // The transform leaves rows and columns exchanged.
    let scale = 1.0 / grid.len() as f64;
    for (column, values) in grid.chunks_exact_mut(period[1]).enumerate() {
        for (row, value) in values.iter_mut().enumerate() {
            *value *= scale * oscillation.factor(wave_number2(column, 0) + wave_number2(row, 1), dt_secs.into());
        }
    }
    transform(&mut grid, [period[1], period[0]], FftDirection::Inverse);
    let decay = (-oscillation.damping_per_s * f64::from(dt_secs)).exp();
    let first = usize::from(edges == Edges::Rest);
    for_each_row(field, |patch, at, [x, z]| {
        for i in at..at + patch.side() {
            let carried = grid[(z + first) * period[0] + x + first + i - at];
            for (channel, carried) in
                channels.into_iter().zip([carried.re, carried.im]).filter_map(|(channel, value)| Some((channel?, value)))
            {
                let now = patch.now[channel][i];
                let before = now - (now - patch.before[channel][i]) * ratio;
                patch.before[channel][i] = (carried - decay * f64::from(before)) as f32;
            }
        }
    });
}

/// Calls `act` for every row of every patch, with the index of its first cell in the planes and its position in the world.
fn for_each_row(field: &mut Field, mut act: impl FnMut(&mut Patch, usize, [usize; 2])) {
    let (layout, side) = (field.layout, field.layout.cells as usize);
    for patch in &mut field.patches {
        let corner = layout.place(patch.index()).map(|n| n as usize * side);
        for j in 0..side {
            let at = patch.at(0, j as i64);
            act(patch, at, [corner[0], corner[1] + j]);
        }
    }
}

/// Positions of a cell and of its mirror image in the period, with their signs.
fn images(edges: Edges, cell: usize, period: usize) -> impl Iterator<Item = (usize, f64)> {
    let (own, image) = match edges {
        Edges::Rest => (cell + 1, Some((period - cell - 1, -1.0))),
        Edges::Free => (cell, Some((period - cell - 1, 1.0))),
        Edges::Wrapped => (cell, None),
    };
    std::iter::once((own, 1.0)).chain(image)
}

/// Transforms rows of `size[0]`, then columns, which become rows.
fn transform(grid: &mut Vec<Complex<f64>>, size: [usize; 2], direction: FftDirection) {
    let mut planner = FftPlannerScalar::new();
    planner.plan_fft(size[0], direction).process(grid);
    let mut turned = vec![Complex::default(); grid.len()];
    // Blocks that fit the cache.
    const BLOCK: usize = 16;
    for block_z in (0..size[1]).step_by(BLOCK) {
        for block_x in (0..size[0]).step_by(BLOCK) {
            for z in block_z..(block_z + BLOCK).min(size[1]) {
                for x in block_x..(block_x + BLOCK).min(size[0]) {
                    turned[x * size[1] + z] = grid[z * size[0] + x];
                }
            }
        }
    }
    planner.plan_fft(size[1], direction).process(&mut turned);
    *grid = turned;
}

const _: () = assert!(CHANNELS == 3, "θ and the two components of ω");
