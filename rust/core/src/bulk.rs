//! A whole file at once: an index of its packets, then each message's packets as rows of a table.
//!
//! Indexing on several threads gives exactly what one thread gives. The scanner's state between two packets
//! is its position alone, so a thread that reaches a later thread's starting point exactly proves that
//! thread's work right; where it does not (a false start inside junk), it goes on through that stretch
//! itself, and the later thread's work is thrown away.

use crate::header::Header;
use crate::layout::{Dialect, FieldType, Layout};
use crate::parser::Packet;
use crate::scan::{Found, Scanner, TIMESTAMP, timestamp_microseconds};
use crate::sequence::Sources;
use crate::statistics::Statistics;
use std::collections::BTreeMap;
use std::sync::Mutex;
use std::thread;

/// Bytes of a row before the payload: time in microseconds (8), system, component, sequence, version.
pub const ROW_HEADER: usize = 12;
/// Time of a row whose packet has none: numpy's "not a time".
pub const NO_TIME: i64 = i64::MIN;
/// A stretch of a file shorter than this is not worth a thread.
const MIN_STRETCH: usize = 1 << 20;
/// Rows that a thread decodes at a time.
const JOB: usize = 16_384;
/// Bytes that the memory fetches at a time, on most machines.
const CACHE_LINE: usize = 64;
/// Rows whose memory is asked for together.
const BATCH: usize = 64;
/// How far into a stretch its first packet is sought.
const MAX_SPLIT_SEARCH: usize = 1 << 16;
/// Set in an offset whose packet has a timestamp before it.
const STAMPED: u32 = 1 << 31;

/// Bytes of a file that the offsets of one part reach; few in tests, so that they cross the border.
const MAX_SPAN: usize = if cfg!(test) { 1 << 18 } else { STAMPED as usize };

/// Where the packets of a part of a file are: short offsets from where it begins.
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

    /// Whether an offset from here reaches `start`.
    fn reaches(&self, start: usize) -> bool {
        start - self.base < MAX_SPAN
    }
}

/// Where every packet of a file is, by message.
#[derive(Debug, Default)]
pub struct Index {
    parts: Vec<Part>,
    unknown: BTreeMap<u32, u64>,
    statistics: Statistics,
    sources: Sources,
    first_time: Option<u64>,
    last_time: Option<u64>,
}

/// Bytes of a row of `layout`'s table, a multiple of four so that rows stay aligned.
#[must_use]
pub fn row_size(layout: &Layout) -> usize {
    (ROW_HEADER + usize::from(layout.length)).next_multiple_of(4)
}

/// One thread's part: `start..end` of the file, packets that begin before `end` included whole.
struct Stretch {
    index: Index,
    start: usize,
    /// The boundary at which the scan stopped: at or behind the end.
    stopped: usize,
}

impl Index {
    /// Indexes `data` on up to `threads` threads.
    #[must_use]
    pub fn build(data: &[u8], dialect: &Dialect, timestamped: bool, threads: usize) -> Self {
        let starts = split_points(data, dialect, timestamped, threads);
        let stretches: Vec<Stretch> = thread::scope(|scope| {
            let ends = starts.iter().skip(1).copied().chain([data.len()]);
            let running: Vec<_> = starts
                .iter()
                .zip(ends)
                .map(|(&start, end)| scope.spawn(move || scan_stretch(data, dialect, timestamped, start, end)))
                .collect();
            running.into_iter().map(|thread| thread.join().expect("a scan does not panic")).collect()
        });
        let mut whole = Self::default();
        let mut reached = 0;
        for stretch in stretches {
            // A stretch that was entered in the middle of a packet is scanned again from where that ended.
            let stretch = if stretch.start == reached {
                stretch
            } else {
                scan_stretch(data, dialect, timestamped, reached, stretch.stopped.max(reached))
            };
            reached = stretch.stopped;
            whole.append(stretch.index);
        }
        whole
    }

