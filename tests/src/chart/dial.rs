//! The dial: one storm at three settings of its accuracy, with error, cost, data and picture of each; and the planned settings beside those of the literature at
//! equal errors.

use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context as _, Result, ensure};
use prairie::charts::image::Picture;
use prairie::charts::still::Still;
use prairie::charts::views::Eye;
use prairie::plan::fronts::Fronts;
use prairie::plan::{Plan, Silent};
use prairie::scenes::{self, LoadedScene, OpenScene};
use prairie::studio::{Act, Stage};
use prairie::world::{Command, World};
use prairie_charts::machine::machine;
use prairie_charts::table::markdown;
use prairie_client::render::{Gpu, Quality};
use prairie_core::bend::{Scheme, Seams};
use prairie_core::scene::{Accuracy, Scene, VehicleKind, WindMethod, WindTerrain};
use prairie_core::wire::Drive;

use super::need::{Line, Visitor};
use crate::prairie::Prairie;

const SCENE: &str = "storm";

/// A setting of the dial.
#[derive(Clone, Copy, Debug)]
struct Dial {
    name: &'static str,
    /// Tolerances of the wind, the bending angle and the blades, and of the picture; `None` for the scene as it is.
    tolerances: Option<([&'static str; 3], f32)>,
}

const DIALS: [Dial; 4] = [
    Dial { name: "as the scene states it", tolerances: None },
    Dial { name: "fine: wind 3 %, bend 1°, blades 2 %, picture 0.14", tolerances: Some((["3 %", "1 deg", "2 %"], 0.14)) },
    Dial { name: "middle: wind 8 %, bend 2°, blades 5 %, picture 0.2", tolerances: Some((["8 %", "2 deg", "5 %"], 0.2)) },
    Dial { name: "coarse: wind 30 %, bend 8°, blades 30 %, picture 0.28", tolerances: Some((["30 %", "8 deg", "30 %"], 0.28)) },
];

/// What is measured of a setting.
struct Setting {
    words: String,
    wind_percent: f64,
    bend_deg: f64,
    /// Mean time of a step of the world with a car in it (ms).
    tick_ms: f64,
    kbit_per_s: f64,
    blades_percent: f64,
    flip: f64,
    /// Time of a frame (ms).
    frame_ms: f64,
    picture: Picture,
}

/// The storm with tolerances, all cells and settings open.
fn demanding(change: impl FnOnce(&mut Scene)) -> Result<OpenScene> {
    let mut open = scenes::load_open(SCENE)?;
    open.loaded.scene.objects.self_driving = 0;
    change(&mut open.loaded.scene);
    open.stated.clear();
    Ok(open)
}

fn percent(plan: &Plan) -> Result<(f64, f64)> {
    let wind = plan.wind.as_ref().map_err(|reason| anyhow::anyhow!("{reason}"))?;
    Ok((100.0 * wind.chosen.error, wind.chosen.ms_per_tick))
}

impl Dial {
    async fn measure(&self, gpu: &Gpu, size_px: [u32; 2], measured: Duration) -> Result<Setting> {
        let open = demanding(|scene| {
            if let Some((texts, picture)) = self.tolerances {
                scene.accuracy = accuracy(texts, picture);
            }
        })?;
        let plan = open.plan_anew(&Fronts::in_use().fronts, &mut Silent);
        let (wind_percent, _) = percent(&plan)?;
        let wind = plan.wind.as_ref().ok().context("a wind")?;
        let words = wind.chosen.settings.words(open.loaded.scene.wind.method);
        let bend_deg = plan.bend.error_deg();
        let blades_percent = 100.0 * plan.blades.as_ref().context("single blades")?.error();
        let flip = plan.picture.as_ref().context("a picture")?.flip;
        let loaded = open.resolved(&plan);
        let tick_ms = tick_ms(&loaded, if measured.as_secs() > 5 { 900 } else { 60 })?;
        let kbit_per_s = kbit_per_s(loaded.clone(), measured).await?;
        let (picture, frame_ms) = picture(gpu, &loaded, size_px)?;
        Ok(Setting { words, wind_percent, bend_deg, tick_ms, kbit_per_s, blades_percent, flip, frame_ms, picture })
    }
}

fn accuracy([wind, bend, blades]: [&str; 3], picture: f32) -> Accuracy {
    let [wind, bend, blades] = [wind, bend, blades].map(str::to_owned);
    Accuracy { wind, bend, blades, picture, cells: "planned".to_owned() }
}

/// Mean time of a step while a car drives (ms), after two seconds.
fn tick_ms(loaded: &LoadedScene, ticks: u32) -> Result<f64> {
    let mut world = World::new(&loaded.scene, loaded.maps())?;
    world.step(&[Command::Join { client: 1 }, Command::Spawn { client: 1, kind: VehicleKind::Car }]);
    let drive = Drive { throttle: 0.5, steer: 0.6, ..Drive::default() };
    let mut run = |ticks: u32| (0..ticks).for_each(|number| world.step(&[Command::Drive { client: 1, number, drive }]));
    run(120);
    let begun = Instant::now();
    run(ticks);
    Ok(1e3 * begun.elapsed().as_secs_f64() / f64::from(ticks))
}

/// Data to a driver without a replica of the grass.
async fn kbit_per_s(loaded: LoadedScene, measured: Duration) -> Result<f64> {
    let world = World::new(&loaded.scene, loaded.maps())?;
    let prairie = Prairie::serve(loaded, world).await?;
    let mut line = Line::open(prairie.addr, Visitor::Driver).await?;
    line.stay(Duration::from_secs(4)).await?;
    let bytes = line.stay(measured).await?;
    prairie.stop().await?;
    Ok(8e-3 * bytes as f64 / measured.as_secs_f64())
}

/// The track of a car that has driven a curve, without the rain, which hides it, at the highest level of detail that automatic quality would use; and the time of a
/// frame (ms).
fn picture(gpu: &Gpu, loaded: &LoadedScene, size_px: [u32; 2]) -> Result<(Picture, f64)> {
    let mut dry = loaded.clone();
    dry.scene.rain.rate_mm_per_h = 0.0;
    let mut stage = Stage::new(&dry)?;
    let camera = Eye::Chase([17.0, 9.0, 4.0]).watch(&mut stage, Act::Track)?;
    let mut still = Still { stage, camera, size_px };
    let level = loaded.scene.plants.highest_detail;
    let quality = Quality::ALL.into_iter().find(|quality| quality.level() >= level).unwrap_or(Quality::FINEST);
    let mut canvas = still.canvas(gpu, quality);
    canvas.set_level(level);
    let (picture, _) = still.draw(&mut canvas);
    Ok((picture, 1e3 * still.frame_secs(&mut canvas, 5)))
}

/// Settings of the literature and planned ones that err at most as much.
struct Pair {
    what: String,
    error: String,
    ms: [f64; 2],
    planned: String,
}

/// Air that Zhang's solver can simulate: no grass or crowns hold it back.
fn bare(scene: &mut Scene) {
    (scene.wind.canopy_drag_per_m, scene.wind.crown_drag_per_m) = (0.0, 0.0);
}

/// Zhang's solver (`stable-fluids`) on the scene's cells times `quarters`/4, and planned settings.
fn wind_pair(quarters: u32) -> Result<Pair> {
    let published = demanding(|scene| {
        bare(scene);
        let wind = &mut scene.wind;
        (wind.method, wind.terrain) = (WindMethod::StableFluids, WindTerrain::Follow);
        for axis in [0, 2] {
            wind.cells[axis] = wind.cells[axis] * quarters / 4;
            wind.spacing_m[axis] *= 4.0 / quarters as f32;
        }
    })?;
    let fronts = Fronts::in_use().fronts;
    let [x, y, z] = published.loaded.scene.wind.cells;
    let (error_percent, ms) = percent(&published.plan_anew(&fronts, &mut Silent))?;
    ensure!(error_percent.is_finite(), "Zhang's solver cannot simulate this wind");
    let tolerance = format!("{:.1} %", (10.0 * error_percent).floor().clamp(1.0, 500.0) / 10.0);
    let planned = demanding(|scene| {
        bare(scene);
        scene.accuracy = Accuracy { wind: tolerance, cells: "planned".to_owned(), ..Accuracy::default() };
    })?;
    let plan = planned.plan_anew(&fronts, &mut Silent);
    let (planned_percent, planned_ms) = percent(&plan)?;
    let words = plan.wind.as_ref().ok().context("a wind")?.chosen.settings.words(planned.loaded.scene.wind.method);
    Ok(Pair {
        what: format!("wind: Zhang's solver on {x} × {y} × {z} cells"),
        error: format!("{error_percent:.2} %, planned {planned_percent:.2} %"),
        ms: [ms, planned_ms],
        planned: words,
    })
}

/// Chen and Johan's bend field (Verlet with overlaps, never at rest), and planned settings.
fn bend_pair() -> Result<Pair> {
    let published = demanding(|scene| {
        (scene.bend.scheme, scene.bend.seams) = (Scheme::Verlet, Seams::Overlap);
        (scene.bend.rest_theta_rad, scene.bend.rest_omega_rad_per_s, scene.stream.theta_error_deg) = (0.0, 0.0, 0.05);
    })?;
    let fronts = Fronts::in_use().fronts;
    let own = published.plan_anew(&fronts, &mut Silent).bend;
    let tolerance = format!("{:.2} deg", own.error_deg().clamp(0.05, 20.0));
    let planned =
        demanding(|scene| scene.accuracy = Accuracy { bend: tolerance, ..Accuracy::default() })?.plan_anew(&fronts, &mut Silent).bend;
    Ok(Pair {
        what: "bend field: Chen and Johan's scheme".to_owned(),
        error: format!("{:.3}°, planned {:.3}°", own.error_deg(), planned.error_deg()),
        ms: [own.ms_per_tick, planned.ms_per_tick].map(|ms| ms.unwrap_or(f64::NAN)),
        planned: format!("{} waves, at rest below {:.3}°", planned.scheme.word(), planned.rest_theta_rad.to_degrees()),
    })
}

/// Measures the dial, draws `dial.jpg` into `out`, and returns the page as Markdown.
///
/// # Errors
/// When there is no GPU, no port is free, or the picture cannot be written.
pub fn report(quick: bool, out: &Path, mut progress: impl FnMut(&str)) -> Result<String> {
    let gpu = Gpu::headless()?;
    let (size_px, measured) = if quick { ([96, 54], Duration::from_secs(2)) } else { ([320, 180], Duration::from_secs(20)) };
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build()?;
    let mut settings = Vec::new();
    for dial in &DIALS {
        progress(dial.name);
        settings.push((dial.name, runtime.block_on(dial.measure(&gpu, size_px, measured))?));
    }
    progress("settings of the literature");
    let mut pairs = [2, 4, 8].into_iter().take(if quick { 1 } else { 3 }).map(wind_pair).collect::<Result<Vec<_>>>()?;
    pairs.push(bend_pair()?);
    std::fs::create_dir_all(out).with_context(|| format!("{} cannot be made", out.display()))?;
    let row: Vec<Picture> = settings.iter().skip(1).map(|(_, setting)| setting.picture.clone()).collect();
    Picture::tiled(&row, row.len())?.save(&out.join("dial.jpg"))?;
    Ok(page(&settings, &pairs))
}

fn page(settings: &[(&str, Setting)], pairs: &[Pair]) -> String {
    let rows: Vec<_> = settings
        .iter()
        .map(|(name, setting)| {
            let Setting { words, wind_percent, bend_deg, tick_ms, kbit_per_s, blades_percent, flip, frame_ms, .. } = setting;
            let errors =
                [format!("{wind_percent:.2} %"), format!("{bend_deg:.3}°"), format!("{blades_percent:.2} %"), format!("{flip:.3}")];
            let costs = [format!("{tick_ms:.3}"), format!("{frame_ms:.0}"), format!("{kbit_per_s:.0}")];
            [vec![(*name).to_owned()], errors.to_vec(), costs.to_vec(), vec![words.clone()]].concat()
        })
        .collect();
    let compared: Vec<_> = pairs
        .iter()
        .map(|Pair { what, error, ms: [published, planned], planned: words }| {
            vec![
                what.clone(),
                error.clone(),
                format!("{published:.4}"),
                format!("{planned:.4}"),
                format!("{:.1}", published / planned),
                words.clone(),
            ]
        })
        .collect();
    format!(
        "# The dial\n\n```sh\ncargo run --release -p tests --bin chart -- dial\n```\n\n\
         The storm at three settings of its [accuracy](../../server/README.md#plan), behind a car that has driven a curve; the picture leaves out the rain.\n\n\
         ![the same moment of the storm at fine, middle and coarse settings of the dial, from left to right](dial.jpg)\n\n\
         Errors are those of the plan, of the picture those of its worst view. The time of a frame is that of the picture in software. The time is that of a whole step of the world with the car, the data those to its driver without a replica of the grass, on {}.\n\n{}\n\
         ## Beside settings of the literature\n\n\
         Settings of the sources in the same storm, and planned ones that may err as much; times per tick by the cost model.\n\n{}",
        machine(),
        markdown(
            &["setting", "wind", "bend", "blades", "picture (FLIP)", "step (ms)", "frame (ms)", "data (kbit/s)", "planned wind"],
            &rows
        ),
        markdown(&["settings", "error", "published (ms)", "planned (ms)", "ratio", "planned settings"], &compared)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coarser_dial_errs_more_and_costs_less() {
        let measured = [DIALS[1], DIALS[3]].map(|dial| {
            let (texts, picture) = dial.tolerances.unwrap();
            let open = demanding(|scene| scene.accuracy = accuracy(texts, picture)).unwrap();
            let plan = open.plan_anew(&Fronts::built_in(), &mut Silent);
            let (percent, ms) = percent(&plan).unwrap();
            (percent, plan.bend.error_deg(), ms, plan.blades.unwrap().error(), plan.picture.unwrap())
        });
        let [fine, coarse] = measured.clone();
        assert!(fine.0 <= 3.0 && coarse.0 <= 30.0 && fine.0 < coarse.0, "{measured:?}");
        assert!(fine.1 < coarse.1 && coarse.2 < fine.2 && fine.3 < coarse.3, "{measured:?}");
        assert!(fine.4.flip <= 0.14 && coarse.4.highest_detail < fine.4.highest_detail, "{measured:?}");
    }
}
