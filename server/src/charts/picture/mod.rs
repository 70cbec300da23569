//! Render options: frame time against visible error.
//!
//! | file | content |
//! |---|---|
//! | `method` | the compared render options: representation of distant plants, and transparency |
//! | `shot` | one method on one view at one quality: its time and its similarity to the reference |
//! | `files` | CSV, JSON, a chart per view and one of all |
//! | `summary` | summary as text |
//! | `budget` | level of detail within a frame budget |
//! | `plants` | time against the plants of the scene |
//! | `height` | time against the height of the view |
//! | `levels` | error of each quality in all views |
//! | `sweep` | times against one quantity, a line for each quality |
//! | `vertices` | time per million vertices, over the views and the qualities |
//! | `problems` | problems of error against time, as other models have them |
//! | `regression` | separate costs of vertices and fragments |

mod budget;
mod files;
mod height;
mod levels;
mod method;
mod plants;
mod problems;
mod regression;
mod shot;
mod summary;
mod sweep;
mod vertices;

pub use budget::{Bought, bought};
pub use files::write_all;
pub use method::{METHODS, Method};
pub use problems::problems;
pub use shot::{Shot, ViewShots, shots};
pub use summary::summary;

use prairie_charts::figure::Figure;

/// All figures other than time against similarity.
pub const FIGURES: [Figure; 4] = [
    Figure { name: "levels", title: "Error of the picture at each level of detail", draw: levels::draw },
    Figure { name: "plants", title: "Frame time against the plants of the scene", draw: plants::draw },
    Figure { name: "height", title: "Frame time against the height of the view", draw: height::draw },
    Figure { name: "vertices", title: "Time of the main pass per million vertices", draw: vertices::draw },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_has_its_data() {
        for figure in &FIGURES {
            let drawn = (figure.draw)(true, "caption").unwrap();
            assert!(drawn.svg.contains("caption") && drawn.csv.lines().count() > 5 && !drawn.summary.is_empty(), "{}", figure.name);
        }
    }
}
