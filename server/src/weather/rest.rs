//! Air at rest: where nothing drives it, the solver takes no step.

use prairie_wind::{Body, Boundary, Canopy, Config};

/// Fraction of the error of the wind on the wire below which air that nothing drives is set to rest: its codes are 0. By itself it would take
/// many minutes to come to rest, since drag falls with the square of its speed.
const REST_FRACTION: f32 = 0.1;

/// When the air of a scene is at rest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rest {
    /// Whether nothing in the scene's settings drives the air.
    is_undriven: bool,
    /// Speed (m/s) that counts as rest, the sum over the axes.
    speed_m_per_s: f64,
}

impl Rest {
    pub(super) fn new(config: &Config, wind_error_m_per_s: f32) -> Self {
        let is_moved = |boundary: &Boundary| matches!(boundary, Boundary::Lid { velocity_m_per_s } if *velocity_m_per_s != [0.0; 3]);
        let sways = matches!(config.canopy, Some(Canopy { motion: Some(_), .. }));
        let is_undriven = config.mean_wind_m_per_s == [0.0; 3]
            && config.body_force_m_per_s2 == [0.0; 3]
            && (config.gusts.number == 0 || config.gusts.strength_m_per_s == 0.0)
            && config.primitives.is_empty()
            && config.dust.is_none()
            && !sways
            && !config.boundary.iter().flatten().any(is_moved);
        Self { is_undriven, speed_m_per_s: f64::from(REST_FRACTION * wind_error_m_per_s) }
    }

    /// Whether nothing drives the air while these bodies are in it, and no jets.
    pub(super) fn is_undriven(&self, bodies: &[Body]) -> bool {
        self.is_undriven && bodies.iter().all(|body| body.velocity_m_per_s == [0.0; 3])
    }

    /// Whether air with these largest speeds along the axes counts as at rest.
    pub(super) fn holds(&self, max_speed_m_per_s: [f64; 3]) -> bool {
        max_speed_m_per_s.iter().sum::<f64>() <= self.speed_m_per_s
    }
}
