//! What visitors see of one another.

use crate::running::Server;
use crate::small_world::{Meadow, OBJECT_LIMIT};
use crate::visitor::Plain;
use server::{Limits, scenes};
use shared::grid::PatchLayout;
use shared::scene::VehicleKind;
use shared::wire::quantise::theta_code;
use shared::wire::{ClientMessage, Drive, Refusal, ServerMessage};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// What a visitor sees at each of the next `frames` frames, by step.
async fn watch(visitor: &mut Plain, frames: usize) -> BTreeMap<u64, impl PartialEq + std::fmt::Debug + use<>> {
    let mut seen = BTreeMap::new();
    while seen.len() < frames {
        let tick = visitor.frame().await;
        let codes: Vec<_> = visitor.picture.patches.values().map(|(_, codes)| codes.clone()).collect();
        seen.insert(tick, (codes, visitor.picture.wind.1.clone(), visitor.objects.clone()));
    }
    seen
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn two_visitors_see_the_same_world() {
    let server = Server::start(Limits::default()).await;
    let mut ada = Plain::join(&server, "Ada").await;
    let mut bob = Plain::join(&server, " Bob\u{7}").await;
    ada.say(&ClientMessage::Choose { vehicle: Some(VehicleKind::Car) }).await;
    ada.say(&ClientMessage::Drive(Drive { throttle: 1.0, ..Drive::default() })).await;
    let object = Some(100 + ada.client);
    let roster = vec![(ada.client, "Ada".to_owned(), object), (bob.client, "Bob".to_owned(), None)];
    for visitor in [&mut ada, &mut bob] {
        visitor.frames_until(|v| v.peers == roster && v.objects.iter().any(|o| Some(o.id) == object && o.position_m[2] < 0.0)).await;
    }
    let (seen_by_ada, seen_by_bob) = tokio::join!(watch(&mut ada, 40), watch(&mut bob, 40));
    let common: Vec<_> = seen_by_ada.keys().filter(|tick| seen_by_bob.contains_key(tick)).collect();
    assert!(common.len() >= 10, "only {} steps were shown to both", common.len());
    for tick in common {
        assert_eq!(seen_by_ada[tick], seen_by_bob[tick], "at step {tick}");
    }
    ada.say(&ClientMessage::Choose { vehicle: None }).await;
    bob.frames_until(|bob| bob.objects.is_empty()).await;
    drop(ada);
    bob.frames_until(|bob| bob.peers.len() == 1).await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_new_name_changes_nothing_else() {
    let server = Server::start(Limits::default()).await;
    let (mut ada, mut bob) = (Plain::join(&server, "Ada").await, Plain::join(&server, "Bob").await);
    ada.say(&ClientMessage::Choose { vehicle: Some(VehicleKind::Monster) }).await;
    let object = Some(100 + ada.client);
    for (said, shown) in [(" Countess\u{7} ", "Countess".to_owned()), ("\n", format!("visitor {}", ada.client))] {
        ada.say(&ClientMessage::Rename { name: said.to_owned() }).await;
        let peer = (ada.client, shown, object);
        tokio::join!(ada.frames_until(|ada| ada.peers.contains(&peer)), bob.frames_until(|bob| bob.peers.contains(&peer)));
    }
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_vehicle_appears_below_the_camera_told_of_just_before() {
    let server = Server::start_meadow().await;
    let mut visitor = Plain::join(&server, "visitor").await;
    let eye_m = [40.0, 5.0, 216.0];
    visitor.say(&ClientMessage::View { eye_m, radius_m: 32.0 }).await;
    visitor.say(&ClientMessage::Choose { vehicle: Some(VehicleKind::Monster) }).await;
    visitor.frames_until(|visitor| !visitor.objects.is_empty()).await;
    let [x, _, z] = visitor.objects[0].position_m;
    assert!((x - eye_m[0]).hypot(z - eye_m[2]) < 40.0, "at {x}, {z}");
    server.stop().await;
}

/// More input than a world that lags takes in: the newest is not lost.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_last_word_of_a_driver_is_heard_however_late_the_world_is() {
    let halted = Arc::new(AtomicBool::new(false));
    let limits = Limits { messages_per_sec: 1e6, ..Limits::default() };
    let (server, _) = Server::start_with(Meadow::halting(halted.clone()), limits, None).await;
    let mut driver = Plain::join(&server, "driver").await;
    driver.say(&ClientMessage::Choose { vehicle: Some(VehicleKind::Car) }).await;
    driver.frames_until(|driver| !driver.objects.is_empty()).await;
    halted.store(true, Relaxed);
    for _ in 0..5000 {
        driver.say(&ClientMessage::Drive(Drive::default())).await;
    }
    driver.say(&ClientMessage::Drive(Drive { throttle: 1.0, ..Drive::default() })).await;
    driver.say(&ClientMessage::Ping { nonce: 1 }).await;
    while driver.hear().await != Ok(ServerMessage::Pong { nonce: 1 }) {}
    halted.store(false, Relaxed);
    driver.frames_until(|driver| driver.objects[0].position_m[2] < 0.0).await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_track_of_a_car_shows_at_another_visitor() {
    let server = Server::start_meadow().await;
    let layout = PatchLayout::from(&scenes::load("meadow").unwrap().scene.patches);
    let (mut driver, mut watcher) = (Plain::join(&server, "driver").await, Plain::join(&server, "watcher").await);
    driver.say(&ClientMessage::Choose { vehicle: Some(VehicleKind::Car) }).await;
    driver.say(&ClientMessage::Drive(Drive { throttle: 0.5, ..Drive::default() })).await;
    watcher.frames_until(|watcher| !watcher.objects.is_empty()).await;
    let start = watcher.objects[0].position_m;
    watcher.say(&ClientMessage::View { eye_m: start, radius_m: 64.0 }).await;
    let patch = layout.patch_at(start[0], start[2]).expect("a car stands in the world");
    let bent = |visitor: &Plain| {
        let (_, codes) = visitor.picture.patches.get(&patch)?;
        codes[..visitor.picture.patch_cells.pow(2)].iter().max().copied()
    };
    let pressed = theta_code(1.0);
    tokio::join!(driver.frames_until(|driver| driver.picture.frame > 40), watcher.frames_until(|watcher| bent(watcher) >= Some(pressed)));
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_refused_vehicle_leaves_the_connection() {
    let server = Server::start(Limits::default()).await;
    let mut drivers = Vec::new();
    for _ in 0..OBJECT_LIMIT {
        let mut driver = Plain::join(&server, "driver").await;
        driver.say(&ClientMessage::Choose { vehicle: Some(VehicleKind::Monster) }).await;
        driver.frames_until(|driver| driver.objects.iter().any(|object| object.id == 100 + driver.client)).await;
        drivers.push(driver);
    }
    let mut late = Plain::join(&server, "late").await;
    late.say(&ClientMessage::Choose { vehicle: Some(VehicleKind::Car) }).await;
    late.frames_until(|late| late.refusals == [Refusal::ObjectLimit]).await;
    assert_eq!(
        late.reasons,
        [format!("there are {OBJECT_LIMIT} objects, and the scene allows {OBJECT_LIMIT}; wait until somebody gives a vehicle up")]
    );
    late.say(&ClientMessage::Ping { nonce: 7 }).await;
    while late.hear().await != Ok(ServerMessage::Pong { nonce: 7 }) {}
    server.stop().await;
}
