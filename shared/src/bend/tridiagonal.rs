//! Tridiagonal systems `(1 − a·L)·δ = f` along a line of cells, eight lines at once.

/// Number of lines solved at once.
pub(super) const LANES: usize = 8;
/// One value of each line.
pub(super) type Lanes = [f32; LANES];

/// Boundary condition at the end of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// No change (homogeneous Dirichlet).
    Rest,
    /// Mirror image (homogeneous Neumann).
    Free,
    /// Joined to the other end (periodic).
    Joined,
}

/// Eight lines of equal length, solved by the Thomas algorithm; periodic ones with the Sherman–Morrison formula.
pub(super) struct Line {
    ends: [End; 2],
    /// a of each cell.
    pub(super) weights: Vec<Lanes>,
    /// Right-hand side, then the solution.
    pub(super) values: Vec<Lanes>,
    /// Reciprocal of the diagonal after elimination, times 1 and times a.
    inverse: Vec<Lanes>,
    upper: Vec<Lanes>,
    /// Solution for the Sherman–Morrison vector u of a periodic line.
    joint: Vec<Lanes>,
}

impl Line {
    pub(super) fn new(cells: usize, ends: [End; 2]) -> Self {
        let lanes = || Vec::with_capacity(cells);
        Self { ends, weights: lanes(), values: lanes(), inverse: lanes(), upper: lanes(), joint: lanes() }
    }

    /// Eliminates the lower diagonal. Every row is diagonally dominant, so no pivoting is needed.
    pub(super) fn factorise(&mut self) {
        let last = self.weights.len() - 1;
        self.inverse.clear();
        self.upper.clear();
        let mut upper = [0.0; LANES];
        for (cell, weights) in self.weights.iter().enumerate() {
            let diagonal: Lanes = std::array::from_fn(|lane| {
                let a = weights[lane];
                let mut diagonal = 1.0 + 2.0 * a;
                for (end, at) in self.ends.into_iter().zip([0, last]) {
                    diagonal += match end {
                        _ if at != cell => 0.0,
                        End::Rest => 0.0,
                        End::Free => -a,
                        // The two corner entries of the periodic matrix are compensated at both ends.
                        End::Joined => a,
                    };
                }
                diagonal - a * if cell == 0 { 0.0 } else { upper[lane] }
            });
            let inverse = diagonal.map(|diagonal| 1.0 / diagonal);
            upper = std::array::from_fn(|lane| weights[lane] * inverse[lane]);
            self.inverse.push(inverse);
            self.upper.push(upper);
        }
        if self.ends[0] == End::Joined {
            self.joint.clear();
            self.joint.resize(last + 1, [0.0; LANES]);
            self.joint[0] = self.weights[0].map(|a| -a);
            self.joint[last] = self.weights[last].map(|a| -a);
            let mut joint = std::mem::take(&mut self.joint);
            self.substitute(&mut joint);
            self.joint = joint;
        }
    }

    /// Replaces the right-hand side by the solution.
    pub(super) fn solve(&mut self) {
        let mut values = std::mem::take(&mut self.values);
        self.substitute(&mut values);
        if self.ends[0] == End::Joined {
            let last = values.len() - 1;
            // The periodic matrix is the factorised one plus u·vᵗ, with u = (−a₀, 0, …, −aₙ) and v = (1, 0, …, 0, 1).
            let fraction: Lanes =
                std::array::from_fn(|lane| (values[0][lane] + values[last][lane]) / (1.0 + self.joint[0][lane] + self.joint[last][lane]));
            for (values, joint) in values.iter_mut().zip(&self.joint) {
                *values = std::array::from_fn(|lane| values[lane] - fraction[lane] * joint[lane]);
            }
        }
        self.values = values;
    }

    fn substitute(&self, values: &mut [Lanes]) {
        let mut last = [0.0; LANES];
        for ((value, weights), inverse) in values.iter_mut().zip(&self.weights).zip(&self.inverse) {
            *value = std::array::from_fn(|lane| (value[lane] + weights[lane] * last[lane]) * inverse[lane]);
            last = *value;
        }
        let mut next = [0.0; LANES];
        for (value, upper) in values.iter_mut().zip(&self.upper).rev() {
            *value = std::array::from_fn(|lane| value[lane] + upper[lane] * next[lane]);
            next = *value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The matrix times the solution gives the right-hand side.
    #[test]
    fn solutions_fulfil_their_systems() {
        for ends in
            [[End::Rest, End::Rest], [End::Free, End::Rest], [End::Rest, End::Free], [End::Free, End::Free], [End::Joined, End::Joined]]
        {
            let mut line = Line::new(17, ends);
            let lanes = |cell: usize, turn: f32| -> Lanes { std::array::from_fn(|lane| ((cell * 13 + lane * 7) as f32 * turn).sin()) };
            line.weights = (0..17).map(|cell| lanes(cell, 0.37).map(|v| 4.0 * v * v)).collect();
            let right: Vec<Lanes> = (0..17).map(|cell| lanes(cell, 1.71)).collect();
            line.values.clone_from(&right);
            line.factorise();
            line.solve();
            for (cell, right) in right.iter().enumerate() {
                for (lane, right) in right.iter().enumerate() {
                    let own = line.values[cell][lane];
                    let beyond = |end: End, other: usize| match end {
                        End::Rest => 0.0,
                        End::Free => own,
                        End::Joined => line.values[other][lane],
                    };
                    let west = if cell == 0 { beyond(ends[0], 16) } else { line.values[cell - 1][lane] };
                    let east = if cell == 16 { beyond(ends[1], 0) } else { line.values[cell + 1][lane] };
                    let left = own - line.weights[cell][lane] * (west + east - 2.0 * own);
                    assert!((left - right).abs() < 1e-5, "{ends:?}, cell {cell}: {left} for {right}");
                }
            }
        }
    }
}
