//! The packets of the last moments, so that copies are recognised.
//!
//! Redundant links deliver packets twice, and a redundant path can bring back what the router itself sent. Both have
//! the same bytes as a packet that came from another port shortly before. The same bytes from the same port are no copy:
//! sequence numbers repeat after 256 packets, so equal messages may be equal packets.
//!
//! The table grows before a packet of the window displaces another one, up to a fixed size. Its hash has random keys, so
//! that no sender can make packets that do.

use crate::packet_hash::PacketHasher;

/// Entries that a hash can be in; the oldest of them is replaced.
const WAYS: usize = 4;
/// Number of sets: one page at first, one megabyte with 65,536 entries at most.
const MIN_SETS: usize = 1 << 6;
const MAX_SETS: usize = 1 << 14;
/// The bits of the hash that may choose the set; the other 50 of an entry are enough for the microseconds of 35 years.
const SET_BITS: u32 = MAX_SETS.trailing_zeros();

/// A packet that was received before.
#[derive(Clone, Copy, Debug, Default)]
struct Entry {
    /// The part of the hash that does not choose the set.
    tag: u32,
    /// The lower half of the port's serial number; 0: no entry.
    port: u32,
    /// The time since the first packet, and in the lower bits the part of the hash that chooses the set.
    at_and_set: u64,
}

impl Entry {
    fn new(hash: u64, port: u32, now: u64) -> Self {
        let set = hash & ((1 << SET_BITS) - 1);
        Self { tag: (hash >> 32) as u32, port, at_and_set: now << SET_BITS | set }
    }

    fn at(&self) -> u64 {
        self.at_and_set >> SET_BITS
    }

    fn is_alive(&self, window: u64, now: u64) -> bool {
        self.port != 0 && now.saturating_sub(self.at()) <= window
    }
}

/// The entries of one part of the hashes: one line of the processor's cache.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
struct Set([Entry; WAYS]);

/// The packets received within a window of time. Times are monotonic, in microseconds.
#[derive(Debug, Default)]
pub struct Duplicates {
    hasher: PacketHasher,
    sets: Vec<Set>,
    /// Time of the first packet, from which the times of the entries count.
    started: Option<u64>,
}

impl Duplicates {
    /// Records a packet that came from the port with serial number `port`, of which the lower half counts and is not 0.
    ///
    /// Returns that half of the serial number of another port on which equal bytes arrived at most `window` microseconds before, and
    /// how long before.
    #[inline]
    pub fn record(&mut self, raw: &[u8], port: u64, window: u64, now: u64) -> Option<(u32, u64)> {
        if self.sets.is_empty() {
            self.sets = vec![Set::default(); MIN_SETS];
        }
        // From 1 on, so that free entries are the oldest.
        let now = now.saturating_sub(*self.started.get_or_insert(now)) + 1;
        let hash = self.hasher.hash(raw);
        let new = Entry::new(hash, port as u32, now);
        let set = self.set_mut(hash);
        if let Some(known) = set.iter_mut().find(|entry| entry.tag == new.tag && entry.is_alive(window, now)) {
            if known.port != new.port {
                return Some((known.port, now.saturating_sub(known.at())));
            }
            *known = new;
            return None;
        }
        self.insert(new, window, now);
        None
    }

    /// The entries that a hash can be in; the number of sets is a power of two.
    #[inline]
    fn set_mut(&mut self, hash: u64) -> &mut [Entry; WAYS] {
        let index = hash as usize & (self.sets.len() - 1);
        &mut self.sets[index].0
    }

    /// Replaces the oldest entry; a table in which that one is still needed grows first.
    fn insert(&mut self, new: Entry, window: u64, now: u64) {
        let can_grow = self.sets.len() < MAX_SETS;
        let [first, others @ ..] = self.set_mut(new.at_and_set);
        let oldest =
            others.iter_mut().fold(first, |oldest, entry| if entry.at() < oldest.at() { entry } else { oldest });
        if can_grow && oldest.is_alive(window, now) {
            self.grow();
            return self.insert(new, window, now);
        }
        *oldest = new;
    }

    /// Doubles the number of sets.
    #[cold]
    fn grow(&mut self) {
        let larger = vec![Set::default(); 2 * self.sets.len()];
        for entry in std::mem::replace(&mut self.sets, larger).iter().flat_map(|set| set.0) {
            // The entries of a set are divided between two, so that there is room for all.
            if let Some(free) = self.set_mut(entry.at_and_set).iter_mut().find(|other| other.port == 0) {
                *free = entry;
            }
        }
    }

    /// Forgets a packet of a port that is not forwarded: a forged one that came first must not hide the true one.
    #[cold]
    pub fn forget(&mut self, raw: &[u8], port: u64) {
        let hash = self.hasher.hash(raw);
        let (tag, port) = ((hash >> 32) as u32, port as u32);
        if self.sets.is_empty() {
            return;
        }
        for entry in self.set_mut(hash).iter_mut().filter(|entry| (entry.tag, entry.port) == (tag, port)) {
            *entry = Entry::default();
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
    fn times_may_count_from_1970() {
        let mut duplicates = Duplicates::default();
        let now = 1_790_000_000_000_000;
        assert_eq!(duplicates.record(b"one", 1, 1000, now), None);
        assert_eq!(duplicates.record(b"one", 2, 1000, now + 20), Some((1, 20)));
    }

    #[test]
    fn the_table_is_as_large_as_the_window_needs() {
        let mut duplicates = Duplicates::default();
        let mut record = |from: u32, until: u32| {
            let known = (from..until)
                .filter(|number| duplicates.record(&number.to_le_bytes(), 1, 100, u64::from(*number)).is_some());
            (known.count(), duplicates.sets.len())
        };
        assert_eq!(record(0, 4), (0, MIN_SETS));
        let (known, sets) = record(4, 2_000);
        assert!(known == 0 && sets <= 1 << 12, "{sets} sets for a hundred packets");
        let latest =
            (1_900..2_000u32).filter(|number| duplicates.record(&number.to_le_bytes(), 2, 100, 2_000).is_some());
        assert_eq!(latest.count(), 100, "a table that grows keeps its packets");
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
