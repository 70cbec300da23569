//! What the faces of the box and solid cells make of a velocity: the values the flow does not decide.

use super::{Boundary, Field, GHOST, Grid, Place, Real, Velocity};

/// A velocity (m/s) as a function of position (m) and time (s).
pub type Prescribed = Box<dyn Fn([f64; 3], f64) -> [f64; 3] + Send + Sync>;

/// Fills in the boundary's share of fields: faces that are closed or blown through, ghosts, and the faces of solid cells.
///
/// A value half a cell beyond a face that holds a value w is `2w − (its mirror image)`; beyond a face that holds none, the mirror image itself. Both are second
/// order. Ghosts are filled along x, then y, then z, so that edges and corners agree.
pub struct Walls<R> {
    grid: Grid<R>,
    /// Twice the velocity on faces of inflow, per axis, side and component, over the plane of the face.
    inflow: Vec<Inflow<R>>,
    prescribed: Prescribed,
    /// For each component, the faces in memory that a solid cell closes.
    closed: [Vec<usize>; 3],
}

struct Inflow<R> {
    axis: usize,
    side: usize,
    doubled: [Vec<R>; 3],
}

/// What the values on and beyond faces of inflow are made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Beyond {
    /// The velocity prescribed there: for air whose divergence is out.
    Prescribed,
    /// The straight line through the two values inside: for air on its way, which the pressure has yet to push. Prescribed values, which it has pushed, would be
    /// off by `dt·∇p`.
    Extended,
    /// Themselves.
    Kept,
}

/// How the values at and beyond one face follow from the ones before it: `sign·(mirror image) + doubled`.
#[derive(Clone, Copy)]
enum Rule<'a, R> {
    Wrap,
    Keep,
    Mirror { sign: R, doubled: R },
    MirrorPlane { sign: R, doubled: &'a [R] },
}

impl<R: Real> Walls<R> {
    /// The walls of `grid`, through whose faces of inflow `prescribed` blows.
    pub fn new(grid: &Grid<R>, prescribed: Prescribed) -> Self {
        let plane_len = |axis: usize| grid.padded_len() / grid.padded()[axis];
        let faces = (0..3).flat_map(|axis| [0, 1].map(|side| (axis, side)));
        let inflow = faces
            .filter(|&(axis, side)| grid.boundary[axis][side] == Boundary::Inflow)
            .map(|(axis, side)| Inflow { axis, side, doubled: std::array::from_fn(|_| vec![R::zero(); plane_len(axis)]) })
            .collect();
        let mut walls = Self { grid: *grid, inflow, prescribed, closed: Default::default() };
        walls.blow(0.0);
        walls
    }

    /// Changes what blows through faces of inflow.
    pub fn prescribe(&mut self, prescribed: Prescribed) {
        self.prescribed = prescribed;
    }

    /// Makes cells solid: `solid` has one entry per cell, x fastest.
    pub fn set_solid(&mut self, solid: &[bool]) {
        let grid = self.grid;
        let [nx, ny, nz] = grid.cells;
        for (axis, closed) in self.closed.iter_mut().enumerate() {
            closed.clear();
            for n in (0..nx * ny * nz).filter(|&n| solid[n]) {
                let near = [n % nx, n / nx % ny, n / (nx * ny)];
                let mut far = near;
                far[axis] += 1;
                if far[axis] == grid.cells[axis] && grid.wraps(axis) {
                    far[axis] = 0;
                }
                closed.extend([grid.at(near), grid.at(far)]);
            }
            closed.sort_unstable();
            closed.dedup();
        }
    }

    /// Takes the velocity on faces of inflow at a time (s). Where the box has no outflow, what comes in and goes out is made to balance by an equal shift
    /// of the normal velocity on all these faces, without which no pressure could take the divergence out.
    pub fn blow(&mut self, time_secs: f64) {
        let grid = self.grid;
        for Inflow { axis, side, doubled } in &mut self.inflow {
            let across: [usize; 2] = if *axis == 0 { [1, 2] } else { [0, if *axis == 1 { 2 } else { 1 }] };
            let len = across.map(|a| grid.padded()[a]);
            for (component, plane) in doubled.iter_mut().enumerate() {
                for (n, value) in plane.iter_mut().enumerate() {
                    let mut position = [0.0; 3];
                    position[*axis] = if *side == 0 { 0.0 } else { grid.extent_m(*axis).wide() };
                    for (a, index) in across.into_iter().zip([n % len[0], n / len[0]]) {
                        let offset = grid.offset(Place::Face(component), a).wide();
                        position[a] = (index as f64 - GHOST as f64 + offset) * grid.spacing_m[a].wide();
                    }
                    *value = R::of(2.0 * (self.prescribed)(position, time_secs)[component]);
                }
            }
        }
        let has_outflow = grid.boundary.iter().flatten().any(|&face| face == Boundary::Outflow);
        if !has_outflow && !self.inflow.is_empty() {
            self.balance();
        }
    }

