//! A server on a free port.

use crate::stand_in::{StandInWorld, scene};
use prairie::net::{Tls, TlsSettings, bind};
use prairie::runner::Simulation;
use prairie::scenes::LoadedScene;
use prairie::world::World;
use prairie::{Config, Limits, RunError, run, run_and_reload, run_simulation, scenes};
use std::net::SocketAddr;
use std::path::Path;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::oneshot;
use tokio::task::JoinHandle;

/// Time limit of every operation of a test.
const TIMEOUT: Duration = Duration::from_secs(20);

pub(crate) struct Server {
    pub(crate) address: SocketAddr,
    pub(crate) stop: oneshot::Sender<()>,
    pub(crate) outcome: JoinHandle<Result<(), RunError>>,
}

impl Server {
    pub(crate) async fn start(limits: Limits) -> Self {
        Self::start_with(StandInWorld::default(), limits, None).await.0
    }

    pub(crate) async fn start_with(world: StandInWorld, limits: Limits, tls: Option<TlsSettings>) -> (Self, Option<Tls>) {
        let listener = bind("127.0.0.1:0").await.unwrap();
        let tls = tls.map(|settings| Tls::new(&settings, listener.local_addr().unwrap()).unwrap());
        let config = Config { tls: tls.clone(), limits, ..Config::new(scene()) };
        (Self::start_config(world, config, listener), tls)
    }

    /// Serves a scene whose height map has this many bytes, which a client must receive before anything else.
    pub(crate) async fn start_large(map_bytes: usize, limits: Limits) -> Self {
        let listener = bind("127.0.0.1:0").await.unwrap();
        let scene = LoadedScene { height_png: vec![7; map_bytes], ..scene() };
        Self::start_config(StandInWorld::default(), Config { limits, ..Config::new(scene) }, listener)
    }

    /// Serves a world with any configuration.
    pub(crate) fn start_config(world: impl Simulation, config: Config, listener: TcpListener) -> Self {
        let address = listener.local_addr().unwrap();
        let (stop, stopped) = oneshot::channel();
        let shutdown = async { drop(stopped.await) };
        let config = Config { threads: Some(1), ..config };
        Self { address, stop, outcome: tokio::spawn(run_simulation(world, config, listener, shutdown)) }
    }

    /// Serves the default scene with the real world.
    pub(crate) async fn start_meadow() -> Self {
        let listener = bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        let (stop, stopped) = oneshot::channel();
        let config = Config::new(scenes::load("meadow").unwrap());
        Self { address, stop, outcome: tokio::spawn(run(config, listener, async { drop(stopped.await) })) }
    }

    /// Serves a scene file with hot reload, like the program.
    pub(crate) async fn start_file(scene: &Path) -> Self {
        let listener = bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        let (stop, stopped) = oneshot::channel();
        let config = Config::new(scenes::load(scene.to_str().unwrap()).unwrap());
        let world = World::new(&config.scene.scene, config.scene.maps()).unwrap();
        Self { address, stop, outcome: tokio::spawn(run_and_reload(world, config, listener, async { drop(stopped.await) })) }
    }

    pub(crate) async fn stop(self) {
        self.stop.send(()).unwrap();
        within(self.outcome).await.unwrap().unwrap();
    }

    /// Sends a request and returns the whole response.
    pub(crate) async fn http(&self, request: &str) -> Vec<u8> {
        self.http_at(&self.address.to_string(), request).await
    }

    /// Sends a request with a body and returns the whole response.
    pub(crate) async fn http_with_body(&self, head: &str, body: &str) -> Vec<u8> {
        let mut stream = TcpStream::connect(self.address).await.unwrap();
        stream.write_all(format!("{head}\r\nhost: {}\r\nconnection: close\r\n\r\n{body}", self.address).as_bytes()).await.unwrap();
        let mut response = Vec::new();
        within(stream.read_to_end(&mut response)).await.unwrap();
        response
    }

    /// Sends a request for a host and returns the whole response.
    pub(crate) async fn http_at(&self, host: &str, request: &str) -> Vec<u8> {
        let mut stream = TcpStream::connect(self.address).await.unwrap();
        stream.write_all(format!("{request}\r\nhost: {host}\r\nconnection: close\r\n\r\n").as_bytes()).await.unwrap();
        let mut response = Vec::new();
        within(stream.read_to_end(&mut response)).await.unwrap();
        response
    }
}

pub(crate) async fn within<T>(future: impl Future<Output = T>) -> T {
    tokio::time::timeout(TIMEOUT, future).await.expect("the operation timed out")
}
