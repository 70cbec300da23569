//! The client's own account of itself.

use super::app::App;
use super::connection::Standing;
use crate::rig::Rig;
use serde_json::{Value, json};

impl App {
    /// Everything that the panel shows and a test may ask for. Places in m, angles in rad, times in s unless the name says ms.
    pub(super) fn report(&self) -> Value {
        let parts = [self.of_connection(), self.of_world(), self.of_drawing()];
        parts.into_iter().filter_map(|part| if let Value::Object(part) = part { Some(part) } else { None }).flatten().collect()
    }

    fn of_connection(&self) -> Value {
        let client = self.connection.client();
        json!({
            "connected": client.is_some(),
            "attempts": match self.connection.standing() { Standing::Away { attempts, .. } => attempts, _ => 0 },
            "client": client,
            "bytes_per_s": self.connection.bytes_per_s(),
            "bytes": self.connection.received_bytes(),
            "latency_ms": self.connection.latency_secs().map(|secs| secs * 1e3),
            "notice": self.notice(),
            "error": self.failure.as_ref().map(|failure| &failure.reason),
        })
    }

    fn of_world(&self) -> Value {
        let camera = self.rig.as_ref().map(Rig::camera);
        let own = self.own_object();
        let client = self.connection.client();
        let kind_of = |object| self.mirror.newest_objects().iter().find(|pose| Some(pose.id) == object).map(|pose| pose.kind.name());
        let peers = self.mirror.peers().iter().map(
            |peer| json!({ "client": peer.client, "name": peer.name, "vehicle": kind_of(peer.object), "me": Some(peer.client) == client }),
        );
        json!({
            "peers": peers.collect::<Vec<_>>(),
            "tick": self.mirror.tick(),
            "time_secs": self.mirror.time_secs(),
            "scene_name": self.scene_name,
            "scene": self.mirror.land().map(|land| land.scene().summary.as_str()),
            "extent_m": self.mirror.land().map(|land| land.scene().extent_m()),
            "wanted": self.wanted().map(|kind| kind.name()),
            "object": own.map(|pose| pose.id),
            "vehicle": own.map(|pose| pose.kind.name()),
            "position": own.map(|pose| pose.position_m),
            "velocity": own.map(|pose| pose.velocity_m_per_s),
            "rotation": own.map(|pose| pose.rotation),
            "objects": self.mirror.newest_objects().len(),
            "eye": camera.map(|camera| camera.eye_m.to_array()),
            "heading": camera.map(|camera| camera.heading_rad),
            "pitch": camera.map(|camera| camera.pitch_rad),
            "view": camera.map(|camera| camera.to_hash()),
            "height": camera.map(|camera| camera.eye_m.y - self.mirror.ground_m(camera.eye_m.x, camera.eye_m.z)),
            "patches_known": self.mirror.known_patches(),
            "patches_bent": self.mirror.bent_patches().count(),
        })
    }

    fn of_drawing(&self) -> Value {
        let frame_secs = self.meter.frame_secs();
        json!({
            "frames": self.meter.frames(),
            "frame_ms": frame_secs.map(|secs| secs * 1e3),
            "fps": frame_secs.map(|secs| 1.0 / secs),
            "cpu_ms": self.meter.cpu_secs().map(|secs| secs * 1e3),
            "gpu_ms": self.stage.as_ref().map(|stage| stage.work_secs() * 1e3),
            "resting": self.meter.is_resting(),
            "skipped": self.meter.skipped(),
            "quality": self.fitting_quality().name(),
            "automatic": self.choices.budget().is_some(),
            "budget_ms": self.choices.budget().map(|budget| budget.budget_secs() * 1e3),
            "level": self.choices.level(),
            "order": self.choices.names()[0],
            "far": self.choices.names()[1],
            "hour": self.choices.hour(),
            "compared": self.choices.compared().map(|(ways, _)| ways),
            "at": self.choices.compared().map(|(_, at)| at),
            "fallbacks": self.fallbacks(),
            "picture_px": self.picture_px(),
            "adapter": self.options.adapter,
            "paused": self.is_paused(),
        })
    }
}