    fn balance(&mut self) {
        let grid = self.grid;
        let inner = |axis: usize| {
            let [a, b] = if axis == 0 { [1, 2] } else { [0, if axis == 1 { 2 } else { 1 }] };
            let row = grid.padded()[a];
            let cell_m2 = grid.spacing_m[a].wide() * grid.spacing_m[b].wide();
            let at = (0..grid.cells[b]).flat_map(move |k| (0..grid.cells[a]).map(move |i| i + GHOST + row * (k + GHOST)));
            (at, cell_m2)
        };
        let (mut doubled_out, mut area_m2) = (0.0, 0.0);
        for Inflow { axis, side, doubled } in &self.inflow {
            let outward = if *side == 0 { -1.0 } else { 1.0 };
            let (at, cell_m2) = inner(*axis);
            for n in at {
                doubled_out += outward * doubled[*axis][n].wide() * cell_m2;
                area_m2 += cell_m2;
            }
        }
        for Inflow { axis, side, doubled } in &mut self.inflow {
            let inward = if *side == 0 { 1.0 } else { -1.0 };
            let shift = R::of(inward * doubled_out / area_m2);
            doubled[*axis].iter_mut().for_each(|value| *value = *value + shift);
        }
    }

    /// Fills in everything of a staggered velocity that the flow does not decide.
    pub fn close(&self, velocity: &mut Velocity<R>) {
        self.close_with(velocity, Beyond::Prescribed);
    }

    /// [`Walls::close`] with other values on faces of inflow.
    pub fn close_with(&self, velocity: &mut Velocity<R>, beyond: Beyond) {
        for field in &mut velocity.0 {
            self.close_component_with(field, beyond);
        }
        for axis in 0..3 {
            for side in [0, 1] {
                if self.grid.boundary[axis][side] == Boundary::Outflow {
                    self.still_the_outside(velocity, axis, side);
                }
            }
        }
    }

    /// Lets air that comes in through a face of outflow come from rest: taking on what is inside it would gain energy from nowhere and blow up.
    fn still_the_outside(&self, velocity: &mut Velocity<R>, axis: usize, side: usize) {
        let (grid, strides) = (&self.grid, self.grid.strides());
        let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
        let n = grid.cells[axis];
        let (node, outside) = if side == 0 { (GHOST, [GHOST - 1, GHOST - 2]) } else { (GHOST + n, [GHOST + n, GHOST + n + 1]) };
        for m in GHOST..GHOST + grid.cells[a] + 1 {
            for l in GHOST..GHOST + grid.cells[b] + 1 {
                let at = |index: usize| index * strides[axis] + m * strides[a] + l * strides[b];
                let through = velocity.0[axis].data[at(node)];
                let comes_in = if side == 0 { through > R::zero() } else { through < R::zero() };
                if comes_in {
                    for component in [a, b] {
                        outside.iter().for_each(|&index| velocity.0[component].data[at(index)] = R::zero());
                    }
                    let beyond = if side == 0 { outside } else { outside.map(|index| index + 1) };
                    beyond.iter().for_each(|&index| velocity.0[axis].data[at(index)] = R::zero());
                }
            }
        }
    }

    /// [`Walls::close`] for one component.
    pub fn close_component(&self, field: &mut Field<R>) {
        self.close_component_with(field, Beyond::Prescribed);
    }

    /// [`Walls::close_with`] for one component.
    pub fn close_component_with(&self, field: &mut Field<R>, beyond: Beyond) {
        let Place::Face(component) = field.place else { unreachable!("velocity components live on faces") };
        // Before, so that what wraps is the image of closed faces; after, for those on the box's own.
        self.shut(field, component);
        for axis in 0..3 {
            let is_inflow = [0, 1].map(|side| self.grid.boundary[axis][side] == Boundary::Inflow);
            let own = |side: usize| is_inflow[side] && beyond != Beyond::Prescribed;
            let rules = [0, 1].map(|side| if own(side) { Rule::Keep } else { self.rule(component, axis, side) });
            self.fill(field, axis, rules);
            (0..2).filter(|&side| own(side) && beyond == Beyond::Extended).for_each(|side| self.extend(field, axis, side));
        }
        self.shut(field, component);
    }

