//! The mesh of volumes, and its step.

use super::Obstacle;
use super::kernel::{self, Rows};
use std::ops::Range;

/// Mesh of volumes: number, size and position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VolumeMesh {
    /// Number of volumes along X, up and along Z; 1 or more each.
    pub count: [usize; 3],
    /// Size of a volume along X, up and along Z (m); above 0.
    pub spacing_m: [f32; 3],
    /// Position of its north-west corner relative to the world's, in volumes along X and Z.
    pub corner: [i32; 2],
}

impl VolumeMesh {
    /// Centre of a volume: X, height above the land, and Z (m).
    pub fn center_m(&self, volume: [usize; 3]) -> [f32; 3] {
        let corner = [self.corner[0], 0, self.corner[1]];
        std::array::from_fn(|axis| (corner[axis] as f32 + volume[axis] as f32 + 0.5) * self.spacing_m[axis])
    }

    /// The mesh moved by whole volumes to centre it on a point (m, X and Z).
    pub fn about(self, at_m: [f32; 2]) -> Self {
        let corner = |axis: usize, at_m: f32| (at_m / self.spacing_m[axis] - 0.5 * self.count[axis] as f32).round() as i32;
        Self { corner: [corner(0, at_m[0]), corner(2, at_m[1])], ..self }
    }

    /// Volumes whose centres are within `reach_m` of a point along each axis.
    pub(super) fn within(&self, at_m: [f32; 3], reach_m: [f32; 3]) -> [Range<usize>; 3] {
        let first_m = self.center_m([0; 3]);
        std::array::from_fn(|axis| {
            let index = |at_m: f32| (at_m - first_m[axis]) / self.spacing_m[axis];
            // Casts saturate at 0.
            let (low, high) = (index(at_m[axis] - reach_m[axis]).ceil(), index(at_m[axis] + reach_m[axis]).floor() + 1.0);
            low as usize..(high as usize).min(self.count[axis])
        })
    }

    /// Distance between rows of the planes along Z and upwards.
    fn strides(&self) -> [usize; 2] {
        let row = self.count[0] + 2;
        [row, row * (self.count[2] + 2)]
    }

    /// Index of a volume in the planes: rows along X, then Z, then upwards, with a ring of one volume around.
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

    /// Rows of volumes along X, by height and Z, in the order of the planes.
    fn layers_and_rows(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let [_, layers, rows] = self.count;
        (0..layers).flat_map(move |y| (0..rows).map(move |z| (y, z)))
    }
}

/// Spread and decay of impulses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lingering {
    /// Diffusivity κ (m²/s): after t seconds an impulse has spread by √(2κt) along each axis. 0 or more.
    pub spread_m2_per_s: f32,
    /// Decay rate k (1/s). Above 0.
    pub decay_per_s: f32,
}

/// Largest fraction of its force that a volume gives to its neighbours in a sub-step. The checkerboard, the first mode to fail, is multiplied by 1 −
/// 2·fraction: up to 1 the step is stable, up to 0.5 no mode oscillates.
const SHARE_LIMIT: f32 = 0.5;

impl Lingering {
    /// Longest step (s) of one sweep on `mesh`: κ·dt·Σ 2/h² ≤ ½, half the stability limit. [`ForceField::step`] divides longer ones.
    pub fn stable_dt_secs(&self, mesh: &VolumeMesh) -> f32 {
        let fraction_per_s: f32 = mesh.spacing_m.iter().map(|h| 2.0 * self.spread_m2_per_s / (h * h)).sum();
        SHARE_LIMIT / fraction_per_s
    }
}

/// One number per volume, along three axes.
type Planes = [Vec<f32>; 3];

/// Force (Pa) on a silhouette in a volume, after [`shelter`](ForceField::shelter).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Force {
    /// Force of the wind that arrives there.
    pub wind_pa: [f32; 3],
    /// Fraction of the wind's force along each axis that arrives.
    pub arriving: [f32; 3],
    /// Remainder of impulses.
    pub lasting_pa: [f32; 3],
}

