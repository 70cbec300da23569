//! Rates of the entities of a recording.

use super::entities::{ENTITIES, Entity, Rate};
use std::str::FromStr;
use thiserror::Error;

/// Largest rate of an entity (Hz): that of the fastest publications.
const HZ_LIMIT: f64 = 60.0;

/// Tolerance of a period (s), for the rounding of simulated time.
const TOLERANCE_SECS: f64 = 1e-6;

/// A stated rate of an entity of the recording, parsed from `PATH=HZ`.
///
/// `HZ` is the most times per simulated second, 0 to 60; 0 turns the entity off. Entities that are recorded once, or when something happens, can
/// only be turned off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EntityRate {
    entity: Entity,
    hz: f64,
}

/// Faults of the rate of an entity.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum EntityRateError {
    /// There is no `=`.
    #[error("`{0}` is no rate of an entity; expected PATH=HZ, such as world/wind=2")]
    NoRate(String),
    /// No entity has this path.
    #[error("there is no entity `{0}`; allowed: {paths}", paths = all_paths())]
    Path(String),
    /// The rate is not a number in range.
    #[error("the rate of `{path}` is `{text}`; allowed: 0 to 60 Hz, where 0 turns it off")]
    Hz {
        /// Path of the entity.
        path: &'static str,
        /// The rate as stated.
        text: String,
    },
    /// The entity has no rate.
    #[error("`{path}` is recorded {when}, not at a rate; allowed: 0, which turns it off")]
    NotPeriodic {
        /// Path of the entity.
        path: &'static str,
        /// When it is recorded.
        when: &'static str,
    },
}

fn all_paths() -> String {
    ENTITIES.iter().map(|row| row.path).collect::<Vec<_>>().join(", ")
}

impl FromStr for EntityRate {
    type Err = EntityRateError;

    fn from_str(text: &str) -> Result<Self, EntityRateError> {
        let (path, hz_text) = text.split_once('=').ok_or_else(|| EntityRateError::NoRate(text.to_owned()))?;
        let entity = Entity::named(path).ok_or_else(|| EntityRateError::Path(path.to_owned()))?;
        let path = entity.path();
        let is_allowed = |hz: &f64| (0.0..=HZ_LIMIT).contains(hz);
        let out_of_range = || EntityRateError::Hz { path, text: hz_text.to_owned() };
        let hz = hz_text.parse().ok().filter(is_allowed).ok_or_else(out_of_range)?;
        match entity.row().rate {
            Rate::Once if hz > 0.0 => Err(EntityRateError::NotPeriodic { path, when: "once" }),
            Rate::Event if hz > 0.0 => Err(EntityRateError::NotPeriodic { path, when: "when it happens" }),
            _ => Ok(Self { entity, hz }),
        }
    }
}

/// Decides when each entity is due.
#[derive(Debug)]
pub(super) struct Schedule {
    /// By entity: the least simulated time between records (s), infinite for entities that are off.
    periods_secs: Vec<f64>,
    /// By entity: simulated time of the newest record (s).
    last_secs: Vec<Option<f64>>,
    now_secs: f64,
}

impl Schedule {
    /// The default rates, except for those that are `stated`; of several for one entity the last counts.
    pub(super) fn new(stated: &[EntityRate]) -> Self {
        let mut periods_secs: Vec<_> = ENTITIES.iter().map(|row| default_secs(row.rate)).collect();
        for EntityRate { entity, hz } in stated {
            periods_secs[*entity as usize] = 1.0 / hz;
        }
        Self { periods_secs, last_secs: vec![None; ENTITIES.len()], now_secs: 0.0 }
    }

    /// Sets the simulated time (s) of the frame that follows.
    pub(super) fn begin(&mut self, now_secs: f64) {
        self.now_secs = now_secs;
    }

    /// Whether an entity is recorded at all.
    pub(super) fn is_on(&self, entity: Entity) -> bool {
        self.periods_secs[entity as usize].is_finite()
    }

