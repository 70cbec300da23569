//! Server and client grow the same underbrush from a scene sent over the wire; plants are not streamed.

use anyhow::{Context as _, Result};
use png::{BitDepth, ColorType};
use prairie::scenes::{self, LoadedScene};
use prairie::studio::Stage;
use prairie_core::plant::flora::Flora;
use prairie_core::terrain::grey_png;
use std::path::Path;
use tests::maps;

/// Checks that server and client grow identical plants; returns their number and checksum.
fn same_plants(name_or_path: &str) -> Result<(usize, u64)> {
    let stage = Stage::load(name_or_path)?;
    let mirrored = stage.mirror.decoded_scene().and_then(|land| land.flora());
    let (server, client) = (stage.world.flora().context("the server grows nothing")?, mirrored.context("the client grows nothing")?);
    assert_eq!(server.grown().plants(), client.grown().plants(), "{name_or_path}");
    assert_eq!(server.checksum(), client.checksum(), "{name_or_path}");
    assert!(server == client, "{name_or_path}: soil, species or postures differ");
    Ok((server.grown().plants().len(), server.checksum()))
}

#[test]
fn plants_of_built_in_scenes_are_the_same_on_both_sides() -> Result<()> {
    for name in ["meadow", "underbrush"] {
        let (plants, _) = same_plants(name)?;
        assert!(plants > 10_000, "{name}: {plants} plants");
    }
    Ok(())
}

/// A scene with the built-in species and a nutrient map that is richer towards the east.
fn drawn_soil(folder: &Path, brightest: u8) -> Result<String> {
    let text = "summary = 's'\nunderbrush_file = 'species.toml'\npatches = { count = [8, 8] }\n[terrain]\nheight_map = 'h.png'\n\
        covering_map = 'c.png'\npixel_m = [2, 2]\nlevel_m = 0.1\n[growth]\nnutrient_map = 'n.png'\n";
    let soil: Vec<u8> = (0..16 * 16).flat_map(|pixel| [brightest / 16 * (pixel % 16) as u8, 200, 255 - pixel as u8]).collect();
    let path = folder.join("s.toml");
    std::fs::write(&path, text)?;
    std::fs::write(folder.join("species.toml"), include_str!("../../../server/scenes/species.toml"))?;
    std::fs::write(folder.join("h.png"), grey_png([65; 2], &[0; 65 * 65]))?;
    std::fs::write(folder.join("c.png"), grey_png([4; 2], &[255; 16]))?;
    std::fs::write(folder.join("n.png"), maps::png(ColorType::Rgb, BitDepth::Eight, [16, 16], &soil))?;
    path.to_str().map(str::to_owned).context("the path is text")
}

#[test]
fn plants_on_drawn_soil_are_the_same_on_both_sides() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let path = drawn_soil(folder.path(), 240)?;
    let (plants, checksum) = same_plants(&path)?;
    assert!(plants > 1000, "{plants} plants");

    // The map matters: another map gives other plants, and so does none.
    let other = same_plants(&drawn_soil(folder.path(), 160)?)?;
    let LoadedScene { scene, cover, .. } = scenes::load(&path)?;
    let generated = Flora::new(&scene, &cover, None).context("a scene with underbrush")?;
    assert!(checksum != other.1 && checksum != generated.checksum());
    Ok(())
}
