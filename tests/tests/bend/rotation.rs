//! Quarter turns of the world rotate the field with it.

use std::f32::consts::TAU;

use prairie_charts::problems::bend::{Striker, Threads, channels, size};
use prairie_core::bend::{Bend, Edges, Field, Kinds, Rest, Scheme, WaveParams};
use prairie_core::grid::PatchLayout;

const DT_SECS: f32 = 1.0 / 60.0;
const STEPS: u32 = 120;
/// Radius of the circle (m): that of the corners around the middle one of 4 × 4 patches, over which the cars pass.
const CIRCLE_M: f32 = 16.0 * 0.4572 * std::f32::consts::SQRT_2;
const SPEED_M_PER_S: f32 = 15.0;
/// Number of cars; with five, no quarter turn maps the circle onto itself.
const CARS: u32 = 5;

/// Cars on a circle about the centre of the world at the end of a step, rotated with the world by quarter turns.
fn cars(step: u32, quarters: usize) -> impl Iterator<Item = Striker> {
    (0..CARS).map(move |car| {
        let angle = (step + 1) as f32 * DT_SECS * SPEED_M_PER_S / CIRCLE_M + car as f32 * TAU / CARS as f32;
        let (sin, cos) = angle.sin_cos();
        let here = Striker {
            at_m: [CIRCLE_M * cos, CIRCLE_M * sin],
            velocity_m_per_s: [-SPEED_M_PER_S * sin, SPEED_M_PER_S * cos],
            radius_m: 0.8,
            strike_height_m: 0.4,
        };
        here.turned(quarters)
    })
}

fn circle(scheme: Scheme, edges: Edges, rest: Rest, quarters: usize) -> Field {
    let grass = WaveParams {
        c0_m_per_s: 3.0,
        mu_m_per_rad: if scheme == Scheme::Substepped { 0.3 } else { 0.0 },
        c_omega_m_per_s: 4.0,
        theta_damping_per_s: 2.0,
        omega_damping_per_s: 5.0,
        stiffness_per_s2: 1.2,
    };
    let mut field =
        Field::new(PatchLayout { count: [4, 4], cells: 16, cell_m: 0.4572 }, Kinds::one(grass)).with_edges(edges).with_rest(rest);
    if matches!(scheme, Scheme::Implicit | Scheme::Modal) {
        field.wake_all();
    }
    for step in 0..STEPS {
        cars(step, quarters).for_each(|car| car.press(&mut field, DT_SECS));
        field.step(scheme, DT_SECS, &Threads(2)).unwrap();
    }
    field
}

/// The state of every cell, rotated back by quarter turns, row by row.
fn turned_back(field: &Field, quarters: usize) -> Vec<Bend> {
    let side = size(field)[0] as i64;
    let cells = (0..side * side).map(|n| [n % side, n / side]);
    let state = |cell: [i64; 2]| {
        // A quarter turn takes (x, z) to (−z, x).
        let there = (0..quarters).fold(cell, |[i, j], _| [side - 1 - j, i]);
        let Bend { theta, omega } = field.cell(there);
        Bend { theta, omega: (0..quarters).fold(omega, |[x, z], _| [z, -x]) }
    };
    cells.map(state).collect()
}

/// Sums are over opposite pairs in any orientation.
#[test]
fn the_explicit_field_rotates_bit_for_bit() {
    for scheme in [Scheme::Verlet, Scheme::Substepped] {
        for edges in [Edges::Rest, Edges::Free, Edges::Wrapped] {
            for rest in [Rest::EXACT, Rest { theta_rad: 0.01, omega_rad_per_s: 0.2 }] {
                let straight = turned_back(&circle(scheme, edges, rest, 0), 0);
                let bent = straight.iter().filter(|bend| bend.theta.abs() > 0.1).count();
                assert!(bent > 300, "{bent} cells are bent");
                for quarters in 1..4 {
                    let turned = turned_back(&circle(scheme, edges, rest, quarters), quarters);
                    let differ = straight.iter().zip(&turned).position(|(a, b)| channels(*a) != channels(*b));
                    let show = differ.map(|n| (n % 64, n / 64, straight[n], turned[n]));
                    assert_eq!(show, None, "{scheme:?}, {edges:?}, {rest:?}, {} degrees", quarters * 90);
                }
            }
        }
    }
}

/// These schemes sum along lines from one end to the other.
#[test]
fn the_implicit_and_modal_fields_rotate_within_rounding() {
    for scheme in [Scheme::Implicit, Scheme::Modal] {
        let straight = turned_back(&circle(scheme, Edges::Free, Rest::EXACT, 0), 0);
        for quarters in 1..4 {
            let turned = turned_back(&circle(scheme, Edges::Free, Rest::EXACT, quarters), quarters);
            let apart = straight.iter().zip(&turned).map(|(a, b)| (a.theta - b.theta).abs()).fold(0.0, f32::max);
            println!("{scheme:?}, {} degrees: {apart:.1e} rad apart", quarters * 90);
            assert!(apart < 1e-4, "{scheme:?}, {} degrees: {apart}", quarters * 90);
        }
    }
}
