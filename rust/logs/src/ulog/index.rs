//! The index of a file or of a part of it: the positions of each topic's records, and all other messages.
//!
//! Indexing on several threads gives exactly the result of one thread: the segment of a thread is used only if the scan
//! of the segment before it ends exactly at its starting point, and knew all subscriptions that were known there.
//! Otherwise the rest of the file is divided again.

use super::catalog::Table;
use super::header::Header;
use super::scan::{Damage, Message, Scanner, State};
use super::u16_at;
use mavstack_core::jobs;
use std::ops::Range;
use std::sync::Arc;

/// Number of bytes in which the starting point of a segment is searched.
const MAX_SPLIT_SEARCH: usize = 1 << 16;
/// Number of times that the rest of a file is divided again because subscriptions have changed.
const MAX_ROUNDS: usize = 8;
/// Number of bytes that the offsets of one part address.
const MAX_SPAN: usize = u32::MAX as usize;

/// How a file is indexed.
#[derive(Debug, Clone, Copy)]
pub struct Options {
    /// Maximum number of threads.
    pub threads: usize,
    /// Minimum size of a segment in bytes: a shorter one is not worth a thread.
    pub min_segment: usize,
    /// Whether the positions of the records are stored, which decoding needs; otherwise records are only counted.
    pub positions: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { threads: 1, min_segment: 1 << 20, positions: true }
    }
}

/// Records of a table in a part of a file.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Records {
    /// Positions, from the beginning of the part.
    pub offsets: Vec<u32>,
    /// Instance of each record.
    pub instances: Vec<u8>,
}

/// Positions of the records in a part of a file, by table.
#[derive(Debug, Clone, Default)]
pub struct Part {
    pub base: usize,
    pub tables: Vec<Records>,
}

/// A message that is not a record: a definition, a subscription, information, a parameter, a text or a dropout.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Entry {
    pub kind: u8,
    pub start: usize,
    /// Latest time of a record before it, in microseconds since boot.
    pub time: u64,
}

/// Index of a part of a file.
#[derive(Debug, Clone)]
pub struct Index {
    pub header: Header,
    pub parts: Vec<Part>,
    /// Number of records by table and instance.
    counts: Vec<Vec<u64>>,
    pub entries: Vec<Entry>,
    /// Number of bytes of all messages.
    pub message_bytes: u64,
    pub damage: Damage,
    /// Position of the first subscription or logged text: parameters after it are changes.
    pub definitions_end: Option<usize>,
    /// Earliest and latest time of a record in microseconds since boot.
    pub time_span: Option<(u64, u64)>,
    /// Latest time so far, including the parts before this one.
    pub(super) last_time: u64,
    start: usize,
    /// State after the last message.
    pub(super) state: State,
}

impl Index {
    /// The index of nothing, which begins at `start`.
    pub(super) fn empty(header: &Header, start: usize) -> Self {
        Self {
            header: header.clone(),
            parts: Vec::new(),
            counts: Vec::new(),
            entries: Vec::new(),
            message_bytes: 0,
            damage: Damage::default(),
            definitions_end: None,
            time_span: None,
            last_time: 0,
            start,
            state: State { position: start, catalog: Arc::default() },
        }
    }

    /// Indexes a whole file.
    #[must_use]
    pub fn build(data: &[u8], header: &Header, options: Options) -> Self {
        Self::first(data, header, data.len(), options)
    }

    /// Indexes a part of a file, from the beginning to the message that reaches `end`.
    #[must_use]
    pub fn first(data: &[u8], header: &Header, end: usize, options: Options) -> Self {
        Self::first_in_steps(data, header, end, options, usize::MAX, |_| {})
    }

    /// Indexes a part of a file in steps of about `step` bytes. `done` is called with each part of the data that is
    /// indexed, so that the caller can give its memory back.
    pub fn first_in_steps(
        data: &[u8],
        header: &Header,
        end: usize,
        options: Options,
        step: usize,
        mut done: impl FnMut(Range<usize>),
    ) -> Self {
        let step = step.max(options.min_segment);
        let mut whole = Self::resume(data, header, State::default(), header.start_time, end.min(step), options);
        let mut begin = 0;
        loop {
            done(begin..whole.state.position);
            begin = whole.state.position;
            if begin >= end.min(data.len()) {
                return whole;
            }
            whole.extend_to(data, end.min(data.len()).min(begin.saturating_add(step)), options);
        }
    }

