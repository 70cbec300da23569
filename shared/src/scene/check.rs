//! Checks of values against each other; the range of each single value is in [`FIELDS`](super::FIELDS).

use super::{Scene, drawn_wind, objects, wind};

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
pub(super) struct Misfits(Vec<Misfit>);

impl Misfits {
    /// Notes what is wrong with the first of the `fields` that take part.
    pub(super) fn note(&mut self, fields: &[&str], message: String) {
        self.0.push(Misfit { fields: fields.iter().map(|&field| field.to_owned()).collect(), message });
    }
}

/// What does not fit together in `scene`.
pub(super) fn cross_checks(scene: &Scene) -> Vec<Misfit> {
    let mut misfits = Misfits::default();
    let patches = &scene.patches;

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
    wind::check::check(scene, &mut misfits);
    objects::check(&scene.objects, &mut misfits);
    drawn_wind::check(scene, &mut misfits);
    misfits.0
}
