//! The detail of a running world: it follows its budget, says so, and a replay repeats it.

use crate::scene_menu::ask;
use crate::test_client::PlainClient;
use crate::test_server::{Server, within};
use prairie::detail::{Demands, WindDemand};
use prairie::journal::{Player, WorldFolder, find, open};
use prairie::net::bind;
use prairie::scenes::{self, Explanation, LoadedScene};
use prairie::{Config, run_and_reload};
use prairie_core::scene::VehicleKind;
use prairie_core::wire::{ClientMessage, Drive};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tokio::sync::oneshot;

/// A scene that demands an error of its wind and a time of its ticks, as a plan would have it.
fn demanding() -> LoadedScene {
    let wind = WindDemand { tolerance: 0.05, planned: 0.04, rms_m_per_s: 4.0 };
    let demands = Demands { wind: Some(wind), bend_deg: Some(1.0), planned_bend_deg: 0.8, server_ms: 1000.0, kbit_per_s: None };
    let mut scene = scenes::load("meadow").unwrap();
    scene.explanation = Arc::new(Explanation { demands: Some(demands), ..Explanation::clone(&scene.explanation) });
    scene
}

async fn start(scene: LoadedScene, folder: &Path, pages_change_scene: bool) -> Server {
    let listener = bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let (stop, stopped) = oneshot::channel();
    let world = Some(WorldFolder::new(folder.to_owned()));
    let config = Config { world, pages_change_scene, threads: Some(1), ..Config::new(scene) };
    let world = open(config.world.as_ref(), &config.scene).unwrap();
    Server { address, stop, outcome: tokio::spawn(run_and_reload(world, config, listener, async { drop(stopped.await) })) }
}

async fn set_budget(server: &Server, body: &str) -> (u16, Value) {
    ask(server, "POST /api/budget HTTP/1.1", body).await
}

