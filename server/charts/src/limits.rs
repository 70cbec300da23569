//! Stability limits of the wind's methods, measured by bisection, beside theory.
//!
//! A trial runs a method on noise for some hundred steps and tests whether its norm grew in the second half. By then decaying modes are negligible, so the
//! result changes where the amplification of the fastest mode passes 1.

use std::f64::consts::TAU;

use prairie_wind::boundary::BoundaryConditions;
use prairie_wind::transport::{STAGES, Stage, TransportScratch, stable_dt_secs};
use prairie_wind::{Boundary, Config, Field, Grid, Gusts, Location, Profile, Solver, Velocity, diagnostics, diffuse};

use crate::random_winds::Random;

const STEPS: usize = 400;
const BISECTIONS: usize = 30;

/// A stability limit in theory and as measured.
#[derive(Clone, Debug)]
pub struct Limit {
    /// The method.
    pub scheme: String,
    /// Limited quantity.
    pub number: &'static str,
    /// Its limit in theory.
    pub theory: f64,
    /// Largest stable value, measured.
    pub measured: f64,
}

impl Limit {
    /// Measured over theory.
    pub fn ratio(&self) -> f64 {
        self.measured / self.theory
    }
}

/// Largest number in an interval up to which `stable` holds, by bisection.
fn bisect([mut low, mut high]: [f64; 2], stable: impl Fn(f64) -> bool) -> f64 {
    assert!(stable(low) && !stable(high), "stable at {low}, unstable at {high}");
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        *(if stable(middle) { &mut low } else { &mut high }) = middle;
    }
    low
}

fn wrapped(cells: [usize; 3], spacing_m: [f64; 3]) -> Grid<f64> {
    Grid { cells, spacing_m, boundary: [[Boundary::Wrap; 2]; 3] }
}

/// Fills the ghost cells of a field with periodic boundaries on all faces.
fn wrap(grid: &Grid<f64>, field: &mut Field<f64>) {
    let padded = grid.padded();
    let inner = |i: usize, axis: usize| (i + grid.cells[axis] * padded[axis] - prairie_wind::GHOST) % grid.cells[axis];
    let values = field.data.clone();
    for k in 0..padded[2] {
        for j in 0..padded[1] {
            for i in 0..padded[0] {
                field.data[i + padded[0] * (j + padded[1] * k)] = values[grid.at([inner(i, 0), inner(j, 1), inner(k, 2)])];
            }
        }
    }
}

fn noise(grid: &Grid<f64>, location: Location) -> Field<f64> {
    let (mut field, mut random) = (Field::zeros(grid, location), Random::new(7));
    field.data.iter_mut().for_each(|value| *value = random.unit());
    let mean = field.values(grid).sum::<f64>() / field.len() as f64;
    field.data.iter_mut().for_each(|value| *value -= mean);
    wrap(grid, &mut field);
    field
}

fn norm(grid: &Grid<f64>, field: &Field<f64>) -> f64 {
    field.values(grid).map(|value| value * value).sum::<f64>().sqrt()
}

/// Whether the norm of noise does not grow from the middle to the end of the trial, apart from rounding errors.
fn holds(grid: &Grid<f64>, mut step: impl FnMut(&mut Field<f64>)) -> bool {
    let mut field = noise(grid, Location::Face(0));
    let rounding = 1e-12 * norm(grid, &field);
    (0..STEPS / 2).for_each(|_| step(&mut field));
    let middle = norm(grid, &field);
    (0..STEPS / 2).for_each(|_| step(&mut field));
    norm(grid, &field) <= middle * (1.0 + 1e-9) + rounding
}

