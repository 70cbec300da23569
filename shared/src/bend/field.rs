//! The whole field: the awake patches, and the step.

use super::halo::{AROUND, Edges, Neighbour, Seams, TileRun, fetch, neighbour, quell, ring, source};
use super::limits::{SUBSTEPS_LIMIT, courant_share, substeps};
use super::tiles::{Rest, TILE};
use super::verlet::{self, Pass, SIDE_LIMIT};
use super::{Bend, Coefficients, Crew, Damping, HALO, Kinds, Patch, Report, Scheme, StepError, implicit, modal};
use crate::grid::{PatchIndex, PatchLayout};

/// The bend field of a world. A patch that is not awake is at rest and holds no memory, however large the world.
///
/// Energy that reaches the border of a patch wakes its neighbour, up to [`awake_limit`](Self::with_awake_limit). With [`Seams::Exact`] and
/// [`Rest::EXACT`] the field equals one big grid bit for bit, in whatever order its patches wake.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    pub(super) layout: PatchLayout,
    pub(super) kinds: Kinds,
    pub(super) edges: Edges,
    pub(super) seams: Seams,
    rest: Rest,
    awake_limit: usize,
    /// Awake patches, ascending by index.
    pub(super) patches: Vec<Patch>,
    /// Time between the two states that every patch holds (s); none before the first step.
    pub(super) dt_secs: Option<f32>,
}

impl Field {
    /// A field at rest, all patches asleep; at its edges grass at rest, seams exact, only zero at rest, any number of patches awake.
    ///
    /// # Panics
    /// When the cells along the side of a patch are no multiple of 8 from 8 to 256.
    pub fn new(layout: PatchLayout, kinds: Kinds) -> Self {
        let cells = layout.cells as usize;
        assert!(cells.is_multiple_of(TILE) && (TILE..=SIDE_LIMIT).contains(&cells), "{cells} cells along a side");
        Self {
            layout,
            kinds,
            edges: Edges::default(),
            seams: Seams::default(),
            rest: Rest::EXACT,
            awake_limit: usize::MAX,
            patches: vec![],
            dt_secs: None,
        }
    }

    /// The same with other edges.
    pub fn with_edges(self, edges: Edges) -> Self {
        Self { edges, ..self }
    }

    /// The same with other seams.
    pub fn with_seams(self, seams: Seams) -> Self {
        Self { seams, ..self }
    }

    /// The same with another tolerance.
    pub fn with_rest(self, rest: Rest) -> Self {
        Self { rest, ..self }
    }

    /// The same with a bound on the patches that are awake: no energy wakes more.
    pub fn with_awake_limit(self, awake_limit: usize) -> Self {
        Self { awake_limit, ..self }
    }

    /// Shape and spacing.
    pub fn layout(&self) -> &PatchLayout {
        &self.layout
    }

    /// What grows where.
    pub fn kinds(&self) -> &Kinds {
        &self.kinds
    }

    /// Number of awake patches.
    pub fn awake_count(&self) -> usize {
        self.patches.len()
    }

    /// Awake patches, ascending by index.
    pub fn awake(&self) -> impl Iterator<Item = &Patch> {
        self.patches.iter()
    }

    /// Awake patches, to be changed.
    pub fn awake_mut(&mut self) -> impl Iterator<Item = &mut Patch> {
        self.patches.iter_mut()
    }

    pub(super) fn slot(&self, patch: PatchIndex) -> Option<usize> {
        self.patches.binary_search_by_key(&patch, Patch::index).ok()
    }

    /// The patch, if it is awake.
    pub fn patch(&self, patch: PatchIndex) -> Option<&Patch> {
        self.slot(patch).map(|slot| &self.patches[slot])
    }

    /// The patch to be changed, if it is awake.
    pub fn patch_mut(&mut self, patch: PatchIndex) -> Option<&mut Patch> {
        self.slot(patch).map(|slot| &mut self.patches[slot])
    }

