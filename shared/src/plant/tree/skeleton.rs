//! Skeleton of a tree: its trunk, limbs and twigs as components with straight axes, and the wood that each of them moves.

use super::colonise::{CrownForm, Node, STEP, colonised};
use glam::Vec3;

/// Largest numbers of limbs on the trunk and of twigs on limbs that bend by themselves; together with the trunk at most
/// [`COMPONENTS_LIMIT`](crate::plant::underbrush::plan::COMPONENTS_LIMIT). Shorter ones belong to their carriers.
const LIMBS: usize = 18;
const TWIGS: usize = 45;
/// Least number of nodes of a limb or twig.
const LEAST_NODES: usize = 3;
/// Radius of the trunk at its foot (m), in a tree one metre tall.
const TRUNK_RADIUS: f32 = 0.016;

/// A component of a tree one metre tall, with its unbent axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limb {
    /// Index of its carrier, which comes before it; `None` for the trunk.
    pub on: Option<usize>,
    /// Position of its foot along the carrier, as a fraction of its length.
    pub at_fraction: f32,
    /// Lower end of its axis (m).
    pub foot: Vec3,
    /// Upper end of its axis (m).
    pub tip: Vec3,
    /// Radius at its foot (m).
    pub radius: f32,
    /// Volume of its wood and of all that it carries (m³).
    pub wood_m3: f32,
    /// Share of the tree's leaves that it carries, itself or on others: 1 for the trunk.
    pub leaves: f32,
}

impl Limb {
    /// Length of its axis (m).
    pub fn length(&self) -> f32 {
        self.foot.distance(self.tip)
    }
}

/// A stretch of wood between forks, which one component moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Wood {
    /// Index of that component.
    pub limb: usize,
    /// Its centre line with radii (m), from the carrier on.
    pub points: Vec<(Vec3, f32)>,
}

/// Skeleton of a tree one metre tall.
#[derive(Clone, Debug, PartialEq)]
pub struct Skeleton {
    /// Components: the trunk, then limbs, then twigs.
    pub limbs: Vec<Limb>,
    /// Number of components among the first that are trunk or limbs.
    pub large: usize,
    /// All wood, thickest first.
    pub wood: Vec<Wood>,
    /// Ends of the wood, which bear leaves, each with the component that moves it.
    pub tips: Vec<(Vec3, usize)>,
}

impl Skeleton {
    /// Grows a tree: the same for the same form and seed.
    pub fn grown(form: &CrownForm, seed: u32) -> Self {
        let (nodes, trunk) = colonised(form, seed);
        let forks = Forks::new(&nodes);
        let chains = chains(&forks, trunk);
        let (movers, large) = movers(&chains);
        let mut skeleton = Self { limbs: Vec::new(), large, wood: Vec::new(), tips: Vec::new() };
        let mut limb_of = vec![usize::MAX; chains.len()];
        for (index, &number) in movers.iter().enumerate() {
            limb_of[number] = index;
            let on = chains[number].on.map(|on| limb_of[on]);
            let limb = skeleton.limb(&nodes, &forks, &chains[number], on);
            skeleton.limbs.push(limb);
        }
        for (number, chain) in chains.iter().enumerate() {
            if limb_of[number] == usize::MAX {
                // Its carrier comes before it.
                limb_of[number] = chain.on.map_or(0, |on| limb_of[on]);
            }
            let points = chain.nodes.iter().enumerate().map(|(n, &node)| {
                let thick = chain.nodes[n.max(1)];
                (nodes[node].at, forks.radius(thick))
            });
            let limb = limb_of[number];
            skeleton.wood.push(Wood { limb, points: points.collect() });
            skeleton.tips.push((nodes[chain.end()].at, limb));
        }
        skeleton.wood.sort_by(|a, b| b.points[0].1.total_cmp(&a.points[0].1));
        skeleton
    }

    /// The component of a chain on the component `on`.
    fn limb(&self, nodes: &[Node], forks: &Forks, chain: &Chain, on: Option<usize>) -> Limb {
        let start = nodes[chain.nodes[0]].at;
        let (foot, at_fraction) = on.map_or((start, 0.0), |on| {
            let carrier = &self.limbs[on];
            let axis = carrier.tip - carrier.foot;
            let fraction = ((start - carrier.foot).dot(axis) / axis.length_squared()).clamp(0.0, 1.0);
            (carrier.foot + fraction * axis, fraction)
        });
        let first = chain.nodes[1];
        Limb {
            on,
            at_fraction,
            foot,
            tip: nodes[chain.end()].at,
            radius: forks.radius(first),
            wood_m3: forks.wood_m3[first],
            leaves: forks.tips[first] / forks.tips[0],
        }
    }
}

/// Numbers of the chains that bend by themselves, carriers first, and how many of them are trunk or limbs.
fn movers(chains: &[Chain]) -> (Vec<usize>, usize) {
    let longest = |order: usize, limit: usize, on: &[usize]| {
        let is_long = |&n: &usize| chains[n].order == order && chains[n].nodes.len() > LEAST_NODES;
        let mut all: Vec<usize> =
            (0..chains.len()).filter(is_long).filter(|&n| chains[n].on.is_none_or(|carrier| on.contains(&carrier))).collect();
        all.sort_by_key(|&n| (usize::MAX - chains[n].nodes.len(), n));
        all.truncate(limit);
        all
    };
    let mut movers = vec![0];
    movers.extend(longest(1, LIMBS, &[0]));
    let large = movers.len();
    movers.extend(longest(2, TWIGS, &movers[1..]));
    (movers, large)
}

