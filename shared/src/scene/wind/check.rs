//! Consistency checks of a scene's wind.

use super::{Wind, WindBoundary, WindDiffusion, WindFaces, WindMethod, WindPressure, WindTerrain, WindTiling, WindTime, intensity};
use crate::scene::Scene;
use crate::scene::checks::conflict::Conflicts;
use crate::scene::checks::limits::WIND_CELLS_LIMIT;
use WindBoundary::{FreeSlip, Inflow, Lid, Outflow, Reflect, Wrap};

/// Paths of the faces across X, Y and Z, in the order of [`WindFaces::pairs`](super::WindFaces::pairs).
const FACES: [[&str; 2]; 3] =
    [["wind.faces.west", "wind.faces.east"], ["wind.faces.bottom", "wind.faces.top"], ["wind.faces.north", "wind.faces.south"]];

/// Horizontal axes: index in the box, index in the world, name, path of the mean wind along it.
const LEVEL: [(usize, usize, &str, &str); 2] = [(0, 0, "X", "wind.mean_m_per_s[0]"), (2, 1, "Z", "wind.mean_m_per_s[1]")];

/// Reports inconsistent settings of the wind of `scene`.
pub(in crate::scene) fn check(scene: &Scene, conflicts: &mut Conflicts) {
    let wind = &scene.wind;
    numbers(wind, conflicts);
    bottom_and_top(wind, conflicts);
    sides(wind, conflicts);
    mean_wind(wind, conflicts);
    lids(wind, conflicts);
    extent(scene, conflicts);
    if wind.canopy_frequency_hz != 0.0 && wind.canopy_drag_per_m == 0.0 {
        let message =
            format!("is {}; allowed with `canopy_drag_per_m = 0`: 0, since the wind moves grass by its drag", wind.canopy_frequency_hz);
        conflicts.note(&["wind.canopy_frequency_hz", "wind.canopy_drag_per_m"], message);
    }
    if wind.crown_drag_per_m != 0.0 && wind.tiling == WindTiling::Patch {
        let message =
            format!("is {}; allowed with `tiling = \"patch\"`: 0, since the trees would be in every patch", wind.crown_drag_per_m);
        conflicts.note(&["wind.crown_drag_per_m", "wind.tiling"], message);
    }
    match wind.method {
        WindMethod::Staggered => schemes(wind, conflicts),
        WindMethod::StableFluids => stable_fluids(wind, conflicts),
    }
    primitives(scene, conflicts);
}

/// Largest number of cells below all gusts together, and of cell steps of the warm-up.
const GUST_CELLS_LIMIT: f64 = 4_194_304.0;
const WARM_UP_LIMIT: f64 = 67_108_864.0;

fn numbers(wind: &Wind, conflicts: &mut Conflicts) {
    let cells: u64 = wind.cells.map(u64::from).iter().product();
    let radii_m = wind.gust_radius_m();
    let below = |axis: usize| f64::from(2.0 * radii_m[axis] / wind.spacing_m[axis] + 1.0).min(wind.cells[axis].into());
    let gust_cells = f64::from(wind.sources) * below(0) * below(1) * below(2);
    if gust_cells > GUST_CELLS_LIMIT {
        let message = format!("with {} sources covers {gust_cells:.0} cells in all; allowed: {GUST_CELLS_LIMIT}", wind.sources);
        conflicts.note(&["wind.source_radius_m", "wind.sources"], message);
    }
    let warm_up = cells as f64 * f64::from(wind.warm_up_secs / wind.step_secs);
    if warm_up > WARM_UP_LIMIT {
        let message = format!("takes {warm_up:.0} steps of a cell; allowed: {WARM_UP_LIMIT}");
        conflicts.note(&["wind.warm_up_secs", "wind.step_secs", "wind.cells"], message);
    }
    if cells > WIND_CELLS_LIMIT {
        conflicts.note(&["wind.cells"], format!("has {cells} cells in all; allowed: {WIND_CELLS_LIMIT}"));
    }
    if u64::from(wind.sources) > cells {
        conflicts.note(&["wind.sources", "wind.cells"], format!("is {}, more than the {cells} cells of the wind's box", wind.sources));
    }
    let [east, south] = wind.mean_m_per_s.map(f64::from);
    let speed = (east * east + south * south).sqrt();
    if speed > 40.0 {
        conflicts.note(&["wind.mean_m_per_s"], format!("has a length of {speed:.1} m/s; allowed: up to 40"));
    }
}

