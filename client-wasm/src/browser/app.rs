//! One page's client: what arrives is mirrored, what hands do is sent, and each frame shows where things stand.

use super::choices::{Automatic, Choices};
use super::connection::Connection;
use super::fitting::Fitting;
use super::input::{Input, Wish};
use super::meter::Meter;
use super::socket::SocketEvent;
use super::stage::{Moment, Stage};
use super::{page, with_app};
use crate::budget::FrameTime;
use crate::camera::Camera;
use crate::render::{Look, Quality, Split, bend_reach_m};
use crate::rig::Rig;
use crate::state::{Event, Mirror};
use crate::stillness::Stillness;
use glam::Vec3;
use serde::Deserialize;
use shared::scene::VehicleKind;
use shared::wire::{self, Close, ObjectPose, Refusal, SERVER_MESSAGE_LIMIT, ServerMessage, WireError};
use wasm_bindgen::prelude::*;
use web_sys::{HtmlCanvasElement, Window};

/// Longest time that one frame moves the camera by (s); what lies beyond was a pause, not a frame.
const LONGEST_FRAME_SECS: f64 = 0.25;

/// Time between two changes of the address (s).
const LINK_SECS: f64 = 0.5;

/// How long a refusal stays in sight (s).
const NOTICE_SECS: f64 = 6.0;

/// Losses of the device in a row that are mended without a word.
const LOSSES: u32 = 3;
/// How long a device holds that was not lost in a row with the one before (s).
const HELD_SECS: f64 = 120.0;

/// What the page starts its client with.
#[derive(Debug, Deserialize)]
pub(super) struct Options {
    /// The visitor's name.
    name: String,
    /// How fine the picture is, or `auto`.
    quality: String,
    /// What `auto` means on this device.
    automatic: Automatic,
    /// The scene that the address names, if it names one.
    pub(super) scene: Option<String>,
    /// Draw only when asked to.
    pub(super) paused: bool,
    /// What the browser says of its graphics adapter.
    pub(super) adapter: String,
}

/// Everything behind a page.
pub(super) struct App {
    pub(super) options: Options,
    pub(super) choices: Choices,
    pub(super) mirror: Mirror,
    pub(super) connection: Connection,
    pub(super) rig: Option<Rig>,
    pub(super) meter: Meter,
    pub(super) failure: Option<Failure>,
    pub(super) stillness: Stillness<How>,
    /// Name of the scene that the server runs.
    pub(super) scene_name: Option<String>,
    pub(super) canvas: HtmlCanvasElement,
    pub(super) stage: Option<Stage>,
    pub(super) fitting: Fitting,
    window: Window,
    input: Input,
    keeps_drawing: bool,
    /// Whether the device was behind since the last picture, and when that was drawn (s).
    waited: bool,
    drew_secs: f64,
    pub(super) losses: u32,
    lost_secs: f64,
    wanted: Option<VehicleKind>,
    clock_secs: f64,
    drawn_secs: f64,
    link: (String, f64),
    pub(super) notice: Option<(String, f64)>,
    pub(super) welcomed_once: bool,
    pub(super) told: Option<(&'static str, String)>,
}

/// Why the client stopped.
#[derive(Clone, Debug)]
pub(super) struct Failure {
    /// Message of the page.
    pub(super) kind: &'static str,
    /// What it says below.
    pub(super) reason: String,
}

/// What a frame depends on beside world and camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct How {
    size_px: [u32; 2],
    quality: Quality,
    level: f32,
    look: Look,
    split: Option<Split>,
}

impl App {
    pub(super) fn new(window: Window, canvas: HtmlCanvasElement, options: Options) -> Result<Self, String> {
        let choices = Choices::new(&options.quality, options.automatic)?;
        let input = Input::new(&window, &canvas);
        let connection = Connection::new(page::socket_url(&window)?, options.name.clone(), hear);
        Ok(Self {
            options,
            choices,
            mirror: Mirror::default(),
            connection,
            rig: None,
            meter: Meter::default(),
            failure: None,
            stillness: Stillness::default(),
            scene_name: None,
            canvas,
            stage: None,
            fitting: Fitting::default(),
            window,
            input,
            keeps_drawing: false,
            waited: false,
            drew_secs: 0.0,
            losses: 0,
            lost_secs: 0.0,
            wanted: None,
            clock_secs: 0.0,
            drawn_secs: 0.0,
            link: (String::new(), 0.0),
            notice: None,
            welcomed_once: false,
            told: None,
        })
    }

    /// Does what is due many times a second, whether or not a picture is drawn: reads the hands, speaks to the server, tells the page.
    pub(super) fn tick(&mut self, now_secs: f64) {
        self.input.poll();
        for wish in self.input.take_wishes() {
            match wish {
                Wish::Take(vehicle) => self.take(vehicle),
                Wish::Height(height_m) => self.set_height(height_m),
            }
        }
        self.connection.tick(now_secs);
        if let Some(kind) = self.own_object().map(|pose| pose.kind) {
            self.connection.drive(self.input.controls().drive(kind), now_secs);
        }
        if let Some(camera) = self.rig.as_ref().map(Rig::camera) {
            self.look_from(camera, now_secs);
            self.keep_link(camera, now_secs);
        }
        self.mend_stage(now_secs);
        self.fit_stage();
        self.tell();
    }

