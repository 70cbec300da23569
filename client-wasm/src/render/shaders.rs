//! The WGSL texts, one a pass, each after the shared pieces of `common.wgsl`.

/// Shared bindings, the frame's uniform block, and what several passes compute.
const COMMON: &str = include_str!("../../shaders/common.wgsl");

/// Compute passes that list single plants and bend them.
pub(super) const BEND: &str = concat!(
    include_str!("../../shaders/blade.wgsl"),
    include_str!("../../shaders/backbone.wgsl"),
    include_str!("../../shaders/sward.wgsl"),
    include_str!("../../shaders/bend.wgsl"),
    include_str!("../../shaders/sift.wgsl")
);
/// Compute pass that lists grass grids.
pub(super) const GRIDS: &str = include_str!("../../shaders/grids.wgsl");
/// How a single blade moves.
#[cfg(test)]
pub(super) const BLADE: &str = include_str!("../../shaders/blade.wgsl");
/// The curve of a blade and the outline about it.
#[cfg(test)]
pub(super) const BACKBONE: &str = include_str!("../../shaders/backbone.wgsl");
/// Blades as strips.
pub(super) const BLADES: &str = concat!(
    include_str!("../../shaders/backbone.wgsl"),
    include_str!("../../shaders/sward.wgsl"),
    include_str!("../../shaders/weighted.wgsl"),
    include_str!("../../shaders/strip_list.wgsl"),
    include_str!("../../shaders/blades.wgsl")
);
/// Rain.
pub(super) const RAIN: &str = include_str!("../../shaders/rain.wgsl");
/// Underbrush.
pub(super) const UNDERBRUSH: &str = concat!(
    include_str!("../../shaders/blade.wgsl"),
    include_str!("../../shaders/sward.wgsl"),
    include_str!("../../shaders/underbrush.wgsl"),
    include_str!("../../shaders/ribbons.wgsl")
);
/// Flower heads.
pub(super) const FLOWERS: &str = concat!(include_str!("../../shaders/strip_list.wgsl"), include_str!("../../shaders/flowers.wgsl"));
/// Clumps of far plants.
pub(super) const BILLBOARDS: &str = concat!(
    include_str!("../../shaders/sward.wgsl"),
    include_str!("../../shaders/nearness.wgsl"),
    include_str!("../../shaders/weighted.wgsl"),
    include_str!("../../shaders/billboards.wgsl")
);
/// Motes and puffs of dust.
pub(super) const DUST: &str = include_str!("../../shaders/dust.wgsl");
/// The listed blades far to near.
pub(super) const ORDER: &str = concat!(include_str!("../../shaders/nearness.wgsl"), include_str!("../../shaders/order.wgsl"));
/// What was blended without order, laid over the picture.
pub(super) const COMPOSE: &str = include_str!("../../shaders/compose.wgsl");
/// Sort of pairs by their keys.
pub(super) const SORT: &str = include_str!("../../shaders/sort.wgsl");
/// Shells.
pub(super) const SHELLS: &str = include_str!("../../shaders/shells.wgsl");
/// Ground.
pub(super) const TERRAIN: &str = concat!(include_str!("../../shaders/sward.wgsl"), include_str!("../../shaders/terrain.wgsl"));
/// Objects, trees and stones.
pub(super) const OBJECTS: &str = include_str!("../../shaders/objects.wgsl");
/// Sky.
pub(super) const SKY: &str = include_str!("../../shaders/sky.wgsl");
/// Tone mapping.
pub(super) const TONE: &str = include_str!("../../shaders/tone.wgsl");

/// Light, after the shared bindings.
const LIGHT: &str = include_str!("../../shaders/light.wgsl");

/// Value of an `override` of a module.
pub(super) type Constant = (&'static str, bool);

/// A module whose overrides have these values from the start. Browsers differ in whether a pipeline may be given the value of an override that its entry points
/// do not read.
pub(super) fn with_constants(text: String, constants: &[Constant]) -> String {
    constants.iter().fold(text, |text, (name, value)| {
        let declared = [true, false].map(|usual| format!("override {name}: bool = {usual};"));
        let found = declared.iter().find(|declared| text.contains(*declared)).unwrap_or_else(|| panic!("{name} is an override"));
        text.replace(found, &format!("const {name}: bool = {value};"))
    })
}

/// A pass's whole module.
pub(super) fn whole(source: &str) -> String {
    format!("{COMMON}\n{LIGHT}\n{source}")
}
