//! `prairie picture`: draws a picture of a scene without a browser.

use super::number::whole;
use super::print::print;
use super::shot::Shot;
use anyhow::Result;
use clap::Args;
use prairie::studio::{play, write_picture};
use prairie_client::render::{OffscreenRenderer, PassSecs, PassStatistics, PipelineStatistics};
use std::path::PathBuf;
use std::time::Instant;

pub(super) const EXAMPLES: &str = "\
Examples:
  prairie picture --out meadow.jpg
  prairie picture --scene storm --quality ultra --size 1920x1080 --out storm.png
  prairie picture --act track --chase 7,2.2,0 --out car.jpg
  prairie picture --hour 19.5 --camera 128,1.7,158,20,-6 --out evening.jpg
  prairie picture --compare low,ultra --out qualities.jpg

It needs a Vulkan driver; a software one, such as Debian's mesa-vulkan-drivers, is enough.
The view is in the page's address, behind the #.";

/// Time between two frames (s).
const DT_SECS: f32 = 1.0 / 30.0;

/// Arguments of `prairie picture`.
#[derive(Debug, Args)]
pub(super) struct Picture {
    #[command(flatten)]
    shot: Shot,
    /// Number of frames, 1/30 s apart, 1 to 100000; the last one is written. Several let the blades begin to move
    #[arg(long, value_name = "N", default_value_t = 45, value_parser = whole::<u32>(1..=100_000))]
    frames: u32,
    /// Print the GPU time of the passes and what they process
    #[arg(long)]
    stats: bool,
    /// File to write; its ending, .jpg or .png, chooses the format
    #[arg(long, value_name = "FILE", value_parser = file)]
    out: PathBuf,
}

impl Picture {
    pub(super) fn run(&self) -> Result<()> {
        let mut studio = self.shot.open()?;
        let eye_m = studio.camera().eye_m.to_array();
        let pose = play(&mut studio.stage, self.shot.act(), eye_m)?;
        studio.follow(pose.as_ref());
        let (mut frame_secs, mut pass_secs) = (Vec::new(), Vec::new());
        for _ in 0..self.frames {
            studio.stage.run(DT_SECS);
            studio.stage.show()?;
            let start = Instant::now();
            studio.draw(DT_SECS);
            frame_secs.push(start.elapsed().as_secs_f64());
            pass_secs.extend(studio.renderer.pass_secs());
        }
        write_picture(&self.out, self.shot.size_px(), &studio.renderer.rgba())?;
        print(format_args!("{}: {}", studio.gpu.adapter_name, frame_times(&frame_secs)))?;
        if self.stats {
            print_stats(&studio.renderer, &pass_secs)?;
        }
        print(format_args!("{}, camera {}", self.out.display(), studio.camera().to_hash()))?;
        Ok(())
    }
}

fn file(name: &str) -> Result<PathBuf, &'static str> {
    let path = PathBuf::from(name);
    let ending = path.extension().and_then(|ending| ending.to_str());
    if matches!(ending, Some("png" | "jpg" | "jpeg")) { Ok(path) } else { Err("allowed: a name that ends in .png, .jpg or .jpeg") }
}

/// Frame times in words. The first frame, which builds the scene and compiles the shaders, is stated apart from the others.
fn frame_times(frame_secs: &[f64]) -> String {
    let (first_ms, rest) = (frame_secs[0] * 1e3, &frame_secs[1..]);
    let mut sorted = rest.to_vec();
    sorted.sort_by(f64::total_cmp);
    match sorted.get(sorted.len() / 2) {
        Some(median) => {
            let mean = rest.iter().sum::<f64>() / rest.len() as f64;
            format!("{:.1} ms per frame (median {:.1}) after {first_ms:.0} ms for the first", mean * 1e3, median * 1e3)
        }
        None => format!("{first_ms:.0} ms for the only frame"),
    }
}

/// Prints the mean GPU time of the passes, without the first frame, and the pipeline statistics of the last frame, where the device counts them.
fn print_stats(renderer: &OffscreenRenderer, pass_secs: &[PassSecs]) -> Result<()> {
    let after_first = pass_secs.get(1..).filter(|rest| !rest.is_empty()).unwrap_or(pass_secs);
    let mean_ms = |of: fn(&PassSecs) -> f64| 1e3 * after_first.iter().map(of).sum::<f64>() / after_first.len() as f64;
    if pass_secs.is_empty() {
        print(format_args!("GPU time: this device has no timestamp queries"))?;
    } else {
        let [shadows, bend, drawn, tone] =
            [mean_ms(|secs| secs.shadows), mean_ms(|secs| secs.bend), mean_ms(|secs| secs.picture), mean_ms(|secs| secs.tone)];
        print(format_args!(
            "GPU time: shadows {shadows:.2} ms, culling and bending {bend:.2} ms, drawing {drawn:.2} ms, tone mapping {tone:.2} ms"
        ))?;
    }
    let Some(PassStatistics { shadows, bend, picture: drawn, tone }) = renderer.pass_statistics() else {
        print(format_args!("pipeline statistics: this device has none"))?;
        return Ok(());
    };
    print(format_args!(
        "pipeline statistics of the last frame: shadows {}; culling and bending, {:.2} M compute invocations; drawing, {}; tone mapping, {:.2} M fragments",
        statistics(shadows),
        millions(bend.compute_invocations),
        statistics(drawn),
        millions(tone.fragments)
    ))?;
    if !pass_secs.is_empty() && drawn.vertices > 0 {
        print(format_args!(
            "drawing takes {:.1} ms per million vertices, fragments included",
            mean_ms(|secs| secs.picture) / millions(drawn.vertices)
        ))?;
    }
    Ok(())
}

fn millions(count: u64) -> f64 {
    1e-6 * count as f64
}

fn statistics(PipelineStatistics { vertices, triangles, fragments, .. }: PipelineStatistics) -> String {
    let [vertices, triangles, fragments] = [vertices, triangles, fragments].map(millions);
    format!("{vertices:.2} M vertices, {triangles:.2} M triangles, {fragments:.2} M fragments")
}
