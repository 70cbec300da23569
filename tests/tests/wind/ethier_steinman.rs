//! On the decaying flow of Ethier & Steinman, through all six faces of a box, schemes have their formal order in three dimensions.

use tests::orders::{self, assert_formal};

#[test]
fn schemes_have_their_order_with_prescribed_velocity_on_every_face() {
    assert_formal(&orders::beltrami());
}