    /// The patch to be changed, woken if it slept.
    ///
    /// # Panics
    /// When the world has no such patch.
    pub fn wake(&mut self, patch: PatchIndex) -> &mut Patch {
        let slot = self.patches.binary_search_by_key(&patch, Patch::index).unwrap_or_else(|slot| {
            assert!((patch as usize) < self.layout.patches(), "patch {patch} of {}", self.layout.patches());
            let (layout, kinds, edges, cells) = (&self.layout, &self.kinds, self.edges, i64::from(self.layout.cells));
            let corner = layout.place(patch).map(|n| i64::from(n) * cells);
            let along = |axis: usize, at: i64| source(edges, corner[axis] + at, i64::from(layout.count[axis]) * cells);
            // Ghosts advance as the cells that they stand for, also beyond the edge of the world.
            let kind = |[i, j]: [i64; 2]| kinds.kind(layout, [along(0, i), along(1, j)]);
            self.patches.insert(slot, Patch::new(patch, cells as usize, kind));
            slot
        });
        &mut self.patches[slot]
    }

    /// Wakes every patch of the world.
    pub fn wake_all(&mut self) {
        (0..self.layout.patches() as PatchIndex).for_each(|patch| {
            self.wake(patch);
        });
    }

    /// Lets a patch go; it is at rest from now on.
    pub fn sleep(&mut self, patch: PatchIndex) {
        if let Some(slot) = self.slot(patch) {
            self.patches.remove(slot);
        }
    }

    /// Lets every patch go in which all cells are at rest to within the tolerance and that no loud neighbour touches, but for those to be
    /// kept.
    pub fn sleep_quiet(&mut self, keep: impl Fn(PatchIndex) -> bool) {
        self.patches.retain(|patch| !patch.tiles.is_still() || patch.tiles.hears_any() || keep(patch.index()));
    }

    /// The patch that holds cell `(x, z)` of the world, and the cell's place in it.
    pub fn locate(&self, cell: [i64; 2]) -> Option<(PatchIndex, [usize; 2])> {
        let cells = i64::from(self.layout.cells);
        let patch = self.layout.index(cell[0].div_euclid(cells), cell[1].div_euclid(cells))?;
        Some((patch, cell.map(|n| n.rem_euclid(cells) as usize)))
    }

    /// State of cell `(x, z)` of the world; at rest where its patch sleeps and outside the world.
    pub fn cell(&self, cell: [i64; 2]) -> Bend {
        let state = |(patch, [i, j]): (PatchIndex, [usize; 2])| self.patch(patch).map(|patch| patch.bend(i, j));
        self.locate(cell).and_then(state).unwrap_or_default()
    }

    /// State at `(x_m, z_m)`: that of the cell there; at rest where the patch sleeps and outside the world.
    pub fn bend_at(&self, x_m: f32, z_m: f32) -> Bend {
        self.cell([x_m, z_m].map(|m| (m / self.layout.cell_m).floor() as i64))
    }

    /// Sets a cell of an awake patch as contact does, in the overlaps of its neighbours, too, where patches overlap.
    pub fn press(&mut self, cell: [i64; 2], bend: Bend) {
        let Some((patch, [i, j])) = self.locate(cell) else { return };
        if let Some(patch) = self.patch_mut(patch) {
            patch.press(i, j, bend);
        }
        if self.seams == Seams::Exact {
            return;
        }
        let (side, halo) = (i64::from(self.layout.cells), HALO as i64);
        for toward in AROUND {
            let beyond = [i as i64 - toward[0] * side, j as i64 - toward[1] * side];
            // The outermost ring of an overlap stays at rest.
            let overlaps = beyond.iter().all(|n| (1 - halo..side + halo - 1).contains(n));
            let slot = neighbour(&self.layout, Edges::Rest, patch, toward).and_then(|neighbour| self.slot(neighbour.index));
            if let (true, Some(slot)) = (overlaps, slot) {
                self.patches[slot].set_ghost(beyond[0], beyond[1], bend, bend);
            }
        }
    }

    /// Sets all cells of the world, waking every patch: for the centre of each cell (m) its state now and `dt_secs` ago. A wave that is to
    /// move starts with both; steps of the same length keep its motion exactly.
    pub fn start(&mut self, dt_secs: f32, state: impl Fn([f32; 2]) -> [Bend; 2]) {
        self.wake_all();
        let layout = self.layout;
        for patch in &mut self.patches {
            let (corner_m, side) = (layout.corner_m(patch.index()), patch.side());
            for (i, j) in (0..side).flat_map(|j| (0..side).map(move |i| (i, j))) {
                let at_m = [(i as f32 + 0.5) * layout.cell_m + corner_m[0], (j as f32 + 0.5) * layout.cell_m + corner_m[1]];
                let [now, before] = state(at_m);
                patch.set(i, j, now, before);
            }
        }
        self.dt_secs = Some(dt_secs);
    }

