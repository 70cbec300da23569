//! What is logged, and under which names.
//!
//! | entity | what |
//! | --- | --- |
//! | `world/ground` | the land (static), with the bending angles laid on it as a texture |
//! | `world/wind` | wind arrows: length the way of the air in 1.2 s, colour the speed |
//! | `world/objects`, `world/trails` | boxes with poses and labels; the ways they came |
//! | `map/bend`, `map/objects`, `map/scale` | the bending angles from above, one class a code; the objects' places; the colours |
//! | `health/…` | scalars |

use super::arrows::WindArrows;
use super::ground::{BendMap, GroundMesh, degrees};
use super::palette::bend_rgb;
use super::trails::{Trails, kind_rgb};
use super::{Frame, InspectError, Sink, Target, blueprint};
use crate::bend::air::GroundWind;
use crate::snapshot::Snapshot;
use rerun::components::{FillMode, ImageFormat};
use rerun::datatypes::ChannelDatatype;
use rerun::external::re_uri::ProxyUri;
use rerun::{
    AnnotationContext, Arrows3D, AsComponents, Boxes3D, LineStrips2D, LineStrips3D, MemoryLimit, Mesh3D, Points2D, Quaternion, Radius,
    RecordingStream, RecordingStreamBuilder, Rgba32, Scalars, SegmentationImage, SeriesLines, ServerOptions, ViewCoordinates,
};
use shared::grid::PatchLayout;
use shared::scene::Scene;
use shared::terrain::{CoverMap, HeightMap, KindMap};
use shared::wire::ObjectPose;
use std::fmt::Display;
use std::net::{TcpListener, TcpStream, ToSocketAddrs};
use std::time::Duration;

/// Name of the program in the viewer's list of recordings.
pub(super) const APPLICATION: &str = "prairie";

/// History that is kept for viewers that connect later (bytes).
const HISTORY_LIMIT_BYTES: u64 = 256 << 20;

/// Radius of a wind arrow's shaft (m).
const ARROW_RADIUS_M: f32 = 0.16;

/// How long a viewer may take to answer at the start, and to take the last frames at the end.
const VIEWER_LIMIT: Duration = Duration::from_secs(2);

/// Steps of the bar that explains the colours of angles.
const SCALE_STEPS: usize = 9;

/// Scalars: entity, name in the plots, colour, and how to read it.
#[expect(clippy::type_complexity, reason = "a table reads best as one literal")]
const SCALARS: [(&str, &str, u32, fn(&Frame) -> f64); 19] = [
    ("health/step/mean_ms", "mean", 0x4CAF_50FF, |frame| f64::from(frame.snapshot.health.step_secs) * 1e3),
    ("health/step/longest_ms", "longest", 0xFF70_43FF, |frame| f64::from(frame.snapshot.health.step_max_secs) * 1e3),
    ("health/wind/divergence", "rms divergence", 0x29B6_F6FF, |frame| f64::from(frame.snapshot.health.divergence_rms)),
    ("health/wind/energy", "wind", 0x29B6_F6FF, |frame| frame.snapshot.health.wind_energy),
    ("health/bend/energy", "bend", 0xFFCA_28FF, |frame| frame.snapshot.health.bend_energy),
    ("health/bend/awake_patches", "awake patches", 0xFFCA_28FF, |frame| f64::from(frame.snapshot.health.awake_patches)),
    ("health/bend/laid_tiles", "laid tiles", 0x8D6E_63FF, |frame| f64::from(frame.snapshot.health.laid_tiles)),
    ("health/bend/broken_plants", "broken plants", 0xEF53_50FF, |frame| frame.snapshot.broken.len() as f64),
    ("health/steps/substeps", "sub-steps", 0xAB47_BCFF, |frame| f64::from(frame.snapshot.health.substeps)),
    ("health/steps/courant", "Courant number", 0xEC40_7AFF, |frame| f64::from(frame.snapshot.health.courant)),
    ("health/net/clients", "clients", 0x26A6_9AFF, |frame| f64::from(frame.traffic.clients)),
    ("health/net/objects", "objects", 0xFF70_43FF, |frame| frame.snapshot.objects.len() as f64),
    ("health/sent/kbyte_per_s", "sent", 0x26A6_9AFF, |frame| frame.traffic.bytes_per_s / 1e3),
    ("health/lost/log_frames", "log frames", 0xBDBD_BDFF, |frame| frame.dropped as f64),
    ("health/lost/evicted_patches", "evicted patches", 0xFFCA_28FF, |frame| frame.snapshot.health.evicted_patches as f64),
    ("health/lost/broken_patches", "broken patches", 0xAB47_BCFF, |frame| frame.snapshot.health.broken_patches as f64),
    ("health/lost/tracks", "tracks let go", 0x8D6E_63FF, |frame| frame.snapshot.health.dropped_tracks as f64),
    ("health/lost/motions", "motions refused", 0xEF53_50FF, |frame| frame.snapshot.health.refused_motions as f64),
    ("health/lost/winds", "winds begun anew", 0x29B6_F6FF, |frame| frame.snapshot.health.wind_resets as f64),
];

