//! `prairie film`: draws a film of a scene without a browser.

use super::number::whole;
use super::print::print;
use super::replay::from_zero;
use super::shot::Shot;
use super::stop_signal::stop_flag;
use anyhow::{Result, ensure};
use clap::{Args, ValueHint};
use indicatif::{ProgressBar, ProgressStyle};
use prairie::journal::recorded;
use prairie::studio::{Film as Writer, Stage};
use prairie_core::wire::Drive;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering::Relaxed;

pub(super) const EXAMPLES: &str = "\
Examples:
  prairie film --scene storm --seconds 6 --out storm.webm
  prairie film --act track --chase 9,3,2 --size 1920x1080 --out car.mp4
  prairie film --seconds 2 --frames-per-second 10 --size 480x270 --out meadow.webp
  prairie film --out frames                  PNG files in a new folder
  prairie film --replay worlds --from 60 --seconds 10 --out storm.webp
                                             ten seconds of a world that is kept

Time in the film is that of the scene, however long a frame takes to draw.
It needs a Vulkan driver, and for files the program ffmpeg (or the one that PRAIRIE_FFMPEG names).";

/// Duration of a film of the wind alone (s).
const WIND_SECS: f32 = 6.0;

/// Warm-up frames before the first one of the film, in which the blades take up the motion of the wind.
const LEAD_IN_FRAMES: u32 = 30;

/// Arguments of `prairie film`.
#[derive(Debug, Args)]
pub(super) struct Film {
    #[command(flatten)]
    shot: Shot,
    /// Duration (s), above 0 to 3600 [default: that of the act; 6 for `wind`]
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    seconds: Option<f32>,
    /// Frames per second, 1 to 60
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = whole::<u32>(1..=60))]
    frames_per_second: u32,
    /// Film what happened in the world that is kept in this folder, as `prairie replay` plays it, instead of an act
    #[arg(long, value_name = "DIR", value_hint = ValueHint::DirPath, conflicts_with_all = ["scene", "act"])]
    replay: Option<PathBuf>,
    /// Simulated time at which the replay begins (s) [default: the oldest that is kept]
    #[arg(long, value_name = "SECS", value_parser = from_zero, requires = "replay")]
    from: Option<f64>,
    /// File to write, which ends in .webm, .mp4, .webp or .gif; or a new or empty folder, for PNG files
    #[arg(long, value_name = "FILE|FOLDER")]
    out: PathBuf,
}

impl Film {
    pub(super) fn run(&self) -> Result<()> {
        let act = self.shot.act();
        let default_secs = if act.vehicle().is_some() { act.secs() } else { WIND_SECS };
        let dt_secs = 1.0 / self.frames_per_second as f32;
        let frames = (self.seconds.unwrap_or(default_secs) / dt_secs).round().max(1.0) as u32;
        let stopped = stop_flag()?;
        let mut film = Writer::create(&self.out, self.shot.size_px(), self.frames_per_second)?;
        let mut studio = match &self.replay {
            Some(world) => {
                let lead_in_secs = f64::from(LEAD_IN_FRAMES) * f64::from(dt_secs);
                self.shot.open_with(|| replayed(world, self.from.map(|secs| (secs - lead_in_secs).max(0.0))))?
            }
            None => self.shot.open()?,
        };
        if self.replay.is_none() {
            let eye_m = studio.camera().eye_m.to_array();
            act.begin(&mut studio.stage, eye_m);
        }

        let bar = ProgressBar::new(u64::from(frames)).with_style(ProgressStyle::with_template("{bar:40} {pos}/{len} frames, {eta} left")?);
        let (tick_hz, mut ticks, mut controls) = (studio.stage.scene().tick_hz, 0, None);
        for frame in 0..LEAD_IN_FRAMES + frames {
            ensure!(!stopped.load(Relaxed), "{}: stopped by a signal before the film was complete", self.out.display());
            let is_filmed = frame >= LEAD_IN_FRAMES;
            if is_filmed
                && let Some(drive) =
                    drive_at(act.script(), dt_secs * (frame - LEAD_IN_FRAMES) as f32).filter(|drive| controls != Some(*drive))
            {
                studio.stage.drive(1, drive);
                controls = Some(drive);
            }
            // Counted from the start, since a frame may last a fraction of a tick.
            let due_ticks = ((frame + 1) as f32 * dt_secs * tick_hz).round() as u32;
            studio.stage.run_ticks(due_ticks - ticks);
            ticks = due_ticks;
            let objects = studio.stage.show()?;
            let pose = act.pose(&studio.stage, &objects)?;
            studio.follow(pose.as_ref());
            studio.draw(dt_secs);
            if is_filmed {
                film.add(&studio.renderer.rgba())?;
                bar.inc(1);
            }
        }
        bar.finish_and_clear();
        film.finish()?;
        let drawing_secs = bar.elapsed().as_secs_f32();
        let film_secs = frames as f32 * dt_secs;
        print(format_args!(
            "{}: {frames} frames, {film_secs:.1} s, drawn in {drawing_secs:.1} s ({:.2} of real time)",
            self.out.display(),
            film_secs / drawing_secs
        ))?;
        Ok(())
    }
}

/// A stage on which the recording in a folder is played.
fn replayed(world: &Path, from_secs: Option<f64>) -> Result<Stage> {
    let (scene, player) = recorded(world, from_secs)?;
    player.recording.faults.iter().for_each(|fault| tracing::warn!("{fault}"));
    Stage::replaying(&scene, player)
}

/// Controls of a script at a time (s); the last ones go on. `None` for an empty script.
fn drive_at(script: &[(f32, Drive)], at_secs: f32) -> Option<Drive> {
    let mut end_secs = 0.0;
    let current = script.iter().find(|(secs, _)| {
        end_secs += secs;
        at_secs < end_secs
    });
    current.or(script.last()).map(|(_, drive)| *drive)
}

fn seconds(text: &str) -> Result<f32, &'static str> {
    text.parse().ok().filter(|secs| *secs > 0.0 && *secs <= 3600.0).ok_or("allowed: above 0 to 3600")
}

#[cfg(test)]
mod tests {
    use super::*;
    use prairie::studio::Act;

    #[test]
    fn a_script_is_followed_to_its_last_controls() {
        let script = Act::Track.script();
        for (at_secs, part) in [(0.0, 0), (2.1, 0), (2.3, 1), (4.9, 2), (60.0, 2)] {
            assert_eq!(drive_at(script, at_secs), Some(script[part].1), "{at_secs} s");
        }
        assert_eq!(drive_at(Act::Wind.script(), 1.0), None);
    }

    #[test]
    fn durations_are_bounded() {
        assert_eq!(seconds("2.5"), Ok(2.5));
        for wrong in ["0", "-1", "nan", "3601", "long"] {
            assert!(seconds(wrong).is_err(), "{wrong}");
        }
    }
}
