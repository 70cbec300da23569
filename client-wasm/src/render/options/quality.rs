//! Quality presets.

use crate::render::options::detail::Detail;

/// Quality preset. The table `PRESETS` lists the settings of each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// Few wide blades, one sample per pixel: for software rendering.
    Low,
    /// More blades, drawn farther; four samples per pixel, one in software.
    #[default]
    Medium,
    /// Every blade near the camera.
    High,
    /// The same farther away, with 2 × 2 supersampling.
    Ultra,
    /// Reference for comparisons: every plant in full detail up to [`REFERENCE_REACH_M`], at any cost.
    Reference,
}

/// Maximum distance at which [`Quality::Reference`] draws every plant (m).
pub const REFERENCE_REACH_M: f32 = 100.0;

/// Class of a device by its graphics performance, slowest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeviceClass {
    /// A software renderer.
    Software,
    /// A device with a touch screen, such as a phone.
    Touch,
    /// Any other device.
    Desktop,
}

/// All settings of a quality.
struct Preset {
    quality: Quality,
    /// Name in addresses, on the page and on the command line.
    name: &'static str,
    /// Slowest class of device on which automatic quality may use it.
    automatic_from: DeviceClass,
    detail: Detail,
    /// Segments of a fine and of a coarse blade, one less than the backbone points of Zhang, section 3.1.1. With n segments that share a turn θ evenly, a
    /// blade of length L departs from its backbone by θ·L/(8n²); for θ = 1: 0.26 % of L with 7 segments, 1.4 % with 3, 0.13 % with 10.
    segments: [u32; 2],
    /// Minimum width of a drawn blade (px), so that none vanishes between samples.
    min_blade_px: f32,
    /// Samples per pixel on a graphics card and in software, where four samples take four times as long.
    samples: [u32; 2],
    /// Rendered pixels along each side of an output pixel.
    supersampling: u32,
    /// Largest ratio of canvas pixels to CSS pixels.
    max_device_pixel_ratio: f64,
    /// Whether software lights coarse trees per vertex, since most fragments of their leaf sprays are hidden or cut away, and samples shadows once.
    is_cheap_in_software: bool,
    /// Side of the shadow map (px).
    shadow_px: u32,
    /// Streaks of heavy rain.
    drops: u32,
    /// Dust motes around the camera.
    motes: u32,
    /// Puffs of dust, and the side of the square around the camera over which they spread where the wind domain is smaller (m).
    puffs: (u32, f32),
    /// Buffer for the underbrush in view, and again for its rows (bytes): four times what the shipped scenes fill at 960 × 540. Where rows do not fit, plants
    /// are drawn more coarsely and finally left out.
    underbrush_bytes: u64,
    /// Whether near underbrush is drawn as curves with veins.
    has_close_ups: bool,
    /// Radius of the bend field that the client requests (m).
    bend_radius_m: f32,
}

/// One row per quality, coarsest first, in the order of the enum.
const PRESETS: [Preset; 5] = [
    Preset {
        quality: Quality::Low,
        name: "low",
        automatic_from: DeviceClass::Software,
        detail: Detail {
            full_m: 2.0,
            fine_m: 2.0,
            heads_m: 20.0,
            blades_m: 55.0,
            far_m: 60.0,
            underbrush_m: 45.0,
            trees_m: 400.0,
            coarser: 2.0,
        },
        segments: [7, 3],
        min_blade_px: 0.9,
        samples: [1, 1],
        supersampling: 1,
        max_device_pixel_ratio: 1.0,
        is_cheap_in_software: true,
        shadow_px: 512,
        drops: 4000,
        motes: 3000,
        puffs: (1024, 130.0),
        underbrush_bytes: 16 << 20,
        has_close_ups: false,
        bend_radius_m: 96.0,
    },
    Preset {
        quality: Quality::Medium,
        name: "medium",
        automatic_from: DeviceClass::Software,
        detail: Detail {
            full_m: 3.4,
            fine_m: 3.0,
            heads_m: 30.0,
            blades_m: 90.0,
            far_m: 100.0,
            underbrush_m: 85.0,
            trees_m: 800.0,
            coarser: 1.6,
        },
        segments: [7, 3],
        min_blade_px: 0.9,
        samples: [4, 1],
        supersampling: 1,
        max_device_pixel_ratio: 1.25,
        is_cheap_in_software: true,
        shadow_px: 1024,
        drops: 9000,
        motes: 6000,
        puffs: (3072, 200.0),
        underbrush_bytes: 32 << 20,
        has_close_ups: false,
        bend_radius_m: 128.0,
    },
    Preset {
        quality: Quality::High,
        name: "high",
        automatic_from: DeviceClass::Touch,
        detail: Detail {
            full_m: 7.3,
            fine_m: 5.0,
            heads_m: 40.0,
            blades_m: 130.0,
            far_m: 150.0,
            underbrush_m: 180.0,
            trees_m: 2000.0,
            coarser: 1.0,
        },
        segments: [7, 3],
        min_blade_px: 0.9,
        samples: [4, 4],
        supersampling: 1,
        max_device_pixel_ratio: 2.0,
        is_cheap_in_software: false,
        shadow_px: 2048,
        drops: 18_000,
        motes: 14_000,
        puffs: (4096, 220.0),
        underbrush_bytes: 64 << 20,
        has_close_ups: true,
        bend_radius_m: 192.0,
    },
    ULTRA,
    Preset {
        quality: Quality::Reference,
        name: "reference",
        detail: Detail {
            full_m: REFERENCE_REACH_M,
            fine_m: REFERENCE_REACH_M,
            heads_m: REFERENCE_REACH_M,
            blades_m: REFERENCE_REACH_M,
            far_m: REFERENCE_REACH_M,
            underbrush_m: REFERENCE_REACH_M,
            ..ULTRA.detail
        },
        min_blade_px: 0.0,
        supersampling: 1,
        ..ULTRA
    },
];

