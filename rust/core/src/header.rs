//! Packet headers of both versions.
//!
//! Version 1: magic FE, length, sequence, system, component, id, payload, CRC.
//! Version 2: magic FD, length, incompatibility flags, compatibility flags, sequence, system, component,
//! three bytes of id (little-endian), payload, CRC, and 13 bytes of signature if the packet is signed.

pub const MAGIC_V1: u8 = 0xFE;
pub const MAGIC_V2: u8 = 0xFD;
pub const HEADER_V1: usize = 6;
pub const HEADER_V2: usize = 10;
pub const CHECKSUM: usize = 2;
pub const SIGNATURE: usize = 13;
pub const MAX_PACKET: usize = HEADER_V2 + 255 + CHECKSUM + SIGNATURE;
/// Incompatibility flag: the packet carries a signature.
pub const FLAG_SIGNED: u8 = 0x01;

/// The header of one packet, decoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    pub message_id: u32,
    pub version: u8,
    pub payload_length: u8,
    pub incompat_flags: u8,
    pub compat_flags: u8,
    pub sequence: u8,
    pub system: u8,
    pub component: u8,
}

impl Header {
    /// Decodes the header at the start of `data`, whose first byte must be a magic; `None` if it is cut short.
    #[inline]
    #[must_use]
    pub fn parse(data: &[u8]) -> Option<Self> {
        match data {
            [MAGIC_V2, payload_length, incompat_flags, compat_flags, sequence, system, component, a, b, c, ..] => {
                Some(Self {
                    message_id: u32::from_le_bytes([*a, *b, *c, 0]),
                    version: 2,
                    payload_length: *payload_length,
                    incompat_flags: *incompat_flags,
                    compat_flags: *compat_flags,
                    sequence: *sequence,
                    system: *system,
                    component: *component,
                })
            }
            [MAGIC_V1, payload_length, sequence, system, component, id, ..] => Some(Self {
                message_id: u32::from(*id),
                version: 1,
                payload_length: *payload_length,
                incompat_flags: 0,
                compat_flags: 0,
                sequence: *sequence,
                system: *system,
                component: *component,
            }),
            _ => None,
        }
    }

    /// Length of the header in bytes.
    #[inline]
    #[must_use]
    pub fn header_length(&self) -> usize {
        if self.version == 2 { HEADER_V2 } else { HEADER_V1 }
    }

    /// True if a signature follows the checksum.
    #[inline]
    #[must_use]
    pub fn signed(&self) -> bool {
        self.incompat_flags & FLAG_SIGNED != 0
    }

    /// The byte range of the payload in the packet.
    #[inline]
    #[must_use]
    pub fn payload(&self) -> std::ops::Range<usize> {
        let start = self.header_length();
        start..start + usize::from(self.payload_length)
    }

    /// Length of the whole packet in bytes.
    #[inline]
    #[must_use]
    pub fn packet_length(&self) -> usize {
        self.payload().end + CHECKSUM + if self.signed() { SIGNATURE } else { 0 }
    }
}
