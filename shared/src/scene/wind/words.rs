//! The words that choose how the wind is solved: methods, schemes, tiling and terrain.

use serde::{Deserialize, Serialize};

/// An enum of the words that a field of a scene file takes, each variant with its word.
macro_rules! words {
    ($(#[$meta:meta])* $name:ident { $($(#[$doc:meta])* $variant:ident = $word:literal,)+ }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
        pub enum $name {
            $($(#[$doc])* #[serde(rename = $word)] $variant,)+
        }

        impl $name {
            /// Every word, in the order of the variants.
            pub const WORDS: &'static [&'static str] = &[$($word),+];

            /// The word that a scene file writes.
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
    /// Which solver computes the wind.
    WindMethod {
        /// Velocities on the faces of cells, pressure and dust at their centres (Harlow & Welch, Phys. Fluids 8, 1965).
        Staggered = "staggered",
        /// The method of 000, chapter 2: everything at the centres of cells, 20 Gauss–Seidel sweeps (after Stam, SIGGRAPH 1999).
        StableFluids = "stable-fluids",
    }
}

words! {
    /// How the wind carries itself, or dust, along.
    WindAdvection {
        /// Traces back and reads between cells linearly (000 §2.3); first order, loses energy.
        SemiLagrangian = "semi-lagrangian",
        /// Semi-Lagrangian there and back, half the error taken off, limited (Selle et al., J. Sci. Comput. 35, 2008); second order.
        MacCormack = "mac-cormack",
        /// Back and forth error compensation and correction (Dupont & Liu, J. Comput. Phys. 190, 2003); second order.
        Bfecc = "bfecc",
        /// Fluxes through the faces of cells; second order, keeps momentum.
        Conservative = "conservative",
    }
}

words! {
    /// How the parts of a step follow each other.
    WindTime {
        /// One after the other; first order in time.
        Split = "split",
        /// Projects by reflection half-way (Zehnder, Narain & Thomaszewski, SIGGRAPH 2018); second order, for the semi-Lagrangian family.
        Reflection = "reflection",
        /// Three Runge–Kutta stages; second order with the pressure, for conservative advection.
        RungeKutta3 = "runge-kutta-3",
    }
}

words! {
    /// How viscosity spreads momentum.
    WindDiffusion {
        /// Forward in time, sub-stepped within its limit (a = ν·dt/h² up to 1/6 in cubic cells).
        Explicit = "explicit",
        /// Implicit, by Gauss–Seidel sweeps (000 §2.3).
        GaussSeidel = "gauss-seidel",
        /// Implicit Euler, solved directly; first order in time.
        Implicit = "implicit",
        /// Mean of explicit and implicit, solved directly; second order in time.
        CrankNicolson = "crank-nicolson",
    }
}

words! {
    /// How the pressure that makes the wind free of divergence is found.
    WindPressure {
        /// By transforms, to rounding; needs a box without obstacles.
        Direct = "direct",
        /// Jacobi's sweeps, from the last iterate.
        Jacobi = "jacobi",
        /// Gauss–Seidel sweeps (000 §2.3).
        GaussSeidel = "gauss-seidel",
        /// Successive over-relaxation, red and black.
        Sor = "sor",
        /// Conjugate gradients.
        ConjugateGradients = "conjugate-gradients",
        /// Conjugate gradients preconditioned by multigrid cycles.
        Multigrid = "multigrid",
    }
}

words! {
    /// How the box serves a world larger than itself.
    WindTiling {
        /// One box over the scene, repeated where it wraps.
        Box = "box",
        /// One small box serves every patch, moved at random per patch (000 §5.1).
        Patch = "patch",
        /// The box goes where the action is.
        Follow = "follow",
    }
}

words! {
    /// What the land is to the wind.
    WindTerrain {
        /// The floor of the box follows the land; heights in the box count from the ground.
        Follow = "follow",
        /// The land is solid cells in a box of absolute height.
        Obstacle = "obstacle",
    }
}
