//! The client of one page: runs the connection, the input, the camera and the frame loop.

use super::connection::Connection;
use super::device_support::DeviceSupport;
use super::frame_meter::FrameMeter;
use super::gpu_canvas::{FrameInput, GpuCanvas};
use super::halted::is_halted;
use super::input::Input;
use super::page;
use super::settings::{Device, Settings};
use super::socket::SocketEvent;
use super::start_times::StartTimes;
use super::status::Status;
use crate::bindings::{Action, next_vehicle};
use crate::budget::FrameTime;
use crate::camera::Camera;
use crate::controls::Controls;
use crate::ladder::Rung;
use crate::prediction::Prediction;
use crate::redraw::RedrawTracker;
use crate::render::{Quality, RenderOptions, Split, Stage, bend_reach_m};
use crate::replica_budget::{ReplicaBudget, Wish};
use crate::rig::Rig;
use crate::sight::Sight;
use crate::state::{Mirror, Past, Record};
use glam::Vec3;
use prairie_core::scene::VehicleKind;
use prairie_core::wire::{Close, ObjectPose};
use serde::Deserialize;
use std::cell::RefCell;
use std::sync::Arc;
use wasm_bindgen::prelude::*;
use web_sys::{HtmlCanvasElement, Window};

/// Maximum time by which one frame moves the camera (s). A longer interval was a pause.
const MAX_FRAME_SECS: f64 = 0.25;

/// Minimum interval between two changes of the page's address (s).
const LINK_SECS: f64 = 0.5;

/// Number of consecutive device losses after which the device is no longer replaced.
const MAX_LOSSES: u32 = 3;
/// Time (s) that a device must last for its loss not to count as consecutive.
const LOSS_SECS: f64 = 120.0;

thread_local! {
    static APP: RefCell<Option<App>> = const { RefCell::new(None) };
}

/// Calls `act` with the page's client; `None` if it has not started, or is halted.
pub(super) fn with_app<T>(act: impl FnOnce(&mut App) -> T) -> Option<T> {
    if is_halted() {
        return None;
    }
    APP.with_borrow_mut(|app| app.as_mut().map(act))
}

/// Makes `app` the page's client.
pub(super) fn set_app(app: App) {
    APP.set(Some(app));
}

/// Start options, given by the page as JSON.
#[derive(Debug, Deserialize)]
pub(super) struct Options {
    /// Name of the user.
    pub(super) name: String,
    /// Names of qualities in order of preference; unknown ones are skipped. The last resort is automatic quality.
    pub(super) qualities: Vec<Option<String>>,
    /// Kind of device.
    pub(super) device: Device,
    /// Name of the scene in the address, if any.
    pub(super) scene: Option<String>,
    /// Whether to draw only on request.
    pub(super) paused: bool,
    /// Whether to predict the own vehicle.
    pub(super) predicts: bool,
    /// The browser's description of its graphics adapter.
    pub(super) adapter: String,
}

/// The client of a page.
pub(super) struct App {
    pub(super) options: Options,
    pub(super) settings: Settings,
    pub(super) mirror: Mirror,
    /// The last minutes.
    pub(super) record: Record,
    /// The past that is shown instead of the present, while the user looks back.
    pub(super) past: Option<Past>,
    pub(super) connection: Connection,
    pub(super) prediction: Prediction,
    pub(super) rig: Option<Rig>,
    /// Trees of the scene with this number, for the chase camera.
    sight: (u32, Sight),
    pub(super) meter: FrameMeter,
    pub(super) failure: Option<Failure>,
    pub(super) replica_budget: ReplicaBudget,
    pub(super) redraw: RedrawTracker<DrawnView>,
    /// Name of the server's scene.
    pub(super) scene_name: Option<String>,
    /// Whether the camera starts anew in the scene that is being received.
    pub(super) starts_anew: bool,
    pub(super) canvas: HtmlCanvasElement,
    pub(super) gpu: Option<GpuCanvas>,
    pub(super) support: DeviceSupport,
    pub(super) times: Arc<StartTimes>,
    pub(super) window: Window,
    pub(super) input: Input,
    draws_every_frame: bool,
    /// Whether a frame was postponed since the last one because the GPU was busy.
    waited: bool,
    /// Time of the last frame (s).
    drawn_at_secs: f64,
    pub(super) losses: u32,
    lost_at_secs: f64,
    /// Vehicle requested by the user.
    pub(super) wanted: Option<VehicleKind>,
    clock_secs: f64,
    /// Simulated time of the last frame (s).
    drawn_secs: f64,
    /// Time of the last motion of the camera (s).
    moved_at_secs: f64,
    /// Last view written to the address, and when (s).
    link: (String, f64),
    /// Message for the user, and when it disappears (s).
    pub(super) notice: Option<(String, f64)>,
    pub(super) was_welcomed: bool,
    /// Status message shown.
    pub(super) status: Option<Status>,
}

