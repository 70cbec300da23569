//! A rectangle of the cells or patches of the world.

/// A rectangle of cells, row by row from its north-western corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Window {
    first: [u32; 2],
    size: [u32; 2],
}

impl Window {
    /// The rectangle of at most `limit × limit` cells whose centre is nearest to the fractions `at` along X and Z of `count` cells: all of them, if they are
    /// fewer.
    pub(super) fn around(at: [f32; 2], count: [u32; 2], limit: u32) -> Self {
        let size = count.map(|count| count.min(limit));
        let first = |axis: usize| {
            let middle = (at[axis] * count[axis] as f32) as u32;
            middle.saturating_sub(size[axis] / 2).min(count[axis] - size[axis])
        };
        Self { first: [first(0), first(1)], size }
    }

    /// North-western cell.
    #[cfg(test)]
    pub(super) fn first(&self) -> [u32; 2] {
        self.first
    }

    /// Cells along X and Z.
    pub(super) fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Number of cells.
    pub(super) fn len(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }

    /// Number of the cell `(x, z)` in the rectangle; `None` outside.
    pub(super) fn index(&self, [x, z]: [u32; 2]) -> Option<usize> {
        let ([first_x, first_z], [width, depth]) = (self.first, self.size);
        let (column, row) = (x.checked_sub(first_x)?, z.checked_sub(first_z)?);
        (column < width && row < depth).then(|| row as usize * width as usize + column as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_lies_within_the_world() {
        assert_eq!(Window::around([0.3, 0.9], [40, 20], 64), Window { first: [0, 0], size: [40, 20] });
        assert_eq!(Window::around([0.5, 0.0], [100, 100], 10), Window { first: [45, 0], size: [10, 10] });
        assert_eq!(Window::around([1.0, 0.98], [100, 100], 10), Window { first: [90, 90], size: [10, 10] });
    }

    #[test]
    fn cells_outside_have_no_number() {
        let window = Window::around([0.5, 0.5], [100, 100], 10);
        assert_eq!(window.index([45, 45]), Some(0));
        assert_eq!(window.index([46, 47]), Some(21));
        assert_eq!([[44, 45], [45, 44], [55, 45], [45, 55]].map(|cell| window.index(cell)), [None; 4]);
    }
}
