//! Exchange between patches before a step: wakes patches, chooses the tiles to step, and fills the ghost cells.

use super::halo::{AROUND, Fetch, Neighbour, RestingGhosts, Seams, TileRun, neighbour, ring};
use super::patch::CHANNELS;
use super::tiles::TILE;
use super::{Coefficients, Executor, Field, Patch};
use crate::grid::PatchIndex;

/// The awake neighbours of a patch with their slots, in the order of [`AROUND`].
type Around = [Option<(usize, Neighbour)>; 8];

/// One plane of all patches: of a channel at a time.
#[derive(Debug, Default)]
struct PlaneSet {
    /// Number of the plane, as in [`Patch::plane_mut`].
    number: usize,
    planes: Vec<Vec<f32>>,
}

/// Ghosts that an exchange changes.
#[derive(Debug, Default)]
struct Ghosts {
    filled: Vec<Fetch>,
    resting: Vec<RestingGhosts>,
    /// Runs of tiles in the ring toward one neighbour, and whether they step.
    runs: Vec<(bool, TileRun)>,
}

impl Ghosts {
    /// Empties the lists. There is room for a run of tiles on each side of every patch, so that waves which spread don't enlarge them.
    fn clear(&mut self, patches: usize, tiles: usize) {
        self.filled.clear();
        self.filled.reserve(AROUND.len() * patches);
        self.resting.clear();
        self.resting.reserve(AROUND.len() * patches);
        self.runs.reserve(tiles);
    }
}

/// Lists of a step, kept for their memory. Copies start without them.
#[derive(Debug, Default)]
pub(super) struct Workspace {
    reached: Vec<PatchIndex>,
    around: Vec<Around>,
    ghosts: Ghosts,
    planes: [PlaneSet; 2 * CHANNELS],
    pub(super) coefficients: Vec<Coefficients>,
}

impl Clone for Workspace {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// Fields are equal whatever their workspaces.
impl PartialEq for Workspace {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Field {
    /// Prepares up to `substeps` sub-steps: wakes patches that energy reaches, chooses the tiles to step, and fills the ghosts. Returns the number of
    /// patches that stayed asleep because of the limit.
    pub(super) fn exchange(&mut self, substeps: usize, executor: &impl Executor) -> u32 {
        let mut work = std::mem::take(&mut self.workspace);
        let rest = self.rest;
        executor.for_each(&mut self.patches, |patch| patch.tiles.find_active(rest));
        let refused = if self.seams == Seams::Exact { self.wake_reached(&mut work.reached) } else { 0 };
        self.find_neighbours(&mut work.around);
        if self.seams == Seams::Exact {
            self.mark_active_neighbours(&work.around);
        }
        executor.for_each(&mut self.patches, choose_tiles);
        work.ghosts.clear(self.patches.len(), self.layout.cells as usize / TILE);
        for (own, around) in work.around.iter().enumerate() {
            for (toward, met) in AROUND.into_iter().zip(*around) {
                self.exchange_with(own, toward, met, substeps, &mut work.ghosts);
            }
        }
        self.fill_ghosts(&work.ghosts, &mut work.planes, substeps, executor);
        self.workspace = work;
        refused
    }

    /// Fills the ghosts, plane by plane in parallel: the own cells of a plane only supply ghosts of the same plane. With one sub-step the ghosts of the
    /// earlier state aren't needed.
    fn fill_ghosts(&mut self, ghosts: &Ghosts, sets: &mut [PlaneSet], substeps: usize, executor: &impl Executor) {
        for (number, set) in sets.iter_mut().enumerate() {
            set.number = number;
            set.planes.extend(self.patches.iter_mut().map(|patch| std::mem::take(patch.plane_mut(number))));
        }
        let filled = if substeps > 1 { 2 * CHANNELS } else { CHANNELS };
        executor.for_each(sets, |PlaneSet { number, planes }| {
            if *number < filled {
                ghosts.filled.iter().for_each(|fetch| fetch.fill(planes));
            }
            ghosts.resting.iter().for_each(|resting| resting.clear(planes));
        });
        for (number, set) in sets.iter_mut().enumerate() {
            self.patches.iter_mut().zip(set.planes.drain(..)).for_each(|(patch, plane)| *patch.plane_mut(number) = plane);
        }
    }

    /// Finds the awake neighbours of each awake patch.
    fn find_neighbours(&self, around: &mut Vec<Around>) {
        let met = |patch: &Patch| {
            AROUND.map(|toward| {
                let neighbour = neighbour(&self.layout, self.edges, patch.index(), toward)?;
                Some((self.slot(neighbour.index)?, neighbour))
            })
        };
        around.clear();
        around.extend(self.patches.iter().map(met));
    }

