//! The bytes of an index, from which a later process has it without reading the file again.
//!
//! Bytes that are not those of an index of this dialect and of a file of this size give no index. Positions are not
//! proven: as with a file that has changed, a wrong one gives wrong rows, and nothing worse.

use super::{Index, Part};
use crate::layout::Dialect;
use crate::saved::{Reader, Writer};
use crate::sequence::Sources;
use crate::statistics::Statistics;

impl Index {
    /// Returns the index as bytes.
    #[must_use]
    pub fn save(&self, dialect: &Dialect) -> Vec<u8> {
        let mut writer = Writer::default();
        writer.size(dialect.layouts().len());
        dialect_numbers(dialect).for_each(|number| writer.number(number));
        writer.size(self.parts.len());
        for part in &self.parts {
            writer.size(part.base);
            part.offsets.iter().for_each(|offsets| writer.offsets(offsets));
        }
        writer.size(self.other_rows.len());
        self.other_rows.iter().for_each(|&rows| writer.size(rows));
        writer.counts(self.unknown.iter().map(|(&id, &count)| (id, count)));
        self.statistics.save(&mut writer);
        self.sources.save(&mut writer);
        writer.optional(self.first_time);
        writer.optional(self.last_time);
        writer.finish()
    }

    /// Returns the index that was saved as `bytes`; `None` if they are not that of a file of `size` bytes.
    #[must_use]
    pub fn restore(bytes: &[u8], dialect: &Dialect, size: usize) -> Option<Self> {
        let mut reader = Reader::new(bytes);
        let slots = dialect.layouts().len();
        let mut same = reader.size()? == slots;
        for number in dialect_numbers(dialect) {
            same &= reader.number()? == number;
        }
        let mut index = Self::default();
        for _ in 0..reader.length(size_of::<u64>()).filter(|_| same)? {
            let base = reader.size().filter(|&base| base <= size)?;
            let offsets = (0..slots).map(|_| reader.offsets()).collect::<Option<_>>()?;
            index.parts.push(Part { base, offsets });
        }
        let rows = (0..reader.length(size_of::<u64>())?).map(|_| reader.size().filter(|&rows| rows <= size));
        index.other_rows = rows.collect::<Option<_>>()?;
        index.unknown = reader.counts()?;
        index.statistics = Statistics::restore(&mut reader)?;
        index.sources = Sources::restore(&mut reader)?;
        (index.first_time, index.last_time) = (reader.optional()?, reader.optional()?);
        reader.end()?;
        let rows: usize = (0..slots).map(|slot| index.rows(slot)).sum();
        let packets = index.unknown.values().try_fold(rows as u64, |sum, &count| sum.checked_add(count))?;
        (packets == index.statistics.packets).then_some(index)
    }
}

/// The numbers that distinguish the tables of a dialect: id, length and seed of the checksum of each message.
fn dialect_numbers(dialect: &Dialect) -> impl Iterator<Item = u64> {
    dialect
        .layouts()
        .iter()
        .map(|layout| u64::from(layout.id) << 16 | u64::from(layout.length) << 8 | u64::from(layout.crc_extra))
}
