//! The bytes of an index, from which a later process has it without reading the log again.
//!
//! The definitions are read from the log itself, at the positions where they were found. Positions of records are not
//! proven: as with a log that has changed, a wrong one gives wrong rows, and nothing worse.

use super::format::Outcome;
use super::index::Index;
use super::scan::{Damage, Place};
use super::segment::{SEGMENT, Segment};
use mavstack_core::saved::{Reader, Writer};
use std::sync::Arc;

impl Index {
    /// Returns the index as bytes.
    #[must_use]
    pub fn save(&self) -> Vec<u8> {
        let mut writer = Writer::default();
        writer.size(self.redefinitions().len());
        self.redefinitions().iter().for_each(|one| writer.size(one.position));
        writer.size(self.segments.len());
        for segment in &self.segments {
            writer.size(segment.begin.position);
            writer.number(segment.begin.aligned.into());
            writer.offsets(&segment.sums);
            writer.number(segment.offsets.is_some().into());
            writer.offsets(segment.offsets.as_deref().unwrap_or(&[]));
        }
        let damage = self.damage();
        for count in damage_counts(&mut damage.clone()) {
            writer.number(*count);
        }
        writer.counts(damage.unknown.iter().map(|(&kind, &count)| (kind, count)));
        writer.finish()
    }

    /// Returns the index of `data` that was saved as `bytes`; `None` if it cannot be that.
    #[must_use]
    pub fn restore(bytes: &[u8], data: &[u8]) -> Option<Self> {
        let mut reader = Reader::new(bytes);
        let mut index = Self::default();
        let mut types = vec![Arc::new(index.formats.types.clone())];
        for _ in 0..reader.length(size_of::<u64>())? {
            let position = reader.size()?;
            let Outcome::Defined(defined) = index.formats.define(data.get(position..)?, position) else {
                return None;
            };
            index.redefinitions.push(defined);
            types.push(Arc::new(index.formats.types.clone()));
        }
        for number in 0..reader.length(5 * size_of::<u64>())? {
            let begin = Place { position: reader.size()?, aligned: reader.number()? == 1 };
            let known = index.redefinitions.partition_point(|one| one.position < begin.position);
            let sums = reader.offsets()?.into();
            let offsets =
                Some(reader.number()? == 1).zip(reader.offsets()).map(|(kept, all)| kept.then(|| all.into()))?;
            let segment = Segment { number, begin, types: Arc::clone(&types[known]), sums, offsets };
            index.segments.push(segment.is_sound(index.definitions().len()).then_some(segment)?);
        }
        for count in damage_counts(&mut index.damage) {
            *count = reader.number()?;
        }
        index.damage.unknown = reader.counts()?;
        reader.end()?;
        index.count_rows();
        let records = index.definitions().iter().enumerate();
        let sizes = records.map(|(slot, one)| (index.rows(slot) * usize::from(one.length)) as u64);
        (sizes.sum::<u64>().checked_add(index.damage.bad_bytes) == Some(data.len() as u64)).then_some(index)
    }
}

impl Segment {
    /// Returns whether the offsets are those of the numbers of records, and inside of the segment.
    fn is_sound(&self, slots: usize) -> bool {
        self.sums.first() == Some(&0)
            && self.sums.is_sorted()
            && self.slots() <= slots
            && self.offsets.as_deref().is_none_or(|offsets| {
                self.sums.last().is_some_and(|&total| total as usize == offsets.len())
                    && offsets.iter().all(|&offset| (offset as usize) < SEGMENT)
            })
    }
}

fn damage_counts(damage: &mut Damage) -> [&mut u64; 5] {
    [
        &mut damage.bad_bytes,
        &mut damage.damaged_records,
        &mut damage.suspect_records,
        &mut damage.bad_definitions,
        &mut damage.truncated_bytes,
    ]
}
