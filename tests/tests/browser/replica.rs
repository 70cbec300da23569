//! The page simulates the grass itself, in wasm, and the server's checksums find no difference.

use anyhow::{Context as _, Result, ensure};
use prairie::Limits;
use prairie::journal::{self, WorldFolder};
use prairie::scenes;
use prairie::world::World;
use std::time::Duration;
use tests::browser::Browser;
use tests::prairie::Prairie;
use tests::slow_line::line;
use tokio::time::sleep;

/// Simulated time for which the page is watched (s): every patch is checked once in each second. `PRAIRIE_REPLICA_SECS=167` watches 10 000 steps, and stays below
/// the time limit of a test.
fn watched_secs() -> Result<f64> {
    std::env::var("PRAIRIE_REPLICA_SECS").map_or(Ok(12.0), |secs| secs.parse().context("PRAIRIE_REPLICA_SECS is a number of seconds"))
}

#[tokio::test(flavor = "multi_thread")]
async fn the_page_has_a_replica_without_a_difference() -> Result<()> {
    let mut meadow = scenes::load("meadow")?;
    meadow.scene.underbrush.clear();
    (meadow.scene.objects.self_driving, meadow.scene.objects.balls) = (3, 3);
    let world = World::new(&meadow.scene, meadow.maps())?;
    let prairie = Prairie::serve(meadow, world).await?;
    let browser = prairie.visitor_at("?quality=low&panel=1#128,6,140,20,-8").await?;
    let watched_secs = watched_secs()?;
    let (mut began_secs, mut steps) = (None, [0.0; 2]);
    for _ in 0..(2.0 * watched_secs) as usize + 96 {
        sleep(Duration::from_millis(500)).await;
        let state = browser.state().await?;
        let time_secs = state["time_secs"].as_f64().context("a time")?;
        match (state["replica"].as_bool(), began_secs) {
            (Some(true), None) => (began_secs, steps[0]) = (Some(time_secs), state["tick"].as_f64().context("a step")?),
            (Some(true), Some(began)) if time_secs - began > watched_secs => break,
            // A machine that draws in software may fall behind and take patches for a while; it must not differ.
            _ => {}
        }
    }
    let state = browser.state().await?;
    let metrics = browser.evaluate("(async () => (await fetch('/metrics')).text())()").await?;
    let metrics = metrics.as_str().context("the metrics are text")?;
    let metric = |name: &str| metrics.lines().find(|line| line.starts_with(name)).map(str::to_owned).with_context(|| name.to_owned());
    steps[1] = state["tick"].as_f64().context("a step")?;
    println!(
        "{} steps, replica: {} %, {}",
        steps[1] - steps[0],
        100.0 * state["replica_share"].as_f64().unwrap_or_default(),
        metric("prairie_replicas ")?
    );
    ensure!(began_secs.is_some(), "the page had no replica within a minute: {state}");
    ensure!(metric("prairie_replica_differences_total ")? == "prairie_replica_differences_total 0", "the replica differed");
    let shown = browser.evaluate("document.getElementById('grass').textContent").await?;
    ensure!(shown.as_str().is_some_and(|text| text.starts_with("simulated here") || text == "from the server"), "the panel shows {shown}");
    Ok(())
}

/// Steps of [`pages_have_the_bits_of_the_server_for_ten_thousand_steps`].
const STEPS: u64 = 10_000;

/// A stall of 1 s in every 10 s: the server drops the frames that it would have sent meanwhile.
fn stalls(since: Duration) -> Duration {
    let phase_secs = since.as_secs_f64() % 10.0;
    Duration::from_secs_f64((1.0 - phase_secs).max(0.0))
}

/// Largest difference of the bend between the page and the server at the same step, at 4096 places 4 m apart (rad); `None` when no frame of the page was one that the
/// server answered for.
const DIFFERENCE: &str = "(async () => {
    const at_m = [];
    for (let x = 2; x < 256; x += 4) for (let z = 2; z < 256; z += 4) at_m.push([x, z]);
    for (let attempt = 0; attempt < 20; attempt++) {
        const answer = await (await fetch('/api/bend', { method: 'POST', body: JSON.stringify({ at_m }) })).json();
        if (window.prairie.state().tick !== answer.tick) continue;
        const apart = ([x, z], n) => { const found = window.prairie.bend(x, z), wanted = answer.bend_rad[n]; return Math.hypot(found[0] - wanted[0], found[1] - wanted[1]) };
        return Math.max(...at_m.map(apart));
    }
    return null;
})()";

/// Lets a page believe that its replica is slow while `window.slow` is true: each look at the clock then takes 5 ms.
const SLOW_CLOCK: &str = "(() => {
    const now = performance.now.bind(performance);
    let late_ms = 0;
    performance.now = () => now() + (window.slow ? late_ms += 5 : late_ms);
})()";

