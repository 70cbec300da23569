//! Posture tables of a component for every direction and size of its load (Endo et al. 2003, §4.2).

use super::rest::{Load, balanced, moments};
use super::strength::weakest;
use std::f64::consts::PI;

/// Load Λ = |R|·L²/EI in the middle of a table's load axis; bending per load is largest near it, as upright components buckle at 7.8.
pub const MIDDLE_LOAD: f32 = 8.0;

/// Load of the first nodes of a table: so light that it bends no intact component (by 1e-4 rad), and enough for a broken one to hang.
const LEAST_LOAD: f64 = 1e-3;

/// Size of a posture table.
///
/// With the default, over all angles and loads up to 200, the tip is off by 0.2 % of the length (root mean square; 95 % of tips by less) if
/// interpolated, and by 2.4 % at the nearest node. With half as many loads that is 0.5 % and 3.8 %, with half as many angles 0.3 % and 4 %. The
/// largest interpolation error, 12 %, is at one point: nearly upright at the buckling load, where the shape has a cusp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nodes {
    /// Number of angles φ between the unbent axis and the direction against the load, at least 2. Default 33.
    pub angles: usize,
    /// Number of loads, at least 2. Default 33.
    pub loads: usize,
}

impl Default for Nodes {
    fn default() -> Self {
        Self { angles: 33, loads: 33 }
    }
}

/// Postures in the plane of the unbent axis and the load, tabulated over the angle φ between that axis and the direction against the load, and over
/// the load.
///
/// # Layout
/// Node `(a, l)` starts at `(a·loads + l)·stride`. It has the angle of each section from the unbent axis towards the load (rad), from the base, and
/// then a lever: the largest moment at a joint relative to that joint's strength is Λ times the lever (in units of EI/L). So `stride` is the number
/// of sections plus one. Angles rotate sections, so an interpolated posture keeps its length exactly.
///
/// Angles φ are `π·(a/(angles − 1))²`, denser near upright, and loads `Λ/(Λ + 8) = l/(loads − 1)`: the last is infinite, and aligns all sections with
/// the load. As φ ≥ 0, there is only one side to fall to, and nothing is interpolated across upright.
#[derive(Clone, Debug, PartialEq)]
pub struct Postures {
    nodes: Nodes,
    stride: usize,
    values: Vec<f32>,
}

