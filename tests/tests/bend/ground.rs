//! Contact of bent grass with the ground.

use std::f32::consts::FRAC_PI_2;

use prairie_charts::problems::bend::{Energy, alike, cells, start};
use prairie_core::bend::{Edges, Field, GroundContact, Kinds, Scheme, Serial};
use prairie_core::grid::PatchLayout;

use crate::limits::random;

const COURANT: f32 = 0.4;

/// Undamped noise of up to 1.5 rad in all channels.
fn noise(ground_contact: GroundContact) -> Field {
    let layout = PatchLayout { count: [2, 2], cells: 16, cell_m: 1.0 };
    let mut field = Field::new(layout, Kinds::one(alike(1.0, 0.0, 0.0))).with_ground_contact(ground_contact);
    start(&mut field, COURANT.into(), |[i, j]| [1.5 * (f64::from(random(i, j)) / 2.0f64.powi(23) - 1.0); 2]);
    field
}

fn largest_rad(field: &Field) -> f32 {
    cells(field).map(|(_, [now, _])| now.theta.abs()).fold(0.0, f32::max)
}

#[test]
fn the_ground_stops_a_bend_and_takes_energy() {
    let energy = Energy { courant: COURANT.into(), restoring: 0.0, edges: Edges::Rest };
    let run = |ground_contact| {
        let mut field = noise(ground_contact);
        let first = energy.of(&field, Scheme::Substepped)[0];
        let (mut last, mut growth, mut largest) = (first, 0.0f64, 0.0f32);
        for _ in 0..2000 {
            field.step(Scheme::Substepped, COURANT, &Serial).unwrap();
            let now = energy.of(&field, Scheme::Substepped)[0];
            (growth, last, largest) = (growth.max(now / last - 1.0), now, largest.max(largest_rad(&field)));
        }
        (last / first, growth, largest)
    };
    let (left, growth, largest) = run(GroundContact::Inelastic);
    println!("with contact: {left:.4} of the energy left, up to {growth:.1e} more after a step, θ up to {largest} rad");
    assert!(
        largest <= FRAC_PI_2 && left < 0.99 && growth < 1e-4,
        "{left} of the energy left, {growth} more after a step, θ up to {largest}"
    );
    let (left, _, largest) = run(GroundContact::None);
    println!("without: {left:.6} of the energy left, θ up to {largest} rad");
    assert!((left - 1.0).abs() < 1e-4 && largest > 1.2 * FRAC_PI_2, "{left} of the energy left, θ up to {largest}");
}

#[test]
fn every_scheme_stops_at_the_ground() {
    for &scheme in Scheme::ALL {
        let largest = GroundContact::ALL.iter().map(|&ground_contact| {
            let mut field = noise(ground_contact);
            (0..200).for_each(|_| {
                field.step(scheme, COURANT, &Serial).unwrap();
            });
            field.awake().map(|patch| patch.theta_max_rad()).fold(0.0, f32::max)
        });
        let largest: Vec<_> = largest.collect();
        println!("{scheme:?}: {largest:?} rad at the end");
        assert!(largest[0] <= FRAC_PI_2, "{scheme:?}: {largest:?}");
    }
}

/// The ground hides no values that are NaN.
#[test]
fn a_patch_that_holds_nan_is_put_to_rest() {
    let mut field = noise(GroundContact::Inelastic);
    let nan = prairie_core::bend::Bend { theta: f32::NAN, omega: [0.0; 2] };
    field.press([3, 4], nan);
    let reset = |field: &mut Field| field.step(Scheme::Substepped, COURANT, &Serial).unwrap().reset_patches;
    assert_eq!(reset(&mut field), 1);
}
