//! Coupling of patches: neighbours, ghost cells, and the ring of tiles around a patch.

use super::patch::{HALO, Patch};
use super::tiles::TILE;
use crate::grid::{PatchIndex, PatchLayout};
use crate::scene::words;
use serde::{Deserialize, Serialize};

words! {
    /// Boundary condition at the edge of the world.
    #[derive(Default)]
    Edges {
        /// Grass at rest (Dirichlet): waves are reflected with opposite sign, as by a fixed end.
        #[default]
        Rest = "rest",
        /// Mirror image (Neumann): waves are reflected as by a free end.
        Free = "free",
        /// Periodic: the world continues at the opposite edge.
        Wrapped = "wrapped",
    }
}

words! {
    /// Coupling of neighbouring patches.
    #[derive(Default)]
    Seams {
        /// Ghost cells are exchanged: a field of many patches equals one big grid, bit for bit.
        #[default]
        Exact = "exact",
        /// The overlaps of Chen & Johan §4.2: each patch simulates 4 extra cells on every side, the outermost at rest, and exchanges nothing with its
        /// neighbours; only contact changes both.
        Overlap = "overlap",
    }
}

/// The eight directions in which a patch has neighbours.
pub(super) const AROUND: [[i64; 2]; 8] = [[-1, -1], [0, -1], [1, -1], [-1, 0], [1, 0], [-1, 1], [0, 1], [1, 1]];

/// Neighbour of a patch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Neighbour {
    pub(super) index: PatchIndex,
    /// Axes along which it is the patch's mirror image.
    mirrored: [bool; 2],
}

impl Neighbour {
    /// Maps a tile in the ring of this patch to the neighbour's tile; `count` tiles a side.
    pub(super) fn place(&self, tile: [i64; 2], toward: [i64; 2], count: i64) -> [i64; 2] {
        [0, 1].map(|axis| theirs(tile[axis], toward[axis], count, self.mirrored[axis]))
    }
}

/// The neighbour in a direction, if the world has one there.
pub(super) fn neighbour(layout: &PatchLayout, edges: Edges, patch: PatchIndex, toward: [i64; 2]) -> Option<Neighbour> {
    let place = layout.place(patch).map(i64::from);
    let count = layout.count.map(i64::from);
    let mut to = [place[0] + toward[0], place[1] + toward[1]];
    let mut mirrored = [false; 2];
    for axis in 0..2 {
        if !(0..count[axis]).contains(&to[axis]) {
            match edges {
                Edges::Rest => return None,
                Edges::Wrapped => to[axis] = to[axis].rem_euclid(count[axis]),
                Edges::Free => (to[axis], mirrored[axis]) = (place[axis], true),
            }
        }
    }
    layout.index(to[0], to[1]).map(|index| Neighbour { index, mirrored })
}

/// Index of the cell that supplies the value beyond an edge of the world, along one axis of `count` cells; the outermost for edges at rest.
pub(super) fn source(edges: Edges, at: i64, count: i64) -> i64 {
    match edges {
        Edges::Rest => at.clamp(0, count - 1),
        Edges::Wrapped => at.rem_euclid(count),
        Edges::Free if at < 0 => -1 - at,
        Edges::Free if at >= count => 2 * count - 1 - at,
        Edges::Free => at,
    }
}

/// Indices along one axis on the side `toward`: −`width..0` for −1, `0..count` for 0, `count..count + width` for 1.
fn ghosts(toward: i64, count: i64, width: i64) -> std::ops::Range<i64> {
    match toward {
        -1 => -width..0,
        0 => 0..count,
        _ => count..count + width,
    }
}

/// Converts an index beyond the border of this patch to the neighbour's index.
fn theirs(at: i64, toward: i64, count: i64, mirrored: bool) -> i64 {
    match (toward, mirrored) {
        (0, _) => at,
        (-1, true) => -1 - at,
        (_, true) => 2 * count - 1 - at,
        _ => at - toward * count,
    }
}

/// Tiles of our ring toward a neighbour.
pub(super) fn ring(count: usize, toward: [i64; 2]) -> impl Iterator<Item = [i64; 2]> {
    let range = move |axis: usize| ghosts(toward[axis], count as i64, 1);
    range(1).flat_map(move |z| range(0).map(move |x| [x, z]))
}

/// Tiles of the ring toward a neighbour, from the first to one past the last, along both axes.
pub(super) type TileRun = [std::ops::Range<i64>; 2];

