//! Token buckets: limits of packets or bytes per second that allow short bursts.

/// A bucket that fills at a rate and is emptied by what passes. Times are monotonic, in microseconds.
#[derive(Clone, Debug)]
pub struct TokenBucket {
    rate: f64,
    burst: f64,
    level: f64,
    filled_at: Option<u64>,
}

impl TokenBucket {
    /// Creates a full bucket of `burst` tokens that gains `rate` tokens per second.
    #[must_use]
    pub fn new(rate: f64, burst: f64) -> Self {
        Self { rate, burst, level: burst, filled_at: None }
    }

    /// Takes `amount` tokens if `reserve` tokens are left then; returns whether they were taken.
    #[inline]
    pub fn take(&mut self, amount: f64, reserve: f64, now: u64) -> bool {
        if let Some(filled_at) = self.filled_at {
            let elapsed = now.saturating_sub(filled_at) as f64 * 1e-6;
            self.level = (self.level + elapsed * self.rate).min(self.burst);
        }
        self.filled_at = Some(now.max(self.filled_at.unwrap_or(0)));
        let passes = self.level >= amount + reserve;
        if passes {
            self.level -= amount;
        }
        passes
    }

    /// Number of tokens of a full bucket.
    #[must_use]
    pub fn burst(&self) -> f64 {
        self.burst
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bucket_passes_its_burst_and_then_its_rate() {
        let mut bucket = TokenBucket::new(4.0, 4.0);
        let passed = (0..100).filter(|step| bucket.take(1.0, 0.0, step * 100_000)).count();
        assert_eq!(passed, 4 + 39);
    }

    #[test]
    fn a_reserve_is_kept_and_time_never_runs_back() {
        let mut bucket = TokenBucket::new(1.0, 10.0);
        assert!(!bucket.take(8.0, 4.0, 5_000_000));
        assert!(bucket.take(8.0, 2.0, 5_000_000));
        assert!(!bucket.take(4.0, 0.0, 1_000_000));
        assert!(!bucket.take(4.0, 0.0, 5_500_000));
        assert!(bucket.take(4.0, 0.0, 7_000_000));
    }
}
