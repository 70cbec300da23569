//! Handling of socket events and of the server's messages.

use super::app::{App, with_app};
use super::page;
use super::socket::SocketEvent;
use crate::camera::Camera;
use crate::replica_budget::{ReplicaBudget, Wish};
use crate::rig::Rig;
use crate::state::Event;
use prairie_core::wire::{self, Close, Refusal, SERVER_MESSAGE_LIMIT, ServerMessage, WireError};

/// Display time of a refusal (s).
const NOTICE_SECS: f64 = 6.0;

/// Passes a socket event to the page's client.
pub(super) fn handle(event: SocketEvent) {
    with_app(|app| app.handle(event));
}

impl App {
    fn handle(&mut self, event: SocketEvent) {
        let now_secs = page::now_secs(&self.window);
        match event {
            SocketEvent::Open => self.connection.opened(),
            SocketEvent::Closed(code) => self.connection.closed(code, now_secs),
            SocketEvent::Message(bytes) => {
                self.connection.received(bytes.len());
                match wire::decode::<ServerMessage>(&bytes, SERVER_MESSAGE_LIMIT) {
                    Ok(message) => self.receive(message, now_secs),
                    Err(WireError::Version { .. }) => self.connection.end(Close::Version),
                    Err(error) => self.fail(format!("A message from the server could not be decoded: {error}.")),
                }
            }
        }
    }

    fn receive(&mut self, message: ServerMessage, now_secs: f64) {
        self.run_clock(now_secs);
        let applied = self.record.apply(&mut self.mirror, message);
        self.measure_replica(now_secs);
        match applied {
            Ok(Some(Event::Welcome { client, proof, scene_name, .. })) => {
                self.follow_scene(&scene_name);
                self.connection.welcomed(client, proof);
                self.prediction.restart();
                self.scene_name = Some(scene_name);
                self.was_welcomed = true;
            }
            Ok(Some(Event::Scene)) => {
                self.replica_budget = ReplicaBudget::default();
                self.connection.replicate(true);
                self.place_camera();
                self.resume(now_secs);
            }
            Ok(Some(Event::FrameEnd { frame })) => {
                self.connection.acknowledge(frame);
                self.prediction.receive(&self.mirror, now_secs);
                if let Some((tick, patch)) = self.mirror.take_difference() {
                    self.connection.report_difference(tick, patch);
                }
            }
            Ok(Some(Event::Pong { nonce })) => {
                self.connection.ponged(nonce, now_secs);
                if let Some(secs) = self.connection.latency_secs() {
                    self.prediction.note_round_trip(secs);
                }
            }
            Ok(Some(Event::Refused { refusal, reason })) => {
                if refusal == Refusal::ObjectLimit {
                    self.wanted = None;
                }
                self.notice = Some((reason, now_secs + NOTICE_SECS));
            }
            Ok(Some(Event::Roster) | None) => {}
            Err(error) => self.fail(format!("A message from the server is invalid: {error}.")),
        }
    }

    /// Measures the work of a message for the replica of the grass, and gives the replica up if it is too much.
    fn measure_replica(&mut self, began_secs: f64) {
        if self.mirror.replica().is_none() {
            return;
        }
        let now_secs = page::now_secs(&self.window);
        if self.replica_budget.record(now_secs, now_secs - began_secs) == Some(Wish::Patches) {
            self.connection.replicate(false);
        }
    }

    /// Goes along when the server changes to another scene: the link and the vehicle belonged to the one before.
    fn follow_scene(&mut self, scene_name: &str) {
        if self.scene_name.as_deref().is_some_and(|before| before != scene_name) && self.other_scene().is_none() {
            self.options.scene = None;
            self.wanted = None;
            self.starts_anew = true;
            self.go_live();
        }
    }

    /// Places the camera in a newly received scene: at the view in the address, or at the scene's start view.
    fn place_camera(&mut self) {
        let is_due = (self.rig.is_none() || self.starts_anew) && self.other_scene().is_none();
        let Some(decoded) = self.mirror.decoded_scene().filter(|_| is_due) else { return };
        let hash = self.window.location().hash().ok().filter(|_| !self.starts_anew);
        let linked = hash.and_then(|hash| Camera::from_hash(&hash));
        let ground_m = |x_m: f32, z_m: f32| decoded.heights().height_m(x_m, z_m);
        let camera = linked.unwrap_or_else(|| Camera::start(&decoded.scene().camera, decoded.scene().extent_m(), ground_m));
        self.set_camera(camera);
        self.starts_anew = false;
    }

    /// Resumes after a reconnection: sends the camera position, which the server must know first, and takes the same kind of vehicle again unless its own was kept.
    fn resume(&mut self, now_secs: f64) {
        if let Some(camera) = self.rig.as_ref().map(Rig::camera) {
            self.send_view(camera, now_secs);
        }
        if self.wanted.is_some() && !self.connection.is_back() {
            self.prediction.restart();
            self.connection.choose(self.wanted);
        }
    }
}
