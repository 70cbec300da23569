//! Prediction of the client's own vehicle: what its driver does is seen at once, not after the way to the server and back.
//!
//! A [`LoneVehicle`](prairie_vehicles::LoneVehicle) does the server's own step. With each frame it goes on from the newest pose of the server, and repeats the inputs that are not in
//! this pose yet, up to the step in which an input given now would have effect. The difference from the picture before fades, so nothing jumps. All other objects are
//! interpolated between poses of the server.

mod correction;
mod inputs;
mod latency;
mod predicted;
mod present;
mod recent;

pub use latency::Latency;

use crate::state::Mirror;
use correction::Correction;
use inputs::SentInputs;
use prairie_core::wire::{AppliedInput, Drive, ObjectId, ObjectPose};
use predicted::Predicted;
use present::Present;

/// Longest time that is predicted (s). With a longer way to the server and back, the own vehicle is interpolated like all others.
pub const PREDICTED_SECS: f64 = 0.5;
/// Part of it that is left for the time between two frames (s).
const FRAME_SECS: f64 = 0.1;

/// The own vehicle of a client, predicted or not, and its inputs on their way.
#[derive(Debug)]
pub struct Prediction {
    is_enabled: bool,
    inputs: SentInputs,
    present: Present,
    predicted: Option<Predicted>,
    correction: Correction,
    latency: Latency,
    /// The newest input known to be applied.
    applied: Option<AppliedInput>,
    /// Time of the newest picture (s), and the pose in it.
    shown: Option<(f64, ObjectPose)>,
}

impl Prediction {
    /// No vehicle yet; `is_enabled`: whether it will be predicted.
    pub fn new(is_enabled: bool) -> Self {
        Self {
            is_enabled,
            inputs: SentInputs::default(),
            present: Present::default(),
            predicted: None,
            correction: Correction::default(),
            latency: Latency::default(),
            applied: None,
            shown: None,
        }
    }

    /// Predicts from now on, or shows the own vehicle as the server has it.
    pub fn enable(&mut self, is_enabled: bool) {
        self.is_enabled = is_enabled;
    }

    /// Whether the newest picture shows a prediction.
    pub fn is_predicting(&self) -> bool {
        self.predicted.is_some()
    }

    /// Moment of the prediction in the newest picture (steps of the world, with fractions); `None` while nothing is predicted.
    pub fn shown_ticks(&self) -> Option<f64> {
        self.predicted.as_ref().map(Predicted::shown_ticks)
    }

    /// Times from inputs to their effects.
    pub fn latency(&self) -> &Latency {
        &self.latency
    }

    /// Notes the round-trip time of a ping (s), from which the way to the server is estimated until an input is known to be applied.
    pub fn note_round_trip(&mut self, secs: f64) {
        self.present.note_round_trip(secs);
    }

    /// Forgets the inputs on their way: for another vehicle or another connection.
    pub fn restart(&mut self) {
        self.inputs.clear();
        self.latency.clear();
        (self.predicted, self.applied, self.shown) = (None, None, None);
        self.correction = Correction::default();
    }

    /// Notes an input that is sent now, caused by an event at `event_secs`. Returns its number.
    pub fn send(&mut self, drive: Drive, mirror: &Mirror, event_secs: f64) -> u32 {
        let fresh_ticks = fresh_ticks(mirror).unwrap_or_default();
        let number = self.inputs.send(drive, fresh_ticks, self.present.next_tick());
        self.latency.send(number, event_secs, self.inputs.newest_tick());
        number
    }

    /// Takes in a complete frame at `now_secs`.
    pub fn receive(&mut self, mirror: &Mirror, now_secs: f64) {
        let Some(applied) = mirror.applied_input().filter(|applied| self.applied != Some(*applied)) else { return };
        self.applied = Some(applied);
        if let Some(input) = self.inputs.acknowledge(applied.number) {
            self.present.note_applied(applied.tick, input.fresh_ticks);
            self.latency.acknowledge(applied, now_secs);
        }
    }