impl Postures {
    /// Balanced postures of a chain of `joints` whose strength relative to the base is `strength_fractions` (both as in [`rest`](super::rest) and
    /// [`strength`](super::strength)).
    pub fn new(joints: &[f64], strength_fractions: &[f64], nodes: Nodes) -> Self {
        let sections = joints.len();
        let (mut bends_rad, mut found) = (vec![0.0; sections], vec![0.0; sections]);
        let mut values = Vec::with_capacity(nodes.angles * nodes.loads * (sections + 1));
        for angle in 0..nodes.angles {
            let fraction = angle as f64 / (nodes.angles - 1) as f64;
            let unbent_rad = PI * fraction * fraction;
            for step in 0..nodes.loads - 1 {
                let fraction = step as f64 / (nodes.loads - 1) as f64;
                let load = (f64::from(MIDDLE_LOAD) * fraction / (1.0 - fraction)).max(LEAST_LOAD);
                balanced(joints, Load { spread: load, tip: 0.0 }, unbent_rad, &mut bends_rad);
                moments(Load { spread: 1.0, tip: 0.0 }, unbent_rad, &bends_rad, &mut found);
                values.extend(bends_rad.iter().map(|&bend_rad| bend_rad as f32));
                values.push(weakest(strength_fractions, &found).1 as f32);
            }
            values.extend(std::iter::repeat_n((PI - unbent_rad) as f32, sections));
            values.push(0.0);
        }
        Self { nodes, stride: sections + 1, values }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> Nodes {
        self.nodes
    }

    /// Numbers per node.
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// All nodes, in the layout above.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Position of an angle and a load in the table, in nodes.
    fn place(&self, cosine: f32, load: f32) -> [f32; 2] {
        let angle = (acos(cosine.clamp(-1.0, 1.0)) * std::f32::consts::FRAC_1_PI).sqrt();
        let load = 1.0 - MIDDLE_LOAD / (load + MIDDLE_LOAD);
        [angle * (self.nodes.angles - 1) as f32, load * (self.nodes.loads - 1) as f32]
    }

    fn node(&self, angle: usize, load: usize) -> &[f32] {
        let start = (angle * self.nodes.loads + load) * self.stride;
        &self.values[start..start + self.stride]
    }

    /// The node nearest to the angle φ with that cosine and the load Λ ≥ 0; for distant plants.
    pub fn nearest(&self, cosine: f32, load: f32) -> &[f32] {
        let [angle, load] = self.place(cosine, load);
        self.node(((angle + 0.5) as usize).min(self.nodes.angles - 1), ((load + 0.5) as usize).min(self.nodes.loads - 1))
    }

    /// Writes the bilinear interpolation between the four nodes about the angle φ with that cosine and the load Λ ≥ 0.
    pub fn interpolated(&self, cosine: f32, load: f32, node: &mut [f32]) {
        let place = self.place(cosine, load);
        let [a, l] = [(place[0] as usize).min(self.nodes.angles - 2), (place[1] as usize).min(self.nodes.loads - 2)];
        let [by_angle, by_load] = [place[0] - a as f32, place[1] - l as f32];
        let corners = [self.node(a, l), self.node(a, l + 1), self.node(a + 1, l), self.node(a + 1, l + 1)];
        let weights = [(1.0 - by_angle) * (1.0 - by_load), (1.0 - by_angle) * by_load, by_angle * (1.0 - by_load), by_angle * by_load];
        for (i, out) in node[..self.stride].iter_mut().enumerate() {
            *out = (weights[0] * corners[0][i] + weights[1] * corners[1][i]) + (weights[2] * corners[2][i] + weights[3] * corners[3][i]);
        }
    }
}

/// Coefficients of √(1 − x)·(c₀ + c₁x + c₂x² + c₃x³) for the angle of a cosine x ≥ 0.
pub const ARC_COSINE: [f32; 4] = [1.570_728_8, -0.212_114_4, 0.074_261, -0.018_729_3];

/// Angle (rad) of a cosine in −1..=1, with an error of 7e-5: Abramowitz & Stegun 1964, 4.4.45.
fn acos(cosine: f32) -> f32 {
    let [c0, c1, c2, c3] = ARC_COSINE;
    let size = cosine.abs();
    let angle = (1.0 - size).sqrt() * (c0 + size * (c1 + size * (c2 + size * c3)));
    if cosine < 0.0 { std::f32::consts::PI - angle } else { angle }
}

#[cfg(test)]
mod tests {
    use super::super::{rest::joints, strength::fractions};
    use super::*;
    use proptest::prelude::*;

    fn table(tip_fraction: f64, nodes: Nodes) -> Postures {
        Postures::new(&joints(8, tip_fraction), &fractions(8, tip_fraction), nodes)
    }

    fn tip(unbent_rad: f64, bends_rad: impl Iterator<Item = f64>) -> [f64; 2] {
        bends_rad.take(8).fold([0.0; 2], |[x, y], bend| [x + (unbent_rad + bend).sin() / 8.0, y + (unbent_rad + bend).cos() / 8.0])
    }

    /// Distance of a looked-up tip from its balanced position, in lengths.
    fn off(tip_fraction: f64, unbent_rad: f64, load: f64, node: &[f32]) -> f64 {
        let mut exact = [0.0; 8];
        balanced(&joints(8, tip_fraction), Load { spread: load, tip: 0.0 }, unbent_rad, &mut exact);
        let [a, b] = [tip(unbent_rad, node.iter().map(|&v| f64::from(v))), tip(unbent_rad, exact.into_iter())];
        (a[0] - b[0]).hypot(a[1] - b[1])
    }

    fn between(table: &Postures, unbent_rad: f64, load: f64) -> [f32; 9] {
        let mut node = [0.0; 9];
        table.interpolated(unbent_rad.cos() as f32, load as f32, &mut node);
        node
    }

