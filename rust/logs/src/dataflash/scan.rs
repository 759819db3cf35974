//! Walking from record to record, over damaged parts of a log too.
//!
//! Records carry no checksum. A record is *confirmed* if another header (of any type) or the end of the log directly
//! follows it. After a confirmed record the next one is where it should be, and is accepted:
//!
//! - confirmed: as it is;
//! - not confirmed, but a confirmed record begins inside it: bytes of it were lost; it is dropped, and the walk
//!   continues with the inner one;
//! - otherwise it is accepted, and junk follows it. Its last bytes may be junk as well, so it is counted as suspect.
//!
//! In junk only confirmed records are accepted. The decision about a record depends on the bytes from its beginning and
//! on the types known there, not on how the walk arrived. A walk can therefore stop and continue anywhere.

use super::format::{FMT_TYPE, Formats, HEADER, HEADER_LENGTH, Outcome, Redefinition};
use memchr::memmem;
use std::collections::BTreeMap;

/// Counts of everything in a log that did not become a row, or is doubtful.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Damage {
    /// Bytes outside of accepted records.
    pub bad_bytes: u64,
    /// Records that were dropped because bytes of them are missing.
    pub damaged_records: u64,
    /// Accepted records that junk follows directly.
    pub suspect_records: u64,
    /// FMT records that make no sense.
    pub bad_definitions: u64,
    /// Bytes of a last record that the log does not contain completely.
    pub truncated_bytes: u64,
    /// Number of headers by type number, where the type has no definition.
    pub unknown: BTreeMap<u8, u64>,
}

impl Damage {
    /// Adds the counts of another part of the log.
    pub fn add(&mut self, other: &Self) {
        self.bad_bytes += other.bad_bytes;
        self.damaged_records += other.damaged_records;
        self.suspect_records += other.suspect_records;
        self.bad_definitions += other.bad_definitions;
        self.truncated_bytes += other.truncated_bytes;
        for (&kind, count) in &other.unknown {
            *self.unknown.entry(kind).or_default() += count;
        }
    }
}

/// Where a walk is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    pub position: usize,
    /// Whether a record should begin here; in junk it is false.
    pub aligned: bool,
}

impl Place {
    /// The beginning of a log.
    pub const START: Self = Self { position: 0, aligned: true };
}

/// An accepted record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Record {
    pub start: usize,
    pub slot: u16,
}

/// A walk over the records of a log.
pub struct Walk<'a> {
    data: &'a [u8],
    pub place: Place,
    pub formats: Formats,
    pub damage: Damage,
    pub redefinitions: Vec<Redefinition>,
}

impl<'a> Walk<'a> {
    #[must_use]
    pub fn new(data: &'a [u8], place: Place, formats: Formats) -> Self {
        Self { data, place, formats, damage: Damage::default(), redefinitions: Vec::new() }
    }

    /// Passes each record that begins before `end` to `accept`.
    pub fn run(&mut self, end: usize, mut accept: impl FnMut(Record)) {
        let end = end.min(self.data.len());
        while self.place.position < end {
            let start = self.place.position;
            if let Some((kind, length)) = self.known(start)
                && begins_header(self.data, start + length)
            {
                accept(Record { start, slot: self.formats.types.slot(kind) });
                if kind == FMT_TYPE {
                    self.define(start, length);
                }
                self.place = Place { position: start + length, aligned: true };
            } else if !self.place.aligned {
                self.search(end);
            } else if let Some(record) = self.unconfirmed() {
                accept(record);
            }
        }
    }

    /// Type number and length of the record at `start`, if its type is known.
    #[inline]
    fn known(&self, start: usize) -> Option<(u8, usize)> {
        let &[first, second, kind] = self.data.get(start..)?.first_chunk()?;
        let length = self.formats.types.length(kind);
        ([first, second] == HEADER && length > 0).then_some((kind, length))
    }

    fn define(&mut self, start: usize, length: usize) {
        match self.formats.define(&self.data[start..start + length], start) {
            Outcome::Defined(redefinition) => self.redefinitions.push(redefinition),
            Outcome::Repeated => {}
            Outcome::Rejected => self.damage.bad_definitions += 1,
        }
    }

    /// Handles the place after a record at which no confirmed record begins. Returns a record accepted nevertheless.
    #[cold]
    fn unconfirmed(&mut self) -> Option<Record> {
        let start = self.place.position;
        let rest = self.data.len() - start;
        let Some((kind, length)) = self.known(start) else {
            if rest < HEADER_LENGTH && begins_header(self.data, start) {
                self.truncated(rest);
            } else {
                self.skip_one();
            }
            return None;
        };
        if let Some(inner) = self.confirmed_inside(start, length) {
            self.damage.damaged_records += 1;
            self.damage.bad_bytes += (inner - start) as u64;
            self.place = Place { position: inner, aligned: true };
            return None;
        }
        if length > rest {
            self.truncated(rest);
            return None;
        }
        self.damage.suspect_records += 1;
        self.place = Place { position: start + length, aligned: false };
        Some(Record { start, slot: self.formats.types.slot(kind) })
    }

    /// Handles a last record of which the log contains only `rest` bytes.
    fn truncated(&mut self, rest: usize) {
        self.damage.truncated_bytes += rest as u64;
        self.damage.bad_bytes += rest as u64;
        self.place = Place { position: self.data.len(), aligned: false };
    }

    /// Position of a confirmed record that begins inside the record at `start`.
    fn confirmed_inside(&self, start: usize, length: usize) -> Option<usize> {
        let end = (start + length).min(self.data.len());
        let inside = self.data.get(start + HEADER.len()..(end + HEADER_LENGTH).min(self.data.len()))?;
        let begins = memmem::find_iter(inside, &HEADER).map(|found| start + HEADER.len() + found);
        begins
            .take_while(|&begin| begin < end)
            .find(|&begin| self.known(begin).is_some_and(|(_, length)| begins_header(self.data, begin + length)))
    }

    /// Skips junk up to the next header that begins before `end`.
    #[cold]
    fn search(&mut self, end: usize) {
        self.skip_one();
        let start = self.place.position;
        let window = &self.data[start.min(end)..self.data.len().min(end + 1)];
        let next = memmem::find(window, &HEADER).map_or(end.max(start), |found| start + found);
        self.damage.bad_bytes += (next - start) as u64;
        self.place.position = next;
    }

    /// Skips the byte at the current place, where no record is accepted.
    fn skip_one(&mut self) {
        let start = self.place.position;
        if let Some(&[first, second, kind]) = self.data[start..].first_chunk()
            && [first, second] == HEADER
            && self.formats.types.length(kind) == 0
        {
            *self.damage.unknown.entry(kind).or_default() += 1;
        }
        self.damage.bad_bytes += 1;
        self.place = Place { position: start + 1, aligned: false };
    }
}

/// Returns whether a header or the end of the data is at `position`.
#[inline]
fn begins_header(data: &[u8], position: usize) -> bool {
    match data.get(position..) {
        Some([first, second, ..]) => [*first, *second] == HEADER,
        Some([first]) => *first == HEADER[0],
        Some([]) => true,
        None => false,
    }
}

#[cfg(test)]
#[path = "scan_tests.rs"]
mod tests;
