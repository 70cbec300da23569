//! Shutdown of a failed client, after a panic or an error that the page caught.

use super::halted::set_halted;
use super::{page, socket};

/// Makes a panic stop the client and show a message in the page, besides the line in the console.
pub(super) fn set_panic_hook() {
    std::panic::set_hook(Box::new(|info| {
        console_error_panic_hook::hook(info);
        halt();
        page::panicked(&info.to_string());
    }));
}

/// Stops the client for good: from now on it draws, receives and sends nothing, and its functions return empty values. Works
/// even after a panic, which leaves the client locked.
pub(super) fn halt() {
    set_halted();
    socket::close();
}
