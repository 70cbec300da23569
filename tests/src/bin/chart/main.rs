//! Compares and draws for the documents, and updates their tables.

mod drawings;
mod help;

use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, ensure};
use clap::{Args, Parser, Subcommand};
use indicatif::{ProgressBar, ProgressStyle};
use prairie::charts::picture::{self, METHODS, Method, ViewShots};
use prairie::charts::still::Still;
use prairie::charts::views::{VIEWS, View};
use prairie_charts::machine::machine;
use prairie_charts::tables::with_tables;
use prairie_client::render::{Gpu, Quality};
use tests::arguments::quality;
use tests::chart::gallery::reference_path;
use tests::chart::peers::{self, Peer};
use tests::chart::plates::Plate;
use tests::chart::versions::{PAGE_VIEWS, PageView};
use tests::chart::{dial, features, gpu, heights, need, start, versions, zhang};

use drawings::{draw_gallery, draw_pictures, draw_plates};
use help::{EXAMPLES, GPU_FILES, PEERS_FILES, PICTURE_FILES, PLATES_FILES, START_FILES, VERSIONS_FILES};

/// Comparisons and pictures for the documents: the picture and what parts of a scene cost, other programs, figures of the literature.
///
/// Methods on problems with known solutions are measured by `prairie chart`. Times are meaningful only on an idle machine.
#[derive(Parser)]
#[command(after_help = EXAMPLES)]
struct Arguments {
    #[command(subcommand)]
    model: Model,
}

#[derive(Subcommand)]
enum Model {
    /// Render options: frame time against visible error, on ten views
    #[command(after_help = PICTURE_FILES)]
    Picture {
        #[command(flatten)]
        options: Options,
        /// Width and height of the pictures (px); default 960x540, with --quick 320x180
        #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size_px)]
        size: Option<[u32; 2]>,
        /// Only these views, separated by commas
        #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = View::find)]
        views: Vec<&'static View>,
    },
    /// What parts of a scene cost: vehicles, snow, snowfall, trees of components; on the server, on the wire and in a frame
    Features {
        /// Output folder
        #[arg(long, value_name = "DIR", default_value = "tests/results")]
        out: PathBuf,
        /// Small pictures and few steps, for a quick look
        #[arg(long)]
        quick: bool,
    },
    /// The gallery: a page of the ten views with frame times, similarity to a reference, and figures in the literature
    Gallery {
        /// Folder of the page
        #[arg(long, value_name = "DIR", default_value = "tests/results/gallery")]
        out: PathBuf,
        /// Cache folder of references
        #[arg(long, value_name = "DIR", default_value = CACHE)]
        cache: PathBuf,
        /// Width and height of the pictures (px)
        #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "960x540", value_parser = size_px)]
        size: [u32; 2],
        /// Quality of the pictures on the page; all are measured
        #[arg(long, default_value = "ultra", value_parser = quality())]
        quality: Quality,
        /// Only these views, separated by commas
        #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = View::find)]
        views: Vec<&'static View>,
    },
    /// One view from 1, 5, 10 and 20 m as one picture (Zhang, Fig. 23)
    Heights {
        /// File to write: .jpg or .png
        #[arg(long, value_name = "FILE", default_value = "tests/results/heights.jpg")]
        out: PathBuf,
        /// Width and height of each of the four views (px)
        #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "288x162", value_parser = size_px)]
        size: [u32; 2],
        /// Quality of the views
        #[arg(long, default_value = "ultra", value_parser = quality())]
        quality: Quality,
    },
    /// Figures of the literature drawn again, as tiles that differ in a setting or in time
    #[command(after_help = PLATES_FILES)]
    Plates {
        /// Folder of the page
        #[arg(long, value_name = "DIR", default_value = "tests/results/plates")]
        out: PathBuf,
        /// Only these plates, separated by commas
        #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = Plate::find)]
        only: Vec<&'static Plate>,
    },
    /// The renderer on this machine's graphics card: frames and passes beside their aims, in less than five minutes
    #[command(after_help = GPU_FILES)]
    Gpu {
        /// Output folder
        #[arg(long, value_name = "DIR", default_value = "target/charts")]
        out: PathBuf,
        /// Small pictures and single frames, for a quick look
        #[arg(long)]
        quick: bool,
    },
    /// Cost against need: processor time of the server, line and frame, from empty land to a storm
    Need {
        /// Output folder
        #[arg(long, value_name = "DIR", default_value = "tests/results")]
        out: PathBuf,
        /// Small pictures and short runs, for a quick look
        #[arg(long)]
        quick: bool,
    },
    /// One storm at three settings of its accuracy, with error, cost, data and picture; planned settings beside those of the literature
    Dial {
        /// Output folder
        #[arg(long, value_name = "DIR", default_value = "tests/results")]
        out: PathBuf,
        /// Small pictures and short runs, for a quick look
        #[arg(long)]
        quick: bool,
    },
    /// Frame rates of other programs that draw grass, and of ours, in a browser with software WebGPU
    #[command(after_help = PEERS_FILES)]
    Peers {
        /// Name of a program and the folder of its built page; repeat for more
        #[arg(long = "peer", value_name = "NAME=FOLDER", value_parser = Peer::parse)]
        peers: Vec<Peer>,
        /// Measured time of each page (s)
        #[arg(long, default_value_t = 30, value_parser = clap::value_parser!(u64).range(1..=600))]
        seconds: u64,
        /// Output folder
        #[arg(long, value_name = "DIR", default_value = "target/charts")]
        out: PathBuf,
    },
    /// Start of a page in fresh browsers with software WebGPU: times of the first pictures, and of a frame in the page
    #[command(after_help = START_FILES)]
    Start {
        /// Number of pages at each quality
        #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u32).range(1..=1000))]
        pages: u32,
        /// Output folder
        #[arg(long, value_name = "DIR", default_value = "target/charts")]
        out: PathBuf,
    },
    /// Pictures of a document, drawn again by the commands beside them
    Pictures {
        /// The document
        #[arg(long, value_name = "FILE", default_value = "tests/results/README.md")]
        of: PathBuf,
        /// Only pictures with this word in their file name
        #[arg(long, value_name = "WORD")]
        only: Option<String>,
    },
    /// Two versions of Prairie in a browser with software WebGPU: the same views of each, side by side
    #[command(after_help = VERSIONS_FILES)]
    Versions {
        /// Program of the earlier version, such as ../earlier/target/release/prairie
        #[arg(long, value_name = "PROGRAM")]
        before: PathBuf,
        /// Program of the later version
        #[arg(long, value_name = "PROGRAM", default_value = "target/release/prairie")]
        after: PathBuf,
        /// Only these views, separated by commas
        #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = PageView::find)]
        views: Vec<&'static PageView>,
        /// Output folder
        #[arg(long, value_name = "DIR", default_value = "tests/results/versions")]
        out: PathBuf,
    },
    /// Orders and limits of the wind: measured again, and their tables in a document replaced
    Tables {
        /// The document
        #[arg(long, value_name = "FILE", default_value = "tests/README.md")]
        of: PathBuf,
    },
    /// Zhang's prairie on this machine, beside the platform of the thesis (Table 3)
    Zhang {
        /// Output folder
        #[arg(long, value_name = "DIR", default_value = "tests/results")]
        out: PathBuf,
        /// Small pictures and few steps, for a quick look
        #[arg(long)]
        quick: bool,
    },
}

