//! GPU pipeline statistics match the drawn content.

use anyhow::{Context as _, Result, ensure};
use prairie::charts::still::Still;
use prairie::charts::views::View;
use prairie::charts::worlds::{bare_land, flat_meadow, on_foot};
use prairie_client::render::{
    BlendOrder, FarPlants, Gpu, OffscreenRenderer as Canvas, PassStatistics, PipelineStatistics, Quality, RenderOptions,
};

use crate::{ensure_refused, gpu};

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

/// Checks that each level of detail has a tenth more vertices than the one below.
fn check_finer(vertices: &[u64]) -> Result<()> {
    ensure!(vertices.first().is_some_and(|lowest| *lowest > 0), "the lowest level has no vertices");
    for (level, pair) in vertices.windows(2).enumerate() {
        ensure!(pair[1] > pair[0] + pair[0] / 10, "level {}: {} vertices, {} a level below", level + 1, pair[1], pair[0]);
    }
    Ok(())
}

#[test]
fn finer_plants_have_more_vertices() -> Result<()> {
    let gpu = gpu()?;
    let mut still = view("walking-calm")?;
    let mut canvas = still.canvas(&gpu, Quality::Ultra);
    let mut vertices = Vec::new();
    for level in [0.0, 1.0, 2.0, 3.0] {
        canvas.set_level(level);
        still.draw(&mut canvas);
        let Some(PassStatistics { picture, .. }) = work(&gpu, &canvas)? else { return Ok(()) };
        println!("level {level}: {picture:?}");
        vertices.push(picture.vertices);
    }
    check_finer(&vertices)?;
    // Negative controls: nothing drawn, one level twice, and the levels in the opposite order.
    ensure_refused(check_finer(&[0, vertices[0]]), "no vertices")?;
    ensure_refused(check_finer(&[vertices[0], vertices[0]]), "a level below")?;
    vertices.reverse();
    ensure_refused(check_finer(&vertices), "a level below")
}

/// Checks that culling halves the vertices at least, and hardly changes the fragments.
fn check_culling([with, without]: [PipelineStatistics; 2]) -> Result<()> {
    ensure!(2 * with.vertices < without.vertices, "{} of {} vertices are left", with.vertices, without.vertices);
    ensure!(with.fragments.abs_diff(without.fragments) < without.fragments / 1000, "fragments: {with:?} {without:?}");
    Ok(())
}

#[test]
fn culling_saves_vertices_and_hardly_any_fragments() -> Result<()> {
    let gpu = gpu()?;
    let mut still = view("driving-calm")?;
    let mut canvas = still.canvas(&gpu, Quality::Low);
    let mut found = Vec::new();
    for (culls, has_car) in [(true, true), (false, true), (true, false)] {
        canvas.set_options(RenderOptions { culls, ..RenderOptions::default() });
        if !has_car {
            still.stage.show_bare()?;
        }
        still.draw(&mut canvas);
        let Some(PassStatistics { picture, .. }) = work(&gpu, &canvas)? else { return Ok(()) };
        found.push(picture);
    }
    let [with, without, carless] = found[..] else { unreachable!("three looks") };
    println!("with culling {with:?}, without {without:?}, without the car {carless:?}");
    check_culling([with, without])?;
    // Negative controls: no culling, and culling that leaves out the car in the middle of the picture.
    ensure_refused(check_culling([without, without]), "vertices are left")?;
    ensure_refused(check_culling([carless, without]), "fragments")
}

/// Checks that most of the work of a meadow is due to its plants.
fn check_plants(grown: &PassStatistics, bare: &PassStatistics) -> Result<()> {
    ensure!(bare.picture.vertices > 0, "bare land has no vertices");
    let [of_grown, of_bare] = [grown, bare].map(|work| work.picture.vertices);
    ensure!(of_grown > 7 * of_bare, "{of_grown} vertices with plants, {of_bare} without");
    let [of_grown, of_bare] = [grown, bare].map(|work| work.bend.compute_invocations);
    ensure!(of_grown > of_bare, "{of_grown} compute invocations with plants, {of_bare} without");
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
    println!("grown {:?} {:?}, bare {:?} {:?}", grown.picture, grown.bend, bare.picture, bare.bend);
    check_plants(&grown, &bare)?;
    // Negative controls: no land, no plants in either, and plants that are drawn but not bent.
    ensure_refused(check_plants(&grown, &PassStatistics::default()), "bare land has no vertices")?;
    ensure_refused(check_plants(&bare, &bare), "vertices with plants")?;
    ensure_refused(check_plants(&PassStatistics { bend: bare.bend, ..grown }, &bare), "compute invocations with plants")
}