/// The plan of the server, when `is_wanted` holds for what it says of the present.
async fn until(server: &Server, is_wanted: impl Fn(&Value) -> bool) -> Value {
    within(async {
        loop {
            let now = ask(server, "GET /api/plan HTTP/1.1", "").await.1["now"].take();
            if is_wanted(&now) {
                return now;
            }
            tokio::time::sleep(Duration::from_millis(50)).await;
        }
    })
    .await
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_budget_that_no_tick_keeps_makes_all_give_way_and_a_replay_repeats_it() {
    let folder = tempfile::tempdir().unwrap();
    let server = start(demanding(), folder.path(), true).await;
    let mut driver = PlainClient::join(&server, "Ada").await;
    driver.send_message(&ClientMessage::Choose { vehicle: Some(VehicleKind::Car) }).await;
    driver.frame().await;
    driver.send_message(&ClientMessage::Drive { number: 1, drive: Drive { throttle: 1.0, ..Drive::default() } }).await;
    let before = until(&server, |now| now["control"]["busy_ms"].as_f64() > Some(0.0)).await;
    assert_eq!((&before["level"], &before["gives_way"], &before["may_set_budget"]), (&json!(0), &json!([]), &json!(true)));
    assert_eq!(before["control"]["budget_ms"], 1000.0);

    assert_eq!(set_budget(&server, r#"{"server_ms": 0.001}"#).await.0, 200);
    // The fewest patches to which the awake ones are limited are more than are awake, so that the last level would change nothing.
    let loaded = until(&server, |now| now["level"] == 4).await;
    let given_up = [
        "the wind is stepped every 12 ticks instead of 3",
        "every other publication is left out",
        "all but 64 patches sleep, the farthest from all cameras",
    ];
    assert_eq!(loaded["gives_way"], json!(given_up));
    let decisions = loaded["decisions"].as_array().unwrap();
    let levels: Vec<_> = decisions.iter().filter_map(|decision| decision["level"].as_u64()).filter(|level| *level > 0).collect();
    assert_eq!(levels, [1, 2, 3, 4]);
    let reason = decisions.last().unwrap()["reason"].as_str().unwrap();
    assert!(reason.starts_with("overload: ") && reason.ends_with(" ms a tick, budget 0.001 ms"), "{reason}");
    // The step of the wind changes at the next tick that both steps have in common.
    let own_secs = before["wind_step_secs"].as_f64().unwrap();
    until(&server, |now| (now["wind_step_secs"].as_f64().unwrap() / own_secs - 4.0).abs() < 0.01).await;
    // Drives on in less detail; the budget comes back, and so does the detail, one by one.
    assert_eq!(set_budget(&server, r#"{"server_ms": 1000}"#).await.0, 200);
    until(&server, |now| now["level"] == 3).await;
    server.stop().await;

    let own = find(folder.path()).unwrap();
    let mut player = Player::open_oldest(&own, &demanding()).unwrap().expect("a recording");
    player.advance(u64::MAX);
    let replayed = player.world.snapshot();
    assert_eq!((replayed.diagnostics.load_level, replayed.decisions.len() as u64), (3, replayed.diagnostics.decisions));
    let mut resumed = open(Some(&WorldFolder::new(folder.path().to_owned())), &demanding()).unwrap();
    assert_eq!(resumed.world().tick(), player.world.tick());
    assert!(resumed.world().save().encode() == player.world.save().encode(), "the replay has the bits of the world that ran");
    prairie::runner::Simulation::step(&mut resumed, &[]);
}

/// Bytes to a viewer from its first frame on, and the time that they took (s).
async fn data_of_viewer(server: &Server) -> (usize, f64) {
    let mut viewer = PlainClient::join(server, "Ida").await;
    viewer.frame().await;
    let (before, start) = (viewer.replica.bytes, Instant::now());
    while start.elapsed() < Duration::from_secs(4) {
        viewer.frame().await;
    }
    (viewer.replica.bytes - before, start.elapsed().as_secs_f64())
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_viewer_gets_no_more_data_than_the_scene_allows() {
    let folder = tempfile::tempdir().unwrap();
    let free = start(demanding(), folder.path(), false).await;
    let (free_bytes, _) = data_of_viewer(&free).await;
    free.stop().await;
    let kbit_per_s = 16.0;
    let mut scene = demanding();
    let mut explanation = Explanation::clone(&scene.explanation);
    explanation.demands.as_mut().unwrap().kbit_per_s = Some(kbit_per_s);
    scene.explanation = Arc::new(explanation);
    let limited = start(scene, folder.path(), false).await;
    let (bytes, secs) = data_of_viewer(&limited).await;
    limited.stop().await;
    // A burst of a second, and the frame that overdraws.
    let allowed = 125.0 * f64::from(kbit_per_s) * (secs + 1.0) + 4096.0;
    assert!(bytes as f64 <= allowed && free_bytes as f64 > allowed, "{bytes} bytes, {free_bytes} without the limit; allowed {allowed}");
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn budgets_that_cannot_be_set_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let server = start(demanding(), folder.path(), true).await;
    for (body, status, error) in [
        ("{}", 400, "the body is not a JSON object with `server_ms`"),
        (r#"{"server_ms": 0}"#, 400, "`server_ms` is 0; allowed: 0.001 to 1000"),
        (r#"{"server_ms": 2000}"#, 400, "`server_ms` is 2000; allowed: 0.001 to 1000"),
        (r#"{"server_ms": 1, "more": 2}"#, 400, "the body is not a JSON object with `server_ms`"),
    ] {
        let (found, answer) = set_budget(&server, body).await;
        let text = answer["error"].as_str().unwrap();
        assert!(found == status && text.starts_with(error), "{body}: {found} {text}");
    }
    assert_eq!(set_budget(&server, &" ".repeat(5000)).await.0, 413);
    server.stop().await;

    let closed = start(demanding(), folder.path(), false).await;
    assert_eq!(set_budget(&closed, r#"{"server_ms": 1}"#).await.0, 403);
    let now = until(&closed, |_| true).await;
    assert_eq!(now["may_set_budget"], json!(false));
    closed.stop().await;

    let undemanding = start(scenes::load("blades").unwrap(), folder.path(), true).await;
    assert_eq!(set_budget(&undemanding, r#"{"server_ms": 1}"#).await.0, 409);
    assert_eq!(until(&undemanding, |_| true).await["control"], Value::Null);
    undemanding.stop().await;
}
