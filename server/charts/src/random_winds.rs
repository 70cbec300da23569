//! Random wind configurations from everything that the solver accepts, absurd ones included.

use prairie_core::random::SplitMix64;
use prairie_wind::pressure::{Effort, IterativeMethod};
use prairie_wind::{
    Advection, Boundary, Canopy, Config, Diffusion, Dust, Front, Gusts, Intensity, Jet, Pressure, Primitive, Profile, Real, Shape, Solver,
    TimeScheme,
};

/// Random numbers from a seed.
pub struct Random(SplitMix64);

impl Random {
    /// A generator whose numbers depend on the seed alone.
    pub fn new(seed: u64) -> Self {
        Self(SplitMix64::new(seed))
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0.unit()
    }

    /// Uniform between two numbers.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Log-uniform between two positive numbers.
    pub fn scale(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    /// True with probability 1/`n`.
    pub fn one_in(&mut self, n: u64) -> bool {
        self.bits().is_multiple_of(n)
    }

    /// One of the given values.
    pub fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[(self.bits() % choices.len() as u64) as usize]
    }
}

/// A run: configuration, initial state and time step.
#[derive(Clone, Debug)]
pub struct RandomWind {
    /// Configuration that [`Config::validate`] accepts.
    pub config: Config,
    /// Largest initial speed (m/s); each face component is random.
    pub speed_m_per_s: f64,
    /// Fraction of solid cells; 0 where the methods do not support them.
    pub solid: f64,
    /// Amplitude (m/s) of the waves on inflow faces; `None` for the mean wind.
    pub inflow_m_per_s: Option<f64>,
    /// Jets of every step.
    pub jets: Vec<Jet>,
    /// Time step (s).
    pub dt_secs: f64,
    /// Seed of the initial velocity and of the solid cells.
    pub seed: u64,
}

impl RandomWind {
    /// The configuration of a seed. Half of them have no forcing.
    pub fn new(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let driven = random.one_in(2);
        let cells = cells(&mut random);
        let finest_m = random.scale(0.01, 100.0);
        let spacing_m = [0; 3].map(|_| (finest_m * random.of(&[1.0, 1.0, 2.0, 10.0])) as f32);
        let boundary = [0, 1, 2].map(|axis| faces(&mut random, axis, driven));
        let (advection, time) = random.of(&schemes());
        let config = Config {
            cells,
            spacing_m,
            boundary,
            advection,
            damping: random.of(&[0.0, 0.5, 1.0]),
            time,
            diffusion: diffusion(&mut random),
            pressure: pressure(&mut random),
            viscosity_m2_per_s: if random.one_in(4) { 0.0 } else { random.scale(1e-5, 1e4) as f32 },
            relaxation_per_s: 0.0,
            mean_wind_m_per_s: [0.0; 3],
            profile: Profile::Uniform,
            gusts: Gusts { number: 0, ..Gusts::default() },
            canopy: random.one_in(3).then(|| Canopy {
                height_m: random.scale(0.01, 100.0) as f32,
                drag_per_m: random.scale(1e-3, 1e3) as f32,
                motion: None,
            }),
            dust: random.one_in(2).then(|| dust(&mut random)),
            seed: random.bits(),
            ..Config::default()
        };
        let may_be_solid =
            config.pressure != Pressure::Direct && matches!(config.diffusion, Diffusion::Explicit | Diffusion::GaussSeidel { .. });
        let mut wind = Self {
            speed_m_per_s: if random.one_in(4) { 0.0 } else { random.scale(1e-3, 100.0) },
            solid: if may_be_solid { random.of(&[0.0, 0.0, 0.1, 0.6]) } else { 0.0 },
            inflow_m_per_s: None,
            jets: Vec::new(),
            dt_secs: random.scale(1e-3, 100.0),
            seed: random.bits(),
            config,
        };
        if driven {
            wind.drive(&mut random);
        }
        wind
    }

    fn drive(&mut self, random: &mut Random) {
        let extent_m: [f64; 3] = std::array::from_fn(|axis| self.config.cells[axis] as f64 * f64::from(self.config.spacing_m[axis]));
        let largest_m = extent_m.into_iter().fold(0.0, f64::max);
        let somewhere = |random: &mut Random| extent_m.map(|extent| (random.between(-0.5, 1.5) * extent) as f32);
        let radius_m = |random: &mut Random| random.scale(1e-3, 3.0 * largest_m.max(1e-2)) as f32;
        let config = &mut self.config;
        config.relaxation_per_s = random.of(&[0.0, 0.2, 1e4]);
        for axis in [0, 2] {
            if !config.boundary[axis].iter().any(|face| face.blocks_flow()) {
                config.mean_wind_m_per_s[axis] = random.between(-40.0, 40.0) as f32;
            }
        }
        if config.boundary[1][0] != Boundary::Wrap {
            let reference_m = random.scale(0.1, 100.0) as f32;
            config.profile = random.of(&[
                Profile::Uniform,
                Profile::Log { roughness_m: 0.05, reference_m },
                Profile::Power { exponent: 1.0 / 7.0, reference_m },
            ]);
        }
        if random.one_in(4) {
            config.body_force_m_per_s2 = [0; 3].map(|_| random.between(-100.0, 100.0) as f32);
        }
        config.gusts = Gusts {
            number: random.of(&[0, 1, 24]),
            strength_m_per_s: random.scale(0.1, 1e3) as f32,
            life_secs: random.scale(1e-2, 100.0) as f32,
            attack: random.between(0.01, 0.99) as f32,
            radius_m: [0; 3].map(|_| radius_m(random)),
        };
        let number = random.of(&[0, 0, 1, 3]);
        config.primitives = (0..number)
            .map(|_| {
                let angle = random.between(0.0, std::f64::consts::TAU);
                Primitive {
                    shape: random.of(&[Shape::Uniform, Shape::Source, Shape::Sink, Shape::Vortex, Shape::Cyclone]),
                    position_m: somewhere(random),
                    drift_m_per_s: [0; 2].map(|_| random.between(-200.0, 200.0) as f32),
                    radius_m: radius_m(random),
                    speed_m_per_s: random.scale(0.1, 200.0) as f32,
                    direction: [angle.cos() as f32, angle.sin() as f32],
                    dust: random.unit() as f32,
                    intensity: Intensity::Steady,
                    front: Front::default(),
                }
            })
            .collect();
        self.inflow_m_per_s = random.one_in(2).then(|| random.scale(0.1, 100.0));
        if random.one_in(4) {
            let velocity = [0; 3].map(|_| random.between(-100.0, 100.0) as f32);
            self.jets = vec![Jet {
                position_m: somewhere(random).into(),
                radius_m: radius_m(random),
                velocity_m_per_s: velocity.into(),
                rate_per_s: random.scale(0.1, 1e3) as f32,
            }];
        }
    }

