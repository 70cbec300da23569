//! The table of figures.

use super::{Figure, Pick};

const STEP: &str = "cargo bench --workspace --bench step -- percentiles";
const BEND: &str = "cargo bench --workspace --bench bend";
const REST: &str = "cargo bench --workspace --bench world -- rest";
const MINUTE: &str = "cargo bench --workspace --bench world -- minute";
const CARS: &str = "cargo bench --workspace --bench world -- cars";
const WIND: &str = "cargo bench --workspace --bench wind";
const CODEC: &str = "cargo bench --workspace --bench codec";
const PLANTS: &str = "cargo bench --workspace --bench plants";
const DRIVE: &str = "cargo run --release -p prairie --example watched_drive -- meadow 112 20";
const LOW: &str =
    "cargo run --release --features picture -- picture --stats --quality low --size 640x360 --frames 300 --out target/figures/low.jpg";
const MEDIUM: &str = "cargo run --release --features picture -- picture --stats --quality medium --size 640x360 --frames 300 --out target/figures/medium.jpg";

const fn figure(quantity: &'static str, aim: &'static str, command: &'static str, pick: Pick) -> Figure {
    Figure { quantity, aim, command, pick }
}

/// All figures, in the order of the page. Figures of one command follow each other.
pub const FIGURES: &[Figure] = &[
    figure("a step of a world of a million cells, 1 object, one core", "", STEP, Pick::After("step with 1 objects: ")),
    figure("the same, 64 objects", "8 ms at 99 %", STEP, Pick::After("step with 64 objects: ")),
    figure(
        "bend field alone, 1 patch of 120 × 120 cells, four sub-steps in a pass: threads, ms a step, 10⁹ cell-steps/s, GB/s, of a triad",
        "",
        BEND,
        Pick::After("|       1 | Substepped, 4 sub-steps"),
    ),
    figure("the same, 225 patches", "0.7 · 10⁹ cell-steps/s on one thread", BEND, Pick::After("|     225 | Substepped, 4 sub-steps")),
    figure("the same, Verlet scheme of Chen & Johan", "", BEND, Pick::After("|     225 | Verlet, 1 sub-step")),
    figure(
        "scene `continuum`, 88 × 88 patches, the whole server at rest",
        "0.5 % of a core, 150 MB",
        REST,
        Pick::After("at rest, no visitor: "),
    ),
    figure(
        "`continuum`, 64 cars at 20 m/s for a minute, two cores, a tick: mean, median, 90 %, 99 %, longest (ms)",
        "12 at 99 %",
        MINUTE,
        Pick::After("      tick "),
    ),
    figure("the same, its bend field", "", MINUTE, Pick::After("      bend ")),
    figure("the same, patches and memory", "", MINUTE, Pick::After("225 patches awake, ")),
    figure("the same against the number of cars, 1 to 256, without a limit of awake patches", "linear", CARS, Pick::After("tick: ")),
    figure(
        "a wind step, default method, one core, 8³ cells",
        "60 µs",
        WIND,
        Pick::Estimate("wind step/conservative, Runge-Kutta 3, 1 threads/8x8x8"),
    ),
    figure("the same, 32 × 8 × 32", "", WIND, Pick::Estimate("wind step/conservative, Runge-Kutta 3, 1 threads/32x8x32")),
    figure("the same, 64 × 32 × 64", "6 ms", WIND, Pick::Estimate("wind step/conservative, Runge-Kutta 3, 1 threads/64x32x64")),
    figure(
        "the same than Zhang's method, 8³",
        "faster",
        WIND,
        Pick::Ratio("wind step/stable fluids, 1 threads/8x8x8", "wind step/conservative, Runge-Kutta 3, 1 threads/8x8x8"),
    ),
    figure(
        "the same than Zhang's method, 64³",
        "faster",
        WIND,
        Pick::Ratio("wind step/stable fluids, 1 threads/64x64x64", "wind step/conservative, Runge-Kutta 3, 1 threads/64x64x64"),
    ),
    figure(
        "direct projection, exact to rounding, than Zhang's 20 Gauss–Seidel sweeps, 64³",
        "faster",
        WIND,
        Pick::Ratio("wind projection/Zhang: 20 Gauss-Seidel sweeps/64", "wind projection/Direct/64"),
    ),
    figure("divergence that these sweeps leave, 64³", "", WIND, Pick::After("20 Gauss-Seidel sweeps at 64³ leave ")),
    figure("bytes of a moving patch of 12 288 values, mean of 39 frames", "below deflate", CODEC, Pick::After("mean bytes of a patch: ")),
    figure(
        "posture look-up at the nearest node: least, median; than the full balance",
        "20 ns",
        PLANTS,
        Pick::After("| looked up at the nearest node"),
    ),
    figure(
        "posture look-up between nodes: least, median; than the full balance",
        "20 ns",
        PLANTS,
        Pick::After("| looked up between nodes"),
    ),
    figure("underbrush grown over 512 × 512 sites, with posture tables", "1 s", PLANTS, Pick::After("| 512 × 512 sites, ")),
    figure(
        "force field, 64 × 4 × 64 volumes, spread and decay: least, median",
        "",
        PLANTS,
        Pick::After("| what lingers spreads and decays"),
    ),
    figure("stream to a client that watches a driving car within 112 m", "2 Mbit/s", DRIVE, Pick::After("total ")),
    figure("frame at low quality, 640 × 360, scene `meadow`", "", LOW, Pick::After(": ")),
    figure("frame at medium quality, 640 × 360, scene `meadow`", "100 ms in software", MEDIUM, Pick::After(": ")),
];

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;
    use std::path::Path;

    #[test]
    fn figures_have_quantities_of_their_own_and_no_borders_of_tables() {
        let quantities: HashSet<_> = FIGURES.iter().map(|figure| figure.quantity).collect();
        assert_eq!(quantities.len(), FIGURES.len());
        for Figure { quantity, aim, command, .. } in FIGURES {
            assert!([quantity, aim, command].iter().all(|cell| !cell.contains('|')), "{quantity}");
        }
    }

    #[test]
    fn figures_of_a_command_follow_each_other() {
        let mut commands: Vec<_> = FIGURES.iter().map(|figure| figure.command).collect();
        commands.dedup();
        assert_eq!(commands.iter().collect::<HashSet<_>>().len(), commands.len());
    }

    #[test]
    fn commands_name_benchmarks_that_exist() {
        let benches = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches");
        for command in FIGURES.iter().map(|figure| figure.command) {
            if let Some((_, rest)) = command.split_once("--bench ") {
                let name = rest.split(' ').next().unwrap_or_default();
                assert!(benches.join(format!("{name}.rs")).exists(), "{command}");
            }
        }
    }
}
