//! Rests between turns while packets come fast.
//!
//! A turn costs system calls and a wake-up, however little it reads. While packets come fast, a turn that read little is
//! therefore followed by a rest, in which a batch collects. A vehicle's telemetry never comes so fast.

use std::time::Duration;

/// Microseconds over which packets are counted, and the number from which on they come fast: 40,000 per second.
const INTERVAL: u64 = 5_000;
const FAST: usize = 200;
/// Datagrams that are a batch.
const BATCH: usize = 32;
/// The length of a rest.
pub const REST: Duration = Duration::from_micros(40);

/// Counts datagrams. Times are monotonic, in microseconds.
#[derive(Debug, Default)]
pub struct Moderation {
    started: u64,
    datagrams: usize,
    is_fast: bool,
}

impl Moderation {
    /// Notes the datagrams of a turn; returns whether a rest should follow.
    pub fn needs_rest(&mut self, datagrams: usize, now: u64) -> bool {
        let elapsed = now.saturating_sub(self.started);
        if elapsed >= INTERVAL {
            self.is_fast = self.datagrams >= FAST && elapsed < 2 * INTERVAL;
            (self.started, self.datagrams) = (now, 0);
        }
        self.datagrams += datagrams;
        self.is_fast && (1..BATCH).contains(&datagrams)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Makes turns with one datagram each; returns the number of rests.
    fn rests(moderation: &mut Moderation, from: u64, until: u64, distance: usize) -> usize {
        (from..until).step_by(distance).filter(|&now| moderation.needs_rest(1, now)).count()
    }

    #[test]
    fn only_packets_that_come_fast_are_collected() {
        let mut moderation = Moderation::default();
        assert_eq!(rests(&mut moderation, 1, 100_000, 100), 0, "10,000 per second");
        assert!(rests(&mut moderation, 100_000, 200_000, 10) > 8_000, "100,000 per second");
        assert!(!moderation.needs_rest(BATCH, 200_000), "a batch has collected");
        assert!(!moderation.needs_rest(0, 200_001), "nothing comes");
        assert!(rests(&mut moderation, 206_000, 300_000, 100) < 100, "slow again");
        assert_eq!(rests(&mut moderation, 900_000, 904_000, 10), 0, "after a silence");
    }
}
