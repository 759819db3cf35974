//! The bytes of an index, from which a later process has it without reading the file again.
//!
//! Definitions and subscriptions are read from the file itself, at the positions where they were found. Positions of
//! records are not proven: as with a file that has changed, a wrong one gives wrong rows, and nothing worse.

use super::header::Header;
use super::index::{Entry, Index, Part, Records};
use super::scan::{Damage, Scanner, State};
use mavstack_core::saved::{Reader, Writer};

impl Index {
    /// Returns the index of a whole file as bytes.
    #[must_use]
    pub fn save(&self) -> Vec<u8> {
        let mut writer = Writer::default();
        writer.size(self.entries.len());
        for entry in &self.entries {
            writer.number(entry.kind.into());
            writer.size(entry.start);
            writer.number(entry.time);
        }
        writer.size(self.parts.len());
        for part in &self.parts {
            writer.size(part.base);
            writer.size(part.tables.len());
            for Records { offsets, instances } in &part.tables {
                writer.offsets(offsets);
                writer.octets(instances);
            }
        }
        if self.parts.is_empty() {
            self.save_counts(&mut writer);
        }
        writer.number(self.message_bytes);
        writer.optional(self.definitions_end.map(|position| position as u64));
        writer.optional(self.time_span.map(|(first, _)| first));
        writer.optional(self.time_span.map(|(_, last)| last));
        writer.number(self.last_time);
        writer.size(self.end());
        save_damage(&self.damage, &mut writer);
        writer.finish()
    }

    /// Returns the index of `data` that was saved as `bytes`; `None` if it cannot be that.
    #[must_use]
    pub fn restore(bytes: &[u8], data: &[u8], header: &Header) -> Option<Self> {
        let mut reader = Reader::new(bytes);
        let mut scanner = Scanner::new(data, header, State::default());
        let mut index = Self::empty(header, 0);
        for _ in 0..reader.length(3 * size_of::<u64>())? {
            let kind = u8::try_from(reader.number()?).ok()?;
            let entry =
                Entry { kind, start: reader.size().filter(|&start| start < data.len())?, time: reader.number()? };
            scanner.learn(kind, index.body(data, &entry));
            index.entries.push(entry);
        }
        let parts = reader.length(2 * size_of::<u64>())?;
        for _ in 0..parts {
            let base = reader.size().filter(|&base| base <= data.len())?;
            let mut part = Part { base, tables: Vec::new() };
            for table in 0..reader.length(2 * size_of::<u64>())? {
                let records = Records { offsets: reader.offsets()?, instances: reader.octets()?.to_vec() };
                let known = table < scanner.state.catalog.tables().len() || records.offsets.is_empty();
                part.tables.push(Some(records).filter(|one| known && one.offsets.len() == one.instances.len())?);
            }
            index.add_counts(&part);
            index.parts.push(part);
        }
        if parts == 0 {
            index.restore_counts(&mut reader, scanner.state.catalog.tables().len(), data.len() as u64)?;
        }
        index.message_bytes = reader.number()?;
        index.definitions_end = reader.optional()?.map(usize::try_from).transpose().ok()?;
        index.time_span = reader.optional()?.zip(reader.optional()?);
        index.last_time = reader.number()?;
        index.state = State { position: reader.size()?, catalog: scanner.state.catalog };
        index.damage = restore_damage(&mut reader)?;
        reader.end()?;
        Some(index)
    }

    /// Writes the numbers of records, which otherwise follow from their positions.
    fn save_counts(&self, writer: &mut Writer) {
        let tables = 0..self.tables().len();
        writer.size(tables.len());
        for table in tables {
            writer.counts(self.instances(table).iter().enumerate().map(|(instance, &count)| (instance as u64, count)));
        }
    }

    fn restore_counts(&mut self, reader: &mut Reader<'_>, tables: usize, limit: u64) -> Option<()> {
        for table in 0..reader.size().filter(|&count| count == tables)? {
            for (instance, count) in reader.counts::<u8, Vec<_>>()? {
                self.add_count(table, instance.into(), Some(count).filter(|&count| count <= limit)?);
            }
        }
        Some(())
    }

    fn add_counts(&mut self, part: &Part) {
        for (table, records) in part.tables.iter().enumerate() {
            for &instance in &records.instances {
                self.add_count(table, instance.into(), 1);
            }
        }
    }
}

fn save_damage(damage: &Damage, writer: &mut Writer) {
    let Damage { bad_bytes, gaps, truncated_bytes, wrong_size, bad_definitions, unsubscribed, unknown_kinds } = damage;
    for &count in [bad_bytes, gaps, truncated_bytes, wrong_size, bad_definitions] {
        writer.number(count);
    }
    writer.counts(unsubscribed.iter().map(|(&id, &count)| (id, count)));
    writer.counts(unknown_kinds.iter().map(|(&kind, &count)| (kind, count)));
}

fn restore_damage(reader: &mut Reader<'_>) -> Option<Damage> {
    Some(Damage {
        bad_bytes: reader.number()?,
        gaps: reader.number()?,
        truncated_bytes: reader.number()?,
        wrong_size: reader.number()?,
        bad_definitions: reader.number()?,
        unsubscribed: reader.counts()?,
        unknown_kinds: reader.counts()?,
    })
}
