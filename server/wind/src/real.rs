//! Floating-point types of the fields.

use std::fmt::{Debug, Display};

use num_traits::Float;

/// Floating-point type of a solver: `f32` for the simulation, `f64` for reference runs.
pub trait Real: Float + Default + Debug + Display + Send + Sync + 'static {
    /// Conversion from `f64`, rounded to nearest.
    ///
    /// ```
    /// use prairie_wind::Real;
    /// assert_eq!(f32::of(0.5), 0.5f32);
    /// ```
    fn of(x: f64) -> Self;

    /// Exact conversion to `f64`.
    fn wide(self) -> f64;

    /// Splits `self` into its floor and the fraction in `[0, 1)` above it; values beyond the range of `i32` give its nearest end and 0. NaN gives `(0, NaN)`.
    ///
    /// ```
    /// use prairie_wind::Real;
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
