//! Bulk decoding of a whole file: an index of its packets, then each message's packets as rows of a table.
//!
//! Indexing on several threads gives exactly the result of one thread. A segment begins where a packet directly follows
//! another one, so if a thread ends exactly at the starting point of the next segment, that segment's result is valid.
//! If not (a false start inside junk), the segment is scanned again from the right position and its first result is
//! discarded.

use crate::header::{Header, SIGNATURE};
use crate::jobs;
use crate::layout::{Dialect, Layout};
use crate::parser::Packet;
use crate::scan::{FrameSpan, Scanner, State};
use crate::sequence::Sources;
use crate::statistics::Statistics;
use crate::timestamps::TIMESTAMP;
use std::collections::BTreeMap;

/// Bytes of a row before the payload: time in microseconds (8), system, component, sequence, version.
pub const ROW_HEADER: usize = 12;
/// Time of a row whose packet has no timestamp: numpy's `NaT`.
pub const NO_TIME: i64 = i64::MIN;
/// Minimum size of a segment in bytes: a shorter one is not worth a thread.
const MIN_SEGMENT: usize = 1 << 20;
/// Maximum size of a segment in bytes: a thread that the system delays holds up the others by one segment at most.
const MAX_SEGMENT: usize = 8 << 20;
/// Number of segments for each thread, if they have the minimum size.
const SEGMENTS_PER_THREAD: usize = 4;
/// Number of bytes of a segment in which its first packet is searched.
const MAX_SPLIT_SEARCH: usize = 1 << 16;
/// Bit that is set in an offset if a timestamp precedes the packet.
const TIMESTAMPED_BIT: u32 = 1 << 31;

/// Number of bytes of a file that the offsets of one part address; small in tests, so that they cross parts.
const MAX_SPAN: usize = if cfg!(test) { 1 << 18 } else { TIMESTAMPED_BIT as usize };

/// Positions of the packets in a part of a file, as 32-bit offsets from its beginning.
#[derive(Debug)]
struct Part {
    base: usize,
    /// By layout slot.
    offsets: Vec<Vec<u32>>,
}

impl Part {
    fn new(base: usize, slots: usize) -> Self {
        Self { base, offsets: vec![Vec::new(); slots] }
    }

    /// Returns whether an offset in this part can address `start`.
    fn reaches(&self, start: usize) -> bool {
        start - self.base < MAX_SPAN
    }
}

/// Positions of all packets of a file, by message.
#[derive(Debug, Default)]
pub struct Index {
    parts: Vec<Part>,
    /// By layout slot: number of packets whose positions are not kept.
    other_rows: Vec<usize>,
    unknown: BTreeMap<u32, u64>,
    statistics: Statistics,
    sources: Sources,
    first_time: Option<u64>,
    last_time: Option<u64>,
}

/// Size in bytes of a row of `layout`'s table, a multiple of four so that rows stay aligned.
#[must_use]
pub fn row_size(layout: &Layout) -> usize {
    (ROW_HEADER + usize::from(layout.length)).next_multiple_of(4)
}

/// The scanned bytes.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub data: &'a [u8],
    pub dialect: &'a Dialect,
    pub timestamped: bool,
    /// False if more bytes follow, which may complete a packet at the end.
    pub at_end: bool,
}

/// The result of one thread: the packets that begin in `start..end` of the file.
struct Segment {
    index: Index,
    start: usize,
    /// State in which the scan stopped, at or after the end of the segment.
    stopped: State,
}

impl Index {
    /// Indexes `data` on up to `threads` threads.
    #[must_use]
    pub fn build(data: &[u8], dialect: &Dialect, timestamped: bool, threads: usize) -> Self {
        let source = Source { data, dialect, timestamped, at_end: true };
        Self::build_from(source, State::default(), threads).0
    }

    /// Indexes the bytes from `state` on; returns the state in which the scan stopped, too.
    pub(crate) fn build_from(source: Source<'_>, state: State, threads: usize) -> (Self, State) {
        let starts = split_points(source, threads);
        let states = std::iter::once(state).chain(starts.iter().map(|&start| State::at(start)));
        let ends = starts.iter().copied().chain([source.data.len()]);
        let ranges = states.zip(ends).collect();
        let segments = jobs::collect(ranges, threads, |(state, end)| scan_segment(source, state, end));
        let mut whole = Self::default();
        let mut covered = state;
        for (number, segment) in segments.into_iter().enumerate() {
            // A segment that starts inside a packet is scanned again from the end of that packet.
            let follows = segment.start == covered.boundary && covered.position == covered.boundary;
            let segment = if number == 0 || follows {
                segment
            } else {
                scan_segment(source, covered, segment.stopped.boundary.max(covered.boundary))
            };
            covered = segment.stopped;
            whole.append(segment.index);
        }
        (whole, covered)
    }

    #[inline]
    fn record(&mut self, data: &[u8], found: &FrameSpan) {
        let Header { system, component, sequence, message_id, .. } = found.header;
        self.sources.record(system, component, sequence, found.range().len());
        match found.slot {
            Some(slot) => self.record_offset(found, slot),
            None => *self.unknown.entry(message_id).or_default() += 1,
        }
        if found.timestamped {
            self.include_time(Packet::new(data, found).timestamp);
        }
    }