/// A path of nodes from a fork, or from the foot of the tree, to an end.
struct Chain {
    /// Its nodes, from the one on its carrier.
    nodes: Vec<usize>,
    /// Index of its carrier, which comes before it.
    on: Option<usize>,
    /// Number of its carriers.
    order: usize,
}

impl Chain {
    fn end(&self) -> usize {
        self.nodes[self.nodes.len() - 1]
    }
}

/// All chains: the trunk, then those on it, and so on. At a fork the branch that reaches farthest goes on.
fn chains(forks: &Forks, trunk: usize) -> Vec<Chain> {
    let mut chains = vec![Chain { nodes: (0..trunk).collect(), on: None, order: 0 }];
    let mut next = 0;
    while next < chains.len() {
        let order = chains[next].order + 1;
        let sides: Vec<[usize; 2]> = chains[next]
            .nodes
            .iter()
            .enumerate()
            // The first node belongs to the carrier.
            .skip(usize::from(next > 0))
            .flat_map(|(n, &node)| {
                let goes_on = chains[next].nodes.get(n + 1).copied();
                forks.above[node].iter().filter(move |&&above| Some(above) != goes_on).map(move |&above| [node, above])
            })
            .collect();
        for [node, above] in sides {
            let mut nodes = vec![node, above];
            let mut last = above;
            while let Some(&farther) = forks.above[last].iter().max_by_key(|&&above| (forks.reach[above], usize::MAX - above)) {
                nodes.push(farther);
                last = farther;
            }
            chains.push(Chain { nodes, on: Some(next), order });
        }
        next += 1;
    }
    chains
}

/// Forks of a skeleton: for each node the nodes that grew from it, and the size of everything from it on.
struct Forks {
    above: Vec<Vec<usize>>,
    /// Number of nodes to the farthest end.
    reach: Vec<usize>,
    /// Number of ends.
    tips: Vec<f32>,
    /// Volume of wood (m³).
    wood_m3: Vec<f32>,
}

impl Forks {
    fn new(nodes: &[Node]) -> Self {
        let mut above = vec![Vec::new(); nodes.len()];
        for (number, node) in nodes.iter().enumerate() {
            if let Some(from) = node.from {
                above[from].push(number);
            }
        }
        let mut forks = Self { above, reach: vec![0; nodes.len()], tips: vec![0.0; nodes.len()], wood_m3: vec![0.0; nodes.len()] };
        for number in (0..nodes.len()).rev() {
            let own = &forks.above[number];
            forks.reach[number] = own.iter().map(|&above| forks.reach[above] + 1).max().unwrap_or(0);
            forks.tips[number] = own.iter().map(|&above| forks.tips[above]).sum::<f32>().max(1.0);
        }
        for number in (0..nodes.len()).rev() {
            let radius = forks.radius(number);
            let carried: f32 = forks.above[number].iter().map(|&above| forks.wood_m3[above]).sum();
            forks.wood_m3[number] = carried + std::f32::consts::PI * radius * radius * STEP;
        }
        forks
    }

    /// Radius at a node (m), by the rule `rⁿ = Σ rᵢⁿ` at forks with n = 16/9. Da Vinci's rule has n = 2; roots alone give n = 16/9, whose twigs are
    /// more slender.
    fn radius(&self, node: usize) -> f32 {
        let root = (self.tips[node] / self.tips[0]).sqrt();
        TRUNK_RADIUS * root * root.sqrt().sqrt().sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::underbrush::plan::COMPONENTS_LIMIT;

    #[test]
    fn trunk_limbs_and_twigs_carry_each_other() {
        let form = CrownForm { low: 0.26, high: 1.0, wide: 0.42, is_cone: false, trunk_top: 0.59 };
        let skeleton = Skeleton::grown(&form, 1);
        assert_eq!(skeleton, Skeleton::grown(&form, 1));
        let Skeleton { limbs, large, wood, tips } = &skeleton;
        assert!(*large > 8 && limbs.len() > large + 10 && limbs.len() <= COMPONENTS_LIMIT, "{large} of {}", limbs.len());
        for (number, limb) in limbs.iter().enumerate() {
            let carrier = limb.on.map(|on| &limbs[on]);
            assert!(limb.on.is_none_or(|on| if number < *large { on == 0 } else { (1..*large).contains(&on) }), "{number}");
            assert!(carrier.is_none_or(|carrier| carrier.radius >= limb.radius && carrier.wood_m3 > limb.wood_m3));
            assert!(limb.length() > 2.0 * STEP && limb.leaves > 0.0 && limb.leaves <= 1.0, "{limb:?}");
        }
        assert!(limbs[0].leaves == 1.0 && limbs[0].tip.distance(Vec3::Y * form.trunk_top) < 1e-6);
        assert_eq!(wood.len(), tips.len());
        assert!(wood.windows(2).all(|pair| pair[0].points[0].1 >= pair[1].points[0].1));
        assert!(wood.iter().all(|wood| wood.points.len() > 1 && wood.limb < limbs.len()));
    }
}
