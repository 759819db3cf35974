//! The index of a log: which records are the rows of which table.
//!
//! The log is divided into segments of equal length. The index of a segment holds the positions of its records by
//! definition, or, beyond a number of records, only how many there are; the segment is then walked again when its rows
//! are needed. An index therefore takes little memory however large the log is.
//!
//! Several threads give exactly the result of one. Each walks a run of segments from a place that looks like the
//! beginning of a record, with the types known at the end of what is certain. A run is valid if the one before it ends
//! at exactly this place with these types. The first invalid run and all runs after it are divided again.

use super::format::{Definition, Formats, HEADER, Redefinition, Types};
use super::neighbours::{Timed, neighbour_times};
use super::row::Layout;
use super::scan::{Damage, Place, Walk};
use super::segment::{SEGMENT, Segment, by_slot, count};
use mavstack_core::jobs;
use memchr::memmem;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Maximum number of records whose positions are kept.
const MAX_KEPT: usize = if cfg!(test) { 2000 } else { 1 << 25 };
/// Number of times that a log is divided among the threads; what is then left is for one.
const MAX_ROUNDS: usize = 4;
/// Number of bytes, and of headers in them, among which the first record of a run is searched.
const MAX_SEARCH: usize = 1 << 16;
const MAX_CANDIDATES: usize = 1 << 12;
/// Number of consecutive records with which a run may begin.
const RECORDS_TO_BEGIN: usize = 4;

/// Consecutive segments that one thread has walked.
struct Run {
    begin: Place,
    end: Place,
    segments: Vec<Segment>,
    formats: Formats,
    damage: Damage,
    redefinitions: Vec<Redefinition>,
}

/// The rows of one table that are to be decoded.
pub struct Request<'a> {
    pub slot: usize,
    /// Number of the first row.
    pub first: usize,
    pub layout: &'a Layout,
    /// The memory of the rows; its length is a multiple of the size of a row.
    pub rows: &'a mut [u8],
}

/// Positions of all records of a log, by definition.
#[derive(Debug, Default)]
pub struct Index {
    pub(super) segments: Vec<Segment>,
    pub(super) formats: Formats,
    rows: Vec<usize>,
    pub(super) damage: Damage,
    pub(super) redefinitions: Vec<Redefinition>,
}

impl Index {
    /// Indexes `data` on up to `threads` threads.
    #[must_use]
    pub fn build(data: &[u8], threads: usize) -> Self {
        Self::build_in_steps(data, threads, data.len(), |_| {})
    }

    /// Indexes `data` in steps of about `step` bytes. `done` is called with each part of the data that is indexed, so
    /// that the caller can give its memory back.
    pub fn build_in_steps(data: &[u8], threads: usize, step: usize, mut done: impl FnMut(Range<usize>)) -> Self {
        let mut index = Self::default();
        let mut place = Place::START;
        while place.position < data.len() {
            let begin = place.position;
            let end = (segment_at(begin) + (step / SEGMENT).max(1)) * SEGMENT;
            place = index.extend(data, place, end.min(data.len()), threads);
            done(begin..place.position);
        }
        index.count_rows();
        index
    }

    /// Indexes the records from `place` to `end`. Returns the place after them.
    fn extend(&mut self, data: &[u8], mut place: Place, end: usize, threads: usize) -> Place {
        for round in 1..=MAX_ROUNDS {
            let assumed = self.formats.clone();
            let threads = if round < MAX_ROUNDS { threads } else { 1 };
            let begins = run_begins(data, place, end, &assumed.types, threads);
            for run in walk_runs(data, &begins, end, &assumed, self.kept()) {
                if run.begin != place || self.formats != assumed {
                    break;
                }
                place = run.end;
                self.append(run);
            }
            if place.position >= end {
                break;
            }
        }
        place
    }

    /// Number of records whose positions are kept.
    fn kept(&self) -> usize {
        self.segments.iter().filter_map(|segment| segment.offsets.as_ref()).map(|offsets| offsets.len()).sum()
    }

    fn append(&mut self, run: Run) {
        self.segments.extend(run.segments);
        self.formats = run.formats;
        self.damage.add(&run.damage);
        self.redefinitions.extend(run.redefinitions);
    }

