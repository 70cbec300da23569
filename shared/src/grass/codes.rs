//! Codes of the grass: 16 bits for each channel of a cell, encoded again where something changed.

use super::snow::SnowField;
use super::vector::length;
use super::{Audience, BendSimulation, grass_state};
use crate::bend::{Bend, Executor, Patch, TILE};
use crate::grid::PatchIndex;
use crate::wire::Shape;
use crate::wire::quantise::{CodeSteps, snow_code};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The bend field by patch. Patches that are missing are at rest.
pub type BentPatches = BTreeMap<PatchIndex, Arc<PatchCodes>>;

/// The bend field of one patch.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PatchCodes {
    /// Step at which the codes last changed.
    pub tick: u64,
    /// Three planes (θ, ωx, ωz) of `cells × cells` codes, row by row from the north-west. Where snow lies, a fourth plane holds the difference in its depth from
    /// undisturbed snow.
    pub codes: Vec<i16>,
}

/// Sources of a patch's codes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Sources {
    is_awake: bool,
    is_flattened: bool,
    is_trodden: bool,
}

/// State of the grass from which the codes of a patch were made.
#[derive(Clone, Copy, Debug, Default)]
struct Encoded {
    /// Revision of the bend field.
    field: u64,
    /// Revision of the flattened grass.
    flattened: u64,
    /// Revision of the snow.
    snow: u64,
    /// Simulated time (s) at which flattened grass has recovered by the largest error of a code, so that all codes are due again.
    due_secs: f64,
}

/// Quantises the bend field for clients. It keeps the newest codes, so that only tiles that changed are encoded again.
///
/// Codes are within half a [step](CodeSteps) of the state, and where grass lies flattened within a whole step of θ.
#[derive(Debug, Default)]
pub struct PatchQuantiser {
    patches: Arc<BentPatches>,
    sources: BTreeMap<PatchIndex, Sources>,
    encoded: BTreeMap<PatchIndex, Encoded>,
    audience: Audience,
}

impl PatchQuantiser {
    /// Sets the patches that are encoded from now on. Default: all.
    pub fn set_audience(&mut self, audience: Audience) {
        self.audience = audience;
    }

    /// The patches that are encoded.
    pub fn audience(&self) -> &Audience {
        &self.audience
    }

    /// Encodes the changed patches of the audience: awake ones, and those that have only flattened grass and are `in_sight`. Returns the codes of all its patches that are not
    /// at rest.
    pub fn quantise(
        &mut self,
        tick: u64,
        bend: &BendSimulation,
        in_sight: impl Fn(PatchIndex) -> bool,
        executor: &impl Executor,
    ) -> Arc<BentPatches> {
        let mut sources = sources(bend, in_sight);
        sources.retain(|patch, _| self.audience.takes(*patch));
        let mut results: Vec<_> = sources.iter().map(|(index, source)| (*index, *source, None)).collect();
        executor.for_each(&mut results, |(index, source, result)| {
            let is_known = self.sources.get(index) == Some(source);
            *result = Some(self.encode(tick, *index, self.encoded.get(index).filter(|_| is_known), bend));
        });
        let results = results.into_iter().filter_map(|(index, _, result)| Some((index, result?)));
        let (mut patches, mut encoded) = (BentPatches::new(), BTreeMap::new());
        for (index, (codes, state)) in results {
            patches.extend(codes.map(|codes| (index, codes)));
            encoded.insert(index, state);
        }
        (self.patches, self.encoded, self.sources) = (Arc::new(patches), encoded, sources);
        Arc::clone(&self.patches)
    }

    /// Codes of a patch, or `None` where all are zero, and the state that they show. They start from the previous codes, if these are `known` to have the same
    /// sources.
    fn encode(&self, tick: u64, index: PatchIndex, known: Option<&Encoded>, bend: &BendSimulation) -> (Option<Arc<PatchCodes>>, Encoded) {
        let (patch, before) = (bend.field().patch(index), self.patches.get(&index));
        let is_current =
            |known: &&Encoded| bend.flattened().secs() < known.due_secs && !bend.flattened().changed_since(known.flattened, index);
        let is_current = |known: &&Encoded| is_current(known) && bend.snow().is_none_or(|snow| !snow.changed_since(known.snow, index));
        let mut state = Encoded {
            field: bend.field().revision(),
            flattened: bend.flattened().revision(),
            snow: bend.snow().map_or(0, SnowField::revision),
            due_secs: f64::INFINITY,
        };
        let codes = match (patch, known.filter(is_current)) {
            (None, Some(known)) => return (before.cloned(), Encoded { due_secs: known.due_secs, ..state }),
            (Some(patch), Some(known)) => {
                state.due_secs = known.due_secs;
                if !patch.changed_since(known.field).any(|changed| changed) {
                    return (before.cloned(), state);
                }
                update(before.map(|before| before.codes.as_slice()), patch, known.field, bend)
            }
            (patch, None) => {
                let (codes, largest_rad) = encode_all(index, patch, bend);
                state.due_secs = bend.flattened().secs() + bend.flattened().recovery_secs(largest_rad, 0.5 * bend.code_steps().theta_rad);
                codes
            }
        };
        let codes = match before {
            Some(before) if before.codes == codes => Some(Arc::clone(before)),
            _ if are_zero(&codes) => None,
            _ => Some(Arc::new(PatchCodes { tick, codes })),
        };
        (codes, state)
    }
}