    /// Largest bending speed of any cell (rad/s).
    pub fn omega_max_rad_per_s(&self) -> f32 {
        self.patches.iter().map(Patch::omega_max_rad_per_s).fold(0.0, f32::max)
    }

    /// Bytes of memory that the awake patches hold.
    pub fn memory_bytes(&self) -> usize {
        self.patches.iter().map(|patch| size_of::<Patch>() + patch.memory_bytes()).sum()
    }

    /// Length of step (s) up to which an explicit scheme keeps every mode bounded, at the present bending speeds: of [`Scheme::Verlet`] as it
    /// stands, of the others with damping taken exactly.
    pub fn stable_dt_secs(&self, scheme: Scheme) -> f32 {
        let omega_max = self.omega_max_rad_per_s();
        let damping = if scheme == Scheme::Verlet { Damping::Plain } else { Damping::Exact };
        let share = |dt_secs: f32| {
            let k = |waves| courant_share(&Coefficients::new(waves, self.layout.cell_m, dt_secs, damping), omega_max);
            self.kinds.waves().iter().map(k).fold(0.0, f32::max)
        };
        let (mut stable, mut unstable) = (0.0, 1.0);
        while share(unstable) <= 1.0 && unstable < 1e6 {
            (stable, unstable) = (unstable, 2.0 * unstable);
        }
        for _ in 0..24 {
            let middle = 0.5 * (stable + unstable);
            if share(middle) <= 1.0 { stable = middle } else { unstable = middle }
        }
        stable
    }

    /// Advances the field by `dt_secs`.
    ///
    /// # Errors
    /// [`StepError`] when the scheme cannot be used here or would need too many sub-steps; the field is as it was, but for patches in which
    /// a value was no number: these go to rest first.
    pub fn step(&mut self, scheme: Scheme, dt_secs: f32, crew: &impl Crew) -> Result<Report, StepError> {
        if !(dt_secs.is_finite() && dt_secs > 0.0) {
            return Err(StepError::NoStep { dt_secs });
        }
        let awake = self.patches.len();
        self.patches.retain(|patch| patch.theta_max_rad().is_finite() && patch.omega_max_rad_per_s().is_finite());
        let broken = (awake - self.patches.len()) as u32;
        let report = match scheme {
            Scheme::Verlet => self.explicit(1, Damping::Plain, dt_secs, crew),
            Scheme::Substepped => self.explicit(self.substeps(dt_secs)?, Damping::Exact, dt_secs, crew),
            Scheme::Implicit => implicit::step(self, dt_secs, crew),
            Scheme::Modal => modal::step(self, dt_secs)?,
        };
        Ok(Report { broken, ..report })
    }

    /// Sub-steps that [`Scheme::Substepped`] takes in `dt_secs` at the present bending speeds.
    fn substeps(&self, dt_secs: f32) -> Result<u32, StepError> {
        let omega_max = self.omega_max_rad_per_s();
        substeps(self.kinds.waves(), self.layout.cell_m, dt_secs, omega_max, Damping::Exact).ok_or(StepError::TooFast {
            omega_rad_per_s: omega_max,
            allowed: SUBSTEPS_LIMIT,
            dt_secs,
        })
    }

    fn explicit(&mut self, count: u32, damping: Damping, dt_secs: f32, crew: &impl Crew) -> Report {
        let substep_secs = dt_secs / count as f32;
        let coefficients = |waves| Coefficients::new(waves, self.layout.cell_m, substep_secs, damping);
        let kinds: Vec<_> = self.kinds.waves().iter().map(coefficients).collect();
        let omega_max = self.omega_max_rad_per_s();
        let mut report = Report {
            substeps: count,
            courant_share: kinds.iter().map(|k| courant_share(k, omega_max)).fold(0.0, f32::max),
            ..Report::default()
        };
        let mut ratio = self.dt_secs.replace(substep_secs).map_or(1.0, |last| substep_secs / last);
        let mut left = count as usize;
        while left > 0 {
            let substeps = left.min(HALO);
            report.refused += self.meet(substeps);
            let rings = (self.seams == Seams::Overlap).then_some(HALO - 1);
            let pass = Pass { kinds: &kinds, substeps, ratio, rings };
            report.cell_steps += self.advance(crew, |patch| verlet::advance(patch, &pass));
            (left, ratio) = (left - substeps, 1.0);
        }
        report
    }

