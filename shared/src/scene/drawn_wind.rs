//! Wind that presses grass as an object does (001 §5.3, the first approach): cyclones, and any wind drawn by hand.

use super::Scene;
use super::check::Misfits;
use serde::{Deserialize, Serialize};

/// Which way, and how strongly, a wind blows over its disc on the ground.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "String", into = "String")]
pub enum WindShape {
    /// Away from the middle (001 Fig. 9a).
    Outward,
    /// About the middle, from +X towards +Z.
    Swirl,
    /// As this PNG file tells (001 Fig. 9b).
    Drawn(String),
}

impl From<String> for WindShape {
    fn from(word: String) -> Self {
        match word.as_str() {
            "outward" => Self::Outward,
            "swirl" => Self::Swirl,
            _ => Self::Drawn(word),
        }
    }
}

impl From<WindShape> for String {
    fn from(shape: WindShape) -> Self {
        match shape {
            WindShape::Outward => "outward".to_owned(),
            WindShape::Swirl => "swirl".to_owned(),
            WindShape::Drawn(file) => file,
        }
    }
}

impl WindShape {
    /// What is wrong with a word that is neither a shape nor the name of a PNG file.
    pub(super) fn fault(&self) -> Option<String> {
        match self {
            Self::Drawn(file) if !file.to_ascii_lowercase().ends_with(".png") => {
                Some(format!("is \"{file}\"; allowed: \"outward\", \"swirl\" or the name of a PNG file that ends in `.png`"))
            }
            _ => None,
        }
    }
}

/// A wind that presses the grass of a disc, and may travel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrawnWind {
    /// Directions: `outward` blows away from the middle, `swirl` about it (from east to south), and any other word names a PNG file
    /// relative to the scene file: a picture of the square around the disc, RGB of 8 bits, at most 1024 pixels a side, north above.
    /// Red is the direction west to east and green north to south, with 128 for none; blue is the strength, 0 to 255. Required.
    pub shape: WindShape,
    /// Places [x, z] that it passes on its way round (m), within the world; at one alone it stands still. Required, allowed
    /// 1..=64 places, 0..=100000 each.
    pub path_m: Vec<[f32; 2]>,
    /// Speed along the path (m/s). Default 0, allowed 0..=60.
    pub travel_m_per_s: f32,
    /// Turns of the picture about its middle per second, from east to south. Default 0, allowed −10..=10.
    pub turns_per_s: f32,
    /// Radius on the ground (m); at a height it is smaller. Default 10, allowed 0.5..=500.
    pub radius_m: f32,
    /// Speed of the air where it is strongest (m/s). Default 12, allowed 0..=60.
    pub speed_m_per_s: f32,
    /// Bend that it sustains where it is strongest (rad). Default 1.2, allowed 0..=1.5.
    pub bend_rad: f32,
    /// Height h above the ground at which it strikes the grass (m), 001 Eq. (12). Default 0.5, allowed 0.05..=5.
    pub strike_height_m: f32,
    /// Height of its source above the ground (m): the higher, the weaker and smaller, and from 30 m on it reaches no grass. Default
    /// 0, allowed 0..=30.
    pub height_m: f32,
}

impl DrawnWind {
    /// A wind of `shape` that passes the places `path_m` (m), all else by default.
    pub fn new(shape: WindShape, path_m: Vec<[f32; 2]>) -> Self {
        Self {
            shape,
            path_m,
            travel_m_per_s: 0.0,
            turns_per_s: 0.0,
            radius_m: 10.0,
            speed_m_per_s: 12.0,
            bend_rad: 1.2,
            strike_height_m: 0.5,
            height_m: 0.0,
        }
    }
}

/// Notes what does not fit together in the drawn winds of `scene`.
pub(super) fn check(scene: &Scene, misfits: &mut Misfits) {
    let extent_m = scene.extent_m();
    for (i, wind) in scene.drawn_winds.iter().enumerate() {
        if let Some(message) = wind.shape.fault() {
            misfits.note(&[&format!("drawn_winds[{i}].shape")], message);
        }
        let outside = wind.path_m.iter().position(|place| (0..2).any(|axis| place[axis] > extent_m[axis]));
        if let Some(at) = outside {
            let ([x, z], [width_m, depth_m]) = (wind.path_m[at], extent_m);
            let message = format!("is [{x}, {z}]; allowed: within the world, 0 to {width_m} and 0 to {depth_m}");
            misfits.note(&[&format!("drawn_winds[{i}].path_m[{at}]"), "patches.count", "patches.cells", "patches.cell_m"], message);
        }
    }
}