    /// Whether an entity is due in this frame; it then counts as recorded.
    pub(super) fn take(&mut self, entity: Entity) -> bool {
        let (period_secs, last_secs) = (self.periods_secs[entity as usize], &mut self.last_secs[entity as usize]);
        // Simulated time may also go back, in a replay that begins again.
        let age_secs = last_secs.map_or(f64::INFINITY, |last| (self.now_secs - last).abs());
        let is_due = period_secs.is_finite() && age_secs >= period_secs - TOLERANCE_SECS;
        if is_due {
            *last_secs = Some(self.now_secs);
        }
        is_due
    }
}

fn default_secs(rate: Rate) -> f64 {
    match rate {
        Rate::Once | Rate::Event => 0.0,
        Rate::Hz(hz) => 1.0 / hz,
    }
}

/// Simulated time between frames (s): `usual_secs`, or less where a faster rate is stated.
pub(super) fn frame_secs(usual_secs: f64, stated: &[EntityRate]) -> f64 {
    stated.iter().map(|rate| 1.0 / rate.hz).fold(usual_secs, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rate(text: &str) -> EntityRate {
        text.parse().unwrap()
    }

    #[test]
    fn every_mistake_has_its_own_error() {
        let error = |text: &str| text.parse::<EntityRate>().unwrap_err();
        assert_eq!(error("world/wind"), EntityRateError::NoRate("world/wind".to_owned()));
        assert_eq!(error("world/wnd=2"), EntityRateError::Path("world/wnd".to_owned()));
        assert!(error("world/wnd=2").to_string().contains("world/wind, world/streamlines"));
        for text in ["", "-1", "61", "NaN", "inf", "fast"] {
            assert_eq!(error(&format!("world/wind={text}")), EntityRateError::Hz { path: "world/wind", text: text.to_owned() });
        }
        assert_eq!(error("land/height=1"), EntityRateError::NotPeriodic { path: "land/height", when: "once" });
        assert_eq!(error("decisions=1"), EntityRateError::NotPeriodic { path: "decisions", when: "when it happens" });
    }

    /// Times of the records (ticks of 1/60 s) of an entity that is asked for in every tick.
    fn recorded(schedule: &mut Schedule, entity: Entity, ticks: u32) -> Vec<u32> {
        let is_due = |tick: &u32| {
            schedule.begin(f64::from(*tick) / 60.0);
            schedule.take(entity)
        };
        (0..ticks).filter(is_due).collect()
    }

    #[test]
    fn entities_are_due_at_their_rates() {
        let mut schedule = Schedule::new(&[rate("world/wind=1"), rate("world/wind=20"), rate("map/bend=0"), rate("land/height=0")]);
        assert_eq!(recorded(&mut schedule, Entity::WindArrows, 10), [0, 3, 6, 9]);
        assert_eq!(recorded(&mut schedule, Entity::Trails, 13), [0, 6, 12]);
        assert_eq!(recorded(&mut schedule, Entity::MapBend, 100), [0; 0]);
        assert_eq!(recorded(&mut schedule, Entity::WindVelocity, 601), [0, 300, 600]);
        assert_eq!(recorded(&mut schedule, Entity::Events, 3), [0, 1, 2]);
        assert_eq!([Entity::LandHeight, Entity::LandCover].map(|entity| schedule.is_on(entity)), [false, true]);
    }

    #[test]
    fn a_world_that_begins_again_is_recorded() {
        let mut schedule = Schedule::new(&[]);
        schedule.begin(100.0);
        assert!(schedule.take(Entity::BendAngle));
        schedule.begin(0.0);
        assert!(schedule.take(Entity::BendAngle) && !schedule.take(Entity::BendAngle));
    }

    #[test]
    fn frames_are_as_frequent_as_the_fastest_rate() {
        assert_eq!(frame_secs(0.1, &[]), 0.1);
        assert_eq!(frame_secs(0.1, &[rate("map/bend=0"), rate("world/wind=2")]), 0.1);
        assert_eq!(frame_secs(0.1, &[rate("world/wind=20"), rate("map/bend=2")]), 0.05);
    }
}
