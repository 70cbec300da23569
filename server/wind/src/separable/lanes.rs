//! Eight lines of numbers at once: four complex numbers, with four lines in the real parts and four in the imaginary parts.
//!
//! Lines of an array lie side by side, so one instruction does the same to several of them and no line is ever gathered. The operations are written
//! lane by lane and vectorised by the compiler: no result depends on the vector width of the processor.

use std::array::from_fn;
use std::ops::{Add, Mul, Sub};

/// Lines in one [`Pair`].
pub(super) const LINES: usize = 8;

/// The same entry of four lines.
#[derive(Clone, Copy, Default)]
#[repr(align(32))]
pub(super) struct Lanes([f64; 4]);

impl Add for Lanes {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(from_fn(|l| self.0[l] + other.0[l]))
    }
}

impl Sub for Lanes {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(from_fn(|l| self.0[l] - other.0[l]))
    }
}

impl Mul<f64> for Lanes {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        Self(from_fn(|l| self.0[l] * factor))
    }
}

/// The same entry of eight lines, as four complex numbers.
#[derive(Clone, Copy, Default)]
pub(super) struct Pair {
    re: Lanes,
    im: Lanes,
}

impl Pair {
    /// The [`LINES`] values at the front of `row`.
    #[inline(always)]
    pub(super) fn load(row: &[f64]) -> Self {
        let row = &row[..LINES];
        Self { re: Lanes(from_fn(|l| row[l])), im: Lanes(from_fn(|l| row[4 + l])) }
    }

    /// Writes the [`LINES`] values to the front of `row`.
    #[inline(always)]
    pub(super) fn store(self, row: &mut [f64]) {
        let row = &mut row[..LINES];
        row[..4].copy_from_slice(&self.re.0);
        row[4..].copy_from_slice(&self.im.0);
    }

    /// Real and imaginary parts swapped. A forward transform between two swaps is a backward one.
    #[inline(always)]
    pub(super) fn swapped(self) -> Self {
        Self { re: self.im, im: self.re }
    }

    /// This plus `i` times `other`.
    #[inline(always)]
    pub(super) fn plus_i(self, other: Self) -> Self {
        Self { re: self.re - other.im, im: self.im + other.re }
    }

    /// This minus `i` times `other`.
    #[inline(always)]
    pub(super) fn minus_i(self, other: Self) -> Self {
        Self { re: self.re + other.im, im: self.im - other.re }
    }

    /// Separates two real lines transformed as one complex line: twice their cosine and sine amplitudes at one frequency, from the transform there
    /// (`self`) and at the opposite frequency (`mirrored`).
    #[inline(always)]
    pub(super) fn apart(self, mirrored: Self) -> (Self, Self) {
        (self + mirrored, Self { re: self.im - mirrored.im, im: mirrored.re - self.re })
    }

    /// This times the complex number `[re, im]`.
    #[inline(always)]
    pub(super) fn turned(self, [re, im]: [f64; 2]) -> Self {
        Self { re: self.re * re - self.im * im, im: self.re * im + self.im * re }
    }
}

impl Add for Pair {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { re: self.re + other.re, im: self.im + other.im }
    }
}

impl Sub for Pair {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { re: self.re - other.re, im: self.im - other.im }
    }
}

impl Mul<f64> for Pair {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        Self { re: self.re * factor, im: self.im * factor }
    }
}
