//! The whole field: the awake patches, what they tell their neighbours, and the step.

use super::patch::CHANNELS;
use super::{Bend, Coefficients, Extremes, Patch, WaveParams, verlet};
use crate::grid::{PatchIndex, PatchLayout};

/// The bend field of a world. A patch that is not awake is at rest and holds no memory, however large the world. Beyond
/// the world's edge the grass is at rest.
///
/// Each awake patch publishes its outermost cells; its neighbours read them into their ghosts before they step, so that
/// all patches can step at once ([`lanes`](Self::lanes)).
#[derive(Clone, Debug)]
pub struct Field {
    layout: PatchLayout,
    /// Awake patches, ascending; the vectors below run alongside.
    indices: Vec<PatchIndex>,
    patches: Vec<Patch>,
    borders: Vec<Border>,
    next_borders: Vec<Border>,
    /// Patches changed since they published.
    stale: Vec<bool>,
}

impl PartialEq for Field {
    fn eq(&self, other: &Self) -> bool {
        self.layout == other.layout && self.indices == other.indices && self.patches == other.patches
    }
}

impl Field {
    /// A field at rest, all patches asleep.
    pub fn new(layout: PatchLayout) -> Self {
        Self { layout, indices: vec![], patches: vec![], borders: vec![], next_borders: vec![], stale: vec![] }
    }

    /// Shape and spacing.
    pub fn layout(&self) -> &PatchLayout {
        &self.layout
    }

    /// Number of awake patches.
    pub fn awake_count(&self) -> usize {
        self.indices.len()
    }

    /// Indices of the awake patches, ascending.
    pub fn awake_indices(&self) -> &[PatchIndex] {
        &self.indices
    }

    /// The patch, if it is awake.
    pub fn patch(&self, patch: PatchIndex) -> Option<&Patch> {
        self.indices.binary_search(&patch).ok().map(|slot| &self.patches[slot])
    }

    /// The patch to be changed, if it is awake.
    pub fn patch_mut(&mut self, patch: PatchIndex) -> Option<&mut Patch> {
        let slot = self.indices.binary_search(&patch).ok()?;
        self.stale[slot] = true;
        Some(&mut self.patches[slot])
    }

    /// The patch to be changed, woken if it slept.
    pub fn wake(&mut self, patch: PatchIndex) -> &mut Patch {
        let slot = self.indices.binary_search(&patch).unwrap_or_else(|slot| {
            let side = self.layout.cells as usize;
            self.indices.insert(slot, patch);
            self.patches.insert(slot, Patch::new(side));
            self.borders.insert(slot, Border::new(side));
            self.next_borders.insert(slot, Border::new(side));
            self.stale.insert(slot, false);
            slot
        });
        self.stale[slot] = true;
        &mut self.patches[slot]
    }

    /// Lets a patch go; it is at rest from now on.
    pub fn sleep(&mut self, patch: PatchIndex) {
        if let Ok(slot) = self.indices.binary_search(&patch) {
            self.indices.remove(slot);
            self.patches.remove(slot);
            self.borders.remove(slot);
            self.next_borders.remove(slot);
            self.stale.remove(slot);
        }
    }

    /// Awake patches in index order.
    pub fn awake(&self) -> impl Iterator<Item = (PatchIndex, &Patch)> {
        self.indices.iter().copied().zip(&self.patches)
    }

    /// Largest bending speed of any cell (rad/s).
    pub fn omega_max_rad_per_s(&self) -> f32 {
        self.awake().map(|(_, patch)| patch.extremes().omega_rad_per_s).fold(0.0, f32::max)
    }

    /// State at `(x_m, z_m)`: that of the nearest cell; at rest where the patch sleeps and outside the world.
    pub fn bend_at(&self, x_m: f32, z_m: f32) -> Bend {
        let Some(index) = self.layout.patch_at(x_m, z_m) else { return Bend::default() };
        let Some(patch) = self.patch(index) else { return Bend::default() };
        let [corner_x, corner_z] = self.layout.corner_m(index);
        let cell = |m: f32| ((m / self.layout.cell_m).max(0.0) as usize).min(patch.side() - 1);
        patch.bend(cell(x_m - corner_x), cell(z_m - corner_z))
    }

    /// One lane for each awake patch, in index order. Step every lane once, in any order or at once, then call
    /// [`turn`](Self::turn).
    pub fn lanes(&mut self) -> Vec<Lane<'_>> {
        for ((patch, border), stale) in self.patches.iter().zip(&mut self.borders).zip(&mut self.stale) {
            if std::mem::take(stale) {
                border.publish(patch);
            }
        }
        let (layout, indices, borders) = (&self.layout, &self.indices, &self.borders);
        let border = |x: i64, z: i64| {
            let slot = indices.binary_search(&layout.index(x, z)?).ok()?;
            Some(&borders[slot])
        };
        let lanes = indices.iter().zip(&mut self.patches).zip(&mut self.next_borders);
        lanes
            .map(|((&index, patch), publishes)| {
                let [x, z] = layout.place(index).map(i64::from);
                let neighbours = [border(x - 1, z), border(x + 1, z), border(x, z - 1), border(x, z + 1)];
                Lane { index, patch, neighbours, publishes }
            })
            .collect()
    }

    /// Makes what the lanes published visible to their neighbours.
    pub fn turn(&mut self) {
        std::mem::swap(&mut self.borders, &mut self.next_borders);
    }

    /// Advances the field by `dt_secs` with Verlet sub-steps chosen from the stability bound, on one thread. Returns the
    /// number of sub-steps.
    pub fn step(&mut self, params: &WaveParams, dt_secs: f32) -> u32 {
        let count = verlet::substeps(params, self.layout.cell_m, dt_secs, self.omega_max_rad_per_s());
        let k = Coefficients::new(params, self.layout.cell_m, dt_secs / count as f32);
        for _ in 0..count {
            for mut lane in self.lanes() {
                lane.step(&k);
            }
            self.turn();
        }
        count
    }
}

