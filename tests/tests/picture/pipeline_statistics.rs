//! GPU pipeline statistics match the drawn content.

use anyhow::{Result, ensure};
use prairie_client::render::{
    BlendOrder, FarPlants, Gpu, OffscreenRenderer as Canvas, PassStatistics, PipelineStatistics, Quality, RenderOptions,
};
use tests::still::Still;
use tests::views::View;
use tests::worlds::{bare_land, flat_meadow, on_foot};

use crate::gpu;

const SIZE_PX: [u32; 2] = [192, 108];
/// Side of the flat worlds (m).
const SIDE_M: u32 = 64;

/// Pipeline statistics of a frame; `None`, with a message, where the GPU does not support them. Software Vulkan does.
fn work(gpu: &Gpu, canvas: &Canvas) -> Result<Option<PassStatistics>> {
    let work = canvas.pass_statistics();
    ensure!(work.is_some() || !gpu.is_software, "{} should count", gpu.adapter_name);
    if work.is_none() {
        println!("not tested: {} does not count what it works through", gpu.adapter_name);
    }
    Ok(work)
}

fn view(name: &str) -> Result<Still> {
    Still::of(View::find(name)?, SIZE_PX)
}

#[test]
fn finer_plants_have_more_vertices() -> Result<()> {
    let gpu = gpu()?;
    let mut still = view("walking-calm")?;
    let mut canvas = still.canvas(&gpu, Quality::Ultra);
    let mut before = 0;
    for level in [0.0, 1.0, 2.0, 3.0] {
        canvas.set_level(level);
        still.draw(&mut canvas);
        let Some(PassStatistics { picture, .. }) = work(&gpu, &canvas)? else { return Ok(()) };
        println!("level {level}: {picture:?}");
        ensure!(picture.vertices > before + before / 10, "level {level}: {} vertices, {before} a level below", picture.vertices);
        before = picture.vertices;
    }
    Ok(())
}

#[test]
fn culling_saves_vertices_and_hardly_any_fragments() -> Result<()> {
    let gpu = gpu()?;
    let mut still = view("driving-calm")?;
    let mut canvas = still.canvas(&gpu, Quality::Low);
    let mut found = Vec::new();
    for culls in [true, false] {
        canvas.set_options(RenderOptions { culls, ..RenderOptions::default() });
        still.draw(&mut canvas);
        let Some(PassStatistics { picture, .. }) = work(&gpu, &canvas)? else { return Ok(()) };
        found.push(picture);
    }
    let [with, without] = found[..] else { unreachable!("two looks") };
    println!("with culling {with:?}, without {without:?}");
    ensure!(2 * with.vertices < without.vertices, "{} of {} vertices are left", with.vertices, without.vertices);
    ensure!(with.fragments.abs_diff(without.fragments) < without.fragments / 100, "{with:?} {without:?}");
    Ok(())
}

#[test]
fn most_vertices_belong_to_plants() -> Result<()> {
    let gpu = gpu()?;
    let of = |mirror: &mut _| {
        let mut canvas = Canvas::new(&gpu, SIZE_PX, Quality::Medium);
        canvas.draw(mirror, &on_foot(SIDE_M), 0.0, 0.0);
        work(&gpu, &canvas)
    };
    let (Some(grown), Some(bare)) = (of(&mut flat_meadow(SIDE_M)?.0)?, of(&mut bare_land(SIDE_M)?)?) else { return Ok(()) };
    println!("grown {:?}, bare {:?}", grown.picture, bare.picture);
    ensure!(bare.picture.vertices > 0 && grown.picture.vertices > 7 * bare.picture.vertices, "{grown:?} {bare:?}");
    ensure!(grown.bend.compute_invocations > bare.bend.compute_invocations, "{grown:?} {bare:?}");
    Ok(())
}

/// Each pass has its own kind of work and no other, for all render options, which differ in their passes.
#[test]
fn each_pass_has_its_own_pipeline_statistics() -> Result<()> {
    let gpu = gpu()?;
    let mut still = view("walking-storm")?;
    for quality in [Quality::Low, Quality::High] {
        for (order, far) in [(BlendOrder::Cut, FarPlants::Land), (BlendOrder::Weighted, FarPlants::Clumps)] {
            let mut canvas = still.canvas(&gpu, quality);
            canvas.set_options(RenderOptions { blend_order: order, far_plants: far, ..RenderOptions::default() });
            still.draw(&mut canvas);
            let Some(PassStatistics { shadows, bend, picture, tone }) = work(&gpu, &canvas)? else { return Ok(()) };
            let name = format!("{}, {}, {}", quality.name(), order.name(), far.name());
            ensure!(shadows.vertices > 0 && shadows.compute_invocations == 0, "{name}: shadows {shadows:?}");
            ensure!(
                bend == PipelineStatistics { compute_invocations: bend.compute_invocations, ..PipelineStatistics::default() }
                    && bend != PipelineStatistics::default(),
                "{name}: {bend:?}"
            );
            ensure!(
                picture.fragments > pixels() && picture.triangles > 0 && picture.compute_invocations == 0,
                "{name}: picture {picture:?}"
            );
            // One triangle over the whole picture; drivers that run blocks of fragments also count some beyond its edges.
            ensure!(tone.vertices == 3 && (pixels()..2 * pixels()).contains(&tone.fragments), "{name}: tone {tone:?}");
            // No shadow caster has moved.
            still.draw(&mut canvas);
            ensure!(
                work(&gpu, &canvas)?.is_some_and(|work| work.shadows == PipelineStatistics::default()),
                "{name}: shadows are drawn twice"
            );
        }
    }
    Ok(())
}

fn pixels() -> u64 {
    SIZE_PX.map(u64::from).iter().product()
}