/// Ghost cells of ring tiles, `rings` wide: our columns and rows.
fn cells(tiles: &TileRun, toward: [i64; 2], side: i64, rings: usize) -> [std::ops::Range<i64>; 2] {
    [0, 1].map(|axis| match toward[axis] {
        0 => tiles[axis].start * TILE as i64..tiles[axis].end * TILE as i64,
        toward => ghosts(toward, side, rings as i64),
    })
}

/// Ghosts of one patch that are filled from a neighbour: rows of equal width, the same in every plane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fetch {
    /// Slots of the patch and of the neighbour.
    own: usize,
    from: usize,
    /// Index of the first ghost in the first row, and of the cell from which the leftmost one of the row, or the rightmost if `is_reversed`, is filled.
    target: usize,
    source: usize,
    /// Distance between the neighbour's rows, and whether it is downwards.
    rows_apart: usize,
    goes_down: bool,
    rows: usize,
    width: usize,
    is_reversed: bool,
}

impl Fetch {
    /// Ghosts of ring tiles of `patch`, in slot `own`, from the neighbour in slot `from`: `rings` rings.
    pub(super) fn new(
        patch: &Patch,
        [own, from]: [usize; 2],
        toward: [i64; 2],
        tiles: &TileRun,
        neighbour: Neighbour,
        rings: usize,
    ) -> Self {
        let side = patch.side() as i64;
        let [columns, rows] = cells(tiles, toward, side, rings);
        let is_reversed = toward[0] != 0 && neighbour.mirrored[0];
        let first_column = if is_reversed { columns.end - 1 } else { columns.start };
        let their_column = theirs(first_column, toward[0], side, neighbour.mirrored[0]);
        Self {
            own,
            from,
            target: patch.at(columns.start, rows.start),
            source: patch.at(their_column, theirs(rows.start, toward[1], side, neighbour.mirrored[1])),
            rows_apart: patch.stride(),
            goes_down: toward[1] == 0 || !neighbour.mirrored[1],
            rows: (rows.end - rows.start) as usize,
            width: (columns.end - columns.start) as usize,
            is_reversed,
        }
    }

    /// Fills the ghosts in one plane, given that plane of all patches.
    pub(super) fn fill(&self, planes: &mut [Vec<f32>]) {
        for row in 0..self.rows {
            let by = row * self.rows_apart;
            let (source, target) = (if self.goes_down { self.source + by } else { self.source - by }, self.target + by);
            let ghosts = target..target + self.width;
            if self.own == self.from {
                planes[self.own].copy_within(source..source + self.width, target);
            } else {
                let Ok([own, from]) = planes.get_disjoint_mut([self.own, self.from]) else { unreachable!("two patches of one field") };
                copy(&from[source..source + self.width], &mut own[ghosts.clone()]);
            }
            if self.is_reversed {
                planes[self.own][ghosts].reverse();
            }
        }
    }
}

/// Copies a row of ghosts; rows beside a patch are too short to be worth a call.
fn copy(from: &[f32], to: &mut [f32]) {
    match (from, to) {
        ([from], [to]) => *to = *from,
        (from, to) if from.len() == HALO && to.len() == HALO => to.iter_mut().zip(from).take(HALO).for_each(|(to, from)| *to = *from),
        (from, to) => to.copy_from_slice(from),
    }
}

/// Ghosts of one patch that are put to rest.
#[derive(Clone, Copy, Debug)]
pub(super) struct RestingGhosts {
    own: usize,
    first: usize,
    rows_apart: usize,
    rows: usize,
    width: usize,
}

impl RestingGhosts {
    /// Ghosts of ring tiles of `patch`, in slot `own`.
    pub(super) fn new(patch: &Patch, own: usize, toward: [i64; 2], tiles: &TileRun) -> Self {
        let [columns, rows] = cells(tiles, toward, patch.side() as i64, HALO);
        Self {
            own,
            first: patch.at(columns.start, rows.start),
            rows_apart: patch.stride(),
            rows: (rows.end - rows.start) as usize,
            width: (columns.end - columns.start) as usize,
        }
    }

    /// Puts the ghosts in one plane to rest, given that plane of all patches.
    pub(super) fn clear(&self, planes: &mut [Vec<f32>]) {
        for row in 0..self.rows {
            planes[self.own][self.first + row * self.rows_apart..][..self.width].fill(0.0);
        }
    }
}
