//! The first view: the land with the wind over it, the map of bends beside it, the scalars below.

use glam::Vec3;
use rerun::blueprint::components::{BackgroundKind, ContainerKind, Corner2D, IncludedContent, PanelState, PlayState, RootContainer};
use rerun::external::re_log_types::BlueprintActivationCommand;
use rerun::external::re_sdk_types::blueprint::archetypes::{
    Background, ContainerBlueprint, EyeControls3D, LineGrid3D, PanelBlueprint, PlotLegend, TimePanelBlueprint, ViewBlueprint, ViewContents,
    ViewportBlueprint,
};
use rerun::external::re_sdk_types::datatypes::Uuid;
use rerun::log::LogMsg;
use rerun::{AsComponents, RecordingStream, RecordingStreamBuilder, RecordingStreamResult};
use shared::scene::Scene;
use shared::terrain::HeightMap;

/// A layout of the viewer, ready to be sent.
pub(super) struct FirstView {
    messages: Vec<LogMsg>,
}

impl FirstView {
    /// Makes it the active layout of a recording.
    pub(super) fn send(self, stream: &RecordingStream) {
        if let Some(blueprint_id) = self.messages.first().map(|message| message.store_id().clone()) {
            stream.send_blueprint(self.messages, BlueprintActivationCommand { blueprint_id, make_active: true, make_default: true });
        }
    }
}

/// The layout for a scene; its camera looks at the place where a visitor starts.
pub(super) fn first_view(scene: &Scene, heights: &HeightMap) -> RecordingStreamResult<FirstView> {
    let (stream, storage) = RecordingStreamBuilder::new(super::recording::APPLICATION).blueprint().memory()?;
    stream.set_time_sequence("blueprint", 0);
    let mut layout = Layout { stream, next: 1 };

    let land = layout.view(
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
    let plots = [
        ("Duration of a step (ms)", "health/step/**"),
        ("Divergence of the wind (1/s)", "health/wind/divergence"),
        ("Kinetic energy of the wind (J/kg)", "health/wind/energy"),
        ("Energy of the bend field", "health/bend/energy"),
        ("Awake patches", "health/bend/awake_patches"),
        ("Laid tiles, broken plants", "health/bend/laid_tiles health/bend/broken_plants"),
        ("Sub-steps, Courant number", "health/steps/**"),
        ("Clients, objects", "health/net/**"),
        ("Lost: log frames, patches, winds", "health/lost/**"),
        ("Sent to clients (kB/s)", "health/sent/kbyte_per_s"),
    ];
    let mut plot_views = Vec::new();
    for (name, entities) in plots {
        let contents: Vec<String> = entities.split(' ').map(|entity| format!("+ /{entity}")).collect();
        let contents: Vec<&str> = contents.iter().map(String::as_str).collect();
        let several = entities.contains(['*', ' ']);
        let legend = PlotLegend::new().with_corner(Corner2D::LeftTop).with_visible(several);
        plot_views.push(layout.view("TimeSeries", name, "health", &contents, &[("PlotLegend", &legend)])?);
    }

    let (_, top) = layout.container(ContainerKind::Horizontal, [land, map], |top| top.with_col_shares([1.9, 1.0]))?;
    let (_, bottom) = layout.container(ContainerKind::Grid, plot_views, |grid| grid.with_grid_columns(5))?;
    let (root, _) = layout.container(ContainerKind::Vertical, [top, bottom], |root| root.with_row_shares([2.2, 1.0]))?;

    let viewport = ViewportBlueprint::new().with_root_container(root).with_auto_layout(false).with_auto_views(false);
    layout.stream.log("viewport", &viewport)?;
    for panel in ["blueprint_panel", "selection_panel"] {
        layout.stream.log(panel, &PanelBlueprint::new().with_state(PanelState::Collapsed))?;
    }
    let time = TimePanelBlueprint::new().with_state(PanelState::Collapsed).with_timeline("sim_time").with_play_state(PlayState::Following);
    layout.stream.log("time_panel", &time)?;
    Ok(FirstView { messages: storage.take() })
}

/// Looks down on the visitors' start from behind it, far enough back to hold a good part of the world.
fn eye(scene: &Scene, heights: &HeightMap) -> EyeControls3D {
    let extent_m = scene.extent_m();
    let [x, z] = [0, 1].map(|axis| scene.camera.at[axis] * extent_m[axis]);
    let target = Vec3::new(x, heights.height_m(x, z), z);
    let (sin, cos) = scene.camera.heading_rad.sin_cos();
    let distance_m = (0.28 * extent_m[0].min(extent_m[1])).clamp(20.0, 150.0);
    let eye = target + distance_m * Vec3::new(-sin, 0.55, cos);
    EyeControls3D::new().with_position(eye.to_array()).with_look_target(target.to_array()).with_eye_up([0.0, 1.0, 0.0])
}

/// Writes the views and containers of a layout, numbering them.
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

    /// The next number as a UUID, and the entity that it names.
    fn path(&mut self, kind: &str) -> (Uuid, String) {
        let id = self.next;
        self.next += 1;
        let hex = format!("{id:032x}");
        let dashed = [&hex[..8], &hex[8..12], &hex[12..16], &hex[16..20], &hex[20..]].join("-");
        (Uuid { bytes: id.to_be_bytes() }, format!("{kind}/{dashed}"))
    }
}
