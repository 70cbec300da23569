//! One step of a blade: where wind and stiffness hold it, and how it swings about that.

use super::modes::{AMPLITUDES, BRAKES, FREQUENCIES, MODES, PUSHES};
use super::propagator::{Integrator, Propagator};
use super::{Blade, LINKS, Leans, Sway};
use multiversion::multiversion;

/// Blades in an [`Eight`].
pub const LANES: usize = 8;

/// A vector on the ground for each link of eight blades, blade by blade.
pub type EightLeans = [[[f32; LANES]; 2]; LINKS];

/// Eight blades side by side, one in each lane of a vector register, with what acts on them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C, align(64))]
pub struct Eight {
    /// As [`Sway::lean_rad`].
    pub lean_rad: EightLeans,
    /// As [`Sway::rate_rad_per_s`].
    pub rate_rad_per_s: EightLeans,
    /// Leans in which the blades are held without wind (rad).
    pub held_rad: EightLeans,
    /// Wind over the ground at the three control points above the root (m/s).
    pub wind_m_per_s: EightLeans,
    /// As [`Blade::length_m`].
    pub length_m: [f32; LANES],
    /// As [`Blade::frequency_rad_per_s`].
    pub frequency_rad_per_s: [f32; LANES],
    /// As [`Blade::lean_per_wind2`].
    pub lean_per_wind2: [f32; LANES],
}

/// Takes a blade through `dt_secs`, held in `held_rad` without wind, in a wind over the ground of `wind_m_per_s` at its three control points above the root.
///
/// Drag is ½ρC_dA·|u − v|(u − v) across the blade at each of them, with the speed |u − v| as at the start of the step: its share in u moves the lean in which the
/// blade is held, its share in v brakes each mode. Contacts are for [`contact`](super::contact) to mend after the step.
pub fn advance(sway: &Sway, blade: &Blade, held_rad: &Leans, wind_m_per_s: &Leans, integrator: Integrator, dt_secs: f32) -> Sway {
    let (lean_rad, rate_rad_per_s) = match integrator {
        Integrator::Euler => advance_by(sway, blade, held_rad, wind_m_per_s, |omega, gamma| Propagator::euler(omega, gamma, dt_secs)),
        Integrator::Verlet => advance_by(sway, blade, held_rad, wind_m_per_s, |omega, gamma| Propagator::verlet(omega, gamma, dt_secs)),
        Integrator::Exact => advance_by(sway, blade, held_rad, wind_m_per_s, |omega, gamma| Propagator::exact(omega, gamma, dt_secs)),
    };
    Sway { lean_rad, rate_rad_per_s }
}

/// [`advance`] by the exact integrator for many blades, eight abreast; the same bits as one by one.
#[multiversion(targets("x86_64+avx2"))]
pub fn advance_eight(eights: &mut [Eight], damping_share: f32, dt_secs: f32) {
    for eight in eights {
        for lane in 0..LANES {
            let pick = |leans: &EightLeans| -> Leans { std::array::from_fn(|link| [leans[link][0][lane], leans[link][1][lane]]) };
            let blade = Blade {
                length_m: eight.length_m[lane],
                frequency_rad_per_s: eight.frequency_rad_per_s[lane],
                damping_share,
                lean_per_wind2: eight.lean_per_wind2[lane],
            };
            let sway = Sway { lean_rad: pick(&eight.lean_rad), rate_rad_per_s: pick(&eight.rate_rad_per_s) };
            let (held_rad, wind_m_per_s) = (pick(&eight.held_rad), pick(&eight.wind_m_per_s));
            let (lean_rad, rate_rad_per_s) =
                advance_by(&sway, &blade, &held_rad, &wind_m_per_s, |omega, gamma| Propagator::exact(omega, gamma, dt_secs));
            for link in 0..LINKS {
                for axis in 0..2 {
                    eight.lean_rad[link][axis][lane] = lean_rad[link][axis];
                    eight.rate_rad_per_s[link][axis][lane] = rate_rad_per_s[link][axis];
                }
            }
        }
    }
}

/// Leans and their rates after a step in which `propagator` takes a mode of given ω (rad/s) and γ (1/s) along.
#[inline(always)]
fn advance_by(
    sway: &Sway,
    blade: &Blade,
    held_rad: &Leans,
    wind_m_per_s: &Leans,
    propagator: impl Fn(f32, f32) -> Propagator,
) -> (Leans, Leans) {
    let link_m = blade.length_m / LINKS as f32;
    let (mut past_m_per_s, mut drag) = ([0.0; LINKS], Leans::default());
    let mut own_m_per_s = [0.0; 2];
    for j in 0..LINKS {
        let wind = wind_m_per_s[j];
        own_m_per_s = [0, 1].map(|axis| own_m_per_s[axis] + link_m * sway.rate_rad_per_s[j][axis]);
        let [x, z] = [wind[0] - own_m_per_s[0], wind[1] - own_m_per_s[1]];
        past_m_per_s[j] = (x * x + z * z).sqrt() * blade.lean_per_wind2;
        drag[j] = wind.map(|u| u * past_m_per_s[j]);
    }
    let (mut lean_rad, mut rate_rad_per_s) = (sway.lean_rad, sway.rate_rad_per_s);
    for m in 0..LINKS {
        let omega = blade.frequency_rad_per_s * FREQUENCIES[m];
        let braked = weighted(&BRAKES[m], past_m_per_s) * blade.frequency_rad_per_s * blade.frequency_rad_per_s * blade.length_m;
        let step = propagator(omega, blade.damping_share * omega + 0.5 * braked);
        for axis in 0..2 {
            let part = |leans: &Leans| -> [f32; LINKS] { [leans[0][axis], leans[1][axis], leans[2][axis]] };
            let (lean, held) = (part(&sway.lean_rad), part(held_rad));
            let apart = [lean[0] - held[0], lean[1] - held[1], lean[2] - held[2]];
            let x = weighted(&AMPLITUDES[m], apart) - weighted(&PUSHES[m], part(&drag));
            let v = weighted(&AMPLITUDES[m], part(&sway.rate_rad_per_s));
            let (dx, dv) = (step.stay * x + step.glide * v, step.pull * x + step.brake * v);
            for link in 0..LINKS {
                lean_rad[link][axis] += MODES[m][link] * dx;
                rate_rad_per_s[link][axis] += MODES[m][link] * dv;
            }
        }
    }
    (lean_rad, rate_rad_per_s)
}

#[inline(always)]
fn weighted(weights: &[f32; LINKS], values: [f32; LINKS]) -> f32 {
    weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2]
}
