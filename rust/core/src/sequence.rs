//! Loss per source, from the gaps in its sequence numbers.
//!
//! A source is a (system, component) heard on one link. A gap of less than half the circle is loss; a packet
//! from a few numbers back is late or a duplicate, and a late one was counted as lost before it came; any
//! other step backwards is a sender that started again, and says nothing about loss.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// How many numbers back a packet may come and still be late, not a restart.
const LATE_WINDOW: u8 = 16;

/// What was heard of one source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source {
    pub received: u64,
    pub bytes: u64,
    pub lost: u64,
    /// Late or duplicate packets.
    pub late: u64,
    last: u8,
    opening: Opening,
}

/// The first numbers heard and what had been counted after them: where a stretch of a stream is joined to the one
/// before, these are counted again, because some may be late to a hole that lies before the border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Opening {
    numbers: [u8; LATE_WINDOW as usize + 1],
    length: u8,
    lost: u64,
    late: u64,
}

impl Source {
    fn new(sequence: u8, bytes: u64) -> Self {
        let mut opening = Opening { numbers: [0; LATE_WINDOW as usize + 1], length: 1, lost: 0, late: 0 };
        opening.numbers[0] = sequence;
        Self { received: 1, bytes, lost: 0, late: 0, last: sequence, opening }
    }

    #[inline]
    fn hear(&mut self, sequence: u8, bytes: u64) {
        self.received += 1;
        self.bytes += bytes;
        self.step(sequence);
        if usize::from(self.opening.length) < self.opening.numbers.len() {
            self.open(sequence);
        }
    }

    #[cold]
    fn open(&mut self, sequence: u8) {
        self.opening.numbers[usize::from(self.opening.length)] = sequence;
        self.opening.length += 1;
        (self.opening.lost, self.opening.late) = (self.lost, self.late);
    }

    /// Joins what was heard in the next stretch of the stream.
    fn join(&mut self, next: &Self) {
        let Opening { numbers, length, lost, late } = next.opening;
        for &number in &numbers[..usize::from(length)] {
            self.step(number);
        }
        self.lost = (self.lost + next.lost).saturating_sub(lost);
        self.late += next.late - late;
        self.received += next.received;
        self.bytes += next.bytes;
        if usize::from(length) == numbers.len() {
            self.last = next.last;
        }
    }

    #[inline]
    fn step(&mut self, sequence: u8) {
        let gap = sequence.wrapping_sub(self.last).wrapping_sub(1);
        if gap < 128 {
            self.lost += u64::from(gap);
        } else if gap >= 255 - LATE_WINDOW {
            self.late += 1;
            // gap 255 repeats the last number: a duplicate fills no hole.
            self.lost = self.lost.saturating_sub(u64::from(gap != 255));
            return;
        }
        self.last = sequence;
    }
}

/// Hashes a source by one multiplication: the keys are two bytes and the table is bounded by them.
#[derive(Debug, Default)]
pub struct SourceHasher(u64);

impl Hasher for SourceHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.write_u16(u16::from(byte));
        }
    }

    fn write_u16(&mut self, key: u16) {
        self.0 = (self.0 ^ u64::from(key)).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    }
}

/// Sequence statistics of all sources heard on one link.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    heard: Vec<(u16, Source)>,
    places: HashMap<u16, usize, BuildHasherDefault<SourceHasher>>,
    /// Place of the source heard last: most packets come from the one before.
    current: usize,
}

impl Sources {
    /// Records one packet.
    #[inline]
    pub fn record(&mut self, system: u8, component: u8, sequence: u8, bytes: usize) {
        let key = u16::from_be_bytes([system, component]);
        match self.heard.get_mut(self.current) {
            Some((current, source)) if *current == key => source.hear(sequence, bytes as u64),
            _ => self.change(key, sequence, bytes as u64),
        }
    }

    fn change(&mut self, key: u16, sequence: u8, bytes: u64) {
        if let Some(&place) = self.places.get(&key) {
            self.current = place;
            self.heard[place].1.hear(sequence, bytes);
        } else {
            self.current = self.insert(key, Source::new(sequence, bytes));
        }
    }

    fn insert(&mut self, key: u16, source: Source) -> usize {
        let place = self.heard.len();
        self.places.insert(key, place);
        self.heard.push((key, source));
        place
    }

    /// Appends what was recorded of the stretch of the stream right behind this one.
    pub fn append(&mut self, next: &Self) {
        for &(key, after) in &next.heard {
            let Some(&place) = self.places.get(&key) else {
                self.insert(key, after);
                continue;
            };
            self.heard[place].1.join(&after);
        }
    }

    /// All sources as (system, component, what was heard), in order of their ids.
    #[must_use]
    pub fn all(&self) -> Vec<(u8, u8, Source)> {
        let mut all: Vec<_> = self
            .heard
            .iter()
            .map(|&(key, source)| {
                let [system, component] = key.to_be_bytes();
                (system, component, source)
            })
            .collect();
        all.sort_unstable_by_key(|&(system, component, _)| (system, component));
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn heard(sequences: &[u8]) -> Source {
        let mut sources = Sources::default();
        for &sequence in sequences {
            sources.record(1, 1, sequence, 21);
        }
        sources.all()[0].2
    }

    #[test]
    fn gaps_are_loss_across_the_wrap() {
        assert_eq!(heard(&[254, 255, 0, 1]).lost, 0);
        assert_eq!(heard(&[254, 2]).lost, 3);
    }

    #[test]
    fn a_late_packet_was_not_lost() {
        let source = heard(&[1, 2, 4, 3, 5]);
        assert_eq!((source.lost, source.late), (0, 1));
    }

    #[test]
    fn a_duplicate_fills_no_hole() {
        let source = heard(&[1, 3, 3]);
        assert_eq!((source.lost, source.late), (1, 1));
    }

    #[test]
    fn a_restart_is_not_loss() {
        assert_eq!(heard(&[100, 101, 0, 1, 2]).lost, 0);
    }

    #[test]
    fn sources_are_counted_apart() {
        let mut sources = Sources::default();
        for sequence in 0..10 {
            sources.record(1, 1, sequence, 20);
            sources.record(1, 100, sequence * 2, 30);
        }
        let all = sources.all();
        assert_eq!((all[0].0, all[0].1, all[0].2.lost, all[0].2.bytes), (1, 1, 0, 200));
        assert_eq!((all[1].1, all[1].2.lost, all[1].2.bytes), (100, 9, 300));
    }

    #[test]
    fn appending_equals_one_run() {
        let numbers: Vec<u8> = vec![250, 251, 255, 0, 3, 1, 5, 4, 4, 9, 10, 7, 6, 20];
        let whole = heard(&numbers);
        for cut in 1..numbers.len() {
            let (mut left, mut right) = (Sources::default(), Sources::default());
            numbers[..cut].iter().for_each(|&number| left.record(1, 1, number, 21));
            numbers[cut..].iter().for_each(|&number| right.record(1, 1, number, 21));
            left.append(&right);
            let joined = left.all()[0].2;
            let counts = |source: &Source| (source.received, source.bytes, source.lost, source.late, source.last);
            assert_eq!(counts(&joined), counts(&whole), "cut at {cut}");
        }
    }
}
