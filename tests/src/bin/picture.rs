//! Draws a picture of a scene without a window, by the same world and renderer as in the browser.

use anyhow::{Context as _, Result};
use clap::Parser;
use prairie_client::camera::Camera;
use prairie_client::render::{
    BlendOrder, FarPlants, Gpu, PassSecs, PassStatistics, PipelineStatistics, Quality, RenderOptions, SideOptions, Split, Sun,
};
use std::path::PathBuf;
use std::time::Instant;
use tests::arguments::quality;
use tests::picture::Picture;
use tests::stage::{Act, Stage, play};
use tests::views::chase;

/// Draws a scene to a JPEG or PNG file and prints how long a frame takes.
#[derive(Parser)]
struct Arguments {
    /// Name of a built-in scene, or a scene file
    #[arg(long, default_value = "meadow")]
    scene: String,
    /// Action before the picture is taken
    #[arg(long, value_enum, default_value = "wind")]
    act: Act,
    /// Camera as in the page's address: x,y,z,heading,pitch; default: the scene's starting view
    #[arg(long, allow_hyphen_values = true)]
    camera: Option<String>,
    /// Look at the act's vehicle instead, from AWAY metres behind it, ABOVE metres above and ASIDE metres to its right
    #[arg(long, value_name = "AWAY,ABOVE,ASIDE", allow_hyphen_values = true)]
    chase: Option<String>,
    /// Width and height (px)
    #[arg(long, default_value = "1280x720")]
    size: String,
    /// Quality preset
    #[arg(long, default_value = "high", value_parser = quality())]
    quality: Quality,
    /// Transparency of plants: cut (alpha test), coverage (alpha to coverage), sorted, precomputed (order) or weighted (blended OIT)
    #[arg(long, default_value = "cut")]
    order: String,
    /// Representation of distant plants: land, clumps or shells
    #[arg(long, default_value = "land")]
    far: String,
    /// Draw two render options side by side: two names of qualities, transparencies or representations of distant plants, such as low,high or cut,sorted
    #[arg(long, value_name = "LEFT,RIGHT")]
    compare: Option<String>,
    /// Hour of the day (0 to 24) that places the sun, instead of the scene's own
    #[arg(long)]
    hour: Option<f32>,
    /// Position of the sun instead: heading from north towards east, and elevation (degrees)
    #[arg(long, value_name = "HEADING,ELEVATION", allow_hyphen_values = true, conflicts_with = "hour")]
    sun: Option<String>,
    /// Number of frames, 1/30 s apart; the last one is written. Several let the blades begin to move
    #[arg(long, default_value_t = 45)]
    frames: u32,
    /// File to write; its ending, .jpg or .png, chooses the format
    #[arg(long)]
    out: PathBuf,
}

