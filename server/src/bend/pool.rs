//! Threads that propagate the bend field (Chen & Johan, §4.4).

use prairie_core::bend::Executor;
use rayon::prelude::*;

/// The rayon thread pool of the caller.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pool;

impl Executor for Pool {
    fn for_each<T: Send>(&self, items: &mut [T], act: impl Fn(&mut T) + Send + Sync) {
        items.par_iter_mut().for_each(act);
    }
}
