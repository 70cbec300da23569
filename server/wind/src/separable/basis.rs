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
    /// Cell centres as above, where `true` with zero value at a wall: the value beyond it lies on the parabola through the wall and the two nearest unknowns u₁ and u₂,
    /// `(u₂ − 6u₁)/3`. The second difference at u₁ is then 4/3 times that of [`Edge::Dirichlet`], and exact for parabolas. Where `false`, [`Edge::Neumann`]. A single unknown
    /// has [`Edge::Dirichlet`] at walls. Transformed by a matrix, in time proportional to the square of the length.
    Walls([bool; 2]),
    /// Nodes, of which the outermost are on the edges. Values at Dirichlet edges are zero and no unknowns; those at Neumann edges are unknowns. Transformed by the
    /// DST-I between two Dirichlet edges; otherwise by a matrix, in time proportional to the square of the length.
    Nodes([Edge; 2]),
}

impl Basis {
    /// The same basis for `len` unknowns, without [`Basis::Walls`] where [`Basis::Centres`] is the same.
    pub(super) fn reduced(self, len: usize) -> Self {
        match self {
            Self::Walls(walls) if len == 1 || !walls.contains(&true) => {
                Self::Centres(walls.map(|is_wall| if is_wall { Edge::Dirichlet } else { Edge::Neumann }))
            }
            basis => basis,
        }
    }
}
