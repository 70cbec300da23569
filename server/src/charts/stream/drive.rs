//! Recordings of the bend field.

use std::f32::consts::TAU;

use crate::scenes;
use crate::world::{Command, World};
use anyhow::Result;
use prairie_core::bend::{Field, Kinds, Scheme};
use prairie_core::grass::{Camera, StepCodec};
use prairie_core::grid::{PatchIndex, PatchLayout};
use prairie_core::scene::VehicleKind;
use prairie_core::wire;
use prairie_core::wire::ServerMessage;

/// Cells along a side of the window: 6 patches of 64 cells.
pub(super) const WINDOW_CELLS: usize = 384;
/// Steps between two frames.
pub(super) const STEPS_PER_FRAME: u64 = 3;
/// Time before the first frame (s).
const WARM_UP_SECS: f32 = 5.0;

/// A world in which something moves in the middle.
pub(super) struct Drive {
    pub(super) title: &'static str,
    /// Built-in scene or scene file.
    pub(super) scene: &'static str,
    /// Vehicles that drive around the middle.
    pub(super) vehicles: &'static [VehicleKind],
}

/// The bend field in a window around the middle of a world, frame by frame.
pub(super) struct Recording {
    pub(super) layout: PatchLayout,
    /// Patches of the window.
    pub(super) patches: Vec<PatchIndex>,
    pub(super) frames: Vec<Frame>,
    /// Bytes of the messages with the causes of all steps, of the whole world.
    pub(super) cause_bytes: usize,
    /// The field at rest, with the grass and the limits of the world.
    pub(super) at_rest: Field,
    pub(super) scheme: Scheme,
    pub(super) dt_secs: f32,
}

/// The field of the window after a step: for each patch the planes θ, ωx and ωz, or `None` at rest.
pub(super) struct Frame {
    pub(super) patches: Vec<Option<[Vec<f32>; 3]>>,
}

impl Frame {
    fn of(field: &Field, patches: &[PatchIndex]) -> Self {
        let planes = |index: &PatchIndex| {
            let patch = field.patch(*index)?;
            Some([0, 1, 2].map(|channel| patch.rows().flat_map(|row| row[channel].iter().copied()).collect()))
        };
        Self { patches: patches.iter().map(planes).collect() }
    }
}

impl Drive {
    /// Records `secs` after a warm-up.
    pub(super) fn record(&self, secs: f32) -> Result<Recording> {
        let loaded = scenes::load(self.scene)?;
        let (scene, mut world) = (&loaded.scene, World::new(&loaded.scene, loaded.maps())?);
        let layout = PatchLayout::from(&scene.patches);
        let side = (WINDOW_CELLS / layout.cells as usize) as u32;
        let first = layout.count.map(|count| count.saturating_sub(side) / 2);
        let patches: Vec<PatchIndex> = (0..side * side).map(|n| first[0] + n % side + (first[1] + n / side) * layout.count[0]).collect();
        let middle_m = scene.extent_m().map(|extent| 0.5 * extent);
        let mut commands = vec![Command::Cameras(vec![Camera { client: 1, eye_m: [middle_m[0], 20.0, middle_m[1]] }])];
        commands.extend(self.vehicles.iter().zip(1..).map(|(kind, client)| Command::Spawn { client, kind: *kind }));
        let (warm_up, steps) = ((WARM_UP_SECS * scene.tick_hz) as u64, (secs * scene.tick_hz) as u64);
        let (mut codec, mut frames, mut cause_bytes) = (StepCodec::default(), vec![], 0);
        for step in 1..=warm_up + steps {
            for (client, kind) in (1..).zip(self.vehicles) {
                commands.push(Command::Drive { client, number: 0, drive: controls(*kind, client, step as f32 / scene.tick_hz) });
            }
            world.step(&std::mem::take(&mut commands));
            if !step.is_multiple_of(STEPS_PER_FRAME) {
                continue;
            }
            let records = world.snapshot().steps;
            let new = records.iter().filter(|record| record.tick > step - STEPS_PER_FRAME).map(|record| &**record);
            let message = codec.encode(new).map(|steps| ServerMessage::Steps {
                first_tick: steps.first_tick,
                steps: steps.heads,
                moves: steps.moves,
            });
            if step > warm_up {
                cause_bytes += message.map_or(0, |message| wire::encode(&message).len());
                frames.push(Frame::of(world.bend().field(), &patches));
            }
        }
        let at_rest = Field::new(layout, Kinds::of(scene, &loaded.cover))
            .with_edges(scene.bend.edges)
            .with_seams(scene.bend.seams)
            .with_rest(scene.bend.rest())
            .with_ground_contact(scene.bend.ground_contact);
        let scheme = scene.bend.scheme;
        Ok(Recording { layout, patches, frames, cause_bytes, at_rest, scheme, dt_secs: scene.dt_secs() })
    }
}

/// Controls that keep a vehicle near the middle: circles, from time to time in the other direction.
fn controls(kind: VehicleKind, client: u32, secs: f32) -> wire::Drive {
    let turn = if ((secs / 9.0 + 0.5 * client as f32) as u32).is_multiple_of(2) { 1.0 } else { -1.0 };
    let throttle = 0.45 + 0.2 * (TAU * secs / 7.0 + client as f32).sin();
    match kind {
        // It climbs for a moment, then hovers near the ground and moves slowly.
        VehicleKind::Helicopter => wire::Drive { throttle: 0.2, steer: 0.5 * turn, lift: if secs < 1.5 { 0.5 } else { 0.0 }, brake: 0.0 },
        _ => wire::Drive { throttle, steer: 0.6 * turn, lift: 0.0, brake: 0.0 },
    }
}
