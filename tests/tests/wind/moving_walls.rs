//! Friction has its order next to walls that move, at constant or at changing speed.

use prairie_charts::orders;
use prairie_charts::tables::assert_published;

#[test]
fn friction_has_its_order_under_a_lid_that_starts() {
    assert_published(&orders::couette_start());
}

#[test]
fn friction_has_its_order_over_a_wall_that_oscillates() {
    assert_published(&orders::oscillating_wall());
}
