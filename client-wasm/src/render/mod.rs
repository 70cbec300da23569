//! The picture: one pass a file, over one uniform block and one set of textures.
//!
//! A frame: compute passes bend the single plants and list those in view; the sun's shadow map; then objects, blades, flowers,
//! billboards, ground and sky, near to far, and dust over them, into a picture of linear light; tone mapping brings it to the target.

mod atlas;
mod billboards;
mod blades;
mod cull;
mod dots;
mod dust;
mod flora;
mod forces;
mod gpu;
mod kinds;
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
mod terrain;
mod tone;
mod underbrush;
mod uniforms;
mod vehicles;
mod view;
mod wind;

pub use atlas::reach_m as bend_reach_m;
pub use gpu::{Gpu, GpuError};
pub use look::{Far, Look, Order};
#[cfg(not(target_arch = "wasm32"))]
pub use picture::Picture;
pub use quality::Quality;

use crate::camera::Camera;
use crate::state::Mirror;
use billboards::{Billboards, Reach};
use blades::Blades;
use cull::Frustum;
use dust::Dust;
use forces::Forces;
use land::{FrameGroup, LandTextures};
use objects::Objects;
use pipeline::{COLOR, DEPTH, Maker};
use rain::RainPass;
use shared::scene::PlantCover;
use shared::wire::ObjectPose;
use shells::{Extent, Shells, Wanted};
use sky::Sky;
use terrain::{Ground, Terrain};
use tone::Tone;
use underbrush::Underbrush;
use view::View;

/// Distance up to which clumps of plants have several segments, over that at which single plants end.
const SEVERAL_REACHES: f32 = 1.6;

/// What a frame drew.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameStats {
    /// Near plants whose posture was simulated.
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
    size_px: [u32; 2],
    frame: FrameGroup,
    targets: Targets,
    tone: Tone,
    sky: Sky,
    terrain: Terrain,
    billboards: Billboards,
    scene: Option<SceneParts>,
}

/// What is made anew for each scene.
struct SceneParts {
    number: u32,
    textures: LandTextures,
    ground: Ground,
    blades: Blades,
    shells: Shells,
    forces: Forces,
    underbrush: Option<Underbrush>,
    rain: Option<RainPass>,
    objects: Objects,
    dust: Option<Dust>,
}

/// The pictures that the passes draw to.
struct Targets {
    color: wgpu::TextureView,
    /// Where the samples of `color` go, if it has more than one.
    resolved: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
}

impl Targets {
    fn new(gpu: &Gpu, size_px: [u32; 2], samples: u32) -> Self {
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
        Self {
            color: texture("color", COLOR, samples),
            resolved: (samples > 1).then(|| texture("resolved color", COLOR, 1)),
            depth: texture("depth", DEPTH, samples),
        }
    }

    fn picture(&self) -> &wgpu::TextureView {
        self.resolved.as_ref().unwrap_or(&self.color)
    }
}