/// Limit of explicit diffusion as `ν·dt·Σ 1/h²` over the axes with more than one cell, with the conditions `across` at both faces across y; periodic along x and z. In
/// theory 1/2 in a periodic box, which is `a = ν·dt/h² = 1/6` on cubes, and by the step that the scheme allows between walls.
pub fn explicit_diffusion(name: &str, cells: [usize; 3], spacing_m: [f64; 3], across: [Boundary; 2], midpoint: bool) -> Limit {
    let grid = Grid { boundary: [[Boundary::Wrap; 2], across, [Boundary::Wrap; 2]], ..wrapped(cells, spacing_m) };
    let boundaries = BoundaryConditions::new(&grid, Box::new(|_, _| [0.0; 3]));
    let per_m2: f64 = (0..3).filter(|&axis| cells[axis] > 1).map(|axis| spacing_m[axis].powi(-2)).sum();
    let theory = if grid.wraps(1) { 0.5 } else { diffuse::stable_dt_secs(&grid, 1.0) * per_m2 };
    let stable = |number: f64| {
        let mut next = [0; 2].map(|_| Field::zeros(&grid, Location::Face(0)));
        holds(&grid, |field| {
            let [half, next] = &mut next;
            boundaries.apply_to_component(field);
            if midpoint {
                diffuse::explicit(&grid, 1.0, 0.5 * number / per_m2, field, field, half);
                boundaries.apply_to_component(half);
                diffuse::explicit(&grid, 1.0, number / per_m2, field, half, next);
            } else {
                diffuse::explicit(&grid, 1.0, number / per_m2, field, field, next);
            }
            std::mem::swap(field, next);
        })
    };
    let scheme = format!("{} diffusion, {name}", if midpoint { "midpoint" } else { "explicit" });
    Limit { scheme, number: "nu dt sum 1/h^2", theory, measured: bisect([0.25, 1.0], stable) }
}

/// Conservative transport by uniform air in a periodic box.
#[derive(Clone, Copy, Debug)]
pub struct Transport {
    /// Cells along each axis.
    pub cells: [usize; 3],
    /// Size of a cell (m).
    pub spacing_m: [f64; 3],
    /// Air velocity (m/s).
    pub air_m_per_s: [f64; 3],
    /// Diffusivity in the flux (m²/s).
    pub diffusivity_m2_per_s: f64,
    /// Upwind fraction, 0 to 1.
    pub damping: f64,
}

impl Transport {
    /// Largest amplification `|R(z)|` of a step, `R(z) = 1 + z + z²/2 + z³/6`, over `modes` wave numbers along each axis with more than one cell.
    pub fn amplification(&self, dt_secs: f64, modes: usize) -> f64 {
        let count = self.cells.map(|n| if n > 1 { modes } else { 1 });
        let mut largest = 0.0f64;
        for wave in 0..count.iter().product() {
            let index = [wave % count[0], wave / count[0] % count[1], wave / (count[0] * count[1])];
            let [mut re, mut im] = [0.0; 2];
            for axis in 0..3 {
                let angle = TAU * index[axis] as f64 / count[axis] as f64;
                let courant = self.air_m_per_s[axis] * dt_secs / self.spacing_m[axis];
                let second = 2.0 - 2.0 * angle.cos();
                im -= courant * angle.sin();
                re -= self.damping / 12.0 * courant.abs() * second * second;
                re -= self.diffusivity_m2_per_s * dt_secs / self.spacing_m[axis].powi(2) * second;
            }
            // Horner: 1 + z(1 + z/2(1 + z/3)).
            let r = [3.0, 2.0, 1.0].into_iter().fold([1.0, 0.0], |[a, b], n| [1.0 + (a * re - b * im) / n, (a * im + b * re) / n]);
            largest = largest.max(r[0].hypot(r[1]));
        }
        largest
    }

    /// Longest stable step (s) by [`Transport::amplification`].
    pub fn theory_secs(&self, modes: usize) -> f64 {
        // Searches up to four times the allowed step: that also counts diffusion along axes of a single cell, where there is none.
        let allowed = stable_dt_secs(&wrapped(self.cells, self.spacing_m), self.air_m_per_s.map(f64::abs), self.diffusivity_m2_per_s);
        bisect([0.5 * allowed, 4.0 * allowed], |dt_secs| self.amplification(dt_secs, modes) <= 1.0 + 1e-12)
    }

    /// Whether noise does not grow at this time step.
    pub fn holds(&self, dt_secs: f64) -> bool {
        let grid = wrapped(self.cells, self.spacing_m);
        let mut air = Velocity::zeros(&grid);
        air.0.iter_mut().zip(self.air_m_per_s).for_each(|(field, speed)| field.data.fill(speed));
        let mut stages = [0; 2].map(|_| Field::zeros(&grid, Location::Face(0)));
        let mut scratch = TransportScratch::new(&grid);
        holds(&grid, |field| run(&grid, &air, field, &mut stages, &mut scratch, dt_secs, self.diffusivity_m2_per_s, self.damping))
    }

