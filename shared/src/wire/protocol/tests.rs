//! The encoded bytes of every message are pinned: postcard does not describe itself, so two builds whose types differ must differ in `PROTOCOL`.

use super::{PINS, PROTOCOL};
use crate::body::{Body, PoseCode, Prism};
use crate::scene::{Allowed, FIELDS, Scene, VehicleKind, parse};
use crate::wire::{
    AppliedInput, BrokenPlant, ClientMessage, Drawing, Drive, Ghost, Joined, Mesh, ModelUse, ObjectPose, PROOF_BYTES, PatchCheck, Peer,
    RareCauses, Refusal, SERVER_MESSAGE_LIMIT, ServerMessage, Shapes, Standing, StepHead, TurbulenceState, WireError, decode, encode,
};
use serde::{Deserialize, de::DeserializeOwned};
use std::fmt::{Debug, Write};
use std::num::NonZeroU8;
use toml::{Table, Value};

/// One example of every client message, in the order of the variants.
fn client_messages() -> Vec<ClientMessage> {
    vec![
        ClientMessage::Hello { name: "Ada".to_owned() },
        ClientMessage::View { eye_m: [1.0, -2.5, 1e6], radius_m: 96.0 },
        ClientMessage::Choose { vehicle: Some(VehicleKind::Helicopter) },
        ClientMessage::Drive { number: 300, drive: Drive { throttle: 1.0, steer: -0.5, lift: 0.25, brake: 0.125 } },
        ClientMessage::Ack { frame: 70_000 },
        ClientMessage::Ping { nonce: 7 },
        ClientMessage::Rename { name: "Grace".to_owned() },
        ClientMessage::Return { name: "Ada".to_owned(), client: 3, proof: [0xab; PROOF_BYTES] },
        ClientMessage::Replicate { wanted: true },
        ClientMessage::Differs { tick: 300, patch: 130 },
    ]
}

/// One example of every server message, in the order of the variants.
fn server_messages() -> Vec<ServerMessage> {
    vec![
        ServerMessage::Welcome {
            client: 3,
            proof: [0xab; PROOF_BYTES],
            server_version: "0.1.0".to_owned(),
            scene_name: "meadow".to_owned(),
        },
        ServerMessage::Scene {
            scene: Box::new(filled_scene()),
            height_png: vec![1, 2],
            covering_png: vec![3],
            nutrient_png: vec![4, 5, 6],
            models: vec![(ModelUse::Vehicle(VehicleKind::Car), mesh()), (ModelUse::Cover(1), mesh())],
            shapes: shapes(),
        },
        ServerMessage::Poses { tick: 300, objects: vec![pose()] },
        ServerMessage::Wind { tick: 300, seq: 2, key: true, turbulence: turbulence(), payload: vec![9, 8] },
        ServerMessage::Patch { patch: 130, seq: 3, key: false, payload: vec![7] },
        ServerMessage::Roster { peers: vec![Peer { client: 3, name: "Ada".to_owned(), object: Some(200) }] },
        ServerMessage::Broken { plants: vec![BrokenPlant { site: 128, fall: NonZeroU8::MAX }] },
        ServerMessage::FrameEnd { frame: 4, tick: 300, time_secs: 5.0 },
        ServerMessage::Refused { refusal: Refusal::ObjectLimit, reason: "full".to_owned() },
        ServerMessage::Pong { nonce: 7 },
        ServerMessage::ReplicaState { tick: 300, part: 1, parts: 200, payload: vec![5, 6] },
        ServerMessage::Steps { first_tick: 300, steps: vec![step()], moves: vec![3, 4] },
        ServerMessage::Applied(AppliedInput { number: 7, tick: 300 }),
        ServerMessage::Race { standings: vec![standing()] },
        ServerMessage::Ghost { ghost: Some(ghost()) },
    ]
}

/// A racer with a running lap.
fn standing() -> Standing {
    Standing {
        client: 200,
        next_gate: 2,
        laps: 1,
        began_secs: Some(5.0),
        is_false_start: true,
        last_secs: Some(1.0),
        best_secs: Some(0.5),
        race_secs: Some(2.0),
        gap_secs: Some(-0.5),
    }
}

/// A ghost of one pose.
fn ghost() -> Ghost {
    let poses = vec![PoseCode { position: [8192, 0, -8192], rotation: [0, 0, 0, 32_767] }];
    Ghost { client: 200, kind: VehicleKind::Sled, lap_secs: 20.0, first_secs: 0.0625, period_secs: 0.125, poses }
}

