//! The field: awake patches and their state.

use super::exchange::Workspace;
use super::halo::{AROUND, Edges, Seams, neighbour, source};
use super::limits::courant_fraction;
use super::tiles::{Rest, TILE};
use super::verlet::SIDE_LIMIT;
use super::{Bend, Coefficients, Damping, GroundContact, HALO, Kinds, Patch, Scheme};
use crate::grid::{PatchIndex, PatchLayout};

/// Bend field of a world. A patch that is not awake is at rest and uses no memory, however large the world.
///
/// Energy that reaches the border of a patch wakes its neighbour, up to [`awake_limit`](Self::with_awake_limit). With [`Seams::Exact`] and
/// [`Rest::EXACT`] the field equals one big grid bit for bit, in whatever order its patches wake.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    pub(super) layout: PatchLayout,
    pub(super) kinds: Kinds,
    pub(super) edges: Edges,
    pub(super) seams: Seams,
    pub(super) rest: Rest,
    pub(super) awake_limit: usize,
    pub(super) ground_contact: GroundContact,
    /// Awake patches, ascending by index.
    pub(super) patches: Vec<Patch>,
    /// Time between the two states that every patch holds (s); `None` before the first step.
    pub(super) dt_secs: Option<f32>,
    pub(super) revision: Revision,
    pub(super) workspace: Workspace,
}

/// Number of completed steps. Fields are equal if their cells are, whatever their history.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Revision(pub(super) u64);

