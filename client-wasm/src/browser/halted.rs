//! Whether the client has stopped for good.

use std::cell::Cell;

thread_local! {
    static HALTED: Cell<bool> = const { Cell::new(false) };
}

/// Whether the client has stopped for good.
pub(super) fn is_halted() -> bool {
    HALTED.get()
}

/// Makes every callback and every function of the page return at once.
pub(super) fn set_halted() {
    HALTED.set(true);
}
