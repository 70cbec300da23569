//! The initial layout of the viewer: the [tabs](super::tabs::TABS).

use super::connect::APPLICATION;
use super::entities::Entity;
use super::plots::{PLOTS, Plot};
use super::tabs::{Slice, TABS, Tab, View, plot};
use glam::Vec3;
use prairie_core::scene::Scene;
use prairie_core::terrain::HeightMap;
use rerun::blueprint::components::{BackgroundKind, ContainerKind, Corner2D, IncludedContent, PanelState, PlayState, RootContainer};
use rerun::external::re_log_types::BlueprintActivationCommand;
use rerun::external::re_sdk_types::blueprint::archetypes::{
    Background, ContainerBlueprint, EyeControls3D, LineGrid3D, PanelBlueprint, PlotLegend, TensorSliceSelection, TimePanelBlueprint,
    ViewBlueprint, ViewContents, ViewportBlueprint,
};
use rerun::external::re_sdk_types::datatypes::{TensorDimensionIndexSelection, Uuid};
use rerun::log::LogMsg;
use rerun::{AsComponents, RecordingStream, RecordingStreamBuilder, RecordingStreamResult};

/// A layout of the viewer, ready to be sent.
pub(super) struct InitialLayout {
    messages: Vec<LogMsg>,
}

impl InitialLayout {
    /// Makes it the active layout of a recording.
    pub(super) fn send(self, stream: &RecordingStream) {
        if let Some(blueprint_id) = self.messages.first().map(|message| message.store_id().clone()) {
            stream.send_blueprint(self.messages, BlueprintActivationCommand { blueprint_id, make_active: true, make_default: true });
        }
    }
}

/// The layout for a scene; its camera looks at the clients' starting point.
pub(super) fn initial_layout(scene: &Scene, heights: &HeightMap) -> RecordingStreamResult<InitialLayout> {
    let (stream, storage) = RecordingStreamBuilder::new(APPLICATION).blueprint().memory()?;
    stream.set_time_sequence("blueprint", 0);
    let mut layout = Layout { stream, next: 1, eye: eye(scene, heights) };
    let tabs = TABS.iter().map(|tab| layout.tab(tab)).collect::<RecordingStreamResult<Vec<_>>>()?;
    let (root, _) = layout.container(ContainerKind::Tabs, tabs, |root| root)?;

    let viewport = ViewportBlueprint::new().with_root_container(root).with_auto_layout(false).with_auto_views(false);
    layout.stream.log("viewport", &viewport)?;
    for panel in ["blueprint_panel", "selection_panel"] {
        layout.stream.log(panel, &PanelBlueprint::new().with_state(PanelState::Collapsed))?;
    }
    let time = TimePanelBlueprint::new().with_state(PanelState::Collapsed).with_timeline("sim_time").with_play_state(PlayState::Following);
    layout.stream.log("time_panel", &time)?;
    Ok(InitialLayout { messages: storage.take() })
}

/// A camera that looks down on the clients' starting point from behind, far enough away to show a good part of the world.
fn eye(scene: &Scene, heights: &HeightMap) -> EyeControls3D {
    let extent_m = scene.extent_m();
    let [x, z] = [0, 1].map(|axis| scene.camera.at[axis] * extent_m[axis]);
    let target = Vec3::new(x, heights.height_m(x, z), z);
    let (sin, cos) = scene.camera.heading_rad.sin_cos();
    let distance_m = (0.28 * extent_m[0].min(extent_m[1])).clamp(20.0, 150.0);
    let eye = target + distance_m * Vec3::new(-sin, 0.55, cos);
    EyeControls3D::new().with_position(eye.to_array()).with_look_target(target.to_array()).with_eye_up([0.0, 1.0, 0.0])
}

/// Writes and numbers the views and containers of a layout.
struct Layout {
    stream: RecordingStream,
    next: u128,
    /// Camera of the views in space.
    eye: EyeControls3D,
}

/// Number of columns of a tab's grid.
const COLUMNS: u32 = 5;

