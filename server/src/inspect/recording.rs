//! The logged entities.
//!
//! | entity | data |
//! | --- | --- |
//! | `world/ground` | terrain mesh (static), textured with the bending angles |
//! | `world/wind` | wind arrows: the length is the distance covered in 1.2 s, the colour is the speed |
//! | `world/objects`, `world/trails` | boxes with poses and labels; trails of the last seconds |
//! | `map/bend`, `map/objects`, `map/scale` | bending angles from above, one class per code; positions of the objects; colour scale |
//! | `decisions` | changes of the detail of the simulation, each with its reason |
//! | `metrics/…` | the metrics of [`PLOTS`](super::plots::PLOTS) |

use super::arrows::WindArrows;
use super::bend_map::{BendMap, degrees};
use super::blueprint;
use super::connect::{VIEWER_TIMEOUT, open_stream, sdk};
use super::error::InspectError;
use super::palette::bend_rgb;
use super::plots::PLOTS;
use super::sink::{Frame, Sink};
use super::target::Target;
use super::terrain_mesh::TerrainMesh;
use super::trails::Trails;
use crate::snapshot::Snapshot;
use prairie_core::grid::PatchLayout;
use prairie_core::scene::{Objects, Scene};
use prairie_core::terrain::{CoverMap, HeightMap, KindMap};
use prairie_core::wind::WindField;
use prairie_core::wire::ObjectPose;
use prairie_vehicles::trail_rgb;
use rerun::components::{FillMode, ImageFormat};
use rerun::datatypes::ChannelDatatype;
use rerun::external::re_log_encoding::{Decodable as _, StreamFooter};
use rerun::{
    AnnotationContext, Arrows3D, AsComponents, Boxes3D, LineStrips2D, LineStrips3D, Mesh3D, Points2D, Quaternion, Radius, RecordingStream,
    Rgba32, Scalars, SegmentationImage, SeriesLines, TextLog, TextLogLevel, ViewCoordinates,
};
use std::fs::File;
use std::io::{Read as _, Seek as _, SeekFrom};
use std::path::Path;
use std::sync::Arc;

/// Radius of a wind arrow's shaft (m).
const ARROW_RADIUS_M: f32 = 0.16;

/// Number of steps in the colour scale of the angles.
const SCALE_STEPS: usize = 9;

/// An open recording.
pub(super) struct Recording {
    stream: RecordingStream,
    address: String,
    to_file: bool,
    map: BendMap,
    arrows: WindArrows,
    settings: Objects,
    wind_tick: Option<u64>,
    trails: Trails,
    /// Number of decisions about the detail so far; `None` before the first frame.
    decisions: Option<u64>,
}

impl Recording {
    /// Opens the target and logs the static data.
    pub(super) fn open(target: &Target, scene: &Scene, heights: &HeightMap, cover: &CoverMap) -> Result<Self, InspectError> {
        let (stream, address) = open_stream(target)?;
        blueprint::initial_layout(scene, heights).map_err(sdk)?.send(&stream);
        let layout = PatchLayout::from(&scene.patches);
        let recording = Self {
            stream,
            address,
            to_file: matches!(target, Target::Save(_)),
            map: BendMap::new(layout, WindField::still(scene, Arc::new(KindMap::new(scene, cover))), scene.tick_hz as u64),
            arrows: WindArrows::new(scene, heights),
            settings: scene.objects.clone(),
            wind_tick: None,
            trails: Trails::default(),
            decisions: None,
        };
        recording.write_static(&TerrainMesh::new(&layout, heights, &scene.light))?;
        Ok(recording)
    }

    /// Path of the file, or URL for viewers.
    pub(super) fn address(&self) -> String {
        self.address.clone()
    }

    fn write_static(&self, mesh: &TerrainMesh) -> Result<(), InspectError> {
        let keep = |entity: &str, what: &dyn AsComponents| self.stream.log_static(entity, what).map_err(sdk);
        keep("world", &ViewCoordinates::RIGHT_HAND_Y_UP())?;
        let ground = Mesh3D::new(&mesh.positions_m)
            .with_triangle_indices(&mesh.triangles)
            .with_vertex_colors(mesh.shades.iter().copied().map(Rgba32::from))
            .with_vertex_texcoords(&mesh.texcoords)
            .with_albedo_texture_format(ImageFormat::rgb8(self.map.size_px()));
        keep("world/ground", &ground)?;
        let names: Vec<_> =
            (0..=127).map(|code| (u16::from(code), format!("{:.0}°", degrees(code)), Rgba32::from(bend_rgb(degrees(code))))).collect();
        keep("map", &AnnotationContext::new(names.iter().map(|(code, name, rgb)| (*code, name.as_str(), *rgb))))?;
        keep("map/scale", &self.scale())?;
        let series = PLOTS.iter().flat_map(|plot| plot.curves.iter().map(|curve| (plot.entity(curve), curve)));
        series.into_iter().try_for_each(|(entity, curve)| {
            keep(&entity, &SeriesLines::new().with_names([curve.label]).with_colors([curve.rgba]).with_widths([1.5]))
        })
    }

