//! One step of a blade: where wind and stiffness hold it, and how it swings about that.

use super::modes::{AMPLITUDES, BRAKES, FREQUENCIES, MODES, PUSHES};
use super::number::Number;
use super::propagator::{Integrator, Propagator};
use super::{Blade, LINKS, Leans, Sway};

/// Takes a blade, or eight, through `dt_secs`, held in `held_rad` without wind, in a wind over the ground of `wind_m_per_s` at its three control points above the
/// root.
///
/// Drag is ½ρC_dA·|u − v|(u − v) across the blade at each of them, with the speed |u − v| as at the start of the step: its share in u moves the lean in which the
/// blade is held, its share in v brakes each mode. Contacts are for [`contact`](super::contact) to mend after the step.
#[inline(always)]
pub fn advance<T: Number>(
    sway: &Sway<T>,
    blade: &Blade<T>,
    held_rad: &Leans<T>,
    wind_m_per_s: &Leans<T>,
    integrator: Integrator,
    dt_secs: f32,
) -> Sway<T> {
    let link_m = blade.length_m * T::splat(1.0 / LINKS as f32);
    let mut own_m_per_s = [T::splat(0.0); 2];
    let (mut past, mut drag) = ([T::splat(0.0); LINKS], [[T::splat(0.0); 2]; LINKS]);
    for j in 0..LINKS {
        own_m_per_s = [0, 1].map(|axis| own_m_per_s[axis] + link_m * sway.rate_rad_per_s[j][axis]);
        let [x, z] = [0, 1].map(|axis| wind_m_per_s[j][axis] - own_m_per_s[axis]);
        past[j] = (x * x + z * z).root() * blade.lean_per_wind2;
        drag[j] = wind_m_per_s[j].map(|u| u * past[j]);
    }
    let braked = T::splat(0.5) * blade.length_m * blade.frequency_rad_per_s * blade.frequency_rad_per_s;
    let mut swung = *sway;
    for m in 0..LINKS {
        let omega = blade.frequency_rad_per_s * T::splat(FREQUENCIES[m]);
        let step = Propagator::new(integrator, omega, blade.damping_share * omega + braked * weighted(&BRAKES[m], past), dt_secs);
        for axis in 0..2 {
            let of = |leans: &Leans<T>| [0, 1, 2].map(|link| leans[link][axis]);
            let apart = [0, 1, 2].map(|link| sway.lean_rad[link][axis] - held_rad[link][axis]);
            let x = weighted(&AMPLITUDES[m], apart) - weighted(&PUSHES[m], of(&drag));
            let [dx, dv] = step.change(x, weighted(&AMPLITUDES[m], of(&sway.rate_rad_per_s)));
            for (link, share) in MODES[m].map(T::splat).into_iter().enumerate() {
                swung.lean_rad[link][axis] = swung.lean_rad[link][axis] + share * dx;
                swung.rate_rad_per_s[link][axis] = swung.rate_rad_per_s[link][axis] + share * dv;
            }
        }
    }
    swung
}

#[inline(always)]
fn weighted<T: Number>(weights: &[f32; LINKS], values: [T; LINKS]) -> T {
    T::splat(weights[0]) * values[0] + T::splat(weights[1]) * values[1] + T::splat(weights[2]) * values[2]
}
