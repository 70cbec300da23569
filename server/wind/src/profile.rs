//! Mean wind, relaxation of layers to it, and sponge layers.

use super::config::{Config, Profile};
use super::{Field, Grid, Real, Velocity};

/// Relaxation rate (1/s) of a sponge layer.
const SPONGE_PER_S: f64 = 2.0;

/// Mean wind as a function of height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeanWind {
    velocity_m_per_s: [f64; 3],
    profile: Profile,
}

impl MeanWind {
    /// The mean wind of these settings.
    pub fn new(config: &Config) -> Self {
        let [x, _, z] = config.mean_wind_m_per_s.map(f64::from);
        Self { velocity_m_per_s: [x, 0.0, z], profile: config.profile }
    }

    /// Velocity (m/s) at a height above the ground (m).
    pub fn at(&self, height_m: f64) -> [f64; 3] {
        let fraction = self.profile.fraction_at(height_m);
        self.velocity_m_per_s.map(|speed| speed * fraction)
    }
}

/// Relaxation of the layer means to the mean wind.
#[derive(Clone, Debug)]
pub struct Relaxation<R> {
    /// Target of the x and z velocity (m/s) of each layer.
    targets: [Vec<f64>; 2],
    sums: Vec<f64>,
    gains: Vec<R>,
}

impl<R: Real> Relaxation<R> {
    /// Tabulates the mean wind at the heights of the layers of `grid`.
    pub fn new(grid: &Grid<R>, mean: &MeanWind) -> Self {
        let layers = grid.cells[1];
        let height = |j: usize| (j as f64 + 0.5) * grid.spacing_m[1].wide();
        let targets = [0, 2].map(|axis| (0..layers).map(|j| mean.at(height(j))[axis]).collect());
        Self { targets, sums: vec![0.0; layers], gains: vec![R::zero(); layers] }
    }

    /// Shifts each layer uniformly towards the mean wind, by the fraction `rate·dt / (1 + rate·dt)` of the difference (backward Euler, stable at any step).
    ///
    /// A uniform shift has no divergence. Applied along periodic axes only.
    pub fn apply(&mut self, grid: &Grid<R>, rate_per_s: f64, dt_secs: f64, velocity: &mut Velocity<R>) {
        let fraction = rate_per_s * dt_secs / (1.0 + rate_per_s * dt_secs);
        for (axis, targets) in [0, 2].into_iter().zip(&self.targets) {
            if !grid.wraps(axis) || fraction == 0.0 {
                continue;
            }
            let field = &mut velocity.0[axis];
            layer_sums(grid, field, &mut self.sums);
            let per_layer = (field.shape[0] * field.shape[2]) as f64;
            for ((gain, &target), &sum) in self.gains.iter_mut().zip(targets).zip(&self.sums) {
                *gain = R::of(fraction * (target - sum / per_layer));
            }
            for (row, &gain) in field.rows(grid).zip(self.gains.iter().cycle()) {
                field.data[row..][..field.shape[0]].iter_mut().for_each(|speed| *speed = *speed + gain);
            }
        }
    }
}

/// Relaxes the air in the cells next to a sponge layer across x at `sponge_m[0]` and one across z at `sponge_m[1]` (m) to the mean wind, by a backward Euler step.
///
/// In a periodic box that follows moving objects it keeps disturbances from re-entering on the other side.
pub fn sponge<R: Real>(grid: &Grid<R>, mean: &MeanWind, sponge_m: [f64; 2], dt_secs: f64, velocity: &mut Velocity<R>) {
    let fraction = R::of(SPONGE_PER_S * dt_secs / (1.0 + SPONGE_PER_S * dt_secs));
    for (axis, field) in velocity.0.iter_mut().enumerate() {
        for (across, sponge_m) in [(0, sponge_m[0]), (2, sponge_m[1])] {
            let n = grid.cells[across] as i64;
            let middle = (sponge_m / grid.spacing_m[across].wide() - grid.offset(field.location, across).wide()).round() as i64;
            for index in (middle - 1..=middle + 1).map(|index| index.rem_euclid(n) as usize).take(field.shape[across]) {
                let other = 2 - across;
                for j in 0..field.shape[1] {
                    let height_m = (j as f64 + grid.offset(field.location, 1).wide()) * grid.spacing_m[1].wide();
                    let target = R::of(mean.at(height_m)[axis]);
                    for along in 0..field.shape[other] {
                        let mut cell = [0, j, 0];
                        (cell[across], cell[other]) = (index, along);
                        let speed = &mut field.data[grid.at(cell)];
                        *speed = *speed + fraction * (target - *speed);
                    }
                }
            }
        }
    }
}

fn layer_sums<R: Real>(grid: &Grid<R>, field: &Field<R>, sums: &mut [f64]) {
    sums.fill(0.0);
    let layers = sums.len();
    for (n, row) in field.rows(grid).enumerate() {
        // Eight partial sums, so that the compiler can vectorise.
        let mut lanes = [R::zero(); 8];
        let mut chunks = field.data[row..][..field.shape[0]].chunks_exact(8);
        for chunk in &mut chunks {
            (0..8).for_each(|lane| lanes[lane] = lanes[lane] + chunk[lane]);
        }
        lanes.iter_mut().zip(chunks.remainder()).for_each(|(lane, &speed)| *lane = *lane + speed);
        sums[n % layers] += lanes.into_iter().map(R::wide).sum::<f64>();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_air_in_the_sponge_relaxes_to_the_mean_wind() {
        let config = Config::default();
        let grid = config.grid::<f32>();
        let mean = MeanWind::new(&config);
        let mut velocity = Velocity::zeros(&grid);
        (0..100).for_each(|_| sponge(&grid, &mean, [250.0, 128.0], 0.1, &mut velocity));
        let u = |i: usize, k: usize| f64::from(velocity.0[0].data[grid.at([i, 4, k])]);
        for (i, k) in [(31, 3), (0, 3), (5, 15), (5, 16)] {
            assert!((u(i, k) - mean.at(9.0)[0]).abs() < 1e-3, "{i}, {k}: {}", u(i, k));
        }
        assert_eq!([u(5, 3), u(20, 20)], [0.0; 2]);
    }

    #[test]
    fn layer_means_reach_the_profile_and_gusts_remain() {
        let config = Config::default();
        let grid = config.grid::<f32>();
        let mean = MeanWind::new(&config);
        let mut relaxation = Relaxation::new(&grid, &mean);
        let mut velocity = Velocity::zeros(&grid);
        let at = grid.at([3, 0, 5]);
        velocity.0[0].data[at] = 4.0;
        for _ in 0..2000 {
            relaxation.apply(&grid, 0.2, 0.1, &mut velocity);
        }
        let u = &velocity.0[0];
        let surplus = u.data[at] - u.data[at + 1];
        assert!((surplus - 4.0).abs() < 1e-4, "{surplus}");
        let mut sums = vec![0.0; 8];
        layer_sums(&grid, u, &mut sums);
        for (j, sum) in sums.into_iter().enumerate() {
            let height = 2.0 * j as f64 + 1.0;
            assert!((sum / 1024.0 - mean.at(height)[0]).abs() < 1e-3);
        }
        assert!((mean.at(10.0)[0] - 5.0).abs() < 1e-12);
        assert!(mean.at(1.0)[0] < 0.65 * mean.at(10.0)[0]);
    }
}