/// Cache folder of references, within the folder of the charts.
const CACHE: &str = "target/charts/cache";

#[derive(Args)]
struct Options {
    /// Output folder
    #[arg(long, value_name = "DIR", default_value = "target/charts")]
    out: PathBuf,
    /// Coarse grids and few repetitions: less than a minute, for a quick look
    #[arg(long)]
    quick: bool,
    /// Only problems and methods with this word in their name
    #[arg(long, value_name = "WORD")]
    only: Option<String>,
}

fn main() -> Result<()> {
    match Arguments::parse().model {
        Model::Picture { options, size, views } => chart_picture(&options, size, &chosen(views)),
        Model::Features { out, quick } => report_features(&out, quick),
        Model::Gallery { out, cache, size, quality, views } => draw_gallery(&out, &cache, size, quality, &chosen(views)),
        Model::Heights { out, size, quality } => heights::series(&Gpu::headless()?, size, quality)?.save(&out),
        Model::Plates { out, only } => draw_plates(&out, &only),
        Model::Gpu { out, quick } => report_gpu(&out, quick),
        Model::Dial { out, quick } => report_dial(&out, quick),
        Model::Need { out, quick } => report_need(&out, quick),
        Model::Peers { peers, seconds, out } => compare_peers(&peers, seconds, &out),
        Model::Start { pages, out } => time_starts(pages, &out),
        Model::Versions { before, after, views, out } => compare_versions(&before, &after, views, &out),
        Model::Pictures { of, only } => draw_pictures(&of, only.as_deref()),
        Model::Zhang { out, quick } => write_report(&zhang::report(quick)?, &out, "zhang.md"),
        Model::Tables { of } => write_tables(&of),
    }
}

fn size_px(text: &str) -> Result<[u32; 2]> {
    let sides = text.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    sides
        .filter(|sides| sides.iter().all(|side| (16..=4096).contains(side)))
        .context("WIDTHxHEIGHT is allowed, each 16 to 4096, such as 960x540")
}

/// The requested views; all by default.
fn chosen(views: Vec<&'static View>) -> Vec<&'static View> {
    if views.is_empty() { VIEWS.iter().collect() } else { views }
}

fn progress(steps: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed} {wide_msg}").expect("the template is well formed");
    ProgressBar::new(steps as u64).with_style(style)
}