/// What was seen of the pages.
#[derive(Debug, Default)]
struct Seen {
    /// Looks at a page, and those at which it had a replica.
    looks: u32,
    replicas: u32,
    /// Comparisons with the server at the same step, and the largest difference in them (rad).
    compared: u32,
    apart_rad: f64,
}

impl Seen {
    /// Looks at a page, and waits.
    async fn look(&mut self, browser: &Browser) -> Result<()> {
        sleep(Duration::from_millis(500)).await;
        let state = browser.state().await?;
        self.looks += 1;
        self.replicas += u32::from(state["replica"] == true);
        if let (true, Some(apart_rad)) = (state["replica"] == true, browser.evaluate(DIFFERENCE).await?.as_f64()) {
            self.compared += 1;
            self.apart_rad = self.apart_rad.max(apart_rad);
        }
        Ok(())
    }
}

/// The value of a metric without labels.
async fn metric(browser: &Browser, name: &str) -> Result<f64> {
    let script = format!(
        "(async () => Number((await (await fetch('/metrics')).text()).split('\\n').find((line) => line.startsWith('{name} ')).split(' ')[1]))()"
    );
    browser.evaluate(&script).await?.as_f64().with_context(|| name.to_owned())
}

#[tokio::test(flavor = "multi_thread")]
#[ignore = "three minutes: cargo nextest run --release -p tests --test browser --run-ignored only ten_thousand_steps --no-capture"]
async fn pages_have_the_bits_of_the_server_for_ten_thousand_steps() -> Result<()> {
    let mut meadow = scenes::load("meadow")?;
    meadow.scene.underbrush.clear();
    // Two pages and the server share the cores of the machine.
    (meadow.scene.objects.self_driving, meadow.scene.objects.balls) = (1, 0);
    let kept = tempfile::tempdir()?;
    let open = || journal::open(Some(&WorldFolder::new(kept.path().to_owned())), &meadow);
    let mut prairie = Prairie::serve(meadow.clone(), open()?).await?;
    let server_addr = prairie.addr;
    let line_addr = line(server_addr, stalls).await?;
    let page = || async move { Browser::open(&format!("http://{line_addr}/?paused=1&quality=low&panel=0#128,6,140,20,-8")).await };
    let has_replica = "window.prairie?.state()?.connected && window.prairie.state().replica";
    let first = page().await?;
    first.until(has_replica).await?;
    let (mut late, mut seen, mut differences) = (None, [Seen::default(), Seen::default()], 0.0);
    let (mut slow_from, mut slow_until, mut is_restarted) = (None, None, false);
    loop {
        let tick = first.state().await?["tick"].as_u64().context("a step")?;
        if tick >= STEPS {
            break;
        }
        seen[0].look(&first).await?;
        let Some(late) = &late else {
            if tick > STEPS / 5 {
                let browser = page().await?;
                browser.until(has_replica).await?;
                browser.evaluate(SLOW_CLOCK).await?;
                late = Some(browser);
            }
            continue;
        };
        seen[1].look(late).await?;
        // Too slow for a replica, until it takes patches; it tries again by itself after 30 s.
        match (slow_from, slow_until) {
            (None, _) if tick > STEPS * 2 / 5 => {
                late.evaluate("window.slow = true").await?;
                late.until("!window.prairie.state().replica").await?;
                late.evaluate("window.slow = false").await?;
                slow_from = Some(tick);
            }
            (Some(_), None) if late.state().await?["replica"] == true => slow_until = Some(tick),
            _ => {}
        }
        if !is_restarted && tick > STEPS * 7 / 10 {
            is_restarted = true;
            differences += metric(&first, "prairie_replica_differences_total").await?;
            prairie.stop().await?;
            let world = open()?;
            let resumed = world.world().tick();
            ensure!(resumed >= tick, "the world goes on at step {resumed} instead of {tick}");
            prairie = Prairie::serve_at(server_addr, meadow.clone(), world, Limits::default()).await?;
            for browser in [&first, late] {
                browser.until(&format!("{has_replica} && window.prairie.state().tick > {resumed}")).await?;
            }
        }
    }
    differences += metric(&first, "prairie_replica_differences_total").await?;
    println!("{seen:?}; patches from step {slow_from:?} to {slow_until:?}; {differences} differences");
    ensure!(differences == 0.0, "a replica differed {differences} times");
    ensure!(is_restarted && slow_from.is_some() && slow_until.is_some(), "the page fell back and returned, and the server restarted");
    for Seen { looks, replicas, compared, apart_rad } in seen {
        ensure!(2 * replicas > looks && compared > 10, "a replica at {replicas} of {looks} looks, {compared} comparisons");
        // Codes of flattened grass are renewed at times that depend on when a replica began.
        ensure!(apart_rad <= f64::from(2.0 * meadow.scene.stream.theta_error_deg.to_radians()), "{apart_rad} rad apart");
    }
    Ok(())
}
