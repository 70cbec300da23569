//! Who does the work of a step: one thread, or as many as the caller has.

/// Does independent tasks, in any order or at once. The tasks share nothing that they write, so the bits do not depend on the crew.
pub trait Crew {
    /// Does every task once.
    fn for_each<T: Send>(&self, tasks: Vec<T>, act: impl Fn(T) + Send + Sync);
}

/// The calling thread alone.
#[derive(Clone, Copy, Debug, Default)]
pub struct Alone;

impl Crew for Alone {
    fn for_each<T: Send>(&self, tasks: Vec<T>, act: impl Fn(T) + Send + Sync) {
        tasks.into_iter().for_each(act);
    }
}
