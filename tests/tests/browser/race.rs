//! A race of two pages: both drive a car through the gates by the page's own keys, both panels list both, and the fastest lap drives beside as a ghost.

use anyhow::{Context as _, Result, ensure};
use prairie::scenes::{self, LoadedScene};
use prairie::world::World;
use prairie_core::scene::{Race, RaceGate};
use serde_json::{Value, json};
use std::f32::consts::FRAC_PI_2;
use tests::browser::Browser;
use tests::prairie::Prairie;

/// Middle of the circuit (m), and distance of its two gates from it (m).
const MIDDLE_M: [f32; 2] = [27.0, 30.0];
const RADIUS_M: f32 = 8.0;
/// A lawn of 64 m with a circuit of two gates, driven to the east past the northern one and back past the southern one.
fn circuit() -> Result<LoadedScene> {
    let mut loaded = scenes::load("blades")?;
    let [x, z] = MIDDLE_M;
    let gate = |z: f32, heading_rad: f32| RaceGate { width_m: 12.0, ..RaceGate::new([x, z], heading_rad) };
    let gates = vec![gate(z - RADIUS_M, FRAC_PI_2), gate(z + RADIUS_M, -FRAC_PI_2)];
    loaded.scene.race = Race { laps: 2, light_period_secs: 0.0, gates };
    // Stones as small as pebbles stop nobody.
    loaded.scene.plants.stone_m = 0.05;
    (loaded.scene.objects.self_driving, loaded.scene.wind.sources, loaded.scene.wind.mean_m_per_s) = (0, 0, [0.0; 2]);
    Ok(loaded)
}

/// Opens a page whose car starts 9 m to the east of `eye_m`, heading east.
async fn driver(prairie: &Prairie, name: &str, [x, z]: [f32; 2]) -> Result<Browser> {
    let browser = prairie.visitor_at(&format!("?quality=low&panel=1&name={name}#{x},2,{z},90,-5")).await?;
    browser.evaluate("window.prairie.choose('car')").await?;
    browser.until("(s => s.vehicle === 'car' && s.position)(window.prairie.state())").await?;
    Ok(browser)
}

/// Holds the page's keys so that its car drives round the circuit in a lane this far outside the middles of the gates (m), at this speed (m/s).
///
/// A car that is beside or behind its next gate first drives to a point before it: a gate passed backwards does not count. Lanes keep the cars apart, so
/// that a page too slow to steer well, on a busy machine, still passes.
async fn drive(browser: &Browser, outside_m: f32, speed_m_per_s: f32) -> Result<()> {
    let [x, z] = MIDDLE_M;
    let gates = json!([[x, z - RADIUS_M - outside_m, 1], [x, z + RADIUS_M + outside_m, -1]]);
    let script = format!(
        "(() => {{
            const held = new Set(), gates = {gates};
            let [standing, backing] = [0, 0];
            const hold = (code, down) => {{
                // A key that is held repeats, in case that the page has lost the focus meanwhile.
                if (!down && !held.delete(code)) return;
                if (down) held.add(code);
                window.dispatchEvent(new KeyboardEvent(down ? 'keydown' : 'keyup', {{ code, key: code.slice(-1).toLowerCase() }}));
            }};
            setInterval(() => {{
                const {{ position, rotation, velocity, race }} = window.prairie.state();
                if (!position) return;
                const [x, z, east] = gates[race.standings.find(({{ me }}) => me)?.next_gate ?? 0];
                const ahead = east * (x - position[0]);
                const passes = ahead > 0 && Math.abs(z - position[2]) < Math.max(2, ahead);
                const aim = passes ? x + 2 * east : x - {RADIUS_M} * east;
                const off = Math.atan2(aim - position[0], position[2] - z) + 2 * Math.atan2(rotation[1], rotation[3]);
                const turn = Math.atan2(Math.sin(off), Math.cos(off));
                const speed = Math.hypot(velocity[0], velocity[2]);
                standing = speed < 0.2 ? standing + 1 : 0;
                // Against a post or another car: back for a while.
                if (standing > 100) [standing, backing] = [0, 60];
                backing -= backing > 0;
                hold('KeyA', turn < -0.1);
                hold('KeyD', turn > 0.1);
                hold('KeyS', backing > 0);
                hold('KeyW', backing === 0 && speed < {speed_m_per_s});
            }}, 20);
        }})()"
    );
    browser.evaluate(&script).await?;
    Ok(())
}

