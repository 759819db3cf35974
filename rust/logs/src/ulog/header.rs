//! The header of a file, and the flag bits that may follow it.

use super::{u16_at, u64_at};
use std::fmt;

/// First bytes of a file.
pub const MAGIC: &[u8] = b"ULog\x01\x12\x35";
/// Size of the header: magic, version, time.
pub const HEADER: usize = 16;
/// Size of a message's header: size, kind.
pub const MESSAGE_HEADER: usize = 3;

/// Incompatible flag: data is appended at the offsets of the flag bits message.
const DATA_APPENDED: u8 = 1;
/// Position of the flag bits message's body.
const FLAGS: usize = HEADER + MESSAGE_HEADER;
const FLAGS_SIZE: u16 = 40;
const OFFSETS: usize = 3;

/// Header of a file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Header {
    pub version: u8,
    /// Time since boot in microseconds at which logging started.
    pub start_time: u64,
    pub compatible_flags: [u8; 8],
    pub incompatible_flags: [u8; 8],
    /// Positions at which appended data begins, in increasing order.
    pub appended: Vec<usize>,
    /// Number of offsets of appended data that are outside the file or not in order.
    pub bad_offsets: u64,
}

/// Reason why a file cannot be read at all.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeaderError {
    Short(usize),
    Magic,
    IncompatibleFlags([u8; 8]),
}

impl fmt::Display for HeaderError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Short(size) => write!(formatter, "it has {size} bytes, the header of a ULog has {HEADER}"),
            Self::Magic => write!(formatter, "it does not begin like a ULog"),
            Self::IncompatibleFlags(flags) => {
                write!(formatter, "it uses features of ULog that are not supported (incompatible flags ")?;
                flags.iter().try_for_each(|flag| write!(formatter, "{flag:02x}"))?;
                write!(formatter, ")")
            }
        }
    }
}

impl std::error::Error for HeaderError {}

impl Header {
    /// Reads the header and the flag bits.
    ///
    /// # Errors
    /// The file is no ULog, or has flags that a reader must not ignore.
    pub fn parse(data: &[u8]) -> Result<Self, HeaderError> {
        if !data.starts_with(&MAGIC[..data.len().min(MAGIC.len())]) {
            return Err(HeaderError::Magic);
        }
        let (Some(&version), Some(start_time)) = (data.get(MAGIC.len()), u64_at(data, MAGIC.len() + 1)) else {
            return Err(HeaderError::Short(data.len()));
        };
        let mut header = Self { version, start_time, ..Self::default() };
        if data.get(FLAGS - 1) == Some(&b'B') && u16_at(data, HEADER).is_some_and(|size| size >= FLAGS_SIZE) {
            header.read_flags(data)?;
        }
        Ok(header)
    }

    fn read_flags(&mut self, data: &[u8]) -> Result<(), HeaderError> {
        let flags = |position: usize| data.get(position..).and_then(|rest| rest.first_chunk::<8>());
        let (Some(&compatible), Some(&incompatible)) = (flags(FLAGS), flags(FLAGS + 8)) else {
            return Ok(());
        };
        self.compatible_flags = compatible;
        self.incompatible_flags = incompatible;
        if incompatible[0] & !DATA_APPENDED != 0 || incompatible[1..].iter().any(|&flag| flag != 0) {
            return Err(HeaderError::IncompatibleFlags(incompatible));
        }
        if incompatible[0] & DATA_APPENDED != 0 {
            let offsets = (0..OFFSETS).filter_map(|number| u64_at(data, FLAGS + 16 + 8 * number));
            for offset in offsets.filter(|&offset| offset != 0) {
                self.append(offset, data.len());
            }
        }
        Ok(())
    }

    fn append(&mut self, offset: u64, size: usize) {
        let lowest = self.appended.last().map_or(FLAGS + usize::from(FLAGS_SIZE), |&last| last + 1);
        match usize::try_from(offset) {
            Ok(offset) if (lowest..=size).contains(&offset) => self.appended.push(offset),
            _ => self.bad_offsets += 1,
        }
    }

    /// End of the section that `position` is in: messages do not cross it.
    #[must_use]
    pub fn section_end(&self, position: usize, size: usize) -> usize {
        self.appended.iter().copied().find(|&offset| offset > position).unwrap_or(size)
    }
}
