//! Problems of the picture: frame time against visible error, a run for each method and quality.

use std::cell::{OnceCell, RefCell};
use std::rc::Rc;
use std::time::Duration;

use anyhow::{Context as _, Result};
use prairie_charts::norms::Norms;
use prairie_charts::{Outcome, Problem, Run};
use prairie_client::render::{Gpu, Quality};

use super::{METHODS, Method, Shot, ViewShots, shots};
use crate::charts::image::Picture;
use crate::charts::still::Still;
use crate::charts::views::View;

/// Views on foot and from a hill.
const VIEWS: [(&str, &str); 2] = [("walking-calm", "Meadow on foot"), ("hill-calm", "Meadow from a hill")];

/// Problems of the picture; `quick` takes one small view at the lower two qualities, with the default order and one other.
pub fn problems(quick: bool) -> Vec<Problem> {
    VIEWS.into_iter().take(if quick { 1 } else { 2 }).map(|(view, name)| problem(view, name, quick)).collect()
}

fn problem(view: &'static str, name: &'static str, quick: bool) -> Problem {
    let size_px = if quick { [160, 90] } else { [960, 540] };
    let methods = if quick { &METHODS[..4] } else { &METHODS[..] };
    let qualities = if quick { &Quality::ALL[..2] } else { &Quality::ALL[..] };
    let stage = Rc::new(OnceCell::new());
    let run = |method: Method, quality: Quality| {
        let (stage, shot) = (Rc::clone(&stage), OnceCell::new());
        Run {
            method: method.name(),
            cells: [size_px[0] as usize, size_px[1] as usize, 1],
            dt_secs: 0.0,
            // Drawn once: its time is the median of several frames already, and blending gives other last digits each time.
            solve: Box::new(move || {
                if stage.get().is_none() {
                    let _ = stage.set(Shown::of(view, size_px)?);
                }
                if shot.get().is_none() {
                    let _ = shot.set(stage.get().context("just set")?.shoot(view, method, quality, if quick { 1 } else { 5 })?);
                }
                shot.get().copied().context("just set")
            }),
        }
    };
    Problem {
        name,
        error: "mean FLIP to the reference",
        per: "frame",
        default_method: Some(DEFAULT),
        cell_bytes: 0,
        runs: methods
            .iter()
            .flat_map(|&method| qualities.iter().map(move |&quality| (method, quality)))
            .map(|(method, quality)| run(method, quality))
            .collect(),
    }
}

/// Name of the method of the default render options.
const DEFAULT: &str = "land, cut";

/// A frozen moment with its reference.
struct Shown {
    gpu: Gpu,
    still: RefCell<Still>,
    reference: Picture,
}

impl Shown {
    fn of(view: &str, size_px: [u32; 2]) -> Result<Self> {
        let gpu = Gpu::headless()?;
        let mut still = Still::of(View::find(view)?, size_px)?;
        let reference = still.reference(&gpu);
        Ok(Self { gpu, still: still.into(), reference })
    }

    fn shoot(&self, view: &str, method: Method, quality: Quality, frames: u32) -> Result<Outcome> {
        let wanted = ViewShots { methods: vec![method], qualities: vec![quality], frames };
        let shots = shots(&self.gpu, view, &mut self.still.borrow_mut(), &self.reference, &wanted, |_| ())?;
        let Shot { flip, flip_worst, ms, .. } = shots.first().context("no shot")?;
        Ok(Outcome {
            error: Norms { l1: *flip, l2: *flip, linf: *flip_worst },
            simulated_secs: 1.0,
            wall: Duration::from_secs_f64(ms * 1e-3),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_method_is_the_default() {
        assert_eq!(METHODS[0].name(), DEFAULT);
    }
}
