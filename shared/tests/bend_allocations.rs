//! No step of the bend field allocates memory while the same patches are awake, save for lists that the first steps still enlarge.

use prairie_core::bend::{Bend, Edges, Field, GroundContact, Kinds, Rest, Scheme, Seams, Serial, WaveParams};
use prairie_core::grid::PatchLayout;

const LAYOUT: PatchLayout = PatchLayout { count: [4, 3], cells: 32, cell_m: 0.25 };
const DT_SECS: f32 = 1.0 / 60.0;
/// Steps before the count starts.
const WARM_UP_STEPS: usize = 200;
const STEPS: usize = 50;

/// Grass whose wave speed grows with the bend, so that a step has several sub-steps.
const WAVES: WaveParams = WaveParams {
    c0_m_per_s: 2.0,
    mu_m_per_rad: 1.2,
    c_omega_m_per_s: 2.0,
    theta_damping_per_s: 3.0,
    omega_damping_per_s: 3.0,
    stiffness_per_s2: 4.0,
};

/// Allocations by steps of a field that is struck in each of them.
fn allocations(scheme: Scheme, edges: Edges, seams: Seams, rest: Rest) -> u64 {
    let mut field = Field::new(LAYOUT, Kinds::one(WAVES))
        .with_edges(edges)
        .with_seams(seams)
        .with_rest(rest)
        .with_ground_contact(GroundContact::Inelastic);
    field.wake_all();
    // The published scheme is unstable in fast grass.
    let omega = if scheme == Scheme::Verlet { [2.0, 0.5] } else { [20.0, 5.0] };
    let mut step = |n: usize| {
        field.press([8 + n as i64 % 50, 30], Bend { theta: 0.8, omega });
        field.step(scheme, DT_SECS, &Serial).expect("the step is possible").substeps
    };
    (0..WARM_UP_STEPS).for_each(|n| {
        step(n);
    });
    let mut substeps = 0;
    let count = allocation_counter::measure(|| (0..STEPS).for_each(|n| substeps = step(n).max(substeps))).count_total;
    assert!(scheme != Scheme::Substepped || substeps > 4, "a step in {substeps} sub-steps has more than one exchange");
    count
}

#[test]
fn no_step_allocates() {
    let rests = [Rest::EXACT, Rest { theta_rad: 1e-3, omega_rad_per_s: 1e-2 }];
    for scheme in [Scheme::Verlet, Scheme::Substepped] {
        for edges in [Edges::Rest, Edges::Free, Edges::Wrapped] {
            for seams in [Seams::Exact, Seams::Overlap] {
                for rest in rests {
                    assert_eq!(allocations(scheme, edges, seams, rest), 0, "{scheme:?} {edges:?} {seams:?} {rest:?}");
                }
            }
        }
    }
}

#[test]
fn allocations_are_counted() {
    // A copy of a field allocates its planes.
    let mut field = Field::new(LAYOUT, Kinds::one(WAVES));
    field.wake_all();
    assert!(allocation_counter::measure(|| drop(field.clone())).count_total >= 12 * 6);
}
