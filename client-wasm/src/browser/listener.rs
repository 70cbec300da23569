//! An event listener that is removed when it is dropped.

use super::halted::is_halted;
use wasm_bindgen::prelude::*;
use web_sys::{Event, EventTarget};

/// A registered event listener.
pub(super) struct Listener {
    target: EventTarget,
    kind: &'static str,
    closure: Closure<dyn FnMut(Event)>,
}

impl Listener {
    /// Calls `handle` with each event of this kind, such as `keydown`, until the client is halted.
    pub(super) fn new<E: JsCast>(target: &EventTarget, kind: &'static str, mut handle: impl FnMut(&E) + 'static) -> Self {
        let closure = Closure::<dyn FnMut(Event)>::new(move |event: Event| {
            if !is_halted() {
                handle(event.unchecked_ref());
            }
        });
        // Fails only if the name or the function is null.
        let _ = target.add_event_listener_with_callback(kind, closure.as_ref().unchecked_ref());
        Self { target: target.clone(), kind, closure }
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        let _ = self.target.remove_event_listener_with_callback(self.kind, self.closure.as_ref().unchecked_ref());
    }
}
