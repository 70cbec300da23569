//! The picture: one pass a file, over one uniform block and one set of textures.
//!
//! A frame: compute passes bend the single plants and list those in view; the sun's shadow map; then objects, blades, flowers,
//! billboards, ground and sky, near to far, and dust over them, into a picture of linear light; tone mapping brings it to the target.

mod atlas;
mod billboards;
mod blades;
mod clump_order;
mod cull;
mod detail;
mod dots;
mod dust;
mod fit;
mod flora;
mod forces;
mod gpu;
mod grove;
mod kept;
mod kept_shadows;
mod kinds;
mod lamps;
mod land;
mod look;
mod mesh;
mod objects;
mod obstacles;
mod paint;
#[cfg(not(target_arch = "wasm32"))]
mod picture;
mod pipeline;
mod quality;
mod rain;
mod shaders;
mod shells;
mod sky;
mod sort;
mod split;
mod sun;
mod terrain;
#[cfg_attr(target_arch = "wasm32", expect(dead_code, reason = "only pictures without a window are timed"))]
mod timing;
mod tone;
mod underbrush;
mod uniforms;
mod vehicles;
mod view;
mod weighted;
mod wind;
#[cfg_attr(target_arch = "wasm32", expect(dead_code, reason = "only pictures without a window are counted"))]
mod work;

pub use atlas::reach_m as bend_reach_m;
pub use fit::fitting_px;
pub use gpu::{Gpu, GpuError};
pub use look::{Far, Look, Order};
#[cfg(not(target_arch = "wasm32"))]
pub use picture::Picture;
pub use quality::{Quality, REFERENCE_M};
pub use shared::light::sun::Sun;
pub use split::{Split, Way};
pub use timing::PassSecs;
pub use work::{PassWork, Work};

use crate::camera::Camera;
use crate::state::{Land, Mirror};
use billboards::{Billboards, Reach};
use blades::{Blades, Standpoint};
use cull::{Beam, Frustum};
use detail::Detail;
use dust::Dust;
use forces::Forces;
use glam::Vec3;
use kept_shadows::{KeptShadows, Seen};
use land::{FrameGroup, LandTextures};
use objects::Objects;
use pipeline::{COLOR, DEPTH, Maker};
use rain::RainPass;
use shared::scene::PlantCover;
use shared::wire::ObjectPose;
use shells::{Extent, Shells, Wanted};
use sky::Sky;
use split::Part;
use sun::Daylight;
use terrain::{Ground, Terrain};
use timing::{Pass, Timer};
use tone::Tone;
use underbrush::Underbrush;
use view::{SHADOW_LAYERS, View};
use weighted::Weighted;
use work::{Counter, counted};

/// Distance up to which clumps of plants have several segments, over that at which single plants end.
const SEVERAL_REACHES: f32 = 1.6;

/// What a frame drew.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameStats {
    /// Near plants, of which those in view were moved.
    pub blades: u32,
    /// Clumps of far plants.
    pub clumps: u32,
    /// Layers of tiles of shells.
    pub sheets: u32,
    /// Underbrush in the scene.
    pub underbrush: u32,
    /// Vertices of the ground.
    pub ground_vertices: u64,
    /// Triangles of vehicles, trees and stones.
    pub object_triangles: u64,
    /// Patches of the bend field that were sent to the GPU.
    pub patches_written: u32,
}

/// Draws a [`Mirror`] as a [`Camera`] sees it.
pub struct Renderer {
    gpu: Gpu,
    quality: Quality,
    look: Look,
    detail: Detail,
    size_px: [u32; 2],
    frame: FrameGroup,
    daylight: Daylight,
    targets: Targets,
    tone: Tone,
    sky: Sky,
    /// Made when first needed.
    weighted: Option<Weighted>,
    /// Made by who wants to know.
    timer: Option<Timer>,
    /// The same.
    counter: Option<Counter>,
    scene: Option<SceneParts>,
}

/// What is made anew for each scene.
struct SceneParts {
    number: u32,
    textures: LandTextures,
    ground: Ground,
    terrain: Terrain,
    billboards: Billboards,
    blades: Blades,
    shells: Shells,
    forces: Forces,
    underbrush: Option<Underbrush>,
    rain: Option<RainPass>,
    objects: Objects,
    kept_shadows: KeptShadows,
    dust: Option<Dust>,
}

