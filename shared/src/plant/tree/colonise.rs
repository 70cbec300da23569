//! Growth of a skeleton by space colonisation (Runions et al. 2007): points in the crown attract the nodes nearest to them, which grow towards the mean
//! direction of their points. A point that a node reaches is taken.
//!
//! Only `+ − × ÷` and roots, so that everyone grows the same tree from the same seed.

use crate::hash::{hash3, unit};
use glam::Vec3;

/// Distance between two nodes (m), in a tree one metre tall.
pub const STEP: f32 = 0.035;
/// Distance from which points attract a node, and at which they are taken (m).
const INFLUENCE: f32 = 0.30;
const TAKEN: f32 = 0.055;
/// Number of attracting points.
const POINTS: usize = 320;
/// Largest number of rounds of growth.
const ROUNDS: usize = 80;
/// Upward growth, relative to the pull of the points.
const LIFT: f32 = 0.12;

/// Crown of a tree one metre tall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrownForm {
    /// Height of its lower end (m).
    pub low: f32,
    /// Height of its upper end (m).
    pub high: f32,
    /// Half its width (m).
    pub wide: f32,
    /// Whether it is a cone, else an ellipsoid.
    pub is_cone: bool,
    /// Height of the upper end of the trunk (m).
    pub trunk_top: f32,
}

impl CrownForm {
    /// Area of its silhouette from the side (m²).
    pub fn silhouette_m2(&self) -> f32 {
        self.wide * (self.high - self.low) * if self.is_cone { 1.0 } else { std::f32::consts::FRAC_PI_2 }
    }

    /// Area of the ground below it (m²).
    pub fn ground_m2(&self) -> f32 {
        std::f32::consts::PI * self.wide * self.wide
    }

    /// Whether it contains a point.
    pub fn contains(&self, at: Vec3) -> bool {
        let up = (at.y - self.low) / (self.high - self.low);
        let aside = (at.x * at.x + at.z * at.z) / (self.wide * self.wide);
        if self.is_cone {
            (0.0..=1.0).contains(&up) && aside <= (1.0 - up) * (1.0 - up)
        } else {
            aside + (2.0 * up - 1.0) * (2.0 * up - 1.0) <= 1.0
        }
    }
}

/// Node of a skeleton.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Its position above the foot of the tree (m), in a tree one metre tall.
    pub at: Vec3,
    /// The node that it grew from, which comes before it; `None` at the foot.
    pub from: Option<usize>,
}

/// Nodes of a tree, and how many of them, from the first, form the trunk: the same for the same form and seed.
pub fn colonised(form: &CrownForm, seed: u32) -> (Vec<Node>, usize) {
    let steps = (form.trunk_top / STEP).max(1.0) as usize;
    let height = |n: usize| Vec3::Y * (form.trunk_top * n as f32 / steps as f32);
    let mut nodes: Vec<Node> = (0..=steps).map(|n| Node { at: height(n), from: n.checked_sub(1) }).collect();
    let mut points: Vec<Point> = points(form, seed).map(|at| Point { at, nearest: 0, distance: f32::INFINITY }).collect();
    let mut grown = 0;
    for _ in 0..ROUNDS {
        points.iter_mut().for_each(|point| point.meet(&nodes, grown));
        points.retain(|point| point.distance > TAKEN);
        grown = nodes.len();
        grow(&mut nodes, &points);
        if nodes.len() == grown {
            break;
        }
    }
    (nodes, steps + 1)
}

/// A point that attracts nodes.
struct Point {
    at: Vec3,
    /// The nearest node and its distance (m).
    nearest: usize,
    distance: f32,
}

impl Point {
    /// Compares its distance with those of the nodes from `first` on.
    fn meet(&mut self, nodes: &[Node], first: usize) {
        for (number, node) in nodes.iter().enumerate().skip(first) {
            let distance = node.at.distance(self.at);
            if distance < self.distance {
                (self.nearest, self.distance) = (number, distance);
            }
        }
    }
}

