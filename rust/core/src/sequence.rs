//! Packet loss per source, from the gaps in its sequence numbers.
//!
//! A source is a (system, component) received on one link. A forward step of less than half the number range is loss;
//! a packet from up to [`LATE_WINDOW`] numbers back is late or a duplicate, and a late packet was counted as lost
//! before it arrived; any other step backwards is a sender that restarted, and is not counted as loss.

use crate::saved::{Reader, Writer};
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Number of sequence numbers by which a packet may be late; a larger step back is a restart.
const LATE_WINDOW: u8 = 16;

/// Number of sources of a full table of which the one with the fewest packets is replaced by a new source.
const REPLACEMENT_SAMPLE: usize = 8;

/// Statistics of one source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source {
    pub received: u64,
    pub bytes: u64,
    pub lost: u64,
    /// Late or duplicate packets.
    pub late: u64,
    last: u8,
    run: SequenceRun,
}

/// The first sequence numbers of a segment and the counters after them. When a segment is joined to the previous one,
/// these numbers are counted again, because some may be late packets of a gap before the border.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct SequenceRun {
    numbers: [u8; LATE_WINDOW as usize + 1],
    length: u8,
    lost: u64,
    late: u64,
}

impl Source {
    fn new(sequence: u8, bytes: u64) -> Self {
        let mut run = SequenceRun { numbers: [0; LATE_WINDOW as usize + 1], length: 1, lost: 0, late: 0 };
        run.numbers[0] = sequence;
        Self { received: 1, bytes, lost: 0, late: 0, last: sequence, run }
    }

    #[inline]
    fn record(&mut self, sequence: u8, bytes: u64) {
        self.received += 1;
        self.bytes += bytes;
        self.step(sequence);
        if usize::from(self.run.length) < self.run.numbers.len() {
            self.extend_run(sequence);
        }
    }

    #[cold]
    fn extend_run(&mut self, sequence: u8) {
        self.run.numbers[usize::from(self.run.length)] = sequence;
        self.run.length += 1;
        (self.run.lost, self.run.late) = (self.lost, self.late);
    }

    /// Adds the statistics of the next segment of the stream.
    fn join(&mut self, next: &Self) {
        let SequenceRun { numbers, length, lost, late } = next.run;
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
            // gap 255 repeats the last number: a duplicate fills no gap.
            self.lost = self.lost.saturating_sub(u64::from(gap != 255));
            return;
        }
        self.last = sequence;
    }
}

/// Hashes a source by one multiplication: keys are two bytes, which also bounds the table.
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

/// Sequence statistics of the sources received on one link.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    /// Maximum number of sources; `None`: all.
    limit: Option<usize>,
    /// Position at which the next source to replace is looked for.
    hand: usize,
    entries: Vec<(u16, Source)>,
    positions: HashMap<u16, usize, BuildHasherDefault<SourceHasher>>,
    /// Position of the most recent source: most packets come from the same source as the packet before.
    current: usize,
}

impl Sources {
    /// Creates a table of at most `limit` sources; when it is full, a new source replaces one with few packets.
    #[must_use]
    pub fn bounded(limit: usize) -> Self {
        Self { limit: Some(limit), ..Self::default() }
    }

    /// Records one packet.
    #[inline]
    pub fn record(&mut self, system: u8, component: u8, sequence: u8, bytes: usize) {
        let key = u16::from_be_bytes([system, component]);
        match self.entries.get_mut(self.current) {
            Some((current, source)) if *current == key => source.record(sequence, bytes as u64),
            _ => self.switch_source(key, sequence, bytes as u64),
        }
    }

    fn switch_source(&mut self, key: u16, sequence: u8, bytes: u64) {
        if let Some(&position) = self.positions.get(&key) {
            self.current = position;
            self.entries[position].1.record(sequence, bytes);
        } else {
            self.current = self.insert(key, Source::new(sequence, bytes));
        }
    }

    fn insert(&mut self, key: u16, source: Source) -> usize {
        let position = self.entries.len();
        if self.limit.is_some_and(|limit| position >= limit) {
            return self.replace(key, source);
        }
        self.positions.insert(key, position);
        self.entries.push((key, source));
        position
    }