    /// Whether a forcing may add energy to the air.
    pub fn is_driven(&self) -> bool {
        let c = &self.config;
        let moving = |face: &Boundary| matches!(face, Boundary::Lid { .. } | Boundary::Inflow);
        let pushed = c.gusts.number > 0 || !c.primitives.is_empty() || c.relaxation_per_s > 0.0 || c.body_force_m_per_s2 != [0.0; 3];
        pushed || !self.jets.is_empty() || c.boundary.iter().flatten().any(moving)
    }

    /// A solver at the start of the run.
    ///
    /// # Errors
    /// Those of [`Solver::new`] and [`Solver::set_solid`].
    pub fn solver<R: Real>(&self) -> anyhow::Result<Solver<R>> {
        let mut solver = Solver::new(&self.config)?;
        let at = |position: [R; 3], salt: u64| {
            let key = position.into_iter().fold(self.seed ^ salt, |key, x| Random::new(key ^ x.wide().to_bits()).bits());
            Random::new(key).unit()
        };
        if let Some(speed) = self.inflow_m_per_s {
            solver.set_inflow(move |[x, y, z], t| [speed * (x + t).sin(), speed * (y - t).cos(), speed * (z + t).sin()]);
        }
        if self.speed_m_per_s > 0.0 {
            solver.set_velocity(|position| [1, 2, 3].map(|salt| R::of(self.speed_m_per_s * (2.0 * at(position, salt) - 1.0))));
        }
        if self.solid > 0.0 {
            solver.set_solid(|position| at(position, 4) < self.solid)?;
        }
        solver.set_dust(|position| R::of(at(position, 5)));
        Ok(solver)
    }
}

/// Every allowed pair of advection and time scheme.
fn schemes() -> Vec<(Advection, TimeScheme)> {
    let pairs = Advection::ALL.iter().flat_map(|&advection| TimeScheme::ALL.iter().map(move |&time| (advection, time)));
    pairs.filter(|&(advection, time)| time.allows(advection)).collect()
}

/// Mostly some hundred cells, now and then thousands; flat and narrow boxes too.
fn cells(random: &mut Random) -> [usize; 3] {
    let most = if random.one_in(40) { 16_000 } else { 500 };
    loop {
        let cells = [0; 3].map(|_| if random.one_in(4) { 1 } else { random.scale(1.0, 41.0) as usize });
        if cells.iter().product::<usize>() <= most {
            return cells;
        }
    }
}

fn faces(random: &mut Random, axis: usize, driven: bool) -> [Boundary; 2] {
    if random.one_in(3) {
        return [Boundary::Wrap; 2];
    }
    [0, 1].map(|_| {
        let mut lid = [0; 3].map(|_| random.between(-40.0, 40.0) as f32);
        lid[axis] = 0.0;
        let still = [Boundary::FreeSlip, Boundary::Reflect, Boundary::NoSlip, Boundary::Outflow];
        let moving = [Boundary::Lid { velocity_m_per_s: lid }, Boundary::Inflow];
        if driven && random.one_in(2) { random.of(&moving) } else { random.of(&still) }
    })
}

fn diffusion(random: &mut Random) -> Diffusion {
    let sweeps = random.scale(1.0, 30.0) as u32;
    random.of(&[Diffusion::Explicit, Diffusion::GaussSeidel { sweeps }, Diffusion::Implicit, Diffusion::CrankNicolson])
}

fn pressure(random: &mut Random) -> Pressure {
    let methods = [
        IterativeMethod::Jacobi,
        IterativeMethod::GaussSeidel,
        IterativeMethod::Sor,
        IterativeMethod::ConjugateGradients,
        IterativeMethod::Multigrid,
    ];
    if random.one_in(3) {
        return Pressure::Direct;
    }
    Pressure::Iterative(random.of(&methods), Effort { tolerance: random.scale(1e-10, 0.1), sweeps: random.scale(1.0, 60.0) as u32 })
}

fn dust(random: &mut Random) -> Dust {
    Dust {
        advection: random.of(Advection::ALL),
        diffusivity_m2_per_s: random.of(&[0.0, 0.2, 100.0]),
        release_per_s: random.of(&[0.0, 1.0, 1e6]),
        settling_per_s: random.of(&[0.0, 0.1, 1e6]),
    }
}
