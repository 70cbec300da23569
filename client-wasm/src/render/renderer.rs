//! The renderer: its state between frames, and its settings.

use crate::ladder;
use crate::render::gpu::device::Gpu;
use crate::render::gpu::error::GpuError;
use crate::render::gpu::pipeline::PassFactory;
use crate::render::gpu::pipeline_statistics::StatisticsQueries;
use crate::render::gpu::timestamps::TimestampQueries;
use crate::render::inputs::daylight::Daylight;
use crate::render::inputs::depth_pyramid::DepthPyramid;
use crate::render::inputs::frame_bindings::FrameBindings;
use crate::render::land_and_sky::sky::Sky;
use crate::render::land_and_sky::tone::ToneMapping;
use crate::render::options::detail::Detail;
use crate::render::options::quality::Quality;
use crate::render::options::render_options::RenderOptions;
use crate::render::plants::weighted_oit::WeightedOit;
use crate::render::scene_resources::SceneResources;
use crate::render::stage::{Stage, StageResources};
use crate::render::targets::Targets;
use crate::state::Mirror;

/// Draws a [`Mirror`] as a [`Camera`](crate::camera::Camera) sees it.
pub struct Renderer {
    pub(super) gpu: Gpu,
    pub(super) quality: Quality,
    pub(super) options: RenderOptions,
    pub(super) detail: Detail,
    pub(super) size_px: [u32; 2],
    /// Fraction of the quality's resolution.
    resolution: f32,
    pub(super) bindings: FrameBindings,
    pub(super) daylight: Daylight,
    pub(super) targets: Targets,
    pub(super) tone: ToneMapping,
    pub(super) sky: Sky,
    /// Created when first needed.
    pub(super) depth_pyramid: Option<DepthPyramid>,
    /// Created when first needed.
    pub(super) weighted: Option<WeightedOit>,
    /// Times the passes, if set.
    pub(super) timestamps: Option<TimestampQueries>,
    /// Counts the vertices, primitives and invocations of the passes, if set.
    pub(super) statistics: Option<StatisticsQueries>,
    pub(super) scene: Option<Box<SceneResources>>,
}

