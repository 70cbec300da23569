//! Drag of bodies that let air through or are smaller than the cells.

use super::super::{Grid, Location, Real, Velocity};

/// A body that takes momentum out of the air in a box around it: `∂u/∂t = −a·|u − v|·(u − v)` with v its velocity.
///
/// The total over the box is `drag_m2·|u − v|·(u − v)`, whatever the cells: the drag per length a (1/m) of a cell is its share of `drag_m2` over its volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DragBody {
    /// Centre (m).
    pub centre_m: [f64; 3],
    /// Half of the sides of the box (m), each 0 or more. One narrower than a cell is widened to it.
    pub half_extents_m: [f64; 3],
    /// Velocity (m/s).
    pub velocity_m_per_s: [f64; 3],
    /// Force over density and squared speed (m²) along x, y and z, 0 or more: `½·C_d·A` for a solid body of frontal area A, `C_d·LAD·V` for a crown of volume V and leaf
    /// area density LAD (Shaw & Schumann, Boundary-Layer Meteorol. 61 (1992)).
    pub drag_m2: [f64; 3],
}

impl DragBody {
    /// Whether all numbers are finite, and neither half extents nor drag below 0.
    pub fn is_valid(&self) -> bool {
        let are_finite = |numbers: [f64; 3]| numbers.iter().all(|number| number.is_finite());
        let from_0 = |numbers: [f64; 3]| are_finite(numbers) && numbers.iter().all(|&number| number >= 0.0);
        are_finite(self.centre_m) && are_finite(self.velocity_m_per_s) && from_0(self.half_extents_m) && from_0(self.drag_m2)
    }
}

/// Drag on one face.
#[derive(Clone, Copy, Debug)]
struct DragFace<R> {
    /// Index in memory.
    at: usize,
    /// Drag per length (1/m).
    per_m: R,
    /// Velocity (m/s) after the drag.
    after: R,
}

/// Faces across x, y and z that one body, or all fixed ones, act on.
#[derive(Clone, Debug)]
struct Slowed<R> {
    faces: [Vec<DragFace<R>>; 3],
    velocity_m_per_s: [R; 3],
}

impl<R: Real> Default for Slowed<R> {
    fn default() -> Self {
        Self { faces: Default::default(), velocity_m_per_s: [R::zero(); 3] }
    }
}

/// Drag of all bodies.
#[derive(Clone, Debug)]
pub(crate) struct Drag<R> {
    fixed: Slowed<R>,
    moving: Vec<Slowed<R>>,
    /// Number of moving bodies; further entries are kept for their memory.
    count: usize,
    /// Index and share of the body along each axis.
    shares: [Vec<(usize, f64)>; 3],
}

impl<R: Real> Drag<R> {
    pub(crate) fn none() -> Self {
        Self { fixed: Slowed::default(), moving: Vec::new(), count: 0, shares: Default::default() }
    }

    /// Whether no body acts on the air.
    pub(crate) fn is_empty(&self) -> bool {
        self.count == 0 && self.fixed.faces.iter().all(Vec::is_empty)
    }

    pub(super) fn set_fixed(&mut self, grid: &Grid<R>, bodies: &[DragBody]) {
        self.fixed.faces.iter_mut().for_each(Vec::clear);
        for body in bodies {
            self.fixed.add(grid, body, &mut self.shares);
        }
        for faces in &mut self.fixed.faces {
            faces.sort_by_key(|face| face.at);
            faces.dedup_by(|next, face| {
                let same = next.at == face.at;
                if same {
                    face.per_m = face.per_m + next.per_m;
                }
                same
            });
        }
    }

    pub(super) fn set_moving(&mut self, grid: &Grid<R>, bodies: impl Iterator<Item = DragBody>) {
        self.count = 0;
        for body in bodies {
            if self.count == self.moving.len() {
                self.moving.push(Slowed::default());
            }
            let slowed = &mut self.moving[self.count];
            slowed.faces.iter_mut().for_each(Vec::clear);
            slowed.velocity_m_per_s = body.velocity_m_per_s.map(R::of);
            slowed.add(grid, &body, &mut self.shares);
            self.count += 1;
        }
    }

    /// Memory of the bodies' faces (bytes).
    pub(crate) fn memory_bytes(&self) -> usize {
        let faces = |slowed: &Slowed<R>| slowed.faces.iter().map(|faces| faces.capacity() * size_of::<DragFace<R>>()).sum::<usize>();
        let moving = self.moving.capacity() * size_of::<Slowed<R>>() + self.moving.iter().map(faces).sum::<usize>();
        let shares: usize = self.shares.iter().map(|shares| shares.capacity() * size_of::<(usize, f64)>()).sum();
        faces(&self.fixed) + moving + shares
    }

