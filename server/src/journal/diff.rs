//! Comparison of two journals: the first step at which they differ.

use super::player::Player;
use crate::world::Command;

/// The first difference of two recordings.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// They have no step in common.
    NothingInCommon {
        /// First and last step of each.
        steps: [[u64; 2]; 2],
    },
    /// The commands of a step differ.
    Commands {
        /// Number of the step.
        tick: u64,
        /// The commands of each.
        commands: [Vec<Command>; 2],
    },
    /// The worlds differ after a step with the same commands, or at the start.
    State {
        /// Number of the step.
        tick: u64,
        /// Names of the parts that differ.
        parts: Vec<&'static str>,
    },
    /// One ends before the other.
    Length {
        /// Last step of each.
        ends: [u64; 2],
    },
}

/// Plays two recordings from the first step that both have, and returns their first difference.
pub fn compare(mut one: Player, mut other: Player) -> Option<Difference> {
    let steps = [&one, &other].map(|player| [player.world.tick(), player.recording.end]);
    let (start, end) = (steps[0][0].max(steps[1][0]), steps[0][1].min(steps[1][1]));
    if start > end {
        return Some(Difference::NothingInCommon { steps });
    }
    one.advance(start);
    other.advance(start);
    for tick in start..=end {
        if tick > start {
            let commands = [&one, &other].map(|player| player.recording.commands.get(&tick).cloned().unwrap_or_default());
            if commands[0] != commands[1] {
                return Some(Difference::Commands { tick, commands });
            }
            one.step();
            other.step();
        }
        let sums = one.world.checksums().into_iter().zip(other.world.checksums());
        let parts: Vec<_> = sums.filter(|(one, other)| one != other).map(|((part, _), _)| part).collect();
        if !parts.is_empty() {
            return Some(Difference::State { tick, parts });
        }
    }
    let ends = [steps[0][1], steps[1][1]];
    (ends[0] != ends[1]).then_some(Difference::Length { ends })
}
