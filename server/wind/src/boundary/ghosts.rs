//! Filling of ghost values along one axis.

use super::condition::GhostRule;
use crate::field::Field;
use crate::grid::{GHOST, Grid, Location};
use crate::real::Real;

/// [`GhostRule`] in the precision of the fields, with the prescribed values of its face; `doubled` is twice the value at the wall.
#[derive(Clone, Copy)]
pub(super) enum Rule<'a, R> {
    Wrap,
    Keep,
    Mirror { sign: R, doubled: R },
    MirrorPlane { sign: R, doubled: &'a [R] },
}

impl<'a, R: Real> Rule<'a, R> {
    /// `prescribed` is twice the prescribed value at each point of the face, if the rule needs it.
    pub(super) fn new(rule: GhostRule, prescribed: impl FnOnce() -> &'a [R]) -> Self {
        match rule {
            GhostRule::Periodic => Self::Wrap,
            GhostRule::Mirror { sign, wall } => Self::Mirror { sign: R::of(sign), doubled: R::of(2.0 * f64::from(wall)) },
            GhostRule::MirrorPrescribed => Self::MirrorPlane { sign: -R::one(), doubled: prescribed() },
        }
    }
}

/// Fills the ghosts of `field` beyond both faces of `axis`, and sets the normal velocity on closed and prescribed faces.
pub(super) fn fill<R: Real>(grid: &Grid<R>, field: &mut Field<R>, axis: usize, rules: [Rule<'_, R>; 2]) {
    let (images, used) = images(grid, field.location, axis, rules);
    let images = &images[..used];
    let planes = rules.map(|rule| if let Rule::MirrorPlane { doubled, .. } = rule { doubled } else { &[] });

    // Lines whose ghosts along later axes are not filled yet are skipped: those ghosts become copies of whole lines.
    let [_, sy, sz] = grid.strides();
    let inner = |axis: usize| GHOST..GHOST + grid.cells[axis] + 1;
    match axis {
        0 => {
            let given = images.iter().any(|image| image.plane.is_some());
            for k in inner(2) {
                let first = inner(1).start * sy + k * sz;
                let rows = &mut field.data[first..first + inner(1).len() * sy];
                if given {
                    rows.chunks_exact_mut(sy).enumerate().for_each(|(n, row)| apply(images, planes, row, 1, first / sy + n));
                } else {
                    // The common case: rows are many and short.
                    for row in rows.chunks_exact_mut(sy) {
                        images.iter().for_each(|image| row[image.to] = image.sign * row[image.from] + image.doubled);
                    }
                }
            }
        }
        1 => inner(2).for_each(|k| apply(images, planes, &mut field.data[k * sz..(k + 1) * sz], sy, k * sy)),
        _ => apply(images, planes, &mut field.data, sz, 0),
    }
}

/// The values to set along a line in the direction of the axis, and their number.
fn images<R: Real>(grid: &Grid<R>, location: Location, axis: usize, rules: [Rule<'_, R>; 2]) -> ([Image<R>; 2 + 2 * GHOST], usize) {
    let n = grid.cells[axis];
    let on_faces = location == Location::Face(axis);
    let (zero, half) = (R::zero(), R::of(0.5));
    let mut images = [Image::default(); 2 + 2 * GHOST];
    let mut used = 0;
    let mut add = |image| {
        images[used] = image;
        used += 1;
    };
    for (side, rule) in rules.into_iter().enumerate().filter(|_| on_faces) {
        let node = GHOST + side * n;
        match rule {
            Rule::MirrorPlane { .. } => add(Image { to: node, from: node, sign: zero, doubled: zero, plane: Some(side), fraction: half }),
            Rule::Mirror { .. } if grid.boundary[axis][side].blocks_flow() => add(Image { to: node, from: node, ..Image::default() }),
            Rule::Mirror { .. } | Rule::Wrap | Rule::Keep => {}
        }
    }
    for (side, rule) in rules.into_iter().enumerate() {
        for m in 1..=GHOST {
            let (to, from) = ghost(n, side, m, on_faces, matches!(rule, Rule::Wrap));
            add(match rule {
                Rule::Keep => continue,
                Rule::Wrap => Image { to, from, sign: R::one(), ..Image::default() },
                Rule::Mirror { sign, doubled } => Image { to, from, sign, doubled, ..Image::default() },
                Rule::MirrorPlane { sign, .. } => Image { to, from, sign, plane: Some(side), fraction: R::one(), ..Image::default() },
            });
        }
    }
    (images, used)
}

/// Assignment of one value on a line from another: `sign·(value from) + doubled + fraction·(value of the plane)`.
#[derive(Clone, Copy, Default)]
struct Image<R> {
    to: usize,
    from: usize,
    sign: R,
    doubled: R,
    plane: Option<usize>,
    fraction: R,
}

/// Applies `images` to a block of lines with `stride` values between neighbours on a line; the block's first value has number `first` in the planes.
#[inline(always)]
fn apply<R: Real>(images: &[Image<R>], planes: [&[R]; 2], block: &mut [R], stride: usize, first: usize) {
    for &Image { to, from, sign, doubled, plane, fraction } in images {
        let [to, from] = [to * stride, from * stride];
        if let Some(side) = plane {
            for inner in 0..stride {
                block[to + inner] = sign * block[from + inner] + fraction * planes[side][first + inner];
            }
        } else if sign == R::zero() {
            block[to..to + stride].fill(doubled);
        } else {
            let (low, high) = block.split_at_mut(to.max(from));
            let (target, source) =
                if to < from { (&mut low[to..to + stride], &high[..stride]) } else { (&mut high[..stride], &low[from..from + stride]) };
            target.iter_mut().zip(source).for_each(|(target, &source)| *target = sign * source + doubled);
        }
    }
}

/// Indices in memory of the m-th ghost beyond a face and of its image; on axes with too few cells the nearest value.
fn ghost(n: usize, side: usize, m: usize, on_faces: bool, wraps: bool) -> (usize, usize) {
    match (side, on_faces) {
        (0, _) if wraps => (GHOST - m, GHOST + (n - m % n) % n),
        (_, _) if wraps => (GHOST + n - 1 + m, GHOST + (m - 1) % n),
        (0, false) => (GHOST - m, GHOST + (m - 1).min(n - 1)),
        (0, true) => (GHOST - m, GHOST + m.min(n)),
        (_, false) => (GHOST + n - 1 + m, GHOST + n - m.min(n)),
        (_, true) => (GHOST + n + m, GHOST + n - m.min(n)),
    }
}