    /// Moves the eye on to `time_secs` and draws, unless that would give the last picture again and none `is_wanted`. Returns whether it drew: not while
    /// there is nothing to draw, or the device is behind.
    pub(super) fn frame(&mut self, now_secs: f64, time_secs: f64, is_wanted: bool) -> bool {
        self.run_clock(now_secs);
        let dt_secs = (time_secs - self.drawn_secs).clamp(0.0, LONGEST_FRAME_SECS) as f32;
        let vehicle = self.shown_own_object();
        let (Some(rig), Some(stage)) = (&mut self.rig, &mut self.stage) else { return false };
        if stage.is_busy() {
            self.waited = true;
            return false;
        }
        let Some(renderer) = stage.renderer(&self.mirror) else { return false };
        let light = self.mirror.land().map(|land| land.scene().light);
        let (look, split) = (self.choices.look(light.as_ref()), self.choices.split());
        renderer.set_look(look);
        renderer.set_level(self.choices.level());
        let quality = renderer.quality();
        let how = How { size_px: stage.wanted_size_px(quality), quality, level: self.choices.level(), look, split };
        self.drawn_secs = time_secs;
        let [right_rad, up_rad] = self.input.take_look(dt_secs);
        rig.look(right_rad, up_rad);
        rig.zoom(self.input.take_zoom());
        let mirror = &self.mirror;
        rig.advance(self.input.controls(), vehicle.as_ref(), |x_m, z_m| mirror.ground_m(x_m, z_m), dt_secs);
        let camera = rig.camera();
        if !self.stillness.needs_frame(&self.mirror, &camera, how, dt_secs) && !is_wanted && !self.keeps_drawing {
            self.meter.rested();
            return false;
        }
        let moment = Moment { time_secs, dt_secs, split };
        let Some(cpu_secs) = stage.draw(&mut self.mirror, &camera, &moment) else {
            self.stillness.wake();
            return false;
        };
        self.meter.drew(now_secs, cpu_secs);
        let interval_secs = (now_secs - std::mem::replace(&mut self.drew_secs, now_secs)) as f32;
        let work_secs = stage.work_secs().max(cpu_secs) as f32;
        let waited = std::mem::take(&mut self.waited);
        self.choices.drew(FrameTime { work_secs, interval_secs, waited });
        true
    }

    /// Draws the newest picture again.
    pub(super) fn redraw(&mut self, now_secs: f64) -> bool {
        self.frame(now_secs, self.drawn_secs, true)
    }

    /// Draws every picture from now on, or only those that differ from the last.
    pub(super) fn keep_drawing(&mut self, keeps: bool) {
        self.keeps_drawing = keeps;
    }

    pub(super) fn is_paused(&self) -> bool {
        self.options.paused
    }

    /// What one drives, at its newest pose.
    pub(super) fn own_object(&self) -> Option<&ObjectPose> {
        let own = self.mirror.object_of(self.connection.client()?)?;
        self.mirror.newest_objects().iter().find(|pose| pose.id == own)
    }

    fn shown_own_object(&self) -> Option<ObjectPose> {
        self.mirror.object(self.mirror.object_of(self.connection.client()?)?)
    }

    /// Takes a vehicle, or gives up the one held.
    pub(super) fn take(&mut self, vehicle: Option<VehicleKind>) {
        self.wanted = vehicle;
        self.connection.choose(vehicle);
    }

    pub(super) fn wanted(&self) -> Option<VehicleKind> {
        self.wanted
    }

    pub(super) fn set_height(&mut self, height_m: f32) {
        if let Some(rig) = &mut self.rig {
            rig.set_height(height_m);
        }
    }

    pub(super) fn hold_rise(&mut self, rise: f32) {
        self.input.hold_rise(rise);
    }

    /// Puts the free camera somewhere.
    pub(super) fn look(&mut self, camera: Camera) {
        let ground_m = self.mirror.ground_m(camera.eye_m.x, camera.eye_m.z);
        self.rig = Some(Rig::new(camera, ground_m));
    }

    /// What the visitor should read beside the panel for a while.
    pub(super) fn notice(&self) -> Option<&str> {
        self.notice.as_ref().filter(|(_, until_secs)| page::now_secs(&self.window) < *until_secs).map(|(text, _)| text.as_str())
    }

    /// Distance up to which the bend field is asked for (m): no farther than it can be shown.
    fn view_radius_m(&self) -> f32 {
        let shown_m = self.mirror.land().map_or(f32::INFINITY, |land| bend_reach_m(land.layout()));
        self.choices.quality().bend_radius_m().min(shown_m)
    }

