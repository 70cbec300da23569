//! Blades in a gust recorded from the wind solver.

use std::sync::OnceLock;

use anyhow::Result;
use prairie_core::plant::blade::{Blade, Integrator, LINKS, Leans, Sway, advance};
use prairie_wind::{Air, Config, Method};

/// Number of positions where the wind is recorded, each with a blade.
pub const PLACES: usize = 64;

/// Frames of the record, which lasts a second.
const FRAMES: usize = 60;

/// Wind steps before the record begins, so that gusts have developed.
const FRAMES_BEFORE: usize = 240;

/// Step rate of the reference (1/s).
const FINEST_PER_S: usize = 30_720;

/// A blade of the default scene.
pub const BLADE: Blade = Blade { length_m: 0.8, frequency_rad_per_s: 9.74, damping_ratio: 0.1, lean_per_wind2: 0.005 };

/// A second of wind at the control points of [`PLACES`] blades, linear between its frames.
pub struct Gust {
    frames: Vec<[Leans; PLACES]>,
}

impl Gust {
    /// The wind of the default scene, sampled at the control points of upright blades; recorded once per process.
    pub fn recorded() -> &'static Self {
        static GUST: OnceLock<Gust> = OnceLock::new();
        GUST.get_or_init(|| {
            let mut air = Air::<f32>::new(Method::Staggered, &Config::default()).expect("the default settings are allowed");
            let mut step = |times: usize| {
                for _ in 0..times {
                    air.step(1.0 / FRAMES as f64, &[]).expect("a step within the limits");
                }
                std::array::from_fn(|place| {
                    std::array::from_fn(|link| {
                        let [x, z] = [place % 8, place / 8].map(|n| 32.0 * n as f32 + 5.0);
                        let [east, _, south] = air.velocity_at([x, BLADE.length_m * (link + 1) as f32 / LINKS as f32, z]);
                        [east, south]
                    })
                })
            };
            let first = step(FRAMES_BEFORE);
            Self { frames: std::iter::once(first).chain((0..FRAMES).map(|_| step(1))).collect() }
        })
    }

    /// Wind at a blade at `step` of `steps` in the second.
    fn wind_m_per_s(&self, place: usize, step: usize, steps: usize) -> Leans {
        let (frame, part) = (step * FRAMES / steps, (step * FRAMES % steps) as f32 / steps as f32);
        let [from, to] = [frame, frame + 1].map(|frame| self.frames[frame][place]);
        std::array::from_fn(|link| std::array::from_fn(|axis| from[link][axis] + (to[link][axis] - from[link][axis]) * part))
    }

    /// Wind at each blade in all `steps` of the second.
    pub fn winds_m_per_s(&self, steps: usize) -> Vec<Vec<Leans>> {
        (0..PLACES).map(|place| (0..steps).map(|step| self.wind_m_per_s(place, step, steps)).collect()).collect()
    }

    /// Tips of the blades after the second (m from the root), from time steps so short that the choice of integrator does not matter.
    pub fn tips_m(&self) -> &'static [[f32; 3]] {
        static TIPS: OnceLock<Vec<[f32; 3]>> = OnceLock::new();
        TIPS.get_or_init(|| {
            let still = Leans::default();
            let tip = |place: usize| {
                let dt_secs = 1.0 / FINEST_PER_S as f32;
                let sway = (0..FINEST_PER_S).fold(Sway::default(), |sway, step| {
                    advance(&sway, &BLADE, &still, &self.wind_m_per_s(place, step, FINEST_PER_S), Integrator::Exact, dt_secs)
                });
                sway.points_m(BLADE.length_m)[LINKS - 1]
            };
            (0..PLACES).map(tip).collect()
        })
    }

    /// Checks that the record is not still.
    ///
    /// # Errors
    /// When it is still.
    pub fn check(&self) -> Result<()> {
        let strongest = self.frames.iter().flatten().flatten().flatten().fold(0.0_f32, |most, speed| most.max(speed.abs()));
        anyhow::ensure!(strongest > 1.0, "the wind is still: {strongest} m/s");
        Ok(())
    }
}
