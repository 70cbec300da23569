//! Threads that propagate the bend field (Chen & Johan, §4.4).

use prairie_core::bend::Crew;
use rayon::prelude::*;

/// The rayon thread pool of the caller.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pool;

impl Crew for Pool {
    fn for_each<T: Send>(&self, tasks: Vec<T>, act: impl Fn(T) + Send + Sync) {
        tasks.into_par_iter().for_each(act);
    }
}
