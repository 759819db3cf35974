//! The packets of the last moments, so that copies are recognised.
//!
//! Redundant links deliver packets twice, and a redundant path can bring back what the router itself sent. Both have
//! the same bytes as a packet that came from another port shortly before. The same bytes from the same port are no copy:
//! sequence numbers repeat after 256 packets, so equal messages may be equal packets.
//!
//! The table has a fixed size. Its hash has a random key, so that no sender can make packets that displace each other.

use std::hash::{BuildHasher, RandomState};

/// Entries that a hash can be in; the oldest of them is replaced.
const WAYS: usize = 4;
/// Number of sets: 65,536 entries, one megabyte.
const SETS: usize = 1 << 14;

/// A packet that was received before.
#[derive(Clone, Copy, Debug, Default)]
struct Entry {
    /// The part of the hash that does not choose the set.
    tag: u32,
    /// The lower half of the port's serial number; 0: no entry.
    port: u32,
    at: u64,
}

/// The entries of one part of the hashes: one line of the processor's cache.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
struct Set([Entry; WAYS]);

/// The packets received within a window of time. Times are monotonic, in microseconds.
#[derive(Debug)]
pub struct Duplicates {
    hasher: RandomState,
    sets: Vec<Set>,
}

impl Default for Duplicates {
    fn default() -> Self {
        Self { hasher: RandomState::new(), sets: Vec::new() }
    }
}

impl Duplicates {
    /// Records a packet that came from the port with serial number `port`, of which the lower half counts and is not 0.
    ///
    /// Returns that half of the serial number of another port on which equal bytes arrived at most `window` microseconds before, and
    /// how long before.
    #[inline]
    pub fn record(&mut self, raw: &[u8], port: u64, window: u64, now: u64) -> Option<(u32, u64)> {
        if self.sets.is_empty() {
            self.sets = vec![Set::default(); SETS];
        }
        let hash = self.hasher.hash_one(raw);
        let (tag, port) = ((hash >> 32) as u32, port as u32);
        let set = &mut self.sets[hash as usize % SETS].0;
        let alive = |entry: &Entry| entry.port != 0 && now.saturating_sub(entry.at) <= window;
        if let Some(known) = set.iter_mut().find(|entry| entry.tag == tag && alive(entry)) {
            if known.port != port {
                return Some((known.port, now.saturating_sub(known.at)));
            }
            known.at = now;
            return None;
        }
        if let Some(oldest) = set.iter_mut().min_by_key(|entry| entry.at) {
            *oldest = Entry { tag, port, at: now };
        }
        None
    }

    /// Forgets a packet of a port that is not forwarded: a forged one that came first must not hide the true one.
    #[cold]
    pub fn forget(&mut self, raw: &[u8], port: u64) {
        let hash = self.hasher.hash_one(raw);
        let (tag, port) = ((hash >> 32) as u32, port as u32);
        if let Some(set) = self.sets.get_mut(hash as usize % SETS) {
            set.0
                .iter_mut()
                .filter(|entry| (entry.tag, entry.port) == (tag, port))
                .for_each(|entry| *entry = Entry::default());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_on_other_ports_are_recognised_within_the_window() {
        let mut duplicates = Duplicates::default();
        assert_eq!(duplicates.record(b"one", 1, 1000, 5_000), None);
        assert_eq!(duplicates.record(b"one", 2, 1000, 6_000), Some((1, 1000)));
        assert_eq!(duplicates.record(b"one", 1, 1000, 6_000), None, "no copy on the same port");
        assert_eq!(duplicates.record(b"two", 2, 1000, 6_000), None);
        assert_eq!(duplicates.record(b"one", 3, 1000, 7_001), None, "too late");
        assert_eq!(duplicates.record(b"one", 1, 1000, 7_002), Some((3, 1)));
    }

    #[test]
    fn a_flood_displaces_only_older_packets() {
        let mut duplicates = Duplicates::default();
        for number in 0..10_000u32 {
            assert_eq!(duplicates.record(&number.to_le_bytes(), 1, 1000, 1), None);
        }
        let copies =
            (0..10_000u32).filter(|number| duplicates.record(&number.to_le_bytes(), 2, 1000, 1) == Some((1, 0)));
        assert!(copies.count() > 9_900);
    }
}
