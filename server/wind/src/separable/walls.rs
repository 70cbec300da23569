//! Modes of the second difference between walls.
//!
//! With walls the matrix of −∂² is `W⁻¹·M`, where M is the symmetric matrix with mirrored values beyond the edges and W is diagonal: 3/4 next to a wall and 1
//! elsewhere. It has the real positive eigenvalues of `T = W^(−1/2)·M·W^(−1/2) = Q·Λ·Qᵀ`, and its modes are the columns of `W^(−1/2)·Q`. Two of them decay away from
//! the walls and are no sines; so Q is found numerically.

/// Fraction of its second difference with mirrored values that enters the symmetric matrix in the row next to a wall.
pub(super) const WEIGHT: f64 = 0.75;

/// Eigenvalues of −∂² for a spacing of 1 on `len` ≥ 2 centres.
pub(super) fn eigenvalues(walls: [bool; 2], len: usize) -> Vec<f64> {
    decompose(walls, len).0
}

/// Matrices, in row order, that transform `len` ≥ 2 centres to modes and back.
pub(super) fn matrices(walls: [bool; 2], len: usize) -> [Vec<f64>; 2] {
    let (_, rows) = decompose(walls, len);
    let mut roots = vec![1.0; len];
    [0, len - 1].into_iter().zip(walls).filter(|(_, is_wall)| *is_wall).for_each(|(at, _)| roots[at] = WEIGHT.sqrt());
    let to_modes = rows.iter().enumerate().map(|(n, value)| value * roots[n % len]).collect();
    let back = (0..len * len).map(|n| rows[n % len * len + n / len] / roots[n / len]).collect();
    [to_modes, back]
}

/// Λ, and the rows of Qᵀ.
fn decompose(walls: [bool; 2], len: usize) -> (Vec<f64>, Vec<f64>) {
    let (mut diagonal, mut beside) = (vec![2.0; len], vec![-1.0; len]);
    beside[len - 1] = 0.0;
    for ((at, link), is_wall) in [(0, 0), (len - 1, len - 2)].into_iter().zip(walls) {
        diagonal[at] = if is_wall { 3.0 / WEIGHT } else { 1.0 };
        beside[link] /= if is_wall { WEIGHT.sqrt() } else { 1.0 };
    }
    let mut rows = vec![0.0; len * len];
    rows.iter_mut().step_by(len + 1).for_each(|value| *value = 1.0);
    diagonalise(&mut diagonal, &mut beside, &mut rows);
    (diagonal, rows)
}

/// Diagonalises a symmetric tridiagonal matrix by the QL algorithm with implicit shifts (Dubrulle, Martin & Wilkinson, Numer. Math. 12 (1968)): `diagonal` becomes
/// the eigenvalues, and the unit matrix in `rows` the eigenvectors, one per row. `beside` has the entries next to the diagonal, and a 0 at the end.
fn diagonalise(diagonal: &mut [f64], beside: &mut [f64], rows: &mut [f64]) {
    let n = diagonal.len();
    for low in 0..n {
        loop {
            let is_split = |&at: &usize| beside[at].abs() <= f64::EPSILON * (diagonal[at].abs() + diagonal[at + 1].abs());
            let high = (low..n - 1).find(is_split).unwrap_or(n - 1);
            if high == low {
                break;
            }
            sweep(low, high, diagonal, beside, rows);
        }
    }
}

/// One sweep of rotations from `high` up to `low`, the ends of a block without zeros beside the diagonal.
fn sweep(low: usize, high: usize, diagonal: &mut [f64], beside: &mut [f64], rows: &mut [f64]) {
    let n = diagonal.len();
    let slope = (diagonal[low + 1] - diagonal[low]) / (2.0 * beside[low]);
    let root = (slope * slope + 1.0).sqrt();
    let mut bulge = diagonal[high] - diagonal[low] + beside[low] / (slope + if slope < 0.0 { -root } else { root });
    let (mut sin, mut cos, mut shift) = (1.0, 1.0, 0.0);
    for at in (low..high).rev() {
        let (f, b) = (sin * beside[at], cos * beside[at]);
        let length = (f * f + bulge * bulge).sqrt();
        beside[at + 1] = length;
        if length == 0.0 {
            diagonal[at + 1] -= shift;
            beside[high] = 0.0;
            return;
        }
        (sin, cos) = (f / length, bulge / length);
        let base = diagonal[at + 1] - shift;
        let turned = (diagonal[at] - base) * sin + 2.0 * cos * b;
        shift = sin * turned;
        diagonal[at + 1] = base + shift;
        bulge = cos * turned - b;
        let (first, second) = rows[at * n..(at + 2) * n].split_at_mut(n);
        for (first, second) in first.iter_mut().zip(second) {
            (*first, *second) = (cos * *first - sin * *second, sin * *first + cos * *second);
        }
    }
    diagonal[low] -= shift;
    beside[low] = bulge;
    beside[high] = 0.0;
}