impl Renderer {
    /// A renderer for targets of `format` and `size_px` (at least 1 × 1).
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat, size_px: [u32; 2], quality: Quality) -> Self {
        let size_px = size_px.map(|side| side.max(1));
        let daylight = Daylight::new(gpu);
        let bindings = FrameBindings::new(gpu, quality, &daylight);
        let factory = pass_factory(gpu, quality, &bindings, [true, false]);
        let targets = Targets::new(gpu, size_px, quality, 1.0);
        Self {
            tone: ToneMapping::new(&factory, format, &targets.color, targets.scale),
            sky: Sky::new(&factory),
            depth_pyramid: None,
            gpu: gpu.clone(),
            quality,
            options: RenderOptions::default(),
            detail: quality.detail(),
            size_px,
            resolution: 1.0,
            targets,
            bindings,
            daylight,
            weighted: None,
            timestamps: None,
            statistics: None,
            scene: None,
        }
    }

    /// Creates a renderer with the first [stage](Stage) of the mirror's scene: land and sky. The future resolves once the device has reported whether its memory
    /// sufficed. After an error the renderer draws garbage; a [lower](Quality::lower) quality may fit.
    ///
    /// # Errors
    /// The future resolves to [`GpuError::DoesNotFit`].
    pub fn with_land(
        gpu: &Gpu,
        format: wgpu::TextureFormat,
        size_px: [u32; 2],
        quality: Quality,
        mirror: &Mirror,
    ) -> (Self, impl Future<Output = Result<(), GpuError>> + use<>) {
        let scopes = ErrorScopes::open(gpu);
        let mut renderer = Self::new(gpu, format, size_px, quality);
        renderer.begin_scene(mirror);
        (renderer, scopes.close(quality))
    }

    /// Creates the resources of the next stage of the mirror's scene, which [`add`](Self::add) makes visible; `None` if all stages are loaded, or those of
    /// another scene. The future is that of [`with_land`](Self::with_land).
    ///
    /// # Errors
    /// The future resolves to [`GpuError::DoesNotFit`].
    pub fn create_next_stage(&self, mirror: &Mirror) -> Option<(NextStage, impl Future<Output = Result<(), GpuError>> + use<>)> {
        let scopes = ErrorScopes::open(&self.gpu);
        let next = self.next_stage(mirror);
        let verdict = scopes.close(self.quality);
        next.map(|next| (next, verdict))
    }

    /// Shows a stage in the following frames, unless it is that of another scene.
    pub fn add(&mut self, next: NextStage) {
        if let Some(scene) = self.scene.as_mut().filter(|scene| scene.number == next.scene_number) {
            scene.add(next.stage, next.resources);
        }
    }

    /// Newest stage that is loaded, and whether it is the last one of the mirror's scene; `None` without a scene.
    pub fn stage(&self, mirror: &Mirror) -> Option<(Stage, bool)> {
        let (scene, decoded) = (self.scene.as_ref()?, mirror.decoded_scene()?);
        Some((scene.stage, scene.stage.next(decoded).is_none()))
    }

    /// Creates a variant of a pipeline that no frame has needed yet, so that the first frame with lamps or moving objects does not wait for it. Returns false
    /// if there is none.
    pub fn create_next_variant(&self) -> bool {
        self.scene.as_ref().is_some_and(|scene| scene.create_next_variant()) || self.sky.create_next()
    }

    /// Changes the size of the target.
    pub fn resize(&mut self, size_px: [u32; 2]) {
        self.size_px = size_px.map(|side| side.max(1));
        self.create_targets();
    }

    /// Sets the fraction of the quality's resolution, along each side, that the following frames are rendered at, [rounded](ladder::rounded). The target keeps
    /// its size: the picture is enlarged along its edges. With supersampling, a picture that is larger than its target has whole pixels for each of the target's.
    pub fn set_resolution(&mut self, resolution: f32) {
        let resolution = ladder::rounded(resolution);
        if resolution != self.resolution {
            self.resolution = resolution;
            self.create_targets();
        }
    }

    fn create_targets(&mut self) {
        self.targets = Targets::new(&self.gpu, self.size_px, self.quality, self.resolution);
        self.tone.set_picture(&self.targets.color, self.targets.scale);
        if let Some(pyramid) = &mut self.depth_pyramid {
            pyramid.set_depth(&self.gpu, &self.targets.depth);
        }
        self.weighted = None;
    }

    /// Size of the picture before it is enlarged or averaged (px).
    pub fn rendered_px(&self) -> [u32; 2] {
        self.targets.size_px
    }

    /// Size of the target (px).
    pub fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// Sets the options of the following frames.
    pub fn set_options(&mut self, options: RenderOptions) {
        self.options = options;
    }

    /// Current render options.
    pub fn options(&self) -> RenderOptions {
        self.options
    }

    /// Sets the level of detail of plants from 0 (low quality) to 3 (ultra), limited to this renderer's own quality.
    pub fn set_level(&mut self, level: f32) {
        self.detail = Quality::detail_at(level.min(self.quality.level()));
    }

    /// Quality that this renderer was created for.
    pub fn quality(&self) -> Quality {
        self.quality
    }

    /// Loads all stages of the mirror's scene. [`draw`](Self::draw) does so by itself when the scene has changed.
    pub(super) fn load_scene(&mut self, mirror: &Mirror) {
        self.begin_scene(mirror);
        while let Some(next) = self.next_stage(mirror) {
            self.add(next);
        }
    }

    /// Loads the first stage of the mirror's scene.
    fn begin_scene(&mut self, mirror: &Mirror) {
        self.scene = mirror.decoded_scene().map(|decoded| {
            let scene = decoded.scene();
            let factory = pass_factory(&self.gpu, self.quality, &self.bindings, [!scene.species.is_empty(), scene.snow.lies()]);
            Box::new(SceneResources::new(factory, &self.bindings, mirror.scene_number(), decoded))
        });
    }

    fn next_stage(&self, mirror: &Mirror) -> Option<NextStage> {
        let (scene, decoded) = (self.scene.as_ref()?, mirror.decoded_scene()?);
        let stage = scene.stage.next(decoded).filter(|_| scene.number == mirror.scene_number())?;
        let resources = StageResources::new(stage, &scene.factory, self.quality, decoded, &scene.force_field)?;
        Some(NextStage { stage, scene_number: scene.number, resources })
    }
}

fn pass_factory(gpu: &Gpu, quality: Quality, bindings: &FrameBindings, [has_kinds, has_snow]: [bool; 2]) -> PassFactory {
    let (samples, soft_shadows) = (quality.samples(gpu.is_software), !quality.is_cheap(gpu.is_software));
    let (frame_layout, pyramid) = (bindings.layout.clone(), bindings.pyramid.clone());
    PassFactory { gpu: gpu.clone(), frame_layout, pyramid, samples, has_kinds, soft_shadows, has_snow }
}

/// Resources of a stage that no frame shows yet.
pub struct NextStage {
    stage: Stage,
    scene_number: u32,
    resources: StageResources,
}

/// Error scopes around the creation of resources.
struct ErrorScopes {
    memory: wgpu::ErrorScopeGuard,
    validity: wgpu::ErrorScopeGuard,
}

impl ErrorScopes {
    fn open(gpu: &Gpu) -> Self {
        let memory = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        Self { memory, validity: gpu.device.push_error_scope(wgpu::ErrorFilter::Validation) }
    }

    /// The future resolves once the device has reported whether everything created for `quality` is valid and fits into memory.
    fn close(self, quality: Quality) -> impl Future<Output = Result<(), GpuError>> + use<> {
        let found = [self.validity.pop(), self.memory.pop()];
        async move {
            for error in found {
                if let Some(error) = error.await {
                    return Err(GpuError::does_not_fit(quality.name(), &error));
                }
            }
            Ok(())
        }
    }
}
