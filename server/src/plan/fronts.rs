//! Costs: measured times of the wind's methods, kept as data with the program and measured anew by `prairie calibrate`.

use super::settings::WindSettings;
use prairie_core::bend::Scheme;
use prairie_core::scene::{BladeIntegrator, Scene, WindDiffusion, WindMethod, WindPressure, WindTime};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Format of the file; other numbers are refused.
const FORMAT: u32 = 2;
/// Largest file (bytes).
const FILE_LIMIT: u64 = 1 << 20;

/// Times of each method on boxes of several sizes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Fronts {
    /// Format of the file.
    pub format: u32,
    /// Version of the program that measured them.
    pub version: String,
    /// Processor, and number of threads.
    pub machine: String,
    /// Day of the measurement (UTC).
    pub date: String,
    /// Numbers of cells of the boxes, ascending.
    pub cells: Vec<f64>,
    /// Time per cell and sub-step (ns) in each box: `step/ADVECTION/TIME` and `step/stable-fluids` of a whole step with explicit diffusion and the direct pressure
    /// solver; `bend/SCHEME` of a cell of the bend field and `blade/INTEGRATOR` of a blade in any box; all others of the difference to the first.
    pub ns: BTreeMap<String, Vec<f64>>,
}

/// Fronts, and where they are from.
#[derive(Clone, Debug, PartialEq)]
pub struct FrontsInUse {
    /// The times.
    pub fronts: Fronts,
    /// Sentence about their origin, and about data that were refused.
    pub origin: String,
}

impl Fronts {
    /// The times that are kept with the program.
    pub fn built_in() -> Self {
        serde_json::from_str(include_str!("fronts.json")).expect("the stored fronts are valid")
    }

    /// Parses a file, and checks that its numbers are finite and of one length.
    ///
    /// # Errors
    /// The reason why it is refused.
    pub fn parse(text: &str) -> Result<Self, String> {
        let fronts: Self = serde_json::from_str(text).map_err(|error| error.to_string())?;
        if fronts.format != FORMAT {
            return Err(format!("its format is {}; allowed: {FORMAT}", fronts.format));
        }
        let ascends = fronts.cells.windows(2).all(|pair| pair[0] < pair[1]) && fronts.cells.first().is_some_and(|first| *first > 0.0);
        let is_sound = |ns: &Vec<f64>| ns.len() == fronts.cells.len() && ns.iter().all(|ns| ns.is_finite());
        match fronts.ns.iter().find(|(_, ns)| !is_sound(ns)) {
            Some((row, _)) => Err(format!("its row `{row}` is not {} finite numbers", fronts.cells.len())),
            None if !ascends => Err("its numbers of cells do not ascend".to_owned()),
            None => Ok(fronts),
        }
    }

    /// The user's own times if they are of this machine and program, else those of the program.
    pub fn in_use() -> FrontsInUse {
        let built_in = Self::built_in();
        let of_program = format!("times measured on {} ({})", built_in.machine, built_in.date);
        let Some(path) = file() else { return FrontsInUse { fronts: built_in, origin: format!("{of_program}, not on this machine") } };
        Self::chosen(built_in, crate::file::read(&path, FILE_LIMIT), &path, &machine())
    }

    /// As [`Fronts::in_use`], with the contents of the user's file.
    fn chosen(built_in: Self, found: Result<Vec<u8>, String>, path: &Path, here: &str) -> FrontsInUse {
        let of_program = format!("times measured on {} ({})", built_in.machine, built_in.date);
        let unused = |why: String| FrontsInUse {
            origin: format!("{of_program}; {why}. `prairie calibrate` measures this machine"),
            fronts: built_in,
        };
        if !path.exists() && found.is_err() {
            return unused(format!("this machine, {here}, is not measured"));
        }
        let shown = path.display();
        let parsed =
            found.and_then(|bytes| String::from_utf8(bytes).map_err(|error| error.to_string())).and_then(|text| Self::parse(&text));
        match parsed {
            Err(reason) => unused(format!("{shown} is refused: {reason}")),
            Ok(own) if own.machine != here => unused(format!("{shown} is refused: it is of {}, and this machine is {here}", own.machine)),
            Ok(own) if own.version != env!("CARGO_PKG_VERSION") => {
                unused(format!("{shown} is refused: it is of version {}, and this is {}", own.version, env!("CARGO_PKG_VERSION")))
            }
            Ok(own) => FrontsInUse { origin: format!("times measured on this machine, {here} ({})", own.date), fronts: own },
        }
    }

    /// An empty front of this machine and day.
    pub(super) fn here() -> Self {
        let date = time::OffsetDateTime::now_utc().date().to_string();
        Self {
            format: FORMAT,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            machine: machine(),
            date,
            cells: Vec::new(),
            ns: BTreeMap::new(),
        }
    }

    /// Time per cell and sub-step (ns) of a row in a box of `cells`, interpolated over the logarithm of their number; 0 for an unknown row.
    fn ns_per_cell(&self, row: &str, cells: f64) -> f64 {
        let Some(ns) = self.ns.get(row) else { return 0.0 };
        let above = self.cells.partition_point(|known| *known <= cells);
        if above == 0 {
            // Smaller boxes take the time of the smallest one, shared by fewer cells.
            return ns[0] * self.cells[0] / cells;
        }
        let (Some(high), low) = (self.cells.get(above), above - 1) else { return ns[above - 1] };
        let fraction = (cells / self.cells[low]).ln() / (high / self.cells[low]).ln();
        ns[low] + fraction * (ns[above] - ns[low])
    }