/// Adds a node to each that points attract, unless it already has one there.
fn grow(nodes: &mut Vec<Node>, points: &[Point]) {
    let count = nodes.len();
    let mut pulls = vec![Vec3::ZERO; count];
    for point in points.iter().filter(|point| point.distance < INFLUENCE) {
        pulls[point.nearest] += (point.at - nodes[point.nearest].at) / point.distance;
    }
    for (from, pull) in pulls.into_iter().enumerate().filter(|(_, pull)| *pull != Vec3::ZERO) {
        let towards = (pull.normalize_or_zero() + LIFT * Vec3::Y).normalize_or_zero();
        let at = nodes[from].at + STEP * towards;
        // Two points on opposite sides of a node pull it to the same place again and again.
        let has_one = nodes.iter().any(|other| other.at.distance_squared(at) < 0.25 * STEP * STEP);
        if !has_one {
            nodes.push(Node { at, from: Some(from) });
        }
    }
}

/// Random points in a crown.
fn points(form: &CrownForm, seed: u32) -> impl Iterator<Item = Vec3> + '_ {
    let candidate = move |n: u32| {
        let [x, y, z] = hash3([n, seed, 0x7e]).map(unit);
        Vec3::new((2.0 * x - 1.0) * form.wide, form.low + y * (form.high - form.low), (2.0 * z - 1.0) * form.wide)
    };
    (0..u32::MAX).map(candidate).filter(move |at| form.contains(*at)).take(POINTS)
}

#[cfg(test)]
mod tests {
    use super::*;

    const OAK: CrownForm = CrownForm { low: 0.26, high: 1.0, wide: 0.42, is_cone: false, trunk_top: 0.59 };
    const PINE: CrownForm = CrownForm { low: 0.14, high: 1.02, wide: 0.30, is_cone: true, trunk_top: 0.92 };

    #[test]
    fn everyone_grows_the_same_tree() {
        let bits = |seed| colonised(&OAK, seed).0.iter().flat_map(|node| node.at.to_array().map(f32::to_bits)).collect::<Vec<u32>>();
        assert_eq!(bits(1), bits(1));
        assert_ne!(bits(1), bits(2));
        // Pinned, so that another machine that grows another tree fails.
        let sum = |form| {
            let (nodes, _) = colonised(form, 7);
            let words = nodes.iter().flat_map(|node| node.at.to_array().map(f32::to_bits));
            words.fold(0xcbf2_9ce4_8422_2325_u64, |sum, word| (sum ^ u64::from(word)).wrapping_mul(0x0100_0000_01b3))
        };
        assert_eq!([sum(&OAK), sum(&PINE)], [1_777_295_005_273_304_121, 13_897_619_379_315_520_781]);
    }

    #[test]
    fn a_tree_fills_its_crown() {
        for form in [OAK, PINE] {
            let (nodes, trunk) = colonised(&form, 3);
            assert!(nodes[..trunk].iter().enumerate().all(|(n, node)| node.from == n.checked_sub(1) && node.at.x == 0.0));
            assert!(nodes.iter().enumerate().skip(1).all(|(n, node)| node.from.is_some_and(|from| from < n)));
            // Every point of the crown has a node nearby; negative control: the trunk alone leaves most of it empty.
            let all: Vec<Vec3> = points(&form, 99).collect();
            let near = |nodes: &[Node]| all.iter().filter(|at| nodes.iter().any(|node| node.at.distance(**at) < 0.12)).count();
            assert!(near(&nodes) > 95 * all.len() / 100, "{} of {}", near(&nodes), all.len());
            assert!(near(&nodes[..trunk]) < all.len() / 2);
            let outside = nodes.iter().filter(|node| node.at.y > form.low && !form.contains(node.at)).count();
            assert!(outside < nodes.len() / 5, "{outside} of {}", nodes.len());
        }
    }
}
