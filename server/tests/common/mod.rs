//! A client's replica of the world, updated like that of a real client.
#![allow(dead_code, missing_docs, unreachable_pub, reason = "each test file uses its own part")]

use prairie_core::grid::PatchIndex;
use prairie_core::wire::{PATCH_MEMORY, SERVER_MESSAGE_LIMIT, ServerMessage, Shape, codec, decode};
use std::collections::BTreeMap;

/// Codes and number of the newest frame of each grid. Strict: a delta must follow the held frame. Keeps no more patches than a client must.
#[derive(Debug, Default, PartialEq)]
pub struct Replica {
    /// Cells along a side of a patch and along the axes of the wind; set by the scene message.
    pub patch_cells: usize,
    pub wind_cells: [u32; 3],
    pub has_dust: bool,
    pub has_snow: bool,
    pub patches: BTreeMap<PatchIndex, (u32, Vec<i16>)>,
    /// The patches, least recently updated first.
    pub recent: Vec<PatchIndex>,
    pub wind: (u32, Vec<i16>),
    pub tick: u64,
    pub frame: u32,
    pub bytes: usize,
}

impl Replica {
    pub fn new(patch_cells: usize, wind_cells: [u32; 3], has_dust: bool) -> Self {
        let mut replica = Self::default();
        replica.shape(patch_cells, wind_cells, has_dust);
        replica
    }

    fn shape(&mut self, patch_cells: usize, wind_cells: [u32; 3], has_dust: bool) {
        (self.patch_cells, self.wind_cells, self.has_dust) = (patch_cells, wind_cells, has_dust);
        self.wind = (0, vec![0; self.wind_shape().planes * wind_cells.iter().product::<u32>() as usize]);
    }

    fn patch_shape(&self) -> Shape {
        if self.has_snow { Shape::snowy_patch(self.patch_cells) } else { Shape::patch(self.patch_cells) }
    }

    fn wind_shape(&self) -> Shape {
        Shape::wind(self.wind_cells[0] as usize, self.has_dust)
    }

    /// Applies a message.
    pub fn apply(&mut self, bytes: &[u8]) -> ServerMessage {
        let message: ServerMessage = decode(bytes, SERVER_MESSAGE_LIMIT).expect("the server sends valid messages");
        self.bytes += bytes.len();
        match &message {
            ServerMessage::Patch { patch, seq, key, payload } => {
                let shape = self.patch_shape();
                let rest = || (0, vec![0; shape.planes * shape.width.pow(2)]);
                let held = self.patches.entry(*patch).or_insert_with(rest);
                update(held, shape, *seq, *key, payload);
                self.recent.retain(|recent| recent != patch);
                self.recent.push(*patch);
                if self.recent.len() > PATCH_MEMORY {
                    self.patches.remove(&self.recent.remove(0));
                }
            }
            ServerMessage::Wind { seq, key, payload, .. } => {
                let shape = self.wind_shape();
                update(&mut self.wind, shape, *seq, *key, payload);
            }
            ServerMessage::Scene { scene, .. } => {
                self.shape(scene.patches.cells as usize, scene.wind.cells, scene.wind.has_dust());
                self.has_snow = scene.snow.lies();
            }
            ServerMessage::FrameEnd { frame, tick, .. } => {
                assert_eq!(*frame, self.frame + 1, "frames are numbered without gaps");
                assert!(*tick >= self.tick, "time never decreases");
                (self.frame, self.tick) = (*frame, *tick);
            }
            ServerMessage::Welcome { .. }
            | ServerMessage::Roster { .. }
            | ServerMessage::Race { .. }
            | ServerMessage::Ghost { .. }
            | ServerMessage::Poses { .. }
            | ServerMessage::Broken { .. }
            | ServerMessage::Pong { .. }
            | ServerMessage::ReplicaState { .. }
            | ServerMessage::Steps { .. }
            | ServerMessage::Applied(_)
            | ServerMessage::Refused { .. } => {}
        }
        message
    }
}

fn update(held: &mut (u32, Vec<i16>), shape: Shape, seq: u32, key: bool, payload: &[u8]) {
    if key {
        held.1.fill(0);
    } else {
        assert_eq!(held.0 + 1, seq, "a delta applies to the previous frame");
    }
    if !payload.is_empty() {
        codec::decode(shape, payload, &mut held.1).expect("the payload is a grid");
    }
    held.0 = seq;
}
