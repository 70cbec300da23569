use std::f64::consts::{PI, TAU};

use super::super::{Dust, Front, Gusts, Intensity, Primitive, Profile, Shape, Solver};
use super::*;

/// A box of still air without forces.
fn quiet(cells: [usize; 3], spacing_m: [f32; 3], face: Boundary) -> Config {
    Config {
        cells,
        spacing_m,
        boundary: [[face; 2]; 3],
        viscosity_m2_per_s: 0.0,
        mean_wind_m_per_s: [0.0; 3],
        profile: Profile::Uniform,
        relaxation_per_s: 0.0,
        gusts: Gusts { number: 0, ..Gusts::default() },
        ..Config::default()
    }
}

/// A rough field of speeds up to 1 m/s.
fn rough<R: Real>([x, y, z]: [R; 3]) -> [R; 3] {
    let [x, y, z] = [x, y, z].map(R::wide);
    [(13.7 * x + 7.1 * y * z).sin(), (5.3 * y + 9.1 * x * z).sin(), (3.3 * z + 8.1 * y * x).cos()].map(R::of)
}

/// Root mean square of the divergence (1/s); `smallest_m` is the smallest spacing of the cells.
fn divergence_rms(air: &StableFluids<f64>, smallest_m: f64) -> f64 {
    let diagnostics = air.diagnostics();
    diagnostics.divergence_rms_rel * (2.0 * diagnostics.kinetic_energy_m2_per_s2).sqrt() / smallest_m
}

/// A second transcription of the listings, on its own arrays of (N + 2)³ and with its own numbers, for cubes of 1 m. Wall values of a normal velocity
/// are `wall` times the adjacent ones.
struct Transcription {
    n: usize,
    wall: f64,
}

impl Transcription {
    fn ix(&self, i: usize, j: usize, k: usize) -> usize {
        i + (self.n + 2) * (j + (self.n + 2) * k)
    }

    fn for_each_cell(&self, mut f: impl FnMut(usize, usize, usize)) {
        for k in 1..=self.n {
            for j in 1..=self.n {
                (1..=self.n).for_each(|i| f(i, j, k));
            }
        }
    }

    fn set_bound(&self, b: usize, x: &mut [f64]) {
        let n = self.n;
        for axis in 0..3 {
            let sign = if b == axis + 1 { self.wall } else { 1.0 };
            for p in 0..=n + 1 {
                for q in 0..=n + 1 {
                    let at = |m: usize| match axis {
                        0 => self.ix(m, p, q),
                        1 => self.ix(p, m, q),
                        _ => self.ix(p, q, m),
                    };
                    x[at(0)] = sign * x[at(1)];
                    x[at(n + 1)] = sign * x[at(n)];
                }
            }
        }
    }

    fn linear_solver(&self, b: usize, x: &mut [f64], x0: &[f64], visc_a: f64, dt_t: f64) {
        for _ in 0..20 {
            self.for_each_cell(|i, j, k| {
                let around = x[self.ix(i - 1, j, k)]
                    + x[self.ix(i + 1, j, k)]
                    + x[self.ix(i, j - 1, k)]
                    + x[self.ix(i, j + 1, k)]
                    + x[self.ix(i, j, k - 1)]
                    + x[self.ix(i, j, k + 1)];
                x[self.ix(i, j, k)] = (x0[self.ix(i, j, k)] + visc_a * around) / dt_t;
            });
            self.set_bound(b, x);
        }
    }

    fn diffuse(&self, b: usize, x0: &[f64], a: f64) -> Vec<f64> {
        let mut x = x0.to_vec();
        self.linear_solver(b, &mut x, x0, a, 1.0 + 6.0 * a);
        x
    }

