//! Boundary conditions of the transforms.

/// Boundary condition at an edge half a cell beyond the outermost cell centre of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// Zero gradient: the value beyond the edge equals the value inside.
    Neumann,
    /// Zero value: the value beyond the edge is minus the value inside.
    Dirichlet,
}

/// Locations of the unknowns along an axis, and the boundary conditions at its ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// Periodic: the first unknown follows the last. Transformed by the FFT.
    Wrap,
    /// Cell centres between two edges, each half a cell beyond the outermost. Transformed by the DCT-II, DST-II, DCT-IV or DST-IV.
    Centres([Edge; 2]),
    /// Inner nodes between two nodes where the value is zero, one spacing beyond the outermost. Transformed by the DST-I.
    Nodes,
}