/// Force field; 14 numbers of 4 bytes per volume. A frame consists of: [move](Self::move_to) the mesh, and if it moved, set the
/// [standing](Self::stand) obstacles; [step](Self::step); set the [moving](Self::obstruct) obstacles, the [wind](Self::blow) and the
/// [impulses](Self::strike); [shelter](Self::shelter).
#[derive(Clone, Debug, PartialEq)]
pub struct ForceField {
    mesh: VolumeMesh,
    lingering: Lingering,
    /// w, the wind's force in the open.
    wind: Planes,
    /// 1 − s, the fraction of it that obstacles keep away.
    lee: Vec<f32>,
    /// The part of it that arrives.
    blown: Planes,
    /// r, the remainder of impulses.
    lasting: Planes,
    next: Vec<f32>,
    /// Fraction of a force that a volume lets through, with all obstacles and with the standing ones only.
    open: Vec<f32>,
    standing: Vec<f32>,
}

impl ForceField {
    /// A field without forces or obstacles.
    ///
    /// # Panics
    /// When the mesh has no volume.
    pub fn new(mesh: VolumeMesh, lingering: Lingering) -> Self {
        assert!(mesh.count.iter().all(|&count| count > 0), "{:?} volumes", mesh.count);
        let plane = |value: f32| vec![value; mesh.plane_len()];
        let planes = || std::array::from_fn(|_| plane(0.0));
        let (lee, next, open, standing) = (plane(0.0), plane(0.0), plane(1.0), plane(1.0));
        Self { mesh, lingering, wind: planes(), lee, blown: planes(), lasting: planes(), next, open, standing }
    }

    /// The mesh.
    pub fn mesh(&self) -> &VolumeMesh {
        &self.mesh
    }

    /// Moves the mesh by whole volumes to another corner. Remainders and lees stay where they are in the world; new volumes have neither. Set wind
    /// and obstacles again afterwards.
    pub fn move_to(&mut self, corner: [i32; 2]) {
        let moved = [0, 1].map(|axis| i64::from(corner[axis]) - i64::from(self.mesh.corner[axis]));
        self.mesh.corner = corner;
        if moved == [0; 2] {
            return;
        }
        let mesh = self.mesh;
        let [nx, _, nz] = mesh.count.map(|count| count as i64);
        // Columns that remain, by their present index.
        let (from, to) = ((-moved[0]).clamp(0, nx), (nx - moved[0]).clamp(0, nx));
        let stays = |z: usize| from < to && (0..nz).contains(&(z as i64 + moved[1]));
        let mut shift = |plane: &mut [f32]| {
            self.next.copy_from_slice(plane);
            for (y, z) in mesh.layers_and_rows() {
                let first = mesh.place([0, y, z]);
                plane[first..][..mesh.count[0]].fill(0.0);
                if stays(z) {
                    let source = mesh.place([(from + moved[0]) as usize, y, (z as i64 + moved[1]) as usize]);
                    let width = (to - from) as usize;
                    plane[first + from as usize..][..width].copy_from_slice(&self.next[source..][..width]);
                }
            }
            self.next.fill(0.0);
        };
        self.lasting.iter_mut().for_each(|plane| shift(plane));
        shift(&mut self.lee);
    }

    /// Sets the standing obstacles.
    pub fn stand(&mut self, obstacles: impl IntoIterator<Item = Obstacle>) {
        self.standing.fill(1.0);
        obstacles.into_iter().for_each(|obstacle| obstacle.close(&self.mesh, &mut self.standing));
        self.obstruct([]);
    }

    /// Sets the moving obstacles, in addition to the standing ones.
    pub fn obstruct(&mut self, obstacles: impl IntoIterator<Item = Obstacle>) {
        self.open.copy_from_slice(&self.standing);
        obstacles.into_iter().for_each(|obstacle| obstacle.close(&self.mesh, &mut self.open));
    }

