//! The two newest poses of every object, and what is shown between them.

use super::{MirrorError, range};
use glam::{Quat, Vec3};
use shared::wire::ObjectPose;

/// Most objects of a pose frame.
pub const OBJECT_LIMIT: usize = 1024;

/// Ticks by which the shown time may lag before it jumps.
const LAG_LIMIT_TICKS: f64 = 60.0;

#[derive(Debug, Default)]
struct Frame {
    tick: u64,
    objects: Vec<ObjectPose>,
}

/// The two newest frames of poses and the shown tick, which runs between them.
#[derive(Debug, Default)]
pub(super) struct PoseFrames {
    before: Option<Frame>,
    newest: Option<Frame>,
    shown_tick: f64,
}

impl PoseFrames {
    pub(super) fn push(&mut self, tick: u64, objects: Vec<ObjectPose>) -> Result<(), MirrorError> {
        if objects.len() > OBJECT_LIMIT {
            return Err(range("number of objects", objects.len(), format!("at most {OBJECT_LIMIT}")));
        }
        if let Some(pose) = objects.iter().find(|pose| !is_sound(pose)) {
            return Err(range("pose", format!("{pose:?}"), "finite numbers within 1e6 and a unit quaternion"));
        }
        match &self.newest {
            Some(newest) if tick == newest.tick => self.newest = Some(Frame { tick, objects }),
            Some(newest) if tick > newest.tick => {
                self.shown_tick = self.shown_tick.clamp(newest.tick as f64 - LAG_LIMIT_TICKS, newest.tick as f64);
                self.before = self.newest.replace(Frame { tick, objects });
            }
            _ => {
                self.shown_tick = tick as f64;
                self.before = None;
                self.newest = Some(Frame { tick, objects });
            }
        }
        Ok(())
    }

    pub(super) fn advance(&mut self, ticks: f64) {
        if let Some(newest) = &self.newest
            && ticks.is_finite()
        {
            let start = self.before.as_ref().map_or(newest.tick, |before| before.tick) as f64;
            self.shown_tick = (self.shown_tick.max(start) + ticks.max(0.0)).min(newest.tick as f64);
        }
    }

    pub(super) fn shown(&self) -> impl Iterator<Item = ObjectPose> + '_ {
        let newest = self.newest.as_ref();
        newest.into_iter().flat_map(move |newest| {
            newest.objects.iter().map(move |pose| {
                let before = self.before.as_ref().and_then(|frame| {
                    let pose = frame.objects.iter().find(|before| before.id == pose.id && before.kind == pose.kind)?;
                    Some((frame.tick, pose))
                });
                match before {
                    Some((tick, before)) => {
                        let span = (newest.tick - tick) as f64;
                        blend(before, pose, ((self.shown_tick - tick as f64) / span).clamp(0.0, 1.0) as f32)
                    }
                    None => *pose,
                }
            })
        })
    }
}

fn is_sound(pose: &ObjectPose) -> bool {
    let numbers = pose.position_m.iter().chain(&pose.velocity_m_per_s).chain([&pose.part_rad]);
    let unit = Quat::from_array(pose.rotation).length_squared();
    numbers.into_iter().all(|value| value.abs() <= 1e6) && (0.9..=1.1).contains(&unit)
}

fn blend(from: &ObjectPose, to: &ObjectPose, share: f32) -> ObjectPose {
    let rotation = Quat::from_array(from.rotation).slerp(Quat::from_array(to.rotation), share).normalize();
    let turn = std::f32::consts::TAU;
    let part_step = (to.part_rad - from.part_rad + 0.5 * turn).rem_euclid(turn) - 0.5 * turn;
    ObjectPose {
        position_m: Vec3::from(from.position_m).lerp(Vec3::from(to.position_m), share).into(),
        rotation: rotation.into(),
        velocity_m_per_s: Vec3::from(from.velocity_m_per_s).lerp(Vec3::from(to.velocity_m_per_s), share).into(),
        part_rad: from.part_rad + part_step * share,
        ..*to
    }
}
