//! The initial layout of the viewer: terrain with wind arrows, the map of bending angles beside it, plots below.

use super::connect::APPLICATION;
use super::plots::PLOTS;
use glam::Vec3;
use prairie_core::scene::Scene;
use prairie_core::terrain::HeightMap;
use rerun::blueprint::components::{BackgroundKind, ContainerKind, Corner2D, IncludedContent, PanelState, PlayState, RootContainer};
use rerun::external::re_log_types::BlueprintActivationCommand;
use rerun::external::re_sdk_types::blueprint::archetypes::{
    Background, ContainerBlueprint, EyeControls3D, LineGrid3D, PanelBlueprint, PlotLegend, TimePanelBlueprint, ViewBlueprint, ViewContents,
    ViewportBlueprint,
};
use rerun::external::re_sdk_types::datatypes::Uuid;
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
    let mut layout = Layout { stream, next: 1 };

    let terrain = layout.view(
        "3D",
        "Wind and grass",
        "world",
        &["$origin/**"],
        &[
            ("EyeControls3D", &eye(scene, heights)),
            ("Background", &Background::new(BackgroundKind::SolidColor).with_color([27, 34, 46])),
            ("LineGrid3D", &LineGrid3D::new().with_visible(false)),
        ],
    )?;
    let map = layout.view("2D", "Bending angle, from above", "map", &["$origin/**"], &[])?;
    let mut plot_views = Vec::new();
    for plot in PLOTS {
        let contents: Vec<String> = plot.curves.iter().map(|curve| format!("+ /{}", plot.entity(curve))).collect();
        let contents: Vec<&str> = contents.iter().map(String::as_str).collect();
        let legend = PlotLegend::new().with_corner(Corner2D::LeftTop).with_visible(plot.curves.len() > 1);
        plot_views.push(layout.view("TimeSeries", plot.title, "metrics", &contents, &[("PlotLegend", &legend)])?);
    }

    plot_views.push(layout.view("TextLog", "Decisions about the detail", "decisions", &["$origin/**"], &[])?);
    let (_, top) = layout.container(ContainerKind::Horizontal, [terrain, map], |top| top.with_col_shares([1.9, 1.0]))?;
    let (_, bottom) = layout.container(ContainerKind::Grid, plot_views, |grid| grid.with_grid_columns(5))?;
    let (root, _) = layout.container(ContainerKind::Vertical, [top, bottom], |root| root.with_row_shares([2.2, 1.0]))?;

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
}

impl Layout {
    fn view(
        &mut self,
        class: &str,
        name: &str,
        origin: &str,
        contents: &[&str],
        properties: &[(&str, &dyn AsComponents)],
    ) -> RecordingStreamResult<IncludedContent> {
        let (_, path) = self.path("view");
        self.stream.log(format!("{path}/ViewContents"), &ViewContents::new(contents.iter().copied()))?;
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