impl Renderer {
    /// A renderer for targets of `format` and `size_px` (at least 1 × 1).
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat, size_px: [u32; 2], quality: Quality) -> Self {
        let size_px = size_px.map(|side| side.max(1));
        let frame = FrameGroup::new(gpu, quality.shadow_px());
        let maker = Maker { gpu, frame_layout: &frame.layout, samples: quality.samples() };
        let targets = Targets::new(gpu, size_px, quality.samples());
        Self {
            tone: Tone::new(&maker, format, targets.picture()),
            sky: Sky::new(&maker),
            terrain: Terrain::new(&maker),
            billboards: Billboards::new(&maker),
            gpu: gpu.clone(),
            quality,
            look: Look::default(),
            size_px,
            targets,
            frame,
            scene: None,
        }
    }

    /// Changes the size of the target.
    pub fn resize(&mut self, size_px: [u32; 2]) {
        self.size_px = size_px.map(|side| side.max(1));
        self.targets = Targets::new(&self.gpu, self.size_px, self.quality.samples());
        self.tone.set_picture(&self.gpu, self.targets.picture());
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

    /// How finely this renderer draws.
    pub fn quality(&self) -> Quality {
        self.quality
    }

    /// Loads the mirror's scene. [`draw`](Self::draw) does so by itself when a new scene has come.
    pub fn load_scene(&mut self, mirror: &Mirror) {
        self.scene = mirror.land().map(|land| {
            let maker = Maker { gpu: &self.gpu, frame_layout: &self.frame.layout, samples: self.quality.samples() };
            let scene = land.scene();
            let heights = land.heights();
            let standing = flora::standing(land);
            let forces = Forces::new(&self.gpu, land, &standing);
            let ground = Ground::new(scene.extent_m(), heights.pixel_m(), heights.range_m(), scene.light.haze_m);
            SceneParts {
                number: mirror.scene_number(),
                textures: LandTextures::new(&self.gpu, &self.frame, land),
                shells: Shells::new(&maker, land, &ground),
                ground,
                blades: Blades::new(&maker, self.quality, land),
                underbrush: Underbrush::new(&maker, land, &forces, self.quality.underbrush_reach_m()),
                forces,
                rain: RainPass::new(&maker, self.quality, land),
                objects: Objects::new(&maker, land, standing),
                dust: Dust::new(&maker, self.quality, land),
            }
        });
    }

    /// Draws a frame to `target`: `time_secs` runs the clouds, gusts and flutter, `dt_secs` is the time since the frame before.
    /// Without a scene the target stays as it is.
    pub fn draw(&mut self, mirror: &mut Mirror, camera: &Camera, time_secs: f64, dt_secs: f32, target: &wgpu::TextureView) -> FrameStats {
        if self.scene.as_ref().is_none_or(|scene| scene.number != mirror.scene_number()) {
            self.load_scene(mirror);
        }
        let Some(scene) = &mut self.scene else { return FrameStats::default() };
        let gpu = &self.gpu;
        let poses: Vec<ObjectPose> = mirror.objects().collect();
        let patches_written = scene.textures.atlas.follow(gpu, mirror, [camera.eye_m.x, camera.eye_m.z], dt_secs);
        scene.textures.wind.follow(gpu, mirror.wind(), dt_secs);
        let Some(land) = mirror.land() else { return FrameStats::default() };

        let view = View::new(camera, self.size_px, self.quality, time_secs);
        let frame = view.frame(land, &scene.textures.atlas, scene.blades.reach_m(), &poses);
        self.frame.write(gpu, &frame);
        let frustum = Frustum::new(&view.projection_from_world);
        let tiles = scene.ground.tiles(camera.eye_m, &frustum);
        self.terrain.prepare(gpu, &tiles);
        let shells = match (land.scene().plants.cover, self.look.far) {
            (PlantCover::Shells, _) => Some(Extent::All),
            (PlantCover::Blades, Far::Shells) => Some(Extent::Far),
            _ => None,
        };
        let has_blades = shells != Some(Extent::All);
        if has_blades {
            scene.blades.prepare(gpu, self.quality, land, camera.eye_m, &frustum, dt_secs);
        }
        if let Some(extent) = shells {
            let wanted = Wanted { extent, reach_m: frame.reach, layers: self.look.shell_layers };
            scene.shells.prepare(gpu, land, camera.eye_m, &frustum, wanted);
        } else {
            let reach = Reach { from_m: 0.72 * frame.reach[0], several_m: SEVERAL_REACHES * frame.reach[1], to_m: frame.reach[3] };
            self.billboards.prepare(gpu, land, camera.eye_m, &frustum, reach);
        }
        if let Some(underbrush) = &mut scene.underbrush {
            scene.forces.follow(gpu, land, &scene.textures.wind, &poses, [camera.eye_m.x, camera.eye_m.z], dt_secs);
            underbrush.show_broken(gpu, mirror.falls(), mirror.broken_count());
            underbrush.prepare(gpu, &scene.forces, camera.eye_m, &frustum, dt_secs);
        }
        if let Some(dust) = &scene.dust {
            dust.prepare(gpu, dt_secs);
        }
        let reach_m = self.quality.tree_reach_m();
        scene.objects.prepare(gpu, &poses, camera.eye_m, &frustum, time_secs as f32, dt_secs, reach_m);

        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
        {
            let mut pass = shadow_pass(&mut encoder, self.frame.shadow_map());
            pass.set_bind_group(0, &scene.textures.shadow_group, &[]);
            scene.objects.draw_shadows(&mut pass);
        }
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("bend"), timestamp_writes: None });
            pass.set_bind_group(0, &scene.textures.group, &[]);
            if has_blades {
                scene.blades.bend(&mut pass);
            }
            if shells.is_some() {
                scene.shells.bend(&mut pass);
            } else {
                self.billboards.bend(&mut pass);
            }
            if let Some(underbrush) = &scene.underbrush {
                underbrush.bend(&mut pass);
            }
            if let Some(dust) = &scene.dust {
                dust.blow(&mut pass);
            }
        }
        {
            let mut pass = main_pass(&mut encoder, &self.targets);
            pass.set_bind_group(0, &scene.textures.group, &[]);
            scene.objects.draw(&mut pass);
            if has_blades {
                scene.blades.draw(&mut pass);
            }
            if let Some(underbrush) = &scene.underbrush {
                underbrush.draw(&mut pass);
            }
            if shells.is_some() {
                scene.shells.draw(&mut pass);
            } else {
                self.billboards.draw(&mut pass);
            }
            self.terrain.draw(&mut pass);
            self.sky.draw(&mut pass);
            if let Some(dust) = &scene.dust {
                dust.draw(&mut pass);
            }
            if let Some(rain) = &scene.rain {
                rain.draw(&mut pass);
            }
        }
        {
            let mut pass = tone_pass(&mut encoder, target);
            pass.set_bind_group(0, &scene.textures.group, &[]);
            self.tone.draw(&mut pass);
        }
        gpu.queue.submit([encoder.finish()]);
        FrameStats {
            blades: if has_blades { scene.blades.simulated() } else { 0 },
            clumps: if shells.is_none() { self.billboards.count() } else { 0 },
            sheets: if shells.is_some() { scene.shells.sheets() } else { 0 },
            underbrush: scene.underbrush.as_ref().map_or(0, Underbrush::plants),
            ground_vertices: self.terrain.vertices(),
            object_triangles: scene.objects.triangles(),
            patches_written,
        }
    }
}

fn shadow_pass<'a>(encoder: &'a mut wgpu::CommandEncoder, depth: &wgpu::TextureView) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("shadows"),
        color_attachments: &[],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
            stencil_ops: None,
        }),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    })
}

fn main_pass<'a>(encoder: &'a mut wgpu::CommandEncoder, targets: &Targets) -> wgpu::RenderPass<'a> {
    let store = if targets.resolved.is_some() { wgpu::StoreOp::Discard } else { wgpu::StoreOp::Store };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("picture"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: &targets.color,
            depth_slice: None,
            resolve_target: targets.resolved.as_ref(),
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store },
        })],
        depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
            view: &targets.depth,
            depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
            stencil_ops: None,
        }),
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    })
}

fn tone_pass<'a>(encoder: &'a mut wgpu::CommandEncoder, target: &wgpu::TextureView) -> wgpu::RenderPass<'a> {
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("tone"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view: target,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::BLACK), store: wgpu::StoreOp::Store },
        })],
        depth_stencil_attachment: None,
        timestamp_writes: None,
        occlusion_query_set: None,
        multiview_mask: None,
    })
}

#[cfg(test)]
mod tests;
