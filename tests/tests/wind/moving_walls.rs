//! Friction has its order next to walls that move, at constant or at changing speed.

use tests::chart::tables::assert_published;
use tests::orders;

#[test]
fn friction_has_its_order_under_a_lid_that_starts() {
    assert_published(&orders::couette_start());
}

#[test]
fn friction_has_its_order_over_a_wall_that_oscillates() {
    assert_published(&orders::oscillating_wall());
}