    #[inline]
    fn record(&mut self, data: &[u8], found: &Found) {
        let Header { system, component, sequence, message_id, .. } = found.header;
        self.sources.record(system, component, sequence, found.range().len());
        match found.slot {
            Some(slot) => self.place(found, slot),
            None => *self.unknown.entry(message_id).or_default() += 1,
        }
        if found.timestamped {
            self.include(Packet::new(data, found).timestamp);
        }
    }

    #[inline]
    fn place(&mut self, found: &Found, slot: u16) {
        if let Some(part) = self.parts.last_mut()
            && part.reaches(found.start)
        {
            let stamped = if found.timestamped { STAMPED } else { 0 };
            part.offsets[usize::from(slot)].push((found.start - part.base) as u32 | stamped);
        } else {
            let slots = self.parts.last().map_or(0, |part| part.offsets.len());
            // From before the packet's timestamp, which is read with it.
            self.parts.push(Part::new(found.start.saturating_sub(TIMESTAMP), slots));
            self.place(found, slot);
        }
    }

    #[inline]
    fn include(&mut self, time: Option<u64>) {
        if let Some(time) = time.filter(|&time| i64::try_from(time).is_ok()) {
            self.first_time = Some(self.first_time.map_or(time, |first| first.min(time)));
            self.last_time = Some(self.last_time.map_or(time, |last| last.max(time)));
        }
    }

    fn append(&mut self, next: Self) {
        self.parts.extend(next.parts);
        for (id, count) in next.unknown {
            *self.unknown.entry(id).or_default() += count;
        }
        self.statistics.add(&next.statistics);
        self.sources.append(&next.sources);
        self.include(next.first_time);
        self.include(next.last_time);
    }

    /// Number of packets of the layout in `slot`.
    #[must_use]
    pub fn rows(&self, slot: usize) -> usize {
        self.parts.iter().map(|part| part.offsets.get(slot).map_or(0, Vec::len)).sum()
    }

    /// Packets of ids that the dialect does not have, by id.
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

    /// Earliest and latest time of a packet, in microseconds since 1970.
    #[must_use]
    pub fn time_span(&self) -> Option<(u64, u64)> {
        self.first_time.zip(self.last_time)
    }

    /// Writes the rows of each slot's layout to the bytes beside it, which must be exactly as long as they are.
    ///
    /// `data` must be what was indexed; packets that are no longer there become rows of zeros.
    pub fn decode(&self, data: &[u8], dialect: &Dialect, tables: Vec<(usize, &mut [u8])>, threads: usize) {
        let mut jobs = Vec::new();
        for (slot, mut table) in tables {
            let Some(layout) = dialect.layouts().get(slot) else {
                continue;
            };
            for part in &self.parts {
                for offsets in part.offsets.get(slot).map_or(&[][..], Vec::as_slice).chunks(JOB) {
                    let rows = table.split_off_mut(..offsets.len() * row_size(layout)).unwrap_or_default();
                    jobs.push((layout, &data[part.base.min(data.len())..], offsets, rows));
                }
            }
        }
        let threads = threads.min(jobs.len());
        let jobs = Mutex::new(jobs.into_iter());
        let next = || jobs.lock().ok()?.next();
        let work = || {
            while let Some((layout, data, offsets, rows)) = next() {
                decode_rows(data, layout, offsets, rows);
            }
        };
        thread::scope(|scope| {
            for _ in 1..threads {
                scope.spawn(work);
            }
            work();
        });
    }
}

