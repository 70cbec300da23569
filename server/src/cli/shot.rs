//! Arguments that `prairie picture` and `prairie film` share: scene, act, camera, size and render options.

use anyhow::{Context as _, Result};
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use prairie::studio::{Act, Stage, chase};
use prairie_client::camera::Camera;
use prairie_client::ladder::LEAST_RESOLUTION;
use prairie_client::render::{BlendOrder, FarPlants, FrameStats, Gpu, OffscreenRenderer, Quality, RenderOptions, SideOptions, Split, Sun};
use prairie_core::wire::ObjectPose;

/// Largest width and height (px).
const SIDE_LIMIT_PX: u32 = 8192;

/// Scene, act, camera, size and render options of a picture or film.
#[derive(Debug, Args)]
pub(super) struct Shot {
    /// Built-in scene, or a scene file
    #[arg(long, value_name = "NAME|FILE", default_value = "meadow")]
    scene: String,
    /// Events in front of the camera
    #[arg(long, value_enum, default_value = "wind")]
    act: Act,
    /// Camera as in the page's address, x,y,z,heading,pitch in metres and degrees [default: the scene's starting view]
    #[arg(long, value_name = "VIEW", value_parser = camera, allow_hyphen_values = true)]
    camera: Option<Camera>,
    /// Look at the act's vehicle from AWAY metres behind it, ABOVE metres above and ASIDE metres to its right
    #[arg(long, value_name = "AWAY,ABOVE,ASIDE", value_parser = offset, allow_hyphen_values = true)]
    chase: Option<Offset>,
    /// Width and height (px), 1 to 8192 each
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1280x720", value_parser = size)]
    size: Size,
    /// Quality preset
    #[arg(long, default_value = "high", value_parser = quality())]
    quality: Quality,
    /// Part of the quality's resolution along each side, 0.5 to 1, in steps of 1/32: the picture is enlarged along its edges
    #[arg(long, value_name = "PART", default_value = "1", value_parser = resolution)]
    resolution: f32,
    /// Transparency of plants: alpha test, alpha to coverage, sorted, precomputed order, or weighted blended
    #[arg(long, default_value = "cut", value_parser = order())]
    order: BlendOrder,
    /// Representation of distant plants
    #[arg(long, default_value = "land", value_parser = far())]
    far: FarPlants,
    /// Let far clumps move the more the farther they are, so that they still move visibly
    #[arg(long)]
    raise_far_wind: bool,
    /// Draw a map of the grass grids over the picture: which are culled, and the level of detail of the others
    #[arg(long)]
    grids: bool,
    /// Shade grass by the height above the ground alone, instead of letting it cast shadows on grass and ground
    #[arg(long)]
    no_grass_shadows: bool,
    /// Draw two render options side by side: two qualities, transparencies or representations of distant plants, such as low,high or cut,sorted
    #[arg(long, value_name = "LEFT,RIGHT")]
    compare: Option<String>,
    /// Hour of the day that places the sun, 0 to 24 [default: the scene's]
    #[arg(long, value_parser = hour)]
    hour: Option<f32>,
    /// Place the sun: heading from north towards east, and elevation, -90 to 90 (degrees)
    #[arg(long, value_name = "HEADING,ELEVATION", value_parser = sun, allow_hyphen_values = true, conflicts_with = "hour")]
    sun: Option<Sun>,
}

/// Width and height (px).
#[derive(Clone, Copy, Debug)]
pub(super) struct Size(pub(super) [u32; 2]);

/// Distance behind, above and to the right of a vehicle (m).
#[derive(Clone, Copy, Debug)]
struct Offset([f32; 3]);

/// A stage with its camera and renderer, ready to draw.
pub(super) struct Studio {
    pub(super) stage: Stage,
    pub(super) gpu: Gpu,
    pub(super) renderer: OffscreenRenderer,
    camera: Camera,
    chase: Option<Offset>,
    split: Option<Split>,
}

impl Shot {
    /// Width and height (px).
    pub(super) fn size_px(&self) -> [u32; 2] {
        self.size.0
    }

    /// The act.
    pub(super) fn act(&self) -> Act {
        self.act
    }

    /// Loads the scene and finds a graphics adapter. The act has not begun.
    ///
    /// # Errors
    /// When options contradict each other, the scene is invalid, or there is no Vulkan driver.
    pub(super) fn open(&self) -> Result<Studio> {
        self.open_with(|| Stage::load(&self.scene))
    }

    /// [`open`](Self::open), with another stage than that of the scene.
    ///
    /// # Errors
    /// When options contradict each other, there is no stage, or no Vulkan driver.
    pub(super) fn open_with(&self, stage: impl FnOnce() -> Result<Stage>) -> Result<Studio> {
        anyhow::ensure!(
            self.chase.is_none() || self.act.vehicle().is_some(),
            "--chase: the act `wind` has no vehicle; allowed with the other values of --act"
        );
        let side = SideOptions {
            options: RenderOptions {
                blend_order: self.order,
                far_plants: self.far,
                raises_far_wind: self.raise_far_wind,
                shows_grids: self.grids,
                grass_shadows: !self.no_grass_shadows,
                ..RenderOptions::default()
            },
            level: 0.0,
        };
        let side = SideOptions { level: self.quality.level(), ..side };
        let mut split = self.compare.as_deref().map(|names| compared(side, names)).transpose()?;
        let gpu = Gpu::headless().context(
            "drawing without a browser needs a Vulkan driver; without a graphics card install a software one, such as Debian's mesa-vulkan-drivers",
        )?;
        let stage = stage()?;
        let sun = self.sun.or(self.hour.map(|hour| stage.scene().light.sun_at_hour(hour)));
        let options = RenderOptions { sun, ..side.options };
        for side in split.iter_mut().flat_map(|split| &mut split.sides) {
            side.options.sun = sun;
        }
        let camera =
            self.camera.unwrap_or_else(|| Camera::start(&stage.scene().camera, stage.scene().extent_m(), |x, z| stage.ground_m(x, z)));
        let mut renderer =
            OffscreenRenderer::new(&gpu, self.size.0, split.as_ref().map_or(self.quality, |split| finest(self.quality, split)));
        renderer.set_options(options);
        renderer.set_resolution(self.resolution);
        Ok(Studio { stage, gpu, renderer, camera, chase: self.chase, split })
    }
}

