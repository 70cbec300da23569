//! Boundary conditions of the transforms.

/// Boundary condition at the end of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// Zero gradient: the value beyond the edge equals its mirror image inside.
    Neumann,
    /// Zero value: the value beyond the edge is minus its mirror image inside.
    Dirichlet,
}

/// Locations of the unknowns along an axis, and the boundary conditions at its ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Basis {
    /// Periodic: the first unknown follows the last. Transformed by the FFT.
    Wrap,
    /// Cell centres between two edges, each half a cell beyond the outermost. Transformed by the DCT-II, DST-II, DCT-IV or DST-IV.
    Centres([Edge; 2]),
    /// Nodes, of which the outermost are on the edges. Values at Dirichlet edges are zero and no unknowns; those at Neumann edges are unknowns. Transformed by the
    /// DST-I between two Dirichlet edges; otherwise by a matrix, in time proportional to the square of the length.
    Nodes([Edge; 2]),
}
