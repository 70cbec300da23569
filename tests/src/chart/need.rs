//! Cost against need: processor time of the server, bytes on the wire and time of a frame for prairies in which more and more happens.

use std::fs;
use std::net::SocketAddr;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, bail, ensure};
use futures_util::{SinkExt as _, StreamExt as _};
use prairie::charts::still::frame_secs;
use prairie::scenes;
use prairie::studio::Stage;
use prairie::world::World;
use prairie_charts::machine::machine;
use prairie_charts::table::markdown;
use prairie_client::camera::Camera;
use prairie_client::render::{Gpu, OffscreenRenderer, Quality};
use prairie_core::scene::{Scene, VehicleKind};
use prairie_core::wire::{ClientMessage, Drive, SERVER_MESSAGE_LIMIT, ServerMessage, decode, encode};
use tokio::net::TcpStream;
use tokio_tungstenite::tungstenite::Message;
use tokio_tungstenite::tungstenite::protocol::WebSocketConfig;
use tokio_tungstenite::{WebSocketStream, client_async_with_config};

use crate::prairie::Prairie;

/// Time before a measurement (s): longer than a world with nobody there waits before it pauses.
const SETTLE: Duration = Duration::from_secs(14);
/// Radius of a viewer's view (m), as in the page at its highest quality.
const RADIUS_M: f32 = 112.0;
const DT_SECS: f32 = 1.0 / 30.0;

/// Who is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Visitor {
    Nobody,
    /// Somebody who stands still.
    Viewer,
    /// Somebody who drives a car in circles.
    Driver,
}

struct Case {
    name: &'static str,
    scene: &'static str,
    change: fn(&mut Scene),
    visitor: Visitor,
}

const CASES: [Case; 7] = [
    Case { name: "empty land in still air, nobody", scene: "meadow", change: empty, visitor: Visitor::Nobody },
    Case { name: "calm meadow, nobody", scene: "meadow", change: calm, visitor: Visitor::Nobody },
    Case { name: "calm meadow, a still viewer", scene: "meadow", change: calm, visitor: Visitor::Viewer },
    Case { name: "windy meadow, a still viewer", scene: "meadow", change: alone, visitor: Visitor::Viewer },
    Case { name: "calm meadow, a driver", scene: "meadow", change: calm, visitor: Visitor::Driver },
    Case { name: "windy meadow, a driver", scene: "meadow", change: alone, visitor: Visitor::Driver },
    Case { name: "storm, a driver", scene: "storm", change: alone, visitor: Visitor::Driver },
];

/// Without vehicles that drive by themselves.
fn alone(scene: &mut Scene) {
    scene.objects.self_driving = 0;
}

fn calm(scene: &mut Scene) {
    alone(scene);
    (scene.wind.mean_m_per_s, scene.wind.sources, scene.wind.turbulence) = ([0.0; 2], 0, 0.0);
}

fn empty(scene: &mut Scene) {
    calm(scene);
    scene.underbrush.clear();
    scene.plants.flowers_per_m2 = 0.0;
}

/// Cost of a case, per second of time.
#[derive(Clone, Copy, Debug)]
struct Cost {
    /// Processor time of the server and of the visitor's end of the line (s).
    cpu_secs: f64,
    /// To the visitor (kbit).
    kbit: f64,
    /// Median time of a frame (ms).
    frame_ms: f64,
}

/// Processor time (s) of this process so far.
fn cpu_secs() -> Result<f64> {
    let stat = fs::read_to_string("/proc/self/stat").context("processor times are read from /proc, which this system lacks")?;
    // After the name in parentheses; the 12th and 13th of the remaining fields are user and system time (proc(5)), in hundredths of a second.
    let fields: Vec<&str> = stat.rsplit_once(')').context("a name in /proc/self/stat")?.1.split_whitespace().collect();
    Ok(fields[11..13].iter().map(|ticks| ticks.parse::<f64>()).sum::<Result<f64, _>>()? / 100.0)
}

/// A visitor's end of the line.
pub(super) struct Line {
    socket: WebSocketStream<TcpStream>,
    visitor: Visitor,
    drives: bool,
}

impl Line {
    pub(super) async fn open(addr: SocketAddr, visitor: Visitor) -> Result<Self> {
        let config = WebSocketConfig::default().max_message_size(Some(SERVER_MESSAGE_LIMIT)).max_frame_size(Some(SERVER_MESSAGE_LIMIT));
        let (socket, _) = client_async_with_config(format!("ws://{addr}/ws"), TcpStream::connect(addr).await?, Some(config)).await?;
        let mut line = Self { socket, visitor, drives: false };
        line.send(&ClientMessage::Hello { name: "visitor".to_owned() }).await?;
        Ok(line)
    }

    async fn send(&mut self, message: &ClientMessage) -> Result<()> {
        Ok(self.socket.send(Message::Binary(encode(message).into())).await?)
    }