    pub(super) fn picture_px(&self) -> [u32; 2] {
        self.stage.as_ref().map_or([0, 0], Stage::size_px)
    }

    fn hear(&mut self, event: SocketEvent) {
        let now_secs = page::now_secs(&self.window);
        match event {
            SocketEvent::Open => self.connection.opened(),
            SocketEvent::Closed(code) => self.connection.closed(code, now_secs),
            SocketEvent::Message(bytes) => {
                self.connection.received(bytes.len());
                match wire::decode::<ServerMessage>(&bytes, SERVER_MESSAGE_LIMIT) {
                    Ok(message) => self.receive(message, now_secs),
                    Err(WireError::Version { .. }) => self.connection.end(Close::Version),
                    Err(error) => self.fail(format!("The server sent what this page cannot read: {error}.")),
                }
            }
        }
    }

    fn receive(&mut self, message: ServerMessage, now_secs: f64) {
        self.run_clock(now_secs);
        match self.mirror.apply(message) {
            Ok(Some(Event::Welcome { client, scene_name, .. })) => {
                self.connection.welcomed(client);
                self.scene_name = Some(scene_name);
                self.welcomed_once = true;
            }
            Ok(Some(Event::Scene)) => {
                self.settle();
                self.come_back(now_secs);
            }
            Ok(Some(Event::FrameEnd { frame })) => self.connection.acknowledge(frame),
            Ok(Some(Event::Pong { nonce })) => self.connection.ponged(nonce, now_secs),
            Ok(Some(Event::Refused { refusal, reason })) => {
                if refusal == Refusal::ObjectLimit {
                    self.wanted = None;
                }
                self.notice = Some((reason, now_secs + NOTICE_SECS));
            }
            Ok(Some(Event::Roster) | None) => {}
            Err(error) => self.fail(format!("The server sent what this page cannot use: {error}.")),
        }
    }

    /// Finds a place for the eye in a land that has just come: that of the link, or the scene's own.
    fn settle(&mut self) {
        let Some(land) = self.mirror.land().filter(|_| self.rig.is_none() && self.other_scene().is_none()) else { return };
        let linked = self.window.location().hash().ok().and_then(|hash| Camera::from_hash(&hash));
        let ground_m = |x_m: f32, z_m: f32| land.heights().height_m(x_m, z_m);
        let camera = linked.unwrap_or_else(|| Camera::start(&land.scene().camera, land.scene().extent_m(), ground_m));
        self.look(camera);
    }

    /// Takes again what was driven when the connection broke: where the eye is, which the server has to know first.
    fn come_back(&mut self, now_secs: f64) {
        if let Some(camera) = self.rig.as_ref().map(Rig::camera) {
            self.look_from(camera, now_secs);
        }
        if self.wanted.is_some() {
            self.connection.choose(self.wanted);
        }
    }

    fn look_from(&mut self, camera: Camera, now_secs: f64) {
        self.connection.look_from(camera.eye_m, self.view_radius_m(), now_secs);
    }

    fn run_clock(&mut self, now_secs: f64) {
        self.mirror.advance((now_secs - self.clock_secs).max(0.0));
        self.clock_secs = now_secs;
    }

    fn fail(&mut self, reason: String) {
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
    fn mend_stage(&mut self, now_secs: f64) {
        if let Some(fault) = self.stage.as_ref().filter(|stage| stage.lost().is_none()).and_then(Stage::fault) {
            self.failure.get_or_insert(Failure { kind: "failed", reason: fault.to_owned() });
        }
        let Some(reason) = self.stage.as_ref().and_then(Stage::lost).map(str::to_owned) else { return };
        self.stage = None;
        self.losses = if now_secs - self.lost_secs < HELD_SECS { self.losses + 1 } else { 1 };
        self.lost_secs = now_secs;
        if self.losses > LOSSES {
            self.failure = Some(Failure { kind: "device-lost", reason });
        } else {
            self.stillness.wake();
            self.build_stage();
        }
    }
}

fn hear(event: SocketEvent) {
    with_app(|app| app.hear(event));
}

/// Parses what the page starts its client with.
pub(super) fn options(json: &str) -> Result<Options, JsError> {
    serde_json::from_str(json).map_err(|error| JsError::new(&format!("the client's options: {error}")))
}

/// A view given by a script; none unless all its numbers are finite.
pub(super) fn camera(eye_m: &[f32], heading_rad: f32, pitch_rad: f32) -> Option<Camera> {
    let eye_m = Vec3::from(<[f32; 3]>::try_from(eye_m).ok()?);
    let limit = crate::camera::PITCH_LIMIT_RAD;
    let camera = Camera { eye_m, heading_rad, pitch_rad: pitch_rad.clamp(-limit, limit), ..Camera::default() };
    (eye_m.is_finite() && heading_rad.is_finite() && pitch_rad.is_finite()).then_some(camera)
}
