use super::*;
use crate::detail::{Decision, Detail, Reason};
use crate::inspect::Inspector;
use crate::inspect::entities::{ENTITIES, Entity, Rate, Row};
use crate::inspect::log::TIMELINES;
use crate::inspect::plots::PLOTS;
use crate::snapshot::Snapshot;
use crate::snapshot::{Diagnostics, PatchCodes, WindFrame};
use prairie_core::body::{BodyPose, Motion};
use prairie_core::grass::{Causes, StepRecord};
use prairie_core::scene::VehicleKind;
use prairie_core::terrain::grey_png;
use prairie_core::wire::ObjectPose;
use prairie_core::wire::TurbulenceState;
use prairie_core::wire::quantise::CodeSteps;
use rerun::external::re_log_encoding::DecoderApp;
use rerun::log::{Chunk, LogMsg};
use std::collections::{BTreeMap, BTreeSet};
use std::io::BufReader;
use std::net::TcpListener;
use std::time::Duration;

fn scene() -> Scene {
    toml::from_str("summary = 'x'\n[terrain]\nheight_map = 'a'\ncovering_map = 'b'\npixel_m = [2.0, 2.0]\nlevel_m = 0.1\n[wind.dust]\nrelease_per_s = 1.0\n").unwrap()
}

fn flat() -> HeightMap {
    HeightMap::from_heights(2, 2, [256.0, 256.0], vec![3.0; 4])
}

fn grass() -> CoverMap {
    CoverMap::from_png(&grey_png([2; 2], &[255; 4])).unwrap()
}

fn open(target: &Target) -> Result<Inspector, InspectError> {
    Inspector::start(target, &[], &scene(), &flat(), &grass())
}

fn pose(kind: VehicleKind, x_m: f32) -> ObjectPose {
    let (rotation, velocity_m_per_s) = ([0.0, 0.0, 0.0, 1.0], [60.0, 0.0, 0.0]);
    ObjectPose { id: 7, kind, position_m: [x_m, 4.0, 50.0], rotation, velocity_m_per_s, part_rad: 0.0 }
}

fn driven(tick: u64) -> Snapshot {
    let car = pose(VehicleKind::Car, 40.0 + tick as f32);
    let patches = Arc::new([(tick as u32 % 256, Arc::new(PatchCodes { tick, codes: vec![50; 3 * 64 * 64] }))].into());
    let wind = Arc::new(WindFrame {
        tick,
        cells: [32, 8, 32],
        turbulence: TurbulenceState::default(),
        codes: vec![CodeSteps::default().wind_code(3.0); 4 * 32 * 8 * 32],
    });
    let detail = Detail { wind_ticks: 3, awake_limit: 100, publish_divisor: 1 };
    let reason = Reason::Relief { busy_ms: 1.0, budget_ms: 2.0 };
    let decisions = vec![Decision { tick, detail, unloaded: detail, level: 0, reason }];
    // A decision before each frame.
    let diagnostics = Diagnostics { decisions: tick / 6 + 1, ..Diagnostics::default() };
    let at = BodyPose { position_m: car.position_m, ..BodyPose::IDENTITY };
    let still = [0.0; 3];
    let motion = Motion { kind: car.kind, from: at, to: at, velocity_m_per_s: still, part_rad: 0.0, is_at_rest: false };
    let causes = Causes { motions: vec![motion], evicted: vec![7], ..Causes::default() };
    let steps = vec![Arc::new(StepRecord { tick, wind_tick: tick, causes, objects: vec![(7, 0.0)], checks: vec![] })];
    Snapshot {
        tick,
        time_secs: tick as f64 / 60.0,
        objects: vec![car],
        wind,
        patches,
        steps,
        decisions,
        diagnostics,
        ..Snapshot::default()
    }
}

/// Chunks of a recording by path: numbers of rows on timelines, and whether there are static ones.
struct Recorded {
    rows: BTreeMap<String, u64>,
    kept: BTreeSet<String>,
    stores: usize,
}

/// Reads a file. Every chunk that is not static has all timelines.
fn read(path: &Path) -> Recorded {
    let mut messages = DecoderApp::decode_eager(BufReader::new(File::open(path).unwrap())).unwrap();
    let (mut rows, mut kept): (BTreeMap<String, u64>, _) = (BTreeMap::new(), BTreeSet::new());
    for message in messages.by_ref() {
        if let LogMsg::ArrowMsg(store, arrow) = message.unwrap()
            && store.is_recording()
        {
            let chunk = Chunk::from_arrow_msg(&arrow).unwrap();
            let path = chunk.entity_path().to_string().trim_start_matches('/').to_owned();
            if chunk.is_static() {
                kept.insert(path);
                continue;
            }
            let timelines: BTreeSet<_> = chunk.timelines().keys().map(|name| name.to_string()).collect();
            assert_eq!(timelines, TIMELINES.map(str::to_owned).into(), "{path}");
            *rows.entry(path).or_default() += chunk.num_rows() as u64;
        }
    }
    Recorded { rows, kept, stores: messages.rrd_manifests().unwrap().len() }
}

