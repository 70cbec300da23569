//! On the decaying Taylor–Green vortex, drifting through a periodic box, every scheme has its formal order.

use prairie_charts::orders;
use prairie_charts::tables::assert_published;
use prairie_wind::Advection;

#[test]
fn semi_lagrangian_advection_has_its_order_with_every_time_scheme() {
    assert_published(&orders::times_of(Advection::SemiLagrangian));
}

#[test]
fn mac_cormack_advection_has_its_order_with_every_time_scheme() {
    assert_published(&orders::times_of(Advection::MacCormack));
}

#[test]
fn bfecc_advection_has_its_order_with_every_time_scheme() {
    assert_published(&orders::times_of(Advection::Bfecc));
}

#[test]
fn conservative_advection_has_its_order_with_every_time_scheme() {
    assert_published(&orders::times_of(Advection::Conservative));
}

#[test]
fn conservative_advection_is_second_order_in_space() {
    assert_published(&orders::space());
}

#[test]
fn time_schemes_and_diffusion_have_their_order_in_time() {
    assert_published(&orders::time());
}