    fn advect(&self, b: usize, d0: &[f64], velocity: &[Vec<f64>; 3], dt: f64) -> Vec<f64> {
        let mut d = d0.to_vec();
        self.for_each_cell(|i, j, k| {
            let from = [i, j, k].map(|n| n as f64);
            let back = |axis: usize| (from[axis] - dt * velocity[axis][self.ix(i, j, k)]).clamp(0.5, self.n as f64 + 0.5);
            let [x, y, z] = [back(0), back(1), back(2)];
            let mut sum = 0.0;
            for (di, dj, dk) in (0..8).map(|corner| (corner & 1, corner >> 1 & 1, corner >> 2)) {
                let weight = |x: f64, d: usize| if d == 1 { x.fract() } else { 1.0 - x.fract() };
                sum += weight(x, di) * weight(y, dj) * weight(z, dk) * d0[self.ix(x as usize + di, y as usize + dj, z as usize + dk)];
            }
            d[self.ix(i, j, k)] = sum;
        });
        self.set_bound(b, &mut d);
        d
    }

    fn project(&self, velocity: &mut [Vec<f64>; 3]) {
        let steps = [1, self.n + 2, (self.n + 2) * (self.n + 2)];
        let mut div = vec![0.0; velocity[0].len()];
        let mut p = div.clone();
        self.for_each_cell(|i, j, k| {
            let at = self.ix(i, j, k);
            div[at] = -0.5 * (0..3).map(|axis| velocity[axis][at + steps[axis]] - velocity[axis][at - steps[axis]]).sum::<f64>();
        });
        self.linear_solver(0, &mut p, &div, 1.0, 6.0);
        for axis in 0..3 {
            self.for_each_cell(|i, j, k| {
                let at = self.ix(i, j, k);
                velocity[axis][at] -= 0.5 * (p[at + steps[axis]] - p[at - steps[axis]]);
            });
            self.set_bound(axis + 1, &mut velocity[axis]);
        }
    }

    /// `vel_step` and `dens_step` without sources.
    fn step(&self, velocity: &mut [Vec<f64>; 3], dust: &mut Vec<f64>, a: f64, dt: f64) {
        *velocity = [0, 1, 2].map(|axis| self.diffuse(axis + 1, &velocity[axis], a));
        self.project(velocity);
        *velocity = [0, 1, 2].map(|axis| self.advect(axis + 1, &velocity[axis], velocity, dt));
        self.project(velocity);
        *dust = self.advect(0, &self.diffuse(0, dust, a), velocity, dt);
    }
}

#[test]
fn steps_are_those_of_the_listings() {
    let (n, dt_secs, viscosity) = (6, 0.7, 0.4f32);
    for (face, wall) in [(Boundary::FreeSlip, 0.0), (Boundary::Reflect, -1.0)] {
        let dust = Dust { diffusivity_m2_per_s: viscosity, settling_per_s: 0.0, ..Dust::default() };
        let config = Config { viscosity_m2_per_s: viscosity, dust: Some(dust), ..quiet([n; 3], [1.0; 3], face) };
        let mut air = StableFluids::<f64>::new(&config).unwrap();
        air.set_velocity(rough);
        // A spike, whose spread reveals every weight.
        let spike = |[x, y, z]: [f64; 3]| if [x, y, z] == [2.5, 3.5, 1.5] { 1.0 } else { 0.0 };
        air.set_dust(spike);

        let listing = Transcription { n, wall };
        let still = vec![0.0; (n + 2).pow(3)];
        let (mut velocity, mut dust) = ([still.clone(), still.clone(), still.clone()], still);
        listing.for_each_cell(|i, j, k| {
            let position_m = [i, j, k].map(|n| n as f64 - 0.5);
            (0..3).for_each(|axis| velocity[axis][listing.ix(i, j, k)] = rough(position_m)[axis]);
            dust[listing.ix(i, j, k)] = spike(position_m);
        });
        (0..3).for_each(|axis| listing.set_bound(axis + 1, &mut velocity[axis]));
        listing.set_bound(0, &mut dust);

        for _ in 0..3 {
            air.step(dt_secs, &[]).unwrap();
            listing.step(&mut velocity, &mut dust, f64::from(viscosity) * dt_secs, dt_secs);
        }
        let own_dust = air.dust.as_ref().unwrap();
        let mut moved = 0.0f64;
        listing.for_each_cell(|i, j, k| {
            let (at, own_at) = (listing.ix(i, j, k), air.grid.at([i - 1, j - 1, k - 1]));
            for (field, own) in velocity.iter().chain([&dust]).zip(air.velocity.0.iter().chain([own_dust])) {
                assert!((field[at] - own.data[own_at]).abs() < 1e-13, "{face:?} in cell {i} {j} {k}: {} {}", field[at], own.data[own_at]);
            }
            moved = moved.max(velocity[0][at].abs());
        });
        assert!(moved > 1e-3, "the air moves still: {moved}");
    }
}

