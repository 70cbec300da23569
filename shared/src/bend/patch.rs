//! One patch of the field: three channels at two times, with a halo of ghost cells.

use super::tiles::{TILE, Tiles, size_bits, square_bits};
use crate::grid::PatchIndex;

/// State of one cluster of grass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bend {
    /// Bending angle (rad); 0 at equilibrium with the wind.
    pub theta: f32,
    /// Bending velocity along X and Z (rad/s); its direction is the direction of the bend.
    pub omega: [f32; 2],
}

/// Number of channels: θ, ωx, ωz.
pub const CHANNELS: usize = 3;

/// Width of the halo around a patch (cells), that of Chen & Johan's overlaps; also the largest number of sub-steps between two exchanges.
pub const HALO: usize = 4;

/// Constants of [`Patch::checksum`]: the first prime of xxHash32, and a start.
const CHECK_MULTIPLIER: u32 = 0x9E37_79B1;
const CHECK_SEED: u32 = 0x811C_9DC5;

/// Padding after each plane, never read: planes a multiple of 4 KiB apart would contend for the same cache sets.
const STAGGER: usize = 32;

pub(super) type Planes = [Vec<f32>; CHANNELS];

/// Square patch of `side × side` cells (a multiple of 8) inside a halo; row-major from the north-west, `(side + 8)²` values a channel.
#[derive(Clone, Debug)]
pub struct Patch {
    index: PatchIndex,
    side: usize,
    /// Channels at the newest time.
    pub(super) now: Planes,
    /// Channels one sub-step earlier.
    pub(super) before: Planes,
    pub(super) tiles: Tiles,
    pub(super) ground: PatchKinds,
    /// Number of cells stepped in the newest pass.
    pub(super) cells_stepped: u64,
}

/// Two patches are equal if their own cells are: ghosts and revisions depend on their history.
impl PartialEq for Patch {
    fn eq(&self, other: &Self) -> bool {
        let is_alike = (self.index, self.side, &self.ground) == (other.index, other.side, &other.ground);
        is_alike && self.rows().eq(other.rows()) && self.rows_before().eq(other.rows_before())
    }
}

/// Kinds of grass in a patch and its halo.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum PatchKinds {
    /// One kind.
    One(u8),
    /// The kind of each cell.
    Map(Vec<u8>),
}

impl Patch {
    /// A patch at rest, with the kinds that grow in it and its halo, row by row.
    pub(super) fn new(index: PatchIndex, side: usize, revision: u64, kind: impl Fn([i64; 2]) -> u8) -> Self {
        let stride = side + 2 * HALO;
        let zeros = || vec![0.0; stride * stride + STAGGER];
        let halo = HALO as i64;
        let cells = (0..stride * stride).map(|at| [(at % stride) as i64 - halo, (at / stride) as i64 - halo]);
        let kinds: Vec<u8> = cells.map(kind).collect();
        let ground = if kinds.iter().all(|kind| *kind == kinds[0]) { PatchKinds::One(kinds[0]) } else { PatchKinds::Map(kinds) };
        Self {
            index,
            side,
            now: std::array::from_fn(|_| zeros()),
            before: std::array::from_fn(|_| zeros()),
            tiles: Tiles::new(side, revision),
            ground,
            cells_stepped: 0,
        }
    }

    /// Index of the patch.
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

    /// Index in the planes of cell `(i, j)`, ghosts included.
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

    /// Sets the state of cell `(i, j)` as contact does (Chen & Johan Eqs 1 and 12): the values at both times move together, so that the object, not
    /// the integrator's memory, decides how fast the cluster moves while it is touched.
    pub fn press(&mut self, i: usize, j: usize, bend: Bend) {
        self.set(i, j, bend, bend);
    }

    /// Sets the state of cell `(i, j)` at both times, and thereby its motion.
    pub fn set(&mut self, i: usize, j: usize, now: Bend, before: Bend) {
        assert!(i < self.side && j < self.side, "cell ({i}, {j}) of a patch of {} × {}", self.side, self.side);
        self.set_ghost(i as i64, j as i64, now, before);
    }

    /// Pushes the cells of tile `(x, z)` of the patch: `push` returns the displacement of θ and ω of a cell, given its place in the tile, in the newer of
    /// the two states, which changes its motion. The tile is not put to rest in the next step, so that small pushes add up.
    pub(crate) fn push_tile(&mut self, [x, z]: [usize; 2], push: impl Fn([usize; 2]) -> Bend) {
        self.tiles.push(x, z);
        for [u, v] in (0..TILE * TILE).map(|n| [n % TILE, n / TILE]) {
            let (i, j) = (x * TILE + u, z * TILE + v);
            let (now, by) = (self.bend(i, j), push([u, v]));
            let pushed = Bend { theta: now.theta + by.theta, omega: [0, 1].map(|axis| now.omega[axis] + by.omega[axis]) };
            self.set(i, j, pushed, self.bend_before(i, j));
        }
    }

