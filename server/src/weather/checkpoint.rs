//! Copies of the weather's state, from which it continues bit for bit.

use super::{Weather, WeatherError};
use crate::settings_error::SettingsError;
use crate::snapshot::WindFrame;
use prairie_core::scene::Scene;
use prairie_core::terrain::{CoverMap, HeightMap};
use prairie_core::wire::TurbulenceState;
use prairie_wind::state::StateError;
use prairie_wind::{AirState, StepReport};
use serde::{Deserialize, Serialize};

/// A copy of the state of [`Weather`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WeatherState {
    air: AirState<f32>,
    resets: u64,
    /// Ticks per step of the solver, at present and from the next common tick on.
    ticks_per_step: [u64; 2],
    turbulence: TurbulenceState,
    /// The newest frame: tick, gusts, codes.
    frame: (u64, TurbulenceState, Vec<i16>),
    /// The newest report: Courant number, divergence, energy, sub-steps, pressure residual, pressure sweeps.
    report: (f64, f64, f64, u32, f64, u32),
}

/// Reason why the weather cannot be restored.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WeatherRestoreError {
    /// The scene's settings are rejected.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The state is that of another box.
    #[error(transparent)]
    State(#[from] StateError),
    /// The frame is that of another box.
    #[error("its wind frame has {found} codes; needed: {needed}")]
    Frame {
        /// Number of codes.
        found: usize,
        /// Number of codes of the scene's wind.
        needed: usize,
    },
    /// The scene's wind cannot be stepped so rarely or often.
    #[error("its wind is stepped every {ticks} ticks; allowed: {allowed:?}")]
    Interval {
        /// Ticks per step.
        ticks: u64,
        /// Allowed ticks per step.
        allowed: Vec<u64>,
    },
}

impl Weather {
    /// Copies the state into `state`, whose memory is used again.
    pub fn save_into(&self, state: &mut WeatherState) {
        let StepReport { courant, divergence_rms_rel, kinetic_energy_m2_per_s2, substeps, pressure_residual, pressure_sweeps } =
            self.report;
        self.air.save_into(&mut state.air);
        (state.resets, state.turbulence) = (self.resets, self.turbulence);
        state.ticks_per_step = [self.ticks_per_step, self.wanted_ticks];
        (state.frame.0, state.frame.1) = (self.frame.tick, self.frame.turbulence);
        state.frame.2.clone_from(&self.frame.codes);
        state.report = (courant, divergence_rms_rel, kinetic_energy_m2_per_s2, substeps, pressure_residual, pressure_sweeps);
    }

    /// The weather of `scene` in a state that it had before; without a warm-up.
    ///
    /// # Errors
    /// When the solver rejects the scene's settings, or the state is that of another box.
    pub fn restored(scene: &Scene, height: &HeightMap, cover: &CoverMap, state: &WeatherState) -> Result<Self, WeatherRestoreError> {
        let mut weather = Self::after(scene, height, cover, (0, 0.0)).map_err(|error: WeatherError| error.in_settings(scene))?;
        weather.air.restore(&state.air)?;
        (weather.resets, weather.turbulence) = (state.resets, state.turbulence);
        let (courant, divergence_rms_rel, kinetic_energy_m2_per_s2, substeps, pressure_residual, pressure_sweeps) = state.report;
        weather.report = StepReport { courant, divergence_rms_rel, kinetic_energy_m2_per_s2, substeps, pressure_residual, pressure_sweeps };
        let (tick, turbulence, ref codes) = state.frame;
        if codes.len() != weather.frame.codes.len() {
            return Err(WeatherRestoreError::Frame { found: codes.len(), needed: weather.frame.codes.len() });
        }
        if let Some(&ticks) = state.ticks_per_step.iter().find(|ticks| !weather.allowed_ticks.contains(ticks)) {
            return Err(WeatherRestoreError::Interval { ticks, allowed: weather.allowed_ticks });
        }
        let [present, wanted] = state.ticks_per_step;
        if present != weather.ticks_per_step {
            weather.set_interval(present);
        }
        weather.wanted_ticks = wanted;
        weather.hold(WindFrame { tick, cells: weather.frame.cells, turbulence, codes: codes.clone() });
        Ok(weather)
    }
}
