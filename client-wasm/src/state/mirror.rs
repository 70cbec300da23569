//! The mirror itself: applies messages, and answers the renderer.

use super::broken_plants::BrokenPlants;
use super::error::{MirrorError, range};
use super::fields::{PatchCodes, PatchFields, ShownWind, WindCodes, WindFrames, WindHeader};
use super::following::{Following, Part};
use super::playback::Playback;
use super::scene::DecodedScene;
use prairie_core::grass::{EncodedSteps, Replica};
use prairie_core::grid::PatchIndex;
use prairie_core::scene::Scene;
use prairie_core::wind::WindField;
use prairie_core::wire::{ObjectId, ObjectPose, PROOF_BYTES, Peer, Refusal, ServerMessage};
use std::sync::Arc;

/// Maximum number of peers stored; the server's list is truncated to it.
pub const PEER_LIMIT: usize = 4096;

/// Delay of the wind behind the objects shown (s): that of a frame, so that a next one to interpolate towards is usually there.
pub const WIND_DELAY_SECS: f64 = 1.0 / 6.0;

/// Event for the page, caused by a message.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// The server accepted the client.
    Welcome {
        /// Number that identifies this client.
        client: u32,
        /// Proof of the number, for a return.
        proof: [u8; PROOF_BYTES],
        /// Version of the server's package.
        server_version: String,
        /// Name of the scene that the server runs.
        scene_name: String,
    },
    /// A new scene arrived; the renderer must load it.
    Scene,
    /// A frame is complete and must be acknowledged.
    FrameEnd {
        /// Frame number.
        frame: u32,
    },
    /// The list of peers changed.
    Roster,
    /// A request was refused, or the connection is about to close.
    Refused {
        /// Machine-readable reason.
        refusal: Refusal,
        /// Explanation for the user.
        reason: String,
    },
    /// Response to a ping.
    Pong {
        /// Nonce of that ping.
        nonce: u32,
    },
}

/// The client's copy of the server's world.
#[derive(Debug, Default)]
pub struct Mirror {
    pub(super) scene: Option<Arc<DecodedScene>>,
    pub(super) scene_number: u32,
    pub(super) patches: PatchFields,
    pub(super) following: Following,
    pub(super) wind: WindFrames,
    pub(super) wind_field: Option<WindField>,
    pub(super) poses: Playback,
    pub(super) broken: BrokenPlants,
    pub(super) peers: Vec<Peer>,
    pub(super) tick: u64,
    pub(super) time_secs: f64,
}

impl Mirror {
    /// Applies a message. A delta whose base is missing is dropped, without an error, until the next key frame.
    ///
    /// # Errors
    /// [`MirrorError`] if the message is malformed or out of range.
    pub fn apply(&mut self, message: ServerMessage) -> Result<Option<Event>, MirrorError> {
        Ok(match message {
            ServerMessage::Welcome { client, proof, server_version, scene_name } => {
                Some(Event::Welcome { client, proof, server_version, scene_name })
            }
            ServerMessage::Scene { scene, height_png, covering_png, nutrient_png, models, shapes } => {
                self.load(DecodedScene::new(*scene, &height_png, &covering_png, &nutrient_png, models, shapes)?);
                Some(Event::Scene)
            }
            ServerMessage::Poses { tick, objects } => {
                self.following.stop();
                self.poses.push(self.secs_of(tick), objects)?;
                None
            }
            ServerMessage::Wind { tick, seq, key, turbulence, payload } => {
                let decoded = self.scene.as_ref().ok_or(MirrorError::BeforeScene("wind frame"))?;
                let is_new = self.wind.apply(&decoded.scene().wind, WindHeader { tick, seq, key, turbulence }, &payload)?;
                if let (true, Some(field), Some(newest)) = (is_new, &mut self.wind_field, self.wind.newest()) {
                    field.set(newest.codes(), newest.turbulence());
                }
                None
            }
            ServerMessage::Patch { patch, seq, key, payload } => {
                let decoded = self.scene.as_ref().ok_or(MirrorError::BeforeScene("patch frame"))?;
                self.patches.apply(decoded.layout(), patch, seq, key, &payload)?;
                None
            }
            ServerMessage::ReplicaState { tick, part, parts, payload } => {
                let decoded = self.scene.as_ref().ok_or(MirrorError::BeforeScene("replica's state"))?;
                self.following.receive(Part { tick, part, parts, payload }, decoded)?;
                None
            }
            ServerMessage::Steps { first_tick, steps: heads, moves } => {
                self.following.advance(EncodedSteps { first_tick, heads, moves }, &self.wind)?;
                None
            }
            ServerMessage::Roster { mut peers } => {
                peers.truncate(PEER_LIMIT);
                self.peers = peers;
                Some(Event::Roster)
            }
            ServerMessage::Broken { plants } => {
                self.broken.record(&plants)?;
                None
            }
            ServerMessage::FrameEnd { frame, tick, time_secs } => {
                self.end_frame(tick, time_secs)?;
                self.following.show(&mut self.patches);
                Some(Event::FrameEnd { frame })
            }
            ServerMessage::Refused { refusal, reason } => Some(Event::Refused { refusal, reason }),
            ServerMessage::Pong { nonce } => Some(Event::Pong { nonce }),
        })
    }

    /// Begins with another scene, at rest.
    fn load(&mut self, decoded: DecodedScene) {
        self.broken = BrokenPlants::new(decoded.flora().map_or(0, |flora| flora.grown().sites.total()));
        self.wind_field = Some(decoded.still_air());
        self.scene = Some(Arc::new(decoded));
        self.scene_number = self.scene_number.wrapping_add(1);
        self.patches = PatchFields::default();
        self.following = Following::default();
        self.wind = WindFrames::default();
        self.poses = Playback::default();
    }

