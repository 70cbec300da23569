//! Sound levels at the camera: loudness and pitch of wind, grass and engines. The page turns them into sound.

use crate::camera::Camera;
use crate::vehicle::{Engine, profile};
use glam::Vec3;
use prairie_core::wire::{ObjectId, ObjectPose};

/// Wind speed (m/s) at which grass rustles loudest.
const LOUD_WIND_M_PER_S: f32 = 15.0;
/// Height above the ground (m) at which the rustling of the grass below is quieter by the factor e.
const RUSTLE_HEIGHT_M: f32 = 8.0;
/// Speed (m/s) at which an object in the grass is loudest, and an engine loudest.
const LOUD_SPEED_M_PER_S: f32 = 12.0;
/// Bending angle (rad) from which grass counts as fully touched.
const TOUCHED_RAD: f32 = 0.8;
/// Distance (m) at which a source is half as loud.
const HALF_M: f32 = 12.0;
/// Loudness of an engine at rest, relative to full speed.
const IDLE_LOUDNESS: f32 = 0.35;
/// Quietest engine that is heard.
const QUIETEST: f32 = 0.01;
/// Largest number of engines heard at once, the loudest first.
pub const ENGINE_LIMIT: usize = 4;

/// Sound levels at the camera. Loudness is 0 (silent) to 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hearing {
    /// Speed of the wind at the camera (m/s).
    pub wind_m_per_s: f32,
    /// Loudness of the grass, rustling in the wind and touched by objects.
    pub rustle: f32,
    /// The loudest engines, loudest first.
    pub engines: Vec<HeardEngine>,
}

/// An engine that is heard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeardEngine {
    /// The object that has it.
    pub object: ObjectId,
    /// Loudness.
    pub loudness: f32,
    /// Pitch (Hz).
    pub pitch_hz: f32,
    /// Beats of the rotor (Hz); 0 for none.
    pub beat_hz: f32,
    /// Direction, −1 (left) to 1 (right).
    pub pan: f32,
}

/// Fields around the camera.
pub trait Air {
    /// Wind at a point (m/s).
    fn wind(&self, at_m: Vec3) -> Vec3;
    /// Bending angle of the grass at `(x_m, z_m)` (rad).
    fn bend_rad(&self, x_m: f32, z_m: f32) -> f32;
    /// Elevation of the ground at `(x_m, z_m)` (m).
    fn ground_m(&self, x_m: f32, z_m: f32) -> f32;
}

impl Air for crate::state::Mirror {
    fn wind(&self, at_m: Vec3) -> Vec3 {
        self.wind_at(at_m)
    }

    fn bend_rad(&self, x_m: f32, z_m: f32) -> f32 {
        self.theta_at(x_m, z_m)
    }

    fn ground_m(&self, x_m: f32, z_m: f32) -> f32 {
        Self::ground_m(self, x_m, z_m)
    }
}

