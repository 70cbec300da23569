//! Many blades abreast, in loops of which the compiler makes vectors, with copies for wide registers that are chosen where the program runs. Each blade gets the
//! bits that it gets alone.

use super::{Blade, Integrator, LINKS, Leans, Sway};
use multiversion::multiversion;

/// Finds the control points (X, height above the root, Z; m) of blades that lean by `lean_rad` over roots at `root_m` (X and Z).
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
pub fn find_points<const N: usize>(
    lean_rad: &Leans<[f32; N]>,
    length_m: &[f32; N],
    root_m: &[[f32; N]; 2],
    points_m: &mut [[[f32; N]; 3]; LINKS],
) {
    for n in 0..N {
        let offsets_m = Sway::at_rest(of(lean_rad, n)).points_m(length_m[n]);
        for link in 0..LINKS {
            let [x, height, z] = offsets_m[link];
            points_m[link][0][n] = root_m[0][n] + x;
            points_m[link][1][n] = height;
            points_m[link][2][n] = root_m[1][n] + z;
        }
    }
}

/// Takes blades through a step as [`advance`](super::advance) takes one.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
pub fn advance<const N: usize>(
    sway: &mut Sway<[f32; N]>,
    blade: &Blade<[f32; N]>,
    held_rad: &Leans<[f32; N]>,
    wind_m_per_s: &Leans<[f32; N]>,
    integrator: Integrator,
    dt_secs: f32,
) {
    // Each loop knows its integrator: of a choice within, the compiler makes no vectors.
    match integrator {
        Integrator::Euler => advance_by(sway, blade, held_rad, wind_m_per_s, Integrator::Euler, dt_secs),
        Integrator::Verlet => advance_by(sway, blade, held_rad, wind_m_per_s, Integrator::Verlet, dt_secs),
        Integrator::Exact => advance_by(sway, blade, held_rad, wind_m_per_s, Integrator::Exact, dt_secs),
    }
}

#[inline(always)]
fn advance_by<const N: usize>(
    sway: &mut Sway<[f32; N]>,
    blade: &Blade<[f32; N]>,
    held_rad: &Leans<[f32; N]>,
    wind_m_per_s: &Leans<[f32; N]>,
    integrator: Integrator,
    dt_secs: f32,
) {
    for n in 0..N {
        let before = Sway { lean_rad: of(&sway.lean_rad, n), rate_rad_per_s: of(&sway.rate_rad_per_s, n) };
        let nature = Blade {
            length_m: blade.length_m[n],
            frequency_rad_per_s: blade.frequency_rad_per_s[n],
            damping_share: blade.damping_share[n],
            lean_per_wind2: blade.lean_per_wind2[n],
        };
        let swung = super::advance(&before, &nature, &of(held_rad, n), &of(wind_m_per_s, n), integrator, dt_secs);
        for link in 0..LINKS {
            for axis in 0..2 {
                sway.lean_rad[link][axis][n] = swung.lean_rad[link][axis];
                sway.rate_rad_per_s[link][axis][n] = swung.rate_rad_per_s[link][axis];
            }
        }
    }
}

/// The leans of one blade.
#[inline(always)]
fn of<const N: usize>([low, middle, high]: &Leans<[f32; N]>, n: usize) -> Leans {
    [[low[0][n], low[1][n]], [middle[0][n], middle[1][n]], [high[0][n], high[1][n]]]
}
