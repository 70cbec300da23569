//! The server as its visitors meet it, on a free port: what good ones get, and that bad ones are closed with a reason and disturb nobody.

mod common;

use common::Picture;
use futures_util::{SinkExt, StreamExt};
use server::net::{Tls, TlsChoice, bind};
use server::runner::Simulation;
use server::scenes::LoadedScene;
use server::snapshot::{PatchCodes, Snapshot, WindFrame};
use server::world::Command;
use server::{Config, Limits, RunError, run, run_simulation, scenes};
use shared::grid::PatchLayout;
use shared::scene::{Patches, Scene, TerrainMaps, VehicleKind, Wind};
use shared::terrain::{CoverMap, HeightMap};
use shared::wire::quantise::theta_code;
use shared::wire::{ClientMessage, Close, Drive, ObjectId, ObjectPose, PROTOCOL, Refusal, ServerMessage, encode};
use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::sync::oneshot;
use tokio::task::JoinHandle;
use tokio_rustls::TlsConnector;
use tokio_rustls::rustls::client::danger::{HandshakeSignatureValid, ServerCertVerified, ServerCertVerifier};
use tokio_rustls::rustls::pki_types::{CertificateDer, ServerName, UnixTime};
use tokio_rustls::rustls::{self, ClientConfig, DigitallySignedStruct, SignatureScheme};
use tokio_tungstenite::WebSocketStream;
use tokio_tungstenite::tungstenite::client::IntoClientRequest;
use tokio_tungstenite::tungstenite::{self, Message};

const CELLS: usize = 8;
const PATCHES: usize = 9;
const WIND_CELLS: [u32; 3] = [4, 2, 4];
const OBJECT_LIMIT: usize = 3;
/// Longer than anything here takes, unless it hangs.
const PATIENCE: Duration = Duration::from_secs(20);

/// A small world that is never still: one patch after the other changes, and objects move as they are driven.
#[derive(Default)]
struct Meadow {
    tick: u64,
    objects: BTreeMap<u32, ObjectPose>,
    throttle: BTreeMap<u32, f32>,
    fails_at: Option<u64>,
}

impl Simulation for Meadow {
    fn step(&mut self, commands: &[Command]) {
        self.tick += 1;
        assert_ne!(Some(self.tick), self.fails_at, "told to fail");
        for command in commands {
            match *command {
                Command::Spawn { client, kind } if self.objects.len() < OBJECT_LIMIT => {
                    self.objects.insert(client, pose(client, kind));
                }
                Command::Remove { client } => {
                    self.objects.remove(&client);
                }
                Command::Drive { client, drive } => {
                    self.throttle.insert(client, drive.throttle);
                }
                Command::Spawn { .. } | Command::Views(_) => {}
            }
        }
        for (client, object) in &mut self.objects {
            object.position_m[2] -= self.throttle.get(client).copied().unwrap_or(0.0);
        }
    }

    fn snapshot(&mut self) -> Snapshot {
        let patch = |index: usize| {
            let tick = self.tick / PATCHES as u64 * PATCHES as u64 + index as u64;
            let codes = (0..3 * CELLS * CELLS).map(|i| ((tick as usize + i * index) % 200) as i8 / 2).collect();
            Some(Arc::new(PatchCodes { tick, codes }))
        };
        let wind = WindFrame { tick: self.tick, cells: WIND_CELLS, codes: vec![(self.tick % 100) as i8; 96] };
        Snapshot {
            tick: self.tick,
            time_secs: self.tick as f64 / 60.0,
            objects: self.objects.values().copied().collect(),
            wind: Arc::new(wind),
            patches: (0..PATCHES).map(patch).collect(),
            ..Snapshot::default()
        }
    }

    fn object_of(&self, client: u32) -> Option<ObjectId> {
        self.objects.get(&client).map(|pose| pose.id)
    }
}

