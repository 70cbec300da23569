//! The threads that propagate the bend field (001 §4.4).

use rayon::prelude::*;
use shared::bend::Crew;

/// All threads of the pool that the caller is in.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pool;

impl Crew for Pool {
    fn for_each<T: Send>(&self, tasks: Vec<T>, act: impl Fn(T) + Send + Sync) {
        tasks.into_par_iter().for_each(act);
    }
}