    #[cold]
    fn replace(&mut self, key: u16, source: Source) -> usize {
        let count = self.entries.len();
        let sample = (self.hand..self.hand + REPLACEMENT_SAMPLE).map(|position| position % count);
        let position = sample.min_by_key(|&position| self.entries[position].1.received).unwrap_or(0);
        self.hand = (self.hand + REPLACEMENT_SAMPLE) % count;
        self.positions.remove(&self.entries[position].0);
        self.positions.insert(key, position);
        self.entries[position] = (key, source);
        position
    }

    /// Appends the statistics of the segment that directly follows this one.
    pub fn append(&mut self, next: &Self) {
        for &(key, after) in &next.entries {
            let Some(&position) = self.positions.get(&key) else {
                self.insert(key, after);
                continue;
            };
            self.entries[position].1.join(&after);
        }
    }

    pub(crate) fn save(&self, writer: &mut Writer) {
        writer.size(self.entries.len());
        for (key, source) in &self.entries {
            let &Source { received, bytes, lost, late, last, run } = source;
            for number in [(*key).into(), received, bytes, lost, late, last.into(), run.lost, run.late] {
                writer.number(number);
            }
            writer.octets(&run.numbers[..usize::from(run.length)]);
        }
    }

    /// Reads the sources of a table without limit.
    pub(crate) fn restore(reader: &mut Reader<'_>) -> Option<Self> {
        let mut sources = Self::default();
        for _ in 0..reader.length(9 * size_of::<u64>())? {
            let (key, mut source) = (u16::try_from(reader.number()?).ok()?, Source::new(0, 0));
            for count in [&mut source.received, &mut source.bytes, &mut source.lost, &mut source.late] {
                *count = reader.number()?;
            }
            source.last = u8::try_from(reader.number()?).ok()?;
            (source.run.lost, source.run.late) = (reader.number()?, reader.number()?);
            let numbers = reader.octets()?;
            source.run.numbers.get_mut(..numbers.len())?.copy_from_slice(numbers);
            source.run.length = numbers.len() as u8;
            sources.insert(key, source);
        }
        Some(sources)
    }

    /// All sources as (system, component, statistics), ordered by their ids.
    #[must_use]
    pub fn all(&self) -> Vec<(u8, u8, Source)> {
        let mut all: Vec<_> = self
            .entries
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

    fn source_of(sequences: &[u8]) -> Source {
        let mut sources = Sources::default();
        for &sequence in sequences {
            sources.record(1, 1, sequence, 21);
        }
        sources.all()[0].2
    }

    #[test]
    fn gaps_are_loss_across_the_wrap() {
        assert_eq!(source_of(&[254, 255, 0, 1]).lost, 0);
        assert_eq!(source_of(&[254, 2]).lost, 3);
    }

    #[test]
    fn a_late_packet_is_not_counted_as_lost() {
        let source = source_of(&[1, 2, 4, 3, 5]);
        assert_eq!((source.lost, source.late), (0, 1));
    }

    #[test]
    fn a_duplicate_fills_no_gap() {
        let source = source_of(&[1, 3, 3]);
        assert_eq!((source.lost, source.late), (1, 1));
    }

    #[test]
    fn a_restart_is_not_loss() {
        assert_eq!(source_of(&[100, 101, 0, 1, 2]).lost, 0);
    }

    #[test]
    fn sources_are_counted_separately() {
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
    fn a_bounded_table_keeps_the_sources_with_many_packets() {
        let mut sources = Sources::bounded(64);
        (0..100).for_each(|sequence| sources.record(1, 1, sequence, 21));
        for forged in 0..=u16::MAX {
            let [system, component] = forged.to_be_bytes();
            sources.record(system, component, 0, 21);
        }
        let all = sources.all();
        assert_eq!(all.len(), 64);
        assert!(all.iter().any(|&(system, component, source)| (system, component) == (1, 1) && source.received > 100));
    }

    #[test]
    fn appended_segments_count_as_one_stream() {
        let numbers: Vec<u8> = vec![250, 251, 255, 0, 3, 1, 5, 4, 4, 9, 10, 7, 6, 20];
        let whole = source_of(&numbers);
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
