//! Rows of tables: the packets of an index, copied out of the file.
//!
//! The packets of one message are far apart in a file. Therefore the rows of all tables are decoded block by block:
//! a block of the file stays in the cache of the processor until the packets of all tables are copied out of it.

use super::{Index, NO_TIME, Part, ROW_HEADER, TIMESTAMPED_BIT, row_size};
use crate::header::Header;
use crate::jobs;
use crate::layout::{Dialect, FieldType, Layout};
use crate::timestamps::{TIMESTAMP, timestamp_microseconds};

/// Number of bytes of a file whose rows are decoded together.
const BLOCK: usize = if cfg!(test) { 1 << 12 } else { 1 << 19 };
/// Size of a cache line in bytes, on most machines.
const CACHE_LINE: usize = 64;
/// Number of rows whose packets are prefetched together.
const ROWS_PER_BATCH: usize = 64;
/// Number of bytes that are copied at a time.
const CHUNK: usize = 16;
/// `KEPT[count]` keeps the first `count` bytes of a chunk, and clears the others.
const KEPT: [u128; CHUNK + 1] = kept();

/// The rows of a block: for each table its layout, the offsets of the packets and the memory of the rows.
type Block<'a> = (&'a [u8], Vec<(&'a Layout, &'a [u32], &'a mut [u8])>);

/// A table whose rows are to be written: what is left of its packets and of its memory.
struct Table<'a> {
    layout: &'a Layout,
    slot: usize,
    offsets: &'a [u32],
    rows: &'a mut [u8],
}

impl Index {
    /// Writes the rows of each slot to the buffer paired with it, whose length must be that of the rows.
    ///
    /// `data` must be the indexed bytes; packets that are no longer in it become rows of zeros.
    pub fn decode(&self, data: &[u8], dialect: &Dialect, tables: Vec<(usize, &mut [u8])>, threads: usize) {
        let table = |(slot, rows)| Some(Table { layout: dialect.layouts().get(slot)?, slot, offsets: &[], rows });
        let mut tables: Vec<_> = tables.into_iter().filter_map(table).collect();
        let mut blocks = Vec::new();
        for part in &self.parts {
            add_blocks(part, data, &mut tables, &mut blocks);
        }
        jobs::run(blocks, threads, |(data, tables)| {
            for (layout, offsets, rows) in tables {
                decode_rows(data, layout, offsets, rows);
            }
        });
    }
}

/// Divides the rows of a part by blocks.
fn add_blocks<'a>(part: &'a Part, data: &'a [u8], tables: &mut [Table<'a>], blocks: &mut Vec<Block<'a>>) {
    for table in &mut *tables {
        table.offsets = part.offsets.get(table.slot).map_or(&[], Vec::as_slice);
    }
    let last = tables.iter().filter_map(|table| table.offsets.last()).map(|&offset| position(offset)).max();
    let count = last.map_or(0, |last| last / BLOCK + 1);
    let data = &data[part.base.min(data.len())..];
    for block in 1..=count {
        let take = |table: &mut Table<'a>| table.take(if block == count { usize::MAX } else { block * BLOCK });
        let rows: Vec<_> = tables.iter_mut().map(take).filter(|(_, offsets, _)| !offsets.is_empty()).collect();
        if !rows.is_empty() {
            blocks.push((data, rows));
        }
    }
}

impl<'a> Table<'a> {
    /// Takes the rows of the packets before `end`.
    fn take(&mut self, end: usize) -> (&'a Layout, &'a [u32], &'a mut [u8]) {
        let (offsets, rest) = self.offsets.split_at(self.offsets.partition_point(|&offset| position(offset) < end));
        self.offsets = rest;
        let rows = self.rows.split_off_mut(..offsets.len() * row_size(self.layout)).unwrap_or_default();
        (self.layout, offsets, rows)
    }
}

/// Position of a packet in its part.
#[inline]
fn position(offset: u32) -> usize {
    (offset & !TIMESTAMPED_BIT) as usize
}

