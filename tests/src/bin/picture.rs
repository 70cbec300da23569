//! Draws pictures of a scene without a window: the same world and the same renderer as in the browser.

use anyhow::{Context as _, Result};
use clap::Parser;
use client_wasm::camera::Camera;
use client_wasm::render::{Far, Gpu, Look, Order, PassSecs, PassWork, Quality, Split, Sun, Way, Work};
use std::path::PathBuf;
use std::time::Instant;
use tests::picture::Picture;
use tests::stage::{Act, Stage, play};
use tests::views::chase;

/// Draws a scene to a PNG file, and says how long a frame takes.
#[derive(Parser)]
struct Arguments {
    /// Built-in scene by name, or scene file
    #[arg(long, default_value = "meadow")]
    scene: String,
    /// What happens before the picture is taken
    #[arg(long, value_enum, default_value = "wind")]
    act: Act,
    /// View as in the page's address: x,y,z,heading,pitch; default: where the scene's visitors start
    #[arg(long, allow_hyphen_values = true)]
    camera: Option<String>,
    /// Look at the act's vehicle instead, from AWAY metres behind, ABOVE metres above and ASIDE metres right of it
    #[arg(long, value_name = "AWAY,ABOVE,ASIDE", allow_hyphen_values = true)]
    chase: Option<String>,
    /// Width and height (px)
    #[arg(long, default_value = "1280x720")]
    size: String,
    /// low, medium, high or ultra
    #[arg(long, default_value = "high")]
    quality: String,
    /// How plants are laid over each other: cut, coverage, sorted, precomputed or weighted
    #[arg(long, default_value = "cut")]
    order: String,
    /// What stands for far plants: land, clumps or shells
    #[arg(long, default_value = "land")]
    far: String,
    /// Draw two ways side by side: names of orders, of what stands for far plants, or of qualities, such as low,high or cut,sorted
    #[arg(long, value_name = "LEFT,RIGHT")]
    compare: Option<String>,
    /// Hour of the day (0 to 24) by which the sun stands, instead of the scene's own
    #[arg(long)]
    hour: Option<f32>,
    /// Place of the sun instead: heading from north towards east and elevation (degrees)
    #[arg(long, value_name = "HEADING,ELEVATION", allow_hyphen_values = true, conflicts_with = "hour")]
    sun: Option<String>,
    /// Frames drawn, 1/30 s apart, so that the blades have found their motion; the last one is kept
    #[arg(long, default_value_t = 45)]
    frames: u32,
    /// File to write
    #[arg(long)]
    out: PathBuf,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    let (width, height) = arguments.size.split_once('x').context("--size: WIDTHxHEIGHT is allowed, such as 1280x720")?;
    let size_px: [u32; 2] = [width.parse().context("--size: width")?, height.parse().context("--size: height")?];
    let quality = Quality::from_name(&arguments.quality).context("--quality: low, medium, high or ultra are allowed")?;
    let order = Order::from_name(&arguments.order).context("--order: cut, coverage, sorted, precomputed or weighted are allowed")?;
    let far = Far::from_name(&arguments.far).context("--far: land, clumps or shells are allowed")?;
    let mut stage = Stage::load(&arguments.scene)?;
    let scene = stage.scene();
    let light = scene.light;
    let mut camera = match &arguments.camera {
        Some(hash) => Camera::from_hash(hash).context("--camera: five numbers are allowed: x,y,z,heading,pitch")?,
        None => Camera::start(&scene.camera, scene.extent_m(), |x, z| stage.ground_m(x, z)),
    };
    let pose = play(&mut stage, arguments.act, camera.eye_m.to_array())?;
    if let Some(offset) = &arguments.chase {
        let pose = pose.context("--chase needs an act with a vehicle")?;
        let parts: Vec<f32> = offset.split(',').map(str::parse).collect::<Result<_, _>>().context("--chase: AWAY,ABOVE,ASIDE")?;
        let &[away, above, aside] = parts.as_slice() else { anyhow::bail!("--chase: three numbers are allowed: AWAY,ABOVE,ASIDE") };
        camera = chase(&pose, [away, above, aside], |x, z| stage.ground_m(x, z));
    }

    let placed = arguments.sun.as_deref().map(sun_at).transpose()?;
    let sun = placed.or(arguments.hour.map(|hour| light.sun_at_hour(hour)));
    let way = Way { look: Look { order, far, sun, ..Look::default() }, level: quality.level() };
    let split = arguments.compare.as_deref().map(|names| compared(way, names)).transpose()?;
    let finest = |split: &Split| {
        let level = split.ways.iter().fold(quality.level(), |level, way| level.max(way.level));
        Quality::ALL.into_iter().find(|quality| quality.level() >= level).unwrap_or(quality)
    };

