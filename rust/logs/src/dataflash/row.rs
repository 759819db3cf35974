//! Conversion of records to the rows of a table.
//!
//! A row is the header of all rows ([`crate::rows`]) and the fields at the places that the layout states. Rows are
//! converted in batches, field by field: the records of a batch are fetched together, because they are far apart in the
//! log, and the conversion of one field is a loop without branches.

use super::format::field_length;
use crate::rows::{INSTANCE, NO_TIME, ROW_HEADER};

/// Number of rows that are converted together.
const BATCH: usize = 64;
/// Maximum length of a record in bytes.
const MAX_LENGTH: usize = 255;

/// Conversion of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Conversion {
    /// The bytes as they are.
    Copy,
    /// A text: bytes after the NUL, which have no meaning, become zero.
    Text,
    /// An integer to a double: the integer divided by 100, or by 10^7 for degrees.
    Scaled,
}

/// A field of a record, and its place in the row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// Format character of the field.
    pub character: u8,
    pub conversion: Conversion,
    /// Position in the record, header included.
    pub source: usize,
    /// Position in the row.
    pub target: usize,
}

/// An integer field that a row's header is made from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HeaderField {
    pub character: u8,
    pub source: usize,
}

/// The time of a row in microseconds since 1970: a field times `factor` plus `offset`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Time {
    pub field: HeaderField,
    pub factor: i64,
    pub offset: i64,
}

#[derive(Clone, Copy, Debug)]
enum Step {
    Copy { source: usize, target: usize, length: usize },
    Text { source: usize, target: usize, length: usize },
    Scaled { source: usize, target: usize, character: u8 },
}

/// How the records of a definition become rows.
#[derive(Clone, Debug)]
pub struct Layout {
    record_length: usize,
    row_size: usize,
    steps: Vec<Step>,
    time: Option<Time>,
    instance: Option<HeaderField>,
}

impl Layout {
    /// Creates a layout. Returns `None` if a field lies outside of the record or of the row.
    #[must_use]
    pub fn new(
        record_length: usize,
        row_size: usize,
        fields: &[Field],
        time: Option<Time>,
        instance: Option<HeaderField>,
    ) -> Option<Self> {
        let mut steps = Vec::new();
        for field in fields {
            let length = field_length(field.character)?;
            let scaled = field.conversion == Conversion::Scaled;
            let width = if scaled { size_of::<f64>() } else { length };
            let known = !scaled || b"cCeEL".contains(&field.character);
            if !known || !fits(field.source, length, record_length) || !fits(field.target, width, row_size) {
                return None;
            }
            add_step(&mut steps, field, length);
        }
        let mut header = time.map(|time| time.field).into_iter().chain(instance);
        let valid =
            record_length <= MAX_LENGTH && row_size >= ROW_HEADER && header.all(|field| field.fits(record_length));
        valid.then_some(Self { record_length, row_size, steps, time, instance })
    }

    /// Size of a row in bytes.
    #[must_use]
    pub fn row_size(&self) -> usize {
        self.row_size
    }

    /// The time of the record at `position` of `data`, if the layout has one and the record is whole.
    #[must_use]
    pub fn time_at(&self, data: &[u8], position: usize) -> Option<i64> {
        self.time?.of(data.get(position..)?.get(..self.record_length)?)
    }

    /// Converts the records at `offsets` of `data`.
    pub fn decode(&self, data: &[u8], offsets: &[u32], rows: &mut [u8]) {
        let empty = &[0; MAX_LENGTH][..self.record_length];
        let mut records = [empty; BATCH];
        for (offsets, rows) in offsets.chunks(BATCH).zip(rows.chunks_mut(BATCH * self.row_size)) {
            let mut fetched = 0;
            for (&offset, record) in offsets.iter().zip(&mut records) {
                let start = offset as usize;
                *record = data.get(start..start + self.record_length).unwrap_or(empty);
                fetched ^= record.first().copied().unwrap_or(0);
            }
            std::hint::black_box(fetched);
            self.convert(&records[..offsets.len()], rows);
        }
    }

    fn convert(&self, records: &[&[u8]], rows: &mut [u8]) {
        let size = self.row_size;
        rows.fill(0);
        for (record, row) in records.iter().zip(rows.chunks_exact_mut(size)) {
            let time = self.time.and_then(|time| time.of(record)).unwrap_or(NO_TIME);
            row[..INSTANCE].copy_from_slice(&time.to_le_bytes());
            row[INSTANCE] = self.instance.map_or(0, |field| field.value(record).clamp(0, u8::MAX.into()) as u8);
        }
        for step in &self.steps {
            for_each_row(records, rows, size, step);
        }
    }
}