    #[inline]
    fn record_offset(&mut self, found: &FrameSpan, slot: u16) {
        if let Some(part) = self.parts.last_mut()
            && part.reaches(found.start)
        {
            let flag = if found.timestamped { TIMESTAMPED_BIT } else { 0 };
            part.offsets[usize::from(slot)].push((found.start - part.base) as u32 | flag);
        } else {
            let slots = self.parts.last().map_or(0, |part| part.offsets.len());
            // The part begins before the packet's timestamp, which is read with the packet.
            self.parts.push(Part::new(found.start.saturating_sub(TIMESTAMP), slots));
            self.record_offset(found, slot);
        }
    }

    #[inline]
    fn include_time(&mut self, time: Option<u64>) {
        if let Some(time) = time.filter(|&time| i64::try_from(time).is_ok()) {
            self.first_time = Some(self.first_time.map_or(time, |first| first.min(time)));
            self.last_time = Some(self.last_time.map_or(time, |last| last.max(time)));
        }
    }

    fn append(&mut self, next: Self) {
        self.append_totals(&next);
        self.parts.extend(next.parts);
    }

    /// Adds the totals of the index that directly follows this one, without its positions.
    pub(crate) fn append_totals(&mut self, next: &Self) {
        for (&id, count) in &next.unknown {
            *self.unknown.entry(id).or_default() += count;
        }
        self.statistics.add(&next.statistics);
        self.sources.append(&next.sources);
        self.include_time(next.first_time);
        self.include_time(next.last_time);
    }

    /// Counts bytes that are neither a packet nor needed to find one.
    pub(crate) fn add_bad_bytes(&mut self, count: usize) {
        self.statistics.bad_bytes += count as u64;
    }

    /// Number of packets of the layout in `slot`.
    #[must_use]
    pub fn rows(&self, slot: usize) -> usize {
        let kept: usize = self.parts.iter().map(|part| part.offsets.get(slot).map_or(0, Vec::len)).sum();
        kept + self.other_rows.get(slot).copied().unwrap_or(0)
    }

    /// True if the positions of all packets are kept, which decoding needs.
    #[must_use]
    pub fn has_positions(&self) -> bool {
        self.other_rows.iter().all(|&rows| rows == 0)
    }

    /// The same index without the positions of the packets.
    #[must_use]
    pub fn without_positions(&self, dialect: &Dialect) -> Self {
        Self {
            parts: Vec::new(),
            other_rows: (0..dialect.layouts().len()).map(|slot| self.rows(slot)).collect(),
            unknown: self.unknown.clone(),
            sources: self.sources.clone(),
            ..*self
        }
    }

    /// Number of packets of each id that is not in the dialect.
    #[must_use]
    pub fn unknown(&self) -> &BTreeMap<u32, u64> {
        &self.unknown
    }

    #[must_use]
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    #[must_use]
    pub fn sources(&self) -> &Sources {
        &self.sources
    }

    /// Earliest and latest timestamp in microseconds since 1970.
    #[must_use]
    pub fn time_span(&self) -> Option<(u64, u64)> {
        self.first_time.zip(self.last_time)
    }
}

/// Number of segments of `size` bytes for `threads` threads.
fn segment_count(size: usize, threads: usize) -> usize {
    if threads <= 1 {
        return 1;
    }
    (threads * SEGMENTS_PER_THREAD).max(size / MAX_SEGMENT).min(size / MIN_SEGMENT).max(1)
}

/// Starting points of the segments after the first: ends of packets that are directly followed by another packet.
fn split_points(source: Source<'_>, threads: usize) -> Vec<usize> {
    let Source { data, dialect, timestamped, .. } = source;
    let segments = segment_count(data.len(), threads);
    let mut starts = Vec::new();
    for nominal in (1..segments).map(|number| data.len() / segments * number) {
        let window = &data[nominal..data.len().min(nominal + MAX_SPLIT_SEARCH)];
        let mut scanner = Scanner::resume(window, dialect, timestamped, State::searching_from(1));
        let mut ignored = Statistics::default();
        while let Some(found) = scanner.next_packet(&mut ignored) {
            let end = found.range().end;
            let next = scanner.next_packet(&mut ignored);
            let gap = if timestamped { TIMESTAMP } else { 0 };
            if found.slot.is_some() && next.is_some_and(|next| next.start == end + gap) {
                starts.push(nominal + end);
                break;
            }
        }
    }
    starts
}

fn scan_segment(source: Source<'_>, state: State, end: usize) -> Segment {
    let Source { data, dialect, timestamped, at_end } = source;
    let start = state.boundary;
    // The first packet may begin in the signature before the segment.
    let part = Part::new(start.saturating_sub(SIGNATURE + TIMESTAMP), dialect.layouts().len());
    let mut index = Index { parts: vec![part], ..Index::default() };
    let mut statistics = Statistics::default();
    let mut scanner = Scanner::resume(data, dialect, timestamped, state);
    while scanner.state().boundary < end {
        let next = scanner.next_packet(&mut statistics);
        // Usually there is a packet: the end of the bytes is a separate call, so that this one is inlined.
        let next = if next.is_none() && at_end { scanner.next_packet_at_end(&mut statistics) } else { next };
        let Some(found) = next else {
            break;
        };
        index.record(data, &found);
    }
    index.statistics = statistics;
    Segment { index, start, stopped: scanner.state() }
}

#[path = "bulk_rows.rs"]
mod rows;

#[path = "bulk_saved.rs"]
mod saved;

#[cfg(test)]
#[path = "bulk_tests.rs"]
pub(crate) mod tests;
