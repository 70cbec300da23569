//! From what a scene says of its wind to the settings of a solver.

use crate::wind::pressure::{Effort, Method as Iteration};
use crate::wind::{Advection, Boundary, Canopy, Config, Diffusion, Dust, Gusts, Method, Pressure, Primitive, Profile, Shape, TimeScheme};
use shared::scene::{PrimitiveKind, Scene, Wind, WindAdvection, WindBoundary, WindDiffusion, WindMethod, WindPressure, WindTime};

/// Roughness length of grass (m), for the logarithmic profile.
const ROUGHNESS_M: f32 = 0.05;

/// The solver's method and settings for `scene`.
pub(super) fn settings(scene: &Scene) -> (Method, Config) {
    let wind = &scene.wind;
    let [hx, hy, hz] = wind.spacing_m;
    let config = Config {
        cells: wind.cells.map(|n| n as usize),
        spacing_m: wind.spacing_m,
        boundary: wind.faces.pairs().map(|pair| pair.map(|face| boundary(face, wind.faces.lid_m_per_s))),
        advection: advection(wind.advection),
        time: match wind.time {
            WindTime::Split => TimeScheme::Split,
            WindTime::Reflection => TimeScheme::Reflection,
            WindTime::RungeKutta3 => TimeScheme::RungeKutta3,
        },
        diffusion: match wind.diffusion {
            WindDiffusion::Explicit => Diffusion::Explicit,
            WindDiffusion::GaussSeidel => Diffusion::GaussSeidel { sweeps: wind.diffusion_sweeps },
            WindDiffusion::Implicit => Diffusion::Implicit,
            WindDiffusion::CrankNicolson => Diffusion::CrankNicolson,
        },
        pressure: pressure(wind),
        viscosity_m2_per_s: wind.viscosity_m2_per_s,
        mean_wind_m_per_s: [wind.mean_m_per_s[0], 0.0, wind.mean_m_per_s[1]],
        profile: Profile::Log { roughness_m: ROUGHNESS_M, reference_m: 5.0 * hy },
        relaxation_per_sec: wind.mean_rate_per_s,
        body_force_m_per_s2: [wind.body_force_m_per_s2[0], 0.0, wind.body_force_m_per_s2[1]],
        gusts: Gusts {
            number: wind.sources as usize,
            strength_m_per_s: wind.source_m_per_s,
            radius_m: [1.75 * hx, 2.5 * hy, 1.75 * hz],
            ..Gusts::default()
        },
        primitives: wind.primitives.iter().map(primitive).collect(),
        canopy: (wind.canopy_drag_per_m > 0.0).then_some(Canopy { height_m: scene.tallest_m(), drag_per_m: wind.canopy_drag_per_m }),
        dust: wind.has_dust().then_some(Dust {
            advection: advection(wind.dust.advection),
            diffusivity_m2_per_s: wind.dust.diffusivity_m2_per_s,
            release_per_sec: wind.dust.release_per_s,
            settling_per_sec: wind.dust.settling_per_s,
        }),
        seed: scene.seed,
        ..Config::default()
    };
    let method = match wind.method {
        WindMethod::Staggered => Method::Staggered,
        WindMethod::StableFluids => Method::StableFluids,
    };
    (method, config)
}

fn boundary(face: WindBoundary, lid_m_per_s: [f32; 3]) -> Boundary {
    match face {
        WindBoundary::Wrap => Boundary::Wrap,
        WindBoundary::FreeSlip => Boundary::FreeSlip,
        WindBoundary::Reflect => Boundary::Reflect,
        WindBoundary::NoSlip => Boundary::NoSlip,
        WindBoundary::Lid => Boundary::Lid { velocity_m_per_s: lid_m_per_s },
        WindBoundary::Inflow => Boundary::Inflow,
        WindBoundary::Outflow => Boundary::Outflow,
    }
}

fn advection(word: WindAdvection) -> Advection {
    match word {
        WindAdvection::SemiLagrangian => Advection::SemiLagrangian,
        WindAdvection::MacCormack => Advection::MacCormack,
        WindAdvection::Bfecc => Advection::Bfecc,
        WindAdvection::Conservative => Advection::Conservative,
    }
}

fn pressure(wind: &Wind) -> Pressure {
    let effort = Effort { tolerance: wind.pressure_tolerance.into(), sweeps: wind.pressure_sweeps };
    let iteration = match wind.pressure {
        WindPressure::Direct => return Pressure::Direct,
        WindPressure::Jacobi => Iteration::Jacobi,
        WindPressure::GaussSeidel => Iteration::GaussSeidel,
        WindPressure::Sor => Iteration::Sor,
        WindPressure::ConjugateGradients => Iteration::ConjugateGradients,
        WindPressure::Multigrid => Iteration::Multigrid,
    };
    Pressure::Iterative(iteration, effort)
}

fn primitive(scene: &shared::scene::Primitive) -> Primitive {
    let (east, north) = scene.heading_rad.sin_cos();
    Primitive {
        shape: match scene.kind {
            PrimitiveKind::Uniform => Shape::Uniform,
            PrimitiveKind::Source => Shape::Source,
            PrimitiveKind::Sink => Shape::Sink,
            PrimitiveKind::Vortex => Shape::Vortex,
            PrimitiveKind::Cyclone => Shape::Cyclone,
        },
        position_m: scene.at_m,
        drift_m_per_s: scene.drift_m_per_s,
        radius_m: scene.radius_m,
        speed_m_per_s: scene.speed_m_per_s,
        direction: [east, -north],
        dust: scene.dust,
    }
}