impl HeaderField {
    fn fits(self, record_length: usize) -> bool {
        let integer = b"bBMhHiIqQ".contains(&self.character);
        integer && field_length(self.character).is_some_and(|length| fits(self.source, length, record_length))
    }

    #[inline]
    fn value(self, record: &[u8]) -> i128 {
        let source = self.source;
        match self.character {
            b'b' => i8::from_le_bytes(bytes(record, source)).into(),
            b'h' => i16::from_le_bytes(bytes(record, source)).into(),
            b'H' => u16::from_le_bytes(bytes(record, source)).into(),
            b'i' => i32::from_le_bytes(bytes(record, source)).into(),
            b'I' => u32::from_le_bytes(bytes(record, source)).into(),
            b'q' => i64::from_le_bytes(bytes(record, source)).into(),
            b'Q' => u64::from_le_bytes(bytes(record, source)).into(),
            _ => record[source].into(),
        }
    }
}

impl Time {
    #[inline]
    fn of(self, record: &[u8]) -> Option<i64> {
        let raw = i64::try_from(self.field.value(record)).ok()?;
        raw.checked_mul(self.factor)?.checked_add(self.offset)
    }
}

fn fits(start: usize, length: usize, size: usize) -> bool {
    start.checked_add(length).is_some_and(|end| end <= size)
}

/// Adds the conversion of a field; neighbouring fields that are copied become one step.
fn add_step(steps: &mut Vec<Step>, field: &Field, length: usize) {
    let &Field { character, conversion, source, target } = field;
    let step = match conversion {
        Conversion::Scaled => Step::Scaled { source, target, character },
        Conversion::Text => Step::Text { source, target, length },
        Conversion::Copy => match steps.last_mut() {
            Some(Step::Copy { source: from, target: to, length: copied })
                if *from + *copied == source && *to + *copied == target =>
            {
                *copied += length;
                return;
            }
            _ => Step::Copy { source, target, length },
        },
    };
    steps.push(step);
}

fn for_each_row(records: &[&[u8]], rows: &mut [u8], size: usize, step: &Step) {
    match *step {
        Step::Copy { source, target, length } => copy(records, rows, size, (source, target, length)),
        Step::Text { source, target, length } => {
            for (record, row) in records.iter().zip(rows.chunks_exact_mut(size)) {
                let text = &record[source..source + length];
                let end = memchr::memchr(0, text).unwrap_or(length);
                row[target..target + end].copy_from_slice(&text[..end]);
            }
        }
        Step::Scaled { source, target, character } => {
            let place = (source, target);
            match character {
                b'c' => scale(records, rows, size, place, |raw| f64::from(i16::from_le_bytes(raw)) / 1e2),
                b'C' => scale(records, rows, size, place, |raw| f64::from(u16::from_le_bytes(raw)) / 1e2),
                b'e' => scale(records, rows, size, place, |raw| f64::from(i32::from_le_bytes(raw)) / 1e2),
                b'E' => scale(records, rows, size, place, |raw| f64::from(u32::from_le_bytes(raw)) / 1e2),
                _ => scale(records, rows, size, place, |raw| f64::from(i32::from_le_bytes(raw)) / 1e7),
            }
        }
    }
}

fn copy(records: &[&[u8]], rows: &mut [u8], size: usize, (source, target, length): (usize, usize, usize)) {
    for (record, row) in records.iter().zip(rows.chunks_exact_mut(size)) {
        row[target..target + length].copy_from_slice(&record[source..source + length]);
    }
}

/// Writes a double for each integer of `N` bytes.
fn scale<const N: usize>(
    records: &[&[u8]],
    rows: &mut [u8],
    size: usize,
    (source, target): (usize, usize),
    value: impl Fn([u8; N]) -> f64,
) {
    for (record, row) in records.iter().zip(rows.chunks_exact_mut(size)) {
        row[target..target + size_of::<f64>()].copy_from_slice(&value(bytes(record, source)).to_le_bytes());
    }
}

/// `N` bytes of a record; [`Layout::new`] made sure that it has them.
#[inline]
fn bytes<const N: usize>(record: &[u8], source: usize) -> [u8; N] {
    let mut bytes = [0; N];
    bytes.copy_from_slice(&record[source..source + N]);
    bytes
}

#[cfg(test)]
#[path = "row_tests.rs"]
mod tests;