/// Reason why the client stopped.
#[derive(Clone, Debug)]
pub(super) struct Failure {
    /// Kind of status message (`messages.js`).
    pub(super) kind: &'static str,
    /// Detail of the message.
    pub(super) reason: String,
}

/// Everything a frame depends on besides world and camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct DrawnView {
    size_px: [u32; 2],
    stage: Option<(Stage, bool)>,
    quality: Quality,
    level: f32,
    resolution: f32,
    options: RenderOptions,
    split: Option<Split>,
}

impl App {
    /// A client that passes the socket's events to `handle`.
    pub(super) fn new(window: Window, canvas: HtmlCanvasElement, options: Options, handle: fn(SocketEvent)) -> Result<Self, String> {
        let settings = Settings::new(&options.qualities, options.device);
        let input = Input::new(&window, &canvas);
        let connection = Connection::new(page::socket_url(&window)?, options.name.clone(), handle);
        Ok(Self {
            prediction: Prediction::new(options.predicts),
            options,
            settings,
            mirror: Mirror::default(),
            record: Record::default(),
            past: None,
            connection,
            rig: None,
            sight: Default::default(),
            meter: FrameMeter::default(),
            failure: None,
            replica_budget: ReplicaBudget::default(),
            redraw: RedrawTracker::default(),
            scene_name: None,
            starts_anew: false,
            canvas,
            gpu: None,
            support: DeviceSupport::default(),
            times: Arc::default(),
            window,
            input,
            draws_every_frame: false,
            waited: false,
            drawn_at_secs: 0.0,
            losses: 0,
            lost_at_secs: 0.0,
            wanted: None,
            clock_secs: 0.0,
            drawn_secs: 0.0,
            moved_at_secs: 0.0,
            link: (String::new(), 0.0),
            notice: None,
            was_welcomed: false,
            status: None,
        })
    }

    /// Periodic work, whether or not frames are drawn: reads the input, talks to the server and updates the page.
    pub(super) fn tick(&mut self, now_secs: f64) {
        self.input.poll();
        for action in self.input.take_actions() {
            match action {
                Action::Take(vehicle) => self.take(vehicle),
                Action::TakeNext { forward } => self.take(Some(next_vehicle(self.wanted, forward))),
                Action::SetHeight(height_m) => self.set_height(height_m),
            }
        }
        self.connection.tick(now_secs);
        if self.replica_budget.wish(now_secs) == Some(Wish::Replica) {
            self.connection.replicate(true);
        }
        if self.own_object().is_some() && self.input.controls() != Controls::default() {
            self.go_live();
        }
        self.drive(now_secs);
        self.work_on_past(now_secs);
        if let Some(camera) = self.rig.as_ref().map(Rig::camera) {
            self.send_view(camera, now_secs);
            self.keep_link(camera, now_secs);
        }
        self.replace_lost_device(now_secs);
        if let Some(decoded) = self.mirror.decoded_scene() {
            self.settings.follow(decoded.scene());
        }
        self.update_renderer();
        self.update_status();
    }

