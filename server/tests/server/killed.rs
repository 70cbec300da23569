//! A program that is killed while a client drives: it resumes where it was, and the client is back in its vehicle.

use crate::common::Replica;
use crate::test_client::TestClient;
use crate::test_server::within;
use prairie::journal::{Player, find, recorded};
use prairie::world::World;
use prairie_core::scene::VehicleKind;
use prairie_core::wire::{ClientMessage, Drive, ObjectPose, ServerMessage};
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};
use tokio::io::{AsyncBufReadExt as _, AsyncReadExt as _, AsyncWriteExt as _, BufReader, Lines};
use tokio::net::TcpStream;
use tokio::process::{Child, ChildStderr, Command};

struct Program {
    child: Child,
    address: String,
    log: Lines<BufReader<ChildStderr>>,
}

impl Program {
    async fn start(world: &Path) -> Self {
        Self::start_with(Command::new(env!("CARGO_BIN_EXE_prairie")), world).await
    }

    async fn start_with(mut command: Command, world: &Path) -> Self {
        command.args(["serve", "--scene", "blades", "--addr", "127.0.0.1:0", "--world"]).arg(world);
        Self::run(command).await
    }

    async fn run(mut command: Command) -> Self {
        command.env("NO_COLOR", "1");
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).kill_on_drop(true).spawn().unwrap();
        let mut printed = BufReader::new(child.stdout.take().unwrap()).lines();
        let log = BufReader::new(child.stderr.take().unwrap()).lines();
        let first = within(printed.next_line()).await.unwrap().expect("the address");
        Self { child, address: first.split("http://").nth(1).expect("an address").trim().to_owned(), log }
    }

    async fn connect(&self) -> TestClient<TcpStream> {
        TestClient::over(TcpStream::connect(&self.address).await.unwrap(), &format!("ws://{}/ws", self.address)).await
    }

    /// A client in a car.
    async fn driver(&self) -> TestClient<TcpStream> {
        let mut client = self.connect().await;
        enter(&mut client, &ClientMessage::Hello { name: "Ada".to_owned() }).await;
        client.send_message(&ClientMessage::Choose { vehicle: Some(VehicleKind::Car) }).await;
        own_object(&mut client).await;
        client
    }

    /// Body of the response to a request.
    async fn get(&self, path: &str) -> String {
        let mut stream = TcpStream::connect(&self.address).await.unwrap();
        let request = format!("GET {path} HTTP/1.1\r\nhost: {}\r\nconnection: close\r\n\r\n", self.address);
        stream.write_all(request.as_bytes()).await.unwrap();
        let mut response = String::new();
        within(stream.read_to_string(&mut response)).await.unwrap();
        response.split_once("\r\n\r\n").expect("a response").1.to_owned()
    }

    /// The first line of the log with `text`.
    async fn logged(&mut self, text: &str) -> String {
        within(async {
            loop {
                let line = self.log.next_line().await.unwrap().unwrap_or_else(|| panic!("no line with `{text}`"));
                if line.contains(text) {
                    return line;
                }
            }
        })
        .await
    }
}

/// Sends the first message, and returns the proof of the welcome.
async fn enter(client: &mut TestClient<TcpStream>, first: &ClientMessage) -> [u8; 32] {
    client.send_message(first).await;
    let welcome = client.receive().await.unwrap();
    let ServerMessage::Welcome { client: id, proof, .. } = welcome else { panic!("{welcome:?}") };
    client.id = id;
    assert!(matches!(client.receive().await, Ok(ServerMessage::Scene { .. })));
    client.send_message(&ClientMessage::View { eye_m: [12.0, 2.0, 12.0], radius_m: 100.0 }).await;
    proof
}

async fn own_object(client: &mut TestClient<TcpStream>) -> u32 {
    client.frames_until(|client| client.peers.iter().any(|peer| peer.0 == client.id && peer.2.is_some())).await;
    client.peers.iter().find(|peer| peer.0 == client.id).and_then(|peer| peer.2).unwrap()
}

/// The tick that a line of the log names.
fn tick(line: &str) -> u64 {
    line.split("tick=").nth(1).and_then(|rest| rest.split_whitespace().next()).and_then(|tick| tick.parse().ok()).expect("a tick")
}

