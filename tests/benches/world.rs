//! The world at the full scale of Chen & Johan, 88 × 88 patches of 120 × 120 cells: at rest, with 64 cars, and against the number of cars.
//!
//! An argument `rest`, `minute` or `cars` runs that part alone; `PRAIRIE_QUICK=1` takes a tenth of the time, for a quick look.

use futures_util::{SinkExt, StreamExt};
use prairie::charts::worlds;
use prairie::objects::{Environment, Objects};
use prairie::scenes;
use prairie::snapshot::{Audience, PatchQuantiser};
use prairie::weather::Weather;
use prairie::world::{Maps, World};
use prairie_core::grid::PatchLayout;
use prairie_core::scene::Scene;
use prairie_core::terrain::HeightMap;
use prairie_core::wire::{ClientMessage, SERVER_MESSAGE_LIMIT, ServerMessage, decode, encode};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tests::prairie::Prairie;
use tokio::net::TcpStream;
use tokio_tungstenite::tungstenite::Message;

/// Number of steps between snapshots.
const PUBLISH_EVERY: u64 = 3;
const THREADS: usize = 2;

/// `secs`, or a tenth of that for a quick look.
fn sampled(secs: f32) -> f32 {
    if std::env::var_os("PRAIRIE_QUICK").is_some() { 0.1 * secs } else { secs }
}

/// The world, with copies of its objects and its wind that are stepped alongside to measure their part of a tick.
struct Timed {
    scene: Scene,
    world: World,
    height: Arc<HeightMap>,
    objects: Objects,
    weather: Weather,
    quantiser: PatchQuantiser,
    tick: u64,
}

/// Cost of a tick (ms); a snapshot counts for the tick before it.
#[derive(Clone, Copy, Default)]
struct Cost {
    objects: f64,
    wind: f64,
    step: f64,
    snapshot: f64,
}

impl Cost {
    fn bend(&self) -> f64 {
        (self.step - self.objects - self.wind).max(0.0)
    }

    fn tick(&self) -> f64 {
        self.step + self.snapshot
    }
}

impl Timed {
    fn new(cars: u32, apart_m: f32, awake_limit: u32) -> Self {
        let (mut scene, maps) = worlds::continuum(cars, apart_m);
        scene.patches.awake_limit = awake_limit;
        let Maps { height, cover, .. } = maps.clone();
        let (height, cover) = (Arc::new(height), Arc::new(cover));
        let environment = Environment { height: height.clone(), cover, extent_m: scene.extent_m() };
        let objects = Objects::new(&scene, environment);
        let weather = Weather::new(&scene, &maps.height, &maps.cover).expect("a built-in scene is sound");
        let world = World::new(&scene, maps).expect("a built-in scene is sound");
        Self { scene, world, height, objects, weather, quantiser: PatchQuantiser::default(), tick: 0 }
    }

    /// Runs one tick, and takes a snapshot if one is due.
    fn tick(&mut self) -> Cost {
        self.tick += 1;
        let dt_secs = self.scene.dt_secs();
        let ((), objects) = timed_ms(|| self.objects.step(dt_secs, |_| [0.0; 3]));
        let motions = self.objects.motions();
        let ((), wind) = timed_ms(|| self.weather.step(self.tick, &motions, &self.height, self.world.bend().field()));
        let ((), step) = timed_ms(|| self.world.step(&[]));
        let snapshot = match self.tick % PUBLISH_EVERY {
            0 => {
                let (shown, taken) = timed_ms(|| self.world.publish(&mut self.quantiser));
                assert_eq!(shown.objects, self.objects.poses(), "the twins do as the world does");
                taken
            }
            _ => 0.0,
        };
        Cost { objects, wind, step, snapshot }
    }

    fn ticks(&mut self, secs: f32) -> Vec<Cost> {
        (0..(secs * self.scene.tick_hz) as u32).map(|_| self.tick()).collect()
    }
}

