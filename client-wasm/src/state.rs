//! The client's mirror of the server: every [`ServerMessage`] goes in, the renderer reads it out.
//!
//! The bytes behind the messages are hostile: lengths, indices and numbers are checked before anything is kept, and what is
//! kept is bounded by [`PATCH_LIMIT`], [`OBJECT_LIMIT`], [`PEER_LIMIT`] and the number of sites.

mod broken;
mod fields;
mod land;
mod playback;
mod sample;
mod underbrush;

pub use fields::{PATCH_LIMIT, PatchCodes, WindCodes};
pub use land::Land;
pub use playback::OBJECT_LIMIT;

use broken::Broken;
use fields::{Patches, WindFrames};
use playback::Playback;
use shared::grid::PatchIndex;
use shared::scene::Scene;
use shared::terrain::MapError;
use shared::wire::{CodecError, ObjectId, ObjectPose, Peer, Refusal, ServerMessage};
use thiserror::Error;

/// Most peers that are kept.
pub const PEER_LIMIT: usize = 4096;

/// Why a message was not taken in. The mirror is then as it was before.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MirrorError {
    /// A map of the scene could not be read.
    #[error("the {map} {error}")]
    Map {
        /// Which map.
        map: &'static str,
        /// What is wrong with it.
        error: MapError,
    },
    /// A field came before the scene that gives its shape.
    #[error("a {0} came before the scene")]
    BeforeScene(&'static str),
    /// A payload is no grid.
    #[error("the {field} frame is damaged: {error}")]
    Field {
        /// `patch` or `wind`.
        field: &'static str,
        /// What is wrong with it.
        error: CodecError,
    },
    /// A value leaves what it may be.
    #[error("{what} is {found}; allowed: {allowed}")]
    Range {
        /// Which value.
        what: &'static str,
        /// The value found.
        found: String,
        /// What is allowed.
        allowed: String,
    },
}

/// What the page wants to know of a message.
#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    /// The server took the client in, under this number.
    Welcome {
        /// The client's own number.
        client: u32,
        /// Version of the server's package.
        server_version: String,
        /// Name of the scene that the server runs.
        scene_name: String,
    },
    /// A new scene; the renderer must load it.
    Scene,
    /// A frame is whole and is to be acknowledged.
    FrameEnd {
        /// Number of the frame.
        frame: u32,
    },
    /// The list of peers has changed.
    Roster,
    /// A request was refused, or the connection is about to close.
    Refused {
        /// Why, for the program.
        refusal: Refusal,
        /// Why, for the person.
        reason: String,
    },
    /// Answer to a ping.
    Pong {
        /// The ping's.
        nonce: u32,
    },
}

/// All that the client knows of the server's world.
#[derive(Debug, Default)]
pub struct Mirror {
    land: Option<Land>,
    scene_number: u32,
    patches: Patches,
    wind: WindFrames,
    poses: Playback,
    broken: Broken,
    peers: Vec<Peer>,
    tick: u64,
    time_secs: f64,
}

impl Mirror {
    /// Takes a message in. A delta that does not follow its base is dropped until the next key; that is no error.
    ///
    /// # Errors
    /// [`MirrorError`] when the message cannot be part of a sound stream.
    pub fn apply(&mut self, message: ServerMessage) -> Result<Option<Event>, MirrorError> {
        Ok(match message {
            ServerMessage::Welcome { client, server_version, scene_name } => Some(Event::Welcome { client, server_version, scene_name }),
            ServerMessage::Scene { scene, height_png, covering_png, nutrient_png, models } => {
                let land = Land::new(*scene, &height_png, &covering_png, &nutrient_png, models)?;
                self.broken = Broken::new(land.flora().map_or(0, |flora| flora.grown().sites.total()));
                self.land = Some(land);
                self.scene_number = self.scene_number.wrapping_add(1);
                self.patches = Patches::default();
                self.wind = WindFrames::default();
                self.poses = Playback::default();
                Some(Event::Scene)
            }
            ServerMessage::Poses { tick, objects } => {
                self.poses.push(tick as f64 / f64::from(self.tick_hz()), objects)?;
                None
            }
            ServerMessage::Wind { seq, key, payload, .. } => {
                let land = self.land.as_ref().ok_or(MirrorError::BeforeScene("wind frame"))?;
                self.wind.apply(&land.scene().wind, seq, key, &payload)?;
                None
            }
            ServerMessage::Patch { patch, seq, key, payload } => {
                let land = self.land.as_ref().ok_or(MirrorError::BeforeScene("patch frame"))?;
                self.patches.apply(land.layout(), patch, seq, key, &payload)?;
                None
            }
            ServerMessage::Roster { mut peers } => {
                peers.truncate(PEER_LIMIT);
                self.peers = peers;
                Some(Event::Roster)
            }
            ServerMessage::Broken { plants } => {
                self.broken.take_in(&plants)?;
                None
            }
            ServerMessage::FrameEnd { frame, tick, time_secs } => {
                if !time_secs.is_finite() {
                    return Err(range("time_secs", time_secs, "a finite number"));
                }
                (self.tick, self.time_secs) = (tick, time_secs);
                Some(Event::FrameEnd { frame })
            }
            ServerMessage::Refused { refusal, reason } => Some(Event::Refused { refusal, reason }),
            ServerMessage::Pong { nonce } => Some(Event::Pong { nonce }),
        })
    }