    /// Continues the straight line through the two values nearest to a face on and beyond it; of a box too thin for two, the one.
    fn extend(&self, field: &mut Field<R>, axis: usize, side: usize) {
        let (grid, n, stride) = (&self.grid, self.grid.cells[axis], self.grid.strides()[axis]);
        let free = grid.free(field.place, axis);
        let Some(last) = free.clone().last() else { return };
        let [near, next] =
            if side == 0 { [free.start, (free.start + 1).min(last)] } else { [last, last.saturating_sub(1).max(free.start)] };
        let outside = if side == 0 { 0..near + GHOST } else { near + GHOST + 1..n + 2 * GHOST + 1 };
        for line in field.data.chunks_mut(stride * grid.padded()[axis]) {
            for inner in 0..stride {
                let at = |index: usize| index * stride + inner;
                let (here, slope) = (line[at(near + GHOST)], line[at(near + GHOST)] - line[at(next + GHOST)]);
                for index in outside.clone() {
                    line[at(index)] = here + R::of(index.abs_diff(near + GHOST) as f64) * slope;
                }
            }
        }
    }

    fn shut(&self, field: &mut Field<R>, component: usize) {
        self.closed[component].iter().for_each(|&at| field.data[at] = R::zero());
    }

    /// Fills in the ghosts of a concentration: none comes in, none passes closed faces.
    pub fn close_concentration(&self, field: &mut Field<R>) {
        for axis in 0..3 {
            let rules = self.grid.boundary[axis].map(|face| match face {
                Boundary::Wrap => Rule::Wrap,
                Boundary::Inflow => Rule::Mirror { sign: R::zero(), doubled: R::zero() },
                _ => Rule::Mirror { sign: R::one(), doubled: R::zero() },
            });
            self.fill(field, axis, rules);
        }
    }

    fn rule(&self, component: usize, axis: usize, side: usize) -> Rule<'_, R> {
        let (zero, one) = (R::zero(), R::one());
        let normal = component == axis;
        match self.grid.boundary[axis][side] {
            Boundary::Wrap => Rule::Wrap,
            Boundary::FreeSlip | Boundary::Reflect => Rule::Mirror { sign: if normal { -one } else { one }, doubled: zero },
            // Without divergence the normal velocity of air that sticks leaves the wall with slope 0.
            Boundary::NoSlip => Rule::Mirror { sign: if normal { one } else { -one }, doubled: zero },
            Boundary::Lid { velocity_m_per_s } => {
                let doubled = R::of(2.0 * f64::from(velocity_m_per_s[component]));
                if normal { Rule::Mirror { sign: one, doubled: zero } } else { Rule::Mirror { sign: -one, doubled } }
            }
            Boundary::Inflow => {
                let face = self.inflow.iter().find(|inflow| inflow.axis == axis && inflow.side == side);
                Rule::MirrorPlane { sign: -one, doubled: &face.expect("every face of inflow has one").doubled[component] }
            }
            Boundary::Outflow => Rule::Mirror { sign: one, doubled: zero },
        }
    }

    fn fill(&self, field: &mut Field<R>, axis: usize, rules: [Rule<'_, R>; 2]) {
        let (grid, n, stride) = (&self.grid, self.grid.cells[axis], self.grid.strides()[axis]);
        let on_faces = field.place == Place::Face(axis);
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
                Rule::MirrorPlane { .. } => add(Image { to: node, from: node, sign: zero, doubled: zero, plane: Some(side), share: half }),
                Rule::Mirror { .. } if grid.boundary[axis][side].is_closed() => add(Image { to: node, from: node, ..Image::default() }),
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
                    Rule::MirrorPlane { sign, .. } => Image { to, from, sign, plane: Some(side), share: R::one(), ..Image::default() },
                });
            }
        }
        let images = &images[..used];
        let planes = rules.map(|rule| if let Rule::MirrorPlane { doubled, .. } = rule { doubled } else { &[] });

        // Lines whose ghosts along later axes are not filled yet are left out: those ghosts are made from whole lines.
        let [sy, sz] = [grid.strides()[1], grid.strides()[2]];
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
            1 => inner(2).for_each(|k| apply(images, planes, &mut field.data[k * sz..(k + 1) * sz], stride, k * sy)),
            _ => apply(images, planes, &mut field.data, stride, 0),
        }
    }
}

/// One line of values along an axis set from another: `sign·(value from) + doubled`, with the share of a plane's value where there is one.
#[derive(Clone, Copy, Default)]
struct Image<R> {
    to: usize,
    from: usize,
    sign: R,
    doubled: R,
    plane: Option<usize>,
    share: R,
}