    /// Wakes the neighbours that active tiles touch, in ascending order, up to the limit.
    fn wake_reached(&mut self, reached: &mut Vec<PatchIndex>) -> u32 {
        reached.clear();
        reached.reserve(AROUND.len() * self.patches.len());
        for patch in &self.patches {
            if !patch.tiles.any_active() {
                continue;
            }
            let last = patch.tiles.count() as i64 - 1;
            for toward in AROUND {
                let border = toward.map(|toward| match toward {
                    -1 => 0..=0,
                    0 => 0..=last,
                    _ => last..=last,
                });
                let [columns, rows] = border;
                let is_active = rows.into_iter().any(|z| columns.clone().any(|x| patch.tiles.is_active(x, z)));
                if let (true, Some(neighbour)) = (is_active, neighbour(&self.layout, self.edges, patch.index(), toward)) {
                    reached.push(neighbour.index);
                }
            }
        }
        reached.sort_unstable();
        reached.dedup();
        reached.retain(|&patch| self.slot(patch).is_none());
        let free = self.awake_limit.saturating_sub(self.patches.len());
        reached.iter().take(free).for_each(|&patch| {
            self.wake(patch);
        });
        reached.len().saturating_sub(free) as u32
    }

    /// Marks which tiles are active beyond each patch's border.
    fn mark_active_neighbours(&mut self, around: &[Around]) {
        for (own, around) in around.iter().enumerate() {
            for (toward, met) in AROUND.into_iter().zip(*around) {
                let Some((from, neighbour)) = met else { continue };
                let count = self.patches[own].tiles.count();
                for [x, z] in ring(count, toward) {
                    let [their_x, their_z] = neighbour.place([x, z], toward, count as i64);
                    let active = self.patches[from].tiles.is_active(their_x, their_z);
                    self.patches[own].tiles.set_active(x, z, active);
                }
            }
        }
    }

    /// Finds the ghosts to fill toward one neighbour, where its tiles step, and those to put to rest, where they no longer do.
    fn exchange_with(&mut self, own: usize, toward: [i64; 2], met: Option<(usize, Neighbour)>, rings: usize, ghosts: &mut Ghosts) {
        let count = self.patches[own].tiles.count() as i64;
        let steps_beyond = |patches: &[Patch], [x, z]: [i64; 2]| match (self.seams, met) {
            (Seams::Overlap, _) => patches[own].tiles.steps(x.clamp(0, count - 1), z.clamp(0, count - 1)),
            (Seams::Exact, None) => false,
            (Seams::Exact, Some((from, neighbour))) => {
                let [x, z] = neighbour.place([x, z], toward, count);
                patches[from].tiles.steps(x, z)
            }
        };
        let Ghosts { filled, resting, runs } = ghosts;
        runs.clear();
        for [x, z] in ring(count as usize, toward) {
            let steps = steps_beyond(&self.patches, [x, z]);
            let stepped = self.patches[own].tiles.steps(x, z);
            self.patches[own].tiles.set_steps(x, z, steps);
            if !steps && !stepped {
                continue;
            }
            match runs.last_mut() {
                Some((last, tiles)) if *last == steps && tiles[0].end == x && tiles[1].start == z => tiles[0].end += 1,
                Some((last, tiles)) if *last == steps && tiles[1].end == z && tiles[0].start == x => tiles[1].end += 1,
                _ => runs.push((steps, [x..x + 1, z..z + 1])),
            }
        }
        for (steps, tiles) in runs.drain(..) {
            match (steps, met, self.seams) {
                (true, Some((from, neighbour)), Seams::Exact) => {
                    filled.push(Fetch::new(&self.patches[own], [own, from], toward, &tiles, neighbour, rings));
                }
                (true, ..) => {}
                (false, ..) => resting.push(RestingGhosts::new(&self.patches[own], own, toward, &tiles)),
            }
        }
    }
}

/// Marks active tiles and their neighbours to step; puts the others to rest.
fn choose_tiles(patch: &mut Patch) {
    let count = patch.tiles.count();
    for (x, z) in (0..count).flat_map(|z| (0..count).map(move |x| (x, z))) {
        let (steps, stepped) = (patch.tiles.is_near_active(x, z), patch.tiles.steps(x as i64, z as i64));
        patch.tiles.set_steps(x as i64, z as i64, steps);
        // A tile that has stepped may hold −0.
        if !steps && (stepped || patch.tiles.holds(x, z)) {
            patch.put_to_rest([x, z].map(|n| (n * TILE) as i64), [TILE; 2]);
            patch.tiles.set_peaks(x, z, [0; 2]);
        }
    }
}