    /// Sets the wind's force in the open (Pa), by the centres of the volumes (X, height above the land, Z; m).
    pub fn blow(&mut self, mut force_pa: impl FnMut([f32; 3]) -> [f32; 3]) {
        let mesh = self.mesh;
        for (y, z) in mesh.layers_and_rows() {
            let (first, [west_m, y_m, z_m]) = (mesh.place([0, y, z]), mesh.center_m([0, y, z]));
            let [east, up, south] = self.wind.each_mut().map(|plane| &mut plane[first..][..mesh.count[0]]);
            for x in 0..mesh.count[0] {
                [east[x], up[x], south[x]] = force_pa([west_m + x as f32 * mesh.spacing_m[0], y_m, z_m]);
            }
        }
    }

    /// Adds impulses (Pa·s) to volumes, those of a step of `dt_secs` (s), above 0.
    pub fn strike(&mut self, impulses_pa_s: impl IntoIterator<Item = ([usize; 3], [f32; 3])>, dt_secs: f32) {
        let rate_per_s = -(-self.lingering.decay_per_s * dt_secs).exp_m1() / dt_secs;
        for (volume, impulse) in impulses_pa_s {
            let place = self.mesh.place(volume);
            self.lasting.iter_mut().zip(impulse).for_each(|(plane, impulse)| plane[place] += rate_per_s * impulse);
        }
    }

    /// Propagates the lee of the obstacles by one volume, and computes the wind's force that arrives behind and before them.
    pub fn shelter(&mut self) {
        let (rows, [row, layer]) = (self.mesh.rows(), self.mesh.strides());
        // Mirrored at the ground.
        self.lee.copy_within(layer..2 * layer, 0);
        let wind = self.wind.each_ref().map(Vec::as_slice);
        kernel::shelter(&self.lee, &mut self.next, &self.open, wind, rows, self.mesh.spacing_m);
        std::mem::swap(&mut self.lee, &mut self.next);
        for (axis, stride) in [1, layer, row].into_iter().enumerate() {
            kernel::arrive(&self.wind[axis], &self.lee, &self.open, &mut self.blown[axis], rows, stride);
        }
    }

    /// Spreads and decays remainders for `dt_secs` (s), 0 or more; in sub-steps if [`Lingering::stable_dt_secs`] requires them.
    ///
    /// The sum of all force falls by e^(−k·dt) exactly and its variance in space grows by 2κ·dt exactly, whatever dt is, as long as it is far from
    /// borders and solids.
    pub fn step(&mut self, dt_secs: f32) {
        let substeps = (dt_secs / self.lingering.stable_dt_secs(&self.mesh)).ceil().max(1.0);
        let dt_secs = dt_secs / substeps;
        let keep = (-self.lingering.decay_per_s * dt_secs).exp();
        let fractions = self.mesh.spacing_m.map(|h| self.lingering.spread_m2_per_s * dt_secs / (h * h));
        let (rows, layer) = (self.mesh.rows(), self.mesh.strides()[1]);
        for lasting in &mut self.lasting {
            for _ in 0..substeps as u32 {
                // Mirrored at the ground, so that nothing passes through it.
                lasting.copy_within(layer..2 * layer, 0);
                kernel::spread(lasting, &mut self.next, &self.open, rows, fractions, keep);
                std::mem::swap(lasting, &mut self.next);
            }
        }
    }

    /// The force in a volume.
    pub fn force(&self, volume: [usize; 3]) -> Force {
        self.force_at(self.mesh.place(volume))
    }

    /// The forces of all volumes: rows along X, then Z, then upwards.
    pub fn forces(&self) -> impl Iterator<Item = Force> + '_ {
        let rows = self.mesh.layers_and_rows().map(|(y, z)| self.mesh.place([0, y, z]));
        rows.flat_map(|first| first..first + self.mesh.count[0]).map(|place| self.force_at(place))
    }

    fn force_at(&self, place: usize) -> Force {
        let of = |planes: &Planes| planes.each_ref().map(|plane| plane[place]);
        let (wind_pa, open_pa) = (of(&self.blown), of(&self.wind));
        // Of no wind, what the lee leaves.
        let arriving = [0, 1, 2].map(|axis| if open_pa[axis] == 0.0 { 1.0 - self.lee[place] } else { wind_pa[axis] / open_pa[axis] });
        Force { wind_pa, arriving, lasting_pa: of(&self.lasting) }
    }
}
