//! On the decaying Taylor–Green vortex, drifting through a periodic box, every scheme has its formal order.

use tests::chart::tables::assert_published;
use tests::orders;

#[test]
fn every_advection_with_every_time_scheme_has_its_order() {
    assert_published(&orders::advection_and_time());
}

#[test]
fn conservative_advection_is_second_order_in_space() {
    assert_published(&orders::space());
}

#[test]
fn time_schemes_and_diffusion_have_their_order_in_time() {
    assert_published(&orders::time());
}
