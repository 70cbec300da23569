//! How the visitor wants the picture: quality, ways of drawing, and two of them side by side.

use crate::budget::{Budget, FrameTime};
use crate::render::{Far, Look, Order, Quality, Split, Way};
use serde::Deserialize;
use shared::scene::Light;

/// Name of the quality that a budget of time steers.
const AUTOMATIC: &str = "auto";

/// What the page says of this device.
#[derive(Clone, Copy, Debug, Deserialize)]
pub(super) struct Automatic {
    /// Finest level that automatic quality goes to.
    #[serde(deserialize_with = "quality_by_name")]
    finest: Quality,
    /// Level that it begins at, 0 = low to 3 = ultra.
    level: f32,
    /// Time that a frame may take (ms).
    budget_ms: f32,
}

fn quality_by_name<'a, D: serde::Deserializer<'a>>(deserializer: D) -> Result<Quality, D::Error> {
    let name = String::deserialize(deserializer)?;
    Quality::from_name(&name).ok_or_else(|| serde::de::Error::custom(format!("quality `{name}`: allowed are {}", names())))
}

fn names() -> String {
    Quality::ALL.map(Quality::name).join(", ")
}

/// All of it.
#[derive(Clone, Debug)]
pub(super) struct Choices {
    automatic: Automatic,
    quality: Quality,
    budget: Option<Budget>,
    look: Look,
    hour: Option<f32>,
    compared: Option<Compared>,
}

/// Two ways, left and right of a border.
#[derive(Clone, Debug, PartialEq)]
struct Compared {
    ways: [String; 2],
    at: f32,
}

impl Choices {
    /// The quality of this name, or `auto`, and the default look.
    pub(super) fn new(quality: &str, automatic: Automatic) -> Result<Self, String> {
        let mut choices = Self { automatic, quality: Quality::default(), budget: None, look: Look::default(), hour: None, compared: None };
        let is_known = choices.set_quality(quality);
        is_known.then_some(choices).ok_or_else(|| format!("quality `{quality}`: allowed are {AUTOMATIC}, {}", names()))
    }

    /// Takes another quality, or `auto`; an unknown name changes nothing and gives false.
    pub(super) fn set_quality(&mut self, name: &str) -> bool {
        let Automatic { finest, level, budget_ms } = self.automatic;
        let (quality, budget) = match Quality::from_name(name) {
            Some(quality) => (quality, None),
            None if name == AUTOMATIC => (finest, Some(Budget::new(budget_ms.max(1.0) / 1e3, level, finest.level()))),
            None => return false,
        };
        (self.quality, self.budget) = (quality, budget);
        true
    }

    /// How finely a renderer has to be able to draw.
    pub(super) fn quality(&self) -> Quality {
        let compared = self.compared.iter().flat_map(|compared| &compared.ways).filter_map(|way| Quality::from_name(way));
        compared.fold(self.quality, |finest, quality| if quality.level() > finest.level() { quality } else { finest })
    }

    /// What steers the level of detail, if anything does.
    pub(super) fn budget(&self) -> Option<&Budget> {
        self.budget.as_ref()
    }

    /// Lets the budget know what a frame took. Where no level keeps it, the next coarser quality has to: fewer samples, fewer pixels.
    pub(super) fn drew(&mut self, frame: FrameTime) {
        let Some(budget) = &mut self.budget else { return };
        budget.drew(frame);
        if let Some(coarser) = self.quality.lower().filter(|_| budget.is_exhausted()) {
            *budget = Budget::new(budget.budget_secs(), 0.0, coarser.level());
            self.quality = coarser;
        }
    }

    /// Level of detail to draw with.
    pub(super) fn level(&self) -> f32 {
        self.budget.as_ref().map_or(self.quality.level(), Budget::level)
    }

    /// Takes other ways of drawing; an unknown name changes nothing.
    pub(super) fn set_look(&mut self, order: &str, far: &str) {
        self.look.order = Order::from_name(order).unwrap_or(self.look.order);
        self.look.far = Far::from_name(far).unwrap_or(self.look.far);
    }

    /// Lets the sun stand as at an hour of the scene's day, 0 to 24; other numbers leave it where the scene has it.
    pub(super) fn set_hour(&mut self, hour: f32) {
        self.hour = Some(hour).filter(|hour| (0.0..=24.0).contains(hour));
    }

    /// The hour that the visitor wants, if any.
    pub(super) fn hour(&self) -> Option<f32> {
        self.hour
    }

    /// The look, in the light of a scene.
    pub(super) fn look(&mut self, light: Option<&Light>) -> Look {
        self.look.sun = self.hour.zip(light).map(|(hour, light)| light.sun_at_hour(hour));
        self.look
    }

    /// Names of how plants are laid over each other, and of what stands for those far away.
    pub(super) fn names(&self) -> [&'static str; 2] {
        [self.look.order.name(), self.look.far.name()]
    }

    /// Shows two ways side by side; unknown names show one picture.
    pub(super) fn compare(&mut self, ways: [String; 2], at: f32) {
        let is_known = at.is_finite() && ways.iter().all(|way| self.way().with(way).is_some());
        self.compared = is_known.then(|| Compared { ways, at: at.clamp(0.0, 1.0) });
    }

    /// Names of the two ways side by side, and where the border is.
    pub(super) fn compared(&self) -> Option<(&[String; 2], f32)> {
        self.compared.as_ref().map(|compared| (&compared.ways, compared.at))
    }

    fn way(&self) -> Way {
        Way { look: self.look, level: self.level() }
    }

    /// The two ways side by side, if two are wanted.
    pub(super) fn split(&self) -> Option<Split> {
        let Compared { ways: [left, right], at } = self.compared.as_ref()?;
        Some(Split { ways: [self.way().with(left)?, self.way().with(right)?], at: *at })
    }
}
