//! The number a field is made of.

use std::fmt::{Debug, Display};

use num_traits::Float;

/// A floating-point number the kernels run in: `f32` for the simulation, `f64` for reference runs.
pub trait Real: Float + Default + Debug + Display + Send + Sync + 'static {
    /// The nearest value to `x`.
    ///
    /// ```
    /// use server::wind::Real;
    /// assert_eq!(f32::of(0.5), 0.5f32);
    /// ```
    fn of(x: f64) -> Self;

    /// This value in double precision; exact.
    fn wide(self) -> f64;

    /// Splits `self` into its floor and the fraction in `[0, 1)` above it; beyond 32 bits into the nearest integer there is, and 0. NaN gives `(0, NaN)`.
    ///
    /// ```
    /// use server::wind::Real;
    /// assert_eq!((-1.25f32).split(), (-2, 0.75));
    /// assert_eq!(1e30f32.split().1, 0.0);
    /// ```
    fn split(self) -> (isize, Self);
}

macro_rules! real {
    ($type:ty) => {
        impl Real for $type {
            #[inline(always)]
            fn of(x: f64) -> Self {
                x as $type
            }

            #[inline(always)]
            fn wide(self) -> f64 {
                f64::from(self)
            }

            // `floor` is a library call on the x86-64 baseline; a truncating conversion is one instruction.
            #[inline(always)]
            fn split(self) -> (isize, Self) {
                let truncated = self as i32;
                if truncated == i32::MAX || truncated == i32::MIN {
                    return (truncated as isize, 0.0);
                }
                let floor = truncated - i32::from(self < truncated as $type);
                (floor as isize, self - floor as $type)
            }
        }
    };
}

real!(f32);
real!(f64);
