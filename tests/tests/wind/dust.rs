//! Dust under each scheme: a rotating hill, Zalesak's slotted disc, and a diffusing spot.

use prairie_charts::norms::Norms;
use prairie_charts::orders;
use prairie_charts::problems::{Rotation, SlottedDisc};
use prairie_charts::tables::assert_published;
use prairie_charts::turntable::turntable;
use prairie_wind::{Advection, Solver};

#[test]
fn each_advection_scheme_has_its_order_on_a_rotating_hill() {
    assert_published(&orders::rotating_gaussian());
}

#[test]
fn each_diffusion_is_second_order_in_space() {
    assert_published(&orders::heat_space());
}

#[test]
fn each_diffusion_has_its_order_in_time() {
    assert_published(&orders::heat_time());
}

/// Result of one revolution of the disc in 628 steps.
struct Turned {
    /// Mean error relative to that of an empty field.
    error: f64,
    least: f32,
    most: f32,
    /// Relative change of the amount of dust.
    gain: f64,
}

fn turn(advection: Advection) -> Turned {
    let rotation = Rotation { side_m: 100.0, period_secs: 628.0 };
    let disc = |position: [f32; 3]| SlottedDisc(rotation).mean_density(position.map(f64::from), [1.0; 2], 8, 0.0);
    let mut air = turntable::<f32>(rotation, advection, 100);
    air.set_dust(|position| disc(position) as f32);
    let amount = |air: &Solver<f32>| air.dust_samples().map(|(_, density)| f64::from(density)).sum::<f64>();
    let before = amount(&air);
    (0..628).for_each(|_| assert!(air.step_dust(1.0).is_ok()));
    let error = Norms::of(air.dust_samples().map(|(position, density)| (f64::from(density), disc(position)))).l1;
    let (least, most) = air.dust_samples().fold((1.0f32, 0.0f32), |(least, most), (_, density)| (least.min(density), most.max(density)));
    Turned { error: error * 1.0e4 / before, least, most, gain: amount(&air) / before - 1.0 }
}

#[test]
fn zalesaks_disc_stays_bounded_and_conservative_transport_conserves_it() {
    let linear = turn(Advection::SemiLagrangian);
    for &advection in Advection::ALL {
        let Turned { error, least, most, gain } = turn(advection);
        println!("{advection:?}: error {error:.3}, from {least:.1e} to 1 − {:.1e}, dust gained {gain:.1e}", 1.0 - most);
        assert!(least >= -1e-6 && most <= 1.0 + 1e-6, "{advection:?}: {least:e} to {most}");
        assert!(!advection.uses_fluxes() || gain.abs() < 2e-7, "{advection:?}: {gain:e}");
        assert!(advection.order() < 2 || error < 0.75 * linear.error, "{advection:?} smears the disc: {error}");
    }
}