fn main() -> Result<()> {
    let arguments = Arguments::parse();
    let (width, height) = arguments.size.split_once('x').context("--size: WIDTHxHEIGHT is allowed, such as 1280x720")?;
    let size_px: [u32; 2] = [width.parse().context("--size: width")?, height.parse().context("--size: height")?];
    let quality = arguments.quality;
    let order = BlendOrder::from_name(&arguments.order).context("--order: cut, coverage, sorted, precomputed or weighted are allowed")?;
    let far = FarPlants::from_name(&arguments.far).context("--far: land, clumps or shells are allowed")?;
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
    let way = SideOptions {
        options: RenderOptions { blend_order: order, far_plants: far, sun, ..RenderOptions::default() },
        level: quality.level(),
    };
    let split = arguments.compare.as_deref().map(|names| compared(way, names)).transpose()?;
    let finest = |split: &Split| {
        let level = split.sides.iter().fold(quality.level(), |level, way| level.max(way.level));
        Quality::ALL.into_iter().find(|quality| quality.level() >= level).unwrap_or(quality)
    };

    let gpu = Gpu::headless()?;
    let mut picture = prairie_client::render::OffscreenRenderer::new(&gpu, size_px, split.as_ref().map_or(quality, finest));
    picture.set_options(way.options);
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
    println!("{}: {}, {stats:?}", gpu.adapter_name, frame_times(&frame_secs));
    let after_first = pass_secs.get(1..).filter(|rest| !rest.is_empty()).unwrap_or(&pass_secs);
    let mean_ms = |of: fn(&PassSecs) -> f64| 1e3 * after_first.iter().map(of).sum::<f64>() / after_first.len() as f64;
    if !pass_secs.is_empty() {
        let [shadows, bend, drawn, tone] =
            [mean_ms(|secs| secs.shadows), mean_ms(|secs| secs.bend), mean_ms(|secs| secs.picture), mean_ms(|secs| secs.tone)];
        println!("GPU time: shadows {shadows:.2} ms, culling and bending {bend:.2} ms, drawing {drawn:.2} ms, tone mapping {tone:.2} ms");
    }
    if let Some(PassStatistics { shadows, bend, picture: drawn, tone }) = picture.pass_statistics() {
        println!(
            "pipeline statistics of the last frame: shadows {}; culling and bending, {:.2} M compute invocations; drawing, {}; tone mapping, {:.2} M fragments",
            statistics(shadows),
            millions(bend.compute_invocations),
            statistics(drawn),
            millions(tone.fragments)
        );
        if !pass_secs.is_empty() && drawn.vertices > 0 {
            println!(
                "drawing takes {:.1} ms per million vertices, fragments included",
                mean_ms(|secs| secs.picture) / millions(drawn.vertices)
            );
        }
    }
    println!("camera {}", camera.to_hash());
    Picture { width: size_px[0], height: size_px[1], rgba: picture.rgba() }.save(&arguments.out)
}

/// Frame times in words. The first frame, which builds the scene and compiles the shaders, is stated apart from the others.
fn frame_times(frame_secs: &[f64]) -> String {
    let (first, rest) = (frame_secs[0] * 1e3, &frame_secs[1..]);
    let mut sorted = rest.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.get(sorted.len() / 2) {
        Some(median) => {
            let mean = rest.iter().sum::<f64>() / rest.len() as f64;
            format!("{:.1} ms per frame (median {:.1}) after {first:.0} ms for the first", mean * 1e3, median * 1e3)
        }
        None => format!("{first:.0} ms for the only frame"),
    }
}

fn millions(count: u64) -> f64 {
    1e-6 * count as f64
}

fn statistics(PipelineStatistics { vertices, triangles, fragments, .. }: PipelineStatistics) -> String {
    let [vertices, triangles, fragments] = [vertices, triangles, fragments].map(millions);
    format!("{vertices:.2} M vertices, {triangles:.2} M triangles, {fragments:.2} M fragments")
}

/// Two render options side by side; each name changes one property of `own`.
fn compared(own: SideOptions, names: &str) -> Result<Split> {
    let allowed = || format!("--compare: give two of {}, separated by a comma", SideOptions::names().collect::<Vec<_>>().join(", "));
    let (left, right) = names.split_once(',').with_context(allowed)?;
    let way = |name: &str| own.with(name.trim()).with_context(allowed);
    Ok(Split { sides: [way(left)?, way(right)?], border: 0.5 })
}

/// Parses the position of the sun: heading and elevation in degrees, separated by a comma.
fn sun_at(text: &str) -> Result<Sun> {
    let parsed = text.split_once(',').and_then(|(heading, elevation)| Some((heading.parse::<f32>().ok()?, elevation.parse::<f32>().ok()?)));
    let (heading, elevation) =
        parsed.filter(|(_, elevation)| elevation.abs() <= 90.0).context("--sun: HEADING,ELEVATION in degrees, elevation from -90 to 90")?;
    Ok(Sun { heading_rad: heading.to_radians(), elevation_rad: elevation.to_radians() })
}
