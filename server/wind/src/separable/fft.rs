//! Complex Fourier transform of four lines at once, of any length.
//!
//! Stockham's self-sorting form, decimation in frequency (Van Loan, "Computational Frameworks for the FFT", 1992, §1.7): each stage reads one buffer
//! and writes the other, without a permutation. Radices 4 and 2, then every odd prime by its definition, halved by symmetry: the cost per value is
//! the sum of the prime factors of the length. Transforms of one line at a time would first have to gather every line.

use std::f64::consts::FRAC_PI_2;

use super::lanes::Pair;

/// A planned transform `Z[k] = Σ z[j]·exp(−2πi·jk/len)`, not normalised.
pub(super) struct Fft {
    stages: Vec<Stage>,
}

struct Stage {
    radix: usize,
    /// Product of the radices of the preceding stages: the number of adjacent values that share a twiddle factor.
    stride: usize,
    /// `exp(−2πi·pj/n)` for `j = 1..radix`, in turn for each `p` of the `n/radix` butterflies.
    twiddles: Vec<[f64; 2]>,
    /// `exp(−2πi·j/radix)`, for an odd radix.
    roots: Vec<[f64; 2]>,
}

impl Fft {
    pub(super) fn new(len: usize) -> Self {
        let mut stages = Vec::new();
        let (mut n, mut stride) = (len, 1);
        while n > 1 {
            let radix = if n.is_multiple_of(4) { 4 } else { smallest_prime_factor(n) };
            stages.push(Stage {
                radix,
                stride,
                twiddles: (0..n / radix).flat_map(|p| (1..radix).map(move |j| root(p * j, n))).collect(),
                roots: (0..radix).map(|j| root(j, radix)).collect(),
            });
            n /= radix;
            stride *= radix;
        }
        Self { stages }
    }

    /// Transforms `values`, using `spare` of the same length. Returns the buffer with the result, then the other one.
    #[inline(always)]
    pub(super) fn transform<'a>(&self, values: &'a mut [Pair], spare: &'a mut [Pair]) -> (&'a mut [Pair], &'a mut [Pair]) {
        let (mut from, mut to) = (values, spare);
        for stage in &self.stages {
            match stage.radix {
                4 => stage.by_four(from, to),
                2 => stage.by_two(from, to),
                // The same loops, unrolled.
                3 => stage.by_odd(3, from, to),
                5 => stage.by_odd(5, from, to),
                radix => stage.by_odd(radix, from, to),
            }
            (from, to) = (to, from);
        }
        (from, to)
    }
}

impl Stage {
    #[inline(always)]
    fn by_four(&self, from: &[Pair], to: &mut [Pair]) {
        let s = self.stride;
        let quarter = from.len() / 4;
        let (low, high) = from.split_at(2 * quarter);
        let ((z0, z1), (z2, z3)) = (low.split_at(quarter), high.split_at(quarter));
        for (p, out) in to.chunks_exact_mut(4 * s).enumerate() {
            let (low, high) = out.split_at_mut(2 * s);
            let ((y0, y1), (y2, y3)) = (low.split_at_mut(s), high.split_at_mut(s));
            let here = p * s..(p + 1) * s;
            let (z0, z1, z2, z3) = (&z0[here.clone()], &z1[here.clone()], &z2[here.clone()], &z3[here]);
            if p == 0 {
                for q in 0..s {
                    (y0[q], y1[q], y2[q], y3[q]) = four_points(z0[q], z1[q], z2[q], z3[q]);
                }
            } else {
                let w = &self.twiddles[3 * p..][..3];
                for q in 0..s {
                    let (a, b, c, d) = four_points(z0[q], z1[q], z2[q], z3[q]);
                    (y0[q], y1[q], y2[q], y3[q]) = (a, b.turned(w[0]), c.turned(w[1]), d.turned(w[2]));
                }
            }
        }
    }

    #[inline(always)]
    fn by_two(&self, from: &[Pair], to: &mut [Pair]) {
        let s = self.stride;
        let (z0, z1) = from.split_at(from.len() / 2);
        for (p, out) in to.chunks_exact_mut(2 * s).enumerate() {
            let (y0, y1) = out.split_at_mut(s);
            let w = self.twiddles[p];
            for (q, (&z0, &z1)) in z0[p * s..].iter().zip(&z1[p * s..][..s]).enumerate() {
                y0[q] = z0 + z1;
                y1[q] = (z0 - z1).turned(w);
            }
        }
    }

    #[inline(always)]
    fn by_odd(&self, radix: usize, from: &[Pair], to: &mut [Pair]) {
        let s = self.stride;
        let part = from.len() / radix;
        let roots = &self.roots[..radix];
        for (p, out) in to.chunks_exact_mut(radix * s).enumerate() {
            for q in 0..s {
                let z = |i: usize| from[i * part + p * s + q];
                out[q] = (1..radix).fold(z(0), |sum, i| sum + z(i));
                for j in 1..=radix / 2 {
                    let (mut even, mut odd) = (z(0), Pair::default());
                    for i in 1..=radix / 2 {
                        let [cos, minus_sin] = roots[i * j % radix];
                        even = even + (z(i) + z(radix - i)) * cos;
                        odd = odd + (z(i) - z(radix - i)) * minus_sin;
                    }
                    out[j * s + q] = even.plus_i(odd).turned(self.twiddles[p * (radix - 1) + j - 1]);
                    out[(radix - j) * s + q] = even.minus_i(odd).turned(self.twiddles[p * (radix - 1) + radix - j - 1]);
                }
            }
        }
    }
}

#[inline(always)]
fn four_points(z0: Pair, z1: Pair, z2: Pair, z3: Pair) -> (Pair, Pair, Pair, Pair) {
    let (even, even_difference) = (z0 + z2, z0 - z2);
    let (odd, odd_difference) = (z1 + z3, z1 - z3);
    (even + odd, even_difference.minus_i(odd_difference), even - odd, even_difference.plus_i(odd_difference))
}

fn smallest_prime_factor(n: usize) -> usize {
    (2..).take_while(|factor| factor * factor <= n).find(|factor| n.is_multiple_of(*factor)).unwrap_or(n)
}

/// `exp(−2πi·k/n)`, with the angle reduced to a quarter turn before rounding.
pub(super) fn root(k: usize, n: usize) -> [f64; 2] {
    let quarters = 4 * (k % n);
    let (sin, cos) = (FRAC_PI_2 * (quarters % n) as f64 / n as f64).sin_cos();
    match quarters / n {
        0 => [cos, -sin],
        1 => [-sin, -cos],
        2 => [-cos, sin],
        _ => [sin, cos],
    }
}
