//! Grass as it stands: where the wind holds it, where weight has laid it, and how the field departs from there.
//!
//! The three are leans: vectors on the ground, of the length of the bend, that add up.

use super::air::GroundWind;
use super::contact::{HELD_RAD_PER_S, length, terrain_limit_rad, unit};
use super::footprint::Footprint;
use super::laid::Laid;
use shared::bend::{Bend, Field};
use shared::scene::Scene;
use shared::terrain::{CoverMap, HeightMap, KindMap};
use shared::wire::quantise::THETA_FULL_RAD;

/// What decides how the grass stands.
pub struct Sward<'a> {
    /// The bend field.
    pub field: &'a mut Field,
    /// What stays bent below the weight of objects.
    pub laid: &'a mut Laid,
    /// The wind near the ground.
    pub wind: &'a GroundWind,
    /// The land.
    pub height: &'a HeightMap,
    /// What grows where.
    pub growth: &'a Growth,
}

/// What contact asks of the grass at a place.
#[derive(Clone, Debug)]
pub struct Growth {
    kinds: KindMap,
    /// Largest bend on flat land (rad) and mean height (m) of each kind.
    limits: Vec<(f32, f32)>,
}

impl Growth {
    /// The kinds of grass of a scene over its covering map.
    pub fn new(scene: &Scene, cover: &CoverMap) -> Self {
        let limits = scene.kinds().into_iter().zip(scene.kinds_of_plants()).map(|(grass, plants)| (grass.theta_max_rad, plants.height_m));
        Self { kinds: KindMap::new(scene, cover), limits: limits.collect() }
    }

    fn at(&self, [x_m, z_m]: [f32; 2]) -> (f32, f32) {
        self.limits[usize::from(self.kinds.at(x_m, z_m))]
    }

    /// Largest bend on flat land (rad) of what grows at a place.
    pub fn theta_max_rad(&self, at_m: [f32; 2]) -> f32 {
        self.at(at_m).0
    }

    /// Mean height (m) of what grows at a place.
    pub fn blade_m(&self, at_m: [f32; 2]) -> f32 {
        self.at(at_m).1
    }
}

/// How pressed grass stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pressed {
    /// The whole bend: wind, laid and field together.
    pub bend: Bend,
    /// Share of it that stays for a while, 0..=1.
    pub lays_share: f32,
}

impl Sward<'_> {
    /// Lets `change` press each cell of awake patches within `footprint`, given the cell's centre (m), the bend that it has in all, and the
    /// terrain's limit (rad) by direction; what neither the wind nor the laid lean accounts for is the field's.
    ///
    /// Below what `rests` it is laid, in patches that sleep too, anew whenever it has risen by what a code on the wire tells; nothing is left for the field.
    pub fn for_each_cell(
        &mut self,
        footprint: &Footprint,
        rests: bool,
        mut change: impl FnMut([f32; 2], Bend, &dyn Fn([f32; 2]) -> f32) -> Option<Pressed>,
    ) {
        let layout = *self.field.layout();
        let cells = i64::from(layout.cells);
        for run in footprint.runs(&layout) {
            let (patch_z, j) = (run.row / cells, (run.row % cells) as usize);
            let z_m = (run.row as f32 + 0.5) * layout.cell_m;
            let wind_rad = self.wind.row(z_m);
            for patch_x in run.from / cells..=(run.to - 1) / cells {
                let Some(index) = layout.index(patch_x, patch_z) else { continue };
                let is_awake = self.field.patch(index).is_some();
                if !(is_awake || rests) {
                    continue;
                }
                let first = patch_x * cells;
                for i in run.from.max(first)..run.to.min(first + cells) {
                    let at_m = [(i as f32 + 0.5) * layout.cell_m, z_m];
                    let cell = [i, run.row];
                    let i = (i - first) as usize;
                    let (wind_rad, laid_rad) = (wind_rad(at_m[0]), self.laid.lean_rad(index, i, j));
                    let bend = leaning(self.field.cell(cell), sum(wind_rad, laid_rad), TELLING_RAD_PER_S);
                    let limit_rad =
                        |direction| terrain_limit_rad(self.growth.theta_max_rad(at_m), self.height.slope(at_m[0], at_m[1]), direction);
                    let risen_rad = bend.theta;
                    let Some(Pressed { bend, lays_share }) = change(at_m, bend, &limit_rad) else { continue };
                    if rests {
                        if is_awake || risen_rad < bend.theta - RISE_RAD {
                            self.laid.lay(index, i, j, sum(lean_rad(bend), wind_rad.map(|lean| -lean)));
                            self.field.press(cell, Bend::default());
                        }
                        continue;
                    }
                    let laid_rad = match unit(bend.omega).filter(|_| lays_share > 0.0) {
                        Some(along) => {
                            let stays = (lays_share * bend.theta).max(length(laid_rad).min(bend.theta));
                            self.laid.lay(index, i, j, along.map(|d| d * stays))
                        }
                        None => laid_rad,
                    };
                    let held_elsewhere = sum(wind_rad, laid_rad).map(|lean| -lean);
                    self.field.press(cell, leaning(bend, held_elsewhere, TELLING_RAD_PER_S));
                }
            }
        }
    }
}

