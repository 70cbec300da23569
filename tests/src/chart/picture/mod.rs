//! Ways of drawing the picture: time of a frame against what one sees missing.
//!
//! | file | what it does |
//! |---|---|
//! | `method` | the ways: what stands for far plants, and in which order plants are laid over each other |
//! | `shot` | one way on one view at one quality: its time and its likeness to the reference |
//! | `files` | CSV, JSON, a chart per view and one of all |
//! | `said` | what was found, on one screen |
//! | `budget` | the level of detail that a frame budget buys |
//! | `plants` | time against the plants of the scene |
//! | `height` | time against the height of the view |
//! | `sweep` | times over one quantity, a line for each quality |
//! | `vertices` | time per million vertices, over the views and the qualities |
//! | `share` | what vertices and fragments take, told apart |

mod budget;
mod files;
mod height;
mod method;
mod plants;
mod said;
mod share;
mod shot;
mod sweep;
mod vertices;

pub use budget::{Bought, bought};
pub use files::write_all;
pub use method::{METHODS, Method};
pub use said::said;
pub use shot::{Shot, ViewShots, shots};

use super::figure::Figure;

/// All figures that are not of time against likeness.
pub const FIGURES: [Figure; 3] = [
    Figure { name: "plants", title: "Time of a frame against the plants of the scene", draw: plants::draw },
    Figure { name: "height", title: "Time of a frame against the height of the view", draw: height::draw },
    Figure { name: "vertices", title: "Time of the picture's pass per million vertices", draw: vertices::draw },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_has_its_data() {
        for figure in &FIGURES {
            let drawn = (figure.draw)(true, "caption").unwrap();
            assert!(drawn.svg.contains("caption") && drawn.csv.lines().count() > 5 && !drawn.said.is_empty(), "{}", figure.name);
        }
    }
}