/// Names in the panel's standings.
async fn listed(browser: &Browser) -> Result<Vec<String>> {
    let names = "Array.from(document.querySelectorAll('#standings li b'), (item) => item.textContent).sort()";
    Ok(serde_json::from_value(browser.evaluate(names).await?)?)
}

/// Best lap (s) of a driver in a page's state.
fn best_secs(state: &Value, name: &str) -> Option<f64> {
    let standings = state["race"]["standings"].as_array()?;
    standings.iter().find(|standing| standing["name"] == name)?["best_secs"].as_f64()
}

/// Waits until an expression is true in both pages; an error says where the cars are.
async fn both_until(ada: &Browser, ben: &Browser, expression: &str) -> Result<()> {
    let Err(error) = tokio::try_join!(ada.until(expression), ben.until(expression)) else { return Ok(()) };
    let motion = "(({ position, rotation, velocity, race }) => ({ position, rotation, velocity, race }))(window.prairie.state())";
    let [one, other] = [ada.evaluate(motion).await?, ben.evaluate(motion).await?];
    Err(error.context(format!("Ada: {one}\nBen: {other}")))
}

#[tokio::test(flavor = "multi_thread")]
async fn two_pages_race_and_the_fastest_lap_drives_beside_as_a_ghost() -> Result<()> {
    let loaded = circuit()?;
    let world = World::new(&loaded.scene, loaded.maps())?;
    let prairie = Prairie::serve(loaded, world).await?;
    let start_m = [MIDDLE_M[0] - 17.0, MIDDLE_M[1] - RADIUS_M];
    let (ada, ben) = tokio::try_join!(driver(&prairie, "Ada", start_m), driver(&prairie, "Ben", [start_m[0] - 8.0, start_m[1]]))?;
    let ghost = "window.prairie.state().race.ghost";
    ensure!(ada.evaluate(ghost).await? == Value::Null, "nobody has completed a lap");
    tokio::try_join!(drive(&ada, 1.5, 5.0), drive(&ben, -1.5, 3.5))?;

    // Both begin a lap, and Ada completes one.
    let begun = "window.prairie.state().race.standings.length === 2";
    both_until(&ada, &ben, begun).await?;
    let lapped = "window.prairie.state().race.standings.some(({ name, best_secs }) => name === 'Ada' && best_secs !== null)";
    both_until(&ada, &ben, lapped).await?;
    ada.until(&format!("{ghost} !== null")).await?;
    let at_m = ada.evaluate(ghost).await?;
    let from_middle_m = |axis: usize, middle_m: f32| at_m[axis].as_f64().map(|m| m - f64::from(middle_m));
    let (x_m, z_m) = (from_middle_m(0, MIDDLE_M[0]).context("a place")?, from_middle_m(2, MIDDLE_M[1]).context("a place")?);
    ensure!(x_m.hypot(z_m) < 2.0 * f64::from(RADIUS_M), "the ghost is {x_m} m east and {z_m} m south of the middle");

    let (one, other) = tokio::try_join!(ada.state(), ben.state())?;
    let best = [best_secs(&one, "Ada"), best_secs(&other, "Ada")];
    ensure!(best[0].is_some_and(|secs| (2.0..60.0).contains(&secs)) && best[0] == best[1], "the best laps are {best:?}");
    for (browser, names) in [(&ada, ["Ada (you)", "Ben"]), (&ben, ["Ada", "Ben (you)"])] {
        browser.until("document.querySelectorAll('#standings li').length === 2").await?;
        ensure!(listed(browser).await? == names, "the panel lists {:?}", listed(browser).await?);
    }
    Ok(())
}
