//! A scoped thread pool for tests of determinism.

use prairie_core::bend::Executor;

/// A number of threads, started for each call. Tasks are dealt round-robin, so that neighbouring tasks run on different threads.
#[derive(Clone, Copy, Debug)]
pub struct Threads(pub usize);

impl Executor for Threads {
    fn for_each<T: Send>(&self, tasks: Vec<T>, act: impl Fn(T) + Send + Sync) {
        let mut hands: Vec<Vec<T>> = (0..self.0).map(|_| vec![]).collect();
        tasks.into_iter().enumerate().for_each(|(n, task)| hands[n % self.0].push(task));
        std::thread::scope(|scope| {
            for hand in hands {
                scope.spawn(|| hand.into_iter().rev().for_each(&act));
            }
        });
    }
}