const ULTRA: Preset = Preset {
    quality: Quality::Ultra,
    name: "ultra",
    automatic_from: DeviceClass::Desktop,
    detail: Detail {
        full_m: 11.0,
        fine_m: 8.0,
        heads_m: 60.0,
        blades_m: 180.0,
        far_m: 220.0,
        underbrush_m: 260.0,
        trees_m: 2000.0,
        coarser: 0.7,
    },
    segments: [10, 4],
    min_blade_px: 0.9,
    samples: [4, 4],
    supersampling: 2,
    max_device_pixel_ratio: 3.0,
    is_cheap_in_software: false,
    shadow_px: 2048,
    drops: 30_000,
    motes: 28_000,
    puffs: (8192, 280.0),
    underbrush_bytes: 128 << 20,
    has_close_ups: true,
    bend_radius_m: 256.0,
};

/// Number of presets for users: all except the last, the reference.
const OFFERED: usize = PRESETS.len() - 1;

const _: () = {
    let mut at = 0;
    while at < PRESETS.len() {
        assert!(PRESETS[at].quality as usize == at, "presets are in the order of the enum");
        at += 1;
    }
    assert!(Quality::Reference as usize == OFFERED, "the reference is the last preset");
};

impl Quality {
    /// All presets that a user may choose, coarsest first.
    pub const ALL: [Self; OFFERED] = {
        let mut all = [Self::Low; OFFERED];
        let mut at = 0;
        while at < OFFERED {
            all[at] = PRESETS[at].quality;
            at += 1;
        }
        all
    };

    /// The finest preset that a user may choose.
    pub const FINEST: Self = Self::ALL[OFFERED - 1];

    /// The finest preset that automatic quality may use on a class of device.
    pub fn automatic(class: DeviceClass) -> Self {
        let usable = |quality: &Self| quality.preset().automatic_from as u8 <= class as u8;
        Self::ALL.into_iter().rev().find(usable).unwrap_or_default()
    }

