//! Blades in a gust that the wind's solver blew.

use std::sync::OnceLock;

use anyhow::Result;
use server::wind::{Air, Config, Method};
use shared::plant::blade::{Blade, Integrator, LINKS, Leans, Sway, advance};

/// Places where the wind is recorded, each with a blade.
pub const PLACES: usize = 64;

/// Blades that are stepped at once.
pub const ABREAST: usize = 16;

/// Frames of the record in its second.
const FRAMES: usize = 60;

/// Steps of the wind before the record begins, so that gusts blow.
const FRAMES_BEFORE: usize = 240;

/// Steps that the reference takes (1/s).
const FINEST_PER_SEC: usize = 30_720;

/// A blade of the default scene.
pub const BLADE: Blade = Blade { length_m: 0.8, frequency_rad_per_s: 9.74, damping_share: 0.1, lean_per_wind2: 0.005 };

/// A second of wind at the control points of [`PLACES`] blades, linear between its frames.
pub struct Gust {
    frames: Vec<[Leans; PLACES]>,
}

impl Gust {
    /// The wind of the default scene over land, read where upright blades have their control points; recorded once.
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

    /// Wind at [`ABREAST`] blades, in all steps of the second: for the first of them in all steps, then for the next.
    pub fn abreast(&self, steps: usize) -> Vec<Leans<[f32; ABREAST]>> {
        let groups = (0..PLACES / ABREAST).flat_map(|group| (0..steps).map(move |step| (group, step)));
        let winds = groups.map(|(group, step)| {
            let each: [Leans; ABREAST] = std::array::from_fn(|n| self.wind_m_per_s(ABREAST * group + n, step, steps));
            std::array::from_fn(|link| std::array::from_fn(|axis| each.map(|wind| wind[link][axis])))
        });
        winds.collect()
    }

    /// Tips of the blades after the second (m from the root), from steps so short that no integrator matters.
    pub fn tips_m(&self) -> &'static [[f32; 3]] {
        static TIPS: OnceLock<Vec<[f32; 3]>> = OnceLock::new();
        TIPS.get_or_init(|| {
            let still = Leans::default();
            let tip = |place: usize| {
                let dt_secs = 1.0 / FINEST_PER_SEC as f32;
                let sway = (0..FINEST_PER_SEC).fold(Sway::default(), |sway, step| {
                    advance(&sway, &BLADE, &still, &self.wind_m_per_s(place, step, FINEST_PER_SEC), Integrator::Exact, dt_secs)
                });
                sway.points_m(BLADE.length_m)[LINKS - 1]
            };
            (0..PLACES).map(tip).collect()
        })
    }

    /// Whether the record blows at all.
    ///
    /// # Errors
    /// When it is still.
    pub fn check(&self) -> Result<()> {
        let strongest = self.frames.iter().flatten().flatten().flatten().fold(0.0_f32, |most, speed| most.max(speed.abs()));
        anyhow::ensure!(strongest > 1.0, "the wind is still: {strongest} m/s");
        Ok(())
    }
}