/// A step with every rare cause.
fn step() -> StepHead {
    let from = PoseCode { position: [8192, 0, -8192], rotation: [0, 0, 0, 32_767] };
    let rare = RareCauses {
        left: vec![2],
        joined: vec![Joined { id: 200, kind: VehicleKind::Ball, from }],
        gusty: Some(vec![5, 6]),
        evicted: vec![7],
        dropped: vec![8],
        checks: vec![PatchCheck { patch: 130, sum: 40_000 }],
    };
    StepHead { quiet_before: 3, rare: Some(Box::new(rare)) }
}

/// A shape and a drawing.
fn shapes() -> Shapes {
    let prism = Prism { outline_m: vec![[0.0, 1.0]], seams: vec![true], span_m: [-1.0, 1.0], parts_grass: true, bears_weight: false };
    let body = Body { prisms: vec![prism], is_round: false, has_downwash: true, stride_m: 0.0 };
    Shapes { bodies: vec![body], drawings: vec![Drawing { name: "spiral".to_owned(), png: vec![1, 2] }] }
}

/// Name of a client message in [`PINS`]; the compiler demands a name for a new variant.
fn client_name(message: &ClientMessage) -> &'static str {
    match message {
        ClientMessage::Hello { .. } => "Hello",
        ClientMessage::View { .. } => "View",
        ClientMessage::Choose { .. } => "Choose",
        ClientMessage::Drive { .. } => "Drive",
        ClientMessage::Ack { .. } => "Ack",
        ClientMessage::Ping { .. } => "Ping",
        ClientMessage::Rename { .. } => "Rename",
        ClientMessage::Return { .. } => "Return",
        ClientMessage::Replicate { .. } => "Replicate",
        ClientMessage::Differs { .. } => "Differs",
    }
}

/// Name of a server message in [`PINS`]; the compiler demands a name for a new variant.
fn server_name(message: &ServerMessage) -> &'static str {
    match message {
        ServerMessage::Welcome { .. } => "Welcome",
        ServerMessage::Scene { .. } => "Scene",
        ServerMessage::Poses { .. } => "Poses",
        ServerMessage::Wind { .. } => "Wind",
        ServerMessage::Patch { .. } => "Patch",
        ServerMessage::Roster { .. } => "Roster",
        ServerMessage::Broken { .. } => "Broken",
        ServerMessage::FrameEnd { .. } => "FrameEnd",
        ServerMessage::Refused { .. } => "Refused",
        ServerMessage::Pong { .. } => "Pong",
        ServerMessage::ReplicaState { .. } => "ReplicaState",
        ServerMessage::Steps { .. } => "Steps",
        ServerMessage::Applied(_) => "Applied",
        ServerMessage::Race { .. } => "Race",
        ServerMessage::Ghost { .. } => "Ghost",
    }
}

fn mesh() -> Mesh {
    Mesh { positions_m: vec![[0.0, 1.0, 2.0]], normals: vec![[0.0, 1.0, 0.0]], rgb: vec![[10, 20, 30]], indices: vec![0, 0, 0] }
}

fn turbulence() -> TurbulenceState {
    TurbulenceState { travel_m: [1.0, -2.0], path_m: 3.0, friction_m_per_s: 0.5 }
}

fn pose() -> ObjectPose {
    ObjectPose {
        id: 200,
        kind: VehicleKind::Ball,
        position_m: [1.0, 2.0, 3.0],
        rotation: [0.0, 0.0, 0.0, 1.0],
        velocity_m_per_s: [4.0, 5.0, 6.0],
        part_rad: 0.5,
    }
}

/// Values of a scene in which no list is empty and every number differs from its neighbours, so that exchanged fields are detected.
fn filled_values() -> Table {
    let text = "summary = 'all'\nunderbrush_file = 'u.toml'\n\
        [terrain]\nheight_map = 'h.png'\ncovering_map = 'c.png'\npixel_m = [0.5, 0.5]\nlevel_m = 0.1\n\
        [[wind.primitives]]\nkind = 'source'\nat_m = [1, 2, 3]\nintensity = 'spline'\nperiod_secs = 9\n\
        intensity_points = [[1, 1], [2, 0.5]]\n[[species]]\nname = 'a'\ncover = 1\n\
        [[underbrush]]\nname = 'b'\n[[underbrush.components]]\nname = 'c'\nkind = 'branch'\n\
        [[underbrush.components]]\nname = 'd'\nkind = 'leaf'\non = 'c'\n\
        [[models]]\nname = 'm'\ncover = 3\nmodel = 'm.glb'\n\
        [[drawn_winds]]\nshape = 'swirl'\npath_m = [[1, 2]]\n[[lights]]\nat_m = [1, 2, 3]\n\
        [[race.gates]]\nat_m = [1, 2]\nheading_rad = 0.5\n[[race.gates]]\nat_m = [8, 2]\nheading_rad = 3.5\n\
        [growth]\nnutrient_map = 'n.png'\n[objects]\ncar_model = 'car.glb'\nmonster_model = 'm.glb'\n";
    let mut values = Table::try_from(parse(text).unwrap()).unwrap();
    let mut count = 0;
    values.iter_mut().for_each(|(_, value)| number(value, &mut count));
    values
}