/// The gradient of a cosine mode along x and y over the whole box.
fn mode(config: &Config) -> impl Fn([f64; 3]) -> [f64; 3] {
    let k: [f64; 2] = [0, 1].map(|axis| PI / (config.cells[axis] as f64 * f64::from(config.spacing_m[axis])));
    move |[x, y, _]| [(k[0] * x).sin() * (k[1] * y).cos(), (k[0] * x).cos() * (k[1] * y).sin(), 0.0]
}

/// Fraction of the divergence of [`mode`] that remains after a projection.
fn fraction_left(config: &Config, sweeps: u32) -> f64 {
    let smallest_m = config.spacing_m.into_iter().fold(f32::INFINITY, f32::min).into();
    let mut air = StableFluids::<f64>::new(config).unwrap();
    air.set_velocity(mode(config));
    let before = divergence_rms(&air, smallest_m);
    air.project(sweeps);
    divergence_rms(&air, smallest_m) / before
}

#[test]
fn the_sweeps_of_zhang_leave_most_of_the_divergence() {
    for (n, sweeps, fraction) in [(8, 20, 0.22), (16, 20, 0.64), (32, 20, 0.89), (8, 1000, 0.04)] {
        let found = fraction_left(&quiet([n; 3], [1.0; 3], Boundary::Reflect), sweeps);
        assert!((found - fraction).abs() < 0.005, "{sweeps} sweeps at {n}³ leave {found}");
    }
}

/// The divergence that remains after any number of sweeps is due to wide differences in place of the Laplacian: `1 − Σ sin²θ/h² / Σ (2 − 2cos θ)/h²`.
#[test]
fn the_projection_stalls_where_theory_says_on_any_cells() {
    for (cells, spacing_m) in [([8, 8, 8], [1.0; 3]), ([8, 6, 4], [1.0, 2.0, 0.5]), ([12, 8, 1], [1.5, 0.7, 1.0])] {
        let sum = |symbol: fn(f64) -> f64| -> f64 {
            (0..2).map(|axis| symbol(PI / cells[axis] as f64) / f64::from(spacing_m[axis]).powi(2)).sum()
        };
        let expected = 1.0 - sum(|angle| angle.sin().powi(2)) / sum(|angle| 2.0 - 2.0 * angle.cos());
        let found = fraction_left(&quiet(cells, spacing_m, Boundary::Reflect), 3000);
        assert!((found - expected).abs() < 1e-9, "{cells:?}: {found}, in theory {expected}");
    }
}