    /// Time per tick (ms) of so many steps of cells of the bend field; `None` for a scheme that is not measured.
    pub fn bend_ms_per_tick(&self, scheme: Scheme, cell_steps: f64) -> Option<f64> {
        Some(self.ns.get(&bend_row(scheme))?.first()? * cell_steps / 1e6)
    }

    /// Time of a step of a blade (ns); on a graphics card only the ratios of the integrators mean something. 0 for one that is not measured.
    pub fn blade_ns(&self, integrator: BladeIntegrator) -> f64 {
        self.ns.get(&blade_row(integrator)).and_then(|ns| ns.first().copied()).unwrap_or_default()
    }

    /// Whether the time of a pressure solver is known: Jacobi and Gauss–Seidel, which no plan chooses, are not measured.
    pub fn knows(pressure: WindPressure) -> bool {
        !matches!(pressure, WindPressure::Jacobi | WindPressure::GaussSeidel)
    }

    /// Mean time per tick (ms) of settings for the wind of `scene`, whose steps take `substeps` sub-steps.
    pub fn ms_per_tick(&self, scene: &Scene, settings: &WindSettings, substeps: f64) -> f64 {
        let cells = settings.count();
        let of = |row: &str| self.ns_per_cell(row, cells);
        let ns = if scene.wind.method == WindMethod::StableFluids {
            of("step/stable-fluids")
        } else {
            let projections = if settings.time == WindTime::Reflection { 3.0 } else { 1.0 };
            let WindSettings { advection, time, .. } = settings;
            of(&format!("step/{}/{}", advection.word(), time.word()))
                + of(&diffusion_row(settings.diffusion))
                + projections * of(&pressure_row(settings.pressure, settings.tolerance))
                + if scene.wind.dust.release_per_s > 0.0 { of("dust") } else { 0.0 }
                + if crate::weather::pilot::has_walls(scene) { of("walls") } else { 0.0 }
        };
        ns.max(1.0) * cells * substeps / settings.ticks as f64 / 1e6
    }
}

/// Row of a scheme of the bend field.
pub(super) fn bend_row(scheme: Scheme) -> String {
    format!("bend/{}", scheme.word())
}

/// Row of an integrator of blades.
pub(super) fn blade_row(integrator: BladeIntegrator) -> String {
    format!("blade/{}", integrator.word())
}

/// Row of a diffusion scheme.
pub(super) fn diffusion_row(diffusion: WindDiffusion) -> String {
    format!("diffusion/{}", diffusion.word())
}

/// Row of a pressure solver: that of the nearest tolerance that is measured.
pub(super) fn pressure_row(pressure: WindPressure, tolerance: f32) -> String {
    let far = |known: &f32| (known / tolerance).ln().abs();
    let nearest = super::settings::TOLERANCES.into_iter().min_by(|one, other| far(one).total_cmp(&far(other))).unwrap_or(tolerance);
    format!("pressure/{}/{nearest:e}", pressure.word())
}

/// The user's file of times; `None` if the user has no configuration folder.
pub fn file() -> Option<PathBuf> {
    directories::ProjectDirs::from("", "", "prairie").map(|folders| folders.config_dir().join("fronts.json"))
}

/// Name of this machine's processor, and the number of threads.
pub fn machine() -> String {
    let information = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let named = information.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    let name = named.map_or(std::env::consts::ARCH, |(_, name)| name.trim());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{name}, {threads} threads")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(own: &Fronts) -> FrontsInUse {
        let bytes = serde_json::to_vec(own).unwrap();
        Fronts::chosen(Fronts::built_in(), Ok(bytes), Path::new("f.json"), "a here, 4 threads")
    }

    #[test]
    fn times_of_another_machine_or_version_are_refused() {
        let own = Fronts { machine: "a here, 4 threads".to_owned(), cells: vec![1.0], ns: BTreeMap::new(), ..Fronts::here() };
        assert_eq!(told(&own).fronts, own);
        let others = [
            (
                Fronts { machine: "b there, 2 threads".to_owned(), ..own.clone() },
                "it is of b there, 2 threads, and this machine is a here, 4 threads",
            ),
            (Fronts { version: "0.0.9".to_owned(), ..own.clone() }, "it is of version 0.0.9, and this is "),
            (Fronts { format: 7, ..own.clone() }, "its format is 7; allowed: 2"),
            (Fronts { cells: vec![2.0, 1.0], ..own.clone() }, "its numbers of cells do not ascend"),
            (Fronts { ns: [("dust".to_owned(), vec![])].into(), ..own }, "its row `dust` is not 1 finite numbers"),
        ];
        for (other, why) in others {
            let used = told(&other);
            assert_eq!(used.fronts, Fronts::built_in());
            assert!(used.origin.contains(&format!("f.json is refused: {why}")), "{}", used.origin);
        }
        let torn = Fronts::chosen(Fronts::built_in(), Ok(b"{".to_vec()), Path::new("f.json"), "a");
        assert!(torn.origin.contains("f.json is refused: EOF"), "{}", torn.origin);
    }

    #[test]
    fn times_are_interpolated_between_boxes() {
        let fronts = Fronts { cells: vec![100.0, 10_000.0], ns: [("dust".to_owned(), vec![50.0, 30.0])].into(), ..Fronts::here() };
        let found = [10.0, 100.0, 1000.0, 10_000.0, 1e6].map(|cells| fronts.ns_per_cell("dust", cells));
        assert!(found.iter().zip([500.0, 50.0, 40.0, 30.0, 30.0]).all(|(found, wanted)| (found - wanted).abs() < 1e-9), "{found:?}");
    }
}