impl Studio {
    /// The camera.
    pub(super) fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Moves a chase camera behind the act's vehicle.
    pub(super) fn follow(&mut self, pose: Option<&ObjectPose>) {
        if let (Some(Offset(offset_m)), Some(pose)) = (self.chase, pose) {
            self.camera = chase(pose, offset_m, |x, z| self.stage.ground_m(x, z));
        }
    }

    /// Draws a frame of the stage as it is shown, `dt_secs` after the previous one.
    pub(super) fn draw(&mut self, dt_secs: f32) -> FrameStats {
        let time_secs = self.stage.mirror.time_secs();
        let Self { stage, renderer, camera, split, .. } = self;
        match split {
            Some(split) => renderer.draw_split(&mut stage.mirror, camera, time_secs, dt_secs, split),
            None => renderer.draw(&mut stage.mirror, camera, time_secs, dt_secs),
        }
    }
}

/// Two render options side by side; each name changes one property of `own`.
fn compared(own: SideOptions, names: &str) -> Result<Split> {
    let allowed =
        || format!("--compare: `{names}`; allowed: two of {}, separated by a comma", SideOptions::names().collect::<Vec<_>>().join(", "));
    let (left, right) = names.split_once(',').with_context(allowed)?;
    let side = |name: &str| own.with(name.trim()).with_context(allowed);
    Ok(Split { sides: [side(left)?, side(right)?], border: 0.5 })
}

/// The lowest quality that can draw both sides.
fn finest(own: Quality, split: &Split) -> Quality {
    let level = split.sides.iter().fold(own.level(), |level, side| level.max(side.level));
    Quality::ALL.into_iter().find(|quality| quality.level() >= level).unwrap_or(own)
}

fn quality() -> impl TypedValueParser<Value = Quality> {
    named(Quality::ALL.map(Quality::name), Quality::from_name)
}

fn order() -> impl TypedValueParser<Value = BlendOrder> {
    named(BlendOrder::ALL.map(BlendOrder::name), BlendOrder::from_name)
}

fn far() -> impl TypedValueParser<Value = FarPlants> {
    named(FarPlants::ALL.map(FarPlants::name), FarPlants::from_name)
}

/// Parser of one of `names`.
fn named<T: Clone + Send + Sync + 'static, const N: usize>(
    names: [&'static str; N],
    from_name: fn(&str) -> Option<T>,
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(names).try_map(move |name| from_name(&name).ok_or("unknown name"))
}

fn camera(text: &str) -> Result<Camera, &'static str> {
    Camera::from_hash(text).ok_or("allowed: five numbers, x,y,z,heading,pitch, in metres and degrees, pitch from -90 to 90")
}

fn numbers<const N: usize>(text: &str) -> Option<[f32; N]> {
    let parsed: Vec<f32> = text.split(',').map(|number| number.trim().parse().ok()).collect::<Option<_>>()?;
    <[f32; N]>::try_from(parsed).ok().filter(|numbers| numbers.iter().all(|number| number.is_finite()))
}

fn offset(text: &str) -> Result<Offset, &'static str> {
    let allowed = |metres: &[f32; 3]| metres.iter().all(|metres| metres.abs() <= 1e4) && metres.iter().any(|metres| *metres != 0.0);
    numbers(text).filter(allowed).map(Offset).ok_or("allowed: three numbers, AWAY,ABOVE,ASIDE, in metres within ±10000, not all 0")
}

fn size(text: &str) -> Result<Size, String> {
    let parsed = text.split_once('x').and_then(|(width, height)| Some([width.parse().ok()?, height.parse().ok()?]));
    let allowed = 1..=SIDE_LIMIT_PX;
    parsed
        .filter(|sides: &[u32; 2]| sides.iter().all(|side| allowed.contains(side)))
        .map(Size)
        .ok_or_else(|| format!("allowed: WIDTHxHEIGHT, each 1 to {SIDE_LIMIT_PX}, such as 1280x720"))
}

fn resolution(text: &str) -> Result<f32, String> {
    let allowed = LEAST_RESOLUTION..=1.0;
    text.parse().ok().filter(|part| allowed.contains(part)).ok_or_else(|| format!("allowed: {LEAST_RESOLUTION} to 1"))
}

fn hour(text: &str) -> Result<f32, &'static str> {
    text.parse().ok().filter(|hour| (0.0..=24.0).contains(hour)).ok_or("allowed: 0 to 24")
}

fn sun(text: &str) -> Result<Sun, &'static str> {
    let [heading, elevation] = numbers(text)
        .filter(|[_, elevation]| elevation.abs() <= 90.0)
        .ok_or("allowed: HEADING,ELEVATION in degrees, elevation from -90 to 90")?;
    Ok(Sun { heading_rad: heading.to_radians(), elevation_rad: elevation.to_radians() })
}
