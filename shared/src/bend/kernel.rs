//! Innermost loops: one sub-step of a block of cells of one kind of grass.

use super::Coefficients;
use super::ground::held;
use super::patch::{CHANNELS, Planes};
use super::tiles::{size_bits, square_bits};
use multiversion::multiversion;

/// A block of cells in the planes, all of one kind of grass.
#[derive(Clone, Copy)]
pub(super) struct Block<'a> {
    /// Index of the north-western cell.
    pub(super) first: usize,
    /// Cells per row.
    pub(super) width: usize,
    pub(super) rows: usize,
    /// Distance between rows.
    pub(super) stride: usize,
    /// Coefficients of its kind of grass.
    pub(super) k: &'a Coefficients,
    /// Largest |θ| (rad).
    pub(super) limit_rad: f32,
}

/// Replaces the earlier state of a block by the next state.
pub(super) fn advance(now: &Planes, before: &mut Planes, block: Block) {
    let advance = match speed(block.k) {
        STEADY => advance_block::<STEADY>,
        FOLLOWING => advance_block::<FOLLOWING>,
        _ => advance_block::<CONSERVING>,
    };
    let [theta, x, z] = before;
    advance(now, theta, x, z, block);
}

/// As [`advance`]; also updates `peaks`, the largest |θ| and |ω|² of each column as bits, with both times.
pub(super) fn advance_and_measure(now: &Planes, before: &mut Planes, block: Block, peaks: [&mut [u32]; 2]) {
    let advance = match speed(block.k) {
        STEADY => advance_and_measure_block::<STEADY>,
        FOLLOWING => advance_and_measure_block::<FOLLOWING>,
        _ => advance_and_measure_block::<CONSERVING>,
    };
    let ([theta, x, z], [theta_peaks, omega2_peaks]) = (before, peaks);
    advance(now, theta, x, z, block, theta_peaks, omega2_peaks);
}

/// Cells of a channel with their four neighbours, all of one length.
#[derive(Clone, Copy)]
struct Stencil<'a> {
    center: &'a [f32],
    west: &'a [f32],
    east: &'a [f32],
    north: &'a [f32],
    south: &'a [f32],
}

impl<'a> Stencil<'a> {
    #[inline(always)]
    fn new(plane: &'a [f32], at: usize, width: usize, stride: usize) -> Self {
        let row = |first: usize| &plane[first..][..width];
        Self { center: row(at), west: row(at - 1), east: row(at + 1), north: row(at - stride), south: row(at + stride) }
    }

    #[inline(always)]
    fn laplacian(&self, i: usize) -> f32 {
        (self.west[i] + self.east[i]) + (self.north[i] + self.south[i]) - 4.0 * self.center[i]
    }
}

// Written out: with `map` the compiler does not see that all have the same length.
#[inline(always)]
fn stencils([theta, x, z]: &Planes, at: usize, width: usize, stride: usize) -> [Stencil<'_>; CHANNELS] {
    [Stencil::new(theta, at, width, stride), Stencil::new(x, at, width, stride), Stencil::new(z, at, width, stride)]
}

/// Wave speed of θ: constant; varying with the bend (Eq. 4); the same, with momentum kept instead of motion.
const STEADY: u8 = 0;
const FOLLOWING: u8 = 1;
const CONSERVING: u8 = 2;

fn speed(k: &Coefficients) -> u8 {
    match (k.r_mu == 0.0, k.keeps_motion) {
        (true, _) => STEADY,
        (false, true) => FOLLOWING,
        (false, false) => CONSERVING,
    }
}

/// Next state of a cell: θ, ωx, ωz.
#[inline(always)]
fn next_cell<const SPEED: u8>(
    row: &[Stencil; CHANNELS],
    i: usize,
    before: [f32; CHANNELS],
    k: &Coefficients,
    limit_rad: f32,
) -> [f32; CHANNELS] {
    let [theta, x, z] = row;
    let (keep, memory) = (2.0 - k.lambda_omega - k.restoring[1], 1.0 - k.lambda_omega);
    let next_x = keep * x.center[i] - memory * before[1] + k.r2_omega * x.laplacian(i);
    let next_z = keep * z.center[i] - memory * before[2] + k.r2_omega * z.laplacian(i);
    let memory = 1.0 - k.lambda_theta;
    let courant = |twice: f32, x: f32, z: f32| twice * k.r0 + k.r_mu * (x * x + z * z).sqrt();
    let next_theta = if SPEED == CONSERVING {
        // Twice the Courant numbers at the bending velocities in the middle of the next and the last interval.
        let ahead = courant(2.0, x.center[i] + next_x, z.center[i] + next_z);
        let behind = courant(2.0, x.center[i] + before[1], z.center[i] + before[2]);
        let kept = memory * (ahead / behind) * (theta.center[i] - before[0]);
        theta.center[i] + kept + 0.125 * ahead * (ahead + behind) * (theta.laplacian(i) - k.stiffness * theta.center[i])
    } else {
        let r = if SPEED == STEADY { k.r0 } else { courant(1.0, x.center[i], z.center[i]) };
        (1.0 + memory - k.restoring[0]) * theta.center[i] - memory * before[0] + r * r * theta.laplacian(i)
    };
    [held(next_theta, limit_rad), next_x, next_z]
}

// Slices are separate arguments so that the compiler may assume that they do not overlap; combined or inlined, the loops would not be vectorised.
#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn advance_block<const SPEED: u8>(now: &Planes, theta: &mut [f32], x: &mut [f32], z: &mut [f32], block: Block) {
    let Block { first, width, rows, stride, k, limit_rad } = block;
    let k = *k;
    for at in (0..rows).map(|row| first + row * stride) {
        let row = stencils(now, at, width, stride);
        let (theta, x, z) = (&mut theta[at..][..width], &mut x[at..][..width], &mut z[at..][..width]);
        for i in 0..width {
            [theta[i], x[i], z[i]] = next_cell::<SPEED>(&row, i, [theta[i], x[i], z[i]], &k, limit_rad);
        }
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl", "x86_64+avx2"))]
fn advance_and_measure_block<const SPEED: u8>(
    now: &Planes,
    theta: &mut [f32],
    x: &mut [f32],
    z: &mut [f32],
    block: Block,
    theta_peaks: &mut [u32],
    omega2_peaks: &mut [u32],
) {
    let Block { first, width, rows, stride, k, limit_rad } = block;
    let k = *k;
    let (theta_peaks, omega2_peaks) = (&mut theta_peaks[..width], &mut omega2_peaks[..width]);
    for at in (0..rows).map(|row| first + row * stride) {
        let row = stencils(now, at, width, stride);
        let (theta, x, z) = (&mut theta[at..][..width], &mut x[at..][..width], &mut z[at..][..width]);
        for i in 0..width {
            let next = next_cell::<SPEED>(&row, i, [theta[i], x[i], z[i]], &k, limit_rad);
            [theta[i], x[i], z[i]] = next;
            theta_peaks[i] = theta_peaks[i].max(size_bits(next[0])).max(size_bits(row[0].center[i]));
            let omega2 = square_bits(row[1].center[i], row[2].center[i]);
            omega2_peaks[i] = omega2_peaks[i].max(omega2).max(square_bits(next[1], next[2]));
        }
    }
}
