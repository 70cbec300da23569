//! Render settings chosen by the user: quality, render options, hour of the day, and side-by-side comparison.

use crate::automatic::{Aim, AutomaticQuality};
use crate::budget::FrameTime;
use crate::ladder::Rung;
use crate::render::{BlendOrder, DeviceClass, FarPlants, Quality, RenderOptions, SideOptions, Split};
use prairie_core::scene::{Light, Scene};
use serde::Deserialize;
use std::ops::RangeInclusive;

/// Name of automatic quality, which a frame time budget controls.
pub(super) const AUTOMATIC: &str = "auto";

/// Frame time budget of automatic quality (ms) where neither address nor scene has one: on a GPU, and on a software adapter.
const BUDGET_MS: [f32; 2] = [16.7, 100.0];

/// Allowed frame time budgets (ms).
const ALLOWED_MS: RangeInclusive<f32> = 1.0..=1000.0;

/// What a scene wishes of automatic quality.
#[derive(Clone, Copy, Debug, PartialEq)]
struct SceneWish {
    /// Frame time budget (ms); 0 if there is none.
    client_ms: f32,
    /// Highest level of detail.
    highest_detail: f32,
}

impl Default for SceneWish {
    fn default() -> Self {
        Self { client_ms: 0.0, highest_detail: Quality::FINEST.level() }
    }
}

/// Kind of device, as detected by the page. It determines presets and time budget of automatic quality.
#[derive(Clone, Copy, Debug, Deserialize)]
pub(super) struct Device {
    /// Whether the graphics adapter is a software renderer.
    is_software: bool,
    /// Whether the primary pointer is a finger.
    is_touch: bool,
    /// Frame time budget from the address (ms), 1 to 1000, instead of the usual one.
    budget_ms: Option<f32>,
}

impl Device {
    fn class(self) -> DeviceClass {
        match self {
            Self { is_software: true, .. } => DeviceClass::Software,
            Self { is_touch: true, .. } => DeviceClass::Touch,
            _ => DeviceClass::Desktop,
        }
    }

    /// What automatic quality keeps here in a scene: the budget of the address, or else that of the scene, or else that of the device.
    fn aim(self, wish: SceneWish) -> Aim {
        let of_address = self.budget_ms.filter(|budget_ms| ALLOWED_MS.contains(budget_ms));
        let of_scene = (wish.client_ms > 0.0).then(|| wish.client_ms.clamp(*ALLOWED_MS.start(), *ALLOWED_MS.end()));
        let budget_ms = of_address.or(of_scene).unwrap_or(BUDGET_MS[usize::from(self.is_software)]);
        Aim { budget_secs: budget_ms / 1e3, highest_level: wish.highest_detail }
    }
}

/// All render settings.
#[derive(Clone, Debug)]
pub(super) struct Settings {
    device: Device,
    scene: SceneWish,
    preset: Preset,
    options: RenderOptions,
    hour: Option<f32>,
    comparison: Option<Comparison>,
}

/// A quality, fixed or automatic.
#[derive(Clone, Debug)]
enum Preset {
    Fixed(Quality),
    Automatic(Box<AutomaticQuality>),
}

/// Two variants, left and right of a border.
#[derive(Clone, Debug, PartialEq)]
struct Comparison {
    variants: [String; 2],
    border: f32,
}

impl Settings {
    /// The first quality of `names` that exists, automatic quality if none does, and default render options.
    pub(super) fn new(names: &[Option<String>], device: Device) -> Self {
        let scene = SceneWish::default();
        let named = names.iter().flatten().find_map(|name| Preset::from_name(name, device.class(), device.aim(scene)));
        let preset = named.unwrap_or_else(|| Preset::automatic(device.class(), device.aim(scene)));
        Self { device, scene, preset, options: RenderOptions::default(), hour: None, comparison: None }
    }

