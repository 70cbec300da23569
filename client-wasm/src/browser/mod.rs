//! The client in a web page, and the functions that the page's script calls.
//!
//! There is one client per page. Before [`start`] and after [`halt`], every function does nothing and returns an empty value.

mod app;
mod connection;
mod device_support;
mod driving;
mod failure;
mod frame_meter;
mod gamepad;
mod gpu_canvas;
mod halted;
mod incoming;
mod input;
mod listener;
mod looking_back;
mod page;
mod pointer;
mod renderer_setup;
mod report;
mod settings;
mod socket;
mod start_times;
mod status;

use crate::bindings::HEIGHT_KEYS;
use crate::render::{BlendOrder, FarPlants, SideOptions};
use crate::vehicle::{Dpad, VehicleProfile, VerticalControl, profile};
use app::{App, set_app, with_app};
use glam::Vec3;
use halted::is_halted;
use prairie_core::scene::VehicleKind;
use serde_json::{Value, json};
use settings::Settings;
use std::cell::{Cell, OnceCell};
use std::rc::Rc;
use wasm_bindgen::prelude::*;
use web_sys::Window;

/// Interval between two ticks (ms): that of the most frequent message to the server.
const TICK_MS: i32 = 33;

/// Starts the client on the canvas with this id. `options` is a JSON object: `name` of the user, `qualities` (names in order of preference, or null),
/// `device` (`is_software`, `is_touch`, and `budget_ms` per frame or null), `scene` (name in the address, or null), `paused` (draw only when [`draw`] is
/// called), `predicts` (whether the own vehicle is predicted) and `adapter` (the browser's description of its graphics adapter).
///
/// # Errors
/// If the page has no such canvas, or the options cannot be parsed.
#[wasm_bindgen]
pub fn start(canvas_id: &str, options: &str) -> Result<(), JsError> {
    failure::set_panic_hook();
    let window = web_sys::window().ok_or_else(|| JsError::new("the client needs a browser window"))?;
    let canvas = page::canvas(&window, canvas_id)?;
    let mut app = App::new(window.clone(), canvas, app::options(options)?, incoming::handle).map_err(|error| JsError::new(&error))?;
    app.request_device();
    set_app(app);

    start_ticking(&window)?;
    start_frame_loop(window);
    Ok(())
}

/// Ticks until the client is halted.
fn start_ticking(window: &Window) -> Result<(), JsError> {
    let (own_window, timer) = (window.clone(), Rc::new(Cell::new(None)));
    let own_timer = timer.clone();
    let tick = Closure::<dyn Fn()>::new(move || {
        if is_halted()
            && let Some(timer) = own_timer.take()
        {
            own_window.clear_interval_with_handle(timer);
        }
        with_app(|app| app.tick(page::now_secs(&own_window)));
    });
    let scheduled = window.set_interval_with_callback_and_timeout_and_arguments_0(tick.into_js_value().unchecked_ref(), TICK_MS);
    timer.set(Some(scheduled.map_err(|_| JsError::new("the page has no timer"))?));
    Ok(())
}

/// Callback of the animation frame, with its time (ms).
type OnFrame = Rc<OnceCell<Closure<dyn Fn(f64)>>>;

/// Draws in every animation frame until the client is halted; browsers stop these while the page is hidden.
fn start_frame_loop(window: Window) {
    let on_frame = OnFrame::default();
    let (own_window, own) = (window.clone(), on_frame.clone());
    on_frame.get_or_init(|| {
        Closure::new(move |_| {
            with_app(|app| {
                if !app.is_paused() {
                    app.frame(page::now_secs(&own_window), None, false);
                }
            });
            request_frame(&own_window, &own);
        })
    });
    request_frame(&window, &on_frame);
}

fn request_frame(window: &Window, on_frame: &OnFrame) {
    if let Some(closure) = on_frame.get().filter(|_| !is_halted()) {
        // Fails only if the function is null.
        let _ = window.request_animation_frame(closure.as_ref().unchecked_ref());
    }
}

/// Stops the client for good, even after a panic.
#[wasm_bindgen]
pub fn halt() {
    failure::halt();
}

/// Panics inside the client, as a bug would, to try how the page reports it.
#[wasm_bindgen]
pub fn panic(reason: &str) {
    with_app(|_| panic!("{reason}"));
}