    /// Advances the camera and draws a frame at simulated time `at_secs`, or else at the time to show now, unless it would equal the previous one and is not
    /// `forced`. Returns whether it drew; it does not while the scene or the renderer is missing, or the GPU is busy.
    pub(super) fn frame(&mut self, now_secs: f64, at_secs: Option<f64>, forced: bool) -> bool {
        self.run_clock(now_secs);
        let elapsed_secs = (now_secs - self.moved_at_secs).clamp(0.0, MAX_FRAME_SECS);
        self.advance_past(elapsed_secs, now_secs);
        let time_secs = at_secs.unwrap_or_else(|| self.shown().shown_secs());
        let passed_secs = (time_secs - self.drawn_secs).clamp(0.0, MAX_FRAME_SECS);
        // Plants settle even in a past that stands still.
        let dt_secs = if self.past.is_some() && at_secs.is_none() { elapsed_secs } else { passed_secs } as f32;
        // The camera moves even if the world does not.
        let camera_secs = if at_secs.is_some() { dt_secs } else { elapsed_secs as f32 };
        self.input.poll();
        self.drive(now_secs);
        let vehicle = self.place_own_object(now_secs);
        self.find_trees();
        let loads_stage = self.loads_stage(now_secs);
        let (Some(rig), Some(gpu)) = (&mut self.rig, &mut self.gpu) else { return false };
        if loads_stage || gpu.is_busy(&self.mirror) {
            self.waited = true;
            return false;
        }
        let stage = gpu.stage(&self.mirror);
        let Some(renderer) = gpu.renderer(&self.mirror) else { return false };
        let light = self.mirror.decoded_scene().map(|decoded| decoded.scene().light);
        let (options, split) = (self.settings.options(light.as_ref()), self.settings.split());
        renderer.set_options(options);
        let Rung { level, resolution } = self.settings.rung();
        renderer.set_level(level);
        let quality = renderer.quality();
        let view = DrawnView { size_px: gpu.next_size_px(quality), stage, quality, level, resolution, options, split };
        (self.drawn_secs, self.moved_at_secs) = (time_secs, now_secs);
        let [right_rad, up_rad] = self.input.take_look(camera_secs);
        rig.look(right_rad, up_rad);
        rig.zoom(self.input.take_zoom());
        let mirror = self.past.as_mut().and_then(Past::mirror_mut).unwrap_or(&mut self.mirror);
        rig.advance(self.input.controls(), vehicle.as_ref(), &self.sight.1, |x_m, z_m| mirror.surface_m(x_m, z_m), camera_secs);
        let camera = rig.camera();
        if !self.redraw.needs_frame(mirror, &camera, view, dt_secs) && !forced && !self.draws_every_frame {
            self.meter.record_skipped();
            self.prediction.drawn(&self.mirror, page::now_secs(&self.window));
            return false;
        }
        let Some(cpu_secs) = gpu.draw(mirror, &camera, &FrameInput { time_secs, dt_secs, resolution, split }) else {
            self.redraw.invalidate();
            return false;
        };
        self.meter.record(now_secs, cpu_secs);
        self.prediction.drawn(&self.mirror, page::now_secs(&self.window));
        let interval_secs = (now_secs - std::mem::replace(&mut self.drawn_at_secs, now_secs)) as f32;
        let work_secs = gpu.gpu_secs().max(cpu_secs) as f32;
        let waited = std::mem::take(&mut self.waited);
        // Until then, frames wait for pipelines.
        if self.times.complete_secs().is_some() {
            self.settings.record(FrameTime { work_secs, interval_secs, waited });
        }
        true
    }

    /// Finds the trees of a new scene.
    fn find_trees(&mut self) {
        let number = self.mirror.scene_number();
        if self.sight.0 != number {
            self.sight = (number, self.mirror.decoded_scene().map(Sight::new).unwrap_or_default());
        }
    }

    /// Draws the newest frame again.
    pub(super) fn redraw(&mut self, now_secs: f64) -> bool {
        self.frame(now_secs, Some(self.drawn_secs), true)
    }

    /// Draws every frame from now on, or only those that differ from the previous one.
    pub(super) fn draw_every_frame(&mut self, enabled: bool) {
        self.draws_every_frame = enabled;
    }

    pub(super) fn is_paused(&self) -> bool {
        self.options.paused
    }

    /// Newest pose of the user's vehicle.
    pub(super) fn own_object(&self) -> Option<&ObjectPose> {
        let own = self.mirror.object_of(self.connection.client()?)?;
        self.mirror.newest_objects().iter().find(|pose| pose.id == own)
    }