impl PartialEq for Revision {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Field {
    /// A field at rest with all patches asleep. Defaults: edges at rest, exact seams, only zero counts as at rest, no
    /// limit on awake patches, no contact with the ground.
    ///
    /// # Panics
    /// When the cells along the side of a patch are not a multiple of 8 in 8..=256.
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
            ground_contact: GroundContact::None,
            patches: vec![],
            dt_secs: None,
            revision: Revision::default(),
            workspace: Workspace::default(),
        }
    }

    /// Sets the boundary condition at the edges of the world.
    pub fn with_edges(self, edges: Edges) -> Self {
        Self { edges, ..self }
    }

    /// Sets how patches are coupled.
    pub fn with_seams(self, seams: Seams) -> Self {
        Self { seams, ..self }
    }

    /// Sets the tolerance within which a tile counts as at rest.
    pub fn with_rest(self, rest: Rest) -> Self {
        Self { rest, ..self }
    }

    /// Limits the number of awake patches: beyond it, energy wakes no more.
    pub fn with_awake_limit(self, awake_limit: usize) -> Self {
        Self { awake_limit, ..self }
    }

    /// Sets how grass that is bent to a right angle meets the ground, in every scheme.
    pub fn with_ground_contact(self, ground_contact: GroundContact) -> Self {
        Self { ground_contact, ..self }
    }

    /// Shape and spacing of the patches.
    pub fn layout(&self) -> &PatchLayout {
        &self.layout
    }

    /// Kinds of grass and where each grows.
    pub fn kinds(&self) -> &Kinds {
        &self.kinds
    }

    /// Number of completed steps. Pass it to [`Patch::changed_since`] later to find the tiles that have changed.
    pub fn revision(&self) -> u64 {
        self.revision.0
    }

    /// Time between the two states that every patch holds (s), the last sub-step; `None` before the first step.
    pub(crate) fn between_states_secs(&self) -> Option<f32> {
        self.dt_secs
    }

    /// Sets the time between the two states that every patch holds (s): their motion is then another one.
    pub fn set_between_states(&mut self, secs: f32) {
        self.dt_secs = Some(secs);
    }

    /// Number of awake patches.
    pub fn awake_count(&self) -> usize {
        self.patches.len()
    }

    /// Awake patches, ascending by index.
    pub fn awake(&self) -> impl Iterator<Item = &Patch> {
        self.patches.iter()
    }

    /// Mutable access to the awake patches, ascending by index.
    pub(crate) fn awake_mut(&mut self) -> impl Iterator<Item = &mut Patch> {
        self.patches.iter_mut()
    }

    pub(super) fn slot(&self, patch: PatchIndex) -> Option<usize> {
        self.patches.binary_search_by_key(&patch, Patch::index).ok()
    }

    /// The patch, if it is awake.
    pub fn patch(&self, patch: PatchIndex) -> Option<&Patch> {
        self.slot(patch).map(|slot| &self.patches[slot])
    }

    /// Mutable access to the patch, if it is awake.
    pub fn patch_mut(&mut self, patch: PatchIndex) -> Option<&mut Patch> {
        self.slot(patch).map(|slot| &mut self.patches[slot])
    }

    /// Mutable access to the patch; wakes it if needed.
    ///
    /// # Panics
    /// When the world has no such patch.
    pub fn wake(&mut self, patch: PatchIndex) -> &mut Patch {
        let slot = self.patches.binary_search_by_key(&patch, Patch::index).unwrap_or_else(|slot| {
            assert!((patch as usize) < self.layout.patches(), "patch {patch} of {}", self.layout.patches());
            let (layout, kinds, edges, cells) = (&self.layout, &self.kinds, self.edges, i64::from(self.layout.cells));
            let corner = layout.place(patch).map(|n| i64::from(n) * cells);
            let along = |axis: usize, at: i64| source(edges, corner[axis] + at, i64::from(layout.count[axis]) * cells);
            // Ghosts advance like the cells that they mirror, also beyond the edge of the world.
            let kind = |[i, j]: [i64; 2]| kinds.kind(layout, [along(0, i), along(1, j)]);
            self.patches.insert(slot, Patch::new(patch, cells as usize, self.revision.0, kind));
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

    /// Puts a patch to rest and frees its memory.
    pub fn sleep(&mut self, patch: PatchIndex) {
        if let Some(slot) = self.slot(patch) {
            self.patches.remove(slot);
        }
    }

    /// A copy of the field around a patch: of it and its neighbours.
    pub fn around(&self, patch: PatchIndex) -> Self {
        let near = |toward| neighbour(&self.layout, self.edges, patch, toward).map(|neighbour| neighbour.index);
        let kept: Vec<_> = AROUND.into_iter().filter_map(near).chain([patch]).collect();
        Self {
            layout: self.layout,
            kinds: self.kinds.clone(),
            patches: self.patches.iter().filter(|patch| kept.contains(&patch.index())).cloned().collect(),
            workspace: Workspace::default(),
            ..*self
        }
    }

    /// Frees every patch whose cells are all at rest within the tolerance and that has no active neighbour, unless `keep` is true for it.
    pub fn sleep_quiet(&mut self, keep: impl Fn(PatchIndex) -> bool) {
        self.patches.retain(|patch| !patch.tiles.is_still() || patch.tiles.any_active() || keep(patch.index()));
    }

    /// The patch that contains cell `(x, z)` of the world, and the cell's position in the patch.
    pub fn locate(&self, cell: [i64; 2]) -> Option<(PatchIndex, [usize; 2])> {
        let cells = i64::from(self.layout.cells);
        let patch = self.layout.index(cell[0].div_euclid(cells), cell[1].div_euclid(cells))?;
        Some((patch, cell.map(|n| n.rem_euclid(cells) as usize)))
    }

    /// State of cell `(x, z)` of the world; at rest if its patch sleeps or the cell is outside the world.
    pub fn cell(&self, cell: [i64; 2]) -> Bend {
        let state = |(patch, [i, j]): (PatchIndex, [usize; 2])| self.patch(patch).map(|patch| patch.bend(i, j));
        self.locate(cell).and_then(state).unwrap_or_default()
    }

    /// State of the cell at `(x_m, z_m)`; at rest if its patch sleeps or the position is outside the world.
    pub fn bend_at(&self, x_m: f32, z_m: f32) -> Bend {
        self.cell([x_m, z_m].map(|m| (m / self.layout.cell_m).floor() as i64))
    }

    /// Sets a cell of an awake patch as contact does; with overlapping seams also in its neighbours' overlaps.
    pub fn press(&mut self, cell: [i64; 2], bend: Bend) {
        let Some((patch, [i, j])) = self.locate(cell) else { return };
        if let Some(patch) = self.patch_mut(patch) {
            patch.press(i, j, bend);
        }
        if self.has_overlaps() {
            self.press_overlaps(cell, bend);
        }
    }

    /// Whether patches have overlaps, in which contact sets the cells of their neighbours, too.
    pub(crate) fn has_overlaps(&self) -> bool {
        self.seams == Seams::Overlap
    }

    /// Sets a cell in the overlaps of the awake neighbours of its patch.
    pub(crate) fn press_overlaps(&mut self, cell: [i64; 2], bend: Bend) {
        let Some((patch, [i, j])) = self.locate(cell) else { return };
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

    /// Sets all cells of the world and wakes every patch: `state` gives, for the centre of each cell (m), the state now and `dt_secs` ago. A moving
    /// wave needs both; steps of the same length then keep its motion exactly.
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

    /// Largest bending velocity of any cell (rad/s).
    pub fn omega_max_rad_per_s(&self) -> f32 {
        self.patches.iter().map(Patch::omega_max_rad_per_s).fold(0.0, f32::max)
    }

    /// Memory held by the awake patches (bytes).
    pub fn memory_bytes(&self) -> usize {
        self.patches.iter().map(|patch| size_of::<Patch>() + patch.memory_bytes()).sum()
    }

    /// Longest step (s) at which an explicit scheme keeps every mode bounded at the present bending velocities: with the published damping for
    /// [`Scheme::Verlet`], with exact damping for the others.
    pub fn stable_dt_secs(&self, scheme: Scheme) -> f32 {
        let omega_max = self.omega_max_rad_per_s();
        let damping = if scheme == Scheme::Verlet { Damping::Plain } else { Damping::Exact };
        let fraction = |dt_secs: f32| {
            let k = |waves| courant_fraction(&Coefficients::new(waves, self.layout.cell_m, dt_secs, damping), omega_max);
            self.kinds.waves().iter().map(k).fold(0.0, f32::max)
        };
        let (mut stable, mut unstable) = (0.0, 1.0);
        while fraction(unstable) <= 1.0 && unstable < 1e6 {
            (stable, unstable) = (unstable, 2.0 * unstable);
        }
        for _ in 0..24 {
            let middle = 0.5 * (stable + unstable);
            if fraction(middle) <= 1.0 { stable = middle } else { unstable = middle }
        }
        stable
    }
}
