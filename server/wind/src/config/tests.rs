use super::*;
use crate::pressure::{Effort, IterativeMethod};

#[test]
fn the_default_is_allowed() {
    assert_eq!(Config::default().validate(), Ok(()));
}

#[test]
fn each_bad_setting_is_named() {
    type Spoil = fn(&mut Config);
    let cases: [(&str, Spoil); 24] = [
        ("cells[1]", |c| c.cells[1] = 0),
        ("cells", |c| c.cells = [512; 3]),
        ("spacing_m[2]", |c| c.spacing_m[2] = f32::NAN),
        ("viscosity_m2_per_s", |c| c.viscosity_m2_per_s = -1.0),
        ("relaxation_per_s", |c| c.relaxation_per_s = f32::INFINITY),
        ("mean_wind_m_per_s[0]", |c| c.boundary[0] = [Boundary::FreeSlip; 2]),
        ("boundary[2]", |c| c.boundary[2] = [Boundary::Wrap, Boundary::NoSlip]),
        ("boundary[1]", |c| c.boundary[1][1] = Boundary::Lid { velocity_m_per_s: [0.0, 1.0, 0.0] }),
        ("damping", |c| c.damping = 1.5),
        ("time", |c| c.time = TimeScheme::Reflection),
        ("time", |c| c.advection = Advection::Bfecc),
        ("diffusion", |c| c.diffusion = Diffusion::GaussSeidel { sweeps: 0 }),
        ("pressure", |c| c.pressure = Pressure::Iterative(IterativeMethod::Sor, Effort { tolerance: 0.0, sweeps: 9 })),
        ("body_force_m_per_s2[1]", |c| c.body_force_m_per_s2[1] = f32::NAN),
        ("canopy.height_m", |c| c.canopy = Some(Canopy { height_m: 0.0, ..Canopy::default() })),
        ("mean_wind_m_per_s[2]", |c| c.mean_wind_m_per_s[2] = f32::NAN),
        ("profile", |c| c.boundary[1] = [Boundary::Wrap; 2]),
        ("profile.roughness_m", |c| c.profile = Profile::Log { roughness_m: 0.0, reference_m: 10.0 }),
        ("profile.exponent", |c| c.profile = Profile::Power { exponent: 2.0, reference_m: 10.0 }),
        ("gusts.number", |c| c.gusts.number = 5000),
        ("gusts.life_secs", |c| c.gusts.life_secs = 0.0),
        ("gusts.attack", |c| c.gusts.attack = 1.0),
        ("gusts.radius_m[1]", |c| c.gusts.radius_m[1] = -2.0),
        ("dust.settling_per_s", |c| c.dust = Some(Dust { settling_per_s: -0.1, ..Dust::default() })),
    ];
    for (field, spoil) in cases {
        let mut config = Config::default();
        spoil(&mut config);
        let error = config.validate().expect_err(field);
        assert_eq!(error.field, field);
        assert!(error.to_string().contains("allowed"), "{error}");
    }
}
