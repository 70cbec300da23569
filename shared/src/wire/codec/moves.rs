//! Codec of the motions of objects: adaptive binary arithmetic coding, with statistics that both sides keep from message to message.
//!
//! A [`Move`] is coded as its kind, then the eight numbers of its [`PoseChange`] as zero flag, sign and exp-Golomb magnitude. The probabilities depend on the
//! number's place and on the size of the same number in the object's last change.

use super::arithmetic::{Coder, Decoder, Encoder, Probability};
use crate::wire::{Move, PoseChange};
use serde::{Deserialize, Serialize};

/// Numbers of a change: position, rotation, part.
const NUMBERS: usize = 8;
/// Size classes of a number.
const SIZES: usize = 6;
/// Longest exp-Golomb prefix: magnitudes below 2³².
const PREFIX: usize = 32;
/// Leading bits of a magnitude, below its top bit, that have probabilities of their own; the others are as good as random.
const MODELLED: usize = 2;

/// Statistics of all objects. Encoder and decoder are equal after the same moves.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MoveModel {
    /// Whether the kind is the last one; whether the pose changes; whether the object is at rest.
    kind: [[Probability; 3]; 4],
    zero: [[Probability; SIZES]; NUMBERS],
    sign: [Probability; NUMBERS],
    prefix: [[[Probability; PREFIX]; SIZES]; NUMBERS],
    suffix: [[Probability; MODELLED]; NUMBERS],
}

/// The last move of an object, as far as the next one depends on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MoveContext {
    kind: u8,
    sizes: [u8; NUMBERS],
}

/// Encoder of the moves of one message.
#[derive(Default)]
pub struct MoveEncoder(Encoder);

/// Decoder of the moves of one message.
pub struct MoveDecoder<'a>(Decoder<'a>);

impl MoveEncoder {
    /// The payload.
    pub fn finish(self) -> Vec<u8> {
        self.0.finish()
    }
}

impl<'a> MoveDecoder<'a> {
    /// A decoder of a payload.
    pub fn new(payload: &'a [u8]) -> Self {
        Self(Decoder::new(payload))
    }

    /// Whether the payload ends exactly with the moves decoded so far.
    pub fn is_finished(&self) -> bool {
        self.0.is_exhausted_exactly()
    }
}

impl MoveModel {
    /// Encodes a move of the object with this context.
    pub fn encode(&mut self, encoder: &mut MoveEncoder, context: &mut MoveContext, step: Move) {
        self.code(&mut encoder.0, context, Some(step));
    }

    /// Decodes the next move, of the object with this context. Any bytes give a move.
    pub fn decode(&mut self, decoder: &mut MoveDecoder, context: &mut MoveContext) -> Move {
        self.code(&mut decoder.0, context, None)
    }

    fn code(&mut self, coder: &mut impl Coder, context: &mut MoveContext, step: Option<Move>) -> Move {
        let kind = self.code_kind(coder, usize::from(context.kind & 3), step.map(kind_of));
        context.kind = kind;
        if kind < 2 {
            return if kind == 0 { Move::Same } else { Move::Rest(self.code_rest(coder, step)) };
        }
        let given = step.map(|step| match step {
            Move::Moved(change) | Move::MovedAtRest(change) => numbers(change),
            Move::Same | Move::Rest(_) => [0; NUMBERS],
        });
        let mut values = [0; NUMBERS];
        for (place, value) in values.iter_mut().enumerate() {
            let size = usize::from(context.sizes[place]).min(SIZES - 1);
            *value = self.code_number(coder, place, size, given.map(|given| given[place]));
            context.sizes[place] = size_class(value.unsigned_abs());
        }
        let change = change(values);
        if kind == 2 { Move::Moved(change) } else { Move::MovedAtRest(change) }
    }

    /// Codes the kind of a move: 0 same, 1 rest, 2 moved, 3 moved at rest.
    fn code_kind(&mut self, coder: &mut impl Coder, last: usize, kind: Option<u8>) -> u8 {
        let [is_last, is_moved, is_rare] = &mut self.kind[last];
        if coder.code(is_last, kind.map(|kind| usize::from(kind) == last)) {
            return last as u8;
        }
        let moved = coder.code(is_moved, kind.map(|kind| kind >= 2));
        let rare = coder.code(is_rare, kind.map(|kind| kind % 2 == 1));
        2 * u8::from(moved) + u8::from(rare)
    }

    fn code_rest(&mut self, coder: &mut impl Coder, step: Option<Move>) -> bool {
        coder.code(&mut Probability::default(), step.map(|step| step == Move::Rest(true)))
    }

