//! One step of the world and its snapshot: 16 × 16 patches of 64 × 64 cells, on one thread; and the bend field alone with every patch
//! awake, in one sub-step (two for objects faster than 50 m/s).

use criterion::{Criterion, criterion_group, criterion_main};
use prairie::charts::worlds;
use prairie::snapshot::PatchQuantiser;
use prairie::world::{Camera, Command, World};
use prairie_core::bend::{Bend, Field, Kinds, Scheme, Serial};
use prairie_core::grid::PatchLayout;
use prairie_core::scene::{Grass, Patches, VehicleKind};
use prairie_core::wire::Drive;
use std::time::Instant;

/// A busy world: `objects` vehicles that have driven about for 2 s.
fn busy(objects: u32) -> World {
    let mut world = worlds::hills(&worlds::scene(16));
    let mut commands = vec![Command::Cameras(vec![Camera { client: 0, eye_m: [128.0, 2.0, 128.0] }])];
    commands.extend((0..objects).map(|client| Command::Spawn { client, kind: VehicleKind::ALL[client as usize % 8 / 5] }));
    world.step(&commands);
    for tick in 0..120 {
        world.step(&drives(objects, tick));
    }
    world
}

fn drives(objects: u32, tick: u32) -> Vec<Command> {
    let steer = |client: u32| ((tick / 60 + client * 37) % 100) as f32 / 50.0 - 1.0;
    let drive = |client| Drive { throttle: 1.0, steer: steer(client), lift: 0.1, brake: 0.0 };
    (0..objects)
        .filter(|client| (tick + client).is_multiple_of(60))
        .map(|client| Command::Drive { client, number: 0, drive: drive(client) })
        .collect()
}

fn step(criterion: &mut Criterion) {
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started");
    for objects in [1, 64] {
        let mut world = one_thread.install(|| busy(objects));
        let (mut tick, mut quantiser) = (120, PatchQuantiser::default());
        criterion.bench_function(&format!("step with {objects} objects"), |bench| {
            bench.iter(|| {
                one_thread.install(|| world.step(&drives(objects, tick)));
                tick += 1;
            });
        });
        criterion.bench_function(&format!("step and snapshot with {objects} objects"), |bench| {
            bench.iter(|| {
                tick += 1;
                one_thread.install(|| {
                    world.step(&drives(objects, tick));
                    world.publish(&mut quantiser)
                })
            });
        });
    }
}

/// Number of steps for the percentiles: a minute of simulated time.
const TIMED_STEPS: usize = 3600;

/// A field of a million cells, all bent.
fn awake_field() -> Field {
    let mut field = Field::new(PatchLayout::from(&Patches::default()), Kinds::one(Grass::default().waves));
    let layout = *field.layout();
    for index in 0..layout.patches() as u32 {
        let patch = field.wake(index);
        let side = patch.side();
        for (i, j) in (0..side).flat_map(|j| (0..side).map(move |i| (i, j))) {
            patch.press(i, j, Bend { theta: 0.01 * (i * j % 97) as f32, omega: [0.02 * i as f32, -0.01 * j as f32] });
        }
    }
    field
}

fn bend(criterion: &mut Criterion) {
    let mut field = awake_field();
    criterion.bench_function("bend field, 1 M cells awake", |bench| bench.iter(|| field.step(Scheme::Substepped, 1.0 / 60.0, &Serial)));
}

/// Percentiles, which a mean hides: the wind steps only every third tick, and a late tick is visible.
fn percentiles(_: &mut Criterion) {
    let one_thread = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread can be started");
    for objects in [1, 64] {
        let mut times_ms = one_thread.install(|| {
            let mut world = busy(objects);
            let timed = (120..).take(TIMED_STEPS).map(|tick| {
                let commands = drives(objects, tick);
                let begun = Instant::now();
                world.step(&commands);
                begun.elapsed().as_secs_f64() * 1e3
            });
            timed.collect::<Vec<_>>()
        });
        times_ms.sort_by(f64::total_cmp);
        let at = |fraction: f64| times_ms[(fraction * (TIMED_STEPS - 1) as f64) as usize];
        println!(
            "step with {objects} objects: median {:.2} ms, 90 % {:.2} ms, 99 % {:.2} ms, longest {:.2} ms of {TIMED_STEPS}",
            at(0.5),
            at(0.9),
            at(0.99),
            at(1.0)
        );
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(50);
    targets = percentiles, step, bend
}
criterion_main!(benches);
