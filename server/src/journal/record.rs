//! Sealed records: the commands of one step, with length and checksum.

use super::error::Fault;
use crate::world::Command;
use serde::{Deserialize, Serialize};

/// Largest record (bytes), more than the commands of all clients in a step.
const RECORD_LIMIT: usize = 1 << 22;

/// The commands of one step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// Number of the step from the start of the segment, at least 1.
    pub after: u64,
    /// The commands in order.
    pub commands: Vec<Command>,
}

/// Appends a step as a record: the length of the payload in bytes of 7 bits, lowest first; the payload; the CRC-32 of both.
pub fn seal_record(step: &Step, out: &mut Vec<u8>) {
    let payload = postcard::to_allocvec(step).expect("commands are plain data");
    let start = out.len();
    let mut length = payload.len();
    while length >= 0x80 {
        out.push(length as u8 | 0x80);
        length >>= 7;
    }
    out.push(length as u8);
    out.extend_from_slice(&payload);
    let sum = crc32fast::hash(&out[start..]);
    out.extend_from_slice(&sum.to_le_bytes());
}

/// The step at the start of `bytes`, and the length of its record.
///
/// # Errors
/// [`Fault`] when the bytes do not begin with a complete record. No bytes make it panic, or allocate more than a multiple of their number.
pub fn open_record(bytes: &[u8]) -> Result<(Step, usize), Fault> {
    let mut length = 0;
    let mut head = 0;
    loop {
        let byte = *bytes.get(head).ok_or(Fault::Truncated)?;
        length |= usize::from(byte & 0x7f) << (7 * head);
        head += 1;
        if byte < 0x80 {
            break;
        }
        if head == 4 {
            return Err(Fault::Content);
        }
    }
    if length == 0 || length > RECORD_LIMIT {
        return Err(Fault::Content);
    }
    let sealed = bytes.get(..head + length).ok_or(Fault::Truncated)?;
    let sum = bytes.get(head + length..head + length + 4).ok_or(Fault::Truncated)?;
    if crc32fast::hash(sealed).to_le_bytes() != sum {
        return Err(Fault::Checksum);
    }
    let (step, rest): (Step, _) = postcard::take_from_bytes(&sealed[head..]).map_err(|_| Fault::Content)?;
    if !rest.is_empty() || step.after == 0 {
        return Err(Fault::Content);
    }
    Ok((step, head + length + 4))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detail::{Decision, Detail, Reason};
    use crate::world::Camera;
    use prairie_core::scene::VehicleKind;
    use prairie_core::wire::Drive;
    use proptest::prelude::*;

    fn command() -> impl Strategy<Value = Command> {
        let drive = [-1.0f32..1.0, -1.0f32..1.0, -1.0f32..1.0, 0.0f32..1.0];
        let camera = (any::<u32>(), any::<[f32; 3]>()).prop_map(|(client, eye_m)| Camera { client, eye_m });
        prop_oneof![
            (any::<u32>(), 0..VehicleKind::ALL.len()).prop_map(|(client, kind)| Command::Spawn { client, kind: VehicleKind::ALL[kind] }),
            any::<u32>().prop_map(|client| Command::Remove { client }),
            (any::<[u32; 2]>(), drive).prop_map(|([client, number], [throttle, steer, lift, brake])| {
                Command::Drive { client, number, drive: Drive { throttle, steer, lift, brake } }
            }),
            proptest::collection::vec(camera, 0..5).prop_map(Command::Cameras),
            any::<u32>().prop_map(|client| Command::Join { client }),
            any::<u32>().prop_map(|client| Command::Leave { client }),
            any::<u32>().prop_map(|client| Command::Return { client }),
            (any::<u64>(), any::<[u32; 3]>(), any::<u8>(), any::<[f32; 2]>(), 0..4).prop_map(
                |(tick, [wind_ticks, awake_limit, publish_divisor], level, [one, other], kind)| {
                    let reason = match kind {
                        0 => Reason::Calm { error: one, allowed: other },
                        1 => Reason::Stirred { error: one, allowed: other },
                        2 => Reason::Overload { busy_ms: one, budget_ms: other },
                        _ => Reason::Relief { busy_ms: one, budget_ms: other },
                    };
                    let detail = Detail { wind_ticks, awake_limit, publish_divisor };
                    Command::Adapt(Decision { tick, detail, unloaded: detail, level, reason })
                }
            ),
        ]
    }

    proptest! {
        #[test]
        fn records_come_back_and_no_flipped_bit_goes_unnoticed(
            after in 1..u64::MAX,
            commands in proptest::collection::vec(command(), 0..8),
            flip in any::<prop::sample::Index>(),
        ) {
            let step = Step { after, commands };
            let mut bytes = vec![];
            seal_record(&step, &mut bytes);
            let (found, length) = open_record(&bytes).unwrap();
            prop_assert!(found == step && length == bytes.len());
            for end in 0..bytes.len() {
                prop_assert!(open_record(&bytes[..end]).is_err(), "cut after {} bytes", end);
            }
            let bit = flip.index(8 * bytes.len());
            bytes[bit / 8] ^= 1 << (bit % 8);
            prop_assert!(open_record(&bytes).is_err(), "bit {} flipped", bit);
        }

        #[test]
        fn any_bytes_are_a_record_or_a_fault(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            if let Ok((_, length)) = open_record(&bytes) {
                prop_assert!(length <= bytes.len());
            }
            // With a valid checksum the payload itself is decoded.
            let mut sealed = vec![bytes.len() as u8 & 0x7f];
            sealed.extend(bytes.iter().take(usize::from(sealed[0])));
            sealed.extend(crc32fast::hash(&sealed).to_le_bytes());
            let _ = open_record(&sealed);
        }
    }
}
