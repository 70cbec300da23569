//! The seeds of the fuzz targets in `tests/fuzz/corpus`: real messages, journals, checkpoints and scenes, all valid in this version.
//!
//! `PRAIRIE_UPDATE=1` writes them again; needed after a change of a format.

use prairie::detail::{Decision, Detail, Reason};
use prairie::journal::{Segment, WorldFolder, find, open, open_checkpoint};
use prairie::runner::Simulation as _;
use prairie::scenes::LoadedScene;
use prairie::world::{Camera, Command, World, WorldState};
use prairie_core::body::{BodyPose, Motion};
use prairie_core::grass::{BendSimulation, Causes, EncodedSteps, ReplicaState, StepCodec, StepRecord};
use prairie_core::scene::{Patches, Scene, TerrainMaps, VehicleKind, Wind, parse, parse_underbrush};
use prairie_core::terrain::{CoverMap, HeightMap, grey_png};
use prairie_core::wire::{CLIENT_MESSAGE_LIMIT, ClientMessage, Drive, SERVER_MESSAGE_LIMIT, ServerMessage, Shape, codec, decode};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};

const VECTORS: &str = include_str!("../docs/protocol-vectors.json");
const SCENES: [(&str, &str); 3] = [
    ("sections", include_str!("mutated_scenes/scene.toml")),
    ("starter", include_str!("../scenes/starter/scene.toml")),
    ("storm", include_str!("../scenes/storm.toml")),
];

/// All species that ship, of which the first is a seed.
const SPECIES: &str = include_str!("../scenes/species.toml");

/// A seed: its target, its name, and its bytes.
type Seed = (&'static str, String, Vec<u8>);

fn corpus() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/fuzz/corpus")
}

/// The messages of the test vectors with this layout: their names and bytes.
fn vectors(layout: &str) -> Vec<(String, Vec<u8>)> {
    let vectors: Value = serde_json::from_str(VECTORS).unwrap();
    let messages = vectors["messages"].as_array().unwrap().iter().filter(|message| message["layout"] == layout);
    let name = |value: &Value| value.as_object().and_then(|value| value.keys().next().cloned()).unwrap_or("other".to_owned());
    let hex = |message: &Value| data_encoding::HEXLOWER.decode(message["bytes"].as_str().unwrap().as_bytes()).unwrap();
    messages.map(|message| (name(&message["value"]), hex(message))).collect()
}

/// Each kind of message from a client, the first of the vectors.
fn client_messages() -> Vec<Seed> {
    let mut messages = vectors("ClientMessage");
    messages.dedup_by(|next, before| next.0 == before.0);
    messages.into_iter().map(|(name, bytes)| ("client_message", name.to_lowercase(), bytes)).collect()
}

/// Messages with their lengths before them.
fn joined<'m>(messages: impl Iterator<Item = &'m Vec<u8>>) -> Vec<u8> {
    messages.flat_map(|message| (message.len() as u16).to_le_bytes().into_iter().chain(message.iter().copied())).collect()
}

/// All messages of the vectors in one stream, and the frames of a lawn.
fn server_messages() -> Vec<Seed> {
    let all = vectors("ServerMessage");
    let (scenes, rest): (Vec<_>, Vec<_>) = all.iter().partition(|(name, _)| name == "Scene");
    let patch: Vec<i16> = (0..192).map(|at| (at % 50) as i16 - 20).collect();
    let wind: Vec<i16> = (0..96).map(|at| (at % 30) as i16).collect();
    let moved: Vec<i16> = wind.iter().map(|code| code + 1).collect();
    let blow = |tick: u64, seq, codes: &[i16], base: Option<&[i16]>| ServerMessage::Wind {
        tick,
        seq,
        key: base.is_none(),
        turbulence: Default::default(),
        payload: codec::encode(Shape::wind(4, false), codes, base),
    };
    let lawn = [
        ServerMessage::Patch { patch: 1, seq: 1, key: true, payload: codec::encode(Shape::patch(8), &patch, None) },
        blow(10, 1, &wind, None),
        blow(20, 2, &moved, Some(&wind)),
        ServerMessage::Patch { patch: 1, seq: 2, key: true, payload: Vec::new() },
        ServerMessage::FrameEnd { frame: 1, tick: 20, time_secs: 0.3 },
    ];
    let lawn: Vec<_> = lawn.iter().map(prairie_core::wire::encode).collect();
    let replica: Vec<_> = replica().iter().map(prairie_core::wire::encode).collect();
    vec![
        ("server_messages", "replica".to_owned(), joined(lawn.iter().chain(&replica))),
        ("server_messages", "vectors".to_owned(), joined(scenes.iter().chain(&rest).map(|(_, bytes)| bytes))),
        ("server_messages", "without_scene".to_owned(), joined(rest.iter().map(|(_, bytes)| bytes))),
        ("server_messages", "lawn".to_owned(), joined(lawn.iter())),
    ]
}

