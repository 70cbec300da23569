//! Checks of values against each other; the range of each single value is in [`FIELDS`](super::FIELDS).

use super::{Scene, drawn_wind, lamp, objects, picture, swing, underbrush, wind};
use crate::bend::{Scheme, Seams};

/// Largest side of the world (m): up to here a coordinate in single precision resolves 1 cm.
pub const EXTENT_LIMIT_M: f32 = 100_000.0;

/// Most cells of the bend field that may hold memory at once, about 1 GB.
pub const AWAKE_CELLS_LIMIT: u64 = 1 << 25;

/// Most cells of the wind's box.
pub const WIND_CELLS_LIMIT: u64 = 1 << 21;

/// Values that are fine by themselves and do not fit together.
pub(super) struct Misfit {
    /// Paths of the fields that take part; the message is about the first.
    pub(super) fields: Vec<String>,
    /// What is wrong.
    pub(super) message: String,
}

/// Keeps what does not fit together.
#[derive(Default)]
pub(super) struct Misfits(pub(super) Vec<Misfit>);

impl Misfits {
    /// Notes what is wrong with the first of the `fields` that take part.
    pub(super) fn note(&mut self, fields: &[impl AsRef<str>], message: String) {
        self.0.push(Misfit { fields: fields.iter().map(|field| field.as_ref().to_owned()).collect(), message });
    }
}

/// What does not fit together in `scene`, whose first `from_file` species of underbrush come from its underbrush file.
pub(super) fn cross_checks(scene: &Scene, from_file: usize) -> Misfits {
    let mut misfits = Misfits::default();
    let Scene { patches, species, .. } = scene;

    if !patches.cells.is_multiple_of(8) {
        misfits.note(&["patches.cells"], format!("is {}; allowed: a multiple of 8", patches.cells));
    }
    let [width_m, depth_m] = scene.extent_m();
    if width_m.max(depth_m) > EXTENT_LIMIT_M {
        let message = format!("makes a world of {width_m} m × {depth_m} m; allowed: count × cells × cell_m up to {EXTENT_LIMIT_M} m");
        misfits.note(&["patches.count", "patches.cells", "patches.cell_m"], message);
    }
    let awake_cells = u64::from(patches.awake_limit) * u64::from(patches.cells) * u64::from(patches.cells);
    if awake_cells > AWAKE_CELLS_LIMIT {
        let message = format!(
            "lets {} patches of {}² cells be awake, {awake_cells} in all; allowed: {AWAKE_CELLS_LIMIT}",
            patches.awake_limit, patches.cells
        );
        misfits.note(&["patches.awake_limit", "patches.cells"], message);
    }
    check_bend(scene, &mut misfits);
    swing::check(scene, &mut misfits);
    wind::check::check(scene, &mut misfits);
    for (i, later) in species.iter().enumerate() {
        let earlier = || species[..i].iter().enumerate();
        if let Some((j, _)) = earlier().find(|(_, earlier)| earlier.name == later.name) {
            let fields = [format!("species[{i}].name"), format!("species[{j}].name")];
            misfits
                .note(&[&fields[0], &fields[1]], format!("is \"{}\", as that of `species[{j}]`; allowed: a name of its own", later.name));
        }
        if let Some((j, _)) = earlier().find(|(_, earlier)| earlier.cover == later.cover) {
            let fields = [format!("species[{i}].cover"), format!("species[{j}].cover")];
            let message =
                format!("is {}, as that of `species[{j}]`, \"{}\"; allowed: an ID of its own, 1 to 252", later.cover, species[j].name);
            misfits.note(&[&fields[0], &fields[1]], message);
        }
    }
    underbrush::check::check(scene, from_file, &mut misfits);
    objects::check(&scene.objects, &mut misfits);
    drawn_wind::check(scene, &mut misfits);
    picture::check(&scene.light, &mut misfits);
    lamp::check(&scene.lights, &mut misfits);
    misfits
}

/// What the modal scheme asks for.
fn check_bend(scene: &Scene, misfits: &mut Misfits) {
    let Scene { bend, grass, patches, species, .. } = scene;
    if bend.scheme != Scheme::Modal {
        return;
    }
    let scheme = "`bend.scheme` = \"modal\"";
    if grass.mu_m_per_rad != 0.0 {
        let message = format!("is {}; allowed with {scheme}: 0, for its speed is one constant", grass.mu_m_per_rad);
        misfits.note(&["grass.mu_m_per_rad", "bend.scheme"], message);
    }
    if !species.is_empty() {
        let message = format!("names {} species; allowed with {scheme}: none, for its speed is one constant", species.len());
        misfits.note(&["species", "bend.scheme"], message);
    }
    if bend.seams != Seams::Exact {
        misfits.note(&["bend.seams", "bend.scheme"], format!("is \"{}\"; allowed with {scheme}: \"exact\"", bend.seams.word()));
    }
    let count = u64::from(patches.count[0]) * u64::from(patches.count[1]);
    if count > u64::from(patches.awake_limit) {
        let message = format!(
            "is {}; allowed with {scheme}: at least as many as there are patches, {count}, for it carries all of them at once",
            patches.awake_limit
        );
        misfits.note(&["patches.awake_limit", "patches.count", "bend.scheme"], message);
    }
}
