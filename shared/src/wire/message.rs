//! Messages, and their encoding.

use super::{ModelUse, PROTOCOL, StepHead, TurbulenceState};
use crate::body::{Body, PoseCode};
use crate::grid::PatchIndex;
use crate::scene::{Scene, VehicleKind};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use std::num::NonZeroU8;
use thiserror::Error;

/// Object ID, unique within a run.
pub type ObjectId = u32;

/// Driving controls, each −1..=1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Drive {
    /// Forward (+) or backward (−).
    pub throttle: f32,
    /// Right (+) or left (−).
    pub steer: f32,
    /// Up (+) or down (−); helicopters only.
    pub lift: f32,
    /// Brake, 0..=1.
    pub brake: f32,
}

impl Drive {
    /// Whether every value is finite and within its range.
    pub fn is_valid(&self) -> bool {
        let signed = [self.throttle, self.steer, self.lift].iter().all(|v| (-1.0..=1.0).contains(v));
        signed && (0.0..=1.0).contains(&self.brake)
    }
}

/// Messages from client to server.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ClientMessage {
    /// First message of a connection.
    Hello {
        /// Display name; at most 32 visible characters, others are dropped.
        name: String,
    },
    /// Camera position; decides which patches are streamed.
    View {
        /// Camera position (m).
        eye_m: [f32; 3],
        /// Radius of the streamed bend field (m), 0..=512.
        radius_m: f32,
    },
    /// Selects a vehicle in place of the previous one, or leaves it.
    Choose {
        /// The vehicle to drive.
        vehicle: Option<VehicleKind>,
    },
    /// Controls of one's own vehicle.
    Drive {
        /// Number of the input, which comes back with [`ServerMessage::Applied`]; from 1, increasing, modulo 2³². 0 is that of no input.
        number: u32,
        /// The controls.
        drive: Drive,
    },
    /// Acknowledges the newest frame that has arrived completely.
    Ack {
        /// Number from [`ServerMessage::FrameEnd`].
        frame: u32,
    },
    /// Requests a [`ServerMessage::Pong`].
    Ping {
        /// Returned unchanged.
        nonce: u32,
    },
    /// Changes the display name.
    Rename {
        /// As in [`Hello`](Self::Hello).
        name: String,
    },
    /// First message of a connection, instead of [`Hello`](Self::Hello), of a client that was connected before. If its vehicle is still there it gets its number and
    /// its vehicle back; otherwise, and with a wrong proof, it is a new client.
    Return {
        /// As in [`Hello`](Self::Hello).
        name: String,
        /// Its number, from [`ServerMessage::Welcome`].
        client: u32,
        /// The proof that came with the number.
        proof: [u8; PROOF_BYTES],
    },
    /// Asks for a replica of the grass ([`ServerMessage::ReplicaState`], then [`ServerMessage::Steps`]) instead of patches, or for patches again. A connection
    /// starts with patches.
    Replicate {
        /// Whether the client wants a replica.
        wanted: bool,
    },
    /// The client's replica differs from the server's grass. It gets the state again.
    Differs {
        /// Tick after which it differs.
        tick: u64,
        /// A patch that differs.
        patch: PatchIndex,
    },
}

/// Length of the proof that a client has its number from the server (bytes).
pub const PROOF_BYTES: usize = 32;