    /// The colour scale of the angles, a bar above the map.
    fn scale(&self) -> LineStrips2D {
        let width_px = self.map.size_px()[0] as f32;
        let radius_px = 0.015 * width_px;
        let step_px = (width_px - 2.0 * radius_px) / SCALE_STEPS as f32;
        let place = |i: usize| [radius_px + i as f32 * step_px, -2.0 * radius_px];
        let bars = (0..SCALE_STEPS).map(|i| [place(i), place(i + 1)]);
        let middles_deg: Vec<_> = (0..SCALE_STEPS).map(|i| 90.0 * (i as f32 + 0.5) / SCALE_STEPS as f32).collect();
        LineStrips2D::new(bars)
            .with_colors(middles_deg.iter().map(|&at| Rgba32::from(bend_rgb(at))))
            .with_labels(middles_deg.iter().map(|at| format!("{at:.0}°")))
            .with_radii([radius_px])
    }

    fn log(&self, entity: &str, what: &dyn AsComponents) -> Result<(), InspectError> {
        self.stream.log(entity, what).map_err(sdk)
    }

    fn write_bends(&self) -> Result<(), InspectError> {
        self.log("world/ground", &Mesh3D::update_fields().with_albedo_texture_buffer(self.map.rgb()))?;
        let format = ImageFormat::segmentation(self.map.size_px(), ChannelDatatype::U8);
        self.log("map/bend", &SegmentationImage::new(self.map.codes().to_vec(), format).with_opacity(1.0))
    }

    /// The decisions since the last frame; those from before the recording are left out.
    fn write_decisions(&mut self, snapshot: &Snapshot) -> Result<(), InspectError> {
        let count = snapshot.diagnostics.decisions;
        let before = self.decisions.replace(count).unwrap_or(count);
        let new = count.saturating_sub(before).min(snapshot.decisions.len() as u64) as usize;
        for decision in &snapshot.decisions[snapshot.decisions.len() - new..] {
            let text = format!("{}: {}", decision.reason, decision.detail);
            self.log("decisions", &TextLog::new(text).with_level(TextLogLevel::INFO))?;
        }
        Ok(())
    }

    fn write_objects(&mut self, snapshot: &Snapshot) -> Result<(), InspectError> {
        let objects = &snapshot.objects;
        self.log("world/objects", &boxes(objects, &self.settings))?;

        self.trails.update(objects);
        let (strips, trail_colours) = self.trails.strips();
        let trails = LineStrips3D::new(strips).with_colors(trail_colours.into_iter().map(Rgba32::from));
        self.log("world/trails", &trails.with_radii([Radius::new_ui_points(1.0)]))?;

        let pixel_m = self.map.pixel_m();
        let places = objects.iter().map(|object| [object.position_m[0] / pixel_m, object.position_m[2] / pixel_m]);
        self.log("map/objects", &Points2D::new(places).with_colors(colours(objects)).with_radii([Radius::new_ui_points(4.0)]))
    }
}

impl Sink for Recording {
    fn write(&mut self, frame: &Frame) -> Result<(), InspectError> {
        let snapshot = &frame.snapshot;
        let readable_secs = (snapshot.time_secs * 1e4).round() / 1e4;
        self.stream.set_duration_secs("sim_time", readable_secs);
        self.stream.set_time_sequence("tick", i64::try_from(snapshot.tick).unwrap_or(i64::MAX));
        if self.map.update(&snapshot.wind, &snapshot.patches) {
            self.write_bends()?;
        }
        if self.wind_tick.replace(snapshot.wind.tick) != Some(snapshot.wind.tick) {
            let (origins_m, vectors_m, colours) = self.arrows.of(&snapshot.wind);
            let arrows = Arrows3D::from_vectors(vectors_m).with_origins(origins_m);
            self.log("world/wind", &arrows.with_colors(colours.into_iter().map(Rgba32::from)).with_radii([ARROW_RADIUS_M]))?;
        }
        self.write_objects(snapshot)?;
        self.write_decisions(snapshot)?;
        let series = PLOTS.iter().flat_map(|plot| plot.curves.iter().map(move |curve| (plot, curve)));
        series.into_iter().try_for_each(|(plot, curve)| self.log(&plot.entity(curve), &Scalars::single(plot.scale * curve.value(frame))))
    }

