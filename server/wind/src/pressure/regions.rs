//! Connected regions of air that touch no open edge.

/// Closed regions: air connected through open faces that touches no [`Dirichlet`](super::Edge::Dirichlet) edge. Their pressure is known only up to a
/// constant.
#[derive(Clone, Debug)]
pub(super) enum Regions {
    /// Every region touches an open edge.
    None,
    /// The whole box is one closed region.
    Whole,
    /// The region of each cell, `u32::MAX` where there is none, and the number of cells in each region.
    Labelled(Vec<u32>, Vec<f64>),
}

/// Not in a closed region.
const OPEN: u32 = u32::MAX;
const UNSEEN: u32 = u32::MAX - 1;

impl Regions {
    /// Labels `len` cells. `neighbours(i)` are the cells that share an open face with cell `i`; `open(i)` is true if it touches an open edge,
    /// `air(i)` if it is air.
    pub(super) fn label<I: Iterator<Item = usize>>(
        len: usize,
        neighbours: impl Fn(usize) -> I,
        open: impl Fn(usize) -> bool,
        air: impl Fn(usize) -> bool,
    ) -> Self {
        let mut labels = vec![UNSEEN; len];
        let (mut sizes, mut region): (Vec<f64>, Vec<usize>) = (vec![], vec![]);
        for seed in 0..len {
            if !air(seed) {
                labels[seed] = OPEN;
            }
            if labels[seed] != UNSEEN {
                continue;
            }
            let label = sizes.len() as u32;
            let mut closed = true;
            region.clear();
            region.push(seed);
            labels[seed] = label;
            let mut next = 0;
            while let Some(&cell) = region.get(next) {
                next += 1;
                closed &= !open(cell);
                for neighbour in neighbours(cell) {
                    if labels[neighbour] == UNSEEN {
                        labels[neighbour] = label;
                        region.push(neighbour);
                    }
                }
            }
            if closed {
                sizes.push(region.len() as f64);
            } else {
                region.iter().for_each(|&cell| labels[cell] = OPEN);
            }
        }
        match sizes[..] {
            [] => Self::None,
            [size] if size == len as f64 => Self::Whole,
            _ => Self::Labelled(labels, sizes),
        }
    }

    /// True if there is no closed region.
    pub(super) fn is_empty(&self) -> bool {
        matches!(self, Self::None)
    }

    /// Number of closed regions.
    pub(super) fn count(&self) -> usize {
        match self {
            Self::None => 0,
            Self::Whole => 1,
            Self::Labelled(_, sizes) => sizes.len(),
        }
    }

    /// Subtracts the mean of each closed region from its cells. `sums` has one value per region.
    pub(super) fn remove_means(&self, field: &mut [f64], sums: &mut [f64]) {
        match self {
            Self::None => {}
            Self::Whole => {
                let rows: f64 = field.chunks(256).map(|row| row.iter().sum::<f64>()).sum();
                let mean = rows / field.len() as f64;
                field.iter_mut().for_each(|value| *value -= mean);
            }
            Self::Labelled(labels, sizes) => {
                sums.fill(0.0);
                let known = |label: u32| (label != OPEN).then_some(label as usize);
                labels.iter().zip(&*field).for_each(|(&label, value)| known(label).into_iter().for_each(|region| sums[region] += value));
                sums.iter_mut().zip(sizes).for_each(|(sum, size)| *sum /= size);
                labels.iter().zip(field).for_each(|(&label, value)| known(label).into_iter().for_each(|region| *value -= sums[region]));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn closed_regions_lose_their_mean_and_open_ones_keep_it() {
        // A line of cells: air 0–1 (open at 0), solid 2, air 3–5 (closed), solid 6, air 7 (closed, alone).
        let air = |i: usize| i != 2 && i != 6;
        let neighbours = |i: usize| [i.checked_sub(1), Some(i + 1)].into_iter().flatten().filter(move |&j| j < 8 && air(j));
        let regions = Regions::label(8, neighbours, |i| i == 0, air);
        assert_eq!(regions.count(), 2);
        let mut field = [1.0, 2.0, 0.0, 3.0, 4.0, 8.0, 0.0, 9.0];
        regions.remove_means(&mut field, &mut [0.0; 2]);
        assert_eq!(field, [1.0, 2.0, 0.0, -2.0, -1.0, 3.0, 0.0, 0.0]);
    }

    #[test]
    fn a_box_without_solids_is_one_region() {
        let neighbours = |i: usize| [(i + 1) % 4, (i + 3) % 4].into_iter();
        assert!(matches!(Regions::label(4, neighbours, |_| false, |_| true), Regions::Whole));
        assert!(Regions::label(4, neighbours, |i| i == 2, |_| true).is_empty());
    }
}
