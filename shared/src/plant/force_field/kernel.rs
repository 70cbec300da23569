//! Innermost loops: spread of impulses, and the wind's force that arrives.

use multiversion::multiversion;

/// Rows of the mesh in planes with a ring of one volume around it.
#[derive(Clone, Copy)]
pub(super) struct Rows {
    /// Index of the first volume, volumes per row, and number of rows along z and y.
    pub(super) first: usize,
    pub(super) width: usize,
    pub(super) count: [usize; 2],
    /// Distance between rows along z and along y.
    pub(super) strides: [usize; 2],
}

impl Rows {
    fn starts(self) -> impl Iterator<Item = usize> {
        let Self { first, count: [rows, layers], strides: [row, layer], .. } = self;
        (0..layers).flat_map(move |y| (0..rows).map(move |z| first + y * layer + z * row))
    }
}

/// A row of a plane and the rows around it, all of one length.
#[derive(Clone, Copy)]
struct Stencil<'a> {
    center: &'a [f32],
    sides: [&'a [f32]; 6],
}

impl<'a> Stencil<'a> {
    #[inline(always)]
    fn new(plane: &'a [f32], at: usize, width: usize, [row, layer]: [usize; 2]) -> Self {
        let slice = |first: usize| &plane[first..][..width];
        let sides = [slice(at - 1), slice(at + 1), slice(at - layer), slice(at + layer), slice(at - row), slice(at + row)];
        Self { center: slice(at), sides }
    }
}

/// Smallest remainder (Pa); a smaller one is set to 0, since denormal numbers would make a step five times as long.
const LEAST_PA: f32 = 1e-20;

/// One sub-step: each volume exchanges the fraction `fractions` (x, y, z) of the difference with its neighbours as far as both are `open`; the fraction
/// `keep` is left.
// Slices passed as separate arguments are known not to overlap.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
pub(super) fn spread(now: &[f32], next: &mut [f32], open: &[f32], rows: Rows, fractions: [f32; 3], keep: f32) {
    let [x, y, z] = fractions;
    for at in rows.starts() {
        let (r, open) = (Stencil::new(now, at, rows.width, rows.strides), Stencil::new(open, at, rows.width, rows.strides));
        let next = &mut next[at..][..rows.width];
        for (i, next) in next.iter_mut().enumerate() {
            let flow = |side: usize| open.sides[side][i] * (r.sides[side][i] - r.center[i]);
            let gain = x * (flow(0) + flow(1)) + y * (flow(2) + flow(3)) + z * (flow(4) + flow(5));
            let left = keep * (r.center[i] + open.center[i] * gain);
            *next = if left.abs() < LEAST_PA { 0.0 } else { left };
        }
    }
}

/// Mixing length ℓ (m) by which air from the sides and above enters a lee, eddy diffusivity over wind speed: κ·u*·z/u at z = 2 m over grass with a
/// roughness of 5 cm, by the logarithmic profile.
pub(super) const MIXING_M: f32 = 0.087;

/// Force over length (Pa/m) below which the wind has no direction, and there is no lee.
const CALM_PA_PER_M: f32 = 1e-6;

/// Smallest lee; a smaller one is set to 0, to avoid denormal numbers far away.
const LEAST_LEE: f32 = 1e-6;

/// One sweep of the lee l along the wind n, implicit upwind: n·∇l = ℓ·∇²l, where each volume lets the fraction `open` of the wind through, and air
/// mixes as far as both volumes are open.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
pub(super) fn shelter(lee: &[f32], next: &mut [f32], open: &[f32], wind: [&[f32]; 3], rows: Rows, spacing_m: [f32; 3]) {
    let along = spacing_m.map(f32::recip);
    let across = along.map(|per_m| MIXING_M * per_m * per_m);
    for at in rows.starts() {
        let (lee, open) = (Stencil::new(lee, at, rows.width, rows.strides), Stencil::new(open, at, rows.width, rows.strides));
        let [east, up, south] = wind.map(|plane| &plane[at..][..rows.width]);
        let next = &mut next[at..][..rows.width];
        for (i, next) in next.iter_mut().enumerate() {
            let (x, y, z) = (east[i], up[i], south[i]);
            let size = (x * x + y * y + z * z).sqrt();
            // From each side: advected, and mixed in.
            let carried = |axis: usize, force: f32| along[axis] * force.max(0.0);
            let carried = [carried(0, x), carried(0, -x), carried(1, y), carried(1, -y), carried(2, z), carried(2, -z)];
            let mixed = |side: usize| across[side / 2] * size * open.sides[side][i];
            let mixed = [mixed(0), mixed(1), mixed(2), mixed(3), mixed(4), mixed(5)];
            let sum = |weights: [f32; 6]| weights[0] + weights[1] + weights[2] + weights[3] + weights[4] + weights[5];
            let lees = |weights: [f32; 6]| {
                let of = |side: usize| weights[side] * lee.sides[side][i];
                of(0) + of(1) + of(2) + of(3) + of(4) + of(5)
            };
            let (comes, passes) = (sum(carried), open.center[i]);
            let lee = (comes - passes * (comes - lees(carried) - lees(mixed))) / (comes + passes * sum(mixed) + CALM_PA_PER_M);
            *next = if lee > LEAST_LEE { lee } else { 0.0 };
        }
    }
}

/// The wind's force that arrives along one axis, with `stride` between neighbours: reduced in a lee, and towards a neighbour by the fraction that the
/// neighbour stops.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
pub(super) fn arrive(wind: &[f32], lee: &[f32], open: &[f32], blown: &mut [f32], rows: Rows, stride: usize) {
    for at in rows.starts() {
        let (wind, lee) = (&wind[at..][..rows.width], &lee[at..][..rows.width]);
        let (before, after) = (&open[at - stride..][..rows.width], &open[at + stride..][..rows.width]);
        let blown = &mut blown[at..][..rows.width];
        for i in 0..rows.width {
            blown[i] = (1.0 - lee[i]) * (wind[i].max(0.0) * after[i] + wind[i].min(0.0) * before[i]);
        }
    }
}