    const fn preset(self) -> &'static Preset {
        &PRESETS[self as usize]
    }

    /// Name in addresses, on the page and on the command line.
    pub fn name(self) -> &'static str {
        self.preset().name
    }

    /// The preset of this name, if it is one for users.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|quality| quality.name() == name)
    }

    /// The next coarser preset, if any.
    pub fn lower(self) -> Option<Self> {
        (self as usize).checked_sub(1).map(|below| Self::ALL[below])
    }

    /// The next finer preset that a user may choose, if any.
    pub fn higher(self) -> Option<Self> {
        Self::ALL.get(self as usize + 1).copied()
    }

    /// Level of detail of plants: 0 for the coarsest preset, 1 more for each finer one that a user may choose.
    pub fn level(self) -> f32 {
        (self as usize).min(OFFERED - 1) as f32
    }

    /// Greatest detail of plants that this preset reserves memory for.
    pub(crate) fn detail(self) -> Detail {
        self.preset().detail
    }

    /// Detail at a fractional [level](Self::level), interpolated geometrically between presets.
    pub(crate) fn detail_at(level: f32) -> Detail {
        let level = level.clamp(0.0, (OFFERED - 1) as f32);
        let below = (level as usize).min(OFFERED - 2);
        PRESETS[below].detail.interpolated(PRESETS[below + 1].detail, level - below as f32)
    }

    /// Segments of a fine and of a coarse blade.
    pub(crate) fn segments(self) -> [u32; 2] {
        self.preset().segments
    }

    /// Minimum width of a drawn blade (px).
    pub(crate) fn min_blade_px(self) -> f32 {
        self.preset().min_blade_px
    }

    /// Samples per pixel.
    pub(crate) fn samples(self, is_software: bool) -> u32 {
        self.preset().samples[usize::from(is_software)]
    }

    /// Supersampling factor: rendered pixels along each side of an output pixel. Reduced to 1 if the rendered picture would exceed `limit_px` along a
    /// side, or 10 million pixels in all (0.5 GB).
    pub fn supersampling(self, size_px: [u32; 2], limit_px: u32) -> u32 {
        const MAX_RENDERED_PX: u64 = 10_000_000;
        let factor = self.preset().supersampling;
        let rendered_px = size_px.map(|side_px| u64::from(factor) * u64::from(side_px));
        let is_within_sides = rendered_px.iter().all(|&side_px| side_px <= u64::from(limit_px));
        if is_within_sides && rendered_px[0] * rendered_px[1] <= MAX_RENDERED_PX { factor } else { 1 }
    }

    /// Largest ratio of canvas pixels to CSS pixels.
    pub fn max_device_pixel_ratio(self) -> f64 {
        self.preset().max_device_pixel_ratio
    }

    /// Whether coarse trees are lit per vertex and shadows sampled once.
    pub(crate) fn is_cheap(self, is_software: bool) -> bool {
        is_software && self.preset().is_cheap_in_software
    }

    /// Side of the shadow map (px).
    pub(crate) fn shadow_px(self) -> u32 {
        self.preset().shadow_px
    }

    /// Streaks of heavy rain.
    pub(crate) fn drops(self) -> u32 {
        self.preset().drops
    }

    /// Dust motes around the camera.
    pub(crate) fn motes(self) -> u32 {
        self.preset().motes
    }

    /// Puffs of dust, and the side of the square around the camera over which they spread where the wind domain is smaller (m).
    pub(crate) fn puffs(self) -> (u32, f32) {
        self.preset().puffs
    }

    /// Buffer for the underbrush in view, and again for its rows (bytes).
    pub(crate) fn underbrush_bytes(self) -> u64 {
        self.preset().underbrush_bytes
    }

    /// Whether near underbrush is drawn as curves with veins.
    pub(crate) fn has_close_ups(self) -> bool {
        self.preset().has_close_ups
    }

    /// Radius of the bend field that the client requests (m).
    pub fn bend_radius_m(self) -> f32 {
        self.preset().bend_radius_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ultra_supersamples_up_to_the_pixel_limits() {
        assert_eq!(Quality::Ultra.supersampling([1920, 1080], 8192), 2);
        assert_eq!(Quality::Ultra.supersampling([3840, 2160], 8192), 1);
        assert_eq!(Quality::Ultra.supersampling([1920, 1080], 2048), 1);
        assert_eq!(Quality::Ultra.supersampling([u32::MAX; 2], u32::MAX), 1);
        assert_eq!(Quality::High.supersampling([640, 360], 8192), 1);
    }

    #[test]
    fn presets_have_distinct_names_and_ascending_levels() {
        let names = PRESETS.map(|preset| preset.name);
        assert!((0..names.len()).all(|at| !names[..at].contains(&names[at])), "{names:?}");
        for (level, quality) in Quality::ALL.into_iter().enumerate() {
            assert_eq!((quality.level(), Quality::from_name(quality.name())), (level as f32, Some(quality)));
            assert_eq!(quality.lower(), level.checked_sub(1).map(|below| Quality::ALL[below]));
        }
        assert_eq!(Quality::Reference.lower(), Some(Quality::Ultra));
        assert_eq!(Quality::from_name("reference"), None);
    }

    #[test]
    fn documentation_lists_every_preset() {
        let readme = include_str!("../../../README.md");
        let columns = Quality::ALL.map(|quality| format!(" {} |", quality.name())).concat();
        assert!(readme.contains(&format!("\n| |{columns}\n")), "client-wasm/README.md has no table of presets with the columns{columns}");
        let values = Quality::ALL.map(|quality| format!(", `{}`", quality.name())).concat();
        assert!(
            readme.contains(&format!("`?quality=auto`{values}")),
            "client-wasm/README.md does not list the values of ?quality=: `auto`{values}"
        );
        let [software, touch] = [DeviceClass::Software, DeviceClass::Touch].map(|class| Quality::automatic(class).name());
        let most = format!("draw `{software}` at most, touch devices `{touch}`");
        assert!(readme.contains(&most), "client-wasm/README.md does not say of automatic quality that software adapters {most}");
    }

    #[test]
    fn automatic_quality_may_use_any_preset_on_a_desktop() {
        assert_eq!(Quality::automatic(DeviceClass::Desktop), Quality::FINEST);
        let levels = [DeviceClass::Software, DeviceClass::Touch, DeviceClass::Desktop].map(|class| Quality::automatic(class).level());
        assert!(levels.is_sorted(), "{levels:?}");
    }

    #[test]
    fn detail_matches_the_presets_and_grows_between_them() {
        for quality in Quality::ALL {
            assert_eq!(Quality::detail_at(quality.level()), quality.detail());
        }
        assert_eq!(Quality::detail_at(-1.0), Quality::Low.detail());
        assert_eq!(Quality::detail_at(9.0), Quality::Ultra.detail());
        let reaches: Vec<f32> = (0..=30).map(|tenth| Quality::detail_at(tenth as f32 * 0.1).blades_m).collect();
        assert!(reaches.windows(2).all(|pair| pair[0] < pair[1]), "{reaches:?}");
    }
}
