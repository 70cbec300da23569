//! The predicted vehicle: goes on from the server's newest pose by the inputs on their way.

use super::inputs::SentInputs;
use crate::damped::wrap_angle;
use crate::state::{Mirror, SeenMotion};
use glam::{Quat, Vec3};
use prairie_core::wire::{ObjectId, ObjectPose};
use prairie_vehicles::{LoneVehicle, VehicleMotion};

/// A vehicle and the newest two steps of its prediction.
#[derive(Debug)]
pub(super) struct Predicted {
    id: ObjectId,
    /// Number of the scene in which it is.
    scene: u32,
    vehicle: LoneVehicle,
    /// Step of the server's pose from which it went on last.
    seen_tick: u64,
    /// Step from which its prediction counts, which is later while it stands.
    start_tick: u64,
    /// Whether it stands, and no input has been on its way since the server's pose.
    stands: bool,
    /// Newest predicted step.
    tick: u64,
    /// Motions before and after that step.
    before: VehicleMotion,
    after: VehicleMotion,
    /// Moment shown (steps).
    shown_ticks: f64,
}

impl Predicted {
    pub(super) fn new(id: ObjectId, scene: u32, vehicle: LoneVehicle) -> Self {
        let motion = vehicle.motion();
        let (before, after) = (motion, motion);
        Self { id, scene, vehicle, seen_tick: 0, start_tick: 0, stands: false, tick: 0, before, after, shown_ticks: 0.0 }
    }

    /// Whether it is that of an object in a scene.
    pub(super) fn is_of(&self, id: ObjectId, scene: u32) -> bool {
        (self.id, self.scene) == (id, scene)
    }

    /// Step of the server's pose from which it went on last.
    pub(super) fn seen_tick(&self) -> u64 {
        self.seen_tick
    }

    /// Moment shown (steps).
    pub(super) fn shown_ticks(&self) -> f64 {
        self.shown_ticks
    }

    /// Goes on from a pose of the server. A vehicle at rest stays so until the next input has effect: frames may be a second apart then.
    pub(super) fn restart_from(&mut self, seen: &SeenMotion, inputs: &SentInputs, now_ticks: f64) {
        self.vehicle.assume(&seen.motion);
        let now_tick = step_before(now_ticks);
        let moves_tick = inputs.first_tick().map_or(now_tick, |first| first.saturating_sub(1).min(now_tick));
        (self.seen_tick, self.stands) = (seen.tick, seen.is_at_rest && inputs.first_tick().is_none());
        self.start_tick = if seen.is_at_rest { seen.tick.max(moves_tick) } else { seen.tick };
        self.tick = self.start_tick;
        (self.before, self.after) = (seen.motion, seen.motion);
    }

    /// Goes on to the moment `now_ticks` (steps), but no further than `cap_ticks` from the server's pose.
    pub(super) fn advance(&mut self, now_ticks: f64, cap_ticks: f64, inputs: &SentInputs, mirror: &Mirror) {
        self.stands &= inputs.first_tick().is_none();
        if self.stands {
            // Nothing moves it: no frame comes either.
            self.start_tick = self.start_tick.max(step_before(now_ticks));
            (self.tick, self.shown_ticks) = (self.start_tick, now_ticks);
            return;
        }
        self.shown_ticks = now_ticks.clamp(self.start_tick as f64, self.start_tick as f64 + cap_ticks);
        while (self.tick as f64) < self.shown_ticks {
            self.tick += 1;
            let wind = |at_m: [f32; 3]| mirror.wind_at(Vec3::from_array(at_m)).to_array();
            self.vehicle.step(inputs.drive_in(self.tick), wind);
            self.before = std::mem::replace(&mut self.after, self.vehicle.motion());
        }
    }

    /// The pose at the moment shown, between the newest two steps.
    pub(super) fn pose(&self) -> ObjectPose {
        let s = (1.0 - (self.tick as f64 - self.shown_ticks)).clamp(0.0, 1.0) as f32;
        let (from, to) = (&self.before, &self.after);
        let between = |from: [f32; 3], to: [f32; 3]| Vec3::from_array(from).lerp(Vec3::from_array(to), s).to_array();
        let rotation = Quat::from_array(from.pose.rotation).slerp(Quat::from_array(to.pose.rotation), s).normalize();
        ObjectPose {
            id: self.id,
            kind: self.vehicle.kind(),
            position_m: between(from.pose.position_m, to.pose.position_m),
            rotation: rotation.to_array(),
            velocity_m_per_s: between(from.velocity_m_per_s, to.velocity_m_per_s),
            part_rad: from.part_rad + wrap_angle(to.part_rad - from.part_rad) * s,
        }
    }
}

/// The step at a moment (steps), or the one before it.
fn step_before(ticks: f64) -> u64 {
    ticks.max(0.0).floor() as u64
}