    /// Names of all qualities, automatic quality first.
    pub(super) fn qualities() -> impl Iterator<Item = &'static str> {
        [AUTOMATIC].into_iter().chain(Quality::ALL.map(Quality::name))
    }

    /// Sets the quality by name, [`AUTOMATIC`] included. An unknown name changes nothing and returns false.
    pub(super) fn set_quality(&mut self, name: &str) -> bool {
        let Some(preset) = Preset::from_name(name, self.device.class(), self.device.aim(self.scene)) else { return false };
        self.preset = preset;
        true
    }

    /// Lets automatic quality keep what a scene wishes. It begins anew where that differs from the scene before.
    pub(super) fn follow(&mut self, scene: &Scene) {
        let wish = SceneWish { client_ms: scene.budget.client_ms, highest_detail: scene.plants.highest_detail };
        if wish != self.scene {
            self.scene = wish;
            if matches!(self.preset, Preset::Automatic(_)) {
                self.preset = Preset::automatic(self.device.class(), self.device.aim(wish));
            }
        }
    }

    /// Name of the chosen quality, [`AUTOMATIC`] included.
    pub(super) fn quality_name(&self) -> &'static str {
        match &self.preset {
            Preset::Fixed(quality) => quality.name(),
            Preset::Automatic(_) => AUTOMATIC,
        }
    }

    /// Highest quality in use: the chosen one, or a higher one in a comparison. The renderer must support it.
    pub(super) fn quality(&self) -> Quality {
        let compared = self.comparison.iter().flat_map(|comparison| &comparison.variants).filter_map(|name| Quality::from_name(name));
        compared.fold(self.preset.quality(), |highest, quality| if quality.level() > highest.level() { quality } else { highest })
    }

    /// Frame time budget of automatic quality (s); `None` for a fixed quality.
    pub(super) fn budget_secs(&self) -> Option<f32> {
        match &self.preset {
            Preset::Fixed(_) => None,
            Preset::Automatic(automatic) => Some(automatic.budget_secs()),
        }
    }

    /// Highest level of detail: of the scene for automatic quality, which uses no higher one, else of all presets.
    pub(super) fn highest_level(&self) -> f32 {
        match &self.preset {
            Preset::Fixed(_) => Quality::FINEST.level(),
            Preset::Automatic(_) => self.scene.highest_detail,
        }
    }

    /// Reports a drawn frame to automatic quality.
    pub(super) fn record(&mut self, frame: FrameTime) {
        if let Preset::Automatic(automatic) = &mut self.preset {
            automatic.record(frame);
        }
    }

    /// Current level of detail and resolution.
    pub(super) fn rung(&self) -> Rung {
        match &self.preset {
            Preset::Fixed(quality) => Rung { level: quality.level(), resolution: 1.0 },
            Preset::Automatic(automatic) => automatic.rung(),
        }
    }

    /// Sets render options by name; an unknown name changes nothing.
    pub(super) fn set_options(&mut self, order: &str, far: &str) {
        self.options.blend_order = BlendOrder::from_name(order).unwrap_or(self.options.blend_order);
        self.options.far_plants = FarPlants::from_name(far).unwrap_or(self.options.far_plants);
    }

    /// Raises the wind on far clumps with distance, or shows it as it is.
    pub(super) fn raise_far_wind(&mut self, raises: bool) {
        self.options.raises_far_wind = raises;
    }

    /// Shows or hides the map of the grass grids.
    pub(super) fn show_grids(&mut self, shows: bool) {
        self.options.shows_grids = shows;
    }

    /// Lets grass cast shadows or not.
    pub(super) fn cast_grass_shadows(&mut self, casts: bool) {
        self.options.grass_shadows = casts;
    }

    /// Whether grass casts shadows.
    pub(super) fn grass_shadows(&self) -> bool {
        self.options.grass_shadows
    }

    /// Whether the wind on far clumps is raised with distance, and whether the map of the grass grids is shown.
    pub(super) fn switches(&self) -> [bool; 2] {
        [self.options.raises_far_wind, self.options.shows_grids]
    }

    /// Sets the hour of the day, 0 to 24, that determines the sun; any other number restores the scene's own hour.
    pub(super) fn set_hour(&mut self, hour: f32) {
        self.hour = Some(hour).filter(|hour| (0.0..=24.0).contains(hour));
    }

    /// Hour chosen by the user; `None` for the scene's own.
    pub(super) fn hour(&self) -> Option<f32> {
        self.hour
    }

    /// Render options, with the sun of the chosen hour in a scene with this light.
    pub(super) fn options(&mut self, light: Option<&Light>) -> RenderOptions {
        self.options.sun = self.hour.zip(light).map(|(hour, light)| light.sun_at_hour(hour));
        self.options
    }

    /// Names of the current transparency order and of the current representation of far plants.
    pub(super) fn option_names(&self) -> [&'static str; 2] {
        [self.options.blend_order.name(), self.options.far_plants.name()]
    }

    /// Compares two variants side by side; an unknown name ends the comparison.
    pub(super) fn compare(&mut self, variants: [String; 2], border: f32) {
        let is_known = border.is_finite() && variants.iter().all(|name| self.current().with(name).is_some());
        self.comparison = is_known.then(|| Comparison { variants, border: border.clamp(0.0, 1.0) });
    }

    /// Names of the compared variants, and the position of the border as a fraction of the width.
    pub(super) fn compared(&self) -> Option<(&[String; 2], f32)> {
        self.comparison.as_ref().map(|comparison| (&comparison.variants, comparison.border))
    }

    fn current(&self) -> SideOptions {
        SideOptions { options: self.options, level: self.rung().level }
    }

    /// The two variants to draw side by side, if a comparison is on.
    pub(super) fn split(&self) -> Option<Split> {
        let Comparison { variants: [left, right], border } = self.comparison.as_ref()?;
        Some(Split { sides: [self.current().with(left)?, self.current().with(right)?], border: *border })
    }
}

impl Preset {
    /// The quality of this name, [`AUTOMATIC`] included.
    fn from_name(name: &str, class: DeviceClass, aim: Aim) -> Option<Self> {
        let automatic = || (name == AUTOMATIC).then(|| Self::automatic(class, aim));
        Quality::from_name(name).map(Self::Fixed).or_else(automatic)
    }

    fn automatic(class: DeviceClass, aim: Aim) -> Self {
        Self::Automatic(Box::new(AutomaticQuality::new(class, aim)))
    }

    fn quality(&self) -> Quality {
        match self {
            Self::Fixed(quality) => *quality,
            Self::Automatic(automatic) => automatic.quality(),
        }
    }
}
