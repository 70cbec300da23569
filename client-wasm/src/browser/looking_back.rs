//! Looking back at the last minutes: the page shows a second mirror, while the live one goes on.

use super::app::App;
use super::page;
use crate::state::{Mirror, Past};

/// Longest work on the way to a moment between two frames (s).
const SLICE_SECS: f64 = 0.012;

impl App {
    /// The mirror that is drawn: that of the past while the user looks back, otherwise the live one.
    pub(super) fn shown(&self) -> &Mirror {
        self.past.as_ref().and_then(Past::mirror).unwrap_or(&self.mirror)
    }

    /// Time between the oldest moment recorded and the present (s).
    pub(super) fn recorded_secs(&self) -> f64 {
        self.record.oldest_secs().map_or(0.0, |oldest_secs| (self.mirror.shown_secs() - oldest_secs).max(0.0))
    }

    /// Time by which the picture is behind the present (s).
    pub(super) fn behind_secs(&self) -> f64 {
        self.past.as_ref().map_or(0.0, |past| (self.mirror.shown_secs() - past.goal_secs()).max(0.0))
    }

    /// Shows the world of `secs` seconds ago, or the present if that is now.
    pub(super) fn look_back(&mut self, secs: f64) {
        if secs <= 0.0 {
            return self.go_live();
        }
        let Some(oldest_secs) = self.record.oldest_secs().filter(|_| secs.is_finite()) else { return };
        let at_secs = (self.mirror.shown_secs() - secs).max(oldest_secs);
        match &mut self.past {
            Some(past) => past.seek(at_secs),
            None => self.past = Some(Past::new(at_secs)),
        }
    }

    /// Lets time go on from the moment shown, or stand still, even at the present.
    pub(super) fn run_past(&mut self, runs: bool) {
        if self.past.is_none() && !runs && self.record.oldest_secs().is_some() {
            self.past = Some(Past::new(self.mirror.shown_secs()));
        }
        if let Some(past) = &mut self.past {
            past.play(runs);
        }
    }

    /// Shows the present again.
    pub(super) fn go_live(&mut self) {
        if self.past.take().is_some() {
            self.mirror.touch_patches();
            self.redraw.invalidate();
        }
    }

    /// Advances the past by `dt_secs`, and goes towards the moment wanted.
    pub(super) fn advance_past(&mut self, dt_secs: f64, now_secs: f64) {
        if let Some(past) = &mut self.past {
            past.advance(dt_secs);
        }
        self.work_on_past(now_secs);
    }

    /// Goes towards the moment wanted. Shows the present again when nothing is recorded any more.
    pub(super) fn work_on_past(&mut self, now_secs: f64) {
        let Some(past) = &mut self.past else { return };
        let (was_there, window) = (past.is_caught_up(), &self.window);
        let is_out_of_time = || page::now_secs(window) - now_secs > SLICE_SECS;
        let followed = past.catch_up(&self.record, &self.mirror, is_out_of_time);
        if !was_there && past.is_caught_up() {
            self.redraw.invalidate();
        }
        if followed.is_err() || self.record.oldest_secs().is_none() {
            self.go_live();
        }
    }
}
