//! Definitions of record types, as FMT records give them.

use std::collections::HashMap;

/// The two bytes that begin every record.
pub const HEADER: [u8; 2] = [0xA3, 0x95];
/// Bytes of a record before its body: the header and the type number.
pub const HEADER_LENGTH: usize = 3;
/// The type number of FMT records, which is the only one known from the start.
pub const FMT_TYPE: u8 = 0x80;
/// Maximum number of definitions: a log has up to 256 types, and redefines few of them.
const MAX_DEFINITIONS: usize = 4096;
/// Slot of a type number without definition.
const UNKNOWN: u16 = u16::MAX;

const NAME: std::ops::Range<usize> = 5..9;
const FORMAT: std::ops::Range<usize> = 9..25;
const LABELS: std::ops::Range<usize> = 25..89;
const FMT_LENGTH: u8 = 89;

/// Length in bytes of the field that a format character stands for, or `None` for an unknown character.
#[must_use]
pub fn field_length(character: u8) -> Option<usize> {
    Some(match character {
        b'b' | b'B' | b'M' => 1,
        b'h' | b'H' | b'c' | b'C' | b'g' => 2,
        b'i' | b'I' | b'e' | b'E' | b'L' | b'f' | b'n' => 4,
        b'd' | b'q' | b'Q' => 8,
        b'N' => 16,
        b'a' | b'Z' => 64,
        _ => return None,
    })
}

/// The meaning of a type number: name, fields and length of its records.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Definition {
    pub name: Vec<u8>,
    /// One character for each field.
    pub format: Vec<u8>,
    /// Names of the fields, separated by commas.
    pub labels: Vec<u8>,
    /// Length of a record in bytes, with its header.
    pub length: u8,
}

impl Definition {
    fn of_fmt() -> Self {
        Self {
            name: b"FMT".to_vec(),
            format: b"BBnNZ".to_vec(),
            labels: b"Type,Length,Name,Format,Columns".to_vec(),
            length: FMT_LENGTH,
        }
    }

    /// Reads an FMT record; `None` if its content makes no sense.
    fn parse(record: &[u8]) -> Option<(u8, Self)> {
        let (&kind, &length) = (record.get(3)?, record.get(4)?);
        let text = |range| Some(until_nul(record.get::<std::ops::Range<usize>>(range)?).to_vec());
        let definition = Self { name: text(NAME)?, format: text(FORMAT)?, labels: text(LABELS)?, length };
        let named = !definition.name.is_empty() && definition.name.iter().all(u8::is_ascii_graphic);
        let readable = definition.format.iter().all(u8::is_ascii_graphic);
        let usable = usize::from(length) >= HEADER_LENGTH && (kind != FMT_TYPE || length == FMT_LENGTH);
        (named && readable && usable).then_some((kind, definition))
    }
}

fn until_nul(text: &[u8]) -> &[u8] {
    &text[..memchr::memchr(0, text).unwrap_or(text.len())]
}

/// The meaning of each type number at some place of a log: the slot of its definition and the length of its records.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Types {
    slots: [u16; 256],
    lengths: [u8; 256],
}

impl Types {
    /// The types known at the beginning of a log: FMT.
    fn initial() -> Self {
        let mut types = Self { slots: [UNKNOWN; 256], lengths: [0; 256] };
        types.set(FMT_TYPE, 0, FMT_LENGTH);
        types
    }

    fn set(&mut self, kind: u8, slot: u16, length: u8) {
        self.slots[usize::from(kind)] = slot;
        self.lengths[usize::from(kind)] = length;
    }

    /// Slot of a type number that has a length.
    #[inline]
    #[must_use]
    pub fn slot(&self, kind: u8) -> u16 {
        self.slots[usize::from(kind)]
    }

    /// Length of the records of a type number, 0 if it has no definition.
    #[inline]
    #[must_use]
    pub fn length(&self, kind: u8) -> usize {
        usize::from(self.lengths[usize::from(kind)])
    }
}

/// A definition that was read from the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Redefinition {
    /// Position of the FMT record.
    pub position: usize,
    /// The type number.
    pub kind: u8,
    /// The definition, one slot for all type numbers with equal definitions.
    pub slot: u16,
}

/// Outcome of applying an FMT record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    Defined(Redefinition),
    /// The definition is the one already known.
    Repeated,
    /// The record makes no sense, or there are too many definitions.
    Rejected,
}

/// All definitions of a log, each with one slot, and the types known at the current place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Formats {
    pub types: Types,
    definitions: Vec<Definition>,
    slots: HashMap<Definition, u16>,
}

impl Default for Formats {
    fn default() -> Self {
        let fmt = Definition::of_fmt();
        Self { types: Types::initial(), definitions: vec![fmt.clone()], slots: HashMap::from([(fmt, 0)]) }
    }
}

impl Formats {
    /// The definitions in the order in which they appear in the log; the number of one is its slot.
    #[must_use]
    pub fn definitions(&self) -> &[Definition] {
        &self.definitions
    }

    /// The same definitions, at a place where `types` are known.
    #[must_use]
    pub fn with_types(&self, types: &Types) -> Self {
        Self { types: types.clone(), ..self.clone() }
    }

    /// Applies an FMT record.
    pub fn define(&mut self, record: &[u8], position: usize) -> Outcome {
        let Some((kind, definition)) = Definition::parse(record) else {
            return Outcome::Rejected;
        };
        let length = definition.length;
        let Some(slot) = self.slot_of(definition) else {
            return Outcome::Rejected;
        };
        if self.types.slot(kind) == slot {
            return Outcome::Repeated;
        }
        self.types.set(kind, slot, length);
        Outcome::Defined(Redefinition { position, kind, slot })
    }

    fn slot_of(&mut self, definition: Definition) -> Option<u16> {
        if let Some(&slot) = self.slots.get(&definition) {
            return Some(slot);
        }
        if self.definitions.len() == MAX_DEFINITIONS {
            return None;
        }
        let slot = self.definitions.len() as u16;
        self.definitions.push(definition.clone());
        self.slots.insert(definition, slot);
        Some(slot)
    }
}

#[cfg(test)]
#[path = "format_tests.rs"]
mod tests;