    /// Receives and acknowledges frames for a time; returns the bytes received.
    pub(super) async fn stay(&mut self, time: Duration) -> Result<usize> {
        let (end, mut bytes) = (Instant::now() + time, 0);
        while let Ok(message) = tokio::time::timeout(end.saturating_duration_since(Instant::now()), self.socket.next()).await {
            let message = match message.context("the server has gone")?? {
                Message::Binary(message) => message,
                Message::Close(close) => bail!("closed: {close:?}"),
                _ => continue,
            };
            bytes += message.len();
            match decode::<ServerMessage>(&message, SERVER_MESSAGE_LIMIT)? {
                ServerMessage::Scene { scene, .. } => {
                    let [x_m, z_m] = scene.extent_m().map(|extent_m| 0.5 * extent_m);
                    self.send(&ClientMessage::View { eye_m: [x_m, 3.0, z_m], radius_m: RADIUS_M }).await?;
                    if self.visitor == Visitor::Driver {
                        self.send(&ClientMessage::Choose { vehicle: Some(VehicleKind::Car) }).await?;
                    }
                }
                ServerMessage::Poses { objects, .. } if self.visitor == Visitor::Driver && !self.drives && !objects.is_empty() => {
                    self.drives = true;
                    let drive = Drive { throttle: 0.5, steer: 0.6, ..Drive::default() };
                    self.send(&ClientMessage::Drive { number: 1, drive }).await?;
                }
                ServerMessage::FrameEnd { frame, .. } => self.send(&ClientMessage::Ack { frame }).await?,
                _ => {}
            }
        }
        Ok(bytes)
    }
}

impl Case {
    async fn measure(&self, gpu: &Gpu, size_px: [u32; 2], measured: Duration) -> Result<Cost> {
        let mut loaded = scenes::load(self.scene)?;
        (self.change)(&mut loaded.scene);
        let world = World::new(&loaded.scene, loaded.maps())?;
        let prairie = Prairie::serve(loaded, world).await?;
        let (mut bytes, mut line) = (0, None);
        match self.visitor {
            Visitor::Nobody => tokio::time::sleep(SETTLE).await,
            visitor => {
                let mut opened = Line::open(prairie.addr, visitor).await?;
                opened.stay(SETTLE).await?;
                ensure!(opened.drives == (visitor == Visitor::Driver), "{}: the visitor has no car", self.name);
                line = Some(opened);
            }
        }
        let before_secs = cpu_secs()?;
        match &mut line {
            None => tokio::time::sleep(measured).await,
            Some(line) => bytes = line.stay(measured).await?,
        }
        let per_s = 1.0 / measured.as_secs_f64();
        let cpu_secs = (cpu_secs()? - before_secs) * per_s;
        prairie.stop().await?;
        Ok(Cost { cpu_secs, kbit: 8e-3 * bytes as f64 * per_s, frame_ms: self.frame_ms(gpu, size_px)? })
    }

    /// Median time of a frame at medium quality from the scene's first view.
    fn frame_ms(&self, gpu: &Gpu, size_px: [u32; 2]) -> Result<f64> {
        let mut stage = Stage::changed(self.scene, self.change)?;
        stage.run(DT_SECS);
        stage.show()?;
        let scene = stage.scene().clone();
        let camera = Camera::start(&scene.camera, scene.extent_m(), |x, z| stage.ground_m(x, z));
        let mut canvas = OffscreenRenderer::new(gpu, size_px, Quality::Medium);
        Ok(1e3 * frame_secs(&mut canvas, &mut stage.mirror, &camera, 9))
    }
}

/// Measures all cases; returns the page as Markdown.
///
/// # Errors
/// When there is no GPU, no port is free, or the system has no `/proc`.
pub fn report(quick: bool, mut progress: impl FnMut(&str)) -> Result<String> {
    let gpu = Gpu::headless()?;
    let (size_px, measured) = if quick { ([160, 90], Duration::from_secs(2)) } else { ([640, 360], Duration::from_secs(30)) };
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build()?;
    let mut rows = Vec::new();
    for case in &CASES {
        progress(case.name);
        let Cost { cpu_secs, kbit, frame_ms } = runtime.block_on(case.measure(&gpu, size_px, measured))?;
        let drawn = if case.visitor == Visitor::Nobody { "–".to_owned() } else { format!("{frame_ms:.0}") };
        rows.push(vec![case.name.to_owned(), format!("{:.2}", 100.0 * cpu_secs), format!("{kbit:.2}"), drawn]);
    }
    let header = ["prairie", "processor (% of a core)", "line (kbit/s)", "frame (ms)"];
    Ok(format!(
        "# Cost against need\n\n```sh\ncargo run --release -p tests --bin chart -- need\n```\n\n\
         A complete server for {} s each, after {} s, on {}. Processor time is that of the server together with the visitor's end of the line, which decodes what it receives. \
         The line carries the payload of WebSocket messages to one visitor without a replica of the grass. Frames of {} × {} px at medium quality from the scene's first view, on {}.\n\n{}",
        measured.as_secs(),
        SETTLE.as_secs(),
        machine(),
        size_px[0],
        size_px[1],
        gpu.adapter_name,
        markdown(&header, &rows)
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn processor_time_grows_with_work_and_not_with_sleep() {
        let before_secs = cpu_secs().unwrap();
        let begun = Instant::now();
        let mut sum = 0.0_f64;
        while begun.elapsed() < Duration::from_millis(200) {
            sum = (sum + 1.0).sqrt();
        }
        assert!(sum > 0.0 && cpu_secs().unwrap() - before_secs >= 0.05);
    }

    #[test]
    fn each_case_is_the_prairie_of_its_name() {
        for Case { name, scene, change, visitor } in &CASES {
            let mut scene = scenes::load(scene).unwrap().scene;
            change(&mut scene);
            let blows = scene.wind.mean_m_per_s != [0.0; 2];
            assert_eq!(blows, name.contains("windy") || name.contains("storm"), "{name}");
            assert_eq!(*visitor == Visitor::Nobody, name.contains("nobody"), "{name}");
        }
    }
}