/// Starting points for the threads: 0, and ends of packets that another packet follows at once.
fn split_points(data: &[u8], dialect: &Dialect, timestamped: bool, threads: usize) -> Vec<usize> {
    let stretches = threads.min(data.len() / MIN_STRETCH).max(1);
    let mut starts = vec![0];
    for nominal in (1..stretches).map(|number| data.len() / stretches * number) {
        let window = &data[nominal..data.len().min(nominal + MAX_SPLIT_SEARCH)];
        let mut scanner = Scanner::resume(window, dialect, timestamped, 1, 0);
        let mut ignored = Statistics::default();
        while let Some(found) = scanner.next_packet(&mut ignored) {
            let end = found.range().end;
            let follower = scanner.next_packet(&mut ignored);
            let gap = if timestamped { TIMESTAMP } else { 0 };
            if found.slot.is_some() && follower.is_some_and(|follower| follower.start == end + gap) {
                starts.push(nominal + end);
                break;
            }
        }
    }
    starts
}

fn scan_stretch(data: &[u8], dialect: &Dialect, timestamped: bool, start: usize, end: usize) -> Stretch {
    let mut index = Index { parts: vec![Part::new(start, dialect.layouts().len())], ..Index::default() };
    let mut statistics = Statistics::default();
    let mut scanner = Scanner::resume(data, dialect, timestamped, start, start);
    while scanner.boundary() < end {
        let Some(found) = scanner.next_packet_at_end(&mut statistics) else {
            break;
        };
        index.record(data, &found);
    }
    index.statistics = statistics;
    Stretch { index, start, stopped: scanner.boundary() }
}

fn decode_rows(data: &[u8], layout: &Layout, offsets: &[u32], rows: &mut [u8]) {
    let texts: Vec<_> = layout
        .fields
        .iter()
        .filter(|field| field.kind == FieldType::Char && field.array_length > 0)
        .map(crate::layout::Field::range)
        .collect();
    let size = row_size(layout);
    for (batch, rows) in offsets.chunks(BATCH).zip(rows.chunks_mut(BATCH * size)) {
        touch(data, batch);
        for (&offset, row) in batch.iter().zip(rows.chunks_exact_mut(size)) {
            decode_row(data, offset, row, usize::from(layout.length));
            for text in &texts {
                clear_behind_nul(&mut row[ROW_HEADER..][text.clone()]);
            }
        }
    }
}

/// Reads a byte of each packet's timestamp and one of its payload, so that the memory fetches all of them side by
/// side: a message's packets are far apart in the file, and one at a time each would be waited for.
#[inline]
fn touch(data: &[u8], batch: &[u32]) {
    let byte = |place: usize| data.get(place).copied().unwrap_or(0);
    let touched = batch.iter().fold(0, |sum, &offset| {
        let start = (offset & !STAMPED) as usize;
        sum ^ byte(start.saturating_sub(TIMESTAMP)) ^ byte(start + CACHE_LINE / 2)
    });
    std::hint::black_box(touched);
}

#[inline]
fn decode_row(data: &[u8], offset: u32, row: &mut [u8], length: usize) {
    let start = (offset & !STAMPED) as usize;
    let Some(header) = data.get(start..).and_then(Header::parse) else {
        row.fill(0);
        return;
    };
    let time = match data[..start].last_chunk::<TIMESTAMP>() {
        Some(&stamp) if offset & STAMPED != 0 => i64::try_from(timestamp_microseconds(stamp)).unwrap_or(NO_TIME),
        _ => NO_TIME,
    };
    row[..TIMESTAMP].copy_from_slice(&time.to_le_bytes());
    row[TIMESTAMP..ROW_HEADER].copy_from_slice(&[header.system, header.component, header.sequence, header.version]);
    let payload = data.get(start..).and_then(|packet| packet.get(header.payload())).unwrap_or(&[]);
    let known = payload.len().min(length);
    row[ROW_HEADER..ROW_HEADER + known].copy_from_slice(&payload[..known]);
    row[ROW_HEADER + known..].fill(0);
}

/// Blanks what follows the NUL of a text: junk by definition.
fn clear_behind_nul(text: &mut [u8]) {
    if let Some(end) = memchr::memchr(0, text) {
        text[end..].fill(0);
    }
}

#[cfg(test)]
#[path = "bulk_tests.rs"]
mod tests;