/// Sound levels at `camera` among `objects`.
pub fn hear(camera: &Camera, objects: impl IntoIterator<Item = ObjectPose>, air: &impl Air) -> Hearing {
    let eye_m = camera.eye_m;
    let wind_m_per_s = air.wind(eye_m).length();
    let height_m = (eye_m.y - air.ground_m(eye_m.x, eye_m.z)).max(0.0);
    let mut rustle = (wind_m_per_s / LOUD_WIND_M_PER_S).min(1.0) * (-height_m / RUSTLE_HEIGHT_M).exp();
    let mut engines = Vec::new();
    for pose in objects {
        let to = Vec3::from_array(pose.position_m) - eye_m;
        let nearness = 1.0 / (1.0 + (to.length() / HALF_M).powi(2));
        let speed_m_per_s = Vec3::from_array(pose.velocity_m_per_s).length();
        let effort = (speed_m_per_s / LOUD_SPEED_M_PER_S).min(1.0);
        let touch = (air.bend_rad(pose.position_m[0], pose.position_m[2]) / TOUCHED_RAD).clamp(0.0, 1.0);
        rustle += nearness * effort * touch;
        if let Some(Engine { idle_hz, hz_per_m_per_s, beat_hz }) = profile(pose.kind).engine {
            engines.push(HeardEngine {
                object: pose.id,
                loudness: nearness * (IDLE_LOUDNESS + (1.0 - IDLE_LOUDNESS) * effort),
                pitch_hz: idle_hz + hz_per_m_per_s * speed_m_per_s,
                beat_hz,
                pan: to.normalize_or_zero().dot(camera.right()),
            });
        }
    }
    engines.retain(|engine| engine.loudness >= QUIETEST);
    engines.sort_by(|a, b| b.loudness.total_cmp(&a.loudness).then(a.object.cmp(&b.object)));
    engines.truncate(ENGINE_LIMIT);
    Hearing { wind_m_per_s, rustle: rustle.min(1.0), engines }
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::scene::VehicleKind;

    /// Flat land in a constant wind, whose grass has one bending angle.
    struct Plain {
        wind_m_per_s: f32,
        bend_rad: f32,
    }

    impl Air for Plain {
        fn wind(&self, _: Vec3) -> Vec3 {
            Vec3::X * self.wind_m_per_s
        }

        fn bend_rad(&self, _: f32, _: f32) -> f32 {
            self.bend_rad
        }

        fn ground_m(&self, _: f32, _: f32) -> f32 {
            0.0
        }
    }

    const CALM: Plain = Plain { wind_m_per_s: 0.0, bend_rad: 0.0 };

    fn pose(id: ObjectId, kind: VehicleKind, east_m: f32, speed_m_per_s: f32) -> ObjectPose {
        let (position_m, velocity_m_per_s) = ([east_m, 0.0, 0.0], [0.0, 0.0, speed_m_per_s]);
        ObjectPose { id, kind, position_m, rotation: [0.0, 0.0, 0.0, 1.0], velocity_m_per_s, part_rad: 0.0 }
    }

    #[test]
    fn the_wind_is_heard_as_it_is_and_the_grass_only_near_the_ground() {
        let at = |height_m, wind_m_per_s| {
            let camera = Camera { eye_m: Vec3::Y * height_m, ..Camera::default() };
            hear(&camera, [], &Plain { wind_m_per_s, ..CALM })
        };
        assert_eq!(at(2.0, 0.0), Hearing::default());
        assert_eq!(at(2.0, 7.0).wind_m_per_s, 7.0);
        assert!(at(2.0, 7.0).rustle > 0.2 && at(2.0, 12.0).rustle > at(2.0, 7.0).rustle);
        assert!(at(40.0, 7.0).rustle < 0.01);
    }

    #[test]
    fn an_engine_is_louder_and_higher_when_fast_and_louder_when_near() {
        let camera = Camera::default();
        let engine = |east_m, speed| hear(&camera, [pose(1, VehicleKind::Car, east_m, speed)], &CALM).engines[0];
        let (idle, fast, far) = (engine(8.0, 0.0), engine(8.0, 10.0), engine(40.0, 0.0));
        assert!(fast.loudness > 1.5 * idle.loudness && fast.pitch_hz > idle.pitch_hz + 20.0, "{idle:?} {fast:?}");
        assert!(far.loudness < 0.3 * idle.loudness && far.loudness > 0.0, "{idle:?} {far:?}");
        assert!(idle.pan > 0.9 && engine(-8.0, 0.0).pan < -0.9, "a camera that looks north has east on its right");
        assert!(hear(&camera, [pose(1, VehicleKind::Ball, 3.0, 5.0)], &CALM).engines.is_empty(), "a ball has no engine");
    }

    #[test]
    fn grass_rustles_where_an_object_moves_through_it() {
        let rustle =
            |speed, bend_rad| hear(&Camera::default(), [pose(1, VehicleKind::Sled, 4.0, speed)], &Plain { bend_rad, ..CALM }).rustle;
        assert!(rustle(6.0, 1.0) > 0.3);
        assert_eq!([rustle(0.0, 1.0), rustle(6.0, 0.0)], [0.0; 2]);
        assert_eq!(rustle(1e6, 1e6), 1.0 / (1.0 + (Vec3::new(4.0, -2.0, 0.0).length() / HALF_M).powi(2)));
    }

    #[test]
    fn only_the_loudest_engines_are_heard() {
        let cars = (0..20).map(|n| pose(n, VehicleKind::Car, 5.0 + 4.0 * n as f32, 3.0)).rev();
        let heard = hear(&Camera::default(), cars, &CALM).engines;
        assert_eq!(heard.iter().map(|engine| engine.object).collect::<Vec<_>>(), [0, 1, 2, 3]);
        assert!(hear(&Camera::default(), [pose(1, VehicleKind::Car, 2000.0, 3.0)], &CALM).engines.is_empty());
    }
}
