//! A segment of a log: the records that begin in it, by definition.

use super::format::{Formats, Types};
use super::scan::{Place, Record, Walk};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// Length of a segment in bytes; small in tests, so that their logs have many.
pub const SEGMENT: usize = if cfg!(test) { 1 << 11 } else { 1 << 21 };

/// The records that begin in one segment.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Segment {
    pub number: usize,
    pub begin: Place,
    pub types: Arc<Types>,
    /// For each slot the number of records of the slots before it, and the total.
    pub sums: Box<[u32]>,
    /// Offsets of the records from the beginning of the segment, ordered by slot.
    pub offsets: Option<Box<[u32]>>,
}

impl Segment {
    pub fn base(&self) -> usize {
        self.number * SEGMENT
    }

    pub fn end(&self) -> usize {
        self.base() + SEGMENT
    }

    pub fn range(&self, slot: usize) -> Range<usize> {
        match self.sums.get(slot..slot + 2) {
            Some(sums) => sums[0] as usize..sums[1] as usize,
            None => 0..0,
        }
    }

    pub fn rows(&self, slot: usize) -> usize {
        self.range(slot).len()
    }

    pub fn slots(&self) -> usize {
        self.sums.len() - 1
    }

    /// The offsets by slot: those kept, or those of another walk over the segment.
    pub fn offsets(&self, data: &[u8], formats: &Formats) -> Cow<'_, [u32]> {
        if let Some(offsets) = &self.offsets {
            return Cow::Borrowed(offsets);
        }
        let formats = formats.with_types(&self.types);
        let mut records = Vec::new();
        Walk::new(data, self.begin, formats).run(self.end(), |record| records.push(record));
        Cow::Owned(by_slot(&records, &self.sums, self.base()))
    }

    pub fn without_offsets(&self) -> Self {
        Self { offsets: None, types: Arc::clone(&self.types), sums: self.sums.clone(), ..*self }
    }
}

/// Returns the offsets of records, ordered by slot. Records beyond the numbers that `sums` states are left out.
pub(super) fn by_slot(records: &[Record], sums: &[u32], base: usize) -> Vec<u32> {
    let mut offsets = vec![0; sums.last().map_or(0, |&total| total as usize)];
    let mut next = sums.to_vec();
    for record in records {
        let slot = usize::from(record.slot);
        let (Some(place), Some(&limit)) = (next.get_mut(slot), sums.get(slot + 1)) else {
            continue;
        };
        if *place < limit {
            offsets[*place as usize] = (record.start - base) as u32;
            *place += 1;
        }
    }
    offsets
}

/// Counts the records of each slot, as sums.
pub(super) fn count(records: &[Record]) -> Box<[u32]> {
    let slots = records.iter().map(|record| usize::from(record.slot) + 1).max().unwrap_or(0);
    let mut sums = vec![0; slots + 1];
    for record in records {
        sums[usize::from(record.slot) + 1] += 1;
    }
    for slot in 0..slots {
        sums[slot + 1] += sums[slot];
    }
    sums.into()
}
