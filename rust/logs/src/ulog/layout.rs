//! Definitions of records, and the layout of a table's rows that follows from them.

use crate::rows::ROW_HEADER;
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// Maximum size of a record in bytes: the size field of a message has 16 bits and counts two bytes of id.
pub const MAX_RECORD: usize = 65_533;
/// Maximum depth of nested definitions; definitions that contain each other exceed it.
const MAX_DEPTH: usize = 32;
/// Maximum length of a column's name in bytes.
const MAX_NAME: usize = 255;
/// Fields whose name begins so only align the fields after them.
const PADDING: &str = "_padding";

/// Basic type of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FieldType {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
    Bool,
    Char,
}

impl FieldType {
    const NAMES: [(&'static str, Self); 12] = [
        ("int8_t", Self::I8),
        ("uint8_t", Self::U8),
        ("int16_t", Self::I16),
        ("uint16_t", Self::U16),
        ("int32_t", Self::I32),
        ("uint32_t", Self::U32),
        ("int64_t", Self::I64),
        ("uint64_t", Self::U64),
        ("float", Self::F32),
        ("double", Self::F64),
        ("bool", Self::Bool),
        ("char", Self::Char),
    ];

    /// Returns the type of a name in a definition, or None if it names another definition.
    #[must_use]
    pub fn of(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(known, _)| *known == name).map(|&(_, kind)| kind)
    }

    /// Name as in a definition.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, kind)| *kind == self).map_or("", |&(name, _)| name)
    }

    /// Size in bytes.
    #[must_use]
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 | Self::Bool | Self::Char => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }
}

/// A field as written in a definition.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Member {
    type_name: String,
    /// Number of elements; 0 for a single value.
    count: usize,
    name: String,
}

/// A definition: `name:type field;type[3] field;`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Format {
    pub name: String,
    members: Vec<Member>,
}

impl Format {
    /// Reads the text of a definition; None if it is malformed.
    #[must_use]
    pub fn parse(text: &[u8]) -> Option<Self> {
        let (name, fields) = std::str::from_utf8(text).ok()?.split_once(':')?;
        let fields = fields.split(';').filter(|field| !field.is_empty());
        let members: Vec<Member> = fields.map(Member::parse).collect::<Option<_>>()?;
        let usable = !name.is_empty() && name.len() <= MAX_NAME && FieldType::of(name).is_none();
        (usable && !members.is_empty()).then(|| Self { name: name.to_owned(), members })
    }
}

impl Member {
    fn parse(text: &str) -> Option<Self> {
        let mut words = text.split_ascii_whitespace();
        let (type_text, name) = (words.next()?, words.next()?);
        let (type_name, count) = match type_text.split_once('[') {
            Some((type_name, count)) => (type_name, count.strip_suffix(']')?.parse().ok()?),
            None => (type_text, 0),
        };
        let usable = name.len() <= MAX_NAME && count <= MAX_RECORD && (count > 0 || !type_text.contains('['));
        usable.then(|| Self { type_name: type_name.to_owned(), count, name: name.to_owned() })
    }
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    /// Name, with the names of the enclosing fields: `esc[0].rpm`.
    pub name: String,
    pub kind: FieldType,
    /// Number of elements; 0 for a single value.
    pub count: usize,
    /// Position in the row.
    pub offset: usize,
}

impl Field {
    fn range(&self) -> Range<usize> {
        self.offset..self.offset + self.kind.size() * self.count.max(1)
    }
}

/// Bytes that are copied from a record to a row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Copy {
    pub from: Range<usize>,
    pub to: usize,
}

/// Layout of a table's rows and of the records that they are copied from.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Layout {
    pub fields: Vec<Field>,
    pub copies: Vec<Copy>,
    /// Positions in the row of texts, and of truth values.
    pub texts: Vec<Range<usize>>,
    pub truths: Vec<Range<usize>>,
    /// Size of a row in bytes, a multiple of four so that rows stay aligned.
    pub row_size: usize,
    /// Size of a record without the padding at its end, which a writer may leave out, and with it.
    pub min_record: usize,
    pub max_record: usize,
    /// Position of the field `timestamp` in a record, and in a row.
    pub timestamp: Option<usize>,
    pub timestamp_in_row: Option<usize>,
}

impl Layout {
    /// Derives the layout of the records of a definition; None if a nested definition is missing, names are not unique,
    /// or the record is too large.
    ///
    /// `budget` is the number of fields that may still be examined; it is reduced also for a definition that fails.
    pub fn build(name: &str, formats: &HashMap<String, Format>, budget: &mut usize) -> Option<Self> {
        let layout = Self { row_size: ROW_HEADER, ..Self::default() };
        let mut builder = Builder { formats, layout, record: 0, budget };
        builder.add_all(name, "", 0)?;
        let Builder { mut layout, record, .. } = builder;
        let mut names = HashSet::from(["_time", "_instance"]);
        let unique = layout.fields.iter().all(|field| names.insert(&field.name));
        layout.max_record = record;
        layout.min_record = layout.copies.last()?.from.end;
        layout.row_size = layout.row_size.next_multiple_of(4);
        let ranges = |kind, single| {
            let fields = layout.fields.iter().filter(move |field| field.kind == kind && (single || field.count > 0));
            fields.map(Field::range).collect()
        };
        (layout.texts, layout.truths) = (ranges(FieldType::Char, false), ranges(FieldType::Bool, true));
        unique.then_some(layout)
    }
}

struct Builder<'a> {
    formats: &'a HashMap<String, Format>,
    layout: Layout,
    /// Size of the record so far.
    record: usize,
    budget: &'a mut usize,
}

impl Builder<'_> {
    fn add_all(&mut self, format: &str, prefix: &str, depth: usize) -> Option<()> {
        let formats = self.formats;
        let members = &formats.get(format).filter(|_| depth < MAX_DEPTH)?.members;
        members.iter().try_for_each(|member| self.add(member, prefix, depth))
    }

    fn add(&mut self, member: &Member, prefix: &str, depth: usize) -> Option<()> {
        *self.budget = self.budget.checked_sub(1)?;
        let name = format!("{prefix}{}", member.name);
        if name.len() > MAX_NAME {
            return None;
        }
        match (FieldType::of(&member.type_name), member.count) {
            (Some(kind), count) => self.add_field(member, name, kind, count),
            (None, 0) => self.add_all(&member.type_name, &format!("{name}."), depth + 1),
            (None, count) => (0..count)
                .try_for_each(|number| self.add_all(&member.type_name, &format!("{name}[{number}]."), depth + 1)),
        }
    }

    fn add_field(&mut self, member: &Member, name: String, kind: FieldType, count: usize) -> Option<()> {
        let start = self.record;
        self.record += kind.size() * count.max(1);
        if self.record > MAX_RECORD {
            return None;
        }
        if member.name.starts_with(PADDING) {
            return Some(());
        }
        let layout = &mut self.layout;
        if name == "timestamp" && kind == FieldType::U64 && count == 0 {
            (layout.timestamp, layout.timestamp_in_row) = (Some(start), Some(layout.row_size));
        }
        layout.fields.push(Field { name, kind, count, offset: layout.row_size });
        match layout.copies.last_mut() {
            Some(copy) if copy.from.end == start => copy.from.end = self.record,
            _ => layout.copies.push(Copy { from: start..self.record, to: layout.row_size }),
        }
        layout.row_size += self.record - start;
        Some(())
    }
}
