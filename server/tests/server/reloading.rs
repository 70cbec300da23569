//! A scene file that is edited while it is served.

use crate::running::Server;
use crate::visitor::Plain;
use shared::terrain::grey_png;
use shared::wire::{ClientMessage, Close, ServerMessage};
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

/// Stiffness of the reeds that a new visitor is told.
async fn greeted(server: &Server) -> (Plain, f32) {
    let mut visitor = Plain::connect(server).await;
    visitor.say(&ClientMessage::Hello { name: "Ada".to_owned() }).await;
    loop {
        match visitor.hear().await.unwrap() {
            ServerMessage::Welcome { scene_name, .. } => assert_eq!(scene_name, "scene"),
            ServerMessage::Scene { scene, .. } => return (visitor, scene.underbrush[0].components[0].stiffness_n_m2),
            _ => {}
        }
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_species_that_is_edited_grows_in_a_new_world() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "scene.toml", SCENE);
    write(folder.path(), "land.png", grey_png([3; 2], &[255; 9]));
    write(folder.path(), "species.toml", species("2.0"));
    let server = Server::start_file(&folder.path().join("scene.toml")).await;
    let (mut visitor, stiffness_n_m2) = greeted(&server).await;
    assert_eq!(stiffness_n_m2, 2.0);

    write(folder.path(), "species.toml", species("-2.0"));
    let before = visitor.frame().await;
    // Longer than it takes to see and refuse the file.
    while visitor.frame().await < before + 90 {}
    write(folder.path(), "species.toml", species("0.5"));
    assert_eq!(visitor.closed().await.0, Close::Stopping.code());

    let (mut visitor, stiffness_n_m2) = greeted(&server).await;
    assert_eq!(stiffness_n_m2, 0.5);
    visitor.frame().await;
    server.stop().await;
}
