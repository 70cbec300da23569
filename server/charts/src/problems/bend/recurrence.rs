//! Exact recurrence of a grid mode under each scheme, from its formula.

use prairie_core::bend::Scheme;

/// Two-step recurrence `a⁺ = p·a − q·a⁻` of a mode's amplitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Recurrence {
    /// Sum of the roots g of `g² − p·g + q`.
    pub p: f64,
    /// Product of the roots.
    pub q: f64,
}

/// A grid mode in dimensionless numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steps {
    /// Damping k·dt.
    pub damping: f64,
    /// κ·dt².
    pub restoring: f64,
    /// Courant number c·dt/h.
    pub courant: f64,
    /// Eigenvalues of the negative second differences along each axis.
    pub differences: [f64; 2],
}

impl Recurrence {
    /// The recurrence of a scheme:
    /// - explicit (Chen & Johan, Eqs. 5–6): `p = 2 − λ − K`, `q = 1 − λ`, `K = r²·s + κ·dt²`, with λ = 1 − e^(−k·dt); sub-stepped, K times λ/(k·dt);
    /// - implicit (Lees 1962): `M·(a⁺ − 2a + a⁻) = −K·a − k·dt·(a − a⁻)`, `M = A·(1 + b·s_x)(1 + b·s_z)`, `A = 1 + k·dt/2 + κ·dt²/4`, `b = r²/4A`;
    /// - modal: the exact solution.
    pub fn of(scheme: Scheme, steps: &Steps) -> Self {
        let Steps { damping, restoring, courant, differences: [x, z] } = *steps;
        let (r2, lambda) = (courant * courant, -f64::exp_m1(-damping));
        let force = r2 * (x + z) + restoring;
        match scheme {
            Scheme::Verlet => Self { p: 2.0 - lambda - force, q: 1.0 - lambda },
            Scheme::Substepped => {
                let fraction = if damping == 0.0 { 1.0 } else { lambda / damping };
                Self { p: 2.0 - lambda - fraction * force, q: 1.0 - lambda }
            }
            Scheme::Implicit => {
                let inertia = 1.0 + 0.5 * damping + 0.25 * restoring;
                let b = 0.25 * r2 / inertia;
                let mass = inertia * (1.0 + b * x) * (1.0 + b * z);
                Self { p: 2.0 - (force + damping) / mass, q: 1.0 - damping / mass }
            }
            Scheme::Modal => {
                let turn = (force - 0.25 * damping * damping).sqrt();
                Self { p: 2.0 * (-0.5 * damping).exp() * turn.cos(), q: (-damping).exp() }
            }
        }
    }

    /// The least-squares fit to a series of amplitudes.
    pub fn fitted(series: &[f64]) -> Self {
        let mut sums = [[0.0; 2]; 2];
        let mut right = [0.0; 2];
        for three in series.windows(3) {
            let row = [three[1], -three[0]];
            for (i, line) in sums.iter_mut().enumerate() {
                (0..2).for_each(|j| line[j] += row[i] * row[j]);
                right[i] += row[i] * three[2];
            }
        }
        let determinant = sums[0][0] * sums[1][1] - sums[0][1] * sums[1][0];
        let p = (right[0] * sums[1][1] - right[1] * sums[0][1]) / determinant;
        let q = (right[1] * sums[0][0] - right[0] * sums[1][0]) / determinant;
        Self { p, q }
    }

    /// Phase change per step (rad, 0 to π); NaN where both roots are real and distinct.
    pub fn phase_rad(&self) -> f64 {
        (0.5 * self.p / self.q.sqrt()).acos()
    }

    /// Decay per step, −ln|g|.
    pub fn decay(&self) -> f64 {
        -0.5 * self.q.ln()
    }
}