/// Draws one frame at simulated time `time_secs`, of wind, clouds and rain, even if it equals the previous one. Returns false if not all of the scene is loaded
/// yet, or the GPU is busy.
#[wasm_bindgen]
pub fn draw(time_secs: f64) -> bool {
    let now_secs = web_sys::window().map_or(0.0, |window| page::now_secs(&window));
    with_app(|app| app.is_complete() && app.frame(now_secs, Some(time_secs), true)).unwrap_or(false)
}

/// Draws the newest frame again, so that the canvas can be read. Returns false like [`draw`].
#[wasm_bindgen]
pub fn redraw() -> bool {
    let now_secs = web_sys::window().map_or(0.0, |window| page::now_secs(&window));
    with_app(|app| app.redraw(now_secs)).unwrap_or(false)
}

/// The client's state as JSON; `null` before it has started.
#[wasm_bindgen]
pub fn state() -> String {
    with_app(|app| app.report().to_string()).unwrap_or_else(|| "null".into())
}

/// Shows the world of `secs` seconds ago, at which time stands still unless it is [`run`](run_past) on; 0 or less shows the present again. Does nothing while
/// nothing is recorded.
#[wasm_bindgen]
pub fn look_back(secs: f64) {
    with_app(|app| app.look_back(secs));
}

/// Shows the present again.
#[wasm_bindgen]
pub fn live() {
    with_app(App::go_live);
}

/// Lets time go on from the moment shown, or stand still, even at the present.
#[wasm_bindgen]
pub fn run_past(runs: bool) {
    with_app(|app| app.run_past(runs));
}

/// Bending angle of the grass at `(x_m, z_m)` in the mirror shown (rad): that of the present, or of the past that the user looks at.
#[wasm_bindgen]
pub fn theta(x_m: f32, z_m: f32) -> f32 {
    with_app(|app| app.shown().theta_at(x_m, z_m)).unwrap_or(0.0)
}

/// Lean of the bend field at `(x_m, z_m)` in the mirror shown (rad, X and Z), without the lean in the wind: as `GET /api/bend` on the server.
#[wasm_bindgen]
pub fn bend(x_m: f32, z_m: f32) -> Vec<f32> {
    with_app(|app| app.shown().field_lean_at(x_m, z_m).to_vec()).unwrap_or_default()
}

/// World step of the newest wind in the mirror shown; −1 before the first.
#[wasm_bindgen]
pub fn wind_tick() -> f64 {
    with_app(|app| app.shown().wind().map(|wind| wind.tick() as f64)).flatten().unwrap_or(-1.0)
}

/// Wind at a point in the mirror shown (m/s), with its gust: as `GET /api/wind` on the server for the same step.
#[wasm_bindgen]
pub fn wind(x_m: f32, y_m: f32, z_m: f32) -> Vec<f32> {
    with_app(|app| app.shown().wind_at(Vec3::new(x_m, y_m, z_m)).to_array().to_vec()).unwrap_or_default()
}

/// Dust concentration at a point in the mirror shown.
#[wasm_bindgen]
pub fn dust(x_m: f32, y_m: f32, z_m: f32) -> f32 {
    with_app(|app| app.shown().dust_at(Vec3::new(x_m, y_m, z_m))).unwrap_or(0.0)
}

/// Sound levels at the camera (`hearing.rs`), as JSON; `null` while the client is not connected or has no view yet.
#[wasm_bindgen]
pub fn hear() -> String {
    with_app(|app| app.hearing_report().to_string()).unwrap_or_else(|| "null".into())
}

/// Checksum of the underbrush in the client's mirror (`Flora::checksum`), 16 hexadecimal digits; empty if there is none.
#[wasm_bindgen]
pub fn plants() -> String {
    let checksum =
        with_app(|app| app.mirror.decoded_scene().and_then(|decoded| decoded.flora()).map(|flora| format!("{:016x}", flora.checksum())));
    checksum.flatten().unwrap_or_default()
}

