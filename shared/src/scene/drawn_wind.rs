//! Winds that press grass like objects (Chen & Johan §5.3, first approach): cyclones, and any wind drawn as a picture.

use serde::{Deserialize, Serialize};

/// Direction and strength of a wind over its disc on the ground.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(from = "String", into = "String")]
pub enum WindShape {
    /// Away from the centre (Chen & Johan Fig. 9a).
    Outward,
    /// Around the centre, from +X towards +Z.
    Swirl,
    /// As drawn in this PNG file (Chen & Johan Fig. 9b).
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
    /// The fault of a word that is neither a shape nor the name of a PNG file.
    pub(super) fn fault(&self) -> Option<String> {
        match self {
            Self::Drawn(file) if !file.to_ascii_lowercase().ends_with(".png") => {
                Some(format!("is \"{file}\"; allowed: \"outward\", \"swirl\" or the name of a PNG file that ends in `.png`"))
            }
            _ => None,
        }
    }
}

/// A wind that presses the grass of a disc, and may move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DrawnWind {
    /// Directions: `outward` blows away from the centre, `swirl` around it (from east to south), and any other word names a PNG file relative to the
    /// scene file: a picture of the square around the disc, RGB of 8 bits, at most 1024 pixels a side, north up. Red is the direction west to east
    /// and green north to south, with 128 for none; blue is the strength, 0 to 255. Required.
    pub shape: WindShape,
    /// Points [x, z] of the closed path that it follows (m), within the world; with a single point it does not move. Required, allowed 1..=64 points,
    /// 0..=100000 each.
    pub path_m: Vec<[f32; 2]>,
    /// Speed along the path (m/s). Default 0, allowed 0..=60.
    pub travel_m_per_s: f32,
    /// Rotation of the picture about its centre (turns per second), from east to south. Default 0, allowed −10..=10.
    pub turns_per_s: f32,
    /// Radius on the ground (m); smaller if the source is above the ground. Default 10, allowed 0.5..=500.
    pub radius_m: f32,
    /// Largest speed of the air (m/s). Default 12, allowed 0..=60.
    pub speed_m_per_s: f32,
    /// Largest bend that it sustains (rad). Default 1.2, allowed 0..=1.5.
    pub bend_rad: f32,
    /// Height h above the ground of its contact with the grass (m), Chen & Johan Eq. (12). Default 0.5, allowed 0.05..=5.
    pub strike_height_m: f32,
    /// Height of its source above the ground (m): the higher, the weaker and smaller; from 30 m on it does not reach the grass. Default 0, allowed
    /// 0..=30.
    pub height_m: f32,
}

impl DrawnWind {
    /// A wind of `shape` along the path `path_m` (m), with the defaults of all else.
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
