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