/// Paths at which a row of the table is recorded: its own, or those of the curves.
fn paths(row: &Row) -> Vec<String> {
    match row.entity {
        Entity::Metrics => PLOTS.iter().flat_map(|plot| plot.curves.iter().map(|curve| plot.entity(curve))).collect(),
        _ => vec![row.path.to_owned()],
    }
}

/// Records frames of a drive in `file`; returns how many were not dropped.
fn record(rates: &[&str], frames: u64, file: &Path) -> u64 {
    let rates: Vec<EntityRate> = rates.iter().map(|rate| rate.parse().unwrap()).collect();
    let inspector = Inspector::start(&Target::Save(file.to_owned()), &rates, &scene(), &flat(), &grass()).unwrap();
    for frame in 0..frames {
        inspector.observe(&driven(6 * frame));
        // The logger keeps up, so that every frame is recorded.
        std::thread::sleep(Duration::from_millis(50));
    }
    inspector.finish().unwrap();
    frames - inspector.dropped()
}

#[test]
fn a_file_has_the_entities_of_the_table_and_no_others() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.rrd");
    let frames = record(&[], 5, &file);
    let found = read(&file);
    assert_eq!(found.stores, 2, "the footer lists the blueprint and the recording");
    for row in ENTITIES {
        for path in paths(row) {
            let rows = found.rows.get(&path).copied();
            let wanted = match row.rate {
                Rate::Once => None,
                Rate::Event => Some(frames - 1),
                Rate::Hz(10.0) => Some(frames),
                Rate::Hz(_) => Some(1),
            };
            assert_eq!(rows, wanted, "rows of {path}");
            assert!(row.rate != Rate::Once || found.kept.contains(&path), "{path} is missing");
        }
    }
    let known: BTreeSet<String> = ENTITIES.iter().flat_map(paths).collect();
    // Properties of the recording as a whole, which the SDK adds.
    let unknown = found.rows.keys().chain(&found.kept).filter(|path| !known.contains(*path) && !path.starts_with("__"));
    assert_eq!(unknown.collect::<Vec<_>>(), Vec::<&String>::new());
}

#[test]
fn entities_are_recorded_at_the_stated_rates() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("run.rrd");
    let off = ["land/height=0", "metrics=0", "events=0", "world/ground=0"];
    let frames = record(&[&off[..], &["world/trails=5", "wind/velocity=10"]].concat(), 5, &file);
    let found = read(&file);
    assert_eq!(frames, 5);
    assert_eq!([found.rows.get("world/trails"), found.rows.get("wind/velocity")], [Some(&3), Some(&5)]);
    for path in ["land/height", "events", "world/ground"].into_iter().map(str::to_owned).chain(paths(Entity::Metrics.row())) {
        assert!(!found.rows.contains_key(&path) && !found.kept.contains(&path), "{path} is off");
    }
}

#[test]
fn a_file_without_its_footer_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.rrd");
    let inspector = open(&Target::Save(path.clone())).unwrap();
    inspector.observe(&driven(0));
    inspector.finish().unwrap();
    check_footer(&path).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    std::fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
    assert!(matches!(check_footer(&path), Err(InspectError::NoFooter { .. })));
}

#[test]
fn a_port_in_use_is_an_error() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let addr = listener.local_addr().unwrap();
    let error = open(&Target::Serve(addr)).err().unwrap();
    assert!(matches!(error, InspectError::Address { .. }));
    assert!(error.to_string().contains(&addr.to_string()), "{error}");
}

#[test]
fn a_served_recording_reports_its_address() {
    let inspector = open(&"serve=0".parse().unwrap()).unwrap();
    let addr = inspector.target().strip_prefix("rerun+http://").and_then(|rest| rest.strip_suffix("/proxy")).unwrap();
    assert!(addr.starts_with("127.0.0.1:") && !addr.ends_with(":0"), "{addr}");
    inspector.observe(&driven(0));
    inspector.finish().unwrap();
}

#[test]
fn an_absent_viewer_and_a_bad_path_are_errors() {
    let free = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let absent = open(&format!("connect=rerun+http://{free}/proxy").parse().unwrap());
    assert!(matches!(absent.err(), Some(InspectError::NoViewer { .. })));
    let nowhere = open(&Target::Save("/no/such/folder/a.rrd".into()));
    assert!(matches!(nowhere.err(), Some(InspectError::File { .. })));
}