    /// Completes the frame of step `tick`. The patches of a replica are not shown yet.
    pub(super) fn end_frame(&mut self, tick: u64, time_secs: f64) -> Result<(), MirrorError> {
        if !time_secs.is_finite() {
            return Err(range("time_secs", time_secs, "a finite number"));
        }
        self.following.rest_until(tick, &self.wind)?;
        if let Some(objects) = self.following.objects() {
            self.poses.push(self.secs_of(tick), objects)?;
        }
        (self.tick, self.time_secs) = (tick, time_secs);
        Ok(())
    }

    /// Time of playback of a step (s).
    pub(super) fn secs_of(&self, tick: u64) -> f64 {
        tick as f64 / f64::from(self.tick_hz())
    }

    /// Advances the client's clock by `dt_secs`, so that objects move on.
    pub fn advance(&mut self, dt_secs: f64) {
        self.poses.advance(dt_secs);
    }

    pub(super) fn tick_hz(&self) -> f32 {
        self.scene.as_ref().map_or(60.0, |decoded| decoded.scene().tick_hz)
    }

    /// The scene with its decoded maps; `None` before it has arrived.
    pub fn decoded_scene(&self) -> Option<&DecodedScene> {
        self.scene.as_deref()
    }

    /// Number of scenes received so far. When it changes, the renderer must reload the scene.
    pub fn scene_number(&self) -> u32 {
        self.scene_number
    }

    /// Interpolated poses of all objects, about 0.1 s behind the server.
    pub fn objects(&self) -> impl Iterator<Item = ObjectPose> + use<> {
        self.poses.interpolated().into_iter()
    }

    /// Interpolated pose of one object.
    pub fn object(&self, id: ObjectId) -> Option<ObjectPose> {
        self.objects().find(|pose| pose.id == id)
    }

    /// Newest received poses of all objects.
    pub fn newest_objects(&self) -> &[ObjectPose] {
        self.poses.newest()
    }

    /// All connected clients.
    pub fn peers(&self) -> &[Peer] {
        &self.peers
    }

    /// Object driven by a client.
    pub fn object_of(&self, client: u32) -> Option<ObjectId> {
        self.peers.iter().find(|peer| peer.client == client)?.object
    }

    /// World step of the newest complete frame.
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// Simulated time of the newest complete frame (s).
    pub fn time_secs(&self) -> f64 {
        self.time_secs
    }

    /// The replica of the server's grass; `None` while the client gets patches.
    pub fn replica(&self) -> Option<&Replica> {
        self.following.replica()
    }

    /// Tick after which the replica was found to differ from the server's grass since the last call, and a patch that differs. The replica has ended with it.
    pub fn take_difference(&mut self) -> Option<(u64, PatchIndex)> {
        self.following.take_difference()
    }

    /// Codes of a patch; `None` if it is at rest or unknown.
    pub fn patch(&self, patch: PatchIndex) -> Option<&PatchCodes> {
        self.patches.codes(patch)
    }

    /// Patches that are not at rest.
    pub fn bent_patches(&self) -> impl Iterator<Item = PatchIndex> + '_ {
        self.patches.bent()
    }

    /// Number of patches received, bent or at rest.
    pub fn known_patches(&self) -> usize {
        self.patches.known()
    }

    /// Patches changed since the previous call.
    pub fn take_dirty_patches(&mut self) -> Vec<PatchIndex> {
        self.patches.take_dirty()
    }

    /// Marks all bent patches as changed, for a renderer that has drawn another mirror in between.
    pub fn touch_patches(&mut self) {
        self.patches.touch();
    }

    /// Whether any patch changed since [`take_dirty_patches`](Self::take_dirty_patches).
    pub fn has_dirty_patches(&self) -> bool {
        self.patches.has_dirty()
    }

    /// Whether nothing moves by itself: no wind, rain, dust or moving sun. True before the scene has arrived.
    pub fn is_calm(&self) -> bool {
        let scene_is_calm = self.scene.as_ref().is_none_or(|decoded| {
            let Scene { wind, rain, light, .. } = decoded.scene();
            wind.mean_m_per_s == [0.0; 2] && rain.rate_mm_per_h <= 0.0 && light.day_length_secs <= 0.0
        });
        scene_is_calm && self.wind().is_none_or(WindCodes::is_calm)
    }

    /// Direction in which the plant of each underbrush site fell, as a [heading code](prairie_core::wire::quantise::heading_code); 0 for an unbroken plant.
    /// Padded with zeros to a multiple of four bytes.
    pub fn falls(&self) -> &[u8] {
        self.broken.falls()
    }

    /// Number of broken plants. Broken plants never heal, so it only grows until the next scene.
    pub fn broken_count(&self) -> u32 {
        self.broken.count()
    }

    /// Newest wind frame.
    pub fn wind(&self) -> Option<&WindCodes> {
        self.wind.newest()
    }

    /// The wind of the newest frame at any place; `None` before the scene has arrived, still before the first frame.
    pub fn wind_field(&self) -> Option<&WindField> {
        self.wind_field.as_ref()
    }

    /// The wind to show at simulated time `time_secs`: that of [`WIND_DELAY_SECS`] before, between two frames. `None` before the first frame.
    pub fn shown_wind(&self, time_secs: f64) -> Option<ShownWind<'_>> {
        self.wind.at((time_secs - WIND_DELAY_SECS) * f64::from(self.tick_hz()))
    }

    /// Simulated time that is shown now (s), about 0.1 s behind the server.
    pub fn shown_secs(&self) -> f64 {
        self.poses.time_secs().unwrap_or(self.time_secs)
    }
}
