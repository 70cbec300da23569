//! Rain.

use serde::{Deserialize, Serialize};

/// Rain: an outer agent of plants (004 §1), whose leaves tremble under its drops, and an overcast sky.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Rain {
    /// How much rain falls (mm/h): 2 is a drizzle, 50 a cloudburst. Default 0, dry; allowed 0..=200.
    pub rate_mm_per_h: f32,
}