/// An awake patch with what its neighbours published.
pub struct Lane<'a> {
    /// Which patch.
    pub index: PatchIndex,
    patch: &'a mut Patch,
    /// Borders of the neighbours to the west, east, north and south; none asleep.
    neighbours: [Option<&'a Border>; 4],
    publishes: &'a mut Border,
}

impl Lane<'_> {
    /// Advances the patch by a Verlet sub-step, between what its neighbours published, and publishes its own new border.
    pub fn step(&mut self, k: &Coefficients) -> Extremes {
        let [west, east, north, south] = self.neighbours;
        fill_row(self.patch, Side::North, north);
        fill_row(self.patch, Side::South, south);
        let extremes = verlet::advance(self.patch, k, &mut Seam { west, east, publishes: self.publishes });
        self.publishes.publish_row(self.patch, Side::North);
        self.publishes.publish_row(self.patch, Side::South);
        extremes
    }

    /// What was published in the west, east, north and south.
    pub fn rims(&self) -> [Rim; 4] {
        Side::ALL.map(|side| self.publishes.rim(side))
    }
}

/// Extremes of the outermost cells on one side of a patch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rim {
    /// Largest |θ| (rad).
    pub theta_rad: f32,
    /// Largest component of ω (rad/s).
    pub omega_rad_per_s: f32,
}

/// The outermost cells of a patch: for each side, for each channel, a line of cells.
#[derive(Clone, Debug)]
struct Border {
    side: usize,
    values: Vec<f32>,
}

impl Border {
    fn new(side: usize) -> Self {
        Self { side, values: vec![0.0; Side::ALL.len() * CHANNELS * side] }
    }

    fn line(&self, side: Side, channel: usize) -> &[f32] {
        &self.values[(side as usize * CHANNELS + channel) * self.side..][..self.side]
    }

    fn line_mut(&mut self, side: Side, channel: usize) -> &mut [f32] {
        &mut self.values[(side as usize * CHANNELS + channel) * self.side..][..self.side]
    }

    fn publish(&mut self, patch: &Patch) {
        for j in 0..self.side {
            let row = patch.at(0, j);
            for (channel, values) in patch.now.iter().enumerate() {
                self.line_mut(Side::West, channel)[j] = values[row];
                self.line_mut(Side::East, channel)[j] = values[row + patch.side() - 1];
            }
        }
        self.publish_row(patch, Side::North);
        self.publish_row(patch, Side::South);
    }

    fn publish_row(&mut self, patch: &Patch, side: Side) {
        let row = patch.at(0, if matches!(side, Side::North) { 0 } else { patch.side() - 1 });
        for (channel, values) in patch.now.iter().enumerate() {
            self.line_mut(side, channel).copy_from_slice(&values[row..row + patch.side()]);
        }
    }

    fn rim(&self, side: Side) -> Rim {
        let largest = |channel| self.line(side, channel).iter().fold(0.0_f32, |largest, value| value.abs().max(largest));
        Rim { theta_rad: largest(0), omega_rad_per_s: largest(1).max(largest(2)) }
    }
}

#[derive(Clone, Copy)]
enum Side {
    West,
    East,
    North,
    South,
}

impl Side {
    const ALL: [Self; 4] = [Self::West, Self::East, Self::North, Self::South];
}

/// The western and eastern ends of a patch's rows.
struct Seam<'a> {
    west: Option<&'a Border>,
    east: Option<&'a Border>,
    publishes: &'a mut Border,
}

impl verlet::Seams for Seam<'_> {
    #[inline(always)]
    fn fill(&mut self, j: usize, row: usize, now: &mut [Vec<f32>; CHANNELS]) {
        for (channel, values) in now.iter_mut().enumerate() {
            values[row - 1] = self.west.map_or(0.0, |border| border.line(Side::East, channel)[j]);
            values[row + self.publishes.side] = self.east.map_or(0.0, |border| border.line(Side::West, channel)[j]);
        }
    }

    #[inline(always)]
    fn publish(&mut self, j: usize, next: [&[f32]; CHANNELS]) {
        for (channel, values) in next.into_iter().enumerate() {
            self.publishes.line_mut(Side::West, channel)[j] = values[0];
            self.publishes.line_mut(Side::East, channel)[j] = values[values.len() - 1];
        }
    }
}

/// Fills the ghosts beyond the northern or southern side; at rest where no neighbour is awake.
fn fill_row(patch: &mut Patch, side: Side, neighbour: Option<&Border>) {
    let (count, stride) = (patch.side(), patch.stride());
    let (start, facing) = match side {
        Side::North => (1, Side::South),
        _ => ((count + 1) * stride + 1, Side::North),
    };
    for (channel, values) in patch.now.iter_mut().enumerate() {
        let ghosts = &mut values[start..start + count];
        match neighbour {
            Some(border) => ghosts.copy_from_slice(border.line(facing, channel)),
            None => ghosts.fill(0.0),
        }
    }
}
