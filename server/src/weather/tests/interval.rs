//! Steps of the solver that are shortened and stretched while the world runs.

use super::*;
use crate::weather::pilot::HORIZON_SECS;

/// The wind of a built-in scene, with grass at rest.
struct Blowing {
    weather: Weather,
    height: HeightMap,
    grass: Field,
    tick: u64,
}

impl Blowing {
    fn new(scene: &str) -> Self {
        let loaded = crate::scenes::load(scene).unwrap();
        let weather = Weather::new(&loaded.scene, &loaded.height, &loaded.cover).unwrap();
        Self { weather, grass: grass(&loaded.scene), height: loaded.height, tick: 0 }
    }

    fn step(&mut self) {
        self.tick += 1;
        self.weather.step(self.tick, &[], &self.height, &self.grass);
    }

    /// Horizontal wind of the lowest cells (m/s).
    fn lowest(&self) -> Vec<[f64; 2]> {
        let [nx, ny, nz] = self.weather.config.cells;
        let velocities = self.weather.velocities();
        let places = (0..nz).flat_map(|k| (0..nx).map(move |i| i + nx * ny * k));
        places.map(|at| [velocities[at].x.into(), velocities[at].z.into()]).collect()
    }
}

fn rms(of: impl Iterator<Item = [f64; 2]>) -> f64 {
    let (sum, count) = of.fold((0.0, 0.0), |(sum, count), [u, w]| (sum + u * u + w * w, count + 1.0));
    (sum / count).sqrt()
}

#[test]
fn every_moment_is_simulated_once_however_often_the_interval_changes() {
    let mut blowing = Blowing::new("meadow");
    let allowed = blowing.weather.allowed_ticks().to_vec();
    assert!(allowed.contains(&blowing.weather.own_ticks()) && allowed.len() >= 3, "{allowed:?}");
    let (start_secs, longest) = (blowing.weather.air.time_secs(), *allowed.last().unwrap());
    let mut intervals = Vec::new();
    for tick in 1..=600 {
        if tick % 37 == 0 {
            blowing.weather.step_every(allowed[tick / 37 * 5 % allowed.len()]);
        }
        blowing.step();
        intervals.push(blowing.weather.ticks_per_step);
        if blowing.tick.is_multiple_of(longest) {
            let simulated_secs = blowing.weather.air.time_secs() - start_secs;
            assert!((simulated_secs - tick as f64 / 60.0).abs() < 1e-4, "{simulated_secs} s after {tick} ticks");
        }
    }
    assert!(allowed.iter().all(|ticks| intervals.contains(ticks)), "{allowed:?} in {intervals:?}");
    blowing.weather.step_every(longest + 1);
    let before = blowing.weather.wanted_ticks;
    assert!(allowed.contains(&before), "{before}");
}

#[test]
fn a_wind_whose_interval_changes_is_restored() {
    let mut blowing = Blowing::new("meadow");
    let [own, longest] = [blowing.weather.own_ticks(), *blowing.weather.allowed_ticks().last().unwrap()];
    (0..longest + 1).for_each(|_| blowing.step());
    blowing.weather.step_every(2 * own);
    (0..2 * own).for_each(|_| blowing.step());
    blowing.weather.step_every(longest);
    blowing.step();
    assert_ne!(blowing.weather.wanted_ticks, blowing.weather.ticks_per_step, "a change waits");
    let mut state = WeatherState::default();
    blowing.weather.save_into(&mut state);
    let mut copy = Blowing { tick: blowing.tick, ..Blowing::new("meadow") };
    let loaded = crate::scenes::load("meadow").unwrap();
    copy.weather = Weather::restored(&loaded.scene, &loaded.height, &loaded.cover, &state).unwrap();
    (0..4 * longest).for_each(|_| {
        blowing.step();
        copy.step();
    });
    assert_eq!((copy.weather.ticks_per_step, copy.weather.step_secs), (longest, blowing.weather.step_secs));
    assert!(copy.weather.velocities() == blowing.weather.velocities() && copy.weather.frame == blowing.weather.frame);
}

#[test]
fn the_scenes_own_interval_has_the_same_frames_after_a_detour() {
    for own_ticks in [1, 2, 3, 4, 5] {
        let loaded = crate::scenes::load("meadow").unwrap();
        let mut scene = loaded.scene.clone();
        scene.wind.step_secs = ((own_ticks as f32 - 0.5) / scene.tick_hz).max(0.004);
        let mut weather = Weather::new(&scene, &loaded.height, &loaded.cover).unwrap();
        let (frame, own) = (weather.ticks_per_frame, weather.own_ticks());
        assert_eq!(own, own_ticks);
        weather.set_interval(2 * own);
        weather.set_interval(own);
        assert_eq!(weather.ticks_per_frame, frame, "every {own_ticks} ticks");
    }
}

#[test]
fn watching_the_errors_changes_no_bit() {
    let (mut watched, mut unseen) = (Blowing::new("storm"), Blowing::new("storm"));
    watched.weather.watch_errors(&watched.height);
    for _ in 0..300 {
        watched.step();
        unseen.step();
    }
    assert!(
        watched.weather.step_errors().present.samples >= 2 && watched.weather.step_errors().doubled.samples >= 2,
        "{:?}",
        watched.weather.step_errors()
    );
    assert!(watched.weather.velocities() == unseen.weather.velocities() && watched.weather.frame == unseen.weather.frame);
}

#[test]
fn stretched_steps_err_by_no_more_than_is_shown() {
    // At immersed walls, as in the lee of stones, each step errs anew instead of adding to the errors of those before.
    for (scene, most) in [("storm", 10.0), ("meadow", 10.0), ("cyclones", 10.0), ("lee", 200.0)] {
        let (mut own, mut stretched) = (Blowing::new(scene), Blowing::new(scene));
        stretched.weather.watch_errors(&stretched.height);
        let longest = *own.weather.allowed_ticks().last().unwrap();
        // Both have the same wind until enough is known about longer steps.
        (0..240 + longest - 240 % longest).for_each(|_| {
            own.step();
            stretched.step();
        });
        let own_ticks = own.weather.own_ticks();
        for ticks in stretched.weather.allowed_ticks().to_vec().into_iter().filter(|ticks| *ticks > own_ticks) {
            stretched.weather.step_every(ticks);
            let until = stretched.tick + (60.0 * HORIZON_SECS) as u64;
            let mut shown = 0.0;
            while stretched.tick < until || !stretched.tick.is_multiple_of(ticks) {
                own.step();
                stretched.step();
                shown = f64::max(shown, stretched.weather.step_errors().present.m_per_s2.unwrap_or(0.0) * HORIZON_SECS);
            }
            let (one, other) = (own.lowest(), stretched.lowest());
            let apart = rms(one.iter().zip(&other).map(|(a, b)| [a[0] - b[0], a[1] - b[1]]));
            let whole = rms(one.into_iter());
            println!("{scene}, every {ticks} instead of {own_ticks} ticks: {apart:.4} m/s of {whole:.2} m/s, shown {shown:.4} m/s");
            assert!(apart <= shown, "{scene}: {apart} m/s with steps of {ticks} ticks, shown {shown} m/s");
            assert!(shown < most * apart, "{scene}: {apart} m/s is hardly anything of the {shown} m/s that are shown");
        }
    }
}