/// Messages from server to client.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum ServerMessage {
    /// Reply to a valid hello or return.
    Welcome {
        /// The client's own ID in [`ServerMessage::Roster`].
        client: u32,
        /// Proof of the number, for [`ClientMessage::Return`].
        proof: [u8; PROOF_BYTES],
        /// Version of the server's package.
        server_version: String,
        /// Name of the running scene as used in links: that of a built-in scene, or of the scene file without its extension.
        scene_name: String,
    },
    /// Everything that is constant during the run.
    Scene {
        /// The checked scene.
        scene: Box<Scene>,
        /// Height map, the PNG file's bytes.
        #[serde(with = "serde_bytes")]
        height_png: Vec<u8>,
        /// Covering map, the PNG file's bytes.
        #[serde(with = "serde_bytes")]
        covering_png: Vec<u8>,
        /// Nutrient map, the PNG file's bytes; empty if nutrients are generated from the seed.
        #[serde(with = "serde_bytes")]
        nutrient_png: Vec<u8>,
        /// Models of vehicles read from glTF files, and those of the covering map; all other vehicles are drawn with the built-in models.
        models: Vec<(ModelUse, Mesh)>,
        /// Shapes of objects and winds that press the grass, for a replica of it.
        shapes: Shapes,
    },
    /// Newest poses of all objects.
    Poses {
        /// Tick of the world.
        tick: u64,
        /// All objects; one that is missing has left.
        objects: Vec<ObjectPose>,
    },
    /// Wind at the cell centres: three planes (u, v, w), each `nx × (ny·nz)`, x fastest, then y, then z. In a scene with dust a fourth plane holds
    /// its concentration.
    Wind {
        /// Tick of the world.
        tick: u64,
        /// Sequence number of this wind frame; a delta frame applies to the previous one.
        seq: u32,
        /// Whether this is a key frame, coded against zero.
        key: bool,
        /// State of the gusts between the cells.
        turbulence: TurbulenceState,
        /// [`codec`](super::codec) payload.
        #[serde(with = "serde_bytes")]
        payload: Vec<u8>,
    },
    /// Bend field of one patch: three planes (θ, ωx, ωz) of `cells × cells`, relative to [the lean in the wind](crate::bend::wind_lean_rad). A client
    /// keeps at least the [`PATCH_MEMORY`](super::PATCH_MEMORY) most recently received patches.
    Patch {
        /// Index of the patch.
        patch: PatchIndex,
        /// Sequence number of this frame of the patch; a delta frame applies to the previous one.
        seq: u32,
        /// Whether this is a key frame, coded against zero.
        key: bool,
        /// [`codec`](super::codec) payload; empty: the patch is at rest.
        #[serde(with = "serde_bytes")]
        payload: Vec<u8>,
    },
    /// The connected clients.
    Roster {
        /// All clients.
        peers: Vec<Peer>,
    },
    /// Underbrush plants that are broken for good: those not sent to this client before, at most [`BROKEN_LIMIT`](super::BROKEN_LIMIT); any others
    /// follow with the next frames.
    Broken {
        /// Ascending by site; 2 to 6 bytes each, 4 where sites have numbers from 2^14 to 2^21.
        plants: Vec<BrokenPlant>,
    },
    /// End of a frame; to be acknowledged.
    FrameEnd {
        /// Frame number, per client, from 1.
        frame: u32,
        /// Tick of the world that the frame shows.
        tick: u64,
        /// Simulated time (s).
        time_secs: f64,
    },
    /// A request was rejected, or the connection is about to be closed.
    Refused {
        /// Machine-readable reason.
        refusal: Refusal,
        /// Human-readable reason.
        reason: String,
    },
    /// Reply to a ping.
    Pong {
        /// The nonce of the ping.
        nonce: u32,
    },
    /// Part of the state of the grass, from which the client starts a replica of it when it has all parts.
    ReplicaState {
        /// Tick of the state.
        tick: u64,
        /// Number of the part, from 0.
        part: u16,
        /// Number of parts.
        parts: u16,
        /// Part of the encoded [`ReplicaState`](crate::grass::ReplicaState).
        #[serde(with = "serde_bytes")]
        payload: Vec<u8>,
    },
    /// Causes of steps of the grass, for a client with a replica of it. Nothing changes in the steps between these and those of the message before.
    Steps {
        /// Tick of the first step.
        first_tick: u64,
        /// The steps in which something changes.
        steps: Vec<StepHead>,
        /// [Coded](super::codec::moves) moves of all objects, ascending by their number, in each of these steps.
        #[serde(with = "serde_bytes")]
        moves: Vec<u8>,
    },
    /// The newest input of the client's own vehicle, whenever it is another. It is part of the frame, whose poses show its effect.
    Applied(AppliedInput),
    /// The race as it stands, whenever that has changed: at most [`STANDINGS_LIMIT`](super::STANDINGS_LIMIT) clients who have begun a lap, the first in front.
    Race {
        /// Ordered by the best race, then by the best lap.
        standings: Vec<Standing>,
    },
    /// The fastest lap of the race, whenever there is a faster one.
    Ghost {
        /// `None` if no lap is complete.
        ghost: Option<Ghost>,
    },
}

/// A client in the race. Times are simulated seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Standing {
    /// The client's ID in [`ServerMessage::Roster`].
    pub client: u32,
    /// Number of the gate that counts next, from 0 for start and finish.
    pub next_gate: u8,
    /// Complete laps of the running race.
    pub laps: u8,
    /// Time of the world at which the running lap began; `None` if none runs.
    pub began_secs: Option<f64>,
    /// Whether the running lap began before the light was green; it does not count then.
    pub is_false_start: bool,
    /// Duration of the newest lap (s).
    pub last_secs: Option<f32>,
    /// Duration of the best lap (s).
    pub best_secs: Option<f32>,
    /// Duration of the best race (s), of as many laps without a break as the scene says.
    pub race_secs: Option<f32>,
    /// Time at the gate passed last (s) after that of the best lap before; negative if it is ahead.
    pub gap_secs: Option<f32>,
}