/// The state of the target's lawn at rest, and steps in which a ball rolls over it.
fn replica() -> Vec<ServerMessage> {
    let terrain = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [1.0, 1.0], level_m: 0.1, base_m: 0.0 };
    let patches = Patches { count: [3, 2], cells: 8, ..Patches::default() };
    let scene = Scene { patches, wind: Wind { cells: [4, 2, 4], ..Wind::default() }, ..Scene::new(terrain) };
    let map = grey_png([4; 2], &[255; 16]);
    let (height, cover) = (HeightMap::from_png(&map, &scene.terrain).unwrap(), CoverMap::from_png(&map).unwrap());
    let bend = BendSimulation::new(&scene, height.into(), &cover, &[], &Default::default()).state();
    let mut codec = StepCodec::default();
    let payload = ReplicaState { tick: 20, bend, codec: codec.clone() }.encode();
    let pose = |tick: u64| BodyPose { position_m: [0.1 * tick as f32, 25.6, 2.0], ..BodyPose::IDENTITY };
    let record = |tick: u64| {
        let motion = Motion {
            kind: VehicleKind::Ball,
            from: pose(tick),
            to: pose(tick + 1),
            velocity_m_per_s: [6.0, 0.0, 0.0],
            part_rad: 0.0,
            is_at_rest: false,
        };
        let causes = Causes { motions: vec![motion.rounded()], ..Causes::default() };
        StepRecord { tick, causes, objects: vec![(1, 0.0)], ..StepRecord::default() }
    };
    let records: Vec<_> = (21..30).map(record).collect();
    let EncodedSteps { first_tick, heads, moves } = codec.encode(&records).unwrap();
    vec![
        ServerMessage::ReplicaState { tick: 20, part: 0, parts: 1, payload },
        ServerMessage::Steps { first_tick, steps: heads, moves },
        ServerMessage::FrameEnd { frame: 2, tick: 32, time_secs: 0.5 },
    ]
}

/// A key frame and a noisy one, in the layout of the target: columns and planes, rows, slope of the base, payload.
fn grids() -> Vec<Seed> {
    let shape = Shape::wind(16, true);
    let len = shape.planes * shape.width * 16;
    let smooth: Vec<i16> = (0..len).map(|at| (at % 16 * 7) as i16 - 50).collect();
    let noisy: Vec<i16> = (0..len).map(|at| ((at * at * 31 + at * 17) % 251) as i16 - 127).collect();
    [("smooth", smooth), ("noisy", noisy)]
        .map(|(name, codes)| {
            let payload = codec::encode(shape, &codes, Some(&vec![0; len]));
            ("codec", name.to_owned(), [&[31, 15, 0], payload.as_slice()].concat())
        })
        .into()
}

/// A lawn of 3 × 3 patches of 8 × 8 cells, on which a car finds room.
fn lawn() -> LoadedScene {
    let terrain = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [1.0, 1.0], level_m: 0.1, base_m: 0.0 };
    let patches = Patches { count: [3, 3], cells: 8, cell_m: 1.0, ..Patches::default() };
    let wind = Wind { cells: [4, 4, 4], ..Wind::default() };
    let scene = Scene { summary: "a lawn".to_owned(), patches, wind, ..Scene::new(terrain) };
    let map = grey_png([2; 2], &[255; 4]);
    LoadedScene {
        name: "lawn".to_owned(),
        height: HeightMap::from_png(&map, &scene.terrain).unwrap(),
        cover: CoverMap::from_png(&map).unwrap(),
        height_png: map.clone(),
        covering_png: map,
        nutrient_png: Vec::new(),
        nutrients: None,
        scene,
        drawings: Default::default(),
        models: Vec::new(),
        files: Vec::new(),
        explanation: Default::default(),
    }
}