fn bottom_and_top(wind: &Wind, conflicts: &mut Conflicts) {
    let WindFaces { bottom, top, .. } = wind.faces;
    let closed = || WindBoundary::ALL.iter().filter(|face| face.blocks_flow());
    if !bottom.blocks_flow() {
        let allowed = quoted(closed().map(|face| face.word()));
        conflicts.note(&["wind.faces.bottom"], format!("is \"{}\"; allowed: {allowed}, since the ground is there", bottom.word()));
    }
    let why = match top {
        Wrap => Some("since the ground is opposite"),
        Inflow => Some("since the mean wind is level and enters by the sides"),
        _ => None,
    };
    if let Some(why) = why {
        let allowed = quoted(closed().chain([&Outflow]).map(|face| face.word()));
        conflicts.note(&["wind.faces.top"], format!("is \"{}\"; allowed: {allowed}, {why}", top.word()));
    }
}

/// Words in quotes, as a list that ends in "or".
fn quoted<'a>(words: impl Iterator<Item = &'a str>) -> String {
    let words: Vec<_> = words.map(|word| format!("\"{word}\"")).collect();
    match words.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => String::new(),
    }
}

/// Checks faces against the face opposite.
fn sides(wind: &Wind, conflicts: &mut Conflicts) {
    let pairs = wind.faces.pairs();
    for (axis, ..) in LEVEL {
        for side in [0, 1] {
            let [(face, path), (opposite, opposite_path)] = [side, 1 - side].map(|side| (pairs[axis][side], FACES[axis][side]));
            let word = face.word();
            if opposite == Wrap && face != Wrap {
                let message = format!(
                    "is \"{word}\", and `{opposite_path}` opposite is \"wrap\"; allowed: \"wrap\" on both or on neither, since what leaves \
                     through one enters through the other"
                );
                conflicts.note(&[path, opposite_path], message);
            }
            if face == Inflow && opposite.blocks_flow() {
                let message = format!(
                    "is \"inflow\", and `{opposite_path}` opposite is \"{}\"; allowed there: \"inflow\" or \"outflow\", since what enters \
                     must leave",
                    opposite.word()
                );
                conflicts.note(&[path, opposite_path], message);
            }
        }
    }
}

/// The prevailing wind must not blow through a closed face, nor in through an outflow.
fn mean_wind(wind: &Wind, conflicts: &mut Conflicts) {
    let pairs = wind.faces.pairs();
    for (axis, level_axis, _, path) in LEVEL {
        let mean = wind.mean_m_per_s[level_axis];
        let [low, high] = pairs[axis];
        // Inconsistent faces are reported by `sides`.
        if mean == 0.0 || low == Wrap || high == Wrap || low.blocks_flow() && high == Inflow || high.blocks_flow() && low == Inflow {
            continue;
        }
        let windward = usize::from(mean < 0.0);
        if let Some(side) = [0, 1].into_iter().find(|&side| pairs[axis][side].blocks_flow()) {
            let (word, face) = (pairs[axis][side].word(), FACES[axis][side]);
            let message = format!("is {mean}, and `{face}` is \"{word}\"; allowed: 0, since nothing blows through such a face");
            conflicts.note(&[path, face], message);
        } else if pairs[axis][windward] == Outflow {
            let (sign, face) = (["at most", "at least"][windward], FACES[axis][windward]);
            let message = format!(
                "is {mean}, which enters at `{face}`, an \"outflow\"; allowed: {sign} 0, or \"inflow\" there, since an outflow does not know what enters"
            );
            conflicts.note(&[path, face], message);
        }
    }
}