    /// Selects a vehicle, or leaves the current one.
    pub(super) fn take(&mut self, vehicle: Option<VehicleKind>) {
        self.go_live();
        self.wanted = vehicle;
        self.prediction.restart();
        self.connection.choose(vehicle);
    }

    pub(super) fn set_height(&mut self, height_m: f32) {
        if let Some(rig) = &mut self.rig {
            rig.set_height(height_m);
        }
    }

    pub(super) fn hold_rise(&mut self, rise: f32) {
        self.input.hold_rise(rise);
    }

    /// Moves the free camera.
    pub(super) fn set_camera(&mut self, camera: Camera) {
        let surface_m = self.mirror.surface_m(camera.eye_m.x, camera.eye_m.z);
        self.rig = Some(Rig::new(camera, surface_m));
    }

    /// Message for the user, while it is to be shown.
    pub(super) fn notice(&self) -> Option<&str> {
        self.notice.as_ref().filter(|(_, until_secs)| page::now_secs(&self.window) < *until_secs).map(|(text, _)| text.as_str())
    }

    /// Radius of the bend field requested from the server (m), limited to what can be drawn.
    fn view_radius_m(&self) -> f32 {
        let drawn_m = self.mirror.decoded_scene().map_or(f32::INFINITY, |decoded| bend_reach_m(decoded.layout()));
        self.settings.quality().bend_radius_m().min(drawn_m)
    }

    pub(super) fn picture_px(&self) -> [u32; 2] {
        self.gpu.as_ref().map_or([0, 0], GpuCanvas::size_px)
    }

    pub(super) fn send_view(&mut self, camera: Camera, now_secs: f64) {
        self.connection.send_view(camera.eye_m, self.view_radius_m(), now_secs);
    }

    pub(super) fn run_clock(&mut self, now_secs: f64) {
        self.mirror.advance((now_secs - self.clock_secs).max(0.0));
        self.clock_secs = now_secs;
    }

    /// Stops the client with a message.
    pub(super) fn fail(&mut self, reason: String) {
        self.failure.get_or_insert(Failure { kind: "failed", reason });
        self.connection.end(Close::BadMessage);
    }

    fn keep_link(&mut self, camera: Camera, now_secs: f64) {
        let (link, at_secs) = &self.link;
        let hash = camera.to_hash();
        if now_secs - at_secs >= LINK_SECS && *link != hash {
            page::set_hash(&self.window, &hash);
            self.link = (hash, now_secs);
        }
    }

    /// Replaces a lost device, unless it is lost again and again.
    fn replace_lost_device(&mut self, now_secs: f64) {
        if let Some(fault) = self.gpu.as_ref().filter(|gpu| gpu.lost().is_none()).and_then(GpuCanvas::fault) {
            self.failure.get_or_insert(Failure { kind: "failed", reason: fault.to_owned() });
        }
        let Some(reason) = self.gpu.as_ref().and_then(GpuCanvas::lost).map(str::to_owned) else { return };
        self.gpu = None;
        self.losses = if now_secs - self.lost_at_secs < LOSS_SECS { self.losses + 1 } else { 1 };
        self.lost_at_secs = now_secs;
        if self.losses > MAX_LOSSES {
            self.failure = Some(Failure { kind: "device-lost", reason });
        } else {
            self.redraw.invalidate();
            self.request_device();
        }
    }
}

/// Parses the start options.
pub(super) fn options(json: &str) -> Result<Options, JsError> {
    serde_json::from_str(json).map_err(|error| JsError::new(&format!("the client's options: {error}")))
}

/// A camera given by a script; `None` unless all numbers are finite.
pub(super) fn camera(eye_m: &[f32], heading_rad: f32, pitch_rad: f32) -> Option<Camera> {
    let eye_m = Vec3::from(<[f32; 3]>::try_from(eye_m).ok()?);
    let limit = crate::camera::PITCH_LIMIT_RAD;
    let camera = Camera { eye_m, heading_rad, pitch_rad: pitch_rad.clamp(-limit, limit), ..Camera::default() };
    (eye_m.is_finite() && heading_rad.is_finite() && pitch_rad.is_finite()).then_some(camera)
}