/// With enough sweeps a wave decays by backward Euler's factor `1/(1 + ν·dt·Σ (2 − 2cos θ)/h²)` per step.
#[test]
fn diffusion_has_the_decay_of_backward_euler_on_any_cells() {
    let (cells, spacing_m, diffusivity, dt_secs) = ([8, 6, 10], [1.0f32, 2.0, 0.5], 0.5, 0.1);
    let grid = quiet(cells, spacing_m, Boundary::Wrap).grid::<f64>();
    let (mut start, mut end) = (Field::zeros(&grid, Location::Centre), Field::zeros(&grid, Location::Centre));
    start.fill(&grid, |position| (0..3).map(|axis| (TAU * position[axis] / grid.extent_m(axis)).cos()).product());
    listing::set_bound(&grid, Kind::Scalar, &mut start);
    listing::diffuse(&grid, Kind::Scalar, &mut end, &start, diffusivity, dt_secs);
    let rate: f64 = (0..3).map(|axis| (2.0 - 2.0 * (TAU / cells[axis] as f64).cos()) / grid.spacing_m[axis].powi(2)).sum();
    let decay = 1.0 / (1.0 + diffusivity * dt_secs * rate);
    for (start, end) in start.values(&grid).zip(end.values(&grid)) {
        assert!((end - decay * start).abs() < 1e-9, "{end} {}", decay * start);
    }
}

/// In theory a step can add a little energy, where linear backtraces gather more fast air than slow; projection and interpolation remove more.
#[test]
fn energy_stays_below_that_of_the_start_at_any_step() {
    for face in [Boundary::Wrap, Boundary::FreeSlip, Boundary::Reflect] {
        for dt_secs in [0.01, 1.0, 1000.0] {
            let mut air = StableFluids::<f32>::new(&quiet([8; 3], [1.0; 3], face)).unwrap();
            air.set_velocity(rough);
            let start = air.diagnostics().kinetic_energy_m2_per_s2;
            for _ in 0..500 {
                let report = air.step(dt_secs, &[]).unwrap();
                assert!(report.kinetic_energy_m2_per_s2 < start, "{face:?} at {dt_secs} s: {report:?}");
            }
        }
    }
}

/// Settings with every forcing of the air.
fn stormy() -> (Config, Jet) {
    let primitive = |shape, x| Primitive {
        shape,
        position_m: [x, 8.0, 40.0],
        drift_m_per_s: [1.0, 0.0],
        radius_m: 12.0,
        speed_m_per_s: 6.0,
        direction: [1.0, 0.0],
        dust: 0.5,
        intensity: Intensity::Steady,
        front: Front::default(),
    };
    let shapes = [Shape::Uniform, Shape::Source, Shape::Sink, Shape::Vortex, Shape::Cyclone];
    let config = Config {
        cells: [16, 8, 16],
        spacing_m: [5.0, 2.0, 5.0],
        gusts: Gusts { number: 6, ..Gusts::default() },
        primitives: shapes.into_iter().zip([10.0, 25.0, 40.0, 55.0, 70.0]).map(|(shape, x)| primitive(shape, x)).collect(),
        body_force_m_per_s2: [0.0, 0.0, 0.3],
        dust: Some(Dust::default()),
        ..Config::default()
    };
    let jet = Jet { position_m: Vec3::new(40.0, 10.0, 10.0), radius_m: 8.0, velocity_m_per_s: Vec3::new(0.0, -10.0, 0.0), rate_per_s: 2.0 };
    (config, jet)
}

#[test]
fn absurd_steps_stay_finite_and_the_same_bits_come_twice() {
    let (config, jet) = stormy();
    for dt_secs in [0.02, 30.0, 1e4] {
        let config = Config { viscosity_m2_per_s: if dt_secs > 1.0 { 1e6 } else { 0.2 }, ..config.clone() };
        let run = || {
            let mut air = StableFluids::<f32>::new(&config).unwrap();
            for _ in 0..40 {
                let report = air.step(dt_secs, &[jet]).unwrap();
                assert!(report.courant.is_finite() && report.pressure_residual < 1.0, "{report:?}");
            }
            assert!(air.dust().unwrap().all(|density| density.is_finite() && density >= 0.0));
            air.cell_velocities().map(|velocity| velocity.to_array().map(f32::to_bits)).collect::<Vec<_>>()
        };
        assert_eq!(run(), run());
    }
}

