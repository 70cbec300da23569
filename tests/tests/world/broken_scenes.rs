//! Every broken scene is reported with all its errors and their positions.

use png::{BitDepth, ColorType};
use prairie::scenes::{SceneError, check, load};
use prairie_core::terrain::grey_png;
use std::path::Path;
use tests::maps;

const BROKEN: [&str; 47] = [
    "accuracy",
    "unknown-field",
    "syntax",
    "out-of-range",
    "no-world",
    "wrong-maps",
    "unreadable-model",
    "endless-model",
    "wind-out-of-range",
    "wind-faces",
    "wind-through-faces",
    "wind-patch",
    "wind-follow",
    "wind-obstacle",
    "wind-endless",
    "wind-time",
    "wind-reflection",
    "wind-stable-fluids",
    "wind-primitives",
    "wind-one-primitive",
    "wind-intensity",
    "species",
    "species-hole",
    "underbrush",
    "underbrush-misfits",
    "underbrush-nameless",
    "underbrush-file",
    "underbrush-twice",
    "underbrush-hole",
    "no-underbrush-file",
    "no-nutrients",
    "objects",
    "sled-outline",
    "sled-without-footprint",
    "sled-of-no-area",
    "drawn-winds",
    "drawn-winds-out-of-range",
    "drawn-winds-too-hard",
    "race",
    "race-one-gate",
    "models",
    "models-twice",
    "models-unreadable",
    "models-hole",
    "models-crowd",
    "snow",
    "snow-out-of-range",
];

/// The message for a broken scene equals the stored text beside it; `PRAIRIE_UPDATE=1` rewrites the stored text.
#[test]
fn broken_scenes_have_their_stored_messages() {
    for name in BROKEN {
        let error = load(format!("scenes/broken/{name}.toml")).expect_err(name).to_string();
        let stored = format!("scenes/broken/{name}.txt");
        if std::env::var_os("PRAIRIE_UPDATE").is_some() {
            std::fs::write(&stored, &error).unwrap();
        }
        assert_eq!(error, std::fs::read_to_string(&stored).unwrap(), "{name}");
    }
}

#[test]
fn missing_names_and_files_are_reported() {
    let told = |name: &str| load(name).unwrap_err().to_string();
    assert_eq!(
        told("medow"),
        "there is no built-in scene and no file called `medow`; did you mean `meadow`? Built-in scenes: meadow, jacksboro, devil, storm, breeze, continuum, underbrush, blades, shells, night, lee, cyclones, follow, prairie-2000, verlet, implicit, modal, history, snow, race, homestead"
    );
    assert_eq!(
        told("xyzzy"),
        "there is no built-in scene and no file called `xyzzy`. Built-in scenes: meadow, jacksboro, devil, storm, breeze, continuum, underbrush, blades, shells, night, lee, cyclones, follow, prairie-2000, verlet, implicit, modal, history, snow, race, homestead"
    );
    assert!(told("scenes/none.toml").starts_with("scene file `scenes/none.toml` cannot be read: No such file"));
    assert_eq!(told("scenes/broken"), "scene file `scenes/broken` cannot be read: it is not a file");
    assert!(told("scenes/broken/no-model.glb").contains("not TOML"));
}

/// A PNG file of uniform level.
fn even(bits: BitDepth, colour: ColorType, [width, height]: [u32; 2], level: u8) -> Vec<u8> {
    let row_bytes = (width as usize * colour.samples() * bits as usize).div_ceil(8);
    maps::png(colour, bits, [width, height], &vec![level; row_bytes * height as usize])
}

/// Message for a scene whose height map is `height_png`.
fn message_for_height_map(folder: &Path, height_png: &[u8]) -> Result<(), String> {
    let text = "summary = \"s\"\n[terrain]\nheight_map = \"h.png\"\ncovering_map = \"c.png\"\npixel_m = [2, 2]\nlevel_m = 1\n";
    std::fs::write(folder.join("s.toml"), text).unwrap();
    std::fs::write(folder.join("h.png"), height_png).unwrap();
    std::fs::write(folder.join("c.png"), grey_png([2, 2], &[255; 4])).unwrap();
    match load(folder.join("s.toml").to_str().unwrap()) {
        Ok(_) => Ok(()),
        Err(SceneError::Faulty(faulty)) => {
            assert_eq!(faulty.faults.len(), 1, "{faulty}");
            assert_eq!((faulty.faults[0].line, faulty.faults[0].column), (3, 14));
            Err(faulty.faults[0].to_string())
        }
        Err(other) => panic!("{other}"),
    }
}

