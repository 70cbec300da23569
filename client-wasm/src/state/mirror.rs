//! The mirror itself: applies messages, and answers the renderer.

use super::broken_plants::BrokenPlants;
use super::error::{MirrorError, range};
use super::fields::{PatchCodes, PatchFields, ShownWind, WindCodes, WindFrames, WindHeader};
use super::following::{Following, Part};
use super::playback::Playback;
use super::scene::DecodedScene;
use super::seen_motion::SeenMotion;
use prairie_core::grass::{EncodedSteps, RepeatedPatch, Replica, patches_within};
use prairie_core::grid::PatchIndex;
use prairie_core::scene::Scene;
use prairie_core::wind::WindField;
use prairie_core::wire::{AppliedInput, Ghost, ObjectId, ObjectPose, PROOF_BYTES, Peer, Refusal, ServerMessage, Standing};
use std::sync::Arc;

/// Maximum number of peers stored; the server's list is truncated to it.
pub const PEER_LIMIT: usize = 4096;

/// Delay of the wind behind the objects shown (s): that of a frame, so that a next one to interpolate towards is usually there.
pub const WIND_DELAY_SECS: f64 = 1.0 / 6.0;

/// Number of sub-steps of the repeated patch before a frame: about 10 ms.
const REPEATED_SUBSTEPS: u32 = 24;

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
    /// Pose to show of the client's own object, instead of the interpolated one.
    pub(super) own: Option<ObjectPose>,
    /// The newest input that moves the client's own object.
    pub(super) applied: Option<AppliedInput>,
    /// Grass in the natural wind where no camera is near.
    pub(super) repeated: Option<RepeatedPatch>,
    pub(super) broken: BrokenPlants,
    pub(super) peers: Vec<Peer>,
    pub(super) standings: Vec<Standing>,
    /// The fastest lap of the race.
    pub(super) ghost: Option<Ghost>,
    /// Number of this client.
    pub(super) client: Option<u32>,
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
                (self.applied, self.client) = (None, Some(client));
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
                self.patches.apply(decoded.scene(), patch, seq, key, &payload)?;
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
            ServerMessage::Applied(applied) => {
                self.applied = Some(applied);
                None
            }
            message @ (ServerMessage::Race { .. } | ServerMessage::Ghost { .. }) => self.apply_race(message)?,
            ServerMessage::Refused { refusal, reason } => Some(Event::Refused { refusal, reason }),
            ServerMessage::Pong { nonce } => Some(Event::Pong { nonce }),
        })
    }

    /// Begins with another scene, at rest.
    fn load(&mut self, decoded: DecodedScene) {
        self.broken = BrokenPlants::new(decoded.flora().map_or(0, |flora| flora.grown().sites.total()));
        self.wind_field = Some(decoded.still_air());
        self.repeated = RepeatedPatch::new(decoded.scene());
        self.scene = Some(Arc::new(decoded));
        self.scene_number = self.scene_number.wrapping_add(1);
        self.patches = PatchFields::default();
        self.following = Following::default();
        self.wind = WindFrames::default();
        self.poses = Playback::default();
        (self.own, self.applied) = (None, None);
        (self.standings, self.ghost) = (Vec::new(), None);
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

    /// Steps of the world in a second (Hz).
    pub fn tick_hz(&self) -> f32 {
        self.scene.as_ref().map_or(60.0, |decoded| decoded.scene().tick_hz)
    }

    /// Sets playback to the newest frame, so that objects are shown at the same moment as the grass: for pictures that are not drawn in real time.
    pub fn show_newest(&mut self) {
        self.poses.show_at(self.secs_of(self.tick));
        if let Some(repeated) = &mut self.repeated {
            repeated.advance_to(self.tick, u32::MAX);
        }
    }

    /// Advances the [repeated patch](Self::repeated_patch) towards the newest frame, by as much as a frame has time for.
    pub fn advance_repeated_patch(&mut self) {
        if let Some(repeated) = &mut self.repeated {
            repeated.advance_to(self.tick, REPEATED_SUBSTEPS);
        }
    }

    /// Grass in the natural wind where no camera is near; `None` in scenes without it.
    pub fn repeated_patch(&self) -> Option<&RepeatedPatch> {
        self.repeated.as_ref()
    }

    /// Patches that the natural wind pushes. Without a replica those around the eye alone: the cameras of others are not known.
    pub fn pushed_patches(&self, eye_m: [f32; 2]) -> Vec<PatchIndex> {
        match (self.following.replica(), &self.scene) {
            (Some(replica), _) => replica.grass().causes().gusty.clone(),
            (None, Some(decoded)) => patches_within(decoded.layout(), decoded.scene().natural_wind.reach_m, [eye_m]),
            (None, None) => vec![],
        }
    }

    /// The scene with its decoded maps; `None` before it has arrived.
    pub fn decoded_scene(&self) -> Option<&DecodedScene> {
        self.scene.as_deref()
    }

    /// Number of scenes received so far. When it changes, the renderer must reload the scene.
    pub fn scene_number(&self) -> u32 {
        self.scene_number
    }

    /// Poses of all objects to show: [that of the own one](Self::show_own), and all others interpolated between the newest snapshots.
    pub fn objects(&self) -> impl Iterator<Item = ObjectPose> + use<> {
        let own = self.own;
        self.poses.interpolated().into_iter().map(move |pose| own.filter(|own| own.id == pose.id).unwrap_or(pose))
    }

    /// Shows an object in this pose from now on, or all of them interpolated.
    pub fn show_own(&mut self, own: Option<ObjectPose>) {
        self.own = own;
    }

    /// Interpolated pose of one object, whatever is shown of it.
    pub fn interpolated(&self, id: ObjectId) -> Option<ObjectPose> {
        self.poses.interpolated().into_iter().find(|pose| pose.id == id)
    }

    /// Poses of all objects as they are heard: that of the own one as it is shown, and the newest of all others.
    pub fn heard_objects(&self) -> impl Iterator<Item = ObjectPose> {
        self.newest_objects().iter().map(|pose| self.own.filter(|own| own.id == pose.id).unwrap_or(*pose))
    }

    /// The newest motion of an object, with its step; `None` while the frame of that step is incomplete. Angular velocity is the mean since the snapshot before.
    pub fn newest_motion(&self, id: ObjectId) -> Option<SeenMotion> {
        let ((newest_secs, pose), before) = self.poses.newest_two(id)?;
        let is_complete = newest_secs == self.secs_of(self.tick);
        is_complete.then(|| SeenMotion::new(self.tick, &pose, before.map(|(secs, before)| (newest_secs - secs, before))))
    }

    /// The newest input that moves the client's own object, if it has sent any; as of the newest frame.
    pub fn applied_input(&self) -> Option<AppliedInput> {
        self.applied
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

    /// Whether nothing moves by itself: no wind, natural wind, rain, snowfall, dust or moving sun. True before the scene has arrived.
    pub fn is_calm(&self) -> bool {
        let scene_is_calm = self.scene.as_ref().is_none_or(|decoded| {
            let Scene { wind, rain, snow, light, .. } = decoded.scene();
            wind.mean_m_per_s == [0.0; 2] && rain.rate_mm_per_h <= 0.0 && snow.fall_m_per_h <= 0.0 && light.day_length_secs <= 0.0
        });
        scene_is_calm && self.repeated.is_none() && self.wind().is_none_or(WindCodes::is_calm)
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

    /// Simulated time that is shown now (s), behind the newest frame by as much as its successors may be late.
    pub fn shown_secs(&self) -> f64 {
        self.poses.clock().time_secs().unwrap_or(self.time_secs)
    }

    /// Simulated time of a frame that would arrive now by the fastest way (s); `None` before the first one.
    pub fn fresh_secs(&self) -> Option<f64> {
        self.poses.clock().fresh_secs()
    }

    /// Time by which other objects are shown behind the fastest frames (s).
    pub fn delay_secs(&self) -> f64 {
        self.poses.clock().delay_secs()
    }
}
