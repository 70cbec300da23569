//! What each scheme makes of dust: a smooth hill and Zalesak's slotted disc that turn, and a spot that spreads.

use server::wind::{Advection, Solver};
use tests::norms::Norms;
use tests::orders::{self, assert_formal};
use tests::problems::{Rotation, SlottedDisc};
use tests::turntable::turntable;

#[test]
fn a_turning_hill_is_carried_at_the_order_of_each_scheme() {
    assert_formal(&orders::rotating_gaussian());
}

#[test]
fn each_diffusion_is_second_order_in_space() {
    assert_formal(&orders::heat_space());
}

#[test]
fn each_diffusion_has_its_order_in_time() {
    assert_formal(&orders::heat_time());
}

/// One turn of the disc in 628 steps.
struct Turned {
    /// Mean error over that of a disc that is gone.
    error: f64,
    least: f32,
    most: f32,
    /// Change of the amount of dust, as a share of it.
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
fn zalesaks_disc_stays_within_its_bounds_and_conservative_transport_keeps_all_of_it() {
    let [linear, others @ ..] =
        [Advection::SemiLagrangian, Advection::MacCormack, Advection::Bfecc, Advection::Conservative].map(|advection| {
            let turned = turn(advection);
            let Turned { error, least, most, gain } = turned;
            println!("{advection:?}: error {error:.3}, from {least:.1e} to 1 − {:.1e}, dust gained {gain:.1e}", 1.0 - most);
            assert!(least >= -1e-6 && most <= 1.0 + 1e-6, "{advection:?}: {least:e} to {most}");
            assert!(advection != Advection::Conservative || gain.abs() < 2e-7, "{advection:?}: {gain:e}");
            turned
        });
    assert!(
        others.iter().all(|other| other.error < 0.75 * linear.error),
        "schemes of second order keep the disc, that of first order smears it"
    );
}
