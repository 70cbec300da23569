//! The client in a page: what the page's script calls.
//!
//! There is one client a page. Every function does nothing, or gives nothing, before [`start`].

mod app;
mod choices;
mod connection;
mod fitting;
mod gamepad;
mod input;
mod listener;
mod meter;
mod page;
mod pointer;
mod report;
mod socket;
mod stage;
mod telling;

use crate::render::{Far, Order, Quality, Way};
use app::App;
use glam::Vec3;
use serde_json::json;
use shared::scene::VehicleKind;
use std::cell::{OnceCell, RefCell};
use std::rc::Rc;
use wasm_bindgen::prelude::*;
use web_sys::Window;

/// Time between two ticks (ms): that of the fastest message to the server.
const TICK_MS: i32 = 33;

thread_local! {
    static APP: RefCell<Option<App>> = const { RefCell::new(None) };
}

/// Gives the page's client to `act`; nothing when there is none.
fn with_app<T>(act: impl FnOnce(&mut App) -> T) -> Option<T> {
    APP.with_borrow_mut(|app| app.as_mut().map(act))
}

/// Starts the client on the canvas with this id. `options` is a JSON object: `name`, `quality` (`auto`, `low`, `medium`, `high`, `ultra`), `automatic` (what
/// `auto` means: `finest` quality, first `level`, 0 to 3, and `budget_ms` for a frame), `scene` (the scene that the address names, or null), `paused` (draw
/// only when [`draw`] asks) and `adapter` (what the browser says of its graphics).
///
/// # Errors
/// When the page has no such canvas, or the options are none of these.
#[wasm_bindgen]
pub fn start(canvas_id: &str, options: &str) -> Result<(), JsError> {
    console_error_panic_hook::set_once();
    let window = web_sys::window().ok_or_else(|| JsError::new("the client runs in a page"))?;
    let canvas = page::canvas(&window, canvas_id)?;
    let mut app = App::new(window.clone(), canvas, app::options(options)?).map_err(|error| JsError::new(&error))?;
    app.build_stage();
    APP.set(Some(app));

    let ticking = window.clone();
    let tick = Closure::<dyn Fn()>::new(move || {
        with_app(|app| app.tick(page::now_secs(&ticking)));
    });
    let scheduled = window.set_interval_with_callback_and_timeout_and_arguments_0(tick.into_js_value().unchecked_ref(), TICK_MS);
    scheduled.map_err(|_| JsError::new("the page keeps no time"))?;
    draw_on(window);
    Ok(())
}

/// Called with the time (ms) of the picture that the screen shows next.
type OnFrame = Rc<OnceCell<Closure<dyn Fn(f64)>>>;

/// Draws with every picture that the screen shows; not at all while the page is hidden.
fn draw_on(window: Window) {
    let on_frame = OnFrame::default();
    let (asking, own) = (window.clone(), on_frame.clone());
    on_frame.get_or_init(|| {
        Closure::new(move |time_ms: f64| {
            with_app(|app| {
                if !app.is_paused() {
                    app.frame(page::now_secs(&asking), time_ms / 1e3, false);
                }
            });
            ask_for_frame(&asking, &own);
        })
    });
    ask_for_frame(&window, &on_frame);
}

fn ask_for_frame(window: &Window, on_frame: &OnFrame) {
    if let Some(closure) = on_frame.get() {
        // Fails only for a function that is null.
        let _ = window.request_animation_frame(closure.as_ref().unchecked_ref());
    }
}

/// Draws one picture, even if it is like the last, with `time_secs` as the time of whatever moves by itself. False when there is nothing to draw yet, or the
/// device is behind.
#[wasm_bindgen]
pub fn draw(time_secs: f64) -> bool {
    let now_secs = web_sys::window().map_or(0.0, |window| page::now_secs(&window));
    with_app(|app| app.frame(now_secs, time_secs, true)).unwrap_or(false)
}

/// Draws the newest picture again, for whoever wants to read the canvas. False as for [`draw`].
#[wasm_bindgen]
pub fn redraw() -> bool {
    let now_secs = web_sys::window().map_or(0.0, |window| page::now_secs(&window));
    with_app(|app| app.redraw(now_secs)).unwrap_or(false)
}