fn timed_ms<T>(act: impl FnOnce() -> T) -> (T, f64) {
    let begun = Instant::now();
    let done = act();
    (done, begun.elapsed().as_secs_f64() * 1e3)
}

/// Runs `act` on two threads, as in the performance aim.
fn on_two_threads<T: Send>(act: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(THREADS).build().expect("two threads can be started").install(act)
}

fn table(costs: &[Cost]) {
    println!("{:>10} {:>9} {:>9} {:>9} {:>9} {:>9}  ms of {} ticks", "", "mean", "median", "90 %", "99 %", "longest", costs.len());
    type Part = (&'static str, fn(&Cost) -> f64);
    let parts: [Part; 5] = [
        ("objects", |cost| cost.objects),
        ("wind", |cost| cost.wind),
        ("bend", Cost::bend),
        ("snapshot", |cost| cost.snapshot),
        ("tick", Cost::tick),
    ];
    for (name, part) in parts {
        let mut times: Vec<f64> = costs.iter().map(part).collect();
        times.sort_by(f64::total_cmp);
        let at = |fraction: f64| times[(fraction * (times.len() - 1) as f64) as usize];
        let mean = times.iter().sum::<f64>() / times.len() as f64;
        println!("{name:>10} {mean:>9.3} {:>9.3} {:>9.3} {:>9.3} {:>9.3}", at(0.5), at(0.9), at(0.99), at(1.0));
    }
}

/// Ticks without a car; then the whole server in real time, without a visitor and with one whose camera stands still.
fn at_rest() {
    println!("at rest, {THREADS} threads:");
    on_two_threads(|| table(&Timed::new(0, 200.0, 225).ticks(sampled(60.0))));
    let runtime = tokio::runtime::Runtime::new().expect("a runtime can be started");
    runtime.block_on(async {
        let mut loaded = scenes::load("continuum").expect("a built-in scene is sound");
        loaded.scene.objects.self_driving = 0;
        let world = World::new(&loaded.scene, loaded.maps()).expect("a built-in scene is sound");
        let prairie = Prairie::serve(loaded, world).await.expect("a port is free");
        // Long enough for the world to pause.
        tokio::time::sleep(Duration::from_secs(10)).await;
        share_of_a_core("at rest, no visitor").await;
        let visit = tokio::spawn(visit(prairie.addr.to_string()));
        share_of_a_core("at rest, one visitor who stands still").await;
        visit.abort();
    });
}

async fn share_of_a_core(name: &str) {
    let period = Duration::from_secs_f32(sampled(20.0).max(5.0));
    tokio::time::sleep(Duration::from_secs(2)).await;
    let (begun, used_secs) = (Instant::now(), cpu_secs());
    tokio::time::sleep(period).await;
    let fraction = (cpu_secs() - used_secs) / begun.elapsed().as_secs_f64();
    println!("{name}: {:.2} % of a core, {:.0} MB resident", 100.0 * fraction, resident_mb());
}

/// A visitor who looks at the middle of the world and receives every frame.
async fn visit(addr: String) {
    let stream = TcpStream::connect(&addr).await.expect("the server listens");
    let (mut socket, _) = tokio_tungstenite::client_async(format!("ws://{addr}/ws"), stream).await.expect("a socket opens");
    let say = |message: &ClientMessage| Message::Binary(encode(message).into());
    socket.send(say(&ClientMessage::Hello { name: "visitor".to_owned() })).await.expect("the server hears");
    socket.send(say(&ClientMessage::View { eye_m: [2414.0, 40.0, 2414.0], radius_m: 512.0 })).await.expect("the server hears");
    while let Some(Ok(message)) = socket.next().await {
        let Message::Binary(bytes) = message else { continue };
        if let Ok(ServerMessage::FrameEnd { frame, .. }) = decode(&bytes, SERVER_MESSAGE_LIMIT) {
            socket.send(say(&ClientMessage::Ack { frame })).await.expect("the server hears");
        }
    }
}

/// CPU time of all threads of this process (s); 0 if the system does not report it.
fn cpu_secs() -> f64 {
    let tasks = std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten();
    let nanos = tasks.filter_map(|task| {
        let text = std::fs::read_to_string(task.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse::<f64>().ok()
    });
    nanos.sum::<f64>() * 1e-9
}

/// Resident memory of this process (MB); 0 if the system does not report it.
fn resident_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok()).unwrap_or(0.0) * 1024e-6
}

