//! The total bend of the grass: equilibrium with the wind, flattened grass, and the bend field on top of both.
//!
//! The three are leans: vectors on the ground, as long as the bend, that add up.

use super::bending::{HELD_RAD_PER_S, terrain_limit_rad};
use super::flattened::{FlattenedGrass, VISIBLE_RAD};
use super::footprint::Footprint;
use super::grass_properties::GrassProperties;
use super::vector::{length, sum, unit};
use crate::bend::{Bend, Field};
use crate::terrain::HeightMap;
use crate::wind::WindField;

/// State and limits of the total bend of the grass.
pub struct GrassState<'a> {
    /// The bend field.
    pub field: &'a mut Field,
    /// Grass that stays bent below the weight of objects.
    pub flattened: &'a mut FlattenedGrass,
    /// The wind.
    pub wind: &'a WindField,
    /// Terrain heights.
    pub height: &'a HeightMap,
    /// Limits of the bend.
    pub properties: &'a GrassProperties,
}

/// Bend of pressed grass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pressed {
    /// The total bend.
    pub bend: Bend,
    /// Fraction of it that remains as flattened grass, 0..=1.
    pub flattened_fraction: f32,
}

impl GrassState<'_> {
    /// Presses each cell of awake patches within `footprint`. `change` gets the cell's centre (m), its total bend, and the terrain limit (rad) as a
    /// function of direction. The bend field stores the result less the leans of wind and flattened grass.
    ///
    /// Below an object that `is_at_rest` all of the bend counts as flattened grass, in sleeping patches as well. It is rewritten whenever it has
    /// recovered by 1.4°.
    pub fn for_each_cell(
        &mut self,
        footprint: &Footprint,
        is_at_rest: bool,
        mut change: impl FnMut([f32; 2], Bend, &dyn Fn([f32; 2]) -> f32) -> Option<Pressed>,
    ) {
        let layout = *self.field.layout();
        let cells = i64::from(layout.cells);
        for run in footprint.runs(&layout) {
            let (patch_z, j) = (run.row / cells, (run.row % cells) as usize);
            let z_m = (run.row as f32 + 0.5) * layout.cell_m;
            for patch_x in run.from / cells..=(run.to - 1) / cells {
                let Some(index) = layout.index(patch_x, patch_z) else { continue };
                let is_awake = self.field.patch(index).is_some();
                if !(is_awake || is_at_rest) {
                    continue;
                }
                let first = patch_x * cells;
                for i in run.from.max(first)..run.to.min(first + cells) {
                    let at_m = [(i as f32 + 0.5) * layout.cell_m, z_m];
                    let cell = [i, run.row];
                    let i = (i - first) as usize;
                    let (wind_rad, flattened_rad) = (self.wind.lean_at(at_m), self.flattened.lean_rad(index, i, j));
                    let bend = leaning(self.field.cell(cell), sum(wind_rad, flattened_rad), DIRECTION_RAD_PER_S);
                    let limit_rad =
                        |direction| terrain_limit_rad(self.properties.theta_max_rad(at_m), self.height.slope(at_m[0], at_m[1]), direction);
                    let recovered_rad = bend.theta;
                    let Some(Pressed { bend, flattened_fraction }) = change(at_m, bend, &limit_rad) else { continue };
                    if is_at_rest {
                        if is_awake || recovered_rad < bend.theta - REWRITE_RAD {
                            self.flattened.flatten(index, i, j, sum(bend.lean_rad(), wind_rad.map(|lean| -lean)));
                            self.field.press(cell, Bend::default());
                        }
                        continue;
                    }
                    let flattened_rad = match unit(bend.omega).filter(|_| flattened_fraction > 0.0) {
                        Some(along) => {
                            let stays = (flattened_fraction * bend.theta).max(length(flattened_rad).min(bend.theta));
                            self.flattened.flatten(index, i, j, along.map(|d| d * stays))
                        }
                        None => flattened_rad,
                    };
                    let outside_the_field = sum(wind_rad, flattened_rad).map(|lean| -lean);
                    self.field.press(cell, leaning(bend, outside_the_field, DIRECTION_RAD_PER_S));
                }
            }
        }
    }
}

