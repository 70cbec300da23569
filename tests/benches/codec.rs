//! Encoding and decoding one patch of 64 × 64 cells, compared with deflate on the same differences.
//!
//! The data are realistic: a disc is driven across a bend field that propagates and recovers, and the frames are 50 ms apart.
//! Payload sizes are printed first, since speed is meaningless without them.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use prairie_core::bend::{Bend, Field, Kinds, Scheme, Serial};
use prairie_core::grid::PatchLayout;
use prairie_core::scene::Grass;
use prairie_core::wire::quantise::CodeSteps;
use prairie_core::wire::{Shape, codec};
use std::hint::black_box;

const SIDE: usize = 64;
const SHAPE: Shape = Shape::patch(SIDE);
const LAYOUT: PatchLayout = PatchLayout { count: [1, 1], cells: SIDE as u32, cell_m: 0.25 };
const DT_SECS: f32 = 1.0 / 60.0;
const STEPS_PER_FRAME: usize = 3;

/// Codes of consecutive frames while a disc of 1 m radius crosses the patch at 8 m/s.
fn frames() -> Vec<Vec<i16>> {
    let mut field = Field::new(LAYOUT, Kinds::one(Grass::default().waves));
    let (steps, mut frames) = (CodeSteps::default(), Vec::new());
    for step in 0..120 {
        let x_m = 1.0 + 8.0 * step as f32 * DT_SECS;
        let patch = field.wake(0);
        for j in 0..SIDE {
            for i in 0..SIDE {
                let (dx, dz) = ((i as f32 + 0.5) * LAYOUT.cell_m - x_m, (j as f32 + 0.5) * LAYOUT.cell_m - 8.0);
                if dx * dx + dz * dz < 1.0 {
                    let theta = (patch.bend(i, j).theta + 26.0 * DT_SECS).min(1.4);
                    patch.press(i, j, Bend { theta, omega: [24.0, 10.0 * dz] });
                }
            }
        }
        field.step(Scheme::Substepped, DT_SECS, &Serial).expect("a step of some length");
        if step % STEPS_PER_FRAME == 0 {
            let patch = field.patch(0).expect("awake");
            let own = |channel: usize, code: fn(&CodeSteps, f32) -> i16| -> Vec<i16> {
                patch.rows().flat_map(|row| row[channel].iter().map(|&value| code(&steps, value)).collect::<Vec<_>>()).collect()
            };
            let planes = [own(0, CodeSteps::theta_code), own(1, CodeSteps::omega_code), own(2, CodeSteps::omega_code)];
            frames.push(planes.concat());
        }
    }
    frames
}

fn deflate_delta(codes: &[i16], base: &[i16]) -> Vec<u8> {
    let delta: Vec<u8> = codes.iter().zip(base).flat_map(|(code, base)| code.wrapping_sub(*base).to_le_bytes()).collect();
    miniz_oxide::deflate::compress_to_vec(&delta, 6)
}

fn bench(criterion: &mut Criterion) {
    let frames = frames();
    let pairs: Vec<_> = frames.windows(2).collect();
    let mean = |size: &dyn Fn(&[Vec<i16>]) -> usize| pairs.iter().map(|pair| size(pair)).sum::<usize>() / pairs.len();
    let ours = mean(&|pair| codec::encode(SHAPE, &pair[1], Some(&pair[0])).len());
    let key = mean(&|pair| codec::encode(SHAPE, &pair[1], None).len());
    let deflate = mean(&|pair| deflate_delta(&pair[1], &pair[0]).len());
    println!("mean bytes of a patch: raw {}, key {key}, delta {ours}, deflate of the delta {deflate}", 2 * frames[0].len());

    let (base, codes) = (&pairs[pairs.len() / 2][0], &pairs[pairs.len() / 2][1]);
    let delta = codec::encode(SHAPE, codes, Some(base));
    let deflated = deflate_delta(codes, base);
    let mut group = criterion.benchmark_group("patch");
    group.throughput(Throughput::Elements(codes.len() as u64));
    group.bench_function("encode delta", |b| b.iter(|| codec::encode(SHAPE, black_box(codes), Some(base))));
    group.bench_function("encode key", |b| b.iter(|| codec::encode(SHAPE, black_box(codes), None)));
    group.bench_function("encode unchanged", |b| b.iter(|| codec::encode(SHAPE, black_box(base), Some(base))));
    group.bench_function("encode delta by deflate", |b| b.iter(|| deflate_delta(black_box(codes), base)));
    group.bench_function("decode delta", |b| {
        b.iter(|| {
            let mut grid = base.clone();
            codec::decode(SHAPE, black_box(&delta), &mut grid).map(|()| grid)
        });
    });
    group.bench_function("decode delta by deflate", |b| b.iter(|| miniz_oxide::inflate::decompress_to_vec(black_box(&deflated))));
    group.finish();
}

criterion_group!(benches, bench);
criterion_main!(benches);