    /// Lets the client's clock run for `dt_secs`: the objects move on.
    pub fn advance(&mut self, dt_secs: f64) {
        self.poses.advance(dt_secs);
    }

    fn tick_hz(&self) -> f32 {
        self.land.as_ref().map_or(60.0, |land| land.scene().tick_hz)
    }

    /// The scene and its maps, once they have come.
    pub fn land(&self) -> Option<&Land> {
        self.land.as_ref()
    }

    /// Counts the scenes that have come; a change means that the renderer must load the scene anew.
    pub fn scene_number(&self) -> u32 {
        self.scene_number
    }

    /// Every object as it is drawn now: about 0.1 s late, on a smooth path between the server's poses.
    pub fn objects(&self) -> impl Iterator<Item = ObjectPose> + use<> {
        self.poses.shown().into_iter()
    }

    /// One object as it is drawn now.
    pub fn object(&self, id: ObjectId) -> Option<ObjectPose> {
        self.objects().find(|pose| pose.id == id)
    }

    /// Every object at its newest pose.
    pub fn newest_objects(&self) -> &[ObjectPose] {
        self.poses.newest()
    }

    /// Who is here.
    pub fn peers(&self) -> &[Peer] {
        &self.peers
    }

    /// The object that a client drives.
    pub fn object_of(&self, client: u32) -> Option<ObjectId> {
        self.peers.iter().find(|peer| peer.client == client)?.object
    }

    /// Step of the world that the newest whole frame shows.
    pub fn tick(&self) -> u64 {
        self.tick
    }

    /// Simulated time of the newest whole frame (s).
    pub fn time_secs(&self) -> f64 {
        self.time_secs
    }

    /// Codes of a patch, or none when it is at rest or unknown.
    pub fn patch(&self, patch: PatchIndex) -> Option<&PatchCodes> {
        self.patches.codes(patch)
    }

    /// Patches whose codes are not all zero.
    pub fn bent_patches(&self) -> impl Iterator<Item = PatchIndex> + '_ {
        self.patches.bent()
    }

    /// Number of patches heard of, bent or at rest.
    pub fn known_patches(&self) -> usize {
        self.patches.known()
    }

    /// Patches that have changed since the last call.
    pub fn take_dirty_patches(&mut self) -> Vec<PatchIndex> {
        self.patches.take_dirty()
    }

    /// Whether any patch has changed since [`take_dirty_patches`](Self::take_dirty_patches).
    pub fn has_dirty_patches(&self) -> bool {
        self.patches.has_dirty()
    }

    /// Whether nothing moves by itself: no wind, no rain, no dust, no sun. True before the scene has come.
    pub fn is_calm(&self) -> bool {
        let scene_is_calm = self.land.as_ref().is_none_or(|land| {
            let Scene { wind, rain, light, .. } = land.scene();
            wind.mean_m_per_s == [0.0; 2] && rain.rate_mm_per_h <= 0.0 && light.day_length_secs <= 0.0
        });
        scene_is_calm && self.wind().is_none_or(WindCodes::is_calm)
    }

    /// Which way the plant of each site of the underbrush fell, a [heading code](shared::wire::quantise::heading_code); 0 where none is broken.
    /// At the end up to three zeros more, so that they are whole words.
    pub fn falls(&self) -> &[u8] {
        self.broken.falls()
    }

    /// Number of broken plants; they never heal, so it only rises until the next scene.
    pub fn broken_count(&self) -> u32 {
        self.broken.count()
    }

    /// The newest wind.
    pub fn wind(&self) -> Option<&WindCodes> {
        self.wind.codes()
    }
}

fn range(what: &'static str, found: impl ToString, allowed: impl ToString) -> MirrorError {
    MirrorError::Range { what, found: found.to_string(), allowed: allowed.to_string() }
}

/// A number is `low..=high`.
fn within(what: &'static str, value: f32, low: f32, high: f32) -> Result<(), MirrorError> {
    if (low..=high).contains(&value) { Ok(()) } else { Err(range(what, value, format!("{low}..={high}"))) }
}

#[cfg(test)]
mod tests;
