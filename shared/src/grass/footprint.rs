//! Convex footprints on the ground, and the cells within them.

use crate::grid::PatchLayout;

/// A convex polygon on the ground, corners in order (m).
#[derive(Clone, Debug, PartialEq)]
pub struct Footprint {
    corners_m: Vec<[f32; 2]>,
}

/// Relative tolerance for equal widths of a footprint.
const EQUAL_WIDTHS: f32 = 1e-4;

/// Cells of one row of the world's grid of cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// Row along Z.
    pub row: i64,
    /// First cell along X.
    pub from: i64,
    /// One past the last.
    pub to: i64,
}

impl Footprint {
    /// The convex hull of points (Andrew's monotone chain).
    pub fn around(mut points_m: Vec<[f32; 2]>) -> Self {
        points_m.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        let half = |points: &mut dyn Iterator<Item = [f32; 2]>| {
            let mut chain: Vec<[f32; 2]> = vec![];
            for point in points {
                while let [.., a, b] = chain[..]
                    && cross(a, b, point) <= 0.0
                {
                    chain.pop();
                }
                chain.push(point);
            }
            chain.pop();
            chain
        };
        let mut corners_m = half(&mut points_m.iter().copied());
        corners_m.extend(half(&mut points_m.iter().rev().copied()));
        Self { corners_m }
    }

    /// The polygon with these corners, which must be convex and in order from +X towards +Z.
    pub fn of(corners_m: Vec<[f32; 2]>) -> Self {
        Self { corners_m }
    }

    /// The polygon widened to `least_m` along its narrowest direction and then along the next, or `None` when it is wide enough. A strip as wide as a
    /// cell contains a chain of cells that touch at least at their corners, in any direction. Of equally narrow directions the one of the first side is
    /// taken, so that rounding does not rotate the widened polygon of a round object between steps.
    pub fn widened(&self, least_m: f32) -> Option<Self> {
        let mut wide: Option<Self> = None;
        for _ in 0..2 {
            let polygon = wide.as_ref().unwrap_or(self);
            let across = |side: &Edge| polygon.corners_m.iter().map(|&corner| side.depth_m(corner)).fold(0.0, f32::max);
            let widths = polygon.sides().into_iter().map(|side| (across(&side), side.normal));
            let narrowest = widths.reduce(|least, next| if next.0 < least.0 * (1.0 - EQUAL_WIDTHS) { next } else { least });
            let Some((width_m, [x, z])) = narrowest.filter(|(width_m, _)| *width_m < least_m) else { break };
            let out = 0.5 * (least_m - width_m);
            let moved = |by: f32| polygon.corners_m.iter().map(move |corner| [corner[0] + x * by, corner[1] + z * by]);
            wide = Some(Self::around(moved(-out).chain(moved(out)).collect()));
        }
        wide
    }

    /// Corners in order, turning from +X towards +Z (m).
    pub fn corners_m(&self) -> &[[f32; 2]] {
        &self.corners_m
    }

    /// Lowest and highest coordinates (m).
    pub fn bounds_m(&self) -> [[f32; 2]; 2] {
        self.corners_m.iter().fold([[f32::INFINITY; 2], [f32::NEG_INFINITY; 2]], |[low, high], corner| {
            [std::array::from_fn(|axis| low[axis].min(corner[axis])), std::array::from_fn(|axis| high[axis].max(corner[axis]))]
        })
    }

    /// Mean of the corners (m).
    pub fn middle_m(&self) -> [f32; 2] {
        let count = self.corners_m.len().max(1) as f32;
        std::array::from_fn(|axis| self.corners_m.iter().map(|corner| corner[axis]).sum::<f32>() / count)
    }

    /// The cells of the world whose centres are inside, row by row.
    pub fn runs(&self, layout: &PatchLayout) -> Vec<Run> {
        let cells = layout.count.map(|n| i64::from(n) * i64::from(layout.cells));
        let [low, high] = self.bounds_m();
        // The first cell whose centre (i + ½)·h is at or beyond `m` is ⌈m/h − ½⌉.
        let first = |m: f32| (m / layout.cell_m - 0.5).ceil() as i64;
        let rows = first(low[1]).max(0)..first(high[1]).min(cells[1]);
        rows.filter_map(|row| {
            let [from_m, to_m] = self.span_m((row as f32 + 0.5) * layout.cell_m)?;
            let (from, to) = (first(from_m).max(0), first(to_m).min(cells[0]));
            (from < to).then_some(Run { row, from, to })
        })
        .collect()
    }