/// Lets a client drive for `frames` frames, kills the program, and resumes; all steps twice.
async fn kill_and_return(frames: usize) {
    let folder = tempfile::tempdir().unwrap();
    let mut program = Program::start(folder.path()).await;
    let mut client = program.connect().await;
    let mut proof = enter(&mut client, &ClientMessage::Hello { name: "Ada".to_owned() }).await;
    client.send_message(&ClientMessage::Choose { vehicle: Some(VehicleKind::Car) }).await;
    let (id, object) = (client.id, own_object(&mut client).await);
    for round in 0..2 {
        for frame in 0..frames {
            let steer = (frame as f32 * 0.3).sin();
            client.send_message(&ClientMessage::Drive { number: 1, drive: Drive { throttle: 1.0, steer, ..Drive::default() } }).await;
            client.frame().await;
        }
        let seen = client.replica.tick;
        // At any moment between two steps, or in one.
        tokio::time::sleep(Duration::from_micros(frames as u64 * 7919 % 16_667)).await;
        program.child.kill().await.unwrap();
        let (_, mut player) = recorded(folder.path(), None).unwrap();
        player.advance(u64::MAX);
        let (reached, sum) = (player.world.tick(), player.world.checksum());
        assert!(reached + 6 >= seen, "round {round}: the client saw step {seen}, the journal has {reached}");

        let begun = Instant::now();
        program = Program::start(folder.path()).await;
        assert!(begun.elapsed() < Duration::from_secs(5), "resumed after {:?}", begun.elapsed());
        assert_eq!(tick(&program.logged("resumed the world").await), reached);
        let (_, newest) = newest_at(folder.path(), reached);
        assert_eq!(newest, sum, "round {round}: the resumed world is that of an undisturbed replay");

        let mut wrong = program.connect().await;
        let mut forged = proof;
        forged[7] ^= 1;
        enter(&mut wrong, &ClientMessage::Return { name: "Eve".to_owned(), client: id, proof: forged }).await;
        assert!(wrong.id != id, "a wrong proof gives a new number");
        drop(wrong);

        client = program.connect().await;
        client.replica = Replica::default();
        proof = enter(&mut client, &ClientMessage::Return { name: "Ada".to_owned(), client: id, proof }).await;
        assert_eq!((client.id, own_object(&mut client).await), (id, object), "the client is back in its vehicle");
        assert!(client.replica.tick >= reached);
    }
}

/// Step and checksum of the state at a step, from the newest checkpoint before it.
fn newest_at(folder: &Path, tick: u64) -> (u64, u64) {
    let world = world_at(folder, tick);
    (world.tick(), world.checksum())
}

