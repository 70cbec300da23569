//! Choices of the wind solver in a scene file: methods, schemes, tiling and terrain.

use serde::{Deserialize, Serialize};

/// Declares an enum for a field of a scene file, with the word of each variant.
macro_rules! words {
    ($(#[$meta:meta])* $name:ident { $($(#[$doc:meta])* $variant:ident = $word:literal,)+ }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
        pub enum $name {
            $($(#[$doc])* #[serde(rename = $word)] $variant,)+
        }

        impl $name {
            /// Every variant.
            pub const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// Every word, in the order of the variants.
            pub const WORDS: &'static [&'static str] = &[$($word),+];

            /// The word in a scene file.
            pub fn word(self) -> &'static str {
                match self {
                    $(Self::$variant => $word,)+
                }
            }
        }
    };
}
pub(crate) use words;

words! {
    /// Wind solver.
    WindMethod {
        /// Staggered grid: velocities on cell faces, pressure and dust at cell centres (Harlow & Welch 1965).
        Staggered = "staggered",
        /// Collocated grid, 20 Gauss–Seidel sweeps (Zhang, chapter 2, after Stam 1999).
        StableFluids = "stable-fluids",
    }
}

words! {
    /// Advection scheme of the wind or of dust.
    WindAdvection {
        /// Linear interpolation at the departure point (Zhang §2.3); first order, dissipative.
        SemiLagrangian = "semi-lagrangian",
        /// Semi-Lagrangian forward and back, half the error subtracted, limited (Selle et al. 2008); second order.
        MacCormack = "mac-cormack",
        /// Back and forth error compensation and correction (Dupont & Liu 2003); second order.
        Bfecc = "bfecc",
        /// Fluxes through cell faces; second order, conserves momentum.
        Conservative = "conservative",
    }
}

impl WindAdvection {
    /// Whether the scheme computes fluxes through cell faces, rather than tracing trajectories back.
    pub fn uses_fluxes(self) -> bool {
        match self {
            Self::SemiLagrangian | Self::MacCormack | Self::Bfecc => false,
            Self::Conservative => true,
        }
    }
}

words! {
    /// Time scheme of the wind.
    WindTime {
        /// One sub-step after the other; first order in time.
        Split = "split",
        /// Advection–reflection (Narain et al. 2019); second order, for the semi-Lagrangian family.
        Reflection = "reflection",
        /// Three Runge–Kutta stages with pressure correction; second order, for conservative advection.
        RungeKutta3 = "runge-kutta-3",
    }
}

impl WindTime {
    /// Whether the scheme can be combined with an advection scheme of the wind.
    pub fn allows(self, advection: WindAdvection) -> bool {
        match self {
            Self::Split => true,
            Self::Reflection => !advection.uses_fluxes(),
            Self::RungeKutta3 => advection.uses_fluxes(),
        }
    }
}

words! {
    /// Diffusion scheme of the wind.
    WindDiffusion {
        /// Forward Euler, with sub-steps within its limit (ν·dt/h² up to 1/6 in cubic cells).
        Explicit = "explicit",
        /// Backward Euler by Gauss–Seidel sweeps (Zhang §2.3).
        GaussSeidel = "gauss-seidel",
        /// Backward Euler, solved directly; first order in time.
        Implicit = "implicit",
        /// Crank–Nicolson, solved directly, or an L-stable scheme where friction is stiff and the pressure is kept; second order in time.
        CrankNicolson = "crank-nicolson",
    }
}

words! {
    /// Solver of the pressure equation.
    WindPressure {
        /// Transforms, exact to rounding; needs a box without obstacles.
        Direct = "direct",
        /// Jacobi sweeps.
        Jacobi = "jacobi",
        /// Gauss–Seidel sweeps (Zhang §2.3).
        GaussSeidel = "gauss-seidel",
        /// Red–black successive over-relaxation.
        Sor = "sor",
        /// Conjugate gradients.
        ConjugateGradients = "conjugate-gradients",
        /// Conjugate gradients preconditioned by multigrid cycles.
        Multigrid = "multigrid",
    }
}

words! {
    /// How the wind's box covers the world.
    WindTiling {
        /// One box over the scene, repeated where it is periodic.
        Box = "box",
        /// One small box that serves every patch, with a random offset per patch (Zhang §5.1).
        Patch = "patch",
        /// A box that follows the objects.
        Follow = "follow",
    }
}

words! {
    /// How the wind treats the land.
    WindTerrain {
        /// The floor of the box follows the land; heights in the box are above the ground.
        Follow = "follow",
        /// The land is solid cells in a box of absolute height.
        Obstacle = "obstacle",
    }
}
