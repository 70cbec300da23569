//! A look at the recorded past: a second mirror that goes on from a checkpoint by the recorded messages.

use super::error::MirrorError;
use super::mirror::Mirror;
use super::record::{Record, RecordedFrame};
use prairie_core::wire::{self, SERVER_MESSAGE_LIMIT, ServerMessage};

/// A mirror on its way to a moment of the record.
#[derive(Debug)]
struct Run {
    mirror: Mirror,
    /// Number of the frame to apply next.
    next: u64,
    /// The moment (time of playback, s), and whether it has been reached.
    to_secs: f64,
    is_there: bool,
}

impl Run {
    /// Starts from the newest checkpoint before `to_secs`; `None` while nothing is recorded.
    fn new(record: &Record, live: &Mirror, to_secs: f64) -> Result<Option<Self>, MirrorError> {
        let Some((number, checkpoint)) = record.checkpoint_before(to_secs) else { return Ok(None) };
        Ok(Some(Self { mirror: live.at(checkpoint)?, next: number + 1, to_secs, is_there: false }))
    }

    /// Whether to go on to `to_secs` instead of starting from a checkpoint.
    fn leads_to(&self, record: &Record, to_secs: f64) -> bool {
        let is_recorded = record.first() <= self.next;
        is_recorded && self.to_secs <= to_secs && record.checkpoint_before(to_secs).is_none_or(|(number, _)| number <= self.next)
    }

    /// Applies frames up to the first at the moment or after it, or until `is_out_of_time`.
    fn advance(&mut self, record: &Record, live: &Mirror, is_out_of_time: &mut impl FnMut() -> bool) -> Result<(), MirrorError> {
        while self.mirror.secs_of(self.mirror.tick()) < self.to_secs {
            let Some(frame) = record.frame(self.next) else { break };
            if is_out_of_time() {
                return Ok(());
            }
            match frame.checkpoint.as_ref().filter(|_| frame.is_start) {
                Some(checkpoint) => self.mirror = live.at(checkpoint)?,
                None => self.mirror.follow(frame)?,
            }
            self.next += 1;
        }
        self.mirror.following.show(&mut self.mirror.patches);
        self.mirror.poses.show_at(self.to_secs);
        self.is_there = true;
        Ok(())
    }
}

impl Mirror {
    /// Applies a recorded frame. Its patches are not shown yet.
    fn follow(&mut self, frame: &RecordedFrame) -> Result<(), MirrorError> {
        for message in &frame.messages {
            match wire::decode(message, SERVER_MESSAGE_LIMIT) {
                Ok(ServerMessage::FrameEnd { tick, time_secs, .. }) => self.end_frame(tick, time_secs)?,
                Ok(message) => drop(self.apply(message)?),
                Err(error) => unreachable!("the record has encoded the message itself: {error}"),
            }
        }
        Ok(())
    }
}

/// A look at the recorded past. The live mirror goes on meanwhile.
#[derive(Debug)]
pub struct Past {
    shown: Option<Run>,
    /// Replaces the one shown when it has arrived.
    next: Option<Run>,
    /// The wanted moment (time of playback, s).
    goal_secs: f64,
    is_playing: bool,
}

impl Past {
    /// A look at the moment `secs` (time of playback), at which time stands still. Nothing is shown before [`catch_up`](Self::catch_up).
    pub fn new(secs: f64) -> Self {
        Self { shown: None, next: None, goal_secs: secs, is_playing: false }
    }

    /// Goes to another moment (time of playback, s).
    pub fn seek(&mut self, secs: f64) {
        self.goal_secs = secs;
    }

    /// Lets time go on from the moment shown, or stand still.
    pub fn play(&mut self, is_playing: bool) {
        self.is_playing = is_playing;
    }

    /// Whether time goes on.
    pub fn is_playing(&self) -> bool {
        self.is_playing
    }

    /// Advances time by `dt_secs`, unless it stands still, or the moment is not shown yet.
    pub fn advance(&mut self, dt_secs: f64) {
        if self.is_playing && self.is_caught_up() {
            self.goal_secs += dt_secs;
        }
    }

    /// Works towards the wanted moment, at the latest until `is_out_of_time`. A moment before or after the record becomes its beginning or end.
    ///
    /// # Errors
    /// [`MirrorError`] when the record does not fit the scene of the `live` mirror.
    pub fn catch_up(&mut self, record: &Record, live: &Mirror, mut is_out_of_time: impl FnMut() -> bool) -> Result<(), MirrorError> {
        let Some((oldest_secs, newest_secs)) = record.oldest_secs().zip(record.newest_secs()) else { return Ok(()) };
        if self.is_caught_up() && !self.is_playing {
            // Stays there even when the record has forgotten the moment.
            return Ok(());
        }
        self.goal_secs = self.goal_secs.clamp(oldest_secs, newest_secs);
        if self.next.as_ref().is_some_and(|run| run.next < record.first()) {
            self.next = None;
        }
        if self.next.is_none() {
            match &mut self.shown {
                Some(shown) if shown.to_secs == self.goal_secs && shown.is_there => return Ok(()),
                Some(shown) if shown.leads_to(record, self.goal_secs) => {
                    (shown.to_secs, shown.is_there) = (self.goal_secs, false);
                    return shown.advance(record, live, &mut is_out_of_time);
                }
                _ => self.next = Run::new(record, live, self.goal_secs)?,
            }
        }
        if let Some(run) = &mut self.next {
            run.advance(record, live, &mut is_out_of_time)?;
        }
        if self.next.as_ref().is_some_and(|run| run.is_there) {
            self.shown = self.next.take();
        }
        Ok(())
    }

    /// Whether the wanted moment is shown.
    pub fn is_caught_up(&self) -> bool {
        self.next.is_none() && self.shown.as_ref().is_some_and(|shown| shown.is_there && shown.to_secs == self.goal_secs)
    }

    /// The wanted moment (time of playback, s).
    pub fn goal_secs(&self) -> f64 {
        self.goal_secs
    }

    /// The mirror of the moment shown; `None` before the first has been reached.
    pub fn mirror(&self) -> Option<&Mirror> {
        self.shown.as_ref().map(|run| &run.mirror)
    }

    /// The same to draw.
    pub fn mirror_mut(&mut self) -> Option<&mut Mirror> {
        self.shown.as_mut().map(|run| &mut run.mirror)
    }
}
