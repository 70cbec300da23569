//! The mesh, and its step.

use super::kernel::{self, Rows};

/// Volumes of a force field and where they lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mesh {
    /// Volumes along X, up and along Z; 1 or more each.
    pub count: [usize; 3],
    /// Size of a volume along X, up and along Z (m); above 0.
    pub spacing_m: [f32; 3],
    /// Volumes that its north-west corner lies from the world's, along X and Z.
    pub corner: [i32; 2],
}

impl Mesh {
    /// Centre of a volume: X, height above the land, and Z (m).
    pub fn center_m(&self, volume: [usize; 3]) -> [f32; 3] {
        let corner = [self.corner[0], 0, self.corner[1]];
        std::array::from_fn(|axis| (corner[axis] as f32 + volume[axis] as f32 + 0.5) * self.spacing_m[axis])
    }

    /// The mesh with whole volumes whose middle is nearest to a place (m, X and Z).
    pub fn about(self, at_m: [f32; 2]) -> Self {
        let corner = |axis: usize, at_m: f32| (at_m / self.spacing_m[axis] - 0.5 * self.count[axis] as f32).round() as i32;
        Self { corner: [corner(0, at_m[0]), corner(2, at_m[1])], ..self }
    }

    /// Place of a point in units of volumes from the centre of the first.
    pub(super) fn index_of(&self, at_m: [f32; 3]) -> [f32; 3] {
        let first = self.center_m([0; 3]);
        std::array::from_fn(|axis| (at_m[axis] - first[axis]) / self.spacing_m[axis])
    }

    /// Distance between rows of the planes along Z and upwards.
    fn strides(&self) -> [usize; 2] {
        let row = self.count[0] + 2;
        [row, row * (self.count[2] + 2)]
    }

    /// Place of a volume in the planes: rows along X, then Z, then upwards, with a ring of one volume around.
    pub(super) fn place(&self, [x, y, z]: [usize; 3]) -> usize {
        let [row, layer] = self.strides();
        (x + 1) + (z + 1) * row + (y + 1) * layer
    }

    fn rows(&self) -> Rows {
        let [width, layers, rows] = self.count;
        Rows { first: self.place([0; 3]), width, count: [rows, layers], strides: self.strides() }
    }

    fn plane_len(&self) -> usize {
        self.strides()[1] * (self.count[1] + 2)
    }

    /// Rows of volumes along X, by their place upwards and along Z, in the order of the planes.
    fn layers_and_rows(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let [_, layers, rows] = self.count;
        (0..layers).flat_map(move |y| (0..rows).map(move |z| (y, z)))
    }

    /// All volumes, in the order of the planes.
    pub(super) fn volumes(&self) -> impl Iterator<Item = [usize; 3]> + use<> {
        let width = self.count[0];
        self.layers_and_rows().flat_map(move |(y, z)| (0..width).map(move |x| [x, y, z]))
    }
}

/// How long impulses linger and how far they spread.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lingering {
    /// Diffusivity κ (m²/s): after t seconds an impulse has spread √(2κt) along each axis. 0 or more.
    pub spread_m2_per_s: f32,
    /// Decay k (1/s). Above 0.
    pub decay_per_s: f32,
}

/// Share of its force that a volume gives to its neighbours in a sub-step, at most. The checkerboard, the mode that fails first, is multiplied by
/// 1 − 2·share: up to 1 the step is stable and no force turns round, up to a half no mode swings.
const SHARE_LIMIT: f32 = 0.5;

impl Lingering {
    /// Longest step (s) of one sweep on `mesh`: κ·dt·Σ 2/h² ≤ ½, half of what is stable. [`ForceField::step`] divides longer ones.
    pub fn stable_dt_secs(&self, mesh: &Mesh) -> f32 {
        let share_per_s: f32 = mesh.spacing_m.iter().map(|h| 2.0 * self.spread_m2_per_s / (h * h)).sum();
        SHARE_LIMIT / share_per_s
    }
}

/// One number for each volume, along three axes.
type Planes = [Vec<f32>; 3];

