//! Objects as the grass meets them: their shapes, and their motion in a step.
//!
//! Server and clients press the same grass with the same bits, so poses are rounded to [`PoseCode`] before they touch it, and everything here uses only
//! `+ − × ÷` and square roots.

mod motion;
mod pose;
mod prism;

pub use motion::{Motion, MotionError};
pub use pose::{BodyPose, POSITION_QUANTUM_M, PoseCode, ROTATION_FULL, part_code, part_rad};
pub use prism::Prism;

use serde::{Deserialize, Serialize};

/// Shape of a kind of object, in contact with the grass.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// Prisms that can touch grass, higher ones first. A lower prism presses the grass that a higher one has bent.
    pub prisms: Vec<Prism>,
    /// Whether its rotation has no effect on the grass.
    pub is_round: bool,
    /// Whether a rotor blows air down on the grass.
    pub has_downwash: bool,
    /// Distance (m) of a walk cycle, in which the prisms that bear weight are feet that stand in turn: those to the left in the first half of the turn of
    /// the moving part, those to the right in the second. 0 for a body without feet.
    pub stride_m: f32,
}