    /// Completes a file with its footer, without which it fails verification; gives a viewer a moment to receive the last frames.
    fn finish(self) -> Result<(), InspectError> {
        if self.to_file {
            self.stream.flush_blocking().map_err(sdk)?;
            self.stream.disconnect();
            return check_footer(Path::new(&self.address));
        }
        self.stream.flush_with_timeout(VIEWER_TIMEOUT).map_err(sdk)
    }
}

/// Checks that a file has its footer. If the SDK cannot write it, it only logs that. A pipe cannot be read again.
fn check_footer(path: &Path) -> Result<(), InspectError> {
    let unreadable = |reason| InspectError::File { path: path.to_owned(), reason };
    if !std::fs::metadata(path).map_err(unreadable)?.is_file() {
        return Ok(());
    }
    let mut file = File::open(path).map_err(unreadable)?;
    let length = StreamFooter::ENCODED_SIZE_BYTES as u64;
    let bytes = file.metadata().map_err(unreadable)?.len();
    let mut footer = [0; StreamFooter::ENCODED_SIZE_BYTES];
    file.seek(SeekFrom::Start(bytes.saturating_sub(length))).and_then(|_| file.read_exact(&mut footer)).map_err(unreadable)?;
    StreamFooter::from_rrd_bytes(&footer).map(drop).map_err(|_| InspectError::NoFooter { path: path.to_owned() })
}

/// The boxes of the objects, in the dimensions that the scene gives them.
fn boxes(objects: &[ObjectPose], settings: &Objects) -> Boxes3D {
    let half_extents_m = objects.iter().map(|object| settings.half_extents_m(object.kind));
    Boxes3D::from_centers_and_half_sizes(objects.iter().map(|object| object.position_m), half_extents_m)
        .with_quaternions(objects.iter().map(|object| Quaternion::from_xyzw(object.rotation)))
        .with_fill_mode(FillMode::TransparentFillMajorWireframe)
        .with_colors(colours(objects))
        .with_labels(objects.iter().map(label))
        .with_radii([Radius::new_ui_points(1.0)])
}

fn colours(objects: &[ObjectPose]) -> impl Iterator<Item = Rgba32> {
    objects.iter().map(|object| Rgba32::from(trail_rgb(object.kind)))
}