impl SceneParts {
    /// Draws plants that are blended over what is opaque: far ones, then single ones.
    fn draw_plants(&self, has_blades: bool, clumps: Option<&Billboards>, has_lamps: bool, pass: &mut wgpu::RenderPass<'_>) {
        if let Some(clumps) = clumps {
            clumps.draw(pass);
        }
        if has_blades {
            self.blades.draw(pass, has_lamps);
        }
    }

    /// Draws what is in the air.
    fn draw_weather(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let Some(dust) = &self.dust {
            dust.draw(pass);
        }
        if let Some(rain) = &self.rain {
            rain.draw(pass);
        }
    }
}

/// The pictures that the passes draw to.
struct Targets {
    size_px: [u32; 2],
    /// Their pixels along either side of one that is shown.
    fineness: u32,
    color: wgpu::TextureView,
    depth: wgpu::TextureView,
}

impl Targets {
    /// For a picture that is shown at `shown_px`.
    fn new(gpu: &Gpu, shown_px: [u32; 2], quality: Quality) -> Self {
        let samples = quality.samples(gpu.is_software);
        let fineness = quality.fineness(shown_px, gpu.side_limit_px());
        let size_px = shown_px.map(|side_px| side_px * fineness);
        let texture = |label, format, samples| {
            let descriptor = wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size_px[0], height: size_px[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: samples,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            };
            gpu.device.create_texture(&descriptor).create_view(&Default::default())
        };
        Self { size_px, fineness, color: texture("color", COLOR, samples), depth: texture("depth", DEPTH, samples) }
    }
}