/// Moves the free camera to `eye_m` (three numbers). While driving, the chase camera takes over again. Returns false if a number is not finite.
#[wasm_bindgen]
pub fn set_camera(eye_m: &[f32], heading_rad: f32, pitch_rad: f32) -> bool {
    app::camera(eye_m, heading_rad, pitch_rad).is_some_and(|camera| with_app(|app| app.set_camera(camera)).is_some())
}

/// Selects a vehicle by its name; any other word leaves the current one.
#[wasm_bindgen]
pub fn choose(vehicle: &str) {
    let kind = VehicleKind::ALL.into_iter().find(|kind| kind.name() == vehicle);
    with_app(|app| app.take(kind));
}

/// Sets the camera's height (m) above the ground, or above the vehicle.
#[wasm_bindgen]
pub fn set_height(height_m: f32) {
    with_app(|app| app.set_height(height_m));
}

/// Sets the quality by name, `auto` included; an unknown name changes nothing.
#[wasm_bindgen]
pub fn set_quality(name: &str) {
    with_app(|app| app.settings.set_quality(name));
}

/// Everything the page offers to choose from, as a JSON object: names of `quality` presets, of transparency `order`s, of representations of `far` plants and
/// of variants that can be `compared`; `vehicles` with `name`, `label`, `key`, `arrow` of the D-pad (or null) and whether they `flies`; camera
/// `heights` (m) on the digit keys from 1.
#[wasm_bindgen]
pub fn choices() -> String {
    let choices = json!({
        "quality": Settings::qualities().collect::<Vec<_>>(),
        "order": BlendOrder::ALL.map(BlendOrder::name),
        "far": FarPlants::ALL.map(FarPlants::name),
        "compared": SideOptions::names().collect::<Vec<_>>(),
        "vehicles": VehicleKind::ALL.map(vehicle),
        "heights": HEIGHT_KEYS.map(|(_, height_m)| height_m),
    });
    choices.to_string()
}

fn vehicle(kind: VehicleKind) -> Value {
    let VehicleProfile { label, key, dpad, vertical, .. } = profile(kind);
    json!({ "name": kind.name(), "label": label, "key": key, "arrow": dpad.map(Dpad::arrow), "flies": vertical == VerticalControl::Lift, "jumps": vertical == VerticalControl::Jump })
}

/// Sets render options by name: the transparency order, and the representation of far plants. An unknown name changes nothing.
#[wasm_bindgen]
pub fn set_options(order: &str, far: &str) {
    with_app(|app| app.settings.set_options(order, far));
}

/// Raises the wind on far clumps with distance, or shows it as it is.
#[wasm_bindgen]
pub fn raise_far_wind(raises: bool) {
    with_app(|app| app.settings.raise_far_wind(raises));
}

/// Shows or hides the map of the grass grids around the camera.
#[wasm_bindgen]
pub fn show_grids(shows: bool) {
    with_app(|app| app.settings.show_grids(shows));
}

/// Lets grass cast shadows on grass and ground or not.
#[wasm_bindgen]
pub fn cast_grass_shadows(casts: bool) {
    with_app(|app| app.settings.cast_grass_shadows(casts));
}

/// Sets the hour of the day, 0 to 24, that determines the sun; any other number restores the scene's own hour.
#[wasm_bindgen]
pub fn set_hour(hour: f32) {
    with_app(|app| app.settings.set_hour(hour));
}

/// Compares two variants side by side, with the border at a fraction of the width. An unknown name ends the comparison.
#[wasm_bindgen]
pub fn compare(left: String, right: String, border: f32) {
    with_app(|app| app.settings.compare([left, right], border));
}

/// Predicts the own vehicle from now on, or shows it as the server has it.
#[wasm_bindgen]
pub fn predict(enabled: bool) {
    with_app(|app| app.prediction.enable(enabled));
}

/// Draws every frame, for a recording, or only those that differ from the previous one.
#[wasm_bindgen]
pub fn draw_every_frame(enabled: bool) {
    with_app(|app| app.draw_every_frame(enabled));
}

/// Changes the user's name.
#[wasm_bindgen]
pub fn set_name(name: String) {
    with_app(|app| app.connection.rename(name));
}

/// Sets the state of the up and down buttons: 1 for up, −1 for down, 0 for released.
#[wasm_bindgen]
pub fn hold_rise(rise: f32) {
    with_app(|app| app.hold_rise(rise));
}
