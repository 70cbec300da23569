//! The whole field: patches, their ghosts, and the step.

use super::{Bend, Coefficients, Patch, WaveParams, verlet};
use crate::grid::{PatchIndex, PatchLayout};

/// The bend field of a world: one optional patch for each place of the layout. A patch that is none sleeps: it is at rest
/// and holds no memory. Beyond the world's edge the grass is at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    layout: PatchLayout,
    patches: Vec<Option<Box<Patch>>>,
}

impl Field {
    /// A field at rest, all patches asleep.
    pub fn new(layout: PatchLayout) -> Self {
        Self { layout, patches: (0..layout.patches()).map(|_| None).collect() }
    }

    /// Shape and spacing.
    pub fn layout(&self) -> &PatchLayout {
        &self.layout
    }

    /// The patch, if it is awake.
    pub fn patch(&self, patch: PatchIndex) -> Option<&Patch> {
        self.patches[patch as usize].as_deref()
    }

    /// The patch, woken if it slept.
    pub fn wake(&mut self, patch: PatchIndex) -> &mut Patch {
        let side = self.layout.cells as usize;
        self.patches[patch as usize].get_or_insert_with(|| Box::new(Patch::new(side)))
    }

    /// Lets a patch go; it is at rest from now on.
    pub fn sleep(&mut self, patch: PatchIndex) {
        self.patches[patch as usize] = None;
    }

    /// Awake patches in index order.
    pub fn awake(&self) -> impl Iterator<Item = (PatchIndex, &Patch)> {
        self.patches.iter().enumerate().filter_map(|(index, patch)| Some((index as PatchIndex, patch.as_deref()?)))
    }

    /// Awake patches in index order, to be changed; each on its own, so that threads can share them out.
    pub fn awake_mut(&mut self) -> impl Iterator<Item = (PatchIndex, &mut Patch)> {
        self.patches.iter_mut().enumerate().filter_map(|(index, patch)| Some((index as PatchIndex, patch.as_deref_mut()?)))
    }

    /// Largest bending speed of any cell (rad/s).
    pub fn omega_max_rad_per_s(&self) -> f32 {
        self.awake().map(|(_, patch)| patch.extremes().1).fold(0.0, f32::max)
    }

    /// State at `(x_m, z_m)`: that of the nearest cell; at rest where the patch sleeps and outside the world.
    pub fn bend_at(&self, x_m: f32, z_m: f32) -> Bend {
        let Some(index) = self.layout.patch_at(x_m, z_m) else { return Bend::default() };
        let Some(patch) = self.patch(index) else { return Bend::default() };
        let [corner_x, corner_z] = self.layout.corner_m(index);
        let cell = |m: f32| ((m / self.layout.cell_m).max(0.0) as usize).min(patch.side() - 1);
        patch.bend(cell(x_m - corner_x), cell(z_m - corner_z))
    }

    /// Copies the border cells of every awake patch into its neighbours' ghosts; ghosts towards sleepers become zero.
    pub fn refresh_ghosts(&mut self) {
        let [count_x, count_z] = self.layout.count.map(|n| n as usize);
        for z in 0..count_z {
            for x in 0..count_x {
                let index = x + z * count_x;
                let east = (x + 1 < count_x).then_some(index + 1);
                let south = (z + 1 < count_z).then_some(index + count_x);
                self.join(index, east, Axis::East);
                self.join(index, south, Axis::South);
                if x == 0
                    && let Some(patch) = &mut self.patches[index]
                {
                    clear_ghosts(patch, Side::West);
                }
                if z == 0
                    && let Some(patch) = &mut self.patches[index]
                {
                    clear_ghosts(patch, Side::North);
                }
            }
        }
    }

    /// Advances the field by `dt_secs` with Verlet sub-steps chosen from the stability bound, on one thread. Returns the
    /// number of sub-steps.
    pub fn step(&mut self, params: &WaveParams, dt_secs: f32) -> u32 {
        let count = verlet::substeps(params, self.layout.cell_m, dt_secs, self.omega_max_rad_per_s());
        let k = Coefficients::new(params, self.layout.cell_m, dt_secs / count as f32);
        for _ in 0..count {
            self.refresh_ghosts();
            for (_, patch) in self.awake_mut() {
                verlet::step(patch, &k);
            }
        }
        count
    }

    fn join(&mut self, first: usize, second: Option<usize>, axis: Axis) {
        let (first_side, second_side) = match axis {
            Axis::East => (Side::East, Side::West),
            Axis::South => (Side::South, Side::North),
        };
        let Some(second) = second else {
            if let Some(patch) = &mut self.patches[first] {
                clear_ghosts(patch, first_side);
            }
            return;
        };
        let [a, b] = self.patches.get_disjoint_mut([first, second]).expect("neighbours are two patches");
        match (a, b) {
            (Some(a), Some(b)) => {
                copy_border(a, b, first_side, second_side);
                copy_border(b, a, second_side, first_side);
            }
            (Some(a), None) => clear_ghosts(a, first_side),
            (None, Some(b)) => clear_ghosts(b, second_side),
            (None, None) => {}
        }
    }
}

#[derive(Clone, Copy)]
enum Axis {
    East,
    South,
}

#[derive(Clone, Copy)]
enum Side {
    West,
    East,
    North,
    South,
}

/// Start and stride of the line of cells along a side: the outermost own cells, or the ghosts beyond them.
fn line(patch: &Patch, side: Side, ghosts: bool) -> (usize, usize) {
    let (n, stride) = (patch.side(), patch.stride());
    let outward = usize::from(ghosts);
    match side {
        Side::West => (stride + 1 - outward, stride),
        Side::East => (stride + n + outward, stride),
        Side::North => ((1 - outward) * stride + 1, 1),
        Side::South => ((n + outward) * stride + 1, 1),
    }
}

fn copy_border(from: &Patch, to: &mut Patch, from_side: Side, to_side: Side) {
    let (source, source_stride) = line(from, from_side, false);
    let (target, target_stride) = line(to, to_side, true);
    for (from, to) in from.now.iter().zip(&mut to.now) {
        for i in 0..to.len().isqrt() - 2 {
            to[target + i * target_stride] = from[source + i * source_stride];
        }
    }
}

fn clear_ghosts(patch: &mut Patch, side: Side) {
    let (start, stride) = line(patch, side, true);
    let count = patch.side();
    for channel in &mut patch.now {
        for i in 0..count {
            channel[start + i * stride] = 0.0;
        }
    }
}