fn pose(client: u32, kind: VehicleKind) -> ObjectPose {
    ObjectPose { id: 100 + client, kind, position_m: [0.0; 3], rotation: [0.0, 0.0, 0.0, 1.0], velocity_m_per_s: [0.0; 3], part_rad: 0.0 }
}

fn scene() -> LoadedScene {
    let terrain = TerrainMaps { height_map: String::new(), covering_map: String::new(), pixel_m: [1.0, 1.0], level_m: 0.1, base_m: 0.0 };
    let patches = Patches { count: [3, 3], cells: CELLS as u32, cell_m: 1.0, ..Patches::default() };
    let wind = Wind { cells: WIND_CELLS, ..Wind::default() };
    let scene = Scene {
        summary: "a test".to_owned(),
        seed: 1,
        tick_hz: 120.0,
        patches,
        terrain,
        wind,
        grass: Default::default(),
        plants: Default::default(),
        objects: Default::default(),
        camera: Default::default(),
        light: Default::default(),
    };
    let mut png_bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut png_bytes, 2, 2);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.write_header().unwrap().write_image_data(&[255; 4]).unwrap();
    LoadedScene {
        height: HeightMap::from_png(&png_bytes, &scene.terrain).unwrap(),
        cover: CoverMap::from_png(&png_bytes).unwrap(),
        height_png: png_bytes.clone(),
        covering_png: png_bytes,
        scene,
        models: Vec::new(),
    }
}

struct Server {
    address: SocketAddr,
    stop: oneshot::Sender<()>,
    outcome: JoinHandle<Result<(), RunError>>,
}

impl Server {
    async fn start(limits: Limits) -> Self {
        Self::start_with(Meadow::default(), limits, None).await.0
    }

    async fn start_with(world: Meadow, limits: Limits, tls: Option<TlsChoice>) -> (Self, Option<Tls>) {
        let listener = bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        let tls = tls.map(|choice| Tls::new(&choice, address).unwrap());
        let config = Config { tls: tls.clone(), limits, threads: Some(1), ..Config::new(scene()) };
        let (stop, stopped) = oneshot::channel();
        let shutdown = async { drop(stopped.await) };
        let outcome = tokio::spawn(run_simulation(world, config, listener, shutdown));
        (Self { address, stop, outcome }, tls)
    }

    /// The real thing: the default scene.
    async fn start_meadow() -> Self {
        let listener = bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        let (stop, stopped) = oneshot::channel();
        let config = Config::new(scenes::load("meadow").unwrap());
        Self { address, stop, outcome: tokio::spawn(run(config, listener, async { drop(stopped.await) })) }
    }

    async fn stop(self) {
        self.stop.send(()).unwrap();
        within(self.outcome).await.unwrap().unwrap();
    }

    /// Sends a request and returns the whole answer.
    async fn http(&self, request: &str) -> Vec<u8> {
        let mut stream = TcpStream::connect(self.address).await.unwrap();
        let host = self.address;
        stream.write_all(format!("{request}\r\nhost: {host}\r\nconnection: close\r\n\r\n").as_bytes()).await.unwrap();
        let mut answer = Vec::new();
        within(stream.read_to_end(&mut answer)).await.unwrap();
        answer
    }
}

async fn within<T>(future: impl Future<Output = T>) -> T {
    tokio::time::timeout(PATIENCE, future).await.expect("this takes far too long")
}

/// A visitor's end of a connection.
struct Visitor<S> {
    socket: WebSocketStream<S>,
    picture: Picture,
    client: u32,
    peers: Vec<(u32, String, Option<ObjectId>)>,
    objects: Vec<ObjectPose>,
    refusals: Vec<Refusal>,
}

type Plain = Visitor<TcpStream>;

impl Plain {
    /// Opens the socket and says nothing yet.
    async fn connect(server: &Server) -> Self {
        Self::over(TcpStream::connect(server.address).await.unwrap(), &format!("ws://{}/ws", server.address)).await
    }

