//! Driving of the own vehicle: inputs to the server, and the pose that is shown.

use super::app::App;
use prairie_core::wire::{ObjectId, ObjectPose};

impl App {
    /// Sends the driver's input if it has changed, and has it predicted.
    pub(super) fn drive(&mut self, now_secs: f64) {
        let Some(kind) = self.own_object().map(|pose| pose.kind) else { return };
        let drive = self.input.controls().drive(kind);
        if !self.connection.is_new_drive(drive) {
            return self.input.forget_event();
        }
        let event_secs = self.input.event_secs(now_secs);
        if self.connection.may_drive(now_secs) {
            let number = self.prediction.send(drive, &self.mirror, event_secs);
            self.connection.drive(number, drive, now_secs);
            self.input.forget_event();
        }
    }

    /// Puts the own vehicle at its place in the next picture; returns its pose there. In the past it is where it was.
    pub(super) fn place_own_object(&mut self, now_secs: f64) -> Option<ObjectPose> {
        let own = self.own_object_id();
        let pose = self.prediction.pose(&self.mirror, own, now_secs);
        self.mirror.show_own(pose);
        self.shown().object(own?)
    }

    fn own_object_id(&self) -> Option<ObjectId> {
        self.mirror.object_of(self.connection.client()?)
    }
}