    pub(super) fn count_rows(&mut self) {
        self.rows = vec![0; self.formats.definitions().len()];
        for segment in &self.segments {
            for slot in 0..segment.slots() {
                self.rows[slot] += segment.rows(slot);
            }
        }
    }

    /// The definitions; the number of one is its slot.
    #[must_use]
    pub fn definitions(&self) -> &[Definition] {
        self.formats.definitions()
    }

    /// The places where type numbers got their definitions, in file order.
    #[must_use]
    pub fn redefinitions(&self) -> &[Redefinition] {
        &self.redefinitions
    }

    #[must_use]
    pub fn damage(&self) -> &Damage {
        &self.damage
    }

    /// Number of records of the definition in `slot`.
    #[must_use]
    pub fn rows(&self, slot: usize) -> usize {
        self.rows.get(slot).copied().unwrap_or(0)
    }

    /// Number of records of each slot that begin before `position`.
    #[must_use]
    pub fn rows_before(&self, data: &[u8], position: usize) -> Vec<usize> {
        let mut rows = vec![0; self.rows.len()];
        for segment in self.segments.iter().take_while(|segment| segment.base() < position) {
            let offsets = (segment.end() > position).then(|| segment.offsets(data, &self.formats));
            for (slot, sum) in rows.iter_mut().enumerate().take(segment.slots()) {
                *sum += match &offsets {
                    None => segment.rows(slot),
                    Some(offsets) => offsets[segment.range(slot)]
                        .partition_point(|&offset| segment.base() + (offset as usize) < position),
                };
            }
        }
        rows
    }

    /// Writes the positions of the records of `slot`, from number `first` on.
    pub fn positions(&self, data: &[u8], slot: usize, first: usize, positions: &mut [u64]) {
        let mut before = 0;
        let mut positions = positions.iter_mut();
        for segment in &self.segments {
            let skipped = first.saturating_sub(before);
            before += segment.rows(slot);
            if before > first && positions.len() > 0 {
                let offsets = segment.offsets(data, &self.formats);
                for (&offset, position) in offsets[segment.range(slot)].iter().skip(skipped).zip(&mut positions) {
                    *position = segment.base() as u64 + u64::from(offset);
                }
            }
        }
    }

    /// Writes the times of records without a time: the time of the record before each, or else after it.
    pub fn neighbour_times(&self, data: &[u8], slot: usize, clocks: &[Timed<'_>], times: &mut [i64]) {
        neighbour_times(&self.segments, &self.formats, data, slot, clocks, times);
    }

    /// True if the positions of some records are kept: of a very large log they are kept up to a number of records.
    #[must_use]
    pub fn has_positions(&self) -> bool {
        self.segments.iter().any(|segment| segment.offsets.is_some())
    }

    /// The same index in less memory: segments are walked again when their rows are needed.
    #[must_use]
    pub fn without_positions(&self) -> Self {
        Self {
            segments: self.segments.iter().map(Segment::without_offsets).collect(),
            formats: self.formats.clone(),
            rows: self.rows.clone(),
            damage: self.damage.clone(),
            redefinitions: self.redefinitions.clone(),
        }
    }

    /// Decodes rows of several tables on up to `threads` threads.
    ///
    /// `data` must be the indexed bytes; records that are no longer in it become rows of zeros.
    pub fn decode(&self, data: &[u8], requests: Vec<Request<'_>>, threads: usize) {
        jobs::run(self.jobs(requests), threads, |(segment, parts)| {
            let offsets = segment.offsets(data, &self.formats);
            let data = &data[segment.base().min(data.len())..];
            for (layout, records, rows) in parts {
                layout.decode(data, &offsets[records], rows);
            }
        });
    }

    /// Divides requests by segment.
    fn jobs<'a>(&self, mut requests: Vec<Request<'a>>) -> Vec<Job<'_, 'a>> {
        let mut jobs = Vec::new();
        for segment in &self.segments {
            let mut parts = Vec::new();
            for request in &mut requests {
                let records = segment.range(request.slot);
                let skipped = request.first.min(records.len());
                request.first -= skipped;
                let size = request.layout.row_size();
                let wanted = (records.len() - skipped).min(request.rows.len() / size);
                if wanted > 0 {
                    let begin = records.start + skipped;
                    let rows = request.rows.split_off_mut(..wanted * size).unwrap_or_default();
                    parts.push((request.layout, begin..begin + wanted, rows));
                }
            }
            if !parts.is_empty() {
                jobs.push((segment, parts));
            }
        }
        jobs
    }
}

