//! All input of the page: keyboard, pointers, gamepad and the page's buttons, collected between two ticks.

use super::gamepad::Gamepad;
use super::listener::Listener;
use super::pointer::Pointers;
use crate::bindings::{Action, HELD_KEYS, key_action};
use crate::controls::Controls;
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::rc::Rc;
use wasm_bindgen::prelude::*;
use web_sys::{Element, Event, HtmlCanvasElement, KeyboardEvent, Window};

/// Maximum number of pending actions; further ones are dropped.
const ACTION_LIMIT: usize = 16;

/// Input of a page.
pub(super) struct Input {
    keys: Rc<RefCell<Keys>>,
    pointers: Pointers,
    gamepad: Gamepad,
    buttons: Controls,
    /// Time at which an input was noticed that is not sent yet (s).
    noticed_secs: Option<f64>,
    _listeners: [Listener; 3],
}

#[derive(Default)]
struct Keys {
    /// Codes of the keys held.
    down: BTreeSet<String>,
    /// Time of the first change of `down` that is not sent yet (s).
    changed_secs: Option<f64>,
    actions: Vec<Action>,
}

impl Input {
    /// Listens to the keys of the window and the pointers of the canvas.
    pub(super) fn new(window: &Window, canvas: &HtmlCanvasElement) -> Self {
        let keys = Rc::new(RefCell::new(Keys::default()));
        let (pressed, released, blurred) = (keys.clone(), keys.clone(), keys.clone());
        let listeners = [
            Listener::new(window, "keydown", move |event: &KeyboardEvent| pressed.borrow_mut().press(event)),
            Listener::new(window, "keyup", move |event: &KeyboardEvent| {
                released.borrow_mut().release(event);
            }),
            Listener::new(window, "blur", move |_: &Event| blurred.borrow_mut().down.clear()),
        ];
        Self {
            keys,
            pointers: Pointers::new(canvas),
            gamepad: Gamepad::default(),
            buttons: Controls::default(),
            noticed_secs: None,
            _listeners: listeners,
        }
    }

    /// Combined controls of all devices.
    pub(super) fn controls(&self) -> Controls {
        self.keys.borrow().controls().with(self.pointers.stick()).with(self.gamepad.controls()).with(self.buttons)
    }

    /// Sets the state of the page's up (+) and down (−) buttons.
    pub(super) fn hold_rise(&mut self, rise: f32) {
        self.buttons.rise = rise.clamp(-1.0, 1.0);
    }

    /// Time of the event behind the present controls (s): that of the key, or else when they were noticed, which is `now_secs` the first time.
    pub(super) fn event_secs(&mut self, now_secs: f64) -> f64 {
        let noticed_secs = *self.noticed_secs.get_or_insert(now_secs);
        self.keys.borrow().changed_secs.unwrap_or(noticed_secs)
    }

    /// Forgets the event: its controls are sent, or those of before again.
    pub(super) fn forget_event(&mut self) {
        (self.noticed_secs, self.keys.borrow_mut().changed_secs) = (None, None);
    }

    /// Polls the gamepad, which sends no events.
    pub(super) fn poll(&mut self) {
        let action = self.gamepad.poll();
        self.keys.borrow_mut().actions.extend(action);
    }

    /// Turn of the view since the last call (rad, right and up); the gamepad's stick counts for `dt_secs`.
    pub(super) fn take_look(&mut self, dt_secs: f32) -> [f32; 2] {
        let [right, up] = self.pointers.take_look();
        let [stick_right, stick_up] = self.gamepad.look_rad_per_s();
        [right + stick_right * dt_secs, up + stick_up * dt_secs]
    }

    /// Notches of the wheel since the last call, positive to zoom out.
    pub(super) fn take_zoom(&mut self) -> f32 {
        self.pointers.take_zoom()
    }

    /// Actions since the last call.
    pub(super) fn take_actions(&mut self) -> Vec<Action> {
        std::mem::take(&mut self.keys.borrow_mut().actions)
    }
}

impl Keys {
    fn press(&mut self, event: &KeyboardEvent) {
        if event.ctrl_key() || event.meta_key() || event.alt_key() || is_for_page_element(event) {
            return;
        }
        let code = event.code();
        if HELD_KEYS.iter().any(|(known, _)| *known == code) {
            event.prevent_default();
            if self.down.insert(code) {
                self.note(event);
            }
        }
        if !event.repeat() && self.actions.len() < ACTION_LIMIT {
            self.actions.extend(key_action(&event.key(), &event.code()));
        }
    }

    fn release(&mut self, event: &KeyboardEvent) {
        if self.down.remove(&event.code()) {
            self.note(event);
        }
    }

    /// Notes the time of an event that changes the controls.
    fn note(&mut self, event: &KeyboardEvent) {
        self.changed_secs.get_or_insert(event.time_stamp() / 1e3);
    }

    fn controls(&self) -> Controls {
        let held = HELD_KEYS.iter().filter(|(code, _)| self.down.contains(*code));
        held.fold(Controls::default(), |sum, (_, controls)| sum.with(*controls))
    }
}

/// Whether the focus is on an element of the page that handles this key itself.
fn is_for_page_element(event: &KeyboardEvent) -> bool {
    let elements = if matches!(event.code().as_str(), "Space" | "Escape") {
        "input, select, textarea, dialog, [role=slider], button, summary"
    } else {
        "input, select, textarea, dialog, [role=slider]"
    };
    let element = event.target().and_then(|target| target.dyn_into::<Element>().ok());
    element.is_some_and(|element| element.closest(elements).is_ok_and(|found| found.is_some()))
}
