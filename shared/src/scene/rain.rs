//! Rain.

use serde::{Deserialize, Serialize};

/// Rain: an external agent (Endo et al. 2003, §1) under whose drops leaves tremble, with an overcast sky.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Rain {
    /// Rainfall rate (mm/h): 2 is a drizzle, 50 a cloudburst. Default 0, dry; allowed 0..=200.
    pub rate_mm_per_h: f32,
}