    /// The pose of the own vehicle for a picture at `now_secs`; `None` without a vehicle.
    pub fn pose(&mut self, mirror: &Mirror, own: Option<ObjectId>, now_secs: f64) -> Option<ObjectPose> {
        let dt_secs = self.shown.map_or(0.0, |(shown_secs, _)| (now_secs - shown_secs).max(0.0));
        if let Some(fresh_ticks) = fresh_ticks(mirror) {
            self.present.advance(now_secs, f64::from(mirror.tick_hz()), fresh_ticks);
        }
        self.correction.decay(dt_secs as f32);
        let Some(interpolated) = own.and_then(|own| mirror.interpolated(own)) else {
            (self.predicted, self.shown) = (None, None);
            self.correction = Correction::default();
            return None;
        };
        let was_predicted = self.predicted.is_some();
        let (pose, before) = match self.predict(mirror, interpolated.id) {
            Some((pose, before)) => (pose, before),
            None => {
                self.predicted = None;
                (interpolated, None)
            }
        };
        // The pose without this frame: the old prediction, or else the picture before, moved on.
        let has_changed = was_predicted != self.predicted.is_some();
        let moved_on = self.shown.filter(|(_, shown)| has_changed && shown.id == pose.id);
        if let Some((_, shown)) = moved_on {
            self.correction = Correction::between(&moved(&shown, dt_secs as f32), &pose);
        } else if let Some(before) = before {
            self.correction.add(&before, &pose);
        }
        let pose = self.correction.applied(&pose);
        self.shown = Some((now_secs, pose));
        Some(pose)
    }

    /// Notes that the poses of the newest call of [`pose`](Self::pose), and otherwise of the mirror, were drawn at `now_secs`.
    pub fn drawn(&mut self, mirror: &Mirror, now_secs: f64) {
        let predicted = self.shown_ticks();
        let interpolated = mirror.shown_secs() * f64::from(mirror.tick_hz());
        self.latency.draw(predicted, interpolated, now_secs);
    }

    /// Predicted pose of the present, and what it would be without a frame that has arrived since the last call.
    fn predict(&mut self, mirror: &Mirror, own: ObjectId) -> Option<(ObjectPose, Option<ObjectPose>)> {
        let hz = f64::from(mirror.tick_hz());
        let cap_ticks = PREDICTED_SECS * hz;
        if !self.is_enabled || self.present.lead_ticks(hz) > cap_ticks - FRAME_SECS * hz {
            return None;
        }
        let now_ticks = self.present.ticks()?;
        let scene = mirror.scene_number();
        let Some(predicted) = self.predicted.as_mut().filter(|predicted| predicted.is_of(own, scene)) else {
            let seen = mirror.newest_motion(own)?;
            let mut predicted = Predicted::new(own, scene, mirror.decoded_scene()?.lone_vehicle(seen.kind));
            predicted.restart_from(&seen, &self.inputs, now_ticks);
            predicted.advance(now_ticks, cap_ticks, &self.inputs, mirror);
            return Some((self.predicted.insert(predicted).pose(), None));
        };
        predicted.advance(now_ticks, cap_ticks, &self.inputs, mirror);
        let pose = predicted.pose();
        let Some(seen) = mirror.newest_motion(own).filter(|seen| seen.tick != predicted.seen_tick()) else { return Some((pose, None)) };
        predicted.restart_from(&seen, &self.inputs, now_ticks);
        predicted.advance(now_ticks, cap_ticks, &self.inputs, mirror);
        Some((predicted.pose(), Some(pose)))
    }
}

/// Simulated time of a frame that would arrive now by the fastest way (ticks).
fn fresh_ticks(mirror: &Mirror) -> Option<f64> {
    Some(mirror.fresh_secs()? * f64::from(mirror.tick_hz()))
}

/// The pose after some time at the same velocity.
fn moved(pose: &ObjectPose, secs: f32) -> ObjectPose {
    let position_m = [0, 1, 2].map(|axis| pose.position_m[axis] + pose.velocity_m_per_s[axis] * secs);
    ObjectPose { position_m, ..*pose }
}
