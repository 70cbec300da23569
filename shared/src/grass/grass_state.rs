//! The total bend of the grass: equilibrium with the wind, flattened grass, and the bend field on top of both.
//!
//! The three are leans: vectors on the ground, as long as the bend, that add up.

use super::bending::{HELD_RAD_PER_S, terrain_limit_rad};
use super::flattened::{DetachedPatch, FlattenedGrass, VISIBLE_RAD};
use super::grass_properties::GrassProperties;
use super::stroke::{Pressed, Stroke};
use super::vector::{length, sum, unit};
use crate::bend::{Bend, Executor, Field, Patch};
use crate::grid::{PatchIndex, PatchLayout};
use crate::terrain::HeightMap;
use crate::wind::WindField;
use std::collections::BTreeMap;

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

/// What the bend of a cell depends on besides its patch.
#[derive(Clone, Copy)]
struct Surroundings<'a> {
    layout: PatchLayout,
    wind: &'a WindField,
    height: &'a HeightMap,
    properties: &'a GrassProperties,
}

/// A patch with the strokes that press it.
struct PressedPatch<'a, 'b> {
    index: PatchIndex,
    /// The patch, if it is awake.
    awake: Option<&'a mut Patch>,
    flattened: DetachedPatch,
    /// In the order of the causes.
    strokes: Vec<&'a Stroke<'b>>,
    /// Cells of the world that were pressed, with their bend in the field.
    pressed: Vec<([i64; 2], Bend)>,
}

/// State of a cell before a stroke; it is found when a rule asks for it.
pub struct CellState<'a> {
    at_m: [f32; 2],
    surroundings: &'a Surroundings<'a>,
    in_field: Bend,
    flattened: &'a mut DetachedPatch,
    place: [usize; 2],
    leans_rad: Option<[[f32; 2]; 2]>,
}

impl CellState<'_> {
    /// Total bend of the cell.
    pub fn bend(&mut self) -> Bend {
        let [wind_rad, flattened_rad] = self.leans_rad();
        leaning(self.in_field, sum(wind_rad, flattened_rad), DIRECTION_RAD_PER_S)
    }

    /// Largest bend (rad) along the unit vector `direction`, which the terrain limits.
    pub fn limit_rad(&self, direction: [f32; 2]) -> f32 {
        let (Surroundings { height, properties, .. }, [x_m, z_m]) = (self.surroundings, self.at_m);
        terrain_limit_rad(properties.theta_max_rad(self.at_m), height.slope(x_m, z_m), direction)
    }

    /// Leans of the wind and of flattened grass (rad).
    fn leans_rad(&mut self) -> [[f32; 2]; 2] {
        let Self { at_m, surroundings, flattened, place: [i, j], leans_rad, .. } = self;
        *leans_rad.get_or_insert_with(|| [surroundings.wind.lean_at(*at_m), flattened.lean_rad(*i, *j)])
    }
}

impl GrassState<'_> {
    /// Presses the cells of awake patches by strokes, one after another; patches in parallel. The bend field stores the resulting bends less the leans of wind
    /// and flattened grass.
    pub fn press(&mut self, strokes: &[Stroke], executor: &impl Executor) {
        let layout = *self.field.layout();
        let surroundings = Surroundings { layout, wind: self.wind, height: self.height, properties: self.properties };
        let keeps_overlaps = self.field.has_overlaps();
        let mut touched = touched(strokes, &layout);
        let mut patches: Vec<PressedPatch> = vec![];
        let mut add = |index, awake, strokes| {
            let flattened = self.flattened.detach(index);
            patches.push(PressedPatch { index, awake, flattened, strokes, pressed: vec![] });
        };
        for patch in self.field.awake_mut() {
            let index = patch.index();
            if let Some(strokes) = touched.remove(&index) {
                add(index, Some(patch), strokes);
            }
        }
        for (index, mut strokes) in touched {
            strokes.retain(|stroke| stroke.is_at_rest);
            if !strokes.is_empty() {
                add(index, None, strokes);
            }
        }
        executor.for_each(&mut patches, |patch| patch.press(&surroundings, keeps_overlaps));
        let mut pressed = vec![];
        for patch in patches {
            self.flattened.attach(patch.index, patch.flattened);
            pressed.extend(patch.pressed);
        }
        pressed.into_iter().for_each(|(cell, bend)| self.field.press_overlaps(cell, bend));
    }
}

