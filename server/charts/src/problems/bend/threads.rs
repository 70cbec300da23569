//! A scoped thread pool for tests of determinism.

use prairie_core::bend::Executor;

/// A number of threads, started for each call. Tasks are dealt round-robin, so that neighbouring tasks run on different threads.
#[derive(Clone, Copy, Debug)]
pub struct Threads(pub usize);

impl Executor for Threads {
    fn for_each<T: Send>(&self, items: &mut [T], act: impl Fn(&mut T) + Send + Sync) {
        let mut hands: Vec<Vec<&mut T>> = (0..self.0).map(|_| vec![]).collect();
        items.iter_mut().enumerate().for_each(|(n, task)| hands[n % self.0].push(task));
        std::thread::scope(|scope| {
            for hand in hands {
                scope.spawn(|| hand.into_iter().rev().for_each(&act));
            }
        });
    }
}