    /// Opens the socket, says hello and waits for the scene.
    async fn join(server: &Server, name: &str) -> Self {
        let mut visitor = Self::connect(server).await;
        visitor.greet(name).await;
        visitor
    }
}

impl<S: AsyncRead + AsyncWrite + Unpin> Visitor<S> {
    async fn over(stream: S, url: &str) -> Self {
        let (socket, _) = within(tokio_tungstenite::client_async(url, stream)).await.unwrap();
        Self { socket, picture: Picture::default(), client: 0, peers: Vec::new(), objects: Vec::new(), refusals: Vec::new() }
    }

    async fn greet(&mut self, name: &str) {
        self.say(&ClientMessage::Hello { name: name.to_owned() }).await;
        let welcome = self.hear().await.unwrap();
        let ServerMessage::Welcome { client, .. } = welcome else { panic!("{welcome:?}") };
        self.client = client;
        assert!(matches!(self.hear().await, Ok(ServerMessage::Scene { .. })));
        self.say(&ClientMessage::View { eye_m: [12.0, 2.0, 12.0], radius_m: 100.0 }).await;
    }

    async fn say(&mut self, message: &ClientMessage) {
        self.send(Message::Binary(encode(message).into())).await;
    }

    async fn send(&mut self, message: Message) {
        // The server may have hung up already; that is seen when reading.
        let _ = within(self.socket.send(message)).await;
    }

    /// The next message, or the code and reason of the close.
    async fn hear(&mut self) -> Result<ServerMessage, (u16, String)> {
        loop {
            match within(self.socket.next()).await {
                Some(Ok(Message::Binary(bytes))) => {
                    let message = self.picture.apply(&bytes);
                    match &message {
                        ServerMessage::Roster { peers } => {
                            self.peers = peers.iter().map(|peer| (peer.client, peer.name.clone(), peer.object)).collect();
                        }
                        ServerMessage::Poses { objects, .. } => self.objects.clone_from(objects),
                        ServerMessage::Refused { refusal, .. } => self.refusals.push(*refusal),
                        _ => {}
                    }
                    return Ok(message);
                }
                Some(Ok(Message::Close(Some(close)))) => return Err((close.code.into(), close.reason.to_string())),
                Some(Ok(_)) => {}
                other => panic!("the connection ended without a close: {other:?}"),
            }
        }
    }

    /// Reads to the end of the next frame and acknowledges it.
    async fn frame(&mut self) -> u64 {
        loop {
            if let ServerMessage::FrameEnd { frame, tick, .. } = self.hear().await.expect("the connection stays") {
                self.say(&ClientMessage::Ack { frame }).await;
                return tick;
            }
        }
    }

    async fn frames_until(&mut self, mut reached: impl FnMut(&Self) -> bool) {
        within(async {
            while !reached(self) {
                self.frame().await;
            }
        })
        .await;
    }

    /// Reads, acknowledging nothing, until the server closes.
    async fn closed(&mut self) -> (u16, String) {
        loop {
            if let Err(close) = self.hear().await {
                return close;
            }
        }
    }
}

