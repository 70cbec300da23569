//! Mouse, pen and touch on the canvas: dragging turns the view, a touch on the left is a virtual stick, the wheel zooms.

use super::listener::Listener;
use crate::controls::{Controls, without_dead_zone};
use std::cell::RefCell;
use std::rc::Rc;
use wasm_bindgen::JsCast;
use web_sys::{HtmlCanvasElement, HtmlElement, PointerEvent, WheelEvent};

/// Turn of the view per pixel of a drag (rad/px): for a mouse, for touch.
const LOOK_RAD: [f32; 2] = [0.0035, 0.006];

/// Fraction of the canvas's width, from the left, where a touch is the virtual stick.
const STICK_FRACTION: f32 = 0.45;

/// Displacement at full deflection of the virtual stick (px), and its dead zone as a fraction of that.
const STICK_PX: f32 = 64.0;
const STICK_DEAD_ZONE: f32 = 0.12;

/// Scroll distance of one wheel notch (px).
const NOTCH_PX: f32 = 100.0;

/// All pointers on the canvas.
pub(super) struct Pointers {
    state: Rc<RefCell<State>>,
    _listeners: [Listener; 5],
}

#[derive(Default)]
struct State {
    drags: Vec<Drag>,
    look_rad: [f32; 2],
    notches: f32,
}

/// A pointer held down.
struct Drag {
    id: i32,
    origin_px: [f32; 2],
    at_px: [f32; 2],
    /// Turn per pixel (rad/px); `None` for the virtual stick.
    look_rad: Option<f32>,
}

impl Pointers {
    pub(super) fn new(canvas: &HtmlCanvasElement) -> Self {
        let state = Rc::new(RefCell::new(State::default()));
        let [pressed, moved, up, cancelled, rolled] = std::array::from_fn(|_| state.clone());
        let own = canvas.clone();
        let listeners = [
            Listener::new(canvas, "pointerdown", move |event: &PointerEvent| pressed.borrow_mut().press(event, &own)),
            Listener::new(canvas, "pointermove", move |event: &PointerEvent| moved.borrow_mut().follow(event)),
            Listener::new(canvas, "pointerup", move |event: &PointerEvent| up.borrow_mut().release(event)),
            Listener::new(canvas, "pointercancel", move |event: &PointerEvent| cancelled.borrow_mut().release(event)),
            Listener::new(canvas, "wheel", move |event: &WheelEvent| {
                event.prevent_default();
                let notch_px = if event.delta_mode() == WheelEvent::DOM_DELTA_LINE { NOTCH_PX / 3.0 } else { 1.0 };
                rolled.borrow_mut().notches += event.delta_y() as f32 * notch_px / NOTCH_PX;
            }),
        ];
        Self { state, _listeners: listeners }
    }

    /// Deflection of the virtual stick.
    pub(super) fn stick(&self) -> Controls {
        let state = self.state.borrow();
        let Some(drag) = state.drags.iter().find(|drag| drag.look_rad.is_none()) else { return Controls::default() };
        let deflection = |axis: usize| without_dead_zone((drag.at_px[axis] - drag.origin_px[axis]) / STICK_PX, STICK_DEAD_ZONE);
        Controls { forward: -deflection(1), turn: deflection(0), ..Default::default() }
    }

    /// Turn of the view since the last call (rad, right and up).
    pub(super) fn take_look(&mut self) -> [f32; 2] {
        std::mem::take(&mut self.state.borrow_mut().look_rad)
    }

    /// Notches of the wheel since the last call.
    pub(super) fn take_zoom(&mut self) -> f32 {
        std::mem::take(&mut self.state.borrow_mut().notches)
    }
}

impl State {
    fn press(&mut self, event: &PointerEvent, canvas: &HtmlCanvasElement) {
        // Fails if the pointer has been released in the meantime.
        if canvas.set_pointer_capture(event.pointer_id()).is_err() {
            return;
        }
        let touch = event.pointer_type() == "touch";
        let left = (event.client_x() as f32) < STICK_FRACTION * canvas.client_width() as f32;
        let stick_is_free = self.drags.iter().all(|drag| drag.look_rad.is_some());
        let look_rad = (!(touch && left && stick_is_free)).then_some(LOOK_RAD[usize::from(touch)]);
        let at_px = position_px(event);
        let drag = Drag { id: event.pointer_id(), origin_px: at_px, at_px, look_rad };
        show_stick(&drag);
        self.drags.retain(|other| other.id != drag.id);
        self.drags.push(drag);
    }

    fn follow(&mut self, event: &PointerEvent) {
        let Some(drag) = self.drags.iter_mut().find(|drag| drag.id == event.pointer_id()) else { return };
        let from_px = std::mem::replace(&mut drag.at_px, position_px(event));
        if let Some(look_rad) = drag.look_rad {
            self.look_rad[0] += (drag.at_px[0] - from_px[0]) * look_rad;
            self.look_rad[1] -= (drag.at_px[1] - from_px[1]) * look_rad;
        } else {
            show_stick(drag);
        }
    }

    fn release(&mut self, event: &PointerEvent) {
        let gone = self.drags.extract_if(.., |drag| drag.id == event.pointer_id());
        if gone.filter(|drag| drag.look_rad.is_none()).count() > 0
            && let Some(stick) = stick()
        {
            stick.set_hidden(true);
        }
    }
}

fn position_px(event: &PointerEvent) -> [f32; 2] {
    [event.client_x() as f32, event.client_y() as f32]
}

/// Shows the virtual stick where the touch began, with its knob under the finger.
fn show_stick(drag: &Drag) {
    let Some(stick) = stick().filter(|_| drag.look_rad.is_none()) else { return };
    let [x, y] = drag.origin_px;
    let [dx, dy] = [0, 1].map(|axis| (drag.at_px[axis] - drag.origin_px[axis]).clamp(-STICK_PX, STICK_PX));
    // The page's policy forbids the attribute `style`, but not its properties.
    for (name, px) in [("left", x), ("top", y), ("--x", dx), ("--y", dy)] {
        // Fails only for a style that is computed.
        let _ = stick.style().set_property(name, &format!("{px}px"));
    }
    stick.set_hidden(false);
}

/// The page's element `#stick`, if there is one.
fn stick() -> Option<HtmlElement> {
    web_sys::window()?.document()?.get_element_by_id("stick")?.dyn_into().ok()
}
