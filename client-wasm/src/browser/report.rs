//! The client's state as JSON, for the page and for tests.

use super::app::App;
use super::connection::ConnectionState;
use super::gpu_canvas::GpuCanvas;
use crate::hearing::{HeardEngine, Hearing, hear};
use crate::rig::Rig;
use crate::state::{DecodedScene, Past};
use prairie_core::race::StartLight;
use serde_json::{Value, json};

impl App {
    /// The whole state. Positions in m, angles in rad, times in s unless the name says ms.
    pub(super) fn report(&self) -> Value {
        let parts = [
            self.connection_report(),
            self.world_report(),
            self.race_report(),
            self.time_report(),
            self.start_report(),
            self.drawing_report(),
        ];
        parts.into_iter().filter_map(|part| if let Value::Object(part) = part { Some(part) } else { None }).flatten().collect()
    }

    /// Sound levels at the camera; null while the client is not connected, has no view yet, or shows a past that stands still.
    pub(super) fn hearing_report(&self) -> Value {
        let is_heard = self.connection.client().is_some() && self.past.as_ref().is_none_or(Past::is_playing);
        let Some(camera) = self.rig.as_ref().map(Rig::camera).filter(|_| is_heard) else { return Value::Null };
        let shown = self.shown();
        let Hearing { wind_m_per_s, rustle, engines } = hear(&camera, shown.heard_objects(), shown);
        let engines = engines.iter().map(|engine| {
            let HeardEngine { object, loudness, pitch_hz, beat_hz, pan } = *engine;
            json!({ "object": object, "loudness": loudness, "pitch_hz": pitch_hz, "beat_hz": beat_hz, "pan": pan })
        });
        json!({ "wind_m_per_s": wind_m_per_s, "rustle": rustle, "engines": engines.collect::<Vec<_>>() })
    }

    fn connection_report(&self) -> Value {
        let client = self.connection.client();
        json!({
            "connected": client.is_some(),
            "attempts": match self.connection.state() { ConnectionState::Connecting { attempts, .. } => attempts, _ => 0 },
            "client": client,
            "bytes_per_s": self.connection.bytes_per_s(),
            "bytes": self.connection.received_bytes(),
            "latency_ms": self.connection.latency_secs().map(|secs| secs * 1e3),
            "predicting": self.prediction.is_predicting(),
            "input_to_picture_ms": self.prediction.latency().to_picture_secs().map(|secs| secs * 1e3),
            "input_to_server_ms": self.prediction.latency().to_server_secs().map(|secs| secs * 1e3),
            "delay_ms": self.mirror.delay_secs() * 1e3,
            "replica": self.mirror.replica().is_some(),
            "replica_share": self.replica_budget.share(),
            "notice": self.notice(),
            "error": self.failure.as_ref().map(|failure| &failure.reason),
        })
    }

    fn world_report(&self) -> Value {
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
            "scene": self.mirror.decoded_scene().map(|decoded| decoded.scene().summary.as_str()),
            "extent_m": self.mirror.decoded_scene().map(|decoded| decoded.scene().extent_m()),
            "wanted": self.wanted.map(|kind| kind.name()),
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

    /// The race; null in a scene without one.
    fn race_report(&self) -> Value {
        let scene = self.mirror.decoded_scene().map(DecodedScene::scene).filter(|scene| !scene.race.gates.is_empty());
        let Some(scene) = scene else { return json!({ "race": null }) };
        let (tick, time_secs) = (self.mirror.tick(), self.mirror.time_secs());
        let light = StartLight::of(scene).map(|light| {
            let until_green_secs = light.until_green(tick) as f32 / scene.tick_hz;
            json!({ "color": light.color(tick).name(), "until_green_secs": until_green_secs })
        });
        let name_of = |client| self.mirror.peers().iter().find(|peer| peer.client == client).map_or("", |peer| peer.name.as_str());
        let standings = self.mirror.standings().iter().map(|standing| {
            json!({
                "client": standing.client,
                "name": name_of(standing.client),
                "me": Some(standing.client) == self.connection.client(),
                "next_gate": standing.next_gate,
                "laps": standing.laps,
                "lap_secs": standing.began_secs.map(|began_secs| (time_secs - began_secs).max(0.0)),
                "false_start": standing.is_false_start,
                "last_secs": standing.last_secs,
                "best_secs": standing.best_secs,
                "race_secs": standing.race_secs,
                "gap_secs": standing.gap_secs,
            })
        });
        let standings: Vec<_> = standings.collect();
        let ghost = self.mirror.ghost_pose().map(|pose| pose.position_m);
        json!({ "race": { "laps": scene.race.laps, "gates": scene.race.gates.len(), "light": light, "standings": standings, "ghost": ghost } })
    }

    fn time_report(&self) -> Value {
        json!({
            "is_live": self.past.is_none(),
            "is_playing": self.past.as_ref().is_none_or(Past::is_playing),
            "recorded_secs": self.recorded_secs(),
            "recorded_bytes": self.record.memory_bytes(),
            "behind_secs": self.behind_secs(),
            "shown_tick": self.shown().tick(),
        })
    }

    fn start_report(&self) -> Value {
        let stages = self.times.drawn().map(|(stage, secs)| (stage.name().to_owned(), json!(secs)));
        json!({
            "first_picture_secs": self.times.first_secs(),
            "complete_picture_secs": self.times.complete_secs(),
            "stage_secs": Value::Object(stages.collect()),
            "complete": self.is_complete(),
        })
    }

    fn drawing_report(&self) -> Value {
        let frame_secs = self.meter.frame_secs();
        json!({
            "frames": self.meter.frames(),
            "frame_ms": frame_secs.map(|secs| secs * 1e3),
            "fps": frame_secs.map(|secs| 1.0 / secs),
            "cpu_ms": self.meter.cpu_secs().map(|secs| secs * 1e3),
            "gpu_ms": self.gpu.as_ref().map(|gpu| gpu.gpu_secs() * 1e3),
            "resting": self.meter.is_idle(),
            "skipped": self.meter.skipped(),
            "quality": self.supported_quality().name(),
            "chosen_quality": self.settings.quality_name(),
            "automatic": self.settings.budget_secs().is_some(),
            "budget_ms": self.settings.budget_secs().map(|budget_secs| budget_secs * 1e3),
            "level": self.settings.rung().level,
            "rendered_px": self.gpu.as_ref().and_then(GpuCanvas::rendered_px),
            "highest_level": self.settings.highest_level(),
            "order": self.settings.option_names()[0],
            "far": self.settings.option_names()[1],
            "raised": self.settings.switches()[0],
            "grids": self.settings.switches()[1],
            "shadows": self.settings.grass_shadows(),
            "hour": self.settings.hour(),
            "scene_hour": self.mirror.decoded_scene().map(|decoded| decoded.scene().light.hour_at(self.mirror.time_secs())),
            "compared": self.settings.compared().map(|(variants, _)| variants),
            "at": self.settings.compared().map(|(_, border)| border),
            "fallbacks": self.fallbacks(),
            "picture_px": self.picture_px(),
            "adapter": self.options.adapter,
            "paused": self.is_paused(),
        })
    }
}