/// Patches that are not at rest, with the sources of their codes.
fn sources(bend: &BendSimulation, in_sight: impl Fn(PatchIndex) -> bool) -> BTreeMap<PatchIndex, Sources> {
    let awake = |patch: &Patch| (patch.index(), Sources { is_awake: true, ..Sources::default() });
    let mut sources: BTreeMap<_, _> = bend.field().awake().map(awake).collect();
    let mut add = |index, add: fn(&mut Sources)| {
        if sources.contains_key(&index) || in_sight(index) {
            add(sources.entry(index).or_default());
        }
    };
    bend.flattened().patches().for_each(|index| add(index, |source| source.is_flattened = true));
    bend.snow().into_iter().flat_map(SnowField::patches).for_each(|index| add(index, |source| source.is_trodden = true));
    sources
}

/// Whether all codes are zero; in chunks, for vectorisation.
fn are_zero(codes: &[i16]) -> bool {
    codes.chunks(256).all(|chunk| chunk.iter().fold(0, |any, code| any | code) == 0)
}

/// Codes of a patch at rest in undisturbed snow.
fn at_rest(side: usize, bend: &BendSimulation) -> Vec<i16> {
    let shape = if bend.snow().is_some() { Shape::snowy_patch(side) } else { Shape::patch(side) };
    vec![0; shape.planes * side * side]
}

/// Codes of all tiles, and the largest lean (rad) of flattened grass in them.
fn encode_all(index: PatchIndex, patch: Option<&Patch>, bend: &BendSimulation) -> (Vec<i16>, f32) {
    let side = bend.field().layout().cells as usize;
    let mut codes = at_rest(side, bend);
    if let Some(patch) = patch {
        write_tiles(&mut codes, patch, bend.code_steps(), |_| true);
    }
    let largest_rad = add_flattened(&mut codes, side, index, patch, bend, |_| true);
    for ([i, j], difference) in bend.snow().into_iter().flat_map(|snow| snow.differences(index)) {
        codes[(3 * side + j) * side + i] = snow_code(difference);
    }
    (codes, largest_rad)
}

/// The codes `before`, updated in the tiles that changed since a revision of the field.
fn update(before: Option<&[i16]>, patch: &Patch, since: u64, bend: &BendSimulation) -> Vec<i16> {
    let side = patch.side();
    let mut codes = before.map_or_else(|| at_rest(side, bend), <[i16]>::to_vec);
    let changed: Vec<bool> = patch.changed_since(since).collect();
    write_tiles(&mut codes, patch, bend.code_steps(), |tile| changed[tile]);
    add_flattened(&mut codes, side, patch.index(), Some(patch), bend, |tile| changed[tile]);
    codes
}

/// Writes the chosen tiles, adjacent ones together.
fn write_tiles(codes: &mut [i16], patch: &Patch, steps: &CodeSteps, chosen: impl Fn(usize) -> bool) {
    let (side, count) = (patch.side(), patch.side() / TILE);
    let plane = side * side;
    for band in 0..count {
        let tiles: Vec<_> = (0..count).filter(|tile| chosen(band * count + tile)).collect();
        for span in tiles.chunk_by(|a, b| a + 1 == *b) {
            let (first, last) = (span[0] * TILE, (span[span.len() - 1] + 1) * TILE);
            for j in band * TILE..(band + 1) * TILE {
                let [theta, x, z] = patch.row(j).map(|row| &row[first..last]);
                let row = j * side + first..j * side + last;
                let range = |channel: usize| channel * plane + row.start..channel * plane + row.end;
                steps.theta_codes(theta, &mut codes[range(0)]);
                steps.omega_codes(x, &mut codes[range(1)]);
                steps.omega_codes(z, &mut codes[range(2)]);
            }
        }
    }
}

/// Adds the flattened grass in the chosen tiles of a patch. Returns its largest lean (rad).
fn add_flattened(
    codes: &mut [i16],
    side: usize,
    index: PatchIndex,
    patch: Option<&Patch>,
    bend: &BendSimulation,
    chosen: impl Fn(usize) -> bool,
) -> f32 {
    let (steps, mut largest_rad) = (bend.code_steps(), 0.0_f32);
    let plane = side * side;
    for ([i, j], lean_rad) in bend.flattened().cells(index).filter(|([i, j], _)| chosen(j / TILE * (side / TILE) + i / TILE)) {
        let bend = grass_state::published(patch.map_or_else(Bend::default, |patch| patch.bend(i, j)), lean_rad);
        let at = j * side + i;
        codes[at] = steps.theta_code(bend.theta);
        codes[plane + at] = steps.omega_code(bend.omega[0]);
        codes[2 * plane + at] = steps.omega_code(bend.omega[1]);
        largest_rad = largest_rad.max(length(lean_rad));
    }
    largest_rad
}
