//! The client in Python of `examples/python` agrees with the test vectors, and with the native client on a running server.

use crate::test_client::PlainClient;
use crate::test_server::Server;
use data_encoding::HEXLOWER;
use prairie::scenes;
use prairie_core::scene::VehicleKind;
use prairie_core::terrain::KindMap;
use prairie_core::wind::WindField;
use prairie_core::wire::quantise::CodeSteps;
use prairie_core::wire::{ClientMessage, Drive, ServerMessage, TurbulenceState};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Output;
use std::sync::Arc;
use tokio::process::Command;

/// Frames that the client in Python receives: three seconds.
const FRAMES: usize = 60;

/// A program in Python, with the interpreter that has its packages.
fn python(program: &str) -> Command {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let in_environment = if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" };
    let interpreter: PathBuf = package.join("../target/python").join(in_environment);
    assert!(interpreter.exists(), "{} is missing: run `.ci/check setup`", interpreter.display());
    let mut command = Command::new(interpreter);
    command.arg(package.join(program)).env("PYTHONDONTWRITEBYTECODE", "1").kill_on_drop(true);
    command
}

/// What a program printed.
///
/// # Panics
/// When it has failed.
fn printed(output: Output) -> String {
    let [stdout, stderr] = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
    assert!(output.status.success(), "{}\n{stdout}\n{stderr}", output.status);
    stdout
}

#[tokio::test]
async fn the_python_client_agrees_with_the_test_vectors() {
    let found = printed(python("examples/python/check_vectors.py").output().await.unwrap());
    assert!(found.contains("values compared, 0 differ"), "{found}");
}

/// A frame, as `watch.py` prints it.
#[derive(Deserialize)]
struct Seen {
    /// Grids that are new in this frame, by the index of the patch or `wind`: sequence number, and codes in hexadecimal.
    grids: BTreeMap<String, (u32, String)>,
    /// Sequence number of the newest wind; 0 before the first one.
    wind_seq: u32,
    /// Wind at [`PLACE_M`], 2 m above the ground.
    wind_m_per_s: [f32; 3],
}

/// Camera of both clients (m, X and Z): that of [`PlainClient`], with the same radius.
const PLACE_M: [f32; 2] = [12.0, 12.0];
const RADIUS_M: f32 = 100.0;

/// Every grid that the native client has received, by name and sequence number, and the state of the gusts by that of the wind.
#[derive(Default)]
struct Received {
    grids: BTreeMap<(String, u32), Vec<i16>>,
    turbulence: BTreeMap<u32, TurbulenceState>,
}

impl Received {
    /// Receives the next message, and acknowledges a frame.
    async fn next(&mut self, client: &mut PlainClient) {
        match client.receive().await.expect("the connection stays open") {
            ServerMessage::Patch { patch, seq, .. } => {
                self.grids.insert((patch.to_string(), seq), client.replica.patches[&patch].1.clone());
            }
            ServerMessage::Wind { seq, turbulence, .. } => {
                self.grids.insert(("wind".to_owned(), seq), client.replica.wind.1.clone());
                self.turbulence.insert(seq, turbulence);
            }
            ServerMessage::FrameEnd { frame, .. } => client.send_message(&ClientMessage::Ack { frame }).await,
            _ => {}
        }
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_python_client_sees_the_wind_and_the_track_of_a_car() {
    let server = Server::start_meadow().await;
    let mut driver = PlainClient::join(&server, "driver").await;
    driver.send_message(&ClientMessage::Choose { vehicle: Some(VehicleKind::Car) }).await;
    driver.send_message(&ClientMessage::Drive { number: 1, drive: Drive { throttle: 0.5, ..Drive::default() } }).await;
    let mut received = Received::default();
    while driver.objects.is_empty() {
        received.next(&mut driver).await;
    }
    let numbers = [FRAMES as f32, PLACE_M[0], PLACE_M[1], RADIUS_M].map(|number| number.to_string());
    let mut watcher = python("tests/server/watch.py");
    watcher.arg(format!("ws://{}/ws", server.address)).args(numbers);
    let mut watching = tokio::spawn(async move { watcher.output().await });
    let output = loop {
        tokio::select! {
            output = &mut watching => break output.unwrap().unwrap(),
            () = received.next(&mut driver) => {}
        }
    };
    let seen: Vec<Seen> = printed(output).lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(seen.len(), FRAMES);
    compare(&seen, &received);
    server.stop().await;
}

/// Compares the codes of every grid that both clients have received, and the wind.
fn compare(seen: &[Seen], received: &Received) {
    let (mut winds, mut patches, mut deepest) = (0, 0, 0);
    for (name, (seq, found)) in seen.iter().flat_map(|seen| &seen.grids) {
        let Some(codes) = received.grids.get(&(name.clone(), *seq)) else { continue };
        let bytes: Vec<u8> = codes.iter().flat_map(|code| code.to_be_bytes()).collect();
        assert!(*found == HEXLOWER.encode(&bytes), "frame {seq} of grid {name} differs");
        if name == "wind" {
            winds += 1;
        } else {
            patches += 1;
            deepest = codes[..codes.len() / 3].iter().copied().max().unwrap_or_default().max(deepest);
        }
    }
    assert!(winds >= 5 && patches >= 10, "{winds} frames of the wind and {patches} of patches reached both clients");
    assert!(deepest >= CodeSteps::default().theta_code(1.0), "the car has pressed the grass to code {deepest}");

    let scene = scenes::load("meadow").unwrap().scene;
    let mut field = WindField::still(&scene, Arc::new(KindMap::uniform()));
    for Seen { wind_seq, wind_m_per_s, .. } in seen {
        let Some(state) = received.turbulence.get(wind_seq) else { continue };
        field.set(&received.grids[&("wind".to_owned(), *wind_seq)], state);
        let wanted = field.wind_at([PLACE_M[0], 2.0, PLACE_M[1]]);
        let off = (0..3).map(|axis| (wind_m_per_s[axis] - wanted[axis]).abs()).fold(0.0, f32::max);
        assert!(off <= 1e-4, "{wind_m_per_s:?} m/s instead of {wanted:?}");
    }
}