/// Lean of the grass at a place (rad), with the field, the wind and what is laid in the cell there.
pub fn standing_rad(field: &Field, laid: &Laid, wind: &GroundWind, at_m: [f32; 2]) -> [f32; 2] {
    let layout = field.layout();
    let (cell, cells) = (at_m.map(|m| (m / layout.cell_m).floor() as i64), i64::from(layout.cells));
    let [patch_x, patch_z] = cell.map(|at| at.div_euclid(cells));
    let [i, j] = cell.map(|at| at.rem_euclid(cells) as usize);
    let laid_rad = layout.index(patch_x, patch_z).map_or([0.0; 2], |patch| laid.lean_rad(patch, i, j));
    let center_m = cell.map(|at| (at as f32 + 0.5) * layout.cell_m);
    sum(lean_rad(field.cell(cell)), sum(wind.lean_rad(center_m), laid_rad))
}

/// How a cell is shown: its field's bend together with what is laid there; its ω tells the direction.
pub fn shown(bend: Bend, laid_rad: [f32; 2]) -> Bend {
    leaning(bend, laid_rad, HELD_RAD_PER_S)
}

/// How far grass rises below what rests before it is laid anew (rad): a code on the wire.
const RISE_RAD: f32 = THETA_FULL_RAD / 127.0;
/// Least bending speed (rad/s) of grass that leans: ω tells the direction of the lean.
const TELLING_RAD_PER_S: f32 = 1e-3;

/// A bend with a lean (rad) added to it as a vector on the ground; its bending speed, at least that given, turns with it.
fn leaning(bend: Bend, lean_rad: [f32; 2], least_rad_per_s: f32) -> Bend {
    let lean = sum(self::lean_rad(bend), lean_rad);
    match unit(lean) {
        Some(along) => Bend { theta: length(lean), omega: along.map(|d| d * length(bend.omega).max(least_rad_per_s)) },
        None => Bend { theta: 0.0, omega: bend.omega },
    }
}

/// The lean of a bend (rad), along its bending speed.
fn lean_rad(bend: Bend) -> [f32; 2] {
    unit(bend.omega).unwrap_or_default().map(|d| d * bend.theta)
}

fn sum([ax, az]: [f32; 2], [bx, bz]: [f32; 2]) -> [f32; 2] {
    [ax + bx, az + bz]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leans_add_up_as_vectors_and_the_speed_turns_with_them() {
        let leaning = |bend, lean_rad| leaning(bend, lean_rad, TELLING_RAD_PER_S);
        let close = |a: Bend, theta: f32, omega: [f32; 2]| {
            (a.theta - theta).abs() < 1e-5 && (a.omega[0] - omega[0]).abs() < 1e-5 && (a.omega[1] - omega[1]).abs() < 1e-5
        };
        let east = Bend { theta: 0.4, omega: [2.0, 0.0] };
        assert!(close(leaning(east, [0.3, 0.0]), 0.7, [2.0, 0.0]), "along");
        assert!(close(leaning(east, [-0.9, 0.0]), 0.5, [-2.0, 0.0]), "against");
        assert!(close(leaning(east, [0.0, 0.3]), 0.5, [1.6, 1.2]), "across");
        assert!(close(leaning(Bend { theta: -0.4, ..east }, [0.0, 0.0]), 0.4, [-2.0, 0.0]), "a negative angle leans the other way");
        let still = leaning(Bend::default(), [0.0, -0.2]);
        assert!(still.theta == 0.2 && still.omega[0] == 0.0 && still.omega[1] < 0.0, "the wind alone gives a direction: {still:?}");
        assert!(leaning(leaning(Bend::default(), [0.2, 0.1]), [-0.2, -0.1]).theta < 1e-6);
        assert!(close(shown(Bend::default(), [0.0, 0.3]), 0.3, [0.0, HELD_RAD_PER_S]), "what is only laid is shown with its direction");
    }
}