    #[test]
    fn the_default_table_is_as_close_as_it_says() {
        for tip_fraction in [0.1, 0.5, 1.0] {
            let table = table(tip_fraction, Nodes::default());
            let mut errors = Vec::new();
            for i in 0..60 {
                for k in 0..60 {
                    let unbent_rad = PI * ((f64::from(i) + 0.37) / 60.0).powf(1.5);
                    let load = 10f64.powf(-1.0 + 3.3 * (f64::from(k) + 0.41) / 60.0);
                    let nearest = table.nearest(unbent_rad.cos() as f32, load as f32);
                    errors.push([
                        off(tip_fraction, unbent_rad, load, &between(&table, unbent_rad, load)),
                        off(tip_fraction, unbent_rad, load, nearest),
                    ]);
                }
            }
            errors.sort_by(|a, b| a[0].total_cmp(&b[0]));
            let rms = |which: usize| (errors.iter().map(|e| e[which] * e[which]).sum::<f64>() / errors.len() as f64).sqrt();
            assert!(rms(0) < 0.0026 && rms(1) < 0.026, "{} and {}", rms(0), rms(1));
            assert!(errors[errors.len() * 95 / 100][0] < 0.0025 && errors[errors.len() - 1][0] < 0.13);
        }
    }

    #[test]
    fn more_nodes_come_closer_with_their_square() {
        let worst = |nodes: usize| {
            let table = table(0.5, Nodes { angles: nodes, loads: nodes });
            let places = (0..40).flat_map(|i| (0..40).map(move |k| (0.5 + 2.5 * f64::from(i) / 40.0, 0.1 + f64::from(k))));
            places.map(|(unbent_rad, load)| off(0.5, unbent_rad, load, &between(&table, unbent_rad, load))).fold(0.0, f64::max)
        };
        let [coarse, fine] = [worst(17), worst(65)];
        let order = (coarse / fine).log2() / 2.0;
        assert!(order > 1.7, "order {order} of {coarse} and {fine}");
    }

    #[test]
    fn a_little_off_upright_a_buckled_component_falls_its_own_way() {
        let table = table(1.0, Nodes::default());
        for unbent_rad in [0.0, 1e-4, 0.003, 0.01, 0.03] {
            for load in [10.0, 15.0, 30.0, 100.0] {
                let error = off(1.0, unbent_rad, load, &between(&table, unbent_rad, load));
                assert!(error < 0.03, "{error} at {unbent_rad} and {load}");
            }
            assert!(between(&table, unbent_rad, 12.0)[..8].iter().all(|&bend| bend > 0.1), "bent, whatever little it is off upright");
        }
        assert!(between(&table, 0.0, 5.0)[..8].iter().all(|bend| bend.abs() < 1e-6), "stands");
    }

    #[test]
    fn a_load_without_bound_lays_all_sections_along_itself() {
        let table = table(0.5, Nodes::default());
        for load in [f32::MAX, f32::INFINITY] {
            let mut node = [0.0; 9];
            table.interpolated(0.3, load, &mut node);
            assert!(node[..8].iter().all(|bend| (bend + 0.3f32.acos() - std::f32::consts::PI).abs() < 0.002), "{node:?}");
        }
    }

    #[test]
    fn the_lever_tells_the_moment_at_the_foot() {
        let table = table(0.5, Nodes::default());
        for (unbent_rad, load) in [(0.4, 0.5), (1.5, 3.0), (2.2, 12.0), (1.0, 60.0)] {
            let (mut bends, mut found) = ([0.0; 8], [0.0; 8]);
            balanced(&joints(8, 0.5), Load { spread: load, tip: 0.0 }, unbent_rad, &mut bends);
            moments(Load { spread: load, tip: 0.0 }, unbent_rad, &bends, &mut found);
            let told = f64::from(between(&table, unbent_rad, load)[8]) * load;
            assert!((told - found[0]).abs() < 0.01 * found[0], "{told} and {}", found[0]);
        }
        assert!(between(&table, 1.0, 1e6)[8] < 1e-3, "what lies along a load feels no moment");
    }

    proptest! {
        #[test]
        fn the_arc_cosine_is_as_close_as_it_says(cosine in -1.0f32..=1.0) {
            prop_assert!((f64::from(acos(cosine)) - f64::from(cosine).acos()).abs() < 7e-5);
        }

        #[test]
        fn any_number_is_looked_up(cosine in proptest::num::f32::ANY, load in proptest::num::f32::ANY) {
            let table = table(0.5, Nodes { angles: 3, loads: 3 });
            prop_assert!(table.nearest(cosine, load).len() == 9);
            table.interpolated(cosine, load, &mut [0.0; 9]);
        }
    }
}
