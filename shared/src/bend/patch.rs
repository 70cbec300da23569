//! One patch of the field: three channels at two times, with a halo of ghost cells.

use super::tiles::{TILE, Tiles, size_bits, square_bits};
use crate::grid::PatchIndex;

/// State of one cluster of grass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bend {
    /// Bending angle (rad), 0 where the wind alone would hold the grass.
    pub theta: f32,
    /// Bending velocity along X and Z (rad/s); its direction is the direction of the bend.
    pub omega: [f32; 2],
}

/// Number of channels: θ, ωx, ωz.
pub const CHANNELS: usize = 3;

/// Width of the ghosts around a patch (cells), that of 001's overlaps; also the most sub-steps between two exchanges.
pub const HALO: usize = 4;

/// Values that follow each plane, never read: planes a multiple of 4 KiB apart would contend for the same places in the cache.
const STAGGER: usize = 32;

pub(super) type Planes = [Vec<f32>; CHANNELS];

/// A square patch of `side × side` cells (a multiple of 8) inside a halo; row-major from the north-west, `(side + 8)²` values a channel.
#[derive(Clone, Debug)]
pub struct Patch {
    index: PatchIndex,
    side: usize,
    /// Channels at the newest time.
    pub(super) now: Planes,
    /// Channels one sub-step earlier.
    pub(super) before: Planes,
    pub(super) tiles: Tiles,
    pub(super) ground: Ground,
}

/// Two patches are equal if their own cells are: ghosts and what has changed are matters of how they came to be.
impl PartialEq for Patch {
    fn eq(&self, other: &Self) -> bool {
        let is_alike = (self.index, self.side, &self.ground) == (other.index, other.side, &other.ground);
        is_alike && self.rows().eq(other.rows()) && self.rows_before().eq(other.rows_before())
    }
}

/// What grows in a patch and its halo.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Ground {
    /// One kind.
    One(u8),
    /// The kind of each cell.
    Map(Vec<u8>),
}

impl Patch {
    /// A patch at rest, with the kinds that grow in it and its halo, row by row.
    pub(super) fn new(index: PatchIndex, side: usize, kind: impl Fn([i64; 2]) -> u8) -> Self {
        let stride = side + 2 * HALO;
        let zeros = || vec![0.0; stride * stride + STAGGER];
        let halo = HALO as i64;
        let cells = (0..stride * stride).map(|at| [(at % stride) as i64 - halo, (at / stride) as i64 - halo]);
        let kinds: Vec<u8> = cells.map(kind).collect();
        let ground = if kinds.iter().all(|kind| *kind == kinds[0]) { Ground::One(kinds[0]) } else { Ground::Map(kinds) };
        Self {
            index,
            side,
            now: std::array::from_fn(|_| zeros()),
            before: std::array::from_fn(|_| zeros()),
            tiles: Tiles::new(side),
            ground,
        }
    }

    /// Which patch.
    pub fn index(&self) -> PatchIndex {
        self.index
    }

    /// Cells along one side.
    pub fn side(&self) -> usize {
        self.side
    }

    /// Distance between rows in the planes.
    pub(super) fn stride(&self) -> usize {
        self.side + 2 * HALO
    }

    /// Place in the planes of cell `(i, j)`, ghosts included.
    pub(super) fn at(&self, i: i64, j: i64) -> usize {
        let halo = HALO as i64;
        debug_assert!([i, j].into_iter().all(|n| (-halo..self.side as i64 + halo).contains(&n)));
        (j + halo) as usize * self.stride() + (i + halo) as usize
    }

    /// State of cell `(i, j)`.
    pub fn bend(&self, i: usize, j: usize) -> Bend {
        read(&self.now, self.at(i as i64, j as i64))
    }

    /// State of cell `(i, j)` one sub-step earlier.
    pub fn bend_before(&self, i: usize, j: usize) -> Bend {
        read(&self.before, self.at(i as i64, j as i64))
    }

    /// Sets the state of cell `(i, j)` as contact does (001 Eqs 1 and 12): the values at both times move together, so that
    /// the object, not the integrator's memory, decides how fast the cluster moves while it is touched.
    pub fn press(&mut self, i: usize, j: usize, bend: Bend) {
        self.set(i, j, bend, bend);
    }

    /// Sets the state of cell `(i, j)` at both times, and so any motion.
    pub fn set(&mut self, i: usize, j: usize, now: Bend, before: Bend) {
        assert!(i < self.side && j < self.side, "cell ({i}, {j}) of a patch of {} × {}", self.side, self.side);
        self.set_ghost(i as i64, j as i64, now, before);
    }

    /// [`set`](Self::set) for any cell, ghosts included; a ghost makes the nearest own tile step.
    pub(super) fn set_ghost(&mut self, i: i64, j: i64, now: Bend, before: Bend) {
        let at = self.at(i, j);
        write(&mut self.now, at, now);
        write(&mut self.before, at, before);
        let [i, j] = [i, j].map(|n| n.clamp(0, self.side as i64 - 1) as usize);
        self.tiles.touch(i, j, [now, before]);
    }