impl Layout {
    fn tab(&mut self, tab: &Tab) -> RecordingStreamResult<IncludedContent> {
        let (mut large, mut small) = (Vec::new(), Vec::new());
        for (views, contents) in [(tab.large, &mut large), (tab.small, &mut small)] {
            for view in views {
                contents.extend(self.views(view)?);
            }
        }
        let columns = COLUMNS.min(small.len() as u32);
        let (_, top) = self.container(ContainerKind::Horizontal, large, |top| top)?;
        let (_, bottom) = self.container(ContainerKind::Grid, small, |grid| grid.with_grid_columns(columns))?;
        let named = |tab_of: ContainerBlueprint| tab_of.with_display_name(tab.name).with_row_shares([1.6, 1.0]);
        Ok(self.container(ContainerKind::Vertical, [top, bottom], named)?.1)
    }

    /// The view, or the views of all plots.
    fn views(&mut self, view: &View) -> RecordingStreamResult<Vec<IncludedContent>> {
        let one = match view {
            View::Space { title, entities } => {
                let eye = self.eye.clone();
                let background = Background::new(BackgroundKind::SolidColor).with_color([27, 34, 46]);
                let grid = LineGrid3D::new().with_visible(false);
                let properties: [(&str, &dyn AsComponents); 3] =
                    [("EyeControls3D", &eye), ("Background", &background), ("LineGrid3D", &grid)];
                self.view("3D", title, Entity::World.path(), &contents(entities), &properties)
            }
            // The origin is above the classes of segmentation images.
            View::Image { title, entities } => {
                let origin = entities[0].path().split('/').next().unwrap_or_default();
                self.view("2D", title, origin, &contents(entities), &[])
            }
            View::Slice { title, entity, slice } => {
                self.view("Tensor", title, entity.path(), &contents(&[*entity]), &[("TensorSliceSelection", &selection(slice))])
            }
            View::Text { title, entity } => self.view("TextLog", title, entity.path(), &contents(&[*entity]), &[]),
            View::Plot(folder) => return plot(folder).into_iter().map(|plot| self.plot(plot)).collect(),
            View::Plots => return PLOTS.iter().map(|plot| self.plot(plot)).collect(),
        };
        Ok(vec![one?])
    }

    fn plot(&mut self, plot: &Plot) -> RecordingStreamResult<IncludedContent> {
        let curves: Vec<_> = plot.curves.iter().map(|curve| format!("+ /{}", plot.entity(curve))).collect();
        let legend = PlotLegend::new().with_corner(Corner2D::LeftTop).with_visible(plot.curves.len() > 1);
        self.view("TimeSeries", plot.title, Entity::Metrics.path(), &curves, &[("PlotLegend", &legend)])
    }

    fn view(
        &mut self,
        class: &str,
        name: &str,
        origin: &str,
        contents: &[String],
        properties: &[(&str, &dyn AsComponents)],
    ) -> RecordingStreamResult<IncludedContent> {
        let (_, path) = self.path("view");
        self.stream.log(format!("{path}/ViewContents"), &ViewContents::new(contents.iter().map(String::as_str)))?;
        self.stream.log(path.as_str(), &ViewBlueprint::new(class).with_display_name(name).with_space_origin(origin))?;
        for (property, archetype) in properties {
            self.stream.log(format!("{path}/{property}"), *archetype)?;
        }
        Ok(path.as_str().into())
    }

    fn container(
        &mut self,
        kind: ContainerKind,
        contents: impl IntoIterator<Item = IncludedContent>,
        with: impl FnOnce(ContainerBlueprint) -> ContainerBlueprint,
    ) -> RecordingStreamResult<(RootContainer, IncludedContent)> {
        let (id, path) = self.path("container");
        self.stream.log(path.as_str(), &with(ContainerBlueprint::new(kind).with_contents(contents)))?;
        Ok((RootContainer(id), path.as_str().into()))
    }

    /// The next number as a UUID, and the entity named after it.
    fn path(&mut self, kind: &str) -> (Uuid, String) {
        let id = self.next;
        self.next += 1;
        let hex = format!("{id:032x}");
        let dashed = [&hex[..8], &hex[8..12], &hex[12..16], &hex[16..20], &hex[20..]].join("-");
        (Uuid { bytes: id.to_be_bytes() }, format!("{kind}/{dashed}"))
    }
}

/// The expression of a view's contents.
fn contents(entities: &[Entity]) -> Vec<String> {
    entities.iter().map(|entity| format!("+ /{}", entity.path())).collect()
}

fn selection(slice: &Slice) -> TensorSliceSelection {
    let [width, height] = slice.across;
    let indices = slice.at.iter().map(|&(dimension, index)| TensorDimensionIndexSelection { dimension, index });
    TensorSliceSelection::new().with_width(width).with_height(height).with_indices(indices)
}
