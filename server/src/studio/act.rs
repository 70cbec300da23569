//! Acts: scripted events on a stage, for pictures and films.

use super::stage::Stage;
use anyhow::{Context as _, Result};
use prairie_core::scene::VehicleKind;
use prairie_core::wire::{Drive, ObjectPose};

/// Time for the wind to build up before an act (s).
const SETTLE_SECS: f32 = 4.0;
/// Time for a new vehicle to come to rest (s).
const DROP_SECS: f32 = 0.5;

/// Events on a stage, in front of its camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Act {
    /// Wind alone.
    Wind,
    /// A car drives a long curve across the view.
    Track,
    /// A helicopter hovers low over the grass.
    Wash,
    /// A monster walks through the grass.
    Walk,
    /// A sled is dragged across the view.
    Drag,
    /// A ball rolls away through the grass.
    Roll,
    /// A walker leaves footprints in the grass.
    Hike,
}

const fn forward(throttle: f32, steer: f32) -> Drive {
    Drive { throttle, steer, lift: 0.0, brake: 0.0 }
}

impl Act {
    /// The vehicle of the act.
    pub fn vehicle(self) -> Option<VehicleKind> {
        match self {
            Self::Wind => None,
            Self::Track => Some(VehicleKind::Car),
            Self::Wash => Some(VehicleKind::Helicopter),
            Self::Walk => Some(VehicleKind::Monster),
            Self::Drag => Some(VehicleKind::Sled),
            Self::Roll => Some(VehicleKind::Ball),
            Self::Hike => Some(VehicleKind::Walker),
        }
    }

    /// The vehicle's controls, each with its duration (s).
    pub fn script(self) -> &'static [(f32, Drive)] {
        const UP: Drive = Drive { lift: 0.5, ..forward(0.0, 0.0) };
        const TRACK: &[(f32, Drive)] = &[(2.2, forward(1.0, 0.0)), (2.6, forward(0.6, 0.45)), (1.2, forward(0.6, -0.3))];
        const WASH: &[(f32, Drive)] = &[(0.8, UP), (3.5, forward(0.0, 0.0))];
        const WALK: &[(f32, Drive)] = &[(4.0, forward(0.7, 0.1))];
        const DRAG: &[(f32, Drive)] = &[(1.8, forward(0.8, 0.0)), (2.4, forward(0.6, 0.7))];
        const ROLL: &[(f32, Drive)] = &[(2.6, forward(1.0, 0.15))];
        const HIKE: &[(f32, Drive)] = &[(4.0, forward(1.0, 0.1))];
        match self {
            Self::Wind => &[],
            Self::Track => TRACK,
            Self::Wash => WASH,
            Self::Walk => WALK,
            Self::Drag => DRAG,
            Self::Roll => ROLL,
            Self::Hike => HIKE,
        }
    }

    /// Duration of the script (s).
    pub fn secs(self) -> f32 {
        self.script().iter().map(|(secs, _)| secs).sum()
    }

    /// Lets the wind build up and puts the vehicle in front of the camera.
    pub fn begin(self, stage: &mut Stage, eye_m: [f32; 3]) {
        stage.look_from(eye_m);
        stage.run(SETTLE_SECS);
        if let Some(kind) = self.vehicle() {
            stage.spawn(1, kind);
            stage.run(DROP_SECS);
        }
    }

    /// Pose of the act's vehicle among the objects of a stage; `None` if the act has none.
    ///
    /// # Errors
    /// When there was no room for the vehicle.
    pub fn pose(self, stage: &Stage, objects: &[ObjectPose]) -> Result<Option<ObjectPose>> {
        let Some(kind) = self.vehicle() else { return Ok(None) };
        let own = stage.world.object_of(1).and_then(|id| objects.iter().find(|pose| pose.id == id));
        own.map(|pose| Some(*pose)).with_context(|| format!("there was no room for the {}", kind.name()))
    }
}

/// Plays an act in front of the camera and shows its end. Returns the pose of the act's vehicle, if it has one.
///
/// # Errors
/// When there is no room for the act's vehicle, or the mirror rejects a message.
pub fn play(stage: &mut Stage, act: Act, eye_m: [f32; 3]) -> Result<Option<ObjectPose>> {
    act.begin(stage, eye_m);
    for &(secs, drive) in act.script() {
        stage.drive(1, drive);
        stage.run(secs);
    }
    let objects = stage.show()?;
    act.pose(stage, &objects)
}
