//! The race: standings, the own next gate, and the ghost of the fastest lap beside the own running one.

use super::check::check_standings;
use super::error::{MirrorError, range};
use super::mirror::{Event, Mirror};
use glam::{Quat, Vec3};
use prairie_core::wire::{Ghost, ObjectId, ObjectPose, ServerMessage, Standing};

/// Number of the ghost among the objects, which no real one has.
const GHOST_ID: ObjectId = ObjectId::MAX;

impl Mirror {
    /// Applies a message about the race; others change nothing.
    ///
    /// # Errors
    /// [`MirrorError`] if it came before the scene, or is out of range.
    pub(super) fn apply_race(&mut self, message: ServerMessage) -> Result<Option<Event>, MirrorError> {
        match message {
            ServerMessage::Race { standings } => {
                let decoded = self.scene.as_ref().ok_or(MirrorError::BeforeScene("race"))?;
                check_standings(&standings, decoded.scene().race.gates.len())?;
                self.standings = standings;
            }
            ServerMessage::Ghost { ghost } => {
                if ghost.as_ref().is_some_and(|ghost| !ghost.is_valid()) {
                    return Err(range("ghost", "out of range", "1 to 2048 poses, and finite times"));
                }
                self.ghost = ghost;
            }
            _ => {}
        }
        Ok(None)
    }

    /// The race, the first in front; empty before somebody has begun a lap.
    pub fn standings(&self) -> &[Standing] {
        &self.standings
    }

    /// Number of the gate that this client has to pass next; `None` without a vehicle or a race.
    pub fn next_gate(&self) -> Option<usize> {
        self.object_of(self.client?)?;
        let own = self.standings.iter().find(|standing| Some(standing.client) == self.client);
        let gate = own.map_or(0, |own| usize::from(own.next_gate));
        (gate < self.decoded_scene()?.scene().race.gates.len()).then_some(gate)
    }

    /// Pose of the ghost: as far into its lap as this client is into its own. `None` if there is none, or no own lap runs, or the ghost has arrived.
    pub fn ghost_pose(&self) -> Option<ObjectPose> {
        let own = self.standings().iter().find(|standing| Some(standing.client) == self.client)?;
        let now_secs = self.fresh_secs().unwrap_or(self.time_secs());
        pose_at(self.ghost.as_ref()?, (now_secs - own.began_secs?) as f32)
    }
}

/// Pose of a ghost at a time (s) after the start of its lap.
fn pose_at(ghost: &Ghost, lap_secs: f32) -> Option<ObjectPose> {
    let place = ((lap_secs - ghost.first_secs) / ghost.period_secs).max(0.0);
    let before = place.floor() as usize;
    let [from, to] = [ghost.poses.get(before)?, ghost.poses.get(before + 1)?].map(|code| code.pose());
    let share = place - place.floor();
    let [from_m, to_m] = [from, to].map(|pose| Vec3::from(pose.position_m));
    let rotation = Quat::from_array(from.rotation).normalize().slerp(Quat::from_array(to.rotation).normalize(), share);
    Some(ObjectPose {
        id: GHOST_ID,
        kind: ghost.kind,
        position_m: from_m.lerp(to_m, share).to_array(),
        rotation: rotation.to_array(),
        velocity_m_per_s: ((to_m - from_m) / ghost.period_secs).to_array(),
        part_rad: 0.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::body::{BodyPose, PoseCode};
    use prairie_core::scene::VehicleKind;

    #[test]
    fn a_ghost_is_between_its_poses_from_the_start_to_the_last() {
        let code = |x: f32| PoseCode::of(&BodyPose { position_m: [x, 1.0, 0.0], ..BodyPose::IDENTITY });
        let poses = [10.0, 12.0, 16.0].map(code).to_vec();
        let ghost = Ghost { client: 1, kind: VehicleKind::Car, lap_secs: 20.0, first_secs: 0.05, period_secs: 0.1, poses };
        let x_m = |secs: f32| pose_at(&ghost, secs).map(|pose| pose.position_m[0]);
        assert_eq!(x_m(0.0), Some(10.0), "at its first pose before the first one");
        assert!((x_m(0.1).unwrap() - 11.0).abs() < 1e-3 && (x_m(0.2).unwrap() - 14.0).abs() < 1e-3, "{:?}", [x_m(0.1), x_m(0.2)]);
        assert_eq!([x_m(0.26), x_m(30.0)], [None; 2], "it has arrived");
        assert_eq!(x_m(f32::NAN), Some(10.0));
        assert!((pose_at(&ghost, 0.2).unwrap().velocity_m_per_s[0] - 40.0).abs() < 1e-2);
    }
}
