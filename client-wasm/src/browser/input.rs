//! What the visitor's hands do: keyboard, mouse, thumbs and gamepad, gathered between two looks at them.

use super::gamepad::Gamepad;
use super::listener::Listener;
use super::pointer::Pointers;
use crate::controls::Controls;
use shared::scene::VehicleKind;
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::rc::Rc;
use wasm_bindgen::prelude::*;
use web_sys::{Element, Event, HtmlCanvasElement, KeyboardEvent, Window};

/// What a single press asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Wish {
    /// A vehicle, or none.
    Take(Option<VehicleKind>),
    /// The eye at a height (m).
    Height(f32),
}

/// Heights of the eye on the keys 1 to 4 (m); 000 figure 23.
const HEIGHTS_M: [(&str, f32); 4] = [("Digit1", 1.0), ("Digit2", 5.0), ("Digit3", 10.0), ("Digit4", 20.0)];

/// Presses that wait to be granted; more are not kept.
const WISHES: usize = 16;

/// All input of a page.
pub(super) struct Input {
    keys: Rc<RefCell<Keys>>,
    pointers: Pointers,
    gamepad: Gamepad,
    held: Controls,
    _listeners: [Listener; 3],
}

#[derive(Default)]
struct Keys {
    down: BTreeSet<String>,
    wishes: Vec<Wish>,
}

impl Input {
    /// Listens to the window's keys and the canvas's pointers.
    pub(super) fn new(window: &Window, canvas: &HtmlCanvasElement) -> Self {
        let keys = Rc::new(RefCell::new(Keys::default()));
        let (pressed, released, away) = (keys.clone(), keys.clone(), keys.clone());
        let listeners = [
            Listener::new(window, "keydown", move |event: &KeyboardEvent| pressed.borrow_mut().press(event)),
            Listener::new(window, "keyup", move |event: &KeyboardEvent| {
                released.borrow_mut().down.remove(&event.code());
            }),
            Listener::new(window, "blur", move |_: &Event| away.borrow_mut().down.clear()),
        ];
        Self { keys, pointers: Pointers::new(canvas), gamepad: Gamepad::default(), held: Controls::default(), _listeners: listeners }
    }

    /// What all hands together ask for now.
    pub(super) fn controls(&self) -> Controls {
        self.keys.borrow().controls().with(self.pointers.stick()).with(self.gamepad.controls()).with(self.held)
    }

    /// Holds or lets go one of the page's buttons that lift (+) and sink (−).
    pub(super) fn hold_rise(&mut self, rise: f32) {
        self.held.rise = rise.clamp(-1.0, 1.0);
    }

    /// Reads the gamepad, which tells nothing by itself.
    pub(super) fn poll(&mut self) {
        let wish = self.gamepad.poll();
        self.keys.borrow_mut().wishes.extend(wish);
    }

    /// Turn of the view since the last call (rad, right and up); the stick of the gamepad turned for `dt_secs`.
    pub(super) fn take_look(&mut self, dt_secs: f32) -> [f32; 2] {
        let [right, up] = self.pointers.take_look();
        let [stick_right, stick_up] = self.gamepad.look_rad_per_s();
        [right + stick_right * dt_secs, up + stick_up * dt_secs]
    }

    /// Notches of the wheel since the last call, + away.
    pub(super) fn take_zoom(&mut self) -> f32 {
        self.pointers.take_zoom()
    }

    /// Presses since the last call.
    pub(super) fn take_wishes(&mut self) -> Vec<Wish> {
        std::mem::take(&mut self.keys.borrow_mut().wishes)
    }
}

impl Keys {
    fn press(&mut self, event: &KeyboardEvent) {
        if event.ctrl_key() || event.meta_key() || event.alt_key() || is_for_the_page(event) {
            return;
        }
        let code = event.code();
        if MOVES.iter().any(|(known, _)| *known == code) {
            event.prevent_default();
            self.down.insert(code);
        }
        if !event.repeat() && self.wishes.len() < WISHES {
            self.wishes.extend(wish(&event.key(), &event.code()));
        }
    }

    fn controls(&self) -> Controls {
        let held = MOVES.iter().filter(|(code, _)| self.down.contains(*code));
        held.fold(Controls::default(), |sum, (_, controls)| sum.with(*controls))
    }
}

const STILL: Controls = Controls { forward: 0.0, turn: 0.0, side: 0.0, rise: 0.0 };

/// Keys that act while they are down, by their place on the keyboard: 000 chapter 6, arrows beside them.
const MOVES: [(&str, Controls); 13] = [
    ("KeyW", Controls { forward: 1.0, ..STILL }),
    ("ArrowUp", Controls { forward: 1.0, ..STILL }),
    ("KeyS", Controls { forward: -1.0, ..STILL }),
    ("ArrowDown", Controls { forward: -1.0, ..STILL }),
    ("KeyA", Controls { turn: -1.0, ..STILL }),
    ("ArrowLeft", Controls { turn: -1.0, ..STILL }),
    ("KeyD", Controls { turn: 1.0, ..STILL }),
    ("ArrowRight", Controls { turn: 1.0, ..STILL }),
    ("KeyQ", Controls { side: -1.0, ..STILL }),
    ("KeyE", Controls { side: 1.0, ..STILL }),
    ("Space", Controls { rise: 1.0, ..STILL }),
    ("ShiftLeft", Controls { rise: -1.0, ..STILL }),
    ("ShiftRight", Controls { rise: -1.0, ..STILL }),
];

/// What a key asks for: a vehicle by its letter, a height by the key's place, since some layouts have digits only with shift.
fn wish(key: &str, code: &str) -> Option<Wish> {
    let vehicle = match key.to_lowercase().as_str() {
        "c" => Some(VehicleKind::Car),
        "m" => Some(VehicleKind::Monster),
        "h" => Some(VehicleKind::Helicopter),
        "l" => Some(VehicleKind::Sled),
        "b" => Some(VehicleKind::Ball),
        "f" | "escape" => None,
        _ => return HEIGHTS_M.iter().find(|(known, _)| *known == code).map(|&(_, height_m)| Wish::Height(height_m)),
    };
    Some(Wish::Take(vehicle))
}

/// Whether the visitor is at one of the page's own controls, which understand this key themselves.
fn is_for_the_page(event: &KeyboardEvent) -> bool {
    let controls = if matches!(event.code().as_str(), "Space" | "Escape") {
        "input, select, textarea, dialog, [role=slider], button, summary"
    } else {
        "input, select, textarea, dialog, [role=slider]"
    };
    let element = event.target().and_then(|target| target.dyn_into::<Element>().ok());
    element.is_some_and(|element| element.closest(controls).is_ok_and(|found| found.is_some()))
}
