//! One step of a blade: its equilibrium in wind and stiffness, and its swing about that.

use super::deflection::deflection;
use super::modes::{AMPLITUDES, BRAKES, FREQUENCIES, MODES};
use super::propagator::{Integrator, Propagator};
use super::{Blade, LINKS, Leans, Sway};

/// Advances a blade by `dt_secs`. Without wind it is in equilibrium at `held_rad`; `wind_m_per_s` is the wind over the ground at its three control
/// points above the root.
///
/// Drag is ½ρC_dA·|u − v|(u − v) across the blade at each point, with the speed |u − v| at the start of the step: the term in u shifts the
/// equilibrium by [`deflection`], the term in v damps each mode. Resolve contacts after the step with [`contact`](super::contact).
#[inline(always)]
pub fn advance(sway: &Sway, blade: &Blade, held_rad: &Leans, wind_m_per_s: &Leans, integrator: Integrator, dt_secs: f32) -> Sway {
    let link_m = blade.length_m * (1.0 / LINKS as f32);
    let mut own_m_per_s = [0.0; 2];
    let mut drag_rad = Leans::default();
    let mut pull = Pull {
        apart_rad: Leans::default(),
        past: [0.0; LINKS],
        braked: 0.5 * blade.length_m * blade.frequency_rad_per_s * blade.frequency_rad_per_s,
    };
    for j in 0..LINKS {
        let rate_rad_per_s = sway.rate_rad_per_s[j];
        own_m_per_s = [own_m_per_s[0] + link_m * rate_rad_per_s[0], own_m_per_s[1] + link_m * rate_rad_per_s[1]];
        let [x, z] = [wind_m_per_s[j][0] - own_m_per_s[0], wind_m_per_s[j][1] - own_m_per_s[1]];
        pull.past[j] = (x * x + z * z).sqrt() * blade.lean_per_wind2;
        drag_rad[j] = [wind_m_per_s[j][0] * pull.past[j], wind_m_per_s[j][1] * pull.past[j]];
    }
    let blown_rad = deflection(&drag_rad);
    for j in 0..LINKS {
        for axis in 0..2 {
            pull.apart_rad[j][axis] = sway.lean_rad[j][axis] - held_rad[j][axis] - blown_rad[j][axis];
        }
    }
    let mut swung = *sway;
    // Written out: with a loop here the compiler does not vectorise the loop over many blades.
    swing(0, &mut swung, sway, blade, &pull, integrator, dt_secs);
    swing(1, &mut swung, sway, blade, &pull, integrator, dt_secs);
    swing(2, &mut swung, sway, blade, &pull, integrator, dt_secs);
    swung
}

/// Forces on a blade.
struct Pull {
    /// Leans relative to equilibrium in the wind (rad).
    apart_rad: Leans,
    /// Speed of the air past each control point times the lean per squared wind (rad·s/m).
    past: [f32; LINKS],
    /// Damping rate (1/s) of a mode per unit of the weighted sum of `past`.
    braked: f32,
}

/// Adds the increment of mode `m` in a step.
#[inline(always)]
fn swing(m: usize, swung: &mut Sway, sway: &Sway, blade: &Blade, pull: &Pull, integrator: Integrator, dt_secs: f32) {
    let omega = blade.frequency_rad_per_s * FREQUENCIES[m];
    let step = Propagator::new(integrator, omega, blade.damping_ratio * omega + pull.braked * weighted(&BRAKES[m], pull.past), dt_secs);
    for axis in 0..2 {
        let of = |[low, middle, high]: &Leans| [low[axis], middle[axis], high[axis]];
        let x = weighted(&AMPLITUDES[m], of(&pull.apart_rad));
        let [dx, dv] = step.change(x, weighted(&AMPLITUDES[m], of(&sway.rate_rad_per_s)));
        for (link, fraction) in MODES[m].iter().enumerate() {
            swung.lean_rad[link][axis] += fraction * dx;
            swung.rate_rad_per_s[link][axis] += fraction * dv;
        }
    }
}

#[inline(always)]
fn weighted(weights: &[f32; LINKS], values: [f32; LINKS]) -> f32 {
    weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2]
}