/// Commands of every kind.
fn commands(tick: u64) -> Vec<Command> {
    match tick {
        0 => vec![Command::Join { client: 1 }, Command::Spawn { client: 1, kind: VehicleKind::Car }],
        5 => vec![Command::Drive { client: 1, number: 0, drive: Drive { throttle: 0.8, steer: 0.3, ..Drive::default() } }],
        9 => vec![Command::Cameras(vec![Camera { client: 1, eye_m: [8.0, 2.0, 8.0] }])],
        20 => vec![Command::Join { client: 2 }, Command::Spawn { client: 2, kind: VehicleKind::ALL[1] }, Command::Leave { client: 1 }],
        23 => {
            let detail = Detail { wind_ticks: 4, awake_limit: 20, publish_divisor: 2 };
            vec![Command::Adapt(Decision {
                tick,
                detail,
                unloaded: detail,
                level: 2,
                reason: Reason::Overload { busy_ms: 9.0, budget_ms: 8.0 },
            })]
        }
        25 => vec![Command::Return { client: 1 }, Command::Remove { client: 2 }],
        _ => vec![],
    }
}

/// The journal and the checkpoints of a world of 30 steps, and its plain state.
fn memory() -> Vec<Seed> {
    let folder = tempfile::tempdir().unwrap();
    let mut kept = open(Some(&WorldFolder::new(folder.path().to_owned())), &lawn()).unwrap();
    let mut world = World::new(&lawn().scene, lawn().maps()).unwrap();
    let young = world.save().encode();
    for tick in 0..30 {
        kept.step(&commands(tick));
        world.step(&commands(tick));
    }
    assert!(world.object_of(1).is_some(), "a car drives");
    drop(kept);
    let world_folder = find(folder.path()).unwrap();
    let read = |name: &str| fs::read(world_folder.join(name)).unwrap();
    vec![
        ("segment", "driven".to_owned(), read("00000001.journal")),
        ("segment", "empty".to_owned(), read("00000002.journal")),
        ("checkpoint", "young_state".to_owned(), young),
        ("checkpoint", "driven_state".to_owned(), world.save().encode()),
        ("checkpoint", "driven_file".to_owned(), read("00000002.checkpoint")),
    ]
}

/// Scene files, and an underbrush file with one species.
fn scenes() -> Vec<Seed> {
    let second = SPECIES.match_indices("[[underbrush]]").nth(1).expect("several species").0;
    let texts = SCENES.into_iter().chain([("underbrush", &SPECIES[..second])]);
    texts.map(|(name, text)| ("scene", name.to_owned(), text.as_bytes().to_owned())).collect()
}

fn seeds() -> Vec<Seed> {
    [client_messages(), server_messages(), grids(), memory(), scenes()].concat()
}

/// Messages with their lengths before them, apart.
fn apart(mut bytes: &[u8]) -> Vec<&[u8]> {
    let mut messages = vec![];
    while let Some((length, rest)) = bytes.split_first_chunk() {
        let (message, rest) = rest.split_at(u16::from_le_bytes(*length).into());
        messages.push(message);
        bytes = rest;
    }
    messages
}

fn is_valid(target: &str, name: &str, bytes: &[u8]) -> bool {
    match target {
        "client_message" => decode::<ClientMessage>(bytes, CLIENT_MESSAGE_LIMIT).is_ok(),
        "server_messages" => apart(bytes).iter().all(|message| decode::<ServerMessage>(message, SERVER_MESSAGE_LIMIT).is_ok()),
        "codec" => codec::decode(Shape::wind(16, true), &bytes[3..], &mut vec![0; 4 * 16 * 16]).is_ok(),
        "segment" => Segment::parse(bytes).is_ok_and(|segment| segment.fault.is_none()),
        "checkpoint" if name.ends_with("file") => open_checkpoint(bytes).is_ok(),
        "checkpoint" => WorldState::decode(bytes).is_ok(),
        "scene" if name == "underbrush" => parse_underbrush(std::str::from_utf8(bytes).unwrap()).is_ok(),
        "scene" => parse(std::str::from_utf8(bytes).unwrap()).is_ok(),
        _ => false,
    }
}

#[test]
fn the_stored_seeds_of_the_fuzz_targets_are_valid() {
    let mut total_bytes = 0;
    for (target, name, bytes) in seeds() {
        let path = corpus().join(target).join(&name);
        if std::env::var_os("PRAIRIE_UPDATE").is_some() {
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(&path, &bytes).unwrap();
        }
        let stored = fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}; run again with PRAIRIE_UPDATE=1", path.display()));
        assert!(is_valid(target, &name, &bytes), "{target}/{name}: the generated seed");
        assert!(is_valid(target, &name, &stored), "{} is of an older version; run again with PRAIRIE_UPDATE=1", path.display());
        total_bytes += stored.len();
    }
    assert!(total_bytes <= 200_000, "{total_bytes} bytes");
}