/// The client's own account of itself, as JSON; `null` before it has started.
#[wasm_bindgen]
pub fn state() -> String {
    with_app(|app| app.report().to_string()).unwrap_or_else(|| "null".into())
}

/// Bending angle of the grass at `(x_m, z_m)` in the client's mirror (rad).
#[wasm_bindgen]
pub fn theta(x_m: f32, z_m: f32) -> f32 {
    with_app(|app| app.mirror.theta_at(x_m, z_m)).unwrap_or(0.0)
}

/// Wind at a place in the client's mirror (m/s).
#[wasm_bindgen]
pub fn wind(x_m: f32, y_m: f32, z_m: f32) -> Vec<f32> {
    with_app(|app| app.mirror.wind_at(Vec3::new(x_m, y_m, z_m)).to_array().to_vec()).unwrap_or_default()
}

/// Concentration of dust at a place in the client's mirror.
#[wasm_bindgen]
pub fn dust(x_m: f32, y_m: f32, z_m: f32) -> f32 {
    with_app(|app| app.mirror.dust_at(Vec3::new(x_m, y_m, z_m))).unwrap_or(0.0)
}

/// Checksum of the underbrush in the client's mirror (`Flora::checksum`), 16 hexadecimal digits; empty where none grows.
#[wasm_bindgen]
pub fn plants() -> String {
    let checksum = with_app(|app| app.mirror.land().and_then(|land| land.flora()).map(|flora| format!("{:016x}", flora.checksum())));
    checksum.flatten().unwrap_or_default()
}

/// Puts the free camera at `eye_m` (three numbers); gives up the chase only while nothing is driven. False when a number is not finite.
#[wasm_bindgen]
pub fn look(eye_m: &[f32], heading_rad: f32, pitch_rad: f32) -> bool {
    app::camera(eye_m, heading_rad, pitch_rad).is_some_and(|camera| with_app(|app| app.look(camera)).is_some())
}

/// Takes a vehicle by its name, or with any other word gives up the one held.
#[wasm_bindgen]
pub fn choose(vehicle: &str) {
    let kind = VehicleKind::ALL.into_iter().find(|kind| kind.name() == vehicle);
    with_app(|app| app.take(kind));
}

/// Takes the eye to a height (m) above the land, or above what one drives.
#[wasm_bindgen]
pub fn set_height(height_m: f32) {
    with_app(|app| app.set_height(height_m));
}

/// Changes how fine the picture is, `auto` included; an unknown name changes nothing.
#[wasm_bindgen]
pub fn set_quality(name: &str) {
    with_app(|app| app.choices.set_quality(name));
}

/// Names of the ways of drawing between which [`set_look`] and [`compare`] choose, as a JSON object: `quality`, `order`, `far`, and `compared`, which are the
/// ways that can stand side by side.
#[wasm_bindgen]
pub fn ways() -> String {
    let (order, far) = (Order::ALL.map(Order::name), Far::ALL.map(Far::name));
    json!({ "quality": Quality::ALL.map(Quality::name), "order": order, "far": far, "compared": Way::names().collect::<Vec<_>>() })
        .to_string()
}

/// Changes how plants are laid over each other and what stands for those far away; an unknown name changes nothing.
#[wasm_bindgen]
pub fn set_look(order: &str, far: &str) {
    with_app(|app| app.choices.set_look(order, far));
}

/// Lets the sun stand as at an hour of the scene's day, 0 to 24; any other number leaves it where the scene has it.
#[wasm_bindgen]
pub fn set_hour(hour: f32) {
    with_app(|app| app.choices.set_hour(hour));
}

/// Shows two ways side by side, with the border at a share of the width; one picture where a name is unknown.
#[wasm_bindgen]
pub fn compare(left: String, right: String, at: f32) {
    with_app(|app| app.choices.compare([left, right], at));
}

/// Draws every picture that the screen shows, for a film, or only those that differ from the last.
#[wasm_bindgen]
pub fn keep_drawing(keeps: bool) {
    with_app(|app| app.keep_drawing(keeps));
}

/// Takes another name.
#[wasm_bindgen]
pub fn set_name(name: String) {
    with_app(|app| app.connection.rename(name));
}

/// Holds a button that lifts (1), sinks (−1), or lets it go (0).
#[wasm_bindgen]
pub fn hold_rise(rise: f32) {
    with_app(|app| app.hold_rise(rise));
}
