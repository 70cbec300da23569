//! Boundary conditions and their properties.

/// Boundary condition at a face of the box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Boundary {
    /// Periodic (Zhang §2.3.7). The opposite face is periodic too.
    Wrap,
    /// Free slip: no flow through the face, no shear stress along it (Zhang §2.3.7: zero normal velocity).
    FreeSlip,
    /// The air beyond the face is the mirror image of that inside (Zhang §2.3.7: the velocity reverses). Equal to [`Boundary::FreeSlip`] on the
    /// staggered grid, which has the normal velocity on the face itself; different on the collocated grid of [`StableFluids`](crate::StableFluids).
    Reflect,
    /// No slip: the air at the face is at rest.
    NoSlip,
    /// Moving wall: the air at the face has this velocity (m/s).
    Lid {
        /// Velocity (m/s); the normal component is 0.
        velocity_m_per_s: [f32; 3],
    },
    /// Prescribed velocity as a function of position and time ([`Solver::set_inflow`](crate::Solver::set_inflow)); by default the mean wind. Dust enters with a
    /// concentration of 0.
    Inflow,
    /// Zero pressure and zero gradient of the velocity. Air that flows back in brings no kinetic energy: fluxes carry half of the velocity at the face (Braack & Mucha
    /// 2014), trajectories of velocity begin in air at rest.
    Outflow,
}

/// Rule for the values at and beyond a face, from their mirror images inside: `sign·image + 2·wall value`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum GhostRule {
    Periodic,
    Mirror { sign: f64, wall: f32 },
    MirrorPrescribed,
}

/// Zero gradient at the face.
const EVEN: GhostRule = GhostRule::Mirror { sign: 1.0, wall: 0.0 };
/// Zero value at the face.
const ODD: GhostRule = GhostRule::Mirror { sign: -1.0, wall: 0.0 };

impl Boundary {
    /// One of each condition; a lid has the velocity `lid_m_per_s` (m/s).
    pub fn all(lid_m_per_s: [f32; 3]) -> [Self; 7] {
        [Self::Wrap, Self::FreeSlip, Self::Reflect, Self::NoSlip, Self::Lid { velocity_m_per_s: lid_m_per_s }, Self::Inflow, Self::Outflow]
    }

    /// Name in tables and scene files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wrap => "wrap",
            Self::FreeSlip => "free-slip",
            Self::Reflect => "reflect",
            Self::NoSlip => "no-slip",
            Self::Lid { .. } => "lid",
            Self::Inflow => "inflow",
            Self::Outflow => "outflow",
        }
    }

    /// The condition of this name; a lid has the velocity `lid_m_per_s` (m/s).
    ///
    /// ```
    /// use prairie_wind::Boundary;
    /// assert_eq!(Boundary::from_name("no-slip", [0.0; 3]), Some(Boundary::NoSlip));
    /// ```
    pub fn from_name(name: &str, lid_m_per_s: [f32; 3]) -> Option<Self> {
        Self::all(lid_m_per_s).into_iter().find(|one| one.name() == name)
    }

    /// Whether the face is impermeable.
    pub fn blocks_flow(self) -> bool {
        match self {
            Self::FreeSlip | Self::Reflect | Self::NoSlip | Self::Lid { .. } => true,
            Self::Wrap | Self::Inflow | Self::Outflow => false,
        }
    }

    /// Whether the tangential velocity is prescribed on the face (a Dirichlet condition), rather than free.
    pub fn fixes_tangential_velocity(self) -> bool {
        match self {
            Self::NoSlip | Self::Lid { .. } | Self::Inflow => true,
            Self::Wrap | Self::FreeSlip | Self::Reflect | Self::Outflow => false,
        }
    }

    /// Whether the pressure on the face is 0 (a Dirichlet condition) and the normal velocity free. Elsewhere the pressure has zero normal gradient.
    pub fn fixes_pressure(self) -> bool {
        match self {
            Self::Outflow => true,
            Self::Wrap | Self::FreeSlip | Self::Reflect | Self::NoSlip | Self::Lid { .. } | Self::Inflow => false,
        }
    }

    /// Ghosts of a velocity component beyond the face: of the normal one, or of the tangential one along `component`.
    pub(super) fn velocity_ghosts(self, component: usize, is_normal: bool) -> GhostRule {
        match self {
            Self::Wrap => GhostRule::Periodic,
            Self::FreeSlip | Self::Reflect => {
                if is_normal {
                    ODD
                } else {
                    EVEN
                }
            }
            // Divergence-free flow that sticks to a wall has zero normal gradient of the normal velocity there.
            Self::NoSlip | Self::Lid { .. } if is_normal => EVEN,
            Self::NoSlip => ODD,
            Self::Lid { velocity_m_per_s } => GhostRule::Mirror { sign: -1.0, wall: velocity_m_per_s[component] },
            Self::Inflow => GhostRule::MirrorPrescribed,
            Self::Outflow => EVEN,
        }
    }

    /// Ghosts of a concentration beyond the face.
    pub(super) fn concentration_ghosts(self) -> GhostRule {
        match self {
            Self::Wrap => GhostRule::Periodic,
            Self::Inflow => GhostRule::Mirror { sign: 0.0, wall: 0.0 },
            Self::FreeSlip | Self::Reflect | Self::NoSlip | Self::Lid { .. } | Self::Outflow => EVEN,
        }
    }
}
