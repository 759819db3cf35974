//! Decoding: the records of tables as rows, on several threads.

use super::header::MESSAGE_HEADER;
use super::index::{Index, Records};
use super::layout::Layout;
use super::{u16_at, u64_at};
use crate::rows::{INSTANCE, NO_TIME, ROW_HEADER};
use mavstack_core::jobs;

/// Number of rows that a thread decodes at a time.
const ROWS_PER_JOB: usize = 16_384;
/// Number of rows whose records are prefetched together.
const ROWS_PER_BATCH: usize = 64;
/// Position of a record in its message, after header and id.
const RECORD: usize = MESSAGE_HEADER + 2;

struct Job<'a> {
    data: &'a [u8],
    layout: &'a Layout,
    offsets: &'a [u32],
    instances: &'a [u8],
    buffer: &'a mut [u8],
}

impl Index {
    /// Writes the rows of each table to the buffer paired with it, whose length must be that of the rows.
    ///
    /// `data` must be the indexed bytes; records that are no longer in it become rows of zeros. `utc_offset` is UTC minus
    /// time since boot in microseconds; None if it is unknown.
    pub fn decode(&self, data: &[u8], tables: Vec<(usize, &mut [u8])>, utc_offset: Option<i64>, threads: usize) {
        let mut jobs = Vec::new();
        for (table, buffer) in tables {
            self.add_jobs(data, table, buffer, &mut jobs);
        }
        jobs::run(jobs, threads, |job| job.run(utc_offset));
    }

    fn add_jobs<'a>(&'a self, data: &'a [u8], table: usize, mut buffer: &'a mut [u8], jobs: &mut Vec<Job<'a>>) {
        let Some(layout) = self.tables().get(table).map(|table| &table.layout) else {
            return;
        };
        for part in &self.parts {
            let Some(Records { offsets, instances }) = part.tables.get(table) else {
                continue;
            };
            let data = &data[part.base.min(data.len())..];
            for (offsets, instances) in offsets.chunks(ROWS_PER_JOB).zip(instances.chunks(ROWS_PER_JOB)) {
                let rows = buffer.split_off_mut(..offsets.len() * layout.row_size).unwrap_or_default();
                jobs.push(Job { data, layout, offsets, instances, buffer: rows });
            }
        }
    }
}

impl Job<'_> {
    fn run(self, utc_offset: Option<i64>) {
        let size = self.layout.row_size;
        let batches = self.offsets.chunks(ROWS_PER_BATCH).zip(self.instances.chunks(ROWS_PER_BATCH));
        for ((offsets, instances), rows) in batches.zip(self.buffer.chunks_mut(ROWS_PER_BATCH * size)) {
            prefetch(self.data, offsets, self.layout.min_record);
            for ((&offset, &instance), row) in offsets.iter().zip(instances).zip(rows.chunks_exact_mut(size)) {
                decode_row(self.data, offset as usize, self.layout, row);
                write_header(row, self.layout, instance, utc_offset);
            }
        }
    }
}

/// Reads the first and the last byte of each record, so that the cache lines are fetched in parallel: the records of a
/// topic are far apart in the file, and each would cost a separate cache miss.
#[inline]
fn prefetch(data: &[u8], offsets: &[u32], length: usize) {
    let byte = |position: usize| data.get(position).copied().unwrap_or(0);
    let ends = |start: usize| byte(start) ^ byte(start + length);
    std::hint::black_box(offsets.iter().fold(0, |sum, &offset| sum ^ ends(offset as usize + RECORD)));
}

#[inline]
fn decode_row(data: &[u8], start: usize, layout: &Layout, row: &mut [u8]) {
    let size = u16_at(data, start).map_or(0, usize::from);
    let record = data.get(start + RECORD..start + MESSAGE_HEADER + size).unwrap_or(&[]);
    if record.len() < layout.min_record {
        row.fill(0);
        return;
    }
    let mut end = ROW_HEADER;
    for copy in &layout.copies {
        end = copy.to + copy.from.len();
        row[copy.to..end].copy_from_slice(&record[copy.from.clone()]);
    }
    row[end..].fill(0);
    for text in &layout.texts {
        clear_after_nul(&mut row[text.clone()]);
    }
    for truths in &layout.truths {
        for byte in &mut row[truths.clone()] {
            *byte = u8::from(*byte != 0);
        }
    }
}

#[inline]
fn write_header(row: &mut [u8], layout: &Layout, instance: u8, utc_offset: Option<i64>) {
    let known = layout.timestamp_in_row.and_then(|position| u64_at(row, position)).zip(utc_offset);
    let time = known.and_then(|(time, offset)| i64::try_from(time).ok()?.checked_add(offset)).unwrap_or(NO_TIME);
    row[..INSTANCE].copy_from_slice(&time.to_le_bytes());
    row[INSTANCE..ROW_HEADER].copy_from_slice(&[instance, 0, 0, 0]);
}

/// Clears the bytes after the NUL of a text, which have no meaning.
fn clear_after_nul(text: &mut [u8]) {
    if let Some(end) = text.iter().position(|&byte| byte == 0) {
        text[end..].fill(0);
    }
}