    /// Lets `act` change every patch of which a tile steps; returns the sum of what it counts.
    pub(super) fn advance(&mut self, crew: &impl Crew, act: impl Fn(&mut Patch) -> u64 + Send + Sync) -> u64 {
        let mut counts = vec![0; self.patches.len()];
        let tasks: Vec<_> = self.patches.iter_mut().zip(&mut counts).filter(|(patch, _)| patch.tiles.hears_any()).collect();
        crew.for_each(tasks, |(patch, count)| *count = act(patch));
        counts.iter().sum()
    }

    /// Before up to `substeps` sub-steps: wakes patches that energy reaches, chooses the tiles that step, fills the ghosts. Returns how many
    /// patches stayed asleep for the limit.
    pub(super) fn meet(&mut self, substeps: usize) -> u32 {
        self.patches.iter_mut().for_each(|patch| patch.tiles.listen(self.rest));
        let refused = if self.seams == Seams::Exact { self.wake_reached() } else { 0 };
        let around = self.neighbours();
        if self.seams == Seams::Exact {
            self.hear_neighbours(&around);
        }
        self.patches.iter_mut().for_each(choose_tiles);
        for (own, around) in around.iter().enumerate() {
            for (toward, met) in AROUND.into_iter().zip(*around) {
                self.meet_neighbour(own, toward, met, substeps);
            }
        }
        refused
    }

    /// Neighbours of each awake patch that are awake, too, with their places.
    fn neighbours(&self) -> Vec<[Option<(usize, Neighbour)>; 8]> {
        let met = |patch: &Patch| {
            AROUND.map(|toward| {
                let neighbour = neighbour(&self.layout, self.edges, patch.index(), toward)?;
                Some((self.slot(neighbour.index)?, neighbour))
            })
        };
        self.patches.iter().map(met).collect()
    }

    /// Wakes the neighbours that loud tiles touch, ascending by index, as far as the limit goes.
    fn wake_reached(&mut self) -> u32 {
        let mut reached = vec![];
        for patch in &self.patches {
            if !patch.tiles.hears_any() {
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
                let is_loud = rows.into_iter().any(|z| columns.clone().any(|x| patch.tiles.is_loud(x, z)));
                if let (true, Some(neighbour)) = (is_loud, neighbour(&self.layout, self.edges, patch.index(), toward)) {
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

    /// Tells each patch which tiles are loud beyond its border.
    fn hear_neighbours(&mut self, around: &[[Option<(usize, Neighbour)>; 8]]) {
        for (own, around) in around.iter().enumerate() {
            for (toward, met) in AROUND.into_iter().zip(*around) {
                let Some((from, neighbour)) = met else { continue };
                let count = self.patches[own].tiles.count();
                for [x, z] in ring(count, toward) {
                    let [their_x, their_z] = neighbour.place([x, z], toward, count as i64);
                    let loud = self.patches[from].tiles.is_loud(their_x, their_z);
                    self.patches[own].tiles.set_loud(x, z, loud);
                }
            }
        }
    }

    /// Fills the ghosts toward one neighbour where its tiles step, and puts those to rest that stepped before.
    fn meet_neighbour(&mut self, own: usize, toward: [i64; 2], met: Option<(usize, Neighbour)>, rings: usize) {
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
                (true, Some((from, neighbour)), Seams::Exact) => fetch(&mut self.patches, own, from, toward, &tiles, neighbour, rings),
                (true, ..) => {}
                (false, ..) => quell(&mut self.patches[own], toward, &tiles),
            }
        }
    }
}

/// Lets loud tiles and those around them step; puts the others to rest.
fn choose_tiles(patch: &mut Patch) {
    let count = patch.tiles.count();
    for (x, z) in (0..count).flat_map(|z| (0..count).map(move |x| (x, z))) {
        let steps = patch.tiles.hears(x, z);
        patch.tiles.set_steps(x as i64, z as i64, steps);
        if !steps && patch.tiles.holds(x, z) {
            patch.quell([x, z].map(|n| (n * TILE) as i64), [TILE; 2]);
            patch.tiles.set_peaks(x, z, [0; 2]);
        }
    }
}