/// Total lean of the grass at a position (rad, as a vector along X and Z).
pub fn total_lean_rad(field: &Field, flattened: &FlattenedGrass, wind: &WindField, at_m: [f32; 2]) -> [f32; 2] {
    let layout = field.layout();
    let (cell, cells) = (at_m.map(|m| (m / layout.cell_m).floor() as i64), i64::from(layout.cells));
    let [patch_x, patch_z] = cell.map(|at| at.div_euclid(cells));
    let [i, j] = cell.map(|at| at.rem_euclid(cells) as usize);
    let flattened_rad = layout.index(patch_x, patch_z).map_or([0.0; 2], |patch| flattened.lean_rad(patch, i, j));
    let center_m = cell.map(|at| (at as f32 + 0.5) * layout.cell_m);
    sum(field.cell(cell).lean_rad(), sum(wind.lean_at(center_m), flattened_rad))
}

/// Bend of a cell as published: the sum of bend field and flattened grass. The direction of ω is the direction of the bend.
pub fn published(bend: Bend, flattened_rad: [f32; 2]) -> Bend {
    leaning(bend, flattened_rad, HELD_RAD_PER_S)
}

/// Recovery below an object at rest after which grass is flattened again (rad).
const REWRITE_RAD: f32 = 2.0 * VISIBLE_RAD;
/// Minimum bending speed (rad/s) of leaning grass. The direction of ω is the direction of the lean.
const DIRECTION_RAD_PER_S: f32 = 1e-3;

/// A bend plus a lean (rad), added as vectors on the ground. The bending speed, at least `least_rad_per_s`, turns with the sum.
fn leaning(bend: Bend, lean_rad: [f32; 2], least_rad_per_s: f32) -> Bend {
    let lean = sum(bend.lean_rad(), lean_rad);
    match unit(lean) {
        Some(along) => Bend { theta: length(lean), omega: along.map(|d| d * length(bend.omega).max(least_rad_per_s)) },
        None => Bend { theta: 0.0, omega: bend.omega },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leans_add_up_as_vectors_and_the_speed_turns_with_them() {
        let leaning = |bend, lean_rad| leaning(bend, lean_rad, DIRECTION_RAD_PER_S);
        let close = |a: Bend, theta: f32, omega: [f32; 2]| {
            (a.theta - theta).abs() < 1e-5 && (a.omega[0] - omega[0]).abs() < 1e-5 && (a.omega[1] - omega[1]).abs() < 1e-5
        };
        let east = Bend { theta: 0.4, omega: [2.0, 0.0] };
        assert!(close(leaning(east, [0.3, 0.0]), 0.7, [2.0, 0.0]), "along");
        assert!(close(leaning(east, [-0.9, 0.0]), 0.5, [-2.0, 0.0]), "against");
        assert!(close(leaning(east, [0.0, 0.3]), 0.5, [1.6, 1.2]), "across");
        assert!(
            close(leaning(Bend { theta: -0.4, ..east }, [0.0, 0.0]), 0.4, [-2.0, 0.0]),
            "a negative angle leans in the opposite direction"
        );
        let still = leaning(Bend::default(), [0.0, -0.2]);
        assert!(still.theta == 0.2 && still.omega[0] == 0.0 && still.omega[1] < 0.0, "the wind alone gives a direction: {still:?}");
        assert!(leaning(leaning(Bend::default(), [0.2, 0.1]), [-0.2, -0.1]).theta < 1e-6);
        assert!(
            close(published(Bend::default(), [0.0, 0.3]), 0.3, [0.0, HELD_RAD_PER_S]),
            "flattened grass is published with its direction"
        );
    }
}