/// The strokes that touch each patch, in order.
fn touched<'a, 'b>(strokes: &'a [Stroke<'b>], layout: &PatchLayout) -> BTreeMap<PatchIndex, Vec<&'a Stroke<'b>>> {
    let cells = i64::from(layout.cells);
    let mut touched: BTreeMap<PatchIndex, Vec<&Stroke>> = BTreeMap::new();
    for stroke in strokes {
        for run in &stroke.runs {
            for index in (run.from / cells..=(run.to - 1) / cells).filter_map(|x| layout.index(x, run.row / cells)) {
                let strokes = touched.entry(index).or_default();
                if strokes.last().is_none_or(|last| !std::ptr::eq(*last, stroke)) {
                    strokes.push(stroke);
                }
            }
        }
    }
    touched
}

impl PressedPatch<'_, '_> {
    /// Presses the cells by all strokes, and notes them if `keeps_pressed`.
    fn press(&mut self, surroundings: &Surroundings, keeps_pressed: bool) {
        let (layout, cells) = (surroundings.layout, i64::from(surroundings.layout.cells));
        let corner = layout.place(self.index).map(|n| i64::from(n) * cells);
        for stroke in std::mem::take(&mut self.strokes) {
            for run in stroke.runs.iter().filter(|run| (corner[1]..corner[1] + cells).contains(&run.row)) {
                for column in run.from.max(corner[0])..run.to.min(corner[0] + cells) {
                    let place = [(column - corner[0]) as usize, (run.row - corner[1]) as usize];
                    let at_m = [column, run.row].map(|at| (at as f32 + 0.5) * layout.cell_m);
                    if let Some(bend) = self.press_cell(surroundings, stroke, place, at_m) {
                        if let Some(patch) = &mut self.awake {
                            patch.press(place[0], place[1], bend);
                        }
                        if keeps_pressed {
                            self.pressed.push(([column, run.row], bend));
                        }
                    }
                }
            }
        }
    }

    /// Bend of a cell in the field after a stroke; `None` where the stroke does not change it. Flattens its grass where it is to stay bent.
    fn press_cell(&mut self, surroundings: &Surroundings, stroke: &Stroke, place: [usize; 2], at_m: [f32; 2]) -> Option<Bend> {
        let [i, j] = place;
        let in_field = self.awake.as_ref().map_or_else(Bend::default, |patch| patch.bend(i, j));
        let mut cell = CellState { at_m, surroundings, in_field, flattened: &mut self.flattened, place, leans_rad: None };
        let Pressed { bend, flattened_fraction } = (stroke.rule)(at_m, &mut cell)?;
        let [wind_rad, flattened_rad] = cell.leans_rad();
        if stroke.is_at_rest {
            let has_recovered = cell.bend().theta < bend.theta - REWRITE_RAD;
            return (self.awake.is_some() || has_recovered).then(|| {
                self.flattened.flatten(i, j, sum(bend.lean_rad(), wind_rad.map(|lean| -lean)));
                Bend::default()
            });
        }
        let flattened_rad = match unit(bend.omega).filter(|_| flattened_fraction > 0.0) {
            Some(along) => {
                let stays = (flattened_fraction * bend.theta).max(length(flattened_rad).min(bend.theta));
                self.flattened.flatten(i, j, along.map(|d| d * stays))
            }
            None => flattened_rad,
        };
        let outside_the_field = sum(wind_rad, flattened_rad).map(|lean| -lean);
        Some(leaning(bend, outside_the_field, DIRECTION_RAD_PER_S))
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