    /// Interval of X (m) in which the line of constant `z_m` crosses the polygon.
    fn span_m(&self, z_m: f32) -> Option<[f32; 2]> {
        let mut span = [f32::INFINITY, f32::NEG_INFINITY];
        for (a, b) in self.edges() {
            if (a[1] <= z_m) != (b[1] <= z_m) {
                let x = a[0] + (b[0] - a[0]) * ((z_m - a[1]) / (b[1] - a[1]));
                span = [span[0].min(x), span[1].max(x)];
            }
        }
        (span[0] < span[1]).then_some(span)
    }

    /// The polygon's edges as outward normals with their offsets.
    pub fn sides(&self) -> Vec<Edge> {
        self.edges()
            .filter_map(|(a, b)| {
                let [x, z] = [b[0] - a[0], b[1] - a[1]];
                let length = (x * x + z * z).sqrt();
                let normal = [z / length, -x / length];
                (length > 0.0).then_some(Edge { normal, offset_m: normal[0] * a[0] + normal[1] * a[1] })
            })
            .collect()
    }

    fn edges(&self) -> impl Iterator<Item = ([f32; 2], [f32; 2])> {
        let next = self.corners_m.iter().cycle().skip(1);
        self.corners_m.iter().copied().zip(next.copied())
    }
}

/// A side of a footprint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Unit normal, outward.
    pub normal: [f32; 2],
    /// Distance from the origin along the normal (m).
    pub offset_m: f32,
}

impl Edge {
    /// Distance of a point inside the side (m).
    pub fn depth_m(&self, [x, z]: [f32; 2]) -> f32 {
        self.offset_m - (self.normal[0] * x + self.normal[1] * z)
    }
}

fn cross(a: [f32; 2], b: [f32; 2], c: [f32; 2]) -> f32 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAYOUT: PatchLayout = PatchLayout { count: [2, 2], cells: 8, cell_m: 0.5 };

    #[test]
    fn the_hull_drops_inner_points_and_its_normals_point_outward() {
        let hull = Footprint::around(vec![[0.0, 0.0], [2.0, 0.0], [1.0, 0.5], [2.0, 1.0], [0.0, 1.0], [1.0, 0.0]]);
        assert_eq!(hull.corners_m().len(), 4);
        for edge in hull.sides() {
            assert!((edge.depth_m([1.0, 0.5]) - if edge.normal[0] == 0.0 { 0.5 } else { 1.0 }).abs() < 1e-6);
        }
    }

    #[test]
    fn rounding_does_not_turn_the_widened_polygon_of_a_round_object() {
        let ring = |jitter: f32| {
            let at = |n: usize| (n as f32 / 8.0 * std::f32::consts::TAU).sin_cos();
            Footprint::of(
                (0..8)
                    .map(|n| (at(n), 0.174 * if n % 4 == 2 { 1.0 - jitter } else { 1.0 }))
                    .map(|((sin, cos), r)| [r * cos, r * sin])
                    .collect(),
            )
        };
        // Corners within rounding of a straight side may come and go, so supports in many directions are compared.
        let support_m = |polygon: &Footprint, n: usize| {
            let (sin, cos) = (n as f32 / 64.0 * std::f32::consts::TAU).sin_cos();
            polygon.corners_m().iter().map(|[x, z]| x * cos + z * sin).fold(f32::NEG_INFINITY, f32::max)
        };
        let differs = |jitter: f32| {
            let [wide, other] = [0.0, jitter].map(|jitter| ring(jitter).widened(1.0).unwrap());
            (0..64).map(|n| (support_m(&wide, n) - support_m(&other, n)).abs()).fold(0.0, f32::max)
        };
        assert!(differs(1e-6) < 1e-5, "{}", differs(1e-6));
        assert!(differs(0.05) > 1e-2, "a clearly narrower direction counts");
    }

    #[test]
    fn runs_are_the_cells_whose_centres_are_within() {
        let hull = Footprint::around(vec![[1.1, 0.9], [6.2, 2.0], [3.3, 6.6], [0.4, 3.0]]);
        let runs = hull.runs(&LAYOUT);
        for row in 0..16 {
            for cell in 0..16 {
                let center = [(cell as f32 + 0.5) * 0.5, (row as f32 + 0.5) * 0.5];
                let inside = hull.sides().iter().all(|edge| edge.depth_m(center) > 0.0);
                let covered = runs.iter().any(|run| run.row == row && (run.from..run.to).contains(&cell));
                assert_eq!(inside, covered, "cell {cell}, row {row}");
            }
        }
    }

    #[test]
    fn runs_stay_inside_the_world() {
        let hull = Footprint::around(vec![[-50.0, -50.0], [50.0, -50.0], [50.0, 50.0], [-50.0, 50.0]]);
        let runs = hull.runs(&LAYOUT);
        assert_eq!(runs.len(), 16);
        assert!(runs.iter().all(|run| (run.from, run.to) == (0, 16)));
    }
}