/// Checks that each pass has its own kind of work and no other.
fn check_passes(PassStatistics { shadows, bend, picture, tone }: &PassStatistics) -> Result<()> {
    ensure!(shadows.vertices > 0 && shadows.compute_invocations == 0, "shadows {shadows:?}");
    let of_compute = PipelineStatistics { compute_invocations: bend.compute_invocations, ..PipelineStatistics::default() };
    ensure!(*bend == of_compute && bend.compute_invocations > 0, "bend {bend:?}");
    ensure!(picture.fragments > pixels() && picture.triangles > 0 && picture.compute_invocations == 0, "picture {picture:?}");
    // One triangle over the whole picture; drivers that run blocks of fragments also count some beyond its edges.
    ensure!(tone.vertices == 3 && (pixels()..2 * pixels()).contains(&tone.fragments), "tone {tone:?}");
    Ok(())
}

/// Checks a frame in which no shadow caster has moved since the one before.
fn check_resting(work: &PassStatistics) -> Result<()> {
    ensure!(work.shadows == PipelineStatistics::default(), "shadows are drawn twice: {:?}", work.shadows);
    Ok(())
}

/// For all render options that differ in their passes.
#[test]
fn each_pass_has_its_own_pipeline_statistics() -> Result<()> {
    let gpu = gpu()?;
    let mut still = view("walking-storm")?;
    for quality in [Quality::Low, Quality::High] {
        for (order, far) in [(BlendOrder::Cut, FarPlants::Land), (BlendOrder::Weighted, FarPlants::Clumps)] {
            let name = || format!("{}, {}, {}", quality.name(), order.name(), far.name());
            let mut canvas = still.canvas(&gpu, quality);
            canvas.set_options(RenderOptions { blend_order: order, far_plants: far, ..RenderOptions::default() });
            still.draw(&mut canvas);
            let Some(first) = work(&gpu, &canvas)? else { return Ok(()) };
            check_passes(&first).with_context(name)?;
            still.draw(&mut canvas);
            let Some(second) = work(&gpu, &canvas)? else { return Ok(()) };
            check_resting(&second).with_context(name)?;
            // Negative control: a frame that draws its shadows.
            ensure_refused(check_resting(&first), "shadows are drawn twice").with_context(name)?;
            ensure_swapped_passes_are_refused(&first).with_context(name)?;
        }
    }
    Ok(())
}

/// Negative controls of [`check_passes`]: a pass that is left out, has work of another kind as well, or is drawn twice.
fn ensure_swapped_passes_are_refused(right: &PassStatistics) -> Result<()> {
    let nothing = PipelineStatistics::default();
    let also_computed = |pass: PipelineStatistics| PipelineStatistics { compute_invocations: right.bend.compute_invocations, ..pass };
    let PassStatistics { bend, tone, .. } = *right;
    let short = PipelineStatistics { fragments: pixels() - 1, ..tone };
    let doubled = PipelineStatistics { fragments: 2 * tone.fragments, ..tone };
    let wrong = [
        ("shadows", PassStatistics { shadows: nothing, ..*right }),
        ("shadows", PassStatistics { shadows: also_computed(right.shadows), ..*right }),
        ("bend", PassStatistics { bend: nothing, ..*right }),
        ("bend", PassStatistics { bend: PipelineStatistics { vertices: 3, ..bend }, ..*right }),
        ("picture", PassStatistics { picture: nothing, ..*right }),
        ("picture", PassStatistics { picture: PipelineStatistics { fragments: pixels(), ..right.picture }, ..*right }),
        ("picture", PassStatistics { picture: PipelineStatistics { triangles: 0, ..right.picture }, ..*right }),
        ("picture", PassStatistics { picture: also_computed(right.picture), ..*right }),
        ("tone", PassStatistics { tone: nothing, ..*right }),
        ("tone", PassStatistics { tone: PipelineStatistics { vertices: 6, ..tone }, ..*right }),
        ("tone", PassStatistics { tone: short, ..*right }),
        ("tone", PassStatistics { tone: doubled, ..*right }),
    ];
    wrong.iter().try_for_each(|(pass, work)| ensure_refused(check_passes(work), pass))
}

fn pixels() -> u64 {
    SIZE_PX.map(u64::from).iter().product()
}
