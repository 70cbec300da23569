//! Command encoder of a frame. Most frames have one. If the plants do not fit into a buffer, they are drawn in batches, each with an encoder of its own.

use crate::render::frame::moment::OutputRegion;
use crate::render::frame::prepare::FramePlan;
use crate::render::gpu::pipeline_statistics::{Counted, counted};
use crate::render::gpu::timestamps::Pass;
use crate::render::options::render_options::BlendOrder;
use crate::render::renderer::Renderer;
use crate::render::scene_resources::SceneResources;
use crate::render::solids::occlusion::Phase;
use crate::render::targets::{overlay_pass, shadow_pass, tone_pass};

type RenderPass = Counted<wgpu::RenderPass<'static>>;

/// The passes of one batch of plants. Shadows and everything but plants are drawn in the first or the last one.
pub(super) struct Batch<'a> {
    renderer: &'a mut Renderer,
    scene: &'a SceneResources,
    plan: &'a FramePlan,
    is_first: bool,
    is_last: bool,
    encoder: wgpu::CommandEncoder,
}

impl<'a> Batch<'a> {
    pub(super) fn begin(renderer: &'a mut Renderer, scene: &'a mut SceneResources, plan: &'a FramePlan, number: u32) -> Self {
        let (is_first, is_last) = (number == 0, number + 1 == plan.batches);
        if let Some(statistics) = &mut renderer.statistics {
            if is_first {
                statistics.begin_frame(&renderer.gpu, plan.batches);
            }
            statistics.begin_encoder();
        }
        if let Some(blades) = &mut scene.blades {
            blades.begin_batch(&renderer.gpu, number);
        }
        let encoder = renderer.gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("frame") });
        Self { renderer, scene, plan, is_first, is_last, encoder }
    }

    /// Sways the trees, draws the shadow cascades that are due, and casts the shade of the grass.
    pub(super) fn shadows(&mut self) {
        if !self.is_first {
            return;
        }
        let cascades = &self.plan.due_cascades;
        let group = &self.scene.textures.shadow_group;
        let shade = self.scene.shade_map.as_ref().filter(|_| self.plan.grass_shades);
        {
            let timestamp_writes = self.renderer.timestamps.as_ref().map(|queries| queries.of_compute(Pass::Shadows, cascades.is_empty()));
            let descriptor = wgpu::ComputePassDescriptor { label: Some("sway"), timestamp_writes };
            let mut pass = self.encoder.begin_compute_pass(&descriptor);
            pass.set_bind_group(0, group, &[]);
            self.scene.objects.iter().for_each(|objects| objects.sway(&mut pass));
            shade.iter().for_each(|shade| shade.cast(&mut pass));
        }
        shade.iter().for_each(|shade| shade.show(&mut self.encoder, &self.scene.textures.shade));
        for &cascade in cascades {
            let is_last = cascades.last() == Some(&cascade);
            let clock = self.renderer.timestamps.as_ref().and_then(|queries| queries.of_render(Pass::Shadows, false, is_last));
            let pass = shadow_pass(&mut self.encoder, &self.renderer.bindings.shadow_map(cascade), clock);
            let mut pass = counted(&mut self.renderer.statistics, Pass::Shadows, pass);
            pass.set_bind_group(0, group, &[]);
            self.scene.objects.iter().for_each(|objects| objects.draw_shadows(&mut pass, cascade as usize));
        }
    }

    /// Draws the solids that were visible in the previous frame, reduces their depth to the pyramid, and lists the other solids that it does not hide.
    pub(super) fn occluders(&mut self) {
        let Some(objects) = self.scene.objects.as_ref().filter(|_| self.occludes()) else { return };
        let mut pass = self.picture_pass(true, false);
        objects.draw(&mut pass, Phase::Known, self.plan.has_lamps);
        drop(pass);
        let descriptor = wgpu::ComputePassDescriptor { label: Some("depth pyramid"), ..Default::default() };
        let mut pass = self.encoder.begin_compute_pass(&descriptor);
        pass.set_bind_group(0, &self.scene.textures.group, &[]);
        self.renderer.depth_pyramid.iter().for_each(|pyramid| pyramid.reduce(&mut pass));
        objects.list_new(&mut pass);
    }

    /// Whether this batch draws its solids in two phases.
    fn occludes(&self) -> bool {
        self.is_first && self.plan.occludes
    }

    /// Culls, bends and sorts the plants.
    pub(super) fn bend(&mut self) {
        let &FramePlan { has_spheres, has_lamps, occludes, .. } = self.plan;
        let flags = [has_spheres, has_lamps, occludes];
        let scene = self.scene;
        let timestamp_writes = self.renderer.timestamps.as_ref().map(|queries| queries.of_compute(Pass::Bend, true));
        let pass = self.encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("bend"), timestamp_writes });
        let mut pass = counted(&mut self.renderer.statistics, Pass::Bend, pass);
        pass.set_bind_group(0, &scene.textures.group, &[]);
        if let Some(blades) = &scene.blades {
            blades.bend(&mut pass, flags);
        }
        if !self.is_first {
            return;
        }
        if let Some(shells) = self.plan.shells(scene) {
            shells.bend(&mut pass);
        }
        if let Some(clumps) = self.plan.clumps(scene) {
            clumps.bend(&mut pass);
        }
        if let Some(underbrush) = &scene.underbrush {
            underbrush.bend(&mut pass, flags);
        }
        if let Some(dust) = &scene.dust {
            dust.drift(&mut pass);
        }
    }

    /// Draws everything opaque, roughly near to far, and returns the pass for [`blended`](Self::blended).
    pub(super) fn opaque(&mut self) -> RenderPass {
        let &FramePlan { has_lamps, order, .. } = self.plan;
        let scene = self.scene;
        let ends_picture = self.is_last && !self.is_weighted();
        let (begins_picture, phase) = if self.occludes() { (false, Phase::New) } else { (self.is_first, Phase::Whole) };
        let mut pass = self.picture_pass(begins_picture, ends_picture);
        if let Some(objects) = scene.objects.as_ref().filter(|_| self.is_first) {
            objects.draw(&mut pass, phase, has_lamps);
        }
        if let Some(blades) = &scene.blades {
            if !order.blends() {
                blades.draw(&mut pass, has_lamps);
            }
            blades.draw_flowers(&mut pass, has_lamps);
        }
        if self.is_last {
            if let Some(shells) = self.plan.shells(scene) {
                shells.draw(&mut pass, has_lamps);
            }
            if let Some(underbrush) = &scene.underbrush {
                underbrush.draw(&mut pass);
            }
            if let Some(clumps) = self.plan.clumps(scene).filter(|_| !order.blends()) {
                clumps.draw(&mut pass);
            }
            scene.terrain.draw(&mut pass, has_lamps);
            self.renderer.sky.draw(&mut pass, self.plan.sky_shows);
        }
        pass
    }

    /// Draws blended plants and the weather over the opaque picture.
    pub(super) fn blended(&mut self, mut picture: RenderPass) {
        if !self.is_weighted() {
            if self.is_last {
                if self.plan.order.blends() {
                    self.draw_blended_plants(&mut picture);
                }
                self.draw_weather(&mut picture);
            }
            return;
        }
        drop(picture);
        let Some(weighted) = &self.renderer.weighted else { return };
        let pass = weighted.pass(&mut self.encoder, &self.renderer.targets.depth);
        let mut pass = counted(&mut self.renderer.statistics, Pass::Picture, pass);
        pass.set_bind_group(0, &self.scene.textures.group, &[]);
        self.draw_blended_plants(&mut pass);
        drop(pass);
        let mut picture = self.picture_pass(false, true);
        self.renderer.weighted.iter().for_each(|weighted| weighted.compose(&mut picture));
        self.draw_weather(&mut picture);
    }

    /// Maps light to the colours of the target.
    pub(super) fn tone(&mut self, target: &wgpu::TextureView, region: &OutputRegion) {
        if !self.is_last {
            return;
        }
        let clock = self.renderer.timestamps.as_ref().and_then(|queries| queries.of_render(Pass::Tone, true, true));
        let pass = tone_pass(&mut self.encoder, target, region.keeps_rest, clock);
        let mut pass = counted(&mut self.renderer.statistics, Pass::Tone, pass);
        pass.set_scissor_rect(region.columns.start, 0, region.columns.len() as u32, self.renderer.size_px[1]);
        pass.set_bind_group(0, &self.scene.textures.group, &[]);
        self.renderer.tone.draw(&mut pass);
    }

    /// Draws the map of the grids over the target, if it is shown.
    pub(super) fn overlay(&mut self, target: &wgpu::TextureView) {
        let Some(map) = self.plan.grid_map(self.scene).filter(|_| self.is_last) else { return };
        let group = &self.scene.textures.group;
        {
            let mut pass =
                self.encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some("classes of grids"), ..Default::default() });
            pass.set_bind_group(0, group, &[]);
            map.class(&mut pass);
        }
        let mut pass = overlay_pass(&mut self.encoder, target);
        pass.set_bind_group(0, group, &[]);
        map.draw(&mut pass);
    }

    pub(super) fn submit(mut self) {
        if let Some(timestamps) = self.renderer.timestamps.as_ref().filter(|_| self.is_last) {
            timestamps.resolve(&mut self.encoder);
        }
        if let Some(statistics) = &self.renderer.statistics {
            statistics.resolve(&mut self.encoder);
        }
        self.renderer.gpu.queue.submit([self.encoder.finish()]);
    }

    fn picture_pass(&mut self, is_first: bool, is_last: bool) -> RenderPass {
        let clock = self.renderer.timestamps.as_ref().and_then(|queries| queries.of_render(Pass::Picture, is_first, is_last));
        let pass = self.renderer.targets.picture_pass(&mut self.encoder, [is_first, is_last], clock);
        let mut pass = counted(&mut self.renderer.statistics, Pass::Picture, pass);
        pass.set_bind_group(0, &self.scene.textures.group, &[]);
        pass
    }

    /// Whether plants are blended by weighted order-independent transparency.
    fn is_weighted(&self) -> bool {
        self.plan.order == BlendOrder::Weighted
    }

    fn draw_blended_plants(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let Some(clumps) = self.plan.clumps(self.scene) {
            clumps.draw(pass);
        }
        if let Some(blades) = &self.scene.blades {
            blades.draw(pass, self.plan.has_lamps);
        }
    }

    fn draw_weather(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let Some(dust) = &self.scene.dust {
            dust.draw(pass);
        }
        if let Some(rain) = &self.scene.rain {
            rain.draw(pass);
        }
    }
}