    /// Applies the drag for `dt_secs` (s), first of the fixed bodies, then of each moving one. The ghosts of `velocity` must be filled.
    pub(crate) fn apply(&mut self, grid: &Grid<R>, dt_secs: f64, velocity: &mut Velocity<R>) {
        let Self { fixed, moving, count, .. } = self;
        for slowed in std::iter::once(fixed).chain(&mut moving[..*count]) {
            slowed.apply(grid, R::of(dt_secs), velocity);
        }
    }
}

impl<R: Real> Slowed<R> {
    fn add(&mut self, grid: &Grid<R>, body: &DragBody, shares: &mut [Vec<(usize, f64)>; 3]) {
        let cell_m3: f64 = grid.spacing_m.iter().map(|h| h.wide()).product();
        for (axis, faces) in self.faces.iter_mut().enumerate() {
            for (along, shares) in shares.iter_mut().enumerate() {
                share_out(grid, Location::Face(axis), along, body, shares);
            }
            let [xs, ys, zs] = &*shares;
            for &(k, z) in zs {
                for &(j, y) in ys {
                    for &(i, x) in xs {
                        let per_m = R::of(x * y * z * body.drag_m2[axis] / cell_m3);
                        faces.push(DragFace { at: grid.at([i, j, k]), per_m, after: R::zero() });
                    }
                }
            }
        }
    }

    /// A backward Euler step, which never overshoots: `u − v` is divided by `1 + dt·a·|u − v|`.
    fn apply(&mut self, grid: &Grid<R>, dt: R, velocity: &mut Velocity<R>) {
        let strides = grid.strides();
        for (axis, faces) in self.faces.iter_mut().enumerate() {
            let own = self.velocity_m_per_s[axis];
            for face in faces {
                let speed = speed_squared(velocity, strides, axis, face.at, self.velocity_m_per_s).sqrt();
                face.after = own + (velocity.0[axis].data[face.at] - own) / (R::one() + dt * face.per_m * speed);
            }
        }
        for (faces, field) in self.faces.iter().zip(&mut velocity.0) {
            faces.iter().for_each(|face| field.data[face.at] = face.after);
        }
    }
}

/// Lists the values along one axis whose cells the body overlaps, with their shares of its width, which add up to 1 unless part of it is beyond the box. On periodic
/// axes it continues on the other side.
fn share_out<R: Real>(grid: &Grid<R>, location: Location, along: usize, body: &DragBody, shares: &mut Vec<(usize, f64)>) {
    shares.clear();
    let (n, spacing_m) = (grid.cells[along] as i64, grid.spacing_m[along].wide());
    let centre = body.centre_m[along] / spacing_m - grid.offset(location, along).wide();
    let half = (body.half_extents_m[along] / spacing_m).max(0.5);
    let free = grid.free(location, along);
    let [first, last] = [(centre - half - 0.5).ceil() as i64, (centre + half + 0.5).floor() as i64];
    if grid.wraps(along) && last - first >= n {
        shares.extend((0..n as usize).map(|i| (i, (n as f64).recip())));
        return;
    }
    let range = if grid.wraps(along) { first..last + 1 } else { first.max(free.start as i64)..last.min(free.end as i64 - 1) + 1 };
    for i in range {
        let [low, high] = [(i as f64 - 0.5).max(centre - half), (i as f64 + 0.5).min(centre + half)];
        let index = if grid.wraps(along) { i.rem_euclid(n) } else { i };
        if high > low {
            shares.push((index as usize, (high - low) / (2.0 * half)));
        }
    }
}

/// Square of the speed (m²/s²) relative to `still_m_per_s` on a face across `axis`, from the mean of the four nearest values of each other component (second order).
#[inline(always)]
pub(crate) fn speed_squared<R: Real>(velocity: &Velocity<R>, strides: [usize; 3], axis: usize, at: usize, still_m_per_s: [R; 3]) -> R {
    let quarter = R::of(0.25);
    let mut squares = R::zero();
    for other in 0..3 {
        let data = &velocity.0[other].data;
        let speed = if other == axis {
            data[at]
        } else {
            let (back, on) = (strides[axis], strides[other]);
            quarter * (data[at] + data[at + on] + data[at - back] + data[at + on - back])
        } - still_m_per_s[other];
        squares = squares + speed * speed;
    }
    squares
}