impl Renderer {
    /// A renderer for targets of `format` and `size_px` (at least 1 × 1).
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat, size_px: [u32; 2], quality: Quality) -> Self {
        let size_px = size_px.map(|side| side.max(1));
        let samples = quality.samples(gpu.is_software);
        let daylight = Daylight::new(gpu);
        let frame = FrameGroup::new(gpu, quality, &daylight);
        let maker = Maker { gpu, frame_layout: &frame.layout, samples, has_kinds: true };
        let targets = Targets::new(gpu, size_px, quality);
        Self {
            tone: Tone::new(&maker, format, &targets.color, targets.fineness),
            sky: Sky::new(&maker),
            gpu: gpu.clone(),
            quality,
            look: Look::default(),
            detail: quality.detail(),
            size_px,
            targets,
            frame,
            daylight,
            weighted: None,
            timer: None,
            counter: None,
            scene: None,
        }
    }

    /// Changes the size of the target.
    pub fn resize(&mut self, size_px: [u32; 2]) {
        self.size_px = size_px.map(|side| side.max(1));
        self.targets = Targets::new(&self.gpu, self.size_px, self.quality);
        self.tone.set_picture(&self.gpu, &self.targets.color, self.targets.fineness);
        self.weighted = None;
    }

    /// Size of the target (px).
    pub fn size_px(&self) -> [u32; 2] {
        self.size_px
    }

    /// How frames are drawn from now on.
    pub fn set_look(&mut self, look: Look) {
        self.look = look;
    }

    /// How frames are drawn.
    pub fn look(&self) -> Look {
        self.look
    }

    /// Draws plants at a level of detail between 0, that of low quality, and 3, that of ultra, from now on; no finer than this renderer's own quality.
    pub fn set_level(&mut self, level: f32) {
        self.detail = Detail::at(level.min(self.quality.level()));
    }

    /// How finely this renderer can draw.
    pub fn quality(&self) -> Quality {
        self.quality
    }

    /// Loads the mirror's scene. [`draw`](Self::draw) does so by itself when a new scene has come.
    pub fn load_scene(&mut self, mirror: &Mirror) {
        self.scene = mirror.land().map(|land| {
            let scene = land.scene();
            let samples = self.quality.samples(self.gpu.is_software);
            let maker = Maker { gpu: &self.gpu, frame_layout: &self.frame.layout, samples, has_kinds: has_kinds(land) };
            let heights = land.heights();
            let standing = flora::standing(land);
            let forces = Forces::new(&self.gpu, land, &standing);
            let grass_m = scene.plants.most_grown() * scene.tallest_m();
            let ground = Ground::new(scene.extent_m(), heights.pixel_m(), heights.range_m(), grass_m, scene.light.haze_m);
            SceneParts {
                number: mirror.scene_number(),
                textures: LandTextures::new(&self.gpu, &self.frame, land),
                shells: Shells::new(&maker, land, &ground),
                ground,
                terrain: Terrain::new(&maker, scene.extent_m()),
                billboards: Billboards::new(&maker),
                blades: Blades::new(&maker, self.quality, land),
                underbrush: Underbrush::new(&maker, self.quality, land, &forces),
                forces,
                rain: RainPass::new(&maker, self.quality, land),
                objects: Objects::new(&maker, self.quality, land, standing),
                kept_shadows: KeptShadows::default(),
                dust: Dust::new(&maker, self.quality, land),
            }
        });
    }

    /// Draws a frame to `target`: `time_secs` runs the clouds, gusts and flutter, `dt_secs` is the time since the frame before.
    /// Without a scene the target stays as it is.
    pub fn draw(&mut self, mirror: &mut Mirror, camera: &Camera, time_secs: f64, dt_secs: f32, target: &wgpu::TextureView) -> FrameStats {
        let whole = Part { columns: 0..self.size_px[0], keeps: false };
        self.draw_part(mirror, camera, time_secs, dt_secs, target, &whole)
    }

    fn draw_part(
        &mut self,
        mirror: &mut Mirror,
        camera: &Camera,
        time_secs: f64,
        dt_secs: f32,
        target: &wgpu::TextureView,
        part: &Part,
    ) -> FrameStats {
        if self.scene.as_ref().is_none_or(|scene| scene.number != mirror.scene_number()) {
            self.load_scene(mirror);
        }
        let Some(scene) = &mut self.scene else { return FrameStats::default() };
        let gpu = &self.gpu;
        let poses: Vec<ObjectPose> = mirror.objects().collect();
        let patches_written = scene.textures.atlas.follow(gpu, mirror, [camera.eye_m.x, camera.eye_m.z], dt_secs);
        scene.textures.wind.follow(gpu, mirror.wind(), dt_secs);
        let Some(land) = mirror.land() else { return FrameStats::default() };

        let sun = self.look.sun.unwrap_or_else(|| land.scene().light.sun_at(mirror.time_secs()));
        self.daylight.follow(gpu, sun);
        let detail = self.detail.on(&land.scene().plants).with(self.look.far);
        let view = View::new(camera, self.targets.size_px, self.quality, detail, time_secs, sun);
        let mut frame = view.frame(land, &scene.textures.atlas, &self.daylight, &poses);
        let (has_lamps, has_spheres) = (frame.has_lamps(), frame.has_spheres());
        let Camera { eye_m, heading_rad, .. } = *camera;
        let seen = Seen { eye_m, heading_rad, sun, trees_m: detail.trees_m, culls: self.look.culls, time_secs };
        // Rotors and models of one's own reach beyond the box that an object collides with.
        let reach_m = |pose: &ObjectPose| 2.0 * Vec3::from(land.scene().objects.half_extents_m(pose.kind)).length();
        let shadows_are_due = scene.kept_shadows.follow(&mut frame, seen, &poses, reach_m, dt_secs);
        let shadow_layers: Vec<u32> = (0..SHADOW_LAYERS).filter(|&layer| shadows_are_due[layer as usize]).collect();
        self.frame.write(gpu, &frame);
        let frustum = if self.look.culls { Frustum::new(&view.projection_from_world) } else { Frustum::ALL };
        let tiles = scene.ground.tiles(camera.eye_m, &frustum);
        scene.terrain.prepare(gpu, &tiles);
        let samples = self.quality.samples(gpu.is_software);
        let maker = Maker { gpu, frame_layout: &self.frame.layout, samples, has_kinds: has_kinds(land) };
        let order = self.look.order.at(maker.samples, scene.blades.by_turns());
        scene.blades.set_order(&maker, order);
        scene.billboards.set_order(&maker, order);
        if order == Order::Weighted && self.weighted.is_none() {
            self.weighted = Some(Weighted::new(&maker, self.targets.size_px));
        }
        let shells = match (land.scene().plants.cover, self.look.far) {
            (PlantCover::Shells, _) => Some(Extent::All),
            (PlantCover::Blades, Far::Shells) => Some(Extent::Far),
            _ => None,
        };
        let has_blades = shells != Some(Extent::All);
        let from = Standpoint { eye_m: camera.eye_m, frustum: &frustum, detail: &detail, look: self.look, dt_secs };
        if has_blades {
            scene.blades.prepare(gpu, land, &from);
        }
        if let Some(extent) = shells {
            let wanted = Wanted { extent, reach_m: frame.reach, layers: self.look.shell_layers };
            scene.shells.prepare(gpu, land, camera.eye_m, &frustum, wanted);
        } else if self.look.far == Far::Clumps {
            let reach = Reach { from_m: frame.reach[0], several_m: SEVERAL_REACHES * frame.reach[1], to_m: frame.reach[3] };
            scene.billboards.prepare(gpu, land, camera.eye_m, &frustum, reach);
        }
        if let Some(underbrush) = &mut scene.underbrush {
            scene.forces.follow(gpu, land, &scene.textures.wind, &poses, [camera.eye_m.x, camera.eye_m.z], dt_secs);
            underbrush.show_broken(gpu, mirror.falls(), mirror.broken_count());
            underbrush.prepare(gpu, &scene.forces, &from);
        }
        if let Some(dust) = &scene.dust {
            dust.prepare(gpu, dt_secs);
        }
        let projections = [&frame.shadow_from_world, &frame.lights.far_shadow_from_world];
        let beams = std::array::from_fn(|layer| shadows_are_due[layer].then(|| Beam::new(projections[layer])));
        scene.objects.prepare(gpu, &poses, &from, beams, time_secs as f32, frame.screen[2]);

        let clumps = (self.look.far == Far::Clumps && has_blades).then_some(&scene.billboards);
        let turns = if has_blades { scene.blades.turns() } else { 1 };
        if let Some(counter) = &mut self.counter {
            counter.begin_frame(gpu, turns);
        }
        for turn in 0..turns {
            if let Some(counter) = &mut self.counter {
                counter.begin_encoder();
            }
            if has_blades {
                scene.blades.begin_turn(gpu, turn);
            }
            let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
            if turn == 0 {
                {
                    let timestamp_writes = self.timer.as_ref().map(|timer| timer.of_compute(Pass::Shadows, shadow_layers.is_empty()));
                    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("blow"), timestamp_writes });
                    pass.set_bind_group(0, &scene.textures.shadow_group, &[]);
                    scene.objects.blow(&mut pass);
                }
                for &layer in &shadow_layers {
                    let is_last = shadow_layers.last() == Some(&layer);
                    let clock = self.timer.as_ref().and_then(|timer| timer.of_render(Pass::Shadows, false, is_last));
                    let pass = shadow_pass(&mut encoder, &self.frame.shadow_map(layer), clock);
                    let mut pass = counted(&mut self.counter, Pass::Shadows, pass);
                    pass.set_bind_group(0, &scene.textures.shadow_group, &[]);
                    scene.objects.draw_shadows(&mut pass, layer as usize);
                }
            }
            {
                let timestamp_writes = self.timer.as_ref().map(|timer| timer.of_compute(Pass::Bend, true));
                let pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("bend"), timestamp_writes });
                let mut pass = counted(&mut self.counter, Pass::Bend, pass);
                pass.set_bind_group(0, &scene.textures.group, &[]);
                if has_blades {
                    scene.blades.bend(&mut pass, has_spheres, has_lamps);
                }
                if turn == 0 {
                    if shells.is_some() {
                        scene.shells.bend(&mut pass);
                    }
                    if let Some(clumps) = clumps {
                        clumps.bend(&mut pass);
                    }
                    if let Some(underbrush) = &scene.underbrush {
                        underbrush.bend(&mut pass, has_spheres, has_lamps);
                    }
                    if let Some(dust) = &scene.dust {
                        dust.blow(&mut pass);
                    }
                }
            }
            let weighted = self.weighted.as_ref().filter(|_| order == Order::Weighted);
            let is_last = turn + 1 == turns;
            {
                let clock = self.timer.as_ref().and_then(|timer| timer.of_render(Pass::Picture, turn == 0, is_last && weighted.is_none()));
                let pass = main_pass(&mut encoder, &self.targets, turn == 0, is_last && weighted.is_none(), clock);
                let mut pass = counted(&mut self.counter, Pass::Picture, pass);
                pass.set_bind_group(0, &scene.textures.group, &[]);
                if turn == 0 {
                    scene.objects.draw(&mut pass, has_lamps);
                }
                if has_blades {
                    if !order.blends() {
                        scene.blades.draw(&mut pass, has_lamps);
                    }
                    scene.blades.draw_flowers(&mut pass, has_lamps);
                }
                if is_last {
                    if shells.is_some() {
                        scene.shells.draw(&mut pass);
                    }
                    if let Some(underbrush) = &scene.underbrush {
                        underbrush.draw(&mut pass);
                    }
                    if let Some(clumps) = clumps.filter(|_| !order.blends()) {
                        clumps.draw(&mut pass);
                    }
                    scene.terrain.draw(&mut pass, has_lamps);
                    self.sky.draw(&mut pass);
                    if weighted.is_none() {
                        if order.blends() {
                            scene.draw_plants(has_blades, clumps, has_lamps, &mut pass);
                        }
                        scene.draw_weather(&mut pass);
                    }
                }
            }
            if let Some(weighted) = weighted {
                {
                    let mut pass = counted(&mut self.counter, Pass::Picture, weighted.pass(&mut encoder, &self.targets.depth));
                    pass.set_bind_group(0, &scene.textures.group, &[]);
                    scene.draw_plants(has_blades, clumps, has_lamps, &mut pass);
                }
                let clock = self.timer.as_ref().and_then(|timer| timer.of_render(Pass::Picture, false, true));
                let mut pass = counted(&mut self.counter, Pass::Picture, main_pass(&mut encoder, &self.targets, false, true, clock));
                pass.set_bind_group(0, &scene.textures.group, &[]);
                weighted.compose(&mut pass);
                scene.draw_weather(&mut pass);
            }
            if turn + 1 == turns {
                let clock = self.timer.as_ref().and_then(|timer| timer.of_render(Pass::Tone, true, true));
                let mut pass = counted(&mut self.counter, Pass::Tone, tone_pass(&mut encoder, target, part.keeps, clock));
                pass.set_scissor_rect(part.columns.start, 0, part.columns.len() as u32, self.size_px[1]);
                pass.set_bind_group(0, &scene.textures.group, &[]);
                self.tone.draw(&mut pass);
            }
            if let Some(timer) = self.timer.as_ref().filter(|_| is_last) {
                timer.resolve(&mut encoder);
            }
            if let Some(counter) = &self.counter {
                counter.resolve(&mut encoder);
            }
            gpu.queue.submit([encoder.finish()]);
        }
        FrameStats {
            blades: if has_blades { scene.blades.standing() } else { 0 },
            clumps: clumps.map_or(0, Billboards::count),
            sheets: if shells.is_some() { scene.shells.sheets() } else { 0 },
            underbrush: scene.underbrush.as_ref().map_or(0, Underbrush::plants),
            ground_vertices: scene.terrain.vertices(),
            object_triangles: scene.objects.triangles(),
            patches_written,
        }
    }
}