fn world_at(folder: &Path, tick: u64) -> World {
    let (scene, _) = recorded(folder, None).unwrap();
    let mut player = Player::open(&find(folder).unwrap(), &scene, tick).unwrap().unwrap();
    player.advance(tick);
    player.world
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_killed_world_is_resumed_and_its_clients_are_back_in_their_vehicles() {
    for frames in [1, 7] {
        kill_and_return(frames).await;
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
#[ignore = "takes many minutes; cargo nextest run --release -p prairie --run-ignored only a_world_killed_200_times_is_always_resumed"]
async fn a_world_killed_200_times_is_always_resumed() {
    for n in 0..100 {
        kill_and_return(1 + n * 37 % 90).await;
    }
}

/// What the program prints with these arguments.
async fn printed(arguments: &[&str]) -> String {
    let output = Command::new(env!("CARGO_BIN_EXE_prairie")).args(arguments).output().await.unwrap();
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_world_is_replayed_at_any_speed_for_viewers_who_change_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut program = Program::start(folder.path()).await;
    let mut client = program.driver().await;
    client.send_message(&ClientMessage::Drive { number: 1, drive: Drive { throttle: 1.0, ..Drive::default() } }).await;
    for _ in 0..200 {
        client.frame().await;
    }
    program.child.kill().await.unwrap();
    let (_, mut player) = recorded(folder.path(), None).unwrap();
    player.advance(u64::MAX);
    let (reached, sum) = (player.world.tick(), player.world.checksum());
    let world = folder.path().to_str().unwrap();
    let unseen = printed(&["replay", world, "--addr", "none"]).await;
    assert_eq!(unseen.trim(), format!("steps 0 to {reached}, checksum {sum:016x}"));
    assert_eq!(printed(&["diff", world, world]).await.trim(), format!("equal up to their end after step {reached}"));

    let mut command = Command::new(env!("CARGO_BIN_EXE_prairie"));
    command.args(["replay", world, "--addr", "127.0.0.1:0", "--from", "0", "--speed", "2"]);
    let replay = Program::run(command).await;
    let mut viewer = replay.connect().await;
    enter(&mut viewer, &ClientMessage::Hello { name: "Eve".to_owned() }).await;
    viewer.send_message(&ClientMessage::Choose { vehicle: Some(VehicleKind::Monster) }).await;
    let mut ticks = vec![];
    while viewer.replica.tick < reached {
        viewer.frame().await;
        ticks.push(viewer.replica.tick);
    }
    ticks.pop();
    let steps: Vec<u64> = ticks.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!(steps.len() > 2 && steps.iter().all(|steps| steps.is_multiple_of(6)), "a publication is three steps of the clock: {steps:?}");
    for _ in 0..10 {
        viewer.frame().await;
    }
    assert_eq!(viewer.replica.tick, reached, "it stands still at its end");
    assert_eq!(viewer.objects.len(), client.objects.len(), "no monster was added");
}

#[cfg(target_os = "linux")]
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_full_disk_is_logged_once_and_reported_and_stops_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut limited = Command::new("sh");
    limited.args(["-c", &format!("ulimit -f 2; exec {} \"$@\"", env!("CARGO_BIN_EXE_prairie")), "sh"]);
    let mut program = Program::start_with(limited, folder.path()).await;
    let line = program.logged("cannot be written").await;
    assert!(line.contains("a checkpoint of the world"), "{line}");
    let mut client = program.driver().await;
    for _ in 0..100 {
        client.frame().await;
    }
    let health: serde_json::Value = serde_json::from_str(&program.get("/healthz").await).unwrap();
    let reason =
        health["reasons"].as_array().unwrap().iter().filter_map(|reason| reason.as_str()).find(|reason| reason.contains("written"));
    assert!(health["status"] == "degraded" && reason.is_some_and(|reason| reason.contains("a crash loses")), "{health}");
    assert!(health["journal_failures"].as_u64() > Some(0) && health["journal_checkpoints"] == 0, "{health}");
}

/// Limits the size of the files that a running program can write.
#[cfg(target_os = "linux")]
async fn limit_files(program: &Program, bytes: &str) {
    let pid = program.child.id().expect("it runs").to_string();
    let status = Command::new("prlimit").args(["--pid", &pid, &format!("--fsize={bytes}:unlimited")]).status().await.unwrap();
    assert!(status.success(), "prlimit failed");
}

/// Drives on, for `frames` frames. Returns their steps, with the objects.
#[cfg(target_os = "linux")]
async fn drive_on(client: &mut TestClient<TcpStream>, frames: usize) -> Vec<(u64, Vec<ObjectPose>)> {
    let mut seen = vec![];
    for frame in 0..frames {
        let drive = Drive { throttle: 1.0, steer: (frame as f32 * 0.3).sin(), ..Drive::default() };
        client.send_message(&ClientMessage::Drive { number: 1, drive }).await;
        client.frame().await;
        seen.push((client.replica.tick, client.objects.clone()));
    }
    seen
}

#[cfg(target_os = "linux")]
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_disk_that_is_full_for_a_while_costs_only_that_while() {
    for is_room_again in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let mut program = Program::start(folder.path()).await;
        let mut client = program.driver().await;
        let mut frames = drive_on(&mut client, 60).await;
        let before = client.replica.tick;
        limit_files(&program, "1").await;
        drive_on(&mut client, 60).await;
        program.logged("cannot be written").await;
        let full = client.replica.tick;
        if is_room_again {
            limit_files(&program, "unlimited").await;
            within(async {
                while program.get("/healthz").await.contains("cannot be written") {
                    drive_on(&mut client, 5).await;
                }
            })
            .await;
            frames = drive_on(&mut client, 60).await;
        }
        let seen = client.replica.tick;
        program.child.kill().await.unwrap();
        let (reached, sum) = newest_at(folder.path(), u64::MAX);
        let wanted = if is_room_again { seen } else { before };
        assert!(reached + 6 >= wanted, "step {wanted} was written, the journal has {reached}");
        assert!(is_room_again || reached < full, "step {reached} was written to a full disk");

        // Nothing is missing in the journal: the car is where the client saw it.
        let (at, objects) = frames.iter().rfind(|(at, _)| *at <= reached).expect("a frame of a step in the journal");
        assert_eq!(world_at(folder.path(), *at).snapshot().objects, *objects, "objects at step {at}");
        let mut program = Program::start(folder.path()).await;
        assert_eq!(tick(&program.logged("resumed the world").await), reached);
        assert_eq!(newest_at(folder.path(), reached), (reached, sum), "the new checkpoint is the replayed state");
    }
}

/// Value of a series without labels in a scrape.
fn scraped(text: &str, name: &str) -> f64 {
    let line = text.lines().find(|line| line.split(' ').next() == Some(name)).unwrap_or_else(|| panic!("no {name}: {text}"));
    line.rsplit_once(' ').and_then(|(_, value)| value.parse().ok()).unwrap_or_else(|| panic!("{line}"))
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_journal_is_scraped_and_zero_without_memory() {
    let folder = tempfile::tempdir().unwrap();
    let counters = ["bytes_total", "checkpoints_total", "failures_total", "lost_steps_total", "copy_max_seconds"];
    let names = counters.map(|name| format!("prairie_journal_{name}"));
    let kept = Program::start(folder.path()).await;
    let mut client = kept.connect().await;
    enter(&mut client, &ClientMessage::Hello { name: "Ada".to_owned() }).await;
    let values = within(async {
        loop {
            let text = kept.get("/metrics").await;
            let values = names.each_ref().map(|name| scraped(&text, name));
            if values[0] > 0.0 && values[1] > 0.0 {
                return values;
            }
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    })
    .await;
    assert!(values[2] == 0.0 && values[4] > 0.0 && values[4] < 10.0, "{values:?}");

    let forgetful = Program::start(Path::new("none")).await;
    let text = forgetful.get("/metrics").await;
    assert_eq!(names.map(|name| scraped(&text, &name)), [0.0; 5]);
    assert!(!forgetful.get("/healthz").await.contains("cannot be written"));
}
