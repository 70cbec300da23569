//! The first gamepad with the standard layout (W3C Gamepad, section 11).

use crate::bindings::{Action, gamepad_action};
use crate::controls::{Controls, without_dead_zone};
use wasm_bindgen::prelude::*;
use web_sys::{Gamepad as Pad, GamepadButton, GamepadMappingType};

/// Dead zone of the sticks, as a fraction of full deflection.
const DEAD_ZONE: f32 = 0.14;

/// Turn rate of the view at full deflection of the right stick (rad/s).
const LOOK_RAD_PER_S: f32 = 2.4;

/// Buttons of the standard layout.
const LOWER: u32 = 0;
const RIGHT: u32 = 1;
const LEFT_TRIGGER: u32 = 6;
const RIGHT_TRIGGER: u32 = 7;

/// State of the gamepad at the last poll.
#[derive(Default)]
pub(super) struct Gamepad {
    controls: Controls,
    look: [f32; 2],
    /// Button with an action that was down.
    pressed: Option<u32>,
}

impl Gamepad {
    pub(super) fn controls(&self) -> Controls {
        self.controls
    }

    /// Turn rate of the view from the right stick (rad/s, right and up).
    pub(super) fn look_rad_per_s(&self) -> [f32; 2] {
        self.look.map(|deflection| deflection * LOOK_RAD_PER_S)
    }

    /// Polls the gamepad; returns the action of a button pressed since the last poll.
    pub(super) fn poll(&mut self) -> Option<Action> {
        let Some(pad) = standard() else {
            *self = Self::default();
            return None;
        };
        let axis = |index: u32| without_dead_zone(pad.axes().get(index).as_f64().unwrap_or(0.0) as f32, DEAD_ZONE);
        let button = |index: u32| pad.buttons().get(index).dyn_into::<GamepadButton>().map_or(0.0, |button| button.value() as f32);
        self.controls = Controls { turn: axis(0), forward: -axis(1), ..Default::default() }.with(Controls {
            forward: button(RIGHT_TRIGGER) - button(LEFT_TRIGGER),
            rise: button(LOWER) - button(RIGHT),
            ..Default::default()
        });
        self.look = [axis(2), -axis(3)];
        let down = (0..pad.buttons().length()).find(|&index| button(index) > 0.5 && gamepad_action(index).is_some());
        let before = std::mem::replace(&mut self.pressed, down);
        down.filter(|index| before != Some(*index)).and_then(gamepad_action)
    }
}

fn standard() -> Option<Pad> {
    let pads = web_sys::window()?.navigator().get_gamepads().ok()?;
    let mut pads = pads.iter().filter_map(|pad| pad.dyn_into::<Pad>().ok());
    pads.find(|pad| pad.connected() && pad.mapping() == GamepadMappingType::Standard)
}
