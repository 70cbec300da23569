//! One number, or eight in the lanes of a vector register: what the step of a blade computes with.

use std::ops::{Add, Mul, Neg, Sub};
use wide::f32x8;

/// What can be added and multiplied as an `f32`, with the same bits.
pub trait Number: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> {
    /// The same number in every lane.
    fn splat(value: f32) -> Self;
    /// Quotient.
    fn over(self, divisor: Self) -> Self;
    /// Square root.
    fn root(self) -> Self;
    /// The lesser of two numbers.
    fn least(self, other: Self) -> Self;
}

impl Number for f32 {
    #[inline(always)]
    fn splat(value: f32) -> Self {
        value
    }

    #[inline(always)]
    fn over(self, divisor: Self) -> Self {
        self / divisor
    }

    #[inline(always)]
    fn root(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn least(self, other: Self) -> Self {
        self.min(other)
    }
}

impl Number for f32x8 {
    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self::splat(value)
    }

    #[inline(always)]
    fn over(self, divisor: Self) -> Self {
        self / divisor
    }

    #[inline(always)]
    fn root(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn least(self, other: Self) -> Self {
        self.min(other)
    }
}