    /// Longest stable step (s): in theory, over the wave numbers of the box, and measured.
    pub fn limit(&self, name: &str) -> Limit {
        let theory = self.theory_secs(self.cells.into_iter().max().unwrap_or(1));
        let measured = bisect([0.5 * theory, 2.0 * theory], |dt_secs| self.holds(dt_secs));
        Limit { scheme: format!("Runge-Kutta 3, {name}"), number: "dt_secs", theory, measured }
    }
}

/// One Runge–Kutta 3 step of a field in frozen air.
#[expect(clippy::too_many_arguments, reason = "a kernel: a field, its scratch and numbers")]
fn run(
    grid: &Grid<f64>,
    air: &Velocity<f64>,
    field: &mut Field<f64>,
    [even, odd]: &mut [Field<f64>; 2],
    scratch: &mut TransportScratch<f64>,
    dt_secs: f64,
    diffusivity_m2_per_s: f64,
    damping: f64,
) {
    for (number, fraction) in STAGES.into_iter().enumerate() {
        let (carried, target) = match number {
            0 => (&*field, &mut *even),
            1 => (&*even, &mut *odd),
            _ => (&*odd, &mut *even),
        };
        Stage { grid, air, carried, start: field, pressure_gradient: None, dt_secs, fraction, diffusivity_m2_per_s, damping }
            .run(target, scratch);
        wrap(grid, target);
    }
    std::mem::swap(field, even);
}

/// Largest Courant number (summed over the axes, worst face) at which limited transport keeps noisy dust between 0 and 1, in uniform air or in divergence-free
/// noise. Theory: 1/2. Up to there every stage is a weighted mean of old values, since a face value differs from the cell by at most the difference to the
/// upwind cell, so at most twice the outflowing fraction leaves. The condition is sufficient, not necessary.
pub fn dust_bounds(name: &str, cells: [usize; 3], uniform: bool) -> Limit {
    let config = Config {
        cells,
        spacing_m: [1.0; 3],
        boundary: [[Boundary::Wrap; 2]; 3],
        profile: Profile::Uniform,
        mean_wind_m_per_s: [0.0; 3],
        gusts: Gusts { number: 0, ..Gusts::default() },
        ..Config::default()
    };
    let mut solver = Solver::<f64>::new(&config).expect("a legal box");
    if !uniform {
        solver.set_velocity(|position| {
            let seed = position.iter().fold(3, |seed, x| Random::new(seed ^ x.to_bits()).bits());
            let mut random = Random::new(seed);
            [0; 3].map(|_| random.between(-1.0, 1.0))
        });
    }
    let (grid, mut air) = (*solver.grid(), solver.velocity().clone());
    if uniform {
        air.0.iter_mut().zip(cells).filter(|(_, n)| *n > 1).for_each(|(field, _)| field.data.fill(1.0));
    }
    let courant_per_s: f64 = diagnostics::largest_speeds(&grid, &air, &air, 0.0).iter().sum();
    let stable = |courant: f64| {
        let mut dust = Field::zeros(&grid, Location::Centre);
        let mut random = Random::new(11);
        dust.data.iter_mut().for_each(|value| *value = f64::from(u8::from(random.one_in(2))));
        wrap(&grid, &mut dust);
        let mut stages = [dust.clone(), dust.clone()];
        let mut scratch = TransportScratch::new(&grid);
        (0..STEPS / 4).all(|_| {
            run(&grid, &air, &mut dust, &mut stages, &mut scratch, courant / courant_per_s, 0.0, 0.0);
            dust.values(&grid).all(|density| (-1e-12..=1.0 + 1e-12).contains(&density))
        })
    };
    let mut measured = 0.5;
    while stable(measured + 0.01) && measured < 2.0 {
        measured += 0.01;
    }
    let measured = if stable(0.5) { measured } else { 0.0 };
    Limit { scheme: format!("limited dust, {name}"), number: "Courant number", theory: 0.5, measured }
}