/// Whether more than one kind of grass grows.
fn has_kinds(land: &Land) -> bool {
    !land.scene().species.is_empty()
}

fn shadow_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    depth: &wgpu::TextureView,
    timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("shadows"),
        color_attachments: &[],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        timestamp_writes,
        occlusion_query_set: None,
        multiview_mask: None,
    })
}

/// The pass that draws the picture: the first one begins it, the last one ends it.
fn main_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    targets: &Targets,
    is_first: bool,
    is_last: bool,
    timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
) -> wgpu::RenderPass<'a> {
    use wgpu::{LoadOp, StoreOp};
    let keep = |is_kept| if is_kept { StoreOp::Store } else { StoreOp::Discard };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("picture"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &targets.color,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: if is_first { LoadOp::Clear(wgpu::Color::BLACK) } else { LoadOp::Load }, store: StoreOp::Store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &targets.depth,
            depth_ops: Some(wgpu::Operations { load: if is_first { LoadOp::Clear(0.0) } else { LoadOp::Load }, store: keep(!is_last) }),
            stencil_ops: None,
        }),
        timestamp_writes,
        occlusion_query_set: None,
        multiview_mask: None,
    })
}

fn tone_pass<'a>(
    encoder: &'a mut wgpu::CommandEncoder,
    target: &wgpu::TextureView,
    keeps: bool,
    timestamp_writes: Option<wgpu::RenderPassTimestampWrites<'_>>,
) -> wgpu::RenderPass<'a> {
    let load = if keeps { wgpu::LoadOp::Load } else { wgpu::LoadOp::Clear(wgpu::Color::BLACK) };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("tone"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: None,
        timestamp_writes,
        occlusion_query_set: None,
        multiview_mask: None,
    })
}

#[cfg(test)]
mod tests;