#[test]
fn height_maps_of_other_formats_and_sizes_are_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let told = |png: &[u8]| message_for_height_map(folder.path(), png);
    let good = even(BitDepth::Eight, ColorType::Grayscale, [128, 128], 0);
    assert_eq!(told(&good), Ok(()));
    assert_eq!(told(&even(BitDepth::Sixteen, ColorType::Grayscale, [129, 128], 0)), Ok(()));

    let kinds = [
        (BitDepth::Eight, ColorType::Rgba, "Rgba 8 bits"),
        (BitDepth::Four, ColorType::Grayscale, "Grayscale 4 bits"),
        (BitDepth::Eight, ColorType::GrayscaleAlpha, "GrayscaleAlpha 8 bits"),
        (BitDepth::Eight, ColorType::Rgb, "Rgb 8 bits"),
    ];
    for (bits, colour, name) in kinds {
        let expected =
            format!("`terrain.height_map` names `h.png`, which is a PNG of kind {name}; allowed: grey without alpha, 8 or 16 bits");
        assert_eq!(told(&even(bits, colour, [128, 128], 0)), Err(expected));
    }
    let message = |png: &[u8]| told(png).unwrap_err();
    assert!(message(&even(BitDepth::Eight, ColorType::Grayscale, [1, 128], 0)).contains("is 1 × 128 pixels; allowed: 2 × 2 to"));
    assert!(message(&even(BitDepth::Eight, ColorType::Grayscale, [127, 128], 0)).contains("covers 254 m × 256 m"));
    assert!(message(&even(BitDepth::Sixteen, ColorType::Grayscale, [128, 128], 255)).contains("elevations from 65535 m"));
    assert!(message(&good[..good.len() / 2]).contains("is not a readable PNG"));
    assert!(message(b"").contains("is not a readable PNG"));
}

#[test]
fn nutrient_maps_are_grey_or_coloured() {
    let folder = tempfile::tempdir().unwrap();
    let scene = |nutrients: &[u8]| {
        let text = "summary = \"s\"\n[terrain]\nheight_map = \"h.png\"\ncovering_map = \"c.png\"\npixel_m = [2, 2]\nlevel_m = 1\n\
                    [growth]\nnutrient_map = \"n.png\"\n";
        std::fs::write(folder.path().join("s.toml"), text).unwrap();
        std::fs::write(folder.path().join("h.png"), grey_png([128; 2], &[0; 128 * 128])).unwrap();
        std::fs::write(folder.path().join("c.png"), grey_png([2, 2], &[255; 4])).unwrap();
        std::fs::write(folder.path().join("n.png"), nutrients).unwrap();
        load(folder.path().join("s.toml").to_str().unwrap())
    };
    for colour in [ColorType::Grayscale, ColorType::Rgb] {
        let png = even(BitDepth::Eight, colour, [4, 3], 9);
        let loaded = scene(&png).unwrap();
        assert_eq!((loaded.nutrient_png, loaded.scene.growth.nutrient_map.as_str()), (png, ""));
    }
    let told = |bits, colour, size_px| scene(&even(bits, colour, size_px, 0)).unwrap_err().to_string();
    let title = "error: `growth.nutrient_map` names `n.png`, which is ";
    for (bits, colour, name) in [(BitDepth::Eight, ColorType::Rgba, "Rgba 8 bits"), (BitDepth::Sixteen, ColorType::Rgb, "Rgb 16 bits")] {
        let told = told(bits, colour, [4, 3]);
        assert!(told.contains(&format!("{title}a PNG of kind {name}; allowed: grey or RGB without alpha, 8 bits\n")), "{told}");
        assert!(told.contains("s.toml:8:16\n"), "{told}");
    }
    let told = told(BitDepth::Eight, ColorType::Rgb, [1, 3]);
    assert!(told.contains(&format!("{title}1 × 3 pixels; allowed: 2 × 2 to 8192 × 8192\n")), "{told}");
}

#[test]
fn species_of_a_file_come_before_those_of_the_scene() {
    let folder = tempfile::tempdir().unwrap();
    let species = |name: &str| format!("[[underbrush]]\nname = \"{name}\"\n[[underbrush.components]]\nname = \"leaf\"\nkind = \"leaf\"\n");
    let text = "underbrush_file = \"u.toml\"\nsummary = \"s\"\n[terrain]\nheight_map = \"h.png\"\ncovering_map = \"c.png\"\npixel_m = [2, 2]\nlevel_m = 1\n";
    std::fs::write(folder.path().join("s.toml"), format!("{text}{}", species("sedge"))).unwrap();
    std::fs::write(folder.path().join("u.toml"), species("reed") + &species("fern")).unwrap();
    std::fs::write(folder.path().join("h.png"), grey_png([128; 2], &[0; 128 * 128])).unwrap();
    std::fs::write(folder.path().join("c.png"), grey_png([2, 2], &[255; 4])).unwrap();
    let path = folder.path().join("s.toml");
    let loaded = load(path.to_str().unwrap()).unwrap();
    assert_eq!(loaded.scene.underbrush.iter().map(|species| species.name.as_str()).collect::<Vec<_>>(), ["reed", "fern", "sedge"]);
    assert!(loaded.scene.underbrush_file.is_empty() && loaded.nutrient_png.is_empty());
    let report = check(path.to_str().unwrap()).unwrap().to_string();
    assert!(report.contains("\n  underbrush reed, fern, sedge, on 512 × 512 sites of generated soil\n"), "{report}");
    std::fs::write(folder.path().join("u.toml"), [0xff, 0xfe]).unwrap();
    let told = load(path.to_str().unwrap()).unwrap_err().to_string();
    assert!(told.contains("error: `underbrush_file` names `u.toml`, which cannot be read: it is not UTF-8 text: "), "{told}");
    assert!(told.contains("s.toml:1:19\n"), "{told}");
}
