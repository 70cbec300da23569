//! Executors of the independent tasks of a step: on one thread, or on the caller's thread pool.

/// Runs independent tasks in any order or in parallel. Tasks share no mutable data, so results do not depend on the implementation.
pub trait Executor {
    /// Runs `act` once for every item.
    fn for_each<T: Send>(&self, items: &mut [T], act: impl Fn(&mut T) + Send + Sync);
}

/// Runs all tasks on the calling thread.
#[derive(Clone, Copy, Debug, Default)]
pub struct Serial;

impl Executor for Serial {
    fn for_each<T: Send>(&self, items: &mut [T], act: impl Fn(&mut T) + Send + Sync) {
        items.iter_mut().for_each(act);
    }
}
