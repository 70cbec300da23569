//! Hot reload of a scene file.

use crate::test_client::PlainClient;
use crate::test_server::Server;
use prairie_core::terrain::grey_png;
use prairie_core::wire::{ClientMessage, Close, ServerMessage};
use std::path::Path;

const SCENE: &str = "summary = 'a test'\nunderbrush_file = 'species.toml'\npatches = { count = [2, 2], cells = 8, cell_m = 1.0 }\n\
    [terrain]\nheight_map = 'land.png'\ncovering_map = 'land.png'\npixel_m = [8, 8]\nlevel_m = 0.1\n[wind]\ncells = [8, 4, 8]\n";

fn species(stiffness_n_m2: &str) -> String {
    format!(
        "[[underbrush]]\nname = 'reed'\n[[underbrush.components]]\nname = 'stalk'\nkind = 'branch'\nlength_m = 1.0\nmass_kg = 0.01\n\
         stiffness_n_m2 = {stiffness_n_m2}\n"
    )
}

/// A model of one triangle, whose positions are those of an accessor.
fn model(accessor: u32) -> String {
    format!(
        r#"{{ "asset": {{ "version": "2.0" }}, "scenes": [{{ "nodes": [0] }}], "nodes": [{{ "mesh": 0 }}],
        "meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": {accessor} }} }}] }}],
        "buffers": [{{ "byteLength": 36, "uri": "data:;base64,{}" }}], "bufferViews": [{{ "buffer": 0, "byteLength": 36 }}],
        "accessors": [{{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [0, 0, 0] }}] }}"#,
        "AAAA".repeat(12)
    )
}

fn write(folder: &Path, name: &str, bytes: impl AsRef<[u8]>) {
    std::fs::write(folder.join(name), bytes).unwrap();
}

/// Joins as a new client; returns the stiffness of the reeds in the scene message.
async fn join(server: &Server) -> (PlainClient, f32) {
    let mut client = PlainClient::connect(server).await;
    client.send_message(&ClientMessage::Hello { name: "Ada".to_owned() }).await;
    loop {
        match client.receive().await.unwrap() {
            ServerMessage::Welcome { scene_name, .. } => assert_eq!(scene_name, "scene"),
            ServerMessage::Scene { scene, .. } => return (client, scene.underbrush[0].components[0].stiffness_n_m2),
            _ => {}
        }
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn an_edited_species_grows_in_a_new_world() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "scene.toml", SCENE);
    write(folder.path(), "land.png", grey_png([3; 2], &[255; 9]));
    write(folder.path(), "species.toml", species("2.0"));
    let server = Server::start_file(&folder.path().join("scene.toml")).await;
    let (mut client, stiffness_n_m2) = join(&server).await;
    assert_eq!(stiffness_n_m2, 2.0);

    write(folder.path(), "species.toml", species("-2.0"));
    let before = client.frame().await;
    // Longer than the server takes to detect and reject the file.
    while client.frame().await < before + 90 {}
    write(folder.path(), "species.toml", species("0.5"));
    assert_eq!(client.closed().await.0, Close::Stopping.code());

    let (mut client, stiffness_n_m2) = join(&server).await;
    assert_eq!(stiffness_n_m2, 0.5);
    client.frame().await;
    server.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_broken_model_leaves_the_old_world_running() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "scene.toml", format!("{SCENE}[objects]\ncar_model = 'car.gltf'\n"));
    write(folder.path(), "land.png", grey_png([3; 2], &[255; 9]));
    write(folder.path(), "species.toml", species("2.0"));
    write(folder.path(), "car.gltf", model(0));
    let server = Server::start_file(&folder.path().join("scene.toml")).await;
    let (mut client, _) = join(&server).await;

    write(folder.path(), "car.gltf", model(7));
    let before = client.frame().await;
    // Longer than the server takes to detect and reject the file.
    while client.frame().await < before + 90 {}
    write(folder.path(), "species.toml", species("0.5"));
    write(folder.path(), "car.gltf", model(0));
    assert_eq!(client.closed().await.0, Close::Stopping.code());
    let (_, stiffness_n_m2) = join(&server).await;
    assert_eq!(stiffness_n_m2, 0.5);
    server.stop().await;
}