/// Forces are applied before the methods differ: momentum agrees with that of the staggered solver.
#[test]
fn forces_are_those_of_the_staggered_solver() {
    let (config, jet) = stormy();
    let config = Config { primitives: config.primitives.into_iter().filter(|primitive| !primitive.is_source()).collect(), ..config };
    let mean = |cells: &mut dyn Iterator<Item = Vec3>| cells.sum::<Vec3>() / (16.0 * 8.0 * 16.0);
    let mut air = StableFluids::<f32>::new(&config).unwrap();
    let before = mean(&mut air.cell_velocities());
    let mut staggered = Solver::<f32>::new(&config).unwrap();
    for _ in 0..10 {
        air.step(0.05, &[jet]).unwrap();
        staggered.step(0.05, &[jet]).unwrap();
    }
    let [own, other] = [mean(&mut air.cell_velocities()), mean(&mut staggered.cell_velocities())];
    assert!((own - before).length() > 0.1, "forces act: {before} {own}");
    let apart = Vec3::new(own.x - other.x, 0.0, own.z - other.z).length();
    assert!(apart < 0.15 * (other - before).length(), "{own} {other}");
}

#[test]
fn sources_blow_and_sinks_draw() {
    let (config, _) = stormy();
    for (shape, sign) in [(Shape::Source, 1.0), (Shape::Sink, -1.0)] {
        let primitive = Primitive { shape, position_m: [8.0; 3], drift_m_per_s: [0.0; 2], radius_m: 6.0, ..config.primitives[0].clone() };
        let config = Config { primitives: vec![primitive], ..quiet([8; 3], [2.0; 3], Boundary::FreeSlip) };
        let mut air = StableFluids::<f32>::new(&config).unwrap();
        air.step(0.1, &[]).unwrap();
        let outward = sign * (air.velocity_at([12.0, 8.0, 8.0])[0] - air.velocity_at([4.0, 8.0, 8.0])[0]);
        assert!(outward > 1.0, "{shape:?}: {outward} m/s");
    }
}

#[test]
fn air_that_is_not_a_number_is_refused() {
    let mut air = StableFluids::<f32>::new(&quiet([4; 3], [1.0; 3], Boundary::Wrap)).unwrap();
    air.set_velocity(|[x, ..]| [if x > 3.0 { f32::NAN } else { 0.0 }, 0.0, 0.0]);
    assert!(matches!(air.step(0.1, &[]), Err(StepError::NotFinite { time_secs: 0.0, .. })));
}

/// Root mean square error of a decaying Taylor–Green vortex after 2 s at Courant number 1/2.
fn taylor_green_error(n: usize) -> f64 {
    let (k, viscosity, secs) = (TAU / 10.0, 0.05f32, 2.0);
    let config = Config { viscosity_m2_per_s: viscosity, ..quiet([n, 1, n], [10.0 / n as f32, 1.0, 10.0 / n as f32], Boundary::Wrap) };
    let exact = |[x, _, z]: [f64; 3], time_secs: f64| {
        let speed = (-2.0 * f64::from(viscosity) * k * k * time_secs).exp();
        [speed * (k * x).sin() * (k * z).cos(), 0.0, -speed * (k * x).cos() * (k * z).sin()]
    };
    let mut air = StableFluids::<f64>::new(&config).unwrap();
    air.set_velocity(|position| exact(position, 0.0));
    let steps = 4 * n / 10;
    for _ in 0..steps {
        air.step(secs / steps as f64, &[]).unwrap();
    }
    let squares: f64 = air.samples(0).map(|(position, u)| (u - exact(position, secs)[0]).powi(2)).sum();
    (squares / (n * n) as f64).sqrt()
}

/// First order while twenty sweeps reach across the box; on finer grids they do not, and the error grows again.
#[test]
fn refinement_helps_only_as_far_as_the_sweeps_reach() {
    let [coarse, middle, fine] = [16, 32, 128].map(taylor_green_error);
    let order = (coarse / middle).log2();
    assert!((0.7..1.1).contains(&order), "order {order}: {coarse} {middle}");
    assert!(fine > middle, "{middle} {fine}");
}