/// The way of the fastest lap: poses at equal distances in time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ghost {
    /// The client that drove it, which may be gone.
    pub client: u32,
    /// Kind of its vehicle.
    pub kind: VehicleKind,
    /// Duration of the lap (s).
    pub lap_secs: f32,
    /// Time of the first pose after the start of the lap (s).
    pub first_secs: f32,
    /// Time from one pose to the next (s).
    pub period_secs: f32,
    /// The poses, 1 to [`GHOST_LIMIT`](super::GHOST_LIMIT).
    pub poses: Vec<PoseCode>,
}

impl Ghost {
    /// Whether all values are finite and in range.
    pub fn is_valid(&self) -> bool {
        let secs = [self.lap_secs, self.first_secs];
        let has_poses = (1..=super::GHOST_LIMIT).contains(&self.poses.len());
        has_poses && secs.iter().all(|secs| (0.0..=1e6).contains(secs)) && (1e-3..=10.0).contains(&self.period_secs)
    }
}

/// An input that moves a vehicle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct AppliedInput {
    /// Its number, from [`ClientMessage::Drive`].
    pub number: u32,
    /// First tick in which it has effect.
    pub tick: u64,
}

/// Shapes of objects and winds that press the grass.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Shapes {
    /// Shapes of all kinds of objects, in the order of [`VehicleKind::ALL`].
    pub bodies: Vec<Body>,
    /// Wind drawings that the scene names.
    pub drawings: Vec<Drawing>,
}

/// A wind drawing.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Drawing {
    /// Its name in the scene.
    pub name: String,
    /// The PNG file's bytes.
    #[serde(with = "serde_bytes")]
    pub png: Vec<u8>,
}

/// Reasons of a [`ServerMessage::Refused`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Refusal {
    /// The scene's limit on objects is reached; the connection stays open.
    ObjectLimit,
    /// The server is full; the connection is closed.
    ServerFull,
    /// A message was malformed, too large or out of range; the connection is closed.
    BadMessage,
    /// Too many messages; the connection is closed.
    RateLimit,
    /// The server is stopping; the connection is closed.
    Stopping,
}

/// A connected client.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Peer {
    /// The client's ID.
    pub client: u32,
    /// Its display name.
    pub name: String,
    /// The object that it drives, if any.
    pub object: Option<ObjectId>,
}

/// A broken plant of the underbrush.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BrokenPlant {
    /// Its site, as numbered in [`Sites`](crate::plant::growth::Sites).
    pub site: u32,
    /// Direction in which it fell: [heading code](super::quantise::heading_code).
    pub fall: NonZeroU8,
}

/// Pose and motion of an object.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ObjectPose {
    /// Object ID.
    pub id: ObjectId,
    /// Kind of object.
    pub kind: VehicleKind,
    /// Centre of the body's box (m).
    pub position_m: [f32; 3],
    /// Orientation as a unit quaternion (x, y, z, w); the body's own axes are right +X, up +Y, forward −Z.
    pub rotation: [f32; 4],
    /// Velocity (m/s).
    pub velocity_m_per_s: [f32; 3],
    /// Angle of a moving part (rad): steering of the front wheels (+ right), phase of the rotor or of the walk, or heading of a ball's driver.
    pub part_rad: f32,
}

/// Triangle mesh with a colour per vertex; at most [`Mesh::VERTEX_LIMIT`] vertices and [`Mesh::INDEX_LIMIT`] indices.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Mesh {
    /// Positions (m) in the body's axes, relative to the centre of its box.
    pub positions_m: Vec<[f32; 3]>,
    /// Unit normals.
    pub normals: Vec<[f32; 3]>,
    /// Linear RGB, 0..=255.
    pub rgb: Vec<[u8; 3]>,
    /// Three indices per triangle, anticlockwise seen from outside.
    pub indices: Vec<u32>,
}

impl Mesh {
    /// Largest number of vertices: indices fit 16 bits.
    pub const VERTEX_LIMIT: usize = 1 << 16;
    /// Largest number of indices; two such meshes, three maps of 24 MiB and all models of the covering map fit into
    /// [`SERVER_MESSAGE_LIMIT`](super::SERVER_MESSAGE_LIMIT).
    pub const INDEX_LIMIT: usize = 1 << 20;
    /// Largest number of vertices of a model of the covering map, which may stand in thousands of places.
    pub const COVER_VERTEX_LIMIT: usize = 1 << 13;
    /// Largest number of its indices.
    pub const COVER_INDEX_LIMIT: usize = 49_152;
}

/// Reasons why bytes cannot be decoded.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum WireError {
    /// The message is empty.
    #[error("the message is empty")]
    Empty,
    /// The other side uses another protocol version.
    #[error("protocol version {found}; this side speaks {PROTOCOL}")]
    Version {
        /// The version found.
        found: u8,
    },
    /// Larger than allowed.
    #[error("the message has {found} bytes; at most {limit} are allowed")]
    TooLarge {
        /// Bytes found.
        found: usize,
        /// Bytes allowed.
        limit: usize,
    },
    /// The bytes after the version are not a message.
    #[error("the message is malformed: {0}")]
    Malformed(String),
    /// Bytes are left over after the message.
    #[error("{0} bytes follow the message")]
    Trailing(usize),
}

