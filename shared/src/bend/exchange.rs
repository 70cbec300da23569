//! Exchange between patches before a step: wakes patches, chooses the tiles to step, and fills the ghost cells.

use super::halo::{AROUND, Fetch, Neighbour, RestingGhosts, Seams, TileRun, neighbour, ring};
use super::patch::CHANNELS;
use super::tiles::TILE;
use super::{Executor, Field, Patch};

impl Field {
    /// Applies `act` to every patch with an active tile; returns the sum of its results.
    pub(super) fn advance(&mut self, executor: &impl Executor, act: impl Fn(&mut Patch) -> u64 + Send + Sync) -> u64 {
        let mut counts = vec![0; self.patches.len()];
        let tasks: Vec<_> = self.patches.iter_mut().zip(&mut counts).filter(|(patch, _)| patch.tiles.any_active()).collect();
        executor.for_each(tasks, |(patch, count)| *count = act(patch));
        counts.iter().sum()
    }

    /// Prepares up to `substeps` sub-steps: wakes patches that energy reaches, chooses the tiles to step, and fills the ghosts. Returns the number of
    /// patches that stayed asleep because of the limit.
    pub(super) fn exchange(&mut self, substeps: usize, executor: &impl Executor) -> u32 {
        let rest = self.rest;
        executor.for_each(self.patches.iter_mut().collect(), |patch: &mut Patch| patch.tiles.find_active(rest));
        let refused = if self.seams == Seams::Exact { self.wake_reached() } else { 0 };
        let around = self.neighbours();
        if self.seams == Seams::Exact {
            self.mark_active_neighbours(&around);
        }
        executor.for_each(self.patches.iter_mut().collect(), choose_tiles);
        let mut ghosts = Ghosts::default();
        for (own, around) in around.iter().enumerate() {
            for (toward, met) in AROUND.into_iter().zip(*around) {
                self.exchange_with(own, toward, met, substeps, &mut ghosts);
            }
        }
        self.fill_ghosts(&ghosts, substeps, executor);
        refused
    }

    /// Fills the ghosts, plane by plane in parallel: the own cells of a plane only supply ghosts of the same plane. With one sub-step the ghosts of the
    /// earlier state aren't needed.
    fn fill_ghosts(&mut self, ghosts: &Ghosts, substeps: usize, executor: &impl Executor) {
        let mut planes: [Vec<&mut [f32]>; 2 * CHANNELS] = Default::default();
        for patch in &mut self.patches {
            planes.iter_mut().zip(patch.planes_mut(2)).for_each(|(planes, plane)| planes.push(plane));
        }
        let filled = if substeps > 1 { 2 * CHANNELS } else { CHANNELS };
        executor.for_each(planes.iter_mut().enumerate().collect(), |(number, planes)| {
            if number < filled {
                ghosts.filled.iter().for_each(|fetch| fetch.fill(planes));
            }
            ghosts.resting.iter().for_each(|resting| resting.clear(planes));
        });
    }

    /// The awake neighbours of each awake patch, with their slots.
    fn neighbours(&self) -> Vec<[Option<(usize, Neighbour)>; 8]> {
        let met = |patch: &Patch| {
            AROUND.map(|toward| {
                let neighbour = neighbour(&self.layout, self.edges, patch.index(), toward)?;
                Some((self.slot(neighbour.index)?, neighbour))
            })
        };
        self.patches.iter().map(met).collect()
    }

    /// Wakes the neighbours that active tiles touch, in ascending order, up to the limit.
    fn wake_reached(&mut self) -> u32 {
        let mut reached = vec![];
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
    fn mark_active_neighbours(&mut self, around: &[[Option<(usize, Neighbour)>; 8]]) {
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
        let mut runs: Vec<(bool, TileRun)> = vec![];
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
        for (steps, tiles) in runs {
            match (steps, met, self.seams) {
                (true, Some((from, neighbour)), Seams::Exact) => {
                    ghosts.filled.push(Fetch::new(&self.patches[own], [own, from], toward, &tiles, neighbour, rings));
                }
                (true, ..) => {}
                (false, ..) => ghosts.resting.push(RestingGhosts::new(&self.patches[own], own, toward, &tiles)),
            }
        }
    }
}

/// Ghosts that an exchange changes.
#[derive(Default)]
struct Ghosts {
    filled: Vec<Fetch>,
    resting: Vec<RestingGhosts>,
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
