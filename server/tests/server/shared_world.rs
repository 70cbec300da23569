//! Clients share one world: vehicles, names, tracks.

use crate::stand_in::{OBJECT_LIMIT, StandInWorld};
use crate::test_client::PlainClient;
use crate::test_server::Server;
use prairie::{Limits, scenes};
use prairie_core::grid::PatchLayout;
use prairie_core::scene::VehicleKind;
use prairie_core::wire::quantise::CodeSteps;
use prairie_core::wire::{ClientMessage, Drive, Refusal, ServerMessage};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};

/// State of a client after each of the next `frames` frames, by step.
async fn watch(client: &mut PlainClient, frames: usize) -> BTreeMap<u64, impl PartialEq + std::fmt::Debug + use<>> {
    let mut seen = BTreeMap::new();
    while seen.len() < frames {
        let tick = client.frame().await;
        let codes: Vec<_> = client.replica.patches.values().map(|(_, codes)| codes.clone()).collect();
        seen.insert(tick, (codes, client.replica.wind.1.clone(), client.objects.clone()));
    }
    seen
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn two_clients_see_the_same_world() {
    let server = Server::start(Limits::default()).await;
    let mut ada = PlainClient::join(&server, "Ada").await;
    let mut bob = PlainClient::join(&server, " Bob\u{7}").await;
    ada.send_message(&ClientMessage::Choose { vehicle: Some(VehicleKind::Car) }).await;
    ada.send_message(&ClientMessage::Drive { number: 1, drive: Drive { throttle: 1.0, ..Drive::default() } }).await;
    let object = Some(100 + ada.id);
    let roster = vec![(ada.id, "Ada".to_owned(), object), (bob.id, "Bob".to_owned(), None)];
    for client in [&mut ada, &mut bob] {
        client.frames_until(|v| v.peers == roster && v.objects.iter().any(|o| Some(o.id) == object && o.position_m[2] < 0.0)).await;
    }
    let (seen_by_ada, seen_by_bob) = tokio::join!(watch(&mut ada, 40), watch(&mut bob, 40));
    let common: Vec<_> = seen_by_ada.keys().filter(|tick| seen_by_bob.contains_key(tick)).collect();
    assert!(common.len() >= 10, "only {} steps reached both", common.len());
    for tick in common {
        assert_eq!(seen_by_ada[tick], seen_by_bob[tick], "at step {tick}");
    }
    ada.send_message(&ClientMessage::Choose { vehicle: None }).await;
    bob.frames_until(|bob| bob.objects.is_empty()).await;
    drop(ada);
    bob.frames_until(|bob| bob.peers.len() == 1).await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn renaming_changes_only_the_name() {
    let server = Server::start(Limits { renames_per_s: 100.0, ..Limits::default() }).await;
    let (mut ada, mut bob) = (PlainClient::join(&server, "Ada").await, PlainClient::join(&server, "Bob").await);
    ada.send_message(&ClientMessage::Choose { vehicle: Some(VehicleKind::Monster) }).await;
    let object = Some(100 + ada.id);
    for (said, shown) in [(" Countess\u{7} ", "Countess".to_owned()), ("\n", format!("guest {}", ada.id))] {
        ada.send_message(&ClientMessage::Rename { name: said.to_owned() }).await;
        let peer = (ada.id, shown, object);
        tokio::join!(ada.frames_until(|ada| ada.peers.contains(&peer)), bob.frames_until(|bob| bob.peers.contains(&peer)));
    }
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_vehicle_appears_below_the_latest_camera() {
    let server = Server::start_meadow().await;
    let mut client = PlainClient::join(&server, "client").await;
    let eye_m = [40.0, 5.0, 216.0];
    client.send_message(&ClientMessage::View { eye_m, radius_m: 32.0 }).await;
    client.send_message(&ClientMessage::Choose { vehicle: Some(VehicleKind::Monster) }).await;
    client.frames_until(|client| !client.objects.is_empty()).await;
    let [x, _, z] = client.objects[0].position_m;
    assert!((x - eye_m[0]).hypot(z - eye_m[2]) < 40.0, "at {x}, {z}");
    server.stop().await;
}

/// A lagging world gets more input than it can take; the newest input must not be lost.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_newest_input_reaches_a_lagging_world() {
    let halted = Arc::new(AtomicBool::new(false));
    let limits = Limits { messages_per_s: 1e6, bytes_per_s: 1e9, ..Limits::default() };
    let (server, _) = Server::start_with(StandInWorld::halting(halted.clone()), limits, None).await;
    let mut driver = PlainClient::join(&server, "driver").await;
    driver.send_message(&ClientMessage::Choose { vehicle: Some(VehicleKind::Car) }).await;
    driver.frames_until(|driver| !driver.objects.is_empty()).await;
    halted.store(true, Relaxed);
    for _ in 0..5000 {
        driver.send_message(&ClientMessage::Drive { number: 1, drive: Drive::default() }).await;
    }
    driver.send_message(&ClientMessage::Drive { number: 1, drive: Drive { throttle: 1.0, ..Drive::default() } }).await;
    driver.send_message(&ClientMessage::Ping { nonce: 1 }).await;
    while driver.receive().await != Ok(ServerMessage::Pong { nonce: 1 }) {}
    halted.store(false, Relaxed);
    driver.frames_until(|driver| driver.objects[0].position_m[2] < 0.0).await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn another_client_sees_the_track_of_a_car() {
    let server = Server::start_meadow().await;
    let layout = PatchLayout::from(&scenes::load("meadow").unwrap().scene.patches);
    let (mut driver, mut watcher) = (PlainClient::join(&server, "driver").await, PlainClient::join(&server, "watcher").await);
    driver.send_message(&ClientMessage::Choose { vehicle: Some(VehicleKind::Car) }).await;
    driver.send_message(&ClientMessage::Drive { number: 1, drive: Drive { throttle: 0.5, ..Drive::default() } }).await;
    watcher.frames_until(|watcher| !watcher.objects.is_empty()).await;
    let start = watcher.objects[0].position_m;
    watcher.send_message(&ClientMessage::View { eye_m: start, radius_m: 64.0 }).await;
    let patch = layout.patch_at(start[0], start[2]).expect("the car is within the world");
    let bent = |client: &PlainClient| {
        let (_, codes) = client.replica.patches.get(&patch)?;
        codes[..client.replica.patch_cells.pow(2)].iter().max().copied()
    };
    let pressed = CodeSteps::default().theta_code(1.0);
    tokio::join!(driver.frames_until(|driver| driver.replica.frame > 40), watcher.frames_until(|watcher| bent(watcher) >= Some(pressed)));
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_refused_vehicle_keeps_the_connection() {
    let server = Server::start(Limits::default()).await;
    let mut drivers = Vec::new();
    for _ in 0..OBJECT_LIMIT {
        let mut driver = PlainClient::join(&server, "driver").await;
        driver.send_message(&ClientMessage::Choose { vehicle: Some(VehicleKind::Monster) }).await;
        driver.frames_until(|driver| driver.objects.iter().any(|object| object.id == 100 + driver.id)).await;
        drivers.push(driver);
    }
    let mut late = PlainClient::join(&server, "late").await;
    late.send_message(&ClientMessage::Choose { vehicle: Some(VehicleKind::Car) }).await;
    late.frames_until(|late| late.refusals == [Refusal::ObjectLimit]).await;
    assert_eq!(
        late.reasons,
        [format!("the scene has {OBJECT_LIMIT} objects and allows {OBJECT_LIMIT}; wait until another client gives up a vehicle")]
    );
    late.send_message(&ClientMessage::Ping { nonce: 7 }).await;
    while late.receive().await != Ok(ServerMessage::Pong { nonce: 7 }) {}
    server.stop().await;
}
