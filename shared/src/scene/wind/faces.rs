//! The six faces of the wind's box.

use super::words::words;
use serde::{Deserialize, Serialize};

words! {
    /// What happens at a face of the wind's box.
    WindBoundary {
        /// What leaves through this face enters through the opposite one, which wraps too.
        Wrap = "wrap",
        /// No flow through the face and no friction along it (000 §2.3.7).
        FreeSlip = "free-slip",
        /// The velocity reverses its direction at the face (000 §2.3.7).
        Reflect = "reflect",
        /// Air at the face is at rest.
        NoSlip = "no-slip",
        /// Air at the face moves with [`WindFaces::lid_m_per_s`].
        Lid = "lid",
        /// The mean wind enters.
        Inflow = "inflow",
        /// Air leaves freely, against no pressure.
        Outflow = "outflow",
    }
}

/// What each face of the wind's box does.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct WindFaces {
    /// Face at the smallest X. `wrap`: what leaves here enters through the opposite face, which wraps too; `free-slip`: no flow
    /// through it, no friction along it; `reflect`: the velocity reverses at it; `no-slip`: the air at it rests; `lid`: the air at
    /// it moves with `lid_m_per_s`; `inflow`: the mean wind enters, to leave by an `inflow` or `outflow` opposite; `outflow`: air
    /// leaves freely. Default `wrap`.
    pub west: WindBoundary,
    /// Face at the largest X: `wrap`, `free-slip`, `reflect`, `no-slip`, `lid`, `inflow` or `outflow`. Default `wrap`.
    pub east: WindBoundary,
    /// Face at the smallest Y: `free-slip`, `reflect`, `no-slip` or `lid`; not `wrap`, `inflow` or `outflow`, since it is the ground.
    /// Default `free-slip`.
    pub bottom: WindBoundary,
    /// Face at the largest Y: `free-slip`, `reflect`, `no-slip`, `lid` or `outflow`; not `wrap`, since the ground is opposite, nor
    /// `inflow`, since the mean wind is level. Default `free-slip`.
    pub top: WindBoundary,
    /// Face at the smallest Z: `wrap`, `free-slip`, `reflect`, `no-slip`, `lid`, `inflow` or `outflow`. Default `wrap`.
    pub north: WindBoundary,
    /// Face at the largest Z: `wrap`, `free-slip`, `reflect`, `no-slip`, `lid`, `inflow` or `outflow`. Default `wrap`.
    pub south: WindBoundary,
    /// Velocity of every lid along X, Y and Z (m/s). Default (0, 0, 0), allowed −40..=40 each, and 0 across a lid.
    pub lid_m_per_s: [f32; 3],
}

impl Default for WindFaces {
    fn default() -> Self {
        use WindBoundary::{FreeSlip, Wrap};
        Self { west: Wrap, east: Wrap, bottom: FreeSlip, top: FreeSlip, north: Wrap, south: Wrap, lid_m_per_s: [0.0; 3] }
    }
}

impl WindFaces {
    /// The faces across X, Y and Z, the one at the smaller coordinate first.
    pub fn pairs(&self) -> [[WindBoundary; 2]; 3] {
        [[self.west, self.east], [self.bottom, self.top], [self.north, self.south]]
    }

    /// Along which of X, Y and Z the box is joined to itself.
    pub fn wraps(&self) -> [bool; 3] {
        self.pairs().map(|pair| pair == [WindBoundary::Wrap; 2])
    }
}