fn lids(wind: &Wind, conflicts: &mut Conflicts) {
    const LID: [&str; 3] = ["wind.faces.lid_m_per_s[0]", "wind.faces.lid_m_per_s[1]", "wind.faces.lid_m_per_s[2]"];
    for (axis, pair) in wind.faces.pairs().into_iter().enumerate() {
        let across = wind.faces.lid_m_per_s[axis];
        let Some(side) = pair.into_iter().position(|face| face == Lid) else { continue };
        if across != 0.0 {
            let face = FACES[axis][side];
            let message =
                format!("is {across}, and `{face}` is \"lid\"; allowed: 0, since a lid slides along itself and lets nothing through");
            conflicts.note(&[LID[axis], face], message);
        }
    }
}

/// The box must cover the world, or a whole number of patches.
fn extent(scene: &Scene, conflicts: &mut Conflicts) {
    let (wind, patch_m) = (&scene.wind, scene.patches.patch_m());
    let pairs = wind.faces.pairs();
    for (axis, level_axis, name, _) in LEVEL {
        let (box_m, world_m) = (wind.box_m()[axis], scene.extent_m()[level_axis]);
        let [low, high] = FACES[axis];
        if pairs[axis] == [Wrap; 2] {
            let patches = box_m / patch_m;
            let is_whole = patches > 0.5 && (patches - patches.round()).abs() <= 1e-4 * patches;
            if wind.tiling == WindTiling::Patch && !is_whole {
                let message = format!(
                    "is \"patch\", and cells × spacing_m is {box_m} m along {name}; allowed: a whole number of patches of {patch_m} m, since one \
                     box serves every patch"
                );
                conflicts.note(&["wind.tiling", "wind.cells", "wind.spacing_m", "patches.cells", "patches.cell_m"], message);
            }
        } else if pairs[axis].contains(&Wrap) {
            // A single `wrap` face is reported by `sides`.
        } else if wind.tiling != WindTiling::Box {
            let message = format!(
                "is \"{}\", and `{low}` is \"{}\"; allowed: \"wrap\" on all four sides, since the box repeats over the world",
                wind.tiling.word(),
                pairs[axis][0].word()
            );
            conflicts.note(&["wind.tiling", low, high], message);
        } else if box_m < world_m {
            let message = format!(
                "is \"{}\", which needs a box that covers the world: {world_m} m along {name}, and cells × spacing_m is {box_m} m; make it larger or \
                 use \"wrap\"",
                pairs[axis][0].word()
            );
            conflicts.note(
                &[low, high, "wind.tiling", "wind.cells", "wind.spacing_m", "patches.count", "patches.cells", "patches.cell_m"],
                message,
            );
        }
    }
}

/// Checks the schemes of the staggered solver against each other and the terrain.
fn schemes(wind: &Wind, conflicts: &mut Conflicts) {
    if !wind.time.allows(wind.advection) {
        let why = if wind.advection.uses_fluxes() { "reflection needs" } else { "Runge–Kutta stages need" };
        let family = if wind.advection.uses_fluxes() { "semi-Lagrangian advection" } else { "fluxes through cell faces" };
        let message = format!(
            "is \"{}\"; allowed with `advection = \"{}\"`: {}, since {why} {family}",
            wind.time.word(),
            wind.advection.word(),
            quoted(WindTime::ALL.iter().filter(|time| time.allows(wind.advection)).map(|time| time.word()))
        );
        conflicts.note(&["wind.time", "wind.advection"], message);
    }
    if wind.terrain != WindTerrain::Obstacle {
        return;
    }
    if wind.pressure == WindPressure::Direct && wind.time == WindTime::Reflection {
        let message = "is \"reflection\"; allowed with `terrain = \"obstacle\"` and `pressure = \"direct\"`: \"split\", since the immersed land holds \
                       the air in every step";
        conflicts.note(&["wind.time", "wind.pressure", "wind.terrain"], message.to_owned());
    }
    if matches!(wind.diffusion, WindDiffusion::Implicit | WindDiffusion::CrankNicolson) {
        let message = format!(
            "is \"{}\"; allowed with `terrain = \"obstacle\"`: \"explicit\" or \"gauss-seidel\", since transforms know no solid cells",
            wind.diffusion.word()
        );
        conflicts.note(&["wind.diffusion", "wind.terrain"], message);
    }
    if wind.tiling != WindTiling::Box {
        let message = format!(
            "is \"{}\"; allowed with `terrain = \"obstacle\"`: \"box\", since the land differs from place to place",
            wind.tiling.word()
        );
        conflicts.note(&["wind.tiling", "wind.terrain"], message);
    }
}