/// Sets lines of `block`, each of `stride` values, from others; the block's first value is number `first` of the planes.
#[inline(always)]
fn apply<R: Real>(images: &[Image<R>], planes: [&[R]; 2], block: &mut [R], stride: usize, first: usize) {
    for &Image { to, from, sign, doubled, plane, share } in images {
        let [to, from] = [to * stride, from * stride];
        if let Some(side) = plane {
            for inner in 0..stride {
                block[to + inner] = sign * block[from + inner] + share * planes[side][first + inner];
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

/// Indices in memory of the m-th ghost beyond a face and of the value it images; on axes of few cells the nearest there is.
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

#[cfg(test)]
mod tests {
    use super::Boundary::*;
    use super::*;

    fn still() -> Prescribed {
        Box::new(|_, _| [0.0; 3])
    }

    fn row(grid: &Grid<f64>, field: &Field<f64>) -> Vec<f64> {
        let start = grid.at([0, 0, 0]) - GHOST;
        field.data[start..start + grid.padded()[0]].to_vec()
    }

    fn closed(low: Boundary, high: Boundary, place: usize, prescribed: Prescribed) -> Vec<f64> {
        let grid = Grid { cells: [4, 1, 1], spacing_m: [1.0; 3], boundary: [[low, high], [Wrap; 2], [Wrap; 2]] };
        let mut field = Field::zeros(&grid, Place::Face(place));
        field.fill(&grid, |[x, ..]| 1.0 + x);
        Walls::new(&grid, prescribed).close_component(&mut field);
        row(&grid, &field)
    }

    #[test]
    fn each_face_leaves_its_mark_on_the_normal_velocity() {
        assert_eq!(closed(Wrap, Wrap, 0, still())[..8], [3.0, 4.0, 1.0, 2.0, 3.0, 4.0, 1.0, 2.0]);
        assert_eq!(closed(FreeSlip, Reflect, 0, still()), [-3.0, -2.0, 0.0, 2.0, 3.0, 4.0, 0.0, -4.0, -3.0]);
        assert_eq!(closed(NoSlip, Lid { velocity_m_per_s: [0.0, 7.0, 0.0] }, 0, still()), [3.0, 2.0, 0.0, 2.0, 3.0, 4.0, 0.0, 4.0, 3.0]);
        assert_eq!(closed(FreeSlip, Outflow, 0, still()), [-3.0, -2.0, 0.0, 2.0, 3.0, 4.0, 5.0, 4.0, 3.0]);
    }

    #[test]
    fn each_face_leaves_its_mark_on_the_velocity_along_it() {
        let (lid, inflow): (_, Prescribed) = (Lid { velocity_m_per_s: [0.0, 7.0, 0.0] }, Box::new(|_, _| [0.0, 2.0, 0.0]));
        // Centres lie half a cell inside: the values are 1.5, 2.5, 3.5, 4.5.
        assert_eq!(closed(FreeSlip, NoSlip, 1, still())[..8], [2.5, 1.5, 1.5, 2.5, 3.5, 4.5, -4.5, -3.5]);
        assert_eq!(closed(lid, Outflow, 1, still())[..8], [11.5, 12.5, 1.5, 2.5, 3.5, 4.5, 4.5, 3.5]);
        assert_eq!(closed(Inflow, FreeSlip, 1, inflow)[..8], [1.5, 2.5, 1.5, 2.5, 3.5, 4.5, 4.5, 3.5]);
    }

    #[test]
    fn air_on_its_way_is_continued_beyond_faces_of_inflow() {
        let grid = Grid { cells: [4, 1, 1], spacing_m: [1.0f64; 3], boundary: [[Inflow; 2], [Wrap; 2], [Wrap; 2]] };
        for place in [0, 1] {
            let mut field = Field::zeros(&grid, Place::Face(place));
            field.fill(&grid, |[x, ..]| if (1.0..4.0).contains(&x) || place == 1 { 3.0 * x } else { 50.0 });
            let walls = Walls::new(&grid, still());
            walls.close_component_with(&mut field, Beyond::Extended);
            let extended = row(&grid, &field);
            let offset = if place == 0 { 0.0 } else { 0.5 };
            assert!((0..extended.len()).all(|i| extended[i] == 3.0 * (i as f64 - 2.0 + offset)), "{extended:?}");
            walls.close_component_with(&mut field, Beyond::Kept);
            assert_eq!(row(&grid, &field), extended);
        }
    }

    #[test]
    fn inflow_without_outflow_is_balanced() {
        let prescribed: Prescribed = Box::new(|[x, ..], time| [1.0 + x + time, 0.0, 0.0]);
        let found = closed(Inflow, Inflow, 0, prescribed);
        assert_eq!([found[GHOST], found[GHOST + 4]], [3.0, 3.0]);
    }

    #[test]
    fn faces_of_solid_cells_are_closed() {
        let grid = Grid { cells: [4, 1, 1], spacing_m: [1.0f64; 3], boundary: [[Wrap; 2]; 3] };
        let mut walls = Walls::new(&grid, still());
        walls.set_solid(&[false, false, false, true]);
        let mut field = Field::zeros(&grid, Place::Face(0));
        field.fill(&grid, |_| 1.0);
        walls.close_component(&mut field);
        assert_eq!(field.values(&grid).collect::<Vec<_>>(), [0.0, 1.0, 1.0, 0.0]);
    }
}
