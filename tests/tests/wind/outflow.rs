//! Outflow faces: vortices leave the box, a channel keeps its exact profile, and air that flows back in brings no energy.

use prairie_wind::{Advection, Boundary, Config, Diffusion, Gusts, Profile, Solver, TimeScheme};

const WIND_M_PER_S: f64 = 4.0;

/// Calm air without forcing in a box of these cells (m).
fn calm(cells: [usize; 3], spacing_m: f64, boundary: [[Boundary; 2]; 3]) -> Config {
    Config {
        cells,
        spacing_m: [spacing_m as f32; 3],
        boundary,
        viscosity_m2_per_s: 0.0,
        relaxation_per_s: 0.0,
        mean_wind_m_per_s: [0.0; 3],
        profile: Profile::Uniform,
        gusts: Gusts { number: 0, ..Gusts::default() },
        canopy: None,
        ..Config::default()
    }
}

/// Velocity (m/s) of a vortex about z, fastest (`speed_m_per_s`) at `core_m` from its centre.
fn vortex([dx, dy]: [f64; 2], core_m: f64, speed_m_per_s: f64) -> [f64; 2] {
    let fraction = speed_m_per_s / core_m * (0.5 * (1.0 - (dx * dx + dy * dy) / (core_m * core_m))).exp();
    [-fraction * dy, fraction * dx]
}

/// Sum of the squares of the deviation from the wind (m⁴/s²).
fn deviation(solver: &Solver<f64>) -> f64 {
    let spacing_m = solver.grid().spacing_m;
    let square = |axis: usize, u: f64| (if axis == 0 { u - WIND_M_PER_S } else { u }).powi(2);
    let sum: f64 = (0..2).flat_map(|axis| solver.samples(axis).map(move |(_, u)| square(axis, u))).sum();
    sum * spacing_m[0] * spacing_m[1]
}

/// Energy of a vortex of 3 m core that the wind carries out of a box of 64 m × 32 m, relative to the start: while it is inside, and 6 s after its centre has left.
fn carried_out(rows: usize, damping: f32, speed_m_per_s: f64) -> anyhow::Result<[f64; 2]> {
    let spacing_m = 32.0 / rows as f64;
    let boundary = [[Boundary::Inflow, Boundary::Outflow], [Boundary::FreeSlip; 2], [Boundary::Wrap; 2]];
    let config = Config { damping, mean_wind_m_per_s: [WIND_M_PER_S as f32, 0.0, 0.0], ..calm([2 * rows, rows, 1], spacing_m, boundary) };
    let mut solver = Solver::<f64>::new(&config)?;
    solver.set_velocity(|[x, y, _]| {
        let [u, v] = vortex([x - 40.0, y - 16.0], 3.0, speed_m_per_s);
        [WIND_M_PER_S + u, v, 0.0]
    });
    let start = deviation(&solver);
    let steps_per_sec = (40.0 / spacing_m) as usize;
    let mut run = |secs: usize| -> anyhow::Result<f64> {
        for _ in 0..secs * steps_per_sec {
            solver.step(1.0 / steps_per_sec as f64, &[])?;
        }
        Ok(deviation(&solver) / start)
    };
    Ok([run(3)?, run(9)?])
}

#[test]
fn vortices_on_fine_grids_leave_with_less_than_a_hundredth_of_their_energy_reflected() -> anyhow::Result<()> {
    for speed_m_per_s in [2.0, 6.0] {
        let mut conserved = Vec::new();
        for rows in [16, 32, 64] {
            let [inside, left] = carried_out(rows, 1.0, speed_m_per_s)?;
            let [kept, noise] = carried_out(rows, 0.0, speed_m_per_s)?;
            println!("{speed_m_per_s} m/s, {rows} rows: {left:.1e} of {inside:.2} are left with damping, {noise:.1e} of {kept:.2} without");
            assert!(rows < 32 || left < 0.01, "{left} left on {rows} rows");
            assert!(inside > 0.5 && kept > 0.97, "it is still inside: {inside}, {kept}");
            conserved.push(noise);
        }
        // Without damping nothing removes the waves of two cells that the coarse grid makes of the vortex.
        let orders = [0, 1].map(|at| (conserved[at] / conserved[at + 1]).log2());
        assert!(conserved[2] < 0.01 && orders.iter().all(|order| *order > 1.0), "{conserved:?}: orders {orders:?}");
    }
    Ok(())
}