/// "car 3, 14 m/s".
fn label(object: &ObjectPose) -> String {
    let speed_m_per_s = object.velocity_m_per_s.iter().map(|v| v * v).sum::<f32>().sqrt();
    format!("{} {}, {speed_m_per_s:.0} m/s", object.kind.name(), object.id)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detail::{Decision, Detail, Reason};
    use crate::inspect::Inspector;
    use crate::snapshot::{Diagnostics, PatchCodes, WindFrame};
    use prairie_core::scene::VehicleKind;
    use prairie_core::terrain::grey_png;
    use prairie_core::wire::TurbulenceState;
    use prairie_core::wire::quantise::CodeSteps;
    use rerun::external::re_log_encoding::DecoderApp;
    use rerun::log::{Chunk, LogMsg};
    use std::collections::BTreeMap;
    use std::io::BufReader;
    use std::net::TcpListener;
    use std::sync::Arc;

    fn scene() -> Scene {
        toml::from_str("summary = 'x'\n[terrain]\nheight_map = 'a'\ncovering_map = 'b'\npixel_m = [2.0, 2.0]\nlevel_m = 0.1\n").unwrap()
    }

    fn flat() -> HeightMap {
        HeightMap::from_heights(2, 2, [256.0, 256.0], vec![3.0; 4])
    }

    fn grass() -> CoverMap {
        CoverMap::from_png(&grey_png([2; 2], &[255; 4])).unwrap()
    }

    fn open(target: &Target) -> Result<Inspector, InspectError> {
        Inspector::start(target, &scene(), &flat(), &grass())
    }

    fn pose(kind: VehicleKind, x_m: f32) -> ObjectPose {
        let (rotation, velocity_m_per_s) = ([0.0, 0.0, 0.0, 1.0], [60.0, 0.0, 0.0]);
        ObjectPose { id: 7, kind, position_m: [x_m, 4.0, 50.0], rotation, velocity_m_per_s, part_rad: 0.0 }
    }

    fn driven(tick: u64) -> Snapshot {
        let car = pose(VehicleKind::Car, 40.0 + tick as f32);
        let patches = Arc::new([(tick as u32 % 256, Arc::new(PatchCodes { tick, codes: vec![50; 3 * 64 * 64] }))].into());
        let wind = Arc::new(WindFrame {
            tick,
            cells: [32, 8, 32],
            turbulence: TurbulenceState::default(),
            codes: vec![CodeSteps::default().wind_code(3.0); 3 * 32 * 8 * 32],
        });
        let detail = Detail { wind_ticks: 3, awake_limit: 100, publish_divisor: 1 };
        let reason = Reason::Relief { busy_ms: 1.0, budget_ms: 2.0 };
        let decisions = vec![Decision { tick, detail, unloaded: detail, level: 0, reason }];
        // A decision before each frame.
        let diagnostics = Diagnostics { decisions: tick / 6 + 1, ..Diagnostics::default() };
        Snapshot { tick, time_secs: tick as f64 / 60.0, objects: vec![car], wind, patches, decisions, diagnostics, ..Snapshot::default() }
    }

    #[test]
    fn a_file_is_complete_and_contains_every_entity() {
        let path = std::env::temp_dir().join(format!("prairie-{}.rrd", std::process::id()));
        let inspector = open(&Target::Save(path.clone())).unwrap();
        for frame in 0..5 {
            inspector.observe(&driven(6 * frame));
        }
        let kept = 5 - inspector.dropped();
        inspector.finish().unwrap();

        let mut messages = DecoderApp::decode_eager(BufReader::new(File::open(&path).unwrap())).unwrap();
        let mut rows: BTreeMap<String, u64> = BTreeMap::new();
        for message in messages.by_ref() {
            if let LogMsg::ArrowMsg(store, arrow) = message.unwrap()
                && store.is_recording()
            {
                let chunk = Chunk::from_arrow_msg(&arrow).unwrap();
                if !chunk.is_static() {
                    *rows.entry(chunk.entity_path().to_string()).or_default() += chunk.num_rows() as u64;
                }
            }
        }
        assert_eq!(messages.rrd_manifests().unwrap().len(), 2, "the footer lists the blueprint and the recording");
        let in_each_frame = ["/world/ground", "/world/wind", "/world/objects", "/world/trails", "/map/bend", "/map/objects"];
        let metrics = PLOTS.iter().flat_map(|plot| plot.curves.iter().map(|curve| format!("/{}", plot.entity(curve))));
        for entity in in_each_frame.into_iter().map(str::to_owned).chain(metrics) {
            assert_eq!(rows.get(&entity), Some(&kept), "{entity} in {rows:?}");
        }
        assert_eq!(rows.get("/decisions"), Some(&(kept - 1)), "a decision from before the recording, or one is missing");
        std::fs::remove_file(path).unwrap();
    }

    #[test]
    fn a_file_without_its_footer_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.rrd");
        let inspector = open(&Target::Save(path.clone())).unwrap();
        inspector.observe(&driven(0));
        inspector.finish().unwrap();
        check_footer(&path).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        std::fs::write(&path, &bytes[..bytes.len() - 1]).unwrap();
        assert!(matches!(check_footer(&path), Err(InspectError::NoFooter { .. })));
    }

    #[test]
    fn a_port_in_use_is_an_error() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let addr = listener.local_addr().unwrap();
        let error = open(&Target::Serve(addr)).err().unwrap();
        assert!(matches!(error, InspectError::Address { .. }));
        assert!(error.to_string().contains(&addr.to_string()), "{error}");
    }

    #[test]
    fn a_served_recording_reports_its_address() {
        let inspector = open(&"serve=0".parse().unwrap()).unwrap();
        let addr = inspector.target().strip_prefix("rerun+http://").and_then(|rest| rest.strip_suffix("/proxy")).unwrap();
        assert!(addr.starts_with("127.0.0.1:") && !addr.ends_with(":0"), "{addr}");
        inspector.observe(&driven(0));
        inspector.finish().unwrap();
    }

    #[test]
    fn the_boxes_have_the_dimensions_of_the_scene() {
        let sled_outline_m = vec![[-3.0, -1.0], [0.5, -1.0], [0.0, 4.0]];
        let settings = Objects { ball_radius_m: 2.5, sled_outline_m, ..Objects::default() };
        let found = boxes(&[pose(VehicleKind::Ball, 1.0), pose(VehicleKind::Sled, 2.0)], &settings);
        let [_, half_height_m, _] = Objects::default().half_extents_m(VehicleKind::Sled);
        assert_eq!(found.half_sizes, Boxes3D::from_half_sizes([[2.5, 2.5, 2.5], [3.0, half_height_m, 4.0]]).half_sizes);
    }

    #[test]
    fn an_absent_viewer_and_a_bad_path_are_errors() {
        let free = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
        let absent = open(&format!("connect=rerun+http://{free}/proxy").parse().unwrap());
        assert!(matches!(absent.err(), Some(InspectError::NoViewer { .. })));
        let nowhere = open(&Target::Save("/no/such/folder/a.rrd".into()));
        assert!(matches!(nowhere.err(), Some(InspectError::File { .. })));
    }
}
