//! Variables of the files: their names, units and meanings, after the CF conventions where these have a name.

use super::grids::Grid;
use prairie_core::scene::Scene;
use std::fmt;
use std::ops::RangeInclusive;
use std::str::FromStr;

/// Smallest and largest absolute error to which a field may be rounded, in its unit.
pub const ALLOWED_ERROR: RangeInclusive<f32> = 1e-6..=1e3;

/// A field that is asked for by one word: one variable, or the components of a vector.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Field {
    /// Wind at the centres of the solver's cells, as the solver has it.
    Wind,
    /// Concentration of dust in the same cells; only in scenes that release some.
    Dust,
    /// Wind at the height of the grass, with the gusts finer than the cells.
    GroundWind,
    /// Bending angle of the grass, without its lean in the wind.
    Bend,
    /// Bending velocity, whose direction is the direction of the bend.
    BendVelocity,
    /// The whole lean of the grass: wind, flattened grass and bend field together.
    Lean,
}

/// A variable of the files.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variable {
    /// Name in the files.
    pub name: &'static str,
    /// The field to which it belongs.
    pub field: Field,
    /// Axis along which it is a component of the field: 0, 1 and 2 for X, Y and Z; `None` for a scalar.
    pub axis: Option<usize>,
    /// Units, as UDUNITS writes them.
    pub units: &'static str,
    /// Meaning in words.
    pub long_name: &'static str,
    /// Name in the CF standard name table, if there is one.
    pub standard_name: Option<&'static str>,
}

/// A row of [`VARIABLES`].
const fn row(field: Field, axis: Option<usize>, name: &'static str, units: &'static str, long_name: &'static str) -> Variable {
    Variable { name, field, axis, units, long_name, standard_name: None }
}

/// All variables, in the order of the fields.
pub const VARIABLES: [Variable; 11] = [
    Variable { standard_name: Some("eastward_wind"), ..row(Field::Wind, Some(0), "u", "m s-1", "wind towards the east") },
    row(Field::Wind, Some(1), "v", "m s-1", "wind away from the ground, relative to its slope where the box follows the land"),
    row(Field::Wind, Some(2), "w", "m s-1", "wind towards the south"),
    row(Field::Dust, None, "dust", "1", "concentration of dust"),
    row(Field::GroundWind, Some(0), "ground_u", "m s-1", "wind towards the east at the height of the grass"),
    row(Field::GroundWind, Some(2), "ground_w", "m s-1", "wind towards the south at the height of the grass"),
    row(Field::Bend, None, "theta", "rad", "bending angle of the grass relative to its lean in the wind"),
    row(
        Field::BendVelocity,
        Some(0),
        "omega_x",
        "rad s-1",
        "bending velocity of the grass towards the east, at least 0.5 rad/s in size where it lies flattened",
    ),
    row(
        Field::BendVelocity,
        Some(2),
        "omega_z",
        "rad s-1",
        "bending velocity of the grass towards the south, at least 0.5 rad/s in size where it lies flattened",
    ),
    row(Field::Lean, Some(0), "lean_x", "rad", "lean of the grass towards the east, that in the wind included"),
    row(Field::Lean, Some(2), "lean_z", "rad", "lean of the grass towards the south, that in the wind included"),
];

impl Field {
    /// All fields.
    pub const ALL: [Self; 6] = [Self::Wind, Self::Dust, Self::GroundWind, Self::Bend, Self::BendVelocity, Self::Lean];

    /// The word by which it is asked for.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wind => "wind",
            Self::Dust => "dust",
            Self::GroundWind => "ground-wind",
            Self::Bend => "bend",
            Self::BendVelocity => "bend-velocity",
            Self::Lean => "lean",
        }
    }

    /// The grid on which it is given.
    pub fn grid(self) -> Grid {
        match self {
            Self::Wind | Self::Dust => Grid::Air,
            Self::GroundWind => Grid::Tiles,
            Self::Bend | Self::BendVelocity | Self::Lean => Grid::Grass,
        }
    }

    /// Its variables.
    pub fn variables(self) -> impl Iterator<Item = &'static Variable> {
        VARIABLES.iter().filter(move |variable| variable.field == self)
    }

    /// The fields that are written unless others are asked for: all but the lean, which takes as long to find as the steps of a second, and dust only where a
    /// scene has some.
    pub fn usual(scene: &Scene) -> Vec<Self> {
        let is_usual = |field: &Self| match field {
            Self::Dust => scene.wind.has_dust(),
            Self::Lean => false,
            _ => true,
        };
        Self::ALL.into_iter().filter(is_usual).collect()
    }
}

impl fmt::Display for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Field {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let allowed = || Self::ALL.map(Self::name).join(", ");
        Self::ALL.into_iter().find(|field| field.name() == text).ok_or_else(|| format!("allowed: {}", allowed()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_field_has_variables_on_its_grid_and_names_differ() {
        for field in Field::ALL {
            assert_eq!(field.name().parse(), Ok(field));
            let axes: Vec<_> = field.variables().map(|variable| variable.axis).collect();
            assert!(axes == [None] || axes.len() > 1 && axes.iter().all(Option::is_some) && axes.is_sorted(), "{field}: {axes:?}");
        }
        let mut names: Vec<_> = VARIABLES.iter().map(|variable| variable.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), VARIABLES.len());
        assert!(VARIABLES.is_sorted_by_key(|variable| variable.field));
        assert_eq!("bends".parse::<Field>(), Err("allowed: wind, dust, ground-wind, bend, bend-velocity, lean".to_owned()));
    }
}