    /// [`set`](Self::set) for any cell, ghosts included; a ghost activates the nearest own tile.
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

    /// Rows one sub-step earlier; with [`rows`](Self::rows) the complete state of a patch.
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

    /// Largest |θ| (rad) of the last two times.
    pub fn theta_max_rad(&self) -> f32 {
        self.tiles.theta_max_rad()
    }

    /// Largest |ω| (rad/s) of the last two times.
    pub fn omega_max_rad_per_s(&self) -> f32 {
        self.tiles.omega_max_rad_per_s()
    }

    /// Sum of θ² + ω² over the cells (mixed units), a measure of distance from rest.
    pub fn activity(&self) -> f64 {
        let tiles = (0..self.tiles.count()).flat_map(|z| (0..self.tiles.count()).map(move |x| (x, z)));
        // The sum of nothing would be −0.
        tiles.filter(|&(x, z)| self.tiles.holds(x, z)).fold(0.0, |sum, (x, z)| sum + f64::from(self.tile_activity(x, z)))
    }

    /// The same for one tile, column by column, vectorised.
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

    /// Checksum of the patch's own cells at both times, in eight lanes, one per column of a tile. Tiles at rest take no time.
    pub fn checksum(&self) -> u32 {
        let mut lanes = [CHECK_SEED; TILE];
        let tiles = (0..self.tiles.count()).flat_map(|z| (0..self.tiles.count()).map(move |x| (x, z)));
        for (x, z) in tiles.filter(|&(x, z)| self.tiles.holds(x, z)) {
            lanes.iter_mut().for_each(|lane| *lane ^= (z * self.tiles.count() + x) as u32);
            for row in 0..TILE {
                let at = self.at((x * TILE) as i64, (z * TILE + row) as i64);
                for plane in self.now.iter().chain(&self.before) {
                    let cells = lanes.iter_mut().zip(&plane[at..at + TILE]);
                    cells.for_each(|(lane, value)| *lane = (*lane ^ value.to_bits()).wrapping_mul(CHECK_MULTIPLIER).rotate_left(15));
                }
            }
        }
        lanes.into_iter().fold(CHECK_SEED, |sum, lane| (sum ^ lane).wrapping_mul(CHECK_MULTIPLIER).rotate_left(15))
    }

    /// Whether each tile of 8 × 8 cells may have changed since the field had this [revision](super::Field::revision), row by row.
    pub fn changed_since(&self, revision: u64) -> impl Iterator<Item = bool> {
        self.tiles.changed_in().iter().map(move |changed_in| *changed_in >= revision)
    }

    /// Memory held by the patch (bytes).
    pub fn memory_bytes(&self) -> usize {
        let kinds = match &self.ground {
            PatchKinds::One(_) => 0,
            PatchKinds::Map(kinds) => kinds.len(),
        };
        self.now.iter().chain(&self.before).map(|plane| plane.len() * size_of::<f32>()).sum::<usize>() + kinds + self.tiles.memory_bytes()
    }

    /// Recomputes the peaks of each tile.
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

    /// Plane of a channel by its number: first those of the newest state, then those of the earlier one.
    pub(super) fn plane_mut(&mut self, number: usize) -> &mut Vec<f32> {
        let planes = if number < CHANNELS { &mut self.now } else { &mut self.before };
        &mut planes[number % CHANNELS]
    }

    /// Puts `width × depth` cells from `(i, j)` on to rest, ghosts included.
    pub(super) fn put_to_rest(&mut self, [i, j]: [i64; 2], [width, depth]: [usize; 2]) {
        for row in 0..depth as i64 {
            let at = self.at(i, j + row);
            self.now.iter_mut().chain(&mut self.before).for_each(|plane| plane[at..at + width].fill(0.0));
        }
    }
}

fn read(planes: &Planes, at: usize) -> Bend {
    Bend { theta: planes[0][at], omega: [planes[1][at], planes[2][at]] }
}

/// Writes a state, with 0 for −0: a cell that counts as at rest has the bits of 0.
fn write(planes: &mut Planes, at: usize, bend: Bend) {
    let values = [bend.theta, bend.omega[0], bend.omega[1]].map(|value| value + 0.0);
    planes.iter_mut().zip(values).for_each(|(plane, value)| plane[at] = value);
}
