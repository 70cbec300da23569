//! The six faces of the wind's box.

use super::words::words;
use serde::{Deserialize, Serialize};

words! {
    /// Boundary condition at a face of the wind's box.
    WindBoundary {
        /// Periodic, together with the opposite face.
        Wrap = "wrap",
        /// No flow through the face, no friction along it (Zhang §2.3.7).
        FreeSlip = "free-slip",
        /// The velocity is mirrored at the face (Zhang §2.3.7).
        Reflect = "reflect",
        /// The air at the face is at rest.
        NoSlip = "no-slip",
        /// The air at the face moves with `lid_m_per_s`.
        Lid = "lid",
        /// The mean wind enters, to leave by an inflow or outflow opposite.
        Inflow = "inflow",
        /// Zero pressure: air leaves freely.
        Outflow = "outflow",
    }
}

impl WindBoundary {
    /// Whether no air passes through the face.
    pub fn blocks_flow(self) -> bool {
        match self {
            Self::FreeSlip | Self::Reflect | Self::NoSlip | Self::Lid => true,
            Self::Wrap | Self::Inflow | Self::Outflow => false,
        }
    }
}

/// Boundary conditions of the wind's box.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct WindFaces {
    /// Boundary condition at the smallest X. Default `wrap`.
    pub west: WindBoundary,
    /// Boundary condition at the largest X. Default `wrap`.
    pub east: WindBoundary,
    /// Boundary condition at the smallest Y, the ground: one without flow through the face. Default `free-slip`.
    pub bottom: WindBoundary,
    /// Boundary condition at the largest Y: one without flow through the face, or `outflow`. Default `free-slip`.
    pub top: WindBoundary,
    /// Boundary condition at the smallest Z. Default `wrap`.
    pub north: WindBoundary,
    /// Boundary condition at the largest Z. Default `wrap`.
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

    /// Whether the box is periodic along X, Y and Z.
    pub fn wraps(&self) -> [bool; 3] {
        self.pairs().map(|pair| pair == [WindBoundary::Wrap; 2])
    }
}