/// Encodes a message with its version byte.
///
/// # Panics
/// Never: postcard can write every message.
pub fn encode<M: Serialize>(message: &M) -> Vec<u8> {
    postcard::to_extend(message, vec![PROTOCOL]).expect("messages hold only what postcard can write")
}

/// Decodes a message of at most `limit` bytes; the length is checked before anything is parsed.
///
/// # Errors
/// [`WireError`] when the bytes are not exactly one message of this version.
pub fn decode<M: DeserializeOwned>(bytes: &[u8], limit: usize) -> Result<M, WireError> {
    if bytes.len() > limit {
        return Err(WireError::TooLarge { found: bytes.len(), limit });
    }
    let (&version, body) = bytes.split_first().ok_or(WireError::Empty)?;
    if version != PROTOCOL {
        return Err(WireError::Version { found: version });
    }
    let (message, rest) = postcard::take_from_bytes(body).map_err(|error| WireError::Malformed(error.to_string()))?;
    if rest.is_empty() { Ok(message) } else { Err(WireError::Trailing(rest.len())) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::CLIENT_MESSAGE_LIMIT;
    use proptest::prelude::*;

    fn decode_client(bytes: &[u8]) -> Result<ClientMessage, WireError> {
        decode(bytes, CLIENT_MESSAGE_LIMIT)
    }

    #[test]
    fn a_message_comes_back() {
        let message = ClientMessage::View { eye_m: [1.0, -2.5, 1e6], radius_m: 96.0 };
        assert_eq!(decode_client(&encode(&message)), Ok(message));
    }

    #[test]
    fn each_damage_has_its_own_error() {
        let whole = encode(&ClientMessage::Ack { frame: 70_000 });
        assert_eq!(decode_client(&[]), Err(WireError::Empty));
        let mut other_version = whole.clone();
        other_version[0] = PROTOCOL + 1;
        assert_eq!(decode_client(&other_version), Err(WireError::Version { found: PROTOCOL + 1 }));
        assert!(matches!(decode_client(&whole[..whole.len() - 1]), Err(WireError::Malformed(_))));
        let longer = [whole.as_slice(), &[0, 0]].concat();
        assert_eq!(decode_client(&longer), Err(WireError::Trailing(2)));
        let huge = vec![PROTOCOL; CLIENT_MESSAGE_LIMIT + 1];
        let limit = CLIENT_MESSAGE_LIMIT;
        assert_eq!(decode_client(&huge), Err(WireError::TooLarge { found: limit + 1, limit }));
    }

    #[test]
    fn a_broken_plant_takes_its_site_and_a_byte_which_is_never_zero() {
        let plant = |site: u32, fall: u8| BrokenPlant { site, fall: NonZeroU8::new(fall).expect("above 0") };
        let encoded = |plants: &[BrokenPlant]| encode(&ServerMessage::Broken { plants: plants.to_vec() });
        let none = encoded(&[]).len();
        for (site, bytes) in [(0, 2), (127, 2), (128, 3), (409_599, 4), (4_194_303, 5), (u32::MAX, 6)] {
            assert_eq!(encoded(&[plant(site, 255)]).len() - none, bytes, "site {site}");
        }
        let mut whole = encoded(&[plant(5, 1), plant(6, 77)]);
        let message = ServerMessage::Broken { plants: vec![plant(5, 1), plant(6, 77)] };
        assert_eq!(decode(&whole, 100), Ok(message));
        *whole.last_mut().expect("it has bytes") = 0;
        assert!(matches!(decode::<ServerMessage>(&whole, 100), Err(WireError::Malformed(_))));
        // A count without the plants to match allocates nothing.
        let boast = [&encoded(&[])[..2], &[255, 255, 255, 255, 15]].concat();
        assert!(matches!(decode::<ServerMessage>(&boast, 100), Err(WireError::Malformed(_))));
    }

    #[test]
    fn a_drive_out_of_range_is_not_valid() {
        assert!(Drive { throttle: 1.0, steer: -1.0, lift: 0.5, brake: 0.0 }.is_valid());
        for value in [f32::NAN, f32::INFINITY, 1.01, -1.01] {
            assert!(!Drive { throttle: value, ..Drive::default() }.is_valid());
            assert!(!Drive { brake: value, ..Drive::default() }.is_valid());
        }
    }

    proptest! {
        #[test]
        fn any_bytes_are_a_message_or_an_error(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            let _ = decode_client(&bytes);
            let _ = decode::<ServerMessage>(&[&[PROTOCOL], bytes.as_slice()].concat(), 4096);
        }
    }
}