/// The method `stable-fluids` has one scheme of each kind, the default of omitted fields, so a field that differs was given in the file.
fn stable_fluids(wind: &Wind, conflicts: &mut Conflicts) {
    let own = Wind::of(WindMethod::StableFluids);
    let words = [
        ("wind.advection", wind.advection.word(), own.advection.word()),
        ("wind.time", wind.time.word(), own.time.word()),
        ("wind.diffusion", wind.diffusion.word(), own.diffusion.word()),
        ("wind.pressure", wind.pressure.word(), own.pressure.word()),
        ("wind.terrain", wind.terrain.word(), own.terrain.word()),
        ("wind.dust.advection", wind.dust.advection.word(), own.dust.advection.word()),
    ];
    for (path, word, own) in words {
        if word != own {
            let message = format!("is \"{word}\"; allowed with `method = \"stable-fluids\"`: \"{own}\", the only one that method has");
            conflicts.note(&[path, "wind.method"], message);
        }
    }
    for (axis, pair) in wind.faces.pairs().into_iter().enumerate() {
        let known = if axis == 1 { "\"free-slip\" or \"reflect\"" } else { "\"wrap\", \"free-slip\" or \"reflect\"" };
        for (face, path) in pair.into_iter().zip(FACES[axis]) {
            if !matches!(face, Wrap | FreeSlip | Reflect) {
                let word = face.word();
                let message = format!("is \"{word}\"; allowed with `method = \"stable-fluids\"`: {known}, the only ones that method has");
                conflicts.note(&[path, "wind.method"], message);
            }
        }
    }
    if wind.canopy_drag_per_m != 0.0 {
        let message =
            format!("is {}; allowed with `method = \"stable-fluids\"`: 0, since that method has no canopy", wind.canopy_drag_per_m);
        conflicts.note(&["wind.canopy_drag_per_m", "wind.method"], message);
    }
    if wind.crown_drag_per_m != 0.0 {
        let message =
            format!("is {}; allowed with `method = \"stable-fluids\"`: 0, since that method has no drag of bodies", wind.crown_drag_per_m);
        conflicts.note(&["wind.crown_drag_per_m", "wind.method"], message);
    }
}

/// Primitives must be inside the world and the height of the box, and have the fields of their intensity.
fn primitives(scene: &Scene, conflicts: &mut Conflicts) {
    let [width_m, depth_m] = scene.extent_m();
    let (world, air) = (["patches.count", "patches.cells", "patches.cell_m"], ["wind.cells", "wind.spacing_m"]);
    let limits = [
        (width_m, "the world's extent along X", &world[..]),
        (scene.wind.box_m()[1], "the height of the wind's box", &air[..]),
        (depth_m, "the world's extent along Z", &world[..]),
    ];
    for (i, primitive) in scene.wind.primitives.iter().enumerate() {
        intensity::check(&format!("wind.primitives[{i}]"), primitive, conflicts);
        for (axis, (limit_m, what, set_by)) in limits.into_iter().enumerate() {
            let at_m = primitive.at_m[axis];
            if at_m > limit_m {
                let path = format!("wind.primitives[{i}].at_m[{axis}]");
                conflicts.note(&[&[path.as_str()], set_by].concat(), format!("is {at_m}; allowed: 0 to {limit_m}, {what}"));
            }
        }
    }
}
