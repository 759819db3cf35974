//! Layout tables: the part of a dialect that the core needs.

use std::fmt;

/// Longest payload that either version of the protocol can carry.
pub const MAX_PAYLOAD: usize = 255;

/// Element type of a field, as the definitions spell it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldType {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F32,
    F64,
    Char,
}

impl FieldType {
    const NAMES: [(&'static str, Self); 12] = [
        ("uint8_t", Self::U8),
        ("uint8_t_mavlink_version", Self::U8),
        ("int8_t", Self::I8),
        ("uint16_t", Self::U16),
        ("int16_t", Self::I16),
        ("uint32_t", Self::U32),
        ("int32_t", Self::I32),
        ("uint64_t", Self::U64),
        ("int64_t", Self::I64),
        ("float", Self::F32),
        ("double", Self::F64),
        ("char", Self::Char),
    ];

    /// The type that a definition spells `name`.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(known, _)| *known == name).map(|&(_, kind)| kind)
    }

    /// Bytes of one element.
    #[must_use]
    pub const fn size(self) -> usize {
        match self {
            Self::U8 | Self::I8 | Self::Char => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }
}

/// One field of a message: its position in the full payload and its type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    pub name: String,
    pub kind: FieldType,
    /// Elements of an array, 0 for a single value.
    pub array_length: u8,
    pub offset: u8,
    /// True if the value reads as an enum member.
    pub enumerated: bool,
}

impl Field {
    /// Size of the field in bytes.
    #[must_use]
    pub fn size(&self) -> usize {
        self.kind.size() * usize::from(self.array_length.max(1))
    }

    /// The byte range of the field in a full payload.
    #[must_use]
    pub fn range(&self) -> std::ops::Range<usize> {
        usize::from(self.offset)..usize::from(self.offset) + self.size()
    }
}

/// One message: its identity, its lengths and its fields in the order of the definition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    pub id: u32,
    pub name: String,
    pub crc_extra: u8,
    /// Payload length without extensions: the length of a version 1 packet.
    pub base_length: u8,
    /// Payload length with extensions.
    pub length: u8,
    pub fields: Vec<Field>,
}

/// A layout that contradicts itself or its dialect.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LayoutError(pub String);

impl fmt::Display for LayoutError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(&self.0)
    }
}

impl std::error::Error for LayoutError {}

impl Layout {
    /// Checks that every field lies inside the payload, so that readers need not check it again.
    pub fn validate(&self) -> Result<(), LayoutError> {
        if self.id > 0x00FF_FFFF {
            return Err(LayoutError(format!("{}: id {} is over 16777215", self.name, self.id)));
        }
        if self.base_length > self.length {
            return Err(LayoutError(format!("{}: base length exceeds length", self.name)));
        }
        for field in &self.fields {
            if field.range().end > usize::from(self.length) {
                return Err(LayoutError(format!("{}.{} ends beyond the payload", self.name, field.name)));
            }
        }
        Ok(())
    }
}

/// The properties of a message that the scanner needs, packed so that a look-up touches one cache line.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    pub slot: u16,
    pub crc_extra: u8,
    pub base_length: u8,
}

const PAGE: usize = 256;
const ABSENT: u16 = u16::MAX;

/// All layouts of a dialect, found by id through a two-level table.
#[derive(Debug, Default)]
pub struct Dialect {
    layouts: Vec<Layout>,
    entries: Vec<Entry>,
    pages: Vec<u16>,
    slots: Vec<[u16; PAGE]>,
}

impl Dialect {
    /// Creates a dialect of `layouts`; each is validated, and no two may share an id.
    pub fn new(layouts: Vec<Layout>) -> Result<Self, LayoutError> {
        if layouts.len() >= usize::from(ABSENT) {
            return Err(LayoutError(format!("a dialect cannot hold {} messages", layouts.len())));
        }
        let mut dialect = Self::default();
        for layout in layouts {
            layout.validate()?;
            dialect.insert(layout)?;
        }
        Ok(dialect)
    }

    fn insert(&mut self, layout: Layout) -> Result<(), LayoutError> {
        let page = layout.id as usize / PAGE;
        if page >= self.pages.len() {
            self.pages.resize(page + 1, ABSENT);
        }
        if self.pages[page] == ABSENT {
            self.pages[page] = self.slots.len() as u16;
            self.slots.push([ABSENT; PAGE]);
        }
        let slot = &mut self.slots[usize::from(self.pages[page])][layout.id as usize % PAGE];
        if *slot != ABSENT {
            return Err(LayoutError(format!("message id {} is defined twice", layout.id)));
        }
        *slot = self.layouts.len() as u16;
        self.entries.push(Entry { slot: *slot, crc_extra: layout.crc_extra, base_length: layout.base_length });
        self.layouts.push(layout);
        Ok(())
    }

    /// The scanner's entry of a message id.
    #[inline]
    #[must_use]
    pub fn entry(&self, id: u32) -> Option<Entry> {
        let page = *self.pages.get(id as usize / PAGE)?;
        let slots = self.slots.get(usize::from(page))?;
        self.entries.get(usize::from(slots[id as usize % PAGE])).copied()
    }

    /// The layout of a message id.
    #[must_use]
    pub fn layout(&self, id: u32) -> Option<&Layout> {
        self.entry(id).map(|entry| &self.layouts[usize::from(entry.slot)])
    }

    /// All layouts; a slot is an index into this slice.
    #[must_use]
    pub fn layouts(&self) -> &[Layout] {
        &self.layouts
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A dialect for tests: HEARTBEAT, and a message with extension fields.
    pub(crate) fn dialect() -> Dialect {
        let field = |name: &str, kind, array_length, offset| Field {
            name: name.into(),
            kind,
            array_length,
            offset,
            enumerated: false,
        };
        Dialect::new(vec![
            Layout {
                id: 0,
                name: "HEARTBEAT".into(),
                crc_extra: 50,
                base_length: 9,
                length: 9,
                fields: vec![field("type", FieldType::U8, 0, 4), field("custom_mode", FieldType::U32, 0, 0)],
            },
            Layout {
                id: 253,
                name: "STATUSTEXT".into(),
                crc_extra: 83,
                base_length: 51,
                length: 54,
                fields: vec![
                    field("severity", FieldType::U8, 0, 0),
                    field("text", FieldType::Char, 50, 1),
                    field("id", FieldType::U16, 0, 51),
                    field("chunk_seq", FieldType::U8, 0, 53),
                ],
            },
        ])
        .expect("a valid dialect")
    }

    #[test]
    fn known_ids_have_layouts_and_unknown_ids_have_none() {
        let dialect = dialect();
        assert_eq!(dialect.layout(253).map(|layout| layout.name.as_str()), Some("STATUSTEXT"));
        assert!(dialect.entry(1).is_none());
        assert!(dialect.entry(0x00FF_FFFF).is_none());
    }

    #[test]
    fn duplicate_ids_and_fields_outside_the_payload_are_refused() {
        let layouts = dialect().layouts().to_vec();
        let twice = vec![layouts[0].clone(), layouts[0].clone()];
        assert!(Dialect::new(twice).unwrap_err().0.contains("defined twice"));
        let mut outside = layouts[0].clone();
        outside.fields[1].offset = 6;
        assert!(Dialect::new(vec![outside]).unwrap_err().0.contains("beyond the payload"));
    }
}