/// The force field; 11 numbers of 4 bytes for each volume. A frame reads: [move](Self::move_to), [step](Self::step), [calm](Self::calm), then all that
/// [drives](Self::drive) and [strikes](Self::strike) it, then [sum up](Self::sum_up).
#[derive(Clone, Debug, PartialEq)]
pub struct ForceField {
    mesh: Mesh,
    lingering: Lingering,
    driven: Planes,
    /// r, what lingers of impulses.
    lasting: Planes,
    next: Vec<f32>,
    force: Planes,
    /// 0 in solids, 1 elsewhere.
    open: Vec<f32>,
}

impl ForceField {
    /// A field of no force and no solids.
    ///
    /// # Panics
    /// When the mesh has no volume.
    pub fn new(mesh: Mesh, lingering: Lingering) -> Self {
        assert!(mesh.count.iter().all(|&count| count > 0), "{:?} volumes", mesh.count);
        let planes = || std::array::from_fn(|_| vec![0.0; mesh.plane_len()]);
        let [next, open] = [0.0, 1.0].map(|value| vec![value; mesh.plane_len()]);
        Self { mesh, lingering, driven: planes(), lasting: planes(), next, force: planes(), open }
    }

    /// Shape and place.
    pub fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// Moves the mesh by whole volumes to another corner. What lingers stays where it is in the world; volumes that come in hold none of it and no
    /// solid, so that they start with what drives them in the next step.
    pub fn move_to(&mut self, corner: [i32; 2]) {
        let moved = [0, 1].map(|axis| i64::from(corner[axis]) - i64::from(self.mesh.corner[axis]));
        self.mesh.corner = corner;
        if moved == [0; 2] {
            return;
        }
        let mesh = self.mesh;
        let [nx, _, nz] = mesh.count.map(|count| count as i64);
        // Columns that stay in, as they are numbered now.
        let (from, to) = ((-moved[0]).clamp(0, nx), (nx - moved[0]).clamp(0, nx));
        let stays = |z: usize| from < to && (0..nz).contains(&(z as i64 + moved[1]));
        let mut shift = |plane: &mut [f32], coming: f32| {
            self.next.copy_from_slice(plane);
            for (y, z) in mesh.layers_and_rows() {
                let first = mesh.place([0, y, z]);
                plane[first..][..mesh.count[0]].fill(coming);
                if stays(z) {
                    let source = mesh.place([(from + moved[0]) as usize, y, (z as i64 + moved[1]) as usize]);
                    let width = (to - from) as usize;
                    plane[first + from as usize..][..width].copy_from_slice(&self.next[source..][..width]);
                }
            }
            self.next.fill(0.0);
        };
        self.lasting.iter_mut().for_each(|plane| shift(plane, 0.0));
        shift(&mut self.open, 1.0);
    }

    /// Says which volumes solids fill, by their centres (X, height above the land, Z; m).
    pub fn fill(&mut self, is_solid: impl Fn([f32; 3]) -> bool) {
        let mesh = self.mesh;
        mesh.volumes().for_each(|volume| self.open[mesh.place(volume)] = if is_solid(mesh.center_m(volume)) { 0.0 } else { 1.0 });
    }

    /// Takes away what drives the field, before a step drives it anew.
    pub fn calm(&mut self) {
        self.driven.iter_mut().for_each(|plane| plane.fill(0.0));
    }

    /// Adds a force (Pa) to what drives the next step, by the centres of the volumes (X, height above the land, Z; m).
    pub fn drive(&mut self, mut force_pa: impl FnMut([f32; 3]) -> [f32; 3]) {
        let mesh = self.mesh;
        for (y, z) in mesh.layers_and_rows() {
            let (first, [_, y_m, z_m]) = (mesh.place([0, y, z]), mesh.center_m([0, y, z]));
            let [east, up, south] = self.driven.each_mut().map(|plane| &mut plane[first..][..mesh.count[0]]);
            for x in 0..mesh.count[0] {
                let [x_m, _, _] = mesh.center_m([x, y, z]);
                let added = force_pa([x_m, y_m, z_m]);
                east[x] += added[0];
                up[x] += added[1];
                south[x] += added[2];
            }
        }
    }

    /// Gives a volume the impulse (Pa·s) of a step of `dt_secs` (s), above 0.
    pub fn strike(&mut self, volume: [usize; 3], impulse_pa_s: [f32; 3], dt_secs: f32) {
        let rate_per_s = self.rate_per_s(dt_secs);
        self.linger(volume, impulse_pa_s.map(|impulse| rate_per_s * impulse));
    }