/// A segment and parts of tables: the layout, the records by their place among the offsets, the rows.
type Job<'index, 'rows> = (&'index Segment, Vec<(&'rows Layout, Range<usize>, &'rows mut [u8])>);

/// Number of the segment in which `position` is.
fn segment_at(position: usize) -> usize {
    position / SEGMENT
}

/// Divides the log from `place` to `end` into runs; returns the places where they begin.
fn run_begins(data: &[u8], place: Place, end: usize, types: &Types, threads: usize) -> Vec<Place> {
    let (first, last) = (segment_at(place.position), end.div_ceil(SEGMENT));
    let segments = last.saturating_sub(first);
    let runs = threads.clamp(1, segments.max(1));
    let nominal = (1..runs).map(|run| (first + segments * run / runs) * SEGMENT);
    [place].into_iter().chain(nominal.map(|position| first_record(data, position, types))).collect()
}

/// Walks runs that begin at the given places, each on its own thread.
fn walk_runs(data: &[u8], begins: &[Place], end: usize, formats: &Formats, kept: usize) -> Vec<Run> {
    let kept = AtomicUsize::new(kept);
    let ends = begins.iter().skip(1).map(|begin| segment_at(begin.position)).chain([end.div_ceil(SEGMENT)]);
    let runs = begins.iter().copied().zip(ends).collect();
    jobs::collect(runs, begins.len(), |(begin, end)| walk_run(data, begin, formats.clone(), end, &kept))
}

/// Walks from `begin` to the beginning of the segment `end`.
fn walk_run(data: &[u8], begin: Place, formats: Formats, end: usize, kept: &AtomicUsize) -> Run {
    let mut walk = Walk::new(data, begin, formats);
    let mut segments: Vec<Segment> = Vec::new();
    let mut records = Vec::new();
    for number in segment_at(begin.position)..end {
        let begin = walk.place;
        let types = match segments.last() {
            Some(last) if *last.types == walk.formats.types => Arc::clone(&last.types),
            _ => Arc::new(walk.formats.types.clone()),
        };
        records.clear();
        walk.run((number + 1) * SEGMENT, |record| records.push(record));
        let sums = count(&records);
        let keep = kept.fetch_add(records.len(), Ordering::Relaxed) + records.len() <= MAX_KEPT;
        let offsets = keep.then(|| by_slot(&records, &sums, number * SEGMENT).into());
        segments.push(Segment { number, begin, types, sums, offsets });
    }
    let Walk { place, formats, damage, redefinitions, .. } = walk;
    Run { begin, end: place, segments, formats, damage, redefinitions }
}

/// The place of the first record at or after `position`, as far as that can be told from there.
fn first_record(data: &[u8], position: usize, types: &Types) -> Place {
    let window = &data[position..data.len().min(position + MAX_SEARCH)];
    let found = memmem::find_iter(window, &HEADER).map(|found| position + found);
    let begin = found.take(MAX_CANDIDATES).find(|&begin| looks_like_records(data, begin, types));
    begin.map_or(Place { position, aligned: false }, |position| Place { position, aligned: true })
}

/// Returns whether several records follow each other at `position`.
fn looks_like_records(data: &[u8], mut position: usize, types: &Types) -> bool {
    for _ in 0..RECORDS_TO_BEGIN {
        match data.get(position..).and_then(|rest| rest.first_chunk()) {
            Some(&[first, second, kind]) if [first, second] == HEADER && types.length(kind) > 0 => {
                position += types.length(kind);
            }
            _ => return false,
        }
    }
    true
}

#[cfg(test)]
#[path = "index_tests.rs"]
mod tests;