/// Measures every method on every view; files are written after each view, so that an interrupted run keeps its results.
fn chart_picture(options: &Options, size: Option<[u32; 2]>, views: &[&View]) -> Result<()> {
    let is_asked = |name: &str| options.only.as_ref().is_none_or(|word| name.to_lowercase().contains(&word.to_lowercase()));
    let methods: Vec<Method> = METHODS.into_iter().filter(|method| is_asked(&method.name())).collect();
    ensure!(!methods.is_empty(), "--only: no method has this in its name");
    let qualities = if options.quick { vec![Quality::Low, Quality::Medium] } else { Quality::ALL.to_vec() };
    let size_px = size.unwrap_or(if options.quick { [320, 180] } else { [960, 540] });
    let wanted = ViewShots { methods, qualities, frames: if options.quick { 1 } else { 5 } };
    let gpu = Gpu::headless()?;
    let about = format!("{} × {} px; {}; {}", size_px[0], size_px[1], gpu.adapter_name, machine());
    let bar = progress(views.len() * (1 + wanted.methods.len() * wanted.qualities.len()));
    let (mut shots, mut files) = (Vec::new(), Vec::new());
    for view in views {
        bar.set_message(format!("{}, reference", view.name));
        let mut still = Still::of(view, size_px)?;
        let reference = still.kept_reference(&gpu, &reference_path(&options.out.join("cache"), view, size_px))?;
        bar.inc(1);
        shots.extend(picture::shots(&gpu, view.name, &mut still, &reference, &wanted, |name| {
            bar.set_message(name.to_owned());
            bar.inc(1);
        })?);
        files = picture::write_all(&shots, &about, &options.out)?;
    }
    bar.finish_and_clear();
    println!("picture: means over {} views\n{about}\n\n{}", views.len(), picture::summary(&shots));
    println!("{} files in {}", files.len(), options.out.display());
    Ok(())
}

/// A line that says what is being done, and since when.
fn spinner() -> ProgressBar {
    let style = ProgressStyle::with_template("{spinner} {elapsed} {wide_msg}").expect("the template is well formed");
    let bar = ProgressBar::new_spinner().with_style(style);
    bar.enable_steady_tick(std::time::Duration::from_millis(200));
    bar
}

fn report_features(out: &Path, quick: bool) -> Result<()> {
    let bar = spinner();
    let report = features::report(quick, |name| bar.set_message(name.to_owned()))?;
    bar.finish_and_clear();
    write_report(&report, out, "features.md")
}

fn report_need(out: &Path, quick: bool) -> Result<()> {
    let bar = spinner();
    let report = need::report(quick, |name| bar.set_message(name.to_owned()))?;
    bar.finish_and_clear();
    write_report(&report, out, "need.md")
}

fn report_dial(out: &Path, quick: bool) -> Result<()> {
    let bar = spinner();
    let report = dial::report(quick, out, |name| bar.set_message(name.to_owned()))?;
    bar.finish_and_clear();
    write_report(&report, out, "dial.md")
}

fn report_gpu(out: &Path, quick: bool) -> Result<()> {
    let bar = spinner();
    let report = gpu::report(quick, &machine(), |name| bar.set_message(name.to_owned()))?;
    bar.finish_and_clear();
    write_report(&report, out, "gpu.md")
}

fn compare_peers(peers: &[Peer], seconds: u64, out: &Path) -> Result<()> {
    let (bar, screenshots) = (spinner(), out.join("peers"));
    std::fs::create_dir_all(&screenshots).with_context(|| format!("{} cannot be made", screenshots.display()))?;
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build()?;
    let measured = std::time::Duration::from_secs(seconds);
    let report = runtime.block_on(peers::compare(peers, measured, &machine(), &screenshots, |name| bar.set_message(name.to_owned())))?;
    bar.finish_and_clear();
    write_report(&report, out, "peers.md")
}

fn time_starts(pages: u32, out: &Path) -> Result<()> {
    let bar = spinner();
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build()?;
    let report = runtime.block_on(start::measure(pages, &machine(), |name| bar.set_message(name.to_owned())))?;
    bar.finish_and_clear();
    write_report(&report, out, "start.md")
}

fn compare_versions(before: &Path, after: &Path, views: Vec<&'static PageView>, out: &Path) -> Result<()> {
    let bar = spinner();
    let runtime = tokio::runtime::Builder::new_multi_thread().worker_threads(1).enable_all().build()?;
    let views = if views.is_empty() { PAGE_VIEWS.iter().collect() } else { views };
    runtime.block_on(versions::compare(before, after, &views, out, |name| bar.set_message(name.to_owned())))?;
    bar.finish_and_clear();
    println!("{} pairs of pictures in {}", views.len(), out.display());
    Ok(())
}

fn write_report(report: &str, out: &Path, name: &str) -> Result<()> {
    println!("{report}");
    std::fs::create_dir_all(out).with_context(|| format!("{} cannot be made", out.display()))?;
    let path = out.join(name);
    std::fs::write(&path, report).with_context(|| format!("{} cannot be written", path.display()))
}

fn write_tables(document: &Path) -> Result<()> {
    let text = std::fs::read_to_string(document).with_context(|| format!("{} cannot be read", document.display()))?;
    let text = with_tables(&text).with_context(|| document.display().to_string())?;
    std::fs::write(document, text).with_context(|| format!("{} cannot be written", document.display()))
}