    /// The same index without the positions of the records, which `decode` needs.
    #[must_use]
    pub fn without_positions(&self) -> Self {
        Self {
            header: self.header.clone(),
            parts: Vec::new(),
            counts: self.counts.clone(),
            entries: self.entries.clone(),
            damage: self.damage.clone(),
            state: self.state.clone(),
            ..*self
        }
    }

    /// Indexes the next `size` bytes of the file; None at its end.
    #[must_use]
    pub fn following(&self, data: &[u8], size: usize, options: Options) -> Option<Self> {
        let end = self.state.position.saturating_add(size.max(1));
        let more = self.state.position < data.len();
        more.then(|| Self::resume(data, &self.header, self.state.clone(), self.last_time, end, options))
    }

    fn resume(data: &[u8], header: &Header, state: State, time: u64, end: usize, options: Options) -> Self {
        let end = end.min(data.len());
        let first = end.min(state.position.saturating_add(options.min_segment));
        let mut whole = scan_segment(data, header, state, first, options);
        whole.last_time = whole.last_time.max(time);
        for entry in &mut whole.entries {
            entry.time = entry.time.max(time);
        }
        whole.extend_to(data, end, options);
        whole
    }

    /// Indexes the rest of the file up to `end`.
    fn extend_to(&mut self, data: &[u8], end: usize, options: Options) {
        for round in 0.. {
            if self.state.position >= end {
                break;
            }
            let threads = if round < MAX_ROUNDS { options.threads } else { 1 };
            self.extend(data, end, Options { threads, ..options });
        }
    }

    /// Indexes the rest of the file up to `end`, or up to a change of the subscriptions.
    fn extend(&mut self, data: &[u8], end: usize, options: Options) {
        let known = Arc::clone(&self.state.catalog);
        let header = self.header.clone();
        let starts = split_points(data, &header, &self.state, end, options);
        let ends = starts.iter().skip(1).copied().chain([end]);
        let ranges: Vec<_> = starts.iter().copied().zip(ends).collect();
        let segments = jobs::collect(ranges, options.threads, |(position, end)| {
            scan_segment(data, &header, State { position, catalog: Arc::clone(&known) }, end, options)
        });
        for segment in segments {
            if !Arc::ptr_eq(&self.state.catalog, &known) {
                return;
            }
            if segment.start == self.state.position {
                self.append(segment);
            } else if segment.state.position > self.state.position {
                // The segment began at a false start.
                self.append(scan_segment(data, &header, self.state.clone(), segment.state.position, options));
            }
        }
    }

    fn append(&mut self, next: Self) {
        self.parts.extend(next.parts);
        for (table, instances) in next.counts.into_iter().enumerate() {
            for (instance, count) in instances.into_iter().enumerate().filter(|&(_, count)| count > 0) {
                self.add_count(table, instance, count);
            }
        }
        let time = self.last_time;
        self.entries.extend(next.entries.into_iter().map(|entry| Entry { time: entry.time.max(time), ..entry }));
        self.message_bytes += next.message_bytes;
        self.damage.add(next.damage);
        self.definitions_end = self.definitions_end.or(next.definitions_end);
        self.last_time = time.max(next.last_time);
        self.time_span = match (self.time_span, next.time_span) {
            (Some(mine), Some(other)) => Some((mine.0.min(other.0), mine.1.max(other.1))),
            (mine, other) => mine.or(other),
        };
        self.state = next.state;
    }

    #[inline]
    pub(super) fn add_count(&mut self, table: usize, instance: usize, count: u64) {
        if self.counts.len() <= table {
            self.counts.resize(table + 1, Vec::new());
        }
        let counts = &mut self.counts[table];
        if counts.len() <= instance {
            counts.resize(instance + 1, 0);
        }
        counts[instance] += count;
    }

    /// The topics that have a subscription.
    #[must_use]
    pub fn tables(&self) -> &[Table] {
        self.state.catalog.tables()
    }

    /// Number of the table of a topic.
    #[must_use]
    pub fn table(&self, name: &str) -> Option<usize> {
        self.state.catalog.table(name)
    }