fn decode_rows(data: &[u8], layout: &Layout, offsets: &[u32], rows: &mut [u8]) {
    let texts: Vec<_> = layout
        .fields
        .iter()
        .filter(|field| field.kind == FieldType::Char && field.array_length > 0)
        .map(crate::layout::Field::range)
        .collect();
    let size = row_size(layout);
    for (batch, rows) in offsets.chunks(ROWS_PER_BATCH).zip(rows.chunks_mut(ROWS_PER_BATCH * size)) {
        prefetch(data, batch);
        for (&offset, row) in batch.iter().zip(rows.chunks_exact_mut(size)) {
            decode_row(data, offset, row, usize::from(layout.length));
            for text in &texts {
                clear_after_nul(&mut row[ROW_HEADER..][text.clone()]);
            }
        }
    }
}

/// Reads a byte of each packet's timestamp and one of its payload, so that the cache lines are fetched in parallel: each
/// would cost a separate cache miss otherwise.
#[inline]
fn prefetch(data: &[u8], batch: &[u32]) {
    let byte = |index: usize| data.get(index).copied().unwrap_or(0);
    let fetched = batch.iter().fold(0, |sum, &offset| {
        let start = position(offset);
        sum ^ byte(start.saturating_sub(TIMESTAMP)) ^ byte(start + CACHE_LINE / 2)
    });
    std::hint::black_box(fetched);
}

#[inline]
fn decode_row(data: &[u8], offset: u32, row: &mut [u8], length: usize) {
    let start = position(offset);
    let Some(header) = data.get(start..).and_then(Header::parse) else {
        row.fill(0);
        return;
    };
    let time = match data[..start].last_chunk::<TIMESTAMP>() {
        Some(&stamp) if offset & TIMESTAMPED_BIT != 0 => {
            i64::try_from(timestamp_microseconds(stamp)).unwrap_or(NO_TIME)
        }
        _ => NO_TIME,
    };
    row[..TIMESTAMP].copy_from_slice(&time.to_le_bytes());
    row[TIMESTAMP..ROW_HEADER].copy_from_slice(&[header.system, header.component, header.sequence, header.version]);
    let payload = header.payload();
    let known = payload.len().min(length);
    let begin = start + payload.start;
    let fields = &mut row[ROW_HEADER..];
    if let Some(source) = data.get(begin..begin + fields.len()) {
        copy_beginning(source, fields, known);
    } else {
        let payload = data.get(begin..begin + known).unwrap_or(&[]);
        fields[..payload.len()].copy_from_slice(payload);
        fields[payload.len()..].fill(0);
    }
}

/// Copies the first `kept` bytes of `source`, and clears the rest of `target`, which has the same length.
///
/// A row has few bytes: copying chunks of known length takes less time than a call of a function for any length.
#[inline]
fn copy_beginning(source: &[u8], target: &mut [u8], kept: usize) {
    let (from, from_rest) = source.as_chunks::<CHUNK>();
    let (to, to_rest) = target.as_chunks_mut::<CHUNK>();
    let mut left = kept;
    for (from, to) in from.iter().zip(to) {
        *to = (u128::from_le_bytes(*from) & KEPT[left.min(CHUNK)]).to_le_bytes();
        left = left.saturating_sub(CHUNK);
    }
    let (from, _) = from_rest.as_chunks::<4>();
    let (to, _) = to_rest.as_chunks_mut::<4>();
    for (from, to) in from.iter().zip(to) {
        *to = (u32::from_le_bytes(*from) & KEPT[left.min(4)] as u32).to_le_bytes();
        left = left.saturating_sub(4);
    }
}

const fn kept() -> [u128; CHUNK + 1] {
    let mut masks = [u128::MAX; CHUNK + 1];
    let mut count = 0;
    while count < CHUNK {
        masks[count] = (1 << (8 * count)) - 1;
        count += 1;
    }
    masks
}

/// Clears the bytes after the NUL of a text, which have no meaning.
fn clear_after_nul(text: &mut [u8]) {
    if let Some(end) = memchr::memchr(0, text) {
        text[end..].fill(0);
    }
}