/// One recording, open.
pub(super) struct Recording {
    stream: RecordingStream,
    address: String,
    to_file: bool,
    map: BendMap,
    arrows: WindArrows,
    wind_tick: Option<u64>,
    trails: Trails,
}

impl Recording {
    /// Opens the target and logs what stays as it is.
    pub(super) fn open(target: &Target, scene: &Scene, heights: &HeightMap, cover: &CoverMap) -> Result<Self, InspectError> {
        let (stream, address) = open_stream(target)?;
        blueprint::first_view(scene, heights).map_err(sdk)?.send(&stream);
        let layout = PatchLayout::from(&scene.patches);
        let recording = Self {
            stream,
            address,
            to_file: matches!(target, Target::Save(_)),
            map: BendMap::new(layout, GroundWind::still(scene).over(KindMap::new(scene, cover)), scene.tick_hz as u64),
            arrows: WindArrows::new(scene, heights),
            wind_tick: None,
            trails: Trails::default(),
        };
        recording.write_static(&GroundMesh::new(&layout, heights, &scene.light))?;
        Ok(recording)
    }

    /// Where it goes; for a served one, what a viewer connects to.
    pub(super) fn address(&self) -> String {
        self.address.clone()
    }

    fn write_static(&self, mesh: &GroundMesh) -> Result<(), InspectError> {
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
        for (entity, name, rgba, _) in SCALARS {
            keep(entity, &SeriesLines::new().with_names([name]).with_colors([rgba]).with_widths([1.5]))?;
        }
        Ok(())
    }