    fn code_number(&mut self, coder: &mut impl Coder, place: usize, size: usize, value: Option<i32>) -> i32 {
        if coder.code(&mut self.zero[place][size], value.map(|value| value == 0)) {
            return 0;
        }
        let is_negative = coder.code(&mut self.sign[place], value.map(|value| value < 0));
        let magnitude = value.map(i32::unsigned_abs);
        let top = magnitude.map(|magnitude| magnitude.ilog2() as usize);
        let mut length = 0;
        while length + 1 < PREFIX && coder.code(&mut self.prefix[place][size][length], top.map(|top| length < top)) {
            length += 1;
        }
        let mut found = 1_u32;
        for bit_place in (0..length).rev() {
            let bit = magnitude.map(|magnitude| (magnitude >> bit_place) & 1 == 1);
            let probability = self.suffix[place].get_mut(length - 1 - bit_place);
            found = (found << 1) | u32::from(coder.code(probability.unwrap_or(&mut Probability::default()), bit));
        }
        if is_negative { (found as i32).wrapping_neg() } else { found as i32 }
    }
}

fn kind_of(step: Move) -> u8 {
    match step {
        Move::Same => 0,
        Move::Rest(_) => 1,
        Move::Moved(_) => 2,
        Move::MovedAtRest(_) => 3,
    }
}

fn numbers(PoseChange { position: [x, y, z], rotation, part }: PoseChange) -> [i32; NUMBERS] {
    let [qx, qy, qz, qw] = rotation.map(i32::from);
    [x, y, z, qx, qy, qz, qw, part.into()]
}

/// The change of eight numbers, the last five modulo 2¹⁶.
fn change([x, y, z, qx, qy, qz, qw, part]: [i32; NUMBERS]) -> PoseChange {
    PoseChange { position: [x, y, z], rotation: [qx, qy, qz, qw].map(|part| part as i16), part: part as i16 }
}

fn size_class(magnitude: u32) -> u8 {
    match magnitude {
        0 => 0,
        1 => 1,
        2..=3 => 2,
        4..=9 => 3,
        10..=40 => 4,
        _ => 5,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn any_move() -> impl Strategy<Value = Move> {
        let number = prop_oneof![-3..=3_i32, any::<i32>()];
        let change = (proptest::array::uniform3(number), proptest::array::uniform4(any::<i16>()), any::<i16>());
        let change = change.prop_map(|(position, rotation, part)| PoseChange { position, rotation, part });
        prop_oneof![
            Just(Move::Same),
            any::<bool>().prop_map(Move::Rest),
            change.clone().prop_map(Move::Moved),
            change.prop_map(Move::MovedAtRest),
        ]
    }

    proptest! {
        #[test]
        fn moves_come_back(messages in proptest::collection::vec(proptest::collection::vec(any_move(), 0..20), 1..5)) {
            let (mut sender, mut receiver) = (MoveModel::default(), MoveModel::default());
            let (mut sent, mut received) = (MoveContext::default(), MoveContext::default());
            for moves in messages {
                let mut encoder = MoveEncoder::default();
                moves.iter().for_each(|step| sender.encode(&mut encoder, &mut sent, *step));
                let payload = encoder.finish();
                let mut decoder = MoveDecoder::new(&payload);
                for step in moves {
                    prop_assert_eq!(receiver.decode(&mut decoder, &mut received), step);
                }
                prop_assert!(decoder.is_finished());
                prop_assert!(sender == receiver && sent == received);
            }
        }

        #[test]
        fn any_bytes_give_moves(payload in proptest::collection::vec(any::<u8>(), 0..100)) {
            let (mut model, mut context, mut decoder) = (MoveModel::default(), MoveContext::default(), MoveDecoder::new(&payload));
            for _ in 0..50 {
                model.decode(&mut decoder, &mut context);
            }
        }
    }

    #[test]
    fn steady_motion_costs_little() {
        let (mut model, mut context, mut bytes) = (MoveModel::default(), MoveContext::default(), 0);
        for message in 0..100 {
            let mut encoder = MoveEncoder::default();
            for step in 0..3 {
                let noise = |n: i32| (message * 31 + step * 17 + n * 13) % 3 - 1;
                let change = PoseChange { position: [noise(0), noise(1), 0], rotation: [0, noise(2) as i16, 0, 0], part: 0 };
                model.encode(&mut encoder, &mut context, Move::Moved(change));
            }
            bytes += encoder.finish().len();
        }
        assert!(bytes < 100 * 3 * 2, "{bytes} bytes for 300 moves");
    }
}
