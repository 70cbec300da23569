//! Lines of the text log: objects that come and go, and grass that is given up.

use prairie_core::grass::StepRecord;
use prairie_core::scene::VehicleKind;
use prairie_core::wire::{ObjectId, ObjectPose};
use std::collections::BTreeMap;

/// Largest number of patches that a line lists.
const LISTED: usize = 8;

/// The objects of the last frame, with which those of the next are compared.
#[derive(Debug, Default)]
pub(super) struct Events {
    /// `None` before the first frame.
    objects: Option<BTreeMap<ObjectId, VehicleKind>>,
}

impl Events {
    /// Lines about everything new since the last frame; the objects of the first frame are no event.
    pub(super) fn update(&mut self, objects: &[ObjectPose], new_steps: &[impl AsRef<StepRecord>]) -> Vec<String> {
        let now: BTreeMap<_, _> = objects.iter().map(|object| (object.id, object.kind)).collect();
        let mut lines = Vec::new();
        if let Some(before) = &self.objects {
            let absent_in = |other: &BTreeMap<ObjectId, VehicleKind>, verb: &str, from: &BTreeMap<ObjectId, VehicleKind>| {
                let gone = from.iter().filter(|(id, _)| !other.contains_key(id));
                gone.map(|(id, kind)| format!("{} {id} {verb}", kind.name())).collect::<Vec<_>>()
            };
            lines.extend(absent_in(&now, "left", before));
            lines.extend(absent_in(before, "joined", &now));
        }
        self.objects = Some(now);
        for step in new_steps.iter().map(AsRef::as_ref) {
            lines.extend(patches("put to sleep, since too many are awake", &step.causes.evicted));
            lines.extend(patches("lost their laid grass or tracks, since there are too many", &step.causes.dropped));
        }
        lines
    }
}

/// "patches 3, 7 and 12 more …"; `None` without any.
fn patches(fate: &str, indices: &[u32]) -> Option<String> {
    let listed: Vec<_> = indices.iter().take(LISTED).map(u32::to_string).collect();
    let more = match indices.len().saturating_sub(LISTED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    (!indices.is_empty()).then(|| format!("patches {}{more} {fate}", listed.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie_core::grass::Causes;
    use std::sync::Arc;

    fn object(id: ObjectId, kind: VehicleKind) -> ObjectPose {
        let (position_m, rotation, velocity_m_per_s) = ([0.0; 3], [0.0, 0.0, 0.0, 1.0], [0.0; 3]);
        ObjectPose { id, kind, position_m, rotation, velocity_m_per_s, part_rad: 0.0 }
    }

    const NONE: [Arc<StepRecord>; 0] = [];

    #[test]
    fn objects_that_come_and_go_are_events() {
        let mut events = Events::default();
        let (car, ball) = (object(3, VehicleKind::Car), object(5, VehicleKind::Ball));
        assert!(events.update(&[car], &NONE).is_empty(), "the first frame");
        assert_eq!(events.update(&[car, ball], &NONE), ["ball 5 joined"]);
        assert!(events.update(&[car, ball], &NONE).is_empty());
        assert_eq!(events.update(&[ball], &NONE), ["car 3 left"]);
    }

    #[test]
    fn patches_that_are_given_up_are_events() {
        let causes = Causes { evicted: vec![4, 9], dropped: (0..11).collect(), ..Causes::default() };
        let step = Arc::new(StepRecord { tick: 1, wind_tick: 0, causes, objects: vec![], checks: vec![] });
        let lines = Events::default().update(&[], &[step]);
        assert_eq!(lines[0], "patches 4, 9 put to sleep, since too many are awake");
        assert!(lines[1].starts_with("patches 0, 1, 2, 3, 4, 5, 6, 7 and 3 more lost"), "{lines:?}");
    }
}