    /// What an impulse of a step adds to r (1/s): (1 − e^(−k·dt))/dt.
    pub(super) fn rate_per_s(&self, dt_secs: f32) -> f32 {
        -(-self.lingering.decay_per_s * dt_secs).exp_m1() / dt_secs
    }

    /// Adds to r in a volume.
    pub(super) fn linger(&mut self, volume: [usize; 3], force_pa: [f32; 3]) {
        let place = self.mesh.place(volume);
        self.lasting.iter_mut().zip(force_pa).for_each(|(plane, force)| plane[place] += force);
    }

    /// Whether a solid fills a volume.
    pub(super) fn is_solid(&self, volume: [usize; 3]) -> bool {
        self.open[self.mesh.place(volume)] == 0.0
    }

    /// Sums up the forces of now: what drives the field, and what lingers.
    pub fn sum_up(&mut self) {
        let (rows, [row, layer]) = (self.mesh.rows(), self.mesh.strides());
        for (axis, stride) in [1, layer, row].into_iter().enumerate() {
            kernel::sum(&self.driven[axis], &self.lasting[axis], &self.open, &mut self.force[axis], rows, stride);
        }
    }

    /// Lets what lingers spread and decay for `dt_secs` (s), 0 or more; in sub-steps where [`Lingering::stable_dt_secs`] asks for them.
    ///
    /// The sum of all force falls by e^(−k·dt) exactly and its variance in space grows by 2κ·dt exactly, whatever dt is, as far as neither border nor
    /// solid is near.
    pub fn step(&mut self, dt_secs: f32) {
        let substeps = (dt_secs / self.lingering.stable_dt_secs(&self.mesh)).ceil().max(1.0);
        let dt_secs = dt_secs / substeps;
        let keep = (-self.lingering.decay_per_s * dt_secs).exp();
        let shares = self.mesh.spacing_m.map(|h| self.lingering.spread_m2_per_s * dt_secs / (h * h));
        let (rows, layer) = (self.mesh.rows(), self.mesh.strides()[1]);
        for lasting in &mut self.lasting {
            for _ in 0..substeps as u32 {
                // Below the ground there is as much as above it, so that nothing goes through.
                lasting.copy_within(layer..2 * layer, 0);
                kernel::spread(lasting, &mut self.next, &self.open, rows, shares, keep);
                std::mem::swap(lasting, &mut self.next);
            }
        }
    }

    /// The force in a volume (Pa), as of [`sum_up`](Self::sum_up).
    pub fn force_pa(&self, volume: [usize; 3]) -> [f32; 3] {
        let place = self.mesh.place(volume);
        std::array::from_fn(|axis| self.force[axis][place])
    }

    /// The forces of all volumes (Pa), as of [`sum_up`](Self::sum_up): rows along X, then Z, then upwards.
    pub fn forces_pa(&self) -> impl Iterator<Item = [f32; 3]> + '_ {
        self.mesh.volumes().map(|volume| self.force_pa(volume))
    }

    /// The force at a point (X, height above the land, Z; m), trilinear between the centres of volumes; beyond the outermost theirs.
    pub fn at(&self, at_m: [f32; 3]) -> [f32; 3] {
        let index = self.mesh.index_of(at_m);
        let along = |axis: usize| {
            let last = self.mesh.count[axis] - 1;
            let at = index[axis].clamp(0.0, last as f32);
            let low = (at as usize).min(last);
            ([low, (low + 1).min(last)], at - low as f32)
        };
        let [(x, east), (y, up), (z, south)] = [0, 1, 2].map(along);
        let mut sum = [0.0; 3];
        for corner in 0..8 {
            let [dx, dy, dz] = [corner & 1, corner >> 1 & 1, corner >> 2];
            let weight = [1.0 - east, east][dx] * [1.0 - up, up][dy] * [1.0 - south, south][dz];
            let force = self.force_pa([x[dx], y[dy], z[dz]]);
            sum = std::array::from_fn(|axis| sum[axis] + weight * force[axis]);
        }
        sum
    }
}