    /// The colours of the angles as a bar above the map.
    fn scale(&self) -> LineStrips2D {
        let width_px = self.map.size_px()[0] as f32;
        let radius_px = 0.015 * width_px;
        let step_px = (width_px - 2.0 * radius_px) / SCALE_STEPS as f32;
        let place = |i: usize| [radius_px + i as f32 * step_px, -2.0 * radius_px];
        let bars = (0..SCALE_STEPS).map(|i| [place(i), place(i + 1)]);
        let middle_degrees: Vec<_> = (0..SCALE_STEPS).map(|i| 90.0 * (i as f32 + 0.5) / SCALE_STEPS as f32).collect();
        LineStrips2D::new(bars)
            .with_colors(middle_degrees.iter().map(|&at| Rgba32::from(bend_rgb(at))))
            .with_labels(middle_degrees.iter().map(|at| format!("{at:.0}°")))
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

    fn write_objects(&mut self, snapshot: &Snapshot) -> Result<(), InspectError> {
        let objects = &snapshot.objects;
        let colours = || objects.iter().map(|object| Rgba32::from(kind_rgb(object.kind)));
        let boxes = Boxes3D::from_centers_and_half_sizes(
            objects.iter().map(|object| object.position_m),
            objects.iter().map(|object| object.kind.half_extents_m()),
        );
        let boxes = boxes
            .with_quaternions(objects.iter().map(|object| Quaternion::from_xyzw(object.rotation)))
            .with_fill_mode(FillMode::TransparentFillMajorWireframe);
        self.log(
            "world/objects",
            &boxes.with_colors(colours()).with_labels(objects.iter().map(label)).with_radii([Radius::new_ui_points(1.0)]),
        )?;

        self.trails.update(objects);
        let (strips, trail_colours) = self.trails.strips();
        let trails = LineStrips3D::new(strips).with_colors(trail_colours.into_iter().map(Rgba32::from));
        self.log("world/trails", &trails.with_radii([Radius::new_ui_points(1.0)]))?;

        let pixel_m = self.map.pixel_m();
        let places = objects.iter().map(|object| [object.position_m[0] / pixel_m, object.position_m[2] / pixel_m]);
        self.log("map/objects", &Points2D::new(places).with_colors(colours()).with_radii([Radius::new_ui_points(4.0)]))
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
        SCALARS.iter().try_for_each(|(entity, _, _, read)| self.log(entity, &Scalars::single(read(frame))))
    }

    /// A file is written to its footer, without which it does not verify; a viewer gets a moment to take what is left.
    fn finish(self) -> Result<(), InspectError> {
        if self.to_file {
            self.stream.flush_blocking().map_err(sdk)?;
            self.stream.disconnect();
            return Ok(());
        }
        self.stream.flush_with_timeout(VIEWER_LIMIT).map_err(sdk)
    }
}

/// "car 3, 14 m/s".
fn label(object: &ObjectPose) -> String {
    let speed_m_per_s = object.velocity_m_per_s.iter().map(|v| v * v).sum::<f32>().sqrt();
    format!("{} {}, {speed_m_per_s:.0} m/s", object.kind.name(), object.id)
}

fn sdk(error: impl Display) -> InspectError {
    InspectError::Sdk(error.to_string())
}

/// Opens the stream, and says where it goes. The SDK itself tells of a taken port or an absent viewer only late, if at all, so
/// both are tried first.
fn open_stream(target: &Target) -> Result<(RecordingStream, String), InspectError> {
    let builder = RecordingStreamBuilder::new(APPLICATION);
    let (stream, address) = match target {
        Target::Serve(addr) => {
            let taken = |reason| InspectError::Address { addr: *addr, reason };
            let free = TcpListener::bind(addr).and_then(|listener| listener.local_addr()).map_err(taken)?;
            let options = ServerOptions { memory_limit: MemoryLimit::from_bytes(HISTORY_LIMIT_BYTES), ..ServerOptions::default() };
            let ip = if free.is_ipv6() { format!("[{}]", free.ip()) } else { free.ip().to_string() };
            (builder.serve_grpc_opts(ip, free.port(), options), format!("rerun+http://{free}/proxy"))
        }
        Target::Save(path) => {
            std::fs::File::create(path).map_err(|reason| InspectError::File { path: path.clone(), reason })?;
            (builder.save(path), path.display().to_string())
        }
        Target::Connect(url) => {
            let uri: ProxyUri = url.parse().map_err(sdk)?;
            knock(&uri).map_err(|reason| InspectError::NoViewer { url: url.clone(), reason })?;
            (builder.connect_grpc_opts(url.as_str()), url.clone())
        }
    };
    let stream = stream.map_err(sdk)?;
    stream.set_log_time_enabled(false);
    Ok((stream, address))
}

/// Whether anything listens at the address of a viewer.
fn knock(uri: &ProxyUri) -> std::io::Result<()> {
    let mut last = std::io::Error::other("the name has no address");
    for addr in (uri.origin.host.to_string(), uri.origin.port).to_socket_addrs()? {
        match TcpStream::connect_timeout(&addr, VIEWER_LIMIT) {
            Ok(_) => return Ok(()),
            Err(error) => last = error,
        }
    }
    Err(last)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inspect::Inspector;
    use crate::snapshot::{PatchCodes, WindFrame};
    use rerun::external::re_log_encoding::DecoderApp;
    use rerun::log::{Chunk, LogMsg};
    use shared::scene::VehicleKind;
    use shared::terrain::grey_png;
    use shared::wire::quantise::wind_code;
    use std::collections::BTreeMap;
    use std::fs::File;
    use std::io::BufReader;
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

    fn driven(tick: u64) -> Snapshot {
        let car = ObjectPose {
            id: 7,
            kind: VehicleKind::Car,
            position_m: [40.0 + tick as f32, 4.0, 50.0],
            rotation: [0.0, 0.0, 0.0, 1.0],
            velocity_m_per_s: [60.0, 0.0, 0.0],
            part_rad: 0.0,
        };
        let patches = Arc::new([(tick as u32 % 256, Arc::new(PatchCodes { tick, codes: vec![50; 3 * 64 * 64] }))].into());
        let wind = Arc::new(WindFrame { tick, cells: [32, 8, 32], codes: vec![wind_code(3.0); 3 * 32 * 8 * 32] });
        Snapshot { tick, time_secs: tick as f64 / 60.0, objects: vec![car], wind, patches, ..Snapshot::default() }
    }

    #[test]
    fn a_file_is_whole_and_holds_every_entity() {
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
        for entity in in_each_frame.into_iter().map(str::to_owned).chain(SCALARS.map(|(entity, ..)| format!("/{entity}"))) {
            assert_eq!(rows.get(&entity), Some(&kept), "{entity} in {rows:?}");
        }
        std::fs::remove_file(path).unwrap();
    }

    #[test]
    fn a_taken_port_is_an_error() {
        let taken = TcpListener::bind("127.0.0.1:0").unwrap();
        let addr = taken.local_addr().unwrap();
        let error = open(&Target::Serve(addr)).err().unwrap();
        assert!(matches!(error, InspectError::Address { .. }));
        assert!(error.to_string().contains(&addr.to_string()), "{error}");
    }

    #[test]
    fn a_served_recording_says_where_it_is() {
        let inspector = open(&"serve=0".parse().unwrap()).unwrap();
        let addr = inspector.target().strip_prefix("rerun+http://").and_then(|rest| rest.strip_suffix("/proxy")).unwrap();
        assert!(addr.starts_with("127.0.0.1:") && !addr.ends_with(":0"), "{addr}");
        inspector.observe(&driven(0));
        inspector.finish().unwrap();
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
