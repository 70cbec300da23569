//! On the decaying flow of Ethier & Steinman, through all six faces of a box, schemes have their formal order in three dimensions.

use tests::chart::tables::assert_published;
use tests::orders;

#[test]
fn schemes_have_their_order_with_prescribed_velocity_on_every_face() {
    assert_published(&orders::beltrami());
}
