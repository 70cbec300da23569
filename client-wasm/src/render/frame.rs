//! The steps of a frame.

mod batch;
mod moment;
mod prepare;

use crate::camera::Camera;
use crate::render::options::split::Split;
use crate::render::plants::billboards::Billboards;
use crate::render::plants::shells::Shells;
use crate::render::renderer::Renderer;
use crate::render::scene_resources::SceneResources;
use crate::state::Mirror;
use batch::Batch;
use moment::{Moment, OutputRegion};
use prepare::FramePlan;

/// Statistics of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FrameStats {
    /// Plants near the camera; of these, the ones in view were simulated.
    pub blades: u32,
    /// Clumps of far plants.
    pub clumps: u32,
    /// Shell layers, summed over all tiles.
    pub shell_layers: u32,
    /// Underbrush plants in the scene.
    pub underbrush: u32,
    /// Vertices of the ground.
    pub ground_vertices: u64,
    /// Triangles of vehicles, trees and stones.
    pub object_triangles: u64,
    /// Patches of the bend field that were uploaded.
    pub patches_written: u32,
}

impl Renderer {
    /// Draws a frame to `target`. `time_secs` drives clouds, gusts and flutter; `dt_secs` is the time since the previous frame.
    /// Without a scene the target is left unchanged.
    pub fn draw(&mut self, mirror: &mut Mirror, camera: &Camera, time_secs: f64, dt_secs: f32, target: &wgpu::TextureView) -> FrameStats {
        let region = OutputRegion { columns: 0..self.size_px[0], keeps_rest: false };
        self.draw_region(mirror, &Moment { camera, time_secs, dt_secs }, target, &region)
    }

    /// Draws with different options to the left and right of a border. Both sides show the same moment: time advances on the side with more
    /// detail, whose plants include those of the other. A side without columns costs nothing.
    pub fn draw_split(
        &mut self,
        mirror: &mut Mirror,
        camera: &Camera,
        time_secs: f64,
        dt_secs: f32,
        target: &wgpu::TextureView,
        split: &Split,
    ) -> FrameStats {
        let (options, detail) = (self.options, self.detail);
        let mut stats = FrameStats::default();
        let sides = split.sides.into_iter().zip(split.columns(self.size_px[0]));
        let mut sides: Vec<_> = sides.filter(|(_, columns)| !columns.is_empty()).collect();
        sides.sort_by(|(a, _), (b, _)| b.level.total_cmp(&a.level));
        for (drawn, (side, columns)) in sides.into_iter().enumerate() {
            self.set_options(side.options);
            self.set_level(side.level);
            let region = OutputRegion { columns, keeps_rest: drawn > 0 };
            let moment = Moment { camera, time_secs, dt_secs: if drawn > 0 { 0.0 } else { dt_secs } };
            stats = self.draw_region(mirror, &moment, target, &region);
        }
        (self.options, self.detail) = (options, detail);
        stats
    }

    fn draw_region(&mut self, mirror: &mut Mirror, moment: &Moment<'_>, target: &wgpu::TextureView, region: &OutputRegion) -> FrameStats {
        let Some(mut scene) = self.take_scene(mirror) else { return FrameStats::default() };
        let plan = self.prepare(&mut scene, mirror, moment, &region.columns);
        for number in 0..plan.batches {
            let mut batch = Batch::begin(self, &mut scene, &plan, number);
            batch.shadows();
            batch.occluders();
            batch.bend();
            let picture = batch.opaque();
            batch.blended(picture);
            batch.tone(target, region);
            batch.overlay(target);
            batch.submit();
        }
        let stats = stats(&scene, &plan);
        self.scene = Some(scene);
        stats
    }

    /// The mirror's scene, loaded if it has changed. The caller puts it back.
    fn take_scene(&mut self, mirror: &Mirror) -> Option<Box<SceneResources>> {
        if self.scene.as_ref().is_none_or(|scene| scene.number != mirror.scene_number()) {
            self.load_scene(mirror);
        }
        self.scene.take()
    }
}

fn stats(scene: &SceneResources, plan: &FramePlan) -> FrameStats {
    FrameStats {
        blades: scene.blades.as_ref().map_or(0, |blades| blades.near_plants()),
        clumps: plan.clumps(scene).map_or(0, Billboards::count),
        shell_layers: plan.shells(scene).map_or(0, Shells::layer_count),
        underbrush: scene.underbrush.as_ref().map_or(0, |underbrush| underbrush.plants()),
        ground_vertices: scene.terrain.vertices(),
        object_triangles: scene.objects.as_ref().map_or(0, |objects| objects.triangles()),
        patches_written: plan.patches_written,
    }
}