    /// Number of records of each instance of a table.
    #[must_use]
    pub fn instances(&self, table: usize) -> &[u64] {
        self.counts.get(table).map_or(&[], Vec::as_slice)
    }

    /// Number of records of a table.
    #[must_use]
    pub fn rows(&self, table: usize) -> usize {
        self.instances(table).iter().sum::<u64>() as usize
    }

    /// Position of the first byte after the indexed part.
    #[must_use]
    pub fn end(&self) -> usize {
        self.state.position
    }

    /// Body of an entry; empty if the data has changed since.
    #[must_use]
    pub fn body<'a>(&self, data: &'a [u8], entry: &Entry) -> &'a [u8] {
        let size = u16_at(data, entry.start).map_or(0, usize::from);
        data.get(entry.start + 3..entry.start + 3 + size).unwrap_or(&[])
    }
}

/// Starting points of the segments: the state's position, and places from which messages follow each other.
fn split_points(data: &[u8], header: &Header, state: &State, end: usize, options: Options) -> Vec<usize> {
    let length = end - state.position;
    let segments = options.threads.min(length / options.min_segment.max(1)).max(1);
    let mut starts = vec![state.position];
    for nominal in (1..segments).map(|number| state.position + length / segments * number) {
        let range = nominal..end.min(nominal + MAX_SPLIT_SEARCH);
        starts.extend(Scanner::find_start(data, header, &state.catalog, range));
    }
    starts.dedup();
    starts
}

fn scan_segment(data: &[u8], header: &Header, state: State, end: usize, options: Options) -> Index {
    let start = state.position;
    let mut index = Index::empty(header, start);
    index.parts.push(Part { base: start, tables: Vec::new() });
    let mut scanner = Scanner::new(data, header, state);
    while scanner.state.position < end
        && let Some(message) = scanner.next_message()
    {
        index.message_bytes += (message.end() - message.start) as u64;
        match message.kind {
            b'D' => index.record(&mut scanner, &message, options.positions),
            b'F' | b'A' | b'L' | b'C' => {
                scanner.learn(message.kind, message.body);
                if message.kind != b'F' {
                    index.definitions_end.get_or_insert(message.start);
                }
                index.enter(&message);
            }
            b'I' | b'M' | b'P' | b'Q' | b'O' => index.enter(&message),
            b'B' | b'R' | b'S' => {}
            kind => *scanner.damage.unknown_kinds.entry(kind).or_default() += 1,
        }
    }
    // After the last message of a file only damage remains.
    index.damage = scanner.damage;
    index.state = scanner.state;
    index
}

impl Index {
    #[inline]
    fn record(&mut self, scanner: &mut Scanner<'_>, message: &Message<'_>, positions: bool) {
        let Some(id) = u16_at(message.body, 0) else {
            scanner.damage.wrong_size += 1;
            return;
        };
        let Some(&subscription) = scanner.state.catalog.subscription(id) else {
            *scanner.damage.unsubscribed.entry(id).or_default() += 1;
            return;
        };
        let record = &message.body[2..];
        if !subscription.accepts(record.len()) {
            scanner.damage.wrong_size += 1;
            return;
        }
        if let Some(time) = subscription.time_of(record) {
            let (first, last) = self.time_span.unwrap_or((time, time));
            self.time_span = Some((first.min(time), last.max(time)));
            self.last_time = self.last_time.max(time);
        }
        let table = subscription.table as usize;
        self.add_count(table, subscription.instance.into(), 1);
        if positions {
            self.store(message.start, table, subscription.instance);
        }
    }

    #[inline]
    fn store(&mut self, start: usize, table: usize, instance: u8) {
        if let Some(part) = self.parts.last_mut()
            && start - part.base <= MAX_SPAN
        {
            if part.tables.len() <= table {
                part.tables.resize(table + 1, Records::default());
            }
            part.tables[table].offsets.push((start - part.base) as u32);
            part.tables[table].instances.push(instance);
        } else {
            self.parts.push(Part { base: start, tables: Vec::new() });
            self.store(start, table, instance);
        }
    }

    fn enter(&mut self, message: &Message<'_>) {
        self.entries.push(Entry { kind: message.kind, start: message.start, time: self.last_time });
    }
}
