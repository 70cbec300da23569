//! Solver settings from a scene's wind settings.

use prairie_core::scene::{
    PrimitiveIntensity, PrimitiveKind, Scene, Wind, WindAdvection, WindBoundary, WindDiffusion, WindMethod, WindPressure, WindTime,
};
use prairie_wind::intensity::{Pulse, Spline};
use prairie_wind::pressure::{Effort, IterativeMethod};
use prairie_wind::{
    Advection, Boundary, Canopy, CanopyMotion, Config, Diffusion, Dust, Front, Gusts, Intensity, Method, Pressure, Primitive, Profile,
    Shape, TimeScheme,
};

/// Roughness length of grass (m), for the logarithmic profile.
pub(super) const ROUGHNESS_M: f32 = 0.05;

/// The solver's method and settings for `scene`.
pub(super) fn settings(scene: &Scene) -> (Method, Config) {
    let wind = &scene.wind;
    let config = Config {
        cells: wind.cells.map(|n| n as usize),
        spacing_m: wind.spacing_m,
        boundary: wind.faces.pairs().map(|pair| pair.map(|face| boundary(face, wind.faces.lid_m_per_s))),
        advection: advection(wind.advection),
        time: time_scheme(wind.time),
        diffusion: match wind.diffusion {
            WindDiffusion::Explicit => Diffusion::Explicit,
            WindDiffusion::GaussSeidel => Diffusion::GaussSeidel { sweeps: wind.diffusion_sweeps },
            WindDiffusion::Implicit => Diffusion::Implicit,
            WindDiffusion::CrankNicolson => Diffusion::CrankNicolson,
        },
        pressure: pressure(wind),
        viscosity_m2_per_s: wind.viscosity_m2_per_s,
        mean_wind_m_per_s: [wind.mean_m_per_s[0], 0.0, wind.mean_m_per_s[1]],
        profile: Profile::Log { roughness_m: ROUGHNESS_M, reference_m: wind.reference_m() },
        relaxation_per_s: wind.mean_rate_per_s,
        body_force_m_per_s2: [wind.body_force_m_per_s2[0], 0.0, wind.body_force_m_per_s2[1]],
        gusts: Gusts {
            number: wind.sources as usize,
            strength_m_per_s: wind.source_m_per_s,
            radius_m: wind.gust_radius_m(),
            ..Gusts::default()
        },
        primitives: wind.primitives.iter().map(primitive).collect(),
        canopy: (wind.canopy_drag_per_m > 0.0).then_some(Canopy {
            height_m: scene.tallest_m(),
            drag_per_m: wind.canopy_drag_per_m,
            motion: (wind.canopy_frequency_hz > 0.0).then_some(CanopyMotion {
                frequency_hz: wind.canopy_frequency_hz,
                damping_ratio: wind.canopy_damping_ratio,
                mass_kg_per_m2: wind.canopy_mass_kg_per_m2,
            }),
        }),
        dust: wind.has_dust().then_some(Dust {
            advection: advection(wind.dust.advection),
            diffusivity_m2_per_s: wind.dust.diffusivity_m2_per_s,
            release_per_s: wind.dust.release_per_s,
            settling_per_s: wind.dust.settling_per_s,
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

/// The solver's boundary condition of the same name.
fn boundary(face: WindBoundary, lid_m_per_s: [f32; 3]) -> Boundary {
    Boundary::from_name(face.word(), lid_m_per_s).expect("the solver has every boundary condition of a scene")
}

/// The solver's advection scheme of the same name.
fn advection(scheme: WindAdvection) -> Advection {
    Advection::from_name(scheme.word()).expect("the solver has every advection scheme of a scene")
}

/// The solver's time scheme of the same name.
fn time_scheme(scheme: WindTime) -> TimeScheme {
    TimeScheme::from_name(scheme.word()).expect("the solver has every time scheme of a scene")
}

fn pressure(wind: &Wind) -> Pressure {
    let effort = Effort { tolerance: wind.pressure_tolerance.into(), sweeps: wind.pressure_sweeps };
    let iteration = match wind.pressure {
        WindPressure::Direct => return Pressure::Direct,
        WindPressure::Jacobi => IterativeMethod::Jacobi,
        WindPressure::GaussSeidel => IterativeMethod::GaussSeidel,
        WindPressure::Sor => IterativeMethod::Sor,
        WindPressure::ConjugateGradients => IterativeMethod::ConjugateGradients,
        WindPressure::Multigrid => IterativeMethod::Multigrid,
    };
    Pressure::Iterative(iteration, effort)
}

fn primitive(scene: &prairie_core::scene::Primitive) -> Primitive {
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
        intensity: intensity(scene),
        front: Front { speed_m_per_s: scene.front_m_per_s, step_m: scene.step_m },
    }
}

fn intensity(scene: &prairie_core::scene::Primitive) -> Intensity {
    let &prairie_core::scene::Primitive { attack_secs, hold_secs, fall_secs, period_secs, .. } = scene;
    let pulse = Pulse { attack_secs, hold_secs, fall_secs, period_secs };
    match scene.intensity {
        PrimitiveIntensity::Steady => Intensity::Steady,
        PrimitiveIntensity::Gust => Intensity::Gust(pulse),
        PrimitiveIntensity::Periodic => Intensity::Periodic { period_secs },
        PrimitiveIntensity::Cubic => Intensity::Cubic(pulse),
        PrimitiveIntensity::Spline => Intensity::Spline(Spline::new(period_secs, scene.intensity_points.clone())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(words: &[&str]) -> Vec<String> {
        let mut words: Vec<_> = words.iter().map(|word| (*word).to_owned()).collect();
        words.sort();
        words
    }

    #[test]
    fn scenes_and_solver_have_the_same_names() {
        let names = |names: Vec<&str>| words(&names);
        assert_eq!(words(WindAdvection::WORDS), names(Advection::ALL.iter().map(|scheme| scheme.name()).collect()));
        assert_eq!(words(WindTime::WORDS), names(TimeScheme::ALL.iter().map(|scheme| scheme.name()).collect()));
        assert_eq!(words(WindBoundary::WORDS), names(Boundary::all([0.0; 3]).map(Boundary::name).to_vec()));
        for &face in WindBoundary::ALL {
            assert_eq!(face.blocks_flow(), boundary(face, [0.0; 3]).blocks_flow(), "{face:?}");
        }
    }

    #[test]
    fn scenes_and_solver_allow_the_same_combinations_of_schemes() {
        for (&scheme, &time) in WindAdvection::ALL.iter().flat_map(|scheme| WindTime::ALL.iter().map(move |time| (scheme, time))) {
            assert_eq!(time.allows(scheme), time_scheme(time).allows(advection(scheme)), "{scheme:?} {time:?}");
        }
    }
}
