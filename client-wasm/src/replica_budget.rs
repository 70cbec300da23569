//! Whether this machine keeps up with a replica of the grass: it measures itself, and takes patches instead when it does not.

/// Period over which the work is measured (s).
const PERIOD_SECS: f64 = 2.0;
/// Largest fraction of the time that a replica may take: 2 ms in each 16 ms.
const SHARE: f64 = 0.125;
/// Time without a replica after the first failure (s); it doubles with each.
const PAUSE_SECS: f64 = 30.0;
/// Longest time without a replica (s).
const PAUSE_LIMIT_SECS: f64 = 960.0;

/// Change of what the client asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// Patches: the replica takes too long.
    Patches,
    /// A replica, after a pause.
    Replica,
}

/// Measures the work of a replica.
#[derive(Clone, Copy, Debug, Default)]
pub struct ReplicaBudget {
    /// Start of the present period (s), and the work in it (s); `None` before the first work.
    period: Option<(f64, f64)>,
    /// Whether the first period is over, in which the replica catches up with the time that its state took to arrive.
    has_caught_up: bool,
    /// Time from which a replica is wanted again (s), while it is not.
    resumes_at_secs: Option<f64>,
    failures: u32,
    /// Work in the newest complete period, as a fraction of the time.
    share: f64,
}

impl ReplicaBudget {
    /// Adds work of `work_secs` for the replica. Returns the wish that changes because of it.
    pub fn record(&mut self, now_secs: f64, work_secs: f64) -> Option<Wish> {
        if self.resumes_at_secs.is_some() {
            return None;
        }
        let (began_secs, total_secs) = *self.period.get_or_insert((now_secs, 0.0));
        let total_secs = total_secs + work_secs;
        self.period = Some((began_secs, total_secs));
        let elapsed_secs = now_secs - began_secs;
        if elapsed_secs < PERIOD_SECS {
            return None;
        }
        self.period = None;
        self.share = total_secs / elapsed_secs;
        if !std::mem::replace(&mut self.has_caught_up, true) || self.share <= SHARE {
            return None;
        }
        let pause_secs = PAUSE_SECS * f64::from(2_u32.saturating_pow(self.failures));
        self.failures += 1;
        self.resumes_at_secs = Some(now_secs + pause_secs.min(PAUSE_LIMIT_SECS));
        self.has_caught_up = false;
        Some(Wish::Patches)
    }

    /// Work of the replica in the newest complete period, as a fraction of the time.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// The wish that changes with time.
    pub fn wish(&mut self, now_secs: f64) -> Option<Wish> {
        self.resumes_at_secs.take_if(|at_secs| now_secs >= *at_secs).map(|_| Wish::Replica)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Wishes while frames of `work_secs` arrive 20 times a second, with their times.
    fn wishes(budget: &mut ReplicaBudget, secs: std::ops::Range<u32>, work_secs: f64) -> Vec<(f64, Wish)> {
        let at = (secs.start * 20..secs.end * 20).map(|n| f64::from(n) / 20.0);
        at.filter_map(|now| Some((now, budget.wish(now).or_else(|| budget.record(now, work_secs))?))).collect()
    }

    #[test]
    fn a_machine_that_keeps_up_keeps_its_replica() {
        let mut budget = ReplicaBudget::default();
        assert_eq!(wishes(&mut budget, 0..60, 0.006), []);
        assert!((budget.share() - 0.12).abs() < 0.01);
    }

    #[test]
    fn a_machine_that_does_not_keep_up_takes_patches_and_tries_again_ever_later() {
        let mut budget = ReplicaBudget::default();
        assert_eq!(wishes(&mut budget, 0..2, 0.04), [], "it catches up first");
        let wishes: Vec<_> = wishes(&mut budget, 2..120, 0.01);
        let kinds: Vec<_> = wishes.iter().map(|(_, wish)| *wish).collect();
        assert_eq!(kinds[..4], [Wish::Patches, Wish::Replica, Wish::Patches, Wish::Replica]);
        let pauses: Vec<_> = wishes.chunks_exact(2).map(|pair| (pair[1].0 - pair[0].0).round()).collect();
        assert_eq!(pauses[..2], [30.0, 60.0]);
    }
}