/// Largest error (m/s) after 8 s of plane Poiseuille flow, between an inflow and an outflow face, relative to the exact parabola, for which friction at the walls is
/// exact.
fn channel_error(diffusion: Diffusion, time: TimeScheme, dt_secs: f64) -> anyhow::Result<f64> {
    let (rows, spacing_m) = (12, 0.25);
    let profile = move |y: f64| {
        let (half_m, from_middle_m) = (0.5 * rows as f64 * spacing_m, y - 0.5 * rows as f64 * spacing_m);
        half_m * half_m - from_middle_m * from_middle_m
    };
    let boundary = [[Boundary::Inflow, Boundary::Outflow], [Boundary::NoSlip; 2], [Boundary::Wrap; 2]];
    let config = Config { viscosity_m2_per_s: 0.3, diffusion, time, ..calm([20, rows, 1], spacing_m, boundary) };
    let mut solver = Solver::<f64>::new(&config)?;
    solver.set_inflow(move |[_, y, _], _| [profile(y), 0.0, 0.0]);
    solver.set_velocity(move |[_, y, _]| [profile(y), 0.0, 0.0]);
    for _ in 0..(8.0 / dt_secs) as usize {
        solver.step(dt_secs, &[])?;
    }
    let across = solver.samples(1).map(|(_, v)| v.abs());
    Ok(solver.samples(0).map(|([_, y, _], u)| (u - profile(y)).abs()).chain(across).fold(0.0, f64::max))
}

#[test]
fn a_channel_keeps_its_profile() -> anyhow::Result<()> {
    for time in [TimeScheme::Split, TimeScheme::RungeKutta3] {
        let worst = channel_error(Diffusion::Explicit, time, 0.02)?;
        assert!(worst < 1e-9, "{time:?}: {worst} m/s of 2.3");
    }
    // Implicit friction acts on a velocity that the pressure has changed, while inflow and walls keep theirs: an error of first order.
    for diffusion in [Diffusion::GaussSeidel { sweeps: 200 }, Diffusion::Implicit] {
        let mut errors = Vec::new();
        for dt_secs in [0.02, 0.01, 0.005] {
            errors.push(channel_error(diffusion, TimeScheme::RungeKutta3, dt_secs)?);
        }
        let orders = [0, 1].map(|at| (errors[at] / errors[at + 1]).log2());
        println!("{diffusion:?}: {errors:?} m/s, orders {orders:.2?}");
        assert!(errors[0] < 2e-3 && orders.iter().all(|order| *order > 0.9), "{diffusion:?}: {errors:?}, orders {orders:?}");
    }
    Ok(())
}

/// Twice the kinetic energy, the values on the faces of the box counted half.
fn energy(solver: &Solver<f64>) -> f64 {
    let extent_m = [0, 1, 2].map(|axis| solver.grid().extent_m(axis));
    let weight = |axis: usize, at: f64| if at == 0.0 || at == extent_m[axis] { 0.5 } else { 1.0 };
    (0..3).flat_map(|axis| solver.samples(axis).map(move |(at, u)| weight(axis, at[axis]) * u * u)).sum()
}

/// A cyclone at the corner of two open faces draws air in through both: without the rule for backflow it would bring ever more energy.
#[test]
fn a_cyclone_at_open_faces_brings_no_energy_in() -> anyhow::Result<()> {
    let boundary = [[Boundary::FreeSlip, Boundary::Outflow], [Boundary::Wrap; 2], [Boundary::Outflow; 2]];
    for (diffusion, viscosity_m2_per_s) in [(Diffusion::Explicit, 0.0), (Diffusion::Implicit, 0.1), (Diffusion::CrankNicolson, 0.1)] {
        let config = Config {
            damping: 0.0,
            advection: Advection::Conservative,
            time: TimeScheme::RungeKutta3,
            diffusion,
            viscosity_m2_per_s,
            ..calm([24, 3, 24], 1.0, boundary)
        };
        let mut solver = Solver::<f64>::new(&config)?;
        solver.set_velocity(|[x, _, z]| {
            let [u, w] = vortex([x - 22.0, z - 20.0], 5.0, 10.0);
            [u, 0.0, w]
        });
        solver.step(1e-6, &[])?;
        let (start, mut before, mut rise) = (energy(&solver), energy(&solver), 0.0_f64);
        for _ in 0..1500 {
            solver.step(0.02, &[])?;
            let now = energy(&solver);
            assert!(now <= start * (1.0 + 1e-3), "{diffusion:?}: {now} of {start}");
            rise = rise.max((now - before) / start);
            before = now;
        }
        println!("{diffusion:?}: {:.1e} of the energy is left, no step adds more than {rise:.1e} of it", before / start);
        assert!(rise < 1e-4 && before < 0.9 * start, "{diffusion:?}: {before} of {start}, {rise}");
    }
    Ok(())
}
