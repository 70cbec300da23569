//! Leaves out commands that change nothing: the same cameras, the same input again.

use crate::world::{Camera, Command};
use prairie_core::wire::Drive;
use std::collections::BTreeMap;

/// The newest cameras and inputs of a journal. Leaving out a command that repeats them gives the same world.
#[derive(Clone, Debug, Default)]
pub struct Unchanged {
    cameras: Option<Vec<(u32, [u32; 3])>>,
    /// Number and bits.
    drives: BTreeMap<u32, (u32, [u32; 4])>,
}

/// The bits of a camera: −0 is not 0.
fn camera_bits(camera: &Camera) -> (u32, [u32; 3]) {
    (camera.client, camera.eye_m.map(f32::to_bits))
}

/// The bits of an input.
fn drive_bits(&Drive { throttle, steer, lift, brake }: &Drive) -> [u32; 4] {
    [throttle, steer, lift, brake].map(f32::to_bits)
}

impl Unchanged {
    /// The commands among those of one step that change something.
    pub fn filter(&mut self, commands: &[Command]) -> Vec<Command> {
        commands.iter().filter(|command| self.changes(command)).cloned().collect()
    }

    fn changes(&mut self, command: &Command) -> bool {
        match command {
            Command::Cameras(cameras) => {
                let bits: Vec<_> = cameras.iter().map(camera_bits).collect();
                let changes = self.cameras.as_ref() != Some(&bits);
                self.cameras = Some(bits);
                changes
            }
            Command::Drive { client, number, drive } => {
                let input = (*number, drive_bits(drive));
                self.drives.insert(*client, input) != Some(input)
            }
            Command::Spawn { client, .. } | Command::Remove { client } | Command::Leave { client } | Command::Return { client } => {
                self.drives.remove(client);
                true
            }
            Command::Join { .. } | Command::Adapt(_) => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::scene::VehicleKind;

    #[test]
    fn repetitions_are_left_out_except_for_a_new_vehicle() {
        let mut unchanged = Unchanged::default();
        let drive = |client, throttle| Command::Drive { client, number: 7, drive: Drive { throttle, ..Drive::default() } };
        let cameras = |x| Command::Cameras(vec![Camera { client: 1, eye_m: [x, 2.0, 3.0] }]);
        let spawn = Command::Spawn { client: 1, kind: VehicleKind::Car };
        let all = [spawn.clone(), drive(1, 1.0), cameras(1.0), drive(2, 1.0)];
        assert_eq!(unchanged.filter(&all), all);
        assert_eq!(unchanged.filter(&all[1..]), []);
        assert_eq!(unchanged.filter(&[drive(1, 0.5), drive(1, 1.0), cameras(2.0)]).len(), 3);
        assert_eq!(unchanged.filter(&[spawn.clone(), drive(1, 1.0), drive(2, 1.0)]), [spawn, drive(1, 1.0)]);
    }
}
