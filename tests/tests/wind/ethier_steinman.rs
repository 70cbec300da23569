//! On the decaying flow of Ethier & Steinman, through all six faces of a box, methods have their order in three dimensions.

use prairie_charts::orders;
use prairie_charts::tables::assert_published;

#[test]
#[ignore = "minutes; cargo nextest run --release --workspace --run-ignored only -E 'test(methods_have_their_order_with_prescribed)'"]
fn methods_have_their_order_with_prescribed_velocity_on_every_face() {
    assert_published(&orders::beltrami());
}

#[test]
fn the_default_has_its_order_on_coarse_grids() {
    orders::assert_expected(&orders::coarse_beltrami());
}