    let gpu = Gpu::headless()?;
    let mut picture = client_wasm::render::Picture::new(&gpu, size_px, split.as_ref().map_or(quality, finest));
    picture.set_look(way.look);
    const DT_SECS: f32 = 1.0 / 30.0;
    let mut stats = Default::default();
    let mut frame_secs = Vec::new();
    let mut pass_secs = Vec::new();
    for frame in 0..arguments.frames.max(1) {
        stage.run(DT_SECS);
        stage.show()?;
        let start = Instant::now();
        let time_secs = f64::from(frame) * f64::from(DT_SECS);
        stats = match &split {
            Some(split) => picture.draw_split(&mut stage.mirror, &camera, time_secs, DT_SECS, split),
            None => picture.draw(&mut stage.mirror, &camera, time_secs, DT_SECS),
        };
        frame_secs.push(start.elapsed().as_secs_f64());
        pass_secs.extend(picture.pass_secs());
    }
    println!("{}: {}, {stats:?}", gpu.adapter_name, paces(&frame_secs));
    let after_first = pass_secs.get(1..).filter(|rest| !rest.is_empty()).unwrap_or(&pass_secs);
    let mean_ms = |of: fn(&PassSecs) -> f64| 1e3 * after_first.iter().map(of).sum::<f64>() / after_first.len() as f64;
    if !pass_secs.is_empty() {
        let [shadows, bend, drawn, tone] =
            [mean_ms(|secs| secs.shadows), mean_ms(|secs| secs.bend), mean_ms(|secs| secs.picture), mean_ms(|secs| secs.tone)];
        println!("on the device: shadows {shadows:.2} ms, culled and bent {bend:.2}, drawn {drawn:.2}, tone mapped {tone:.2}");
    }
    if let Some(PassWork { shadows, bend, picture: drawn, tone }) = picture.pass_work() {
        println!(
            "work of the last: shadows {}; culled and bent, {:.2} M compute invocations; drawn, {}; tone mapped, {:.2} M fragments",
            worked(shadows),
            millions(bend.compute_invocations),
            worked(drawn),
            millions(tone.fragments)
        );
        if !pass_secs.is_empty() && drawn.vertices > 0 {
            println!("drawn in {:.1} ms per million vertices, fragments and all", mean_ms(|secs| secs.picture) / millions(drawn.vertices));
        }
    }
    println!("camera {}", camera.to_hash());
    Picture { width: size_px[0], height: size_px[1], rgba: picture.rgba() }.save(&arguments.out)
}

/// How long the first frame took, which makes all that is drawn and compiles the shaders, and how long those after it.
fn paces(frame_secs: &[f64]) -> String {
    let (first, rest) = (frame_secs[0] * 1e3, &frame_secs[1..]);
    let mut sorted = rest.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.get(sorted.len() / 2) {
        Some(median) => {
            let mean = rest.iter().sum::<f64>() / rest.len() as f64;
            format!("{:.1} ms a frame (median {:.1}) after a first of {first:.0} ms", mean * 1e3, median * 1e3)
        }
        None => format!("{first:.0} ms for the only frame"),
    }
}

fn millions(count: u64) -> f64 {
    1e-6 * count as f64
}

fn worked(Work { vertices, triangles, fragments, .. }: Work) -> String {
    let [vertices, triangles, fragments] = [vertices, triangles, fragments].map(millions);
    format!("{vertices:.2} M vertices, {triangles:.2} M triangles, {fragments:.2} M fragments")
}

/// Two ways side by side, each like `own` but for what its name changes.
fn compared(own: Way, names: &str) -> Result<Split> {
    let allowed = || format!("--compare: two of {} are allowed, with a comma between", Way::names().collect::<Vec<_>>().join(", "));
    let (left, right) = names.split_once(',').with_context(allowed)?;
    let way = |name: &str| own.with(name.trim()).with_context(allowed);
    Ok(Split { ways: [way(left)?, way(right)?], at: 0.5 })
}

/// The sun at a heading and an elevation in degrees, with a comma between.
fn sun_at(text: &str) -> Result<Sun> {
    let parsed = text.split_once(',').and_then(|(heading, elevation)| Some((heading.parse::<f32>().ok()?, elevation.parse::<f32>().ok()?)));
    let (heading, elevation) =
        parsed.filter(|(_, elevation)| elevation.abs() <= 90.0).context("--sun: HEADING,ELEVATION in degrees, up to 90 up or down")?;
    Ok(Sun { heading_rad: heading.to_radians(), elevation_rad: elevation.to_radians() })
}