/// Replaces every number by the next of a sequence.
fn number(value: &mut Value, count: &mut i64) {
    match value {
        Value::Integer(n) => *n = *count % 251 + 1,
        Value::Float(n) => *n = *count as f64 + 0.25,
        Value::Array(items) => return items.iter_mut().for_each(|item| number(item, count)),
        Value::Table(table) => return table.iter_mut().for_each(|(_, value)| number(value, count)),
        _ => return,
    }
    *count += 1;
}

fn filled_scene() -> Scene {
    Scene::deserialize(filled_values()).unwrap()
}

/// The scene with each word of each field in turn, concatenated: pins the order of the variants of every enum.
fn scenes_with_every_word() -> Vec<u8> {
    let mut bytes = vec![];
    for (path, allowed) in FIELDS {
        let Allowed::OneOf(words) = allowed else { continue };
        for word in words {
            let mut values = filled_values();
            let mut keys = path.split('.');
            let mut value = &mut values[keys.next().unwrap()];
            for key in keys {
                let section = if value.is_array() { &mut value[0] } else { value };
                value = &mut section[key];
            }
            *value = Value::from(*word);
            bytes.extend(encode(&Scene::deserialize(values).unwrap()));
        }
    }
    bytes
}

/// A body as [`PINS`] shows it.
fn shown(body: &[u8]) -> String {
    if body.len() <= 40 {
        return body.iter().fold(String::new(), |mut hex, byte| {
            write!(hex, "{byte:02x}").unwrap();
            hex
        });
    }
    let hash = body.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3));
    format!("{} bytes, {hash:016x}", body.len())
}

#[test]
fn encoded_bytes_of_every_message_are_as_pinned() {
    let mut found = vec![("protocol".to_owned(), PROTOCOL.to_string())];
    found.extend(client_messages().iter().map(|message| (format!("client {}", client_name(message)), shown(&encode(message)[1..]))));
    found.extend(server_messages().iter().map(|message| (format!("server {}", server_name(message)), shown(&encode(message)[1..]))));
    let refusals = [Refusal::ObjectLimit, Refusal::ServerFull, Refusal::BadMessage, Refusal::RateLimit, Refusal::Stopping];
    found.push(("refusals".to_owned(), shown(&encode(&refusals)[1..])));
    found.push(("vehicle kinds".to_owned(), shown(&encode(&VehicleKind::ALL.to_vec())[1..])));
    found.push(("scenes with every word".to_owned(), shown(&scenes_with_every_word())));
    let is_pinned = found.iter().map(|(name, body)| (name.as_str(), body.as_str())).eq(PINS.iter().copied());
    let table: String = found.iter().map(|(name, body)| format!("    (\"{name}\", \"{body}\"),\n")).collect();
    assert!(is_pinned, "the wire format has changed: in wire/protocol.rs, bump PROTOCOL and replace the pins by:\n{table}");
}

/// Checks that `examples` are all variants of a message, in order.
fn assert_complete<M: DeserializeOwned + serde::Serialize + Debug + PartialEq>(examples: &[M]) {
    for (variant, example) in examples.iter().enumerate() {
        let bytes = encode(example);
        assert_eq!(usize::from(bytes[1]), variant, "{example:?} is not at its variant's place in the list");
        assert_eq!(decode::<M>(&bytes, SERVER_MESSAGE_LIMIT).as_ref(), Ok(example));
    }
    let next = [&[PROTOCOL, examples.len() as u8], [0; 4096].as_slice()].concat();
    let beyond = decode::<M>(&next, SERVER_MESSAGE_LIMIT);
    assert!(matches!(beyond, Err(WireError::Malformed(_))), "variant {} has no example in this file", examples.len());
}

#[test]
fn every_message_variant_has_an_example() {
    assert_complete(&client_messages());
    assert_complete(&server_messages());
}