    /// Rows of θ, ωx and ωz from the north.
    pub fn rows(&self) -> impl Iterator<Item = [&[f32]; CHANNELS]> {
        (0..self.side).map(|j| self.row(j))
    }

    /// Rows one sub-step earlier; with [`rows`](Self::rows) the whole state of a patch.
    pub fn rows_before(&self) -> impl Iterator<Item = [&[f32]; CHANNELS]> {
        (0..self.side).map(|j| self.row_of(&self.before, j))
    }

    /// θ, ωx and ωz of row `j`.
    ///
    /// # Panics
    /// When the patch has no such row.
    pub fn row(&self, j: usize) -> [&[f32]; CHANNELS] {
        self.row_of(&self.now, j)
    }

    fn row_of<'a>(&self, planes: &'a Planes, j: usize) -> [&'a [f32]; CHANNELS] {
        assert!(j < self.side, "row {j} of a patch of {}", self.side);
        planes.each_ref().map(|plane| &plane[(j + HALO) * self.stride() + HALO..][..self.side])
    }

    /// Largest |θ| (rad) of the newest two times.
    pub fn theta_max_rad(&self) -> f32 {
        self.tiles.theta_max_rad()
    }

    /// Largest |ω| (rad/s) of the newest two times.
    pub fn omega_max_rad_per_s(&self) -> f32 {
        self.tiles.omega_max_rad_per_s()
    }

    /// Sum of θ² + ω² over the cells (mixed units): how far from rest the patch is.
    pub fn activity(&self) -> f64 {
        let tiles = (0..self.tiles.count()).flat_map(|z| (0..self.tiles.count()).map(move |x| (x, z)));
        // The sum of nothing would be −0.
        tiles.filter(|&(x, z)| self.tiles.holds(x, z)).fold(0.0, |sum, (x, z)| sum + f64::from(self.tile_activity(x, z)))
    }

    /// The same of one tile; column by column, in vectors.
    fn tile_activity(&self, x: usize, z: usize) -> f32 {
        let mut columns = [0.0_f32; TILE];
        for row in 0..TILE {
            let at = self.at((x * TILE) as i64, (z * TILE + row) as i64);
            for plane in &self.now {
                columns.iter_mut().zip(&plane[at..at + TILE]).for_each(|(sum, value)| *sum += value * value);
            }
        }
        columns.iter().sum()
    }

    /// Tiles of 8 × 8 cells that have changed since they were last taken, row by row.
    pub fn changed_tiles(&self) -> &[bool] {
        self.tiles.changed()
    }

    /// Takes the tiles that have changed as seen.
    pub fn forget_changes(&mut self) {
        self.tiles.forget_changes();
    }

    /// Bytes of memory that the patch holds.
    pub fn memory_bytes(&self) -> usize {
        let kinds = match &self.ground {
            Ground::One(_) => 0,
            Ground::Map(kinds) => kinds.len(),
        };
        self.now.iter().chain(&self.before).map(|plane| plane.len() * size_of::<f32>()).sum::<usize>() + kinds + self.tiles.memory_bytes()
    }

    /// Finds anew how far each tile is from rest.
    pub(super) fn measure(&mut self) {
        let count = self.tiles.count();
        for (x, z) in (0..count).flat_map(|z| (0..count).map(move |x| (x, z))) {
            let mut peaks = [0; 2];
            for row in 0..TILE {
                let at = self.at((x * TILE) as i64, (z * TILE + row) as i64);
                for planes in [&self.now, &self.before] {
                    let [theta, u, w] = planes.each_ref().map(|plane| &plane[at..at + TILE]);
                    for i in 0..TILE {
                        peaks[0] = peaks[0].max(size_bits(theta[i]));
                        peaks[1] = peaks[1].max(square_bits(u[i], w[i]));
                    }
                }
            }
            self.tiles.set_peaks(x, z, peaks);
        }
    }

    /// Planes of the newest state, and of the earlier one if there are to be two `states`.
    pub(super) fn planes_mut(&mut self, states: usize) -> impl Iterator<Item = &mut [f32]> {
        self.now.iter_mut().chain(&mut self.before).take(states * CHANNELS).map(Vec::as_mut_slice)
    }

    /// Puts `width × depth` cells from `(i, j)` on, ghosts included, to rest.
    pub(super) fn quell(&mut self, [i, j]: [i64; 2], [width, depth]: [usize; 2]) {
        for row in 0..depth as i64 {
            let at = self.at(i, j + row);
            self.planes_mut(2).for_each(|plane| plane[at..at + width].fill(0.0));
        }
    }
}

fn read(planes: &Planes, at: usize) -> Bend {
    Bend { theta: planes[0][at], omega: [planes[1][at], planes[2][at]] }
}

fn write(planes: &mut Planes, at: usize, bend: Bend) {
    let values = [bend.theta, bend.omega[0], bend.omega[1]];
    planes.iter_mut().zip(values).for_each(|(plane, value)| plane[at] = value);
}