/// What a visitor sees at each of the next `frames` frames, by step.
async fn watch(visitor: &mut Plain, frames: usize) -> BTreeMap<u64, impl PartialEq + std::fmt::Debug + use<>> {
    let mut seen = BTreeMap::new();
    while seen.len() < frames {
        let tick = visitor.frame().await;
        let codes: Vec<_> = visitor.picture.patches.values().map(|(_, codes)| codes.clone()).collect();
        seen.insert(tick, (codes, visitor.picture.wind.1.clone(), visitor.objects.clone()));
    }
    seen
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn two_visitors_see_the_same_world() {
    let server = Server::start(Limits::default()).await;
    let mut ada = Plain::join(&server, "Ada").await;
    let mut bob = Plain::join(&server, " Bob\u{7}").await;
    ada.say(&ClientMessage::Choose { vehicle: Some(VehicleKind::Car) }).await;
    ada.say(&ClientMessage::Drive(Drive { throttle: 1.0, ..Drive::default() })).await;
    let object = Some(100 + ada.client);
    let roster = vec![(ada.client, "Ada".to_owned(), object), (bob.client, "Bob".to_owned(), None)];
    for visitor in [&mut ada, &mut bob] {
        visitor.frames_until(|v| v.peers == roster && v.objects.iter().any(|o| Some(o.id) == object && o.position_m[2] < 0.0)).await;
    }
    let (seen_by_ada, seen_by_bob) = tokio::join!(watch(&mut ada, 40), watch(&mut bob, 40));
    let common: Vec<_> = seen_by_ada.keys().filter(|tick| seen_by_bob.contains_key(tick)).collect();
    assert!(common.len() >= 10, "only {} steps were shown to both", common.len());
    for tick in common {
        assert_eq!(seen_by_ada[tick], seen_by_bob[tick], "at step {tick}");
    }
    ada.say(&ClientMessage::Choose { vehicle: None }).await;
    bob.frames_until(|bob| bob.objects.is_empty()).await;
    drop(ada);
    bob.frames_until(|bob| bob.peers.len() == 1).await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_track_of_a_car_shows_at_another_visitor() {
    let server = Server::start_meadow().await;
    let layout = PatchLayout::from(&scenes::load("meadow").unwrap().scene.patches);
    let (mut driver, mut watcher) = (Plain::join(&server, "driver").await, Plain::join(&server, "watcher").await);
    driver.say(&ClientMessage::Choose { vehicle: Some(VehicleKind::Car) }).await;
    driver.say(&ClientMessage::Drive(Drive { throttle: 0.5, ..Drive::default() })).await;
    watcher.frames_until(|watcher| !watcher.objects.is_empty()).await;
    let start = watcher.objects[0].position_m;
    watcher.say(&ClientMessage::View { eye_m: start, radius_m: 64.0 }).await;
    let patch = layout.patch_at(start[0], start[2]).expect("a car stands in the world");
    let bent = |visitor: &Plain| {
        let (_, codes) = visitor.picture.patches.get(&patch)?;
        codes[..visitor.picture.patch_cells.pow(2)].iter().max().copied()
    };
    let pressed = theta_code(1.0);
    tokio::join!(driver.frames_until(|driver| driver.picture.frame > 40), watcher.frames_until(|watcher| bent(watcher) >= Some(pressed)));
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn bad_messages_close_their_sender_and_nobody_else() {
    let server = Server::start(Limits::default()).await;
    let mut witness = Plain::join(&server, "witness").await;
    let drive = |drive: Drive| encode(&ClientMessage::Drive(drive));
    let view = |eye_m, radius_m| encode(&ClientMessage::View { eye_m, radius_m });
    let hello = encode(&ClientMessage::Hello { name: "again".to_owned() });
    let huge_name = encode(&ClientMessage::Hello { name: "x".repeat(5000) });
    let mut other_version = hello.clone();
    other_version[0] = PROTOCOL + 1;
    let bad = Close::BadMessage;
    let cases: [(&str, Vec<u8>, Close); 13] = [
        ("nothing", vec![], bad),
        ("garbage", vec![PROTOCOL, 0xff, 0xff, 0xff, 0xff, 0xff], bad),
        ("an oversized message", huge_name, bad),
        ("a very much oversized message", vec![PROTOCOL; 1 << 20], bad),
        ("a truncated message", view([1.0; 3], 9.0)[..9].to_vec(), bad),
        ("a message with more after it", [view([1.0; 3], 9.0), vec![0]].concat(), bad),
        ("another version", other_version, Close::Version),
        ("a second hello", hello, bad),
        ("a throttle of NaN", drive(Drive { throttle: f32::NAN, ..Drive::default() }), bad),
        ("a steer of 2", drive(Drive { steer: 2.0, ..Drive::default() }), bad),
        ("an eye at infinity", view([0.0, f32::INFINITY, 0.0], 9.0), bad),
        ("a radius of 513 m", view([0.0; 3], 513.0), bad),
        ("an acknowledgement of what was never sent", encode(&ClientMessage::Ack { frame: 1_000_000 }), bad),
    ];
    for (what, bytes, close) in cases {
        let mut visitor = Plain::join(&server, "vandal").await;
        visitor.send(Message::Binary(bytes.into())).await;
        let (code, reason) = visitor.closed().await;
        assert_eq!(Close::from_code(code), Some(close), "{what}: {code} {reason}");
        assert!(!reason.is_empty(), "{what}");
        assert_eq!(visitor.refusals.contains(&Refusal::BadMessage), close == bad, "{what}");
        witness.frames_until(|witness| witness.peers.len() == 1).await;
    }
    let mut visitor = Plain::join(&server, "vandal").await;
    visitor.send(Message::Text("hello".into())).await;
    assert_eq!(visitor.closed().await.0, Close::BadMessage.code());
    for (bytes, close) in [(vec![0; 3], Close::Version), (view([0.0; 3], 1.0), bad), (vec![PROTOCOL, 99], bad)] {
        let mut visitor = Plain::connect(&server).await;
        visitor.send(Message::Binary(bytes.into())).await;
        assert_eq!(visitor.closed().await.0, close.code(), "in place of the hello");
    }
    witness.frame().await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn silence_at_the_door_is_closed() {
    let limits = Limits { greeting: Duration::from_millis(200), ..Limits::default() };
    let server = Server::start(limits).await;
    let mut witness = Plain::join(&server, "witness").await;
    assert_eq!(Plain::connect(&server).await.closed().await.0, Close::NoHello.code());
    let mut mute = TcpStream::connect(server.address).await.unwrap();
    mute.write_all(b"GET / HTTP/1.1\r\nhost:").await.unwrap();
    let mut answer = Vec::new();
    within(mute.read_to_end(&mut answer)).await.unwrap();
    assert!(!String::from_utf8_lossy(&answer).contains("200 OK"), "half a request gets no page");
    witness.frame().await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_flood_is_closed() {
    let limits = Limits { messages_per_sec: 50.0, ..Limits::default() };
    let server = Server::start(limits).await;
    let mut witness = Plain::join(&server, "witness").await;
    let mut visitor = Plain::join(&server, "flood").await;
    for nonce in 0..500 {
        let ping = encode(&ClientMessage::Ping { nonce });
        if visitor.socket.feed(Message::Binary(ping.into())).await.is_err() {
            break;
        }
    }
    let _ = visitor.socket.flush().await;
    assert_eq!(visitor.closed().await.0, Close::RateLimit.code());
    assert!(visitor.refusals.contains(&Refusal::RateLimit));
    witness.frames_until(|witness| witness.peers.len() == 1).await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_client_that_never_reads_or_acknowledges_is_closed() {
    let limits = Limits { stall: Duration::from_millis(400), ..Limits::default() };
    let server = Server::start(limits).await;
    let mut witness = Plain::join(&server, "witness").await;
    let mut deaf = Plain::join(&server, "deaf").await;
    let lazy = Plain::join(&server, "lazy").await;
    witness.frames_until(|witness| witness.peers.len() == 3).await;
    witness.frames_until(|witness| witness.peers.len() == 1).await;
    assert_eq!(deaf.closed().await.0, Close::Stalled.code());
    assert!(deaf.picture.frame <= limits.send.in_flight, "{} frames without an acknowledgement", deaf.picture.frame);
    drop(lazy);
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_full_server_says_so_and_has_room_again_later() {
    let server = Server::start(Limits { clients: 1, ..Limits::default() }).await;
    let mut first = Plain::join(&server, "first").await;
    let mut second = Plain::connect(&server).await;
    second.say(&ClientMessage::Hello { name: "second".to_owned() }).await;
    assert_eq!(second.closed().await.0, Close::ServerFull.code());
    assert_eq!(second.refusals, [Refusal::ServerFull]);
    first.frame().await;
    first.socket.close(None).await.unwrap();
    within(async {
        loop {
            let mut third = Plain::connect(&server).await;
            third.say(&ClientMessage::Hello { name: "third".to_owned() }).await;
            if third.hear().await.is_ok_and(|message| matches!(message, ServerMessage::Welcome { .. })) {
                break;
            }
        }
    })
    .await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_refused_vehicle_leaves_the_connection() {
    let server = Server::start(Limits::default()).await;
    let mut drivers = Vec::new();
    for _ in 0..OBJECT_LIMIT {
        let mut driver = Plain::join(&server, "driver").await;
        driver.say(&ClientMessage::Choose { vehicle: Some(VehicleKind::Monster) }).await;
        driver.frames_until(|driver| driver.objects.iter().any(|object| object.id == 100 + driver.client)).await;
        drivers.push(driver);
    }
    let mut late = Plain::join(&server, "late").await;
    late.say(&ClientMessage::Choose { vehicle: Some(VehicleKind::Car) }).await;
    late.frames_until(|late| late.refusals == [Refusal::ObjectLimit]).await;
    late.say(&ClientMessage::Ping { nonce: 7 }).await;
    while late.hear().await != Ok(ServerMessage::Pong { nonce: 7 }) {}
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn everybody_is_told_when_the_server_stops() {
    let server = Server::start(Limits::default()).await;
    let mut visitor = Plain::join(&server, "visitor").await;
    visitor.frame().await;
    server.stop().await;
    assert_eq!(visitor.closed().await.0, Close::Stopping.code());
    assert_eq!(visitor.refusals, [Refusal::Stopping]);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_fault_in_the_world_ends_the_run_with_an_error() {
    let world = Meadow { fails_at: Some(20), ..Meadow::default() };
    let (server, _) = Server::start_with(world, Limits::default(), None).await;
    assert!(matches!(within(server.outcome).await.unwrap(), Err(RunError::WorldStopped)));
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn pages_health_and_origins() {
    let server = Server::start(Limits::default()).await;
    let text = |answer: Vec<u8>| String::from_utf8_lossy(&answer).into_owned();
    let page = text(server.http("GET / HTTP/1.1").await);
    assert!(page.starts_with("HTTP/1.1 200") && page.contains("text/html"), "{page}");
    let etag = page.lines().find_map(|line| line.strip_prefix("etag: ")).expect("a tag").trim().to_owned();
    assert!(text(server.http(&format!("GET / HTTP/1.1\r\nif-none-match: {etag}")).await).starts_with("HTTP/1.1 304"));
    let packed = server.http("GET / HTTP/1.1\r\naccept-encoding: gzip").await;
    assert!(text(packed.clone()).contains("content-encoding: gzip") && packed.windows(2).any(|pair| pair == [0x1f, 0x8b]));
    assert!(text(server.http("GET /../Cargo.toml HTTP/1.1").await).starts_with("HTTP/1.1 404"));
    assert!(text(server.http("POST / HTTP/1.1").await).starts_with("HTTP/1.1 405"));
    assert!(text(server.http("nonsense").await).starts_with("HTTP/1.1 400"));

    let mut visitor = Plain::join(&server, "visitor").await;
    visitor.frame().await;
    // The first frame may show the world before its first step, and be counted after it has arrived.
    within(async {
        loop {
            let health = text(server.http("GET /healthz HTTP/1.1").await);
            let report: serde_json::Value = serde_json::from_str(health.split("\r\n\r\n").nth(1).unwrap()).unwrap();
            assert_eq!(report["status"], "ok");
            if report["tick"].as_u64().unwrap() > 0 && report["clients"][0]["sent_bytes"].as_u64().unwrap() > 0 {
                break;
            }
            tokio::time::sleep(Duration::from_millis(10)).await;
        }
    })
    .await;

    for (origin, allowed) in [(format!("http://{}", server.address), true), ("http://elsewhere.example".to_owned(), false)] {
        let mut request = format!("ws://{}/ws", server.address).into_client_request().unwrap();
        request.headers_mut().insert("origin", origin.parse().unwrap());
        let stream = TcpStream::connect(server.address).await.unwrap();
        match within(tokio_tungstenite::client_async(request, stream)).await {
            Ok(_) => assert!(allowed, "{origin}"),
            Err(tungstenite::Error::Http(answer)) => assert!(!allowed && answer.status() == 403, "{origin}: {}", answer.status()),
            Err(other) => panic!("{origin}: {other}"),
        }
    }
    server.stop().await;
}

/// Trusts exactly the certificate with one fingerprint, as a careful visitor does.
#[derive(Debug)]
struct Fingerprint(String);

impl ServerCertVerifier for Fingerprint {
    fn verify_server_cert(
        &self,
        certificate: &CertificateDer<'_>,
        _: &[CertificateDer<'_>],
        _: &ServerName<'_>,
        _: &[u8],
        _: UnixTime,
    ) -> Result<ServerCertVerified, rustls::Error> {
        let digest = ring::digest::digest(&ring::digest::SHA256, certificate);
        let found = digest.as_ref().iter().map(|byte| format!("{byte:02X}")).collect::<Vec<_>>().join(":");
        if found == self.0 { Ok(ServerCertVerified::assertion()) } else { Err(rustls::Error::General("another certificate".to_owned())) }
    }

    fn verify_tls12_signature(
        &self,
        message: &[u8],
        certificate: &CertificateDer<'_>,
        signature: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, rustls::Error> {
        let algorithms = rustls::crypto::ring::default_provider().signature_verification_algorithms;
        rustls::crypto::verify_tls12_signature(message, certificate, signature, &algorithms)
    }

    fn verify_tls13_signature(
        &self,
        message: &[u8],
        certificate: &CertificateDer<'_>,
        signature: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, rustls::Error> {
        let algorithms = rustls::crypto::ring::default_provider().signature_verification_algorithms;
        rustls::crypto::verify_tls13_signature(message, certificate, signature, &algorithms)
    }

    fn supported_verify_schemes(&self) -> Vec<SignatureScheme> {
        rustls::crypto::ring::default_provider().signature_verification_algorithms.supported_schemes()
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn tls_carries_the_same_stream() {
    let limits = Limits { greeting: Duration::from_millis(500), ..Limits::default() };
    let (server, tls) = Server::start_with(Meadow::default(), limits, Some(TlsChoice::SelfSigned)).await;
    let connect = async |fingerprint: String| {
        let provider = Arc::new(rustls::crypto::ring::default_provider());
        let config = ClientConfig::builder_with_provider(provider)
            .with_safe_default_protocol_versions()
            .unwrap()
            .dangerous()
            .with_custom_certificate_verifier(Arc::new(Fingerprint(fingerprint)))
            .with_no_client_auth();
        let stream = TcpStream::connect(server.address).await.unwrap();
        TlsConnector::from(Arc::new(config)).connect(ServerName::try_from("localhost").unwrap(), stream).await
    };
    let stream = connect(tls.unwrap().fingerprint().to_owned()).await.unwrap();
    let mut visitor = Visitor::over(stream, "wss://localhost/ws").await;
    visitor.greet("visitor").await;
    visitor.frame().await;
    assert!(connect("00".to_owned()).await.is_err(), "the fingerprint decides");
    let plain = server.http("GET / HTTP/1.1").await;
    assert!(!plain.starts_with(b"HTTP/1.1 200"), "no plain http beside it");
    let mut mute = TcpStream::connect(server.address).await.unwrap();
    assert_eq!(within(mute.read(&mut [0; 16])).await.unwrap_or(0), 0, "a handshake that never comes is hung up on");
    visitor.frame().await;
    server.stop().await;
}
