//! Executors of the independent tasks of a step: on one thread, or on the caller's thread pool.

/// Runs independent tasks in any order or in parallel. Tasks share no mutable data, so results do not depend on the implementation.
pub trait Executor {
    /// Runs every task once.
    fn for_each<T: Send>(&self, tasks: Vec<T>, act: impl Fn(T) + Send + Sync);
}

/// Runs all tasks on the calling thread.
#[derive(Clone, Copy, Debug, Default)]
pub struct Serial;

impl Executor for Serial {
    fn for_each<T: Send>(&self, tasks: Vec<T>, act: impl Fn(T) + Send + Sync) {
        tasks.into_iter().for_each(act);
    }
}
