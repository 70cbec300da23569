//! Automatic quality: which preset is loaded, and the height on its [ladder] that keeps the frame time within a budget.

use crate::budget::{FrameBudget, FrameTime};
use crate::ladder::{self, RUNGS_BELOW, Rung};
use crate::render::{DeviceClass, Quality};

/// What automatic quality keeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aim {
    /// Frame time budget (s), greater than 0.
    pub budget_secs: f32,
    /// Highest level of detail that the scene needs, from 0.
    pub highest_level: f32,
}

/// Automatic quality on a device.
#[derive(Clone, Debug)]
pub struct AutomaticQuality {
    quality: Quality,
    highest: Quality,
    highest_level: f32,
    budget: FrameBudget,
}

impl AutomaticQuality {
    /// Keeps frames within the budget. A software renderer begins with the coarsest preset, so that a page that needs it does not load two of them.
    pub fn new(class: DeviceClass, Aim { budget_secs, highest_level }: Aim) -> Self {
        let mut highest = Quality::automatic(class);
        while let Some(lower) = highest.lower().filter(|lower| lower.level() >= highest_level) {
            highest = lower;
        }
        let (quality, height) = match class {
            DeviceClass::Software => (Quality::Low, 0.0),
            DeviceClass::Touch => (highest, RUNGS_BELOW + 1.0),
            DeviceClass::Desktop => (highest, RUNGS_BELOW + 1.5),
        };
        Self { quality, highest, highest_level, budget: controller(budget_secs, height, top_level(quality, highest_level)) }
    }

    /// Preset to be loaded.
    pub fn quality(&self) -> Quality {
        self.quality
    }

    /// Frame time budget (s).
    pub fn budget_secs(&self) -> f32 {
        self.budget.budget_secs()
    }

    /// Reports a drawn frame. If no rung keeps the budget, the next coarser preset takes over, and no finer one comes back; if the highest rung leaves much of it unused, the
    /// next finer one.
    pub fn record(&mut self, frame: FrameTime) {
        self.budget.record(frame);
        if let Some(lower) = self.quality.lower().filter(|_| self.budget.is_exhausted()) {
            self.highest = lower;
            self.load(lower, 0.0);
        } else if let Some(higher) = self.quality.higher().filter(|higher| higher.level() <= self.highest.level() && self.budget.is_ample())
        {
            self.load(higher, RUNGS_BELOW);
        }
    }

    fn load(&mut self, quality: Quality, height: f32) {
        self.budget = controller(self.budget_secs(), height, top_level(quality, self.highest_level));
        self.quality = quality;
    }

    /// Current level of detail and resolution. Detail changes gradually, resolution at once: each of its changes creates new textures.
    pub fn rung(&self) -> Rung {
        let top_level = top_level(self.quality, self.highest_level);
        let [shown, goal] = [self.budget.level(), self.budget.goal()].map(|height| Rung::at(height, top_level));
        Rung { level: shown.level, resolution: goal.resolution }
    }
}

/// Highest level of detail of a preset in a scene that needs no more than `highest_level`.
fn top_level(quality: Quality, highest_level: f32) -> f32 {
    quality.level().min(highest_level)
}

fn controller(budget_secs: f32, height: f32, top_level: f32) -> FrameBudget {
    FrameBudget::new(budget_secs, height, ladder::top(top_level))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn aim(budget_secs: f32) -> Aim {
        Aim { budget_secs, highest_level: Quality::FINEST.level() }
    }

    /// Draws for `secs` on a device that needs `full_secs` for all pixels at level 0, and twice as long per level and at each higher preset than low. Returns
    /// the presets in the order of their use.
    fn presets(automatic: &mut AutomaticQuality, full_secs: f32, secs: f32) -> Vec<Quality> {
        let (mut time_secs, mut used) = (0.0, vec![automatic.quality()]);
        while time_secs < secs {
            let Rung { level, resolution } = automatic.rung();
            let work_secs = full_secs * resolution.powi(2) * (level + automatic.quality().level()).exp2();
            let interval_secs = work_secs.max(1.0 / 60.0);
            automatic.record(FrameTime { work_secs, interval_secs, waited: false });
            time_secs += interval_secs;
            if used.last() != Some(&automatic.quality()) {
                used.push(automatic.quality());
            }
        }
        used
    }

    #[test]
    fn software_begins_low_and_rises_only_where_there_is_time() {
        let both = [Quality::Low, Quality::Medium];
        for (full_secs, wanted) in [(2.0, &both[..1]), (0.09, &both[..1]), (0.02, &both), (0.001, &both)] {
            let mut automatic = AutomaticQuality::new(DeviceClass::Software, aim(0.1));
            assert_eq!(presets(&mut automatic, full_secs, 60.0), wanted, "{full_secs} s");
        }
    }

    #[test]
    fn a_preset_that_was_too_much_does_not_come_back() {
        let mut automatic = AutomaticQuality::new(DeviceClass::Software, aim(0.1));
        assert_eq!(presets(&mut automatic, 0.02, 60.0), [Quality::Low, Quality::Medium]);
        assert_eq!(presets(&mut automatic, 2.0, 60.0), [Quality::Medium, Quality::Low]);
        assert_eq!(presets(&mut automatic, 0.001, 60.0), [Quality::Low]);
    }

    #[test]
    fn a_graphics_card_begins_with_its_finest_preset() {
        let mut automatic = AutomaticQuality::new(DeviceClass::Desktop, aim(1.0 / 60.0));
        assert_eq!(presets(&mut automatic, 0.0005, 10.0), [Quality::FINEST]);
        let used = presets(&mut automatic, 0.02, 60.0);
        assert_eq!(used, [Quality::Ultra, Quality::High, Quality::Medium], "a card that is too slow for ultra and high");
    }

    #[test]
    fn a_scene_that_needs_no_more_gets_no_finer_preset_and_level() {
        for (highest_level, wanted) in [(0.0, Quality::Low), (1.0, Quality::Medium), (1.4, Quality::High), (3.0, Quality::Ultra)] {
            let mut automatic = AutomaticQuality::new(DeviceClass::Desktop, Aim { highest_level, ..aim(1.0 / 60.0) });
            assert_eq!(presets(&mut automatic, 0.0001, 60.0), [wanted]);
            assert_eq!(automatic.rung(), Rung { level: highest_level, resolution: 1.0 });
        }
    }
}