/// A minute with 64 cars, with the scene's limit on awake patches: with drivers whose pages simulate the grass themselves, and with some who take all patches.
fn minute() {
    for (drivers, audience) in [("none takes patches", nobody()), ("all patches are taken", Audience::default())] {
        on_two_threads(|| {
            let mut timed = Timed::new(64, 200.0, 225);
            timed.quantiser.set_audience(audience);
            timed.ticks(2.0);
            println!("64 cars at 20 m/s, {THREADS} threads, {drivers}:");
            table(&timed.ticks(sampled(60.0)));
            let health = timed.world.snapshot().diagnostics;
            println!("{} patches awake, {} let go, {:.0} MB resident", health.awake_patches, health.evicted_patches, resident_mb());
        });
    }
}

/// No patch of the scene.
fn nobody() -> Audience {
    let scene = scenes::load("continuum").expect("a built-in scene is sound").scene;
    Audience::of(std::iter::empty(), &PatchLayout::from(&scene.patches))
}

/// Cost of a car: up to 256 cars, each with a track of its own, without a limit on patches.
fn cars() {
    let warm_up_secs = 9.0;
    println!("{:>6} {:>9} {:>9} {:>9}  mean ms of a tick, {THREADS} threads", "cars", "bend", "tick", "awake");
    let mut points = vec![];
    for cars in [1, 4, 16, 64, 256] {
        let (bend, tick, awake) = on_two_threads(|| {
            let mut timed = Timed::new(cars, 140.0, 2330);
            timed.ticks(sampled(warm_up_secs));
            let costs = timed.ticks(sampled(3.0));
            let mean = |part: fn(&Cost) -> f64| costs.iter().map(part).sum::<f64>() / costs.len() as f64;
            (mean(Cost::bend), mean(Cost::tick), timed.world.snapshot().diagnostics.awake_patches)
        });
        println!("{cars:>6} {bend:>9.3} {tick:>9.3} {awake:>9}");
        points.push((f64::from(cars), bend, tick));
    }
    for (name, part) in [("bend", 1), ("tick", 2)] {
        let line: Vec<_> = points.iter().map(|&(cars, bend, tick)| (cars, if part == 1 { bend } else { tick })).collect();
        let (start, slope, r2) = fit(&line);
        println!("{name}: {start:.3} ms + {:.1} µs a car, R² {r2:.4}", 1e3 * slope);
    }
}

/// Least-squares line through points: value at 0, slope and R².
fn fit(points: &[(f64, f64)]) -> (f64, f64, f64) {
    let n = points.len() as f64;
    let mean = |part: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(part).sum::<f64>() / n;
    let [x, y] = [mean(&|point| point.0), mean(&|point| point.1)];
    let [xx, xy, yy] =
        [mean(&|point| (point.0 - x).powi(2)), mean(&|point| (point.0 - x) * (point.1 - y)), mean(&|point| (point.1 - y).powi(2))];
    let slope = xy / xx;
    (y - slope * x, slope, xy * xy / (xx * yy))
}

fn main() {
    let wanted = std::env::args().skip(1).find(|argument| !argument.starts_with('-'));
    let parts: [(&str, fn()); 3] = [("rest", at_rest), ("minute", minute), ("cars", cars)];
    parts.iter().filter(|(name, _)| wanted.as_ref().is_none_or(|wanted| wanted == name)).for_each(|(_, run)| run());
}
